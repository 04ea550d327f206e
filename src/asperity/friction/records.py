"""Records of friction: times, the velocity of slip, and the friction coefficient."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks, views
from asperity.base.checks import Floats
from asperity.base.columns import TIME, Chosen, Columns, Role, Units, named
from asperity.errors import InputError
from asperity.friction.laws import timetable
from asperity.friction.tabor import ShearStrength, add_friction
from asperity.results import History, load

STEP = 1.2
"""Ratio of two velocities from which a change is a step."""

RUN_IN, HOLD, STEPPED = 0, 1, 2
"""Kinds of events."""


@dataclass(frozen=True, eq=False, repr=False)
class Record(views.Brief):
    """How friction went while a contact slid and rested.

    Parameters
    ----------
    time
        Times that never fall, shape (n,); two entries of one time stand before and after a jump.
    velocity
        Mean velocity of slip in the interval that ends at each time, shape (n,), not below 0 and 0 at
        rest; at the first time that of the first interval, and after a jump that of the interval that
        begins. Within an interval ln V is linear in slip (`asperity.friction.laws.half_changes`).
    friction
        Friction coefficients above 0, shape (n,).
    strength_at_rest
        Whether friction at rest is the strength that a slip would meet, as in simulations. In an
        experiment it is the force that the machine holds, and a fit leaves it out.
    a
        The direct effect, if it is known: 0 for a simulation with a constant shear strength.
    si
        Whether times are in s and lengths in m; else they are in units of the simulation.
    normal_stress
        Mean normal stress (Pa), if it is known; only passed on.
    source
        Where the record comes from.
    read
        What was read of which columns of a table.

    Raises
    ------
    InputError
        Times fall, a velocity is negative, a friction coefficient is not above 0, or the shapes differ.
    """

    time: Floats
    velocity: Floats
    friction: Floats
    strength_at_rest: bool = field(default=False, kw_only=True)
    a: float | None = field(default=None, kw_only=True)
    si: bool = field(default=True, kw_only=True)
    normal_stress: float | None = field(default=None, kw_only=True)
    source: str = field(default="", kw_only=True)
    read: str = field(default="", kw_only=True, repr=False)

    def __post_init__(self) -> None:
        time, velocity = timetable(self.time, self.velocity)
        friction = checks.positive("friction", checks.line("friction", self.friction))
        if friction.size != time.size:
            expected = f"one for each of the {time.size} times"
            raise InputError("friction", expected=expected, got=friction.size)
        for name, values in (("time", time), ("velocity", velocity), ("friction", friction)):
            object.__setattr__(self, name, values)

    @classmethod
    def of_displacement(
        cls,
        time: ArrayLike,
        displacement: ArrayLike,
        friction: ArrayLike,
        *,
        strength_at_rest: bool = False,
        a: float | None = None,
        si: bool = True,
        normal_stress: float | None = None,
        source: str = "",
    ) -> Record:
        """Make a record of the displacement (length) in place of the velocity.

        The velocity of an interval is its displacement over its duration. Of entries at one time between
        which the contact slipped the first one counts: that before the slip. Simulated contacts are oldest
        there: with shifts by whole sites mu_0 was up to 1 % above that of short shifts
        (docs/rate_and_state.md, which has b and D_c too).

        Parameters
        ----------
        time, displacement, friction
            Shape (n,); the displacement never falls.
        strength_at_rest, a, si, normal_stress, source
            As in a record.

        Raises
        ------
        InputError
            As for a record; or the displacement falls.
        """
        times, places = checks.line("time", time), checks.line("displacement", displacement)
        values = checks.line("friction", friction)
        if not times.size or places.size != times.size or values.size != times.size:
            got = f"{times.size} times, {places.size} displacements, {values.size} friction coefficients"
            raise InputError("displacement", expected="one for each time and friction", got=got)
        kept = ~_after_slips(times, places)
        times, places, values = times[kept], places[kept], values[kept]
        falls = np.diff(places) < 0
        if falls.any():
            at = int(np.argmax(falls))
            raise InputError(
                "displacement",
                expected="a displacement that never falls, as the record slides in one direction",
                got=f"{places[at + 1]:g} after {places[at]:g}",
                advice="cutting the record at the reversal, smoothing noise, or a column of velocity",
            )
        durations = np.diff(times)
        with np.errstate(invalid="ignore", divide="ignore"):
            velocity = np.append(np.nan, np.diff(places) / durations)
        # The first time, and the second of two entries at one time, have the velocity of what follows.
        for at in np.flatnonzero(~np.isfinite(velocity))[::-1]:
            velocity[at] = velocity[at + 1] if at + 1 < velocity.size else 0.0
        return cls(
            times,
            velocity,
            values,
            strength_at_rest=strength_at_rest,
            a=a,
            si=si,
            normal_stress=normal_stress,
            source=source,
        )

    @property
    def displacement(self) -> Floats:
        """Slip since the first time, shape (n,)."""
        return np.cumsum(self.velocity * np.diff(self.time, prepend=self.time[0]))

    @property
    def finest_slip(self) -> float:
        """Smallest slip between two values; a D_c below it is not resolved."""
        slips = np.diff(self.displacement)
        return float(slips[slips > 0].min())

    @property
    def events(self) -> NDArray[np.intp]:
        """To what each entry belongs, shape (n,): 0 the run-in, 1 a rest and the slip after it, 2 a step."""
        before, now = self.velocity[:-1], self.velocity[1:]
        with np.errstate(divide="ignore", invalid="ignore"):
            stepped = (before > 0) & (now > 0) & (np.abs(np.log(now / before)) > math.log(STEP))
        change = np.where(now == 0, HOLD, np.where(stepped, STEPPED, -1))
        change = np.append(HOLD if self.velocity[0] == 0 else RUN_IN, change)
        return np.asarray(change[np.maximum.accumulate(np.where(change >= 0, np.arange(change.size), 0))])


@dataclass(frozen=True, eq=False, repr=False)
class HoldPeaks(views.Brief):
    """Static friction after holds.

    Attributes
    ----------
    duration
        Time at rest, shape (holds,).
    peak
        Friction at the end of the rest where it is the strength, else the largest of the slip after it.
    before
        Mean friction of the second half of the slip before, shape (holds,).
    velocity
        Velocity of the slip before, shape (holds,).
    """

    duration: Floats
    peak: Floats
    before: Floats
    velocity: Floats


def hold_peaks(record: Record) -> HoldPeaks:
    """Find static friction against hold time.

    If the state before each hold is that of steady sliding at V, the aging law says
    peak - before = b ln(1 + V duration/D_c) without a direct effect: `asperity.fits.logarithm` fits it.

    Parameters
    ----------
    record
        Holds count if there is slip before and after them.

    Returns
    -------
    HoldPeaks
        Possibly of no holds.
    """
    checks.instance("record", record, Record, "asperity.friction.record_of(history)")
    time, velocity, friction = record.time, record.velocity, record.friction
    runs = np.split(np.arange(time.size), np.flatnonzero(np.diff(velocity == 0)) + 1)  # slips and rests
    rows = []
    for slid, rest, slip in zip(runs, runs[1:], runs[2:], strict=False):
        if velocity[rest[0]] == 0:
            peak = friction[rest[-1]] if record.strength_at_rest else friction[slip].max()
            before = friction[slid[slid.size // 2 :]].mean()
            rows.append((time[rest[-1]] - time[slid[-1]], peak, before, velocity[slid[-1]]))
    return HoldPeaks(*np.array(rows, dtype=np.float64).reshape(-1, 4).T)


def record_of(
    history: History | xr.Dataset | Path | str,
    *,
    shear_strength: ShearStrength | float | str | None = None,
) -> Record:
    """Take the record of a history in which the contact slid.

    Parameters
    ----------
    history
        A `History`, its dataset, or the folder where one is saved.
    shear_strength
        As in `add_friction`; needed where the dataset has no series ``friction`` yet.

    Returns
    -------
    Record
        Friction at rest is the strength.

    Raises
    ------
    InputError
        The contact never slid, or friction was not asked for.
    """
    dataset, source = _dataset(history)
    if "displacement" not in dataset or not (dataset["displacement"] > 0).any():
        advice = (
            "a protocol with Slide legs, at the prompt --leg 'slide distance=8 velocity=5' --leg 'hold 10'"
        )
        raise InputError("history", expected="one in which the contact slides", got="none", advice=advice)
    if np.isinf(dataset["velocity"]).any():
        expected = "slides at finite velocities, as the age of contacts has no time to change otherwise"
        raise InputError("history", expected=expected, got="a slide at once")
    if shear_strength is not None:
        dataset = add_friction(dataset, shear_strength)
    if "friction" not in dataset:
        expected = "the shear strength of the contacts, as the history has no series 'friction'"
        raise InputError("shear_strength", expected=expected, got="none", advice="shear_strength=1.0")
    si = dataset["load"].attrs.get("units") in ("N", "N/m")
    slides = dataset.isel(time=np.isfinite(dataset["time"].values))  # not the relaxed state
    slides = slides.isel(time=~_after_slips(slides["time"].values, slides["displacement"].values))
    time = slides["time"].values
    return Record.of_displacement(
        time,
        # The slide goes on between shifts, in which states may have been asked for.
        np.cumsum(slides["velocity"].values * np.diff(time, prepend=time[0])),
        slides["friction"].values,
        strength_at_rest=True,
        a=None if dataset.attrs.get("rate_coefficient") else 0.0,
        si=si,
        normal_stress=float(dataset["load"].mean()) / _nominal_area(dataset) if si else None,
        source=source,
    )


def _after_slips(time: Floats, displacement: Floats) -> NDArray[np.bool_]:
    """Which entries are those after a slip at once, shape (n,)."""
    return np.append(False, (np.diff(time) == 0) & (np.diff(displacement) != 0))


ROLES = (
    Role("", "", r"temp(?!s\b)|humid|feucht|\bstd|\berr|angle|winkel|thickness|dicke"),
    TIME,
    Role(
        "normal stress",
        "Pa",
        r"(normale?|effective)\b.*(stress|pressure|contrainte)|normalspannung|^sigma|^σ",
    ),
    Role("normal force", "N", r"normal.*(force|load)|normalkraft|force normale|^(load|fn|f n|fz|f z)$"),
    Role("shear stress", "Pa", r"shear.*stress|(schub|scher)spannung|contrainte.*(cisail|tang)|^tau$|^τ$"),
    Role(
        "shear force",
        "N",
        r"(shear|friction|tangential|lateral).*force|(reib|reibungs|tangential|quer|scher)kraft"
        r"|force.*(frottement|tangent)|^f ?[stx]$",
    ),
    Role("velocity", "m/s", r"veloc|speed|slip rate|geschwindigkeit|vitesse|^v$"),
    Role(
        "displacement",
        "m",
        r"displac|slip|position|distance|weg\b|verschiebung|deplacement|glissement|^[xds]$",
    ),
    Role("friction", "1", r"friction|^mu\b|^μ|^cof\b|coef|reib\w*(zahl|wert|koeff)|frottement"),
)
"""What the columns of a record hold."""
_EXAMPLES = (
    "time_s, displacement_um and friction, or time_s, velocity_um/s, shear_stress_MPa and normal_stress_MPa"
)


def read_record(
    path: Path | str,
    *,
    columns: Chosen | None = None,
    units: Units | None = None,
    strength_at_rest: bool = False,
) -> Record:
    """Read the record of an experiment from a table in a text file, and convert it to s, m and Pa.

    The names of the columns, or a row below them, say what they hold and in which unit, in English, German or
    French: ``time_s``, ``velocity [um/s]`` or ``displacement (mm)``, and ``friction``, ``COF`` or
    ``Reibungszahl [-]``, or ``shear_stress_MPa`` and ``normal_stress_MPa``, or ``Fx [N]`` and ``Fz [N]``, of
    which friction is the ratio. Where there are velocity and displacement, the velocity counts, which is the
    mean since the line before. If neither time nor velocity nor displacement has a unit, the record is in
    units of its own, such as those of a simulation. For the form of the file see
    `asperity.fits.read_measurements`.

    Parameters
    ----------
    path
        A text file with a line for each time.
    columns
        Names or numbers, from 0, of the columns to read; by default all whose names are understood.
    units
        Units of columns by name or number, in place of those of the table: ``{"slip": "um"}``.
    strength_at_rest
        As in `Record`.

    Raises
    ------
    InputError
        There is no such table, its columns are not understood, some have units and some have none, a cell
        is no number, or the numbers are no record.
    """
    found = Columns(path, ROLES, columns, units)
    by_role, name = found.by_role, found.table.name
    ratios = [kind for kind in ("stress", "force") if {f"shear {kind}", f"normal {kind}"} <= set(by_role)]
    motion = "velocity" if "velocity" in by_role else "displacement"
    if "time" not in by_role or motion not in by_role or not ("friction" in by_role or ratios):
        raise InputError(
            name,
            expected="columns of time, of velocity or displacement, and of friction, stresses or forces",
            got=named(found.table),
            advice=f"a first line that names them with their units, such as {_EXAMPLES}",
        )
    # Of what is divided, or goes together, each has a unit or none has.
    si = any(found.unit(role) for role in ("time", motion))
    time, moved = (found.values(role, bare=not si) for role in ("time", motion))
    if "friction" in by_role:
        friction = found.values("friction")
    else:
        parts = [f"{kind} {ratios[0]}" for kind in ("shear", "normal")]
        bare = not any(map(found.unit, parts))
        shear, normal = (found.values(part, bare=bare) for part in parts)
        friction = shear / normal
    has_stress = "normal stress" in by_role and bool(found.unit("normal stress"))
    normal_stress = float(found.values("normal stress").mean()) if has_stress else None
    make = Record if motion == "velocity" else Record.of_displacement
    how: dict[str, Any] = {"strength_at_rest": strength_at_rest, "si": si, "normal_stress": normal_stress}
    try:
        return replace(make(time, moved, friction, **how, source=name), read=found.read)
    except InputError as error:
        raise error if error.name == "units" else error.about(f"{name}, {error.name}") from error


def _nominal_area(dataset: xr.Dataset) -> float:
    """In m^2; of a run of a campaign, which keeps no heights, from the contact."""
    if "heights" in dataset:
        return float(dataset["heights"].size * math.prod(json.loads(dataset.attrs["spacing"])))
    return float((dataset["contact_area"] / dataset["contact_fraction"]).max())


def _dataset(history: object) -> tuple[xr.Dataset, str]:
    """The dataset of a history, and where it comes from."""
    if isinstance(history, Path | str):
        return load(history), str(Path(history))
    if isinstance(history, History):
        return history.dataset, ""
    return checks.instance("history", history, xr.Dataset, "asperity.age(contact, times, protocol=...)"), ""
