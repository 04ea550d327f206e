"""Records of friction: times, the velocity of slip, and the friction coefficient."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypedDict, Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks, units, views
from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.friction.laws import timetable
from asperity.friction.loading import STEP, Drive, drive_of, drive_of_slip
from asperity.friction.tabor import ShearStrength, add_friction
from asperity.results import History, load

RUN_IN, HOLD, STEPPED = 0, 1, 2
"""Kinds of events."""

_SHORT, _FEW = 2, 10
"""Rests of so many rows, and how many of them are no noise of the displacement."""


class About(TypedDict, total=False):
    """What a record may say of itself; see there."""

    si: bool
    normal_stress: float | None
    normal_force: float | None
    source: str
    read: str
    units: tuple[str, str]


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
    normal_stress, normal_force
        Mean normal stress (Pa) and force (N), if they are known: a stiffness may be over them.
    source
        Where the record comes from.
    load_point, slip
        Measured displacements, with their noise, of the load point of a machine and of the slider, shape
        (n,); None where they are not.
    drive
        The load point as straight segments. Where there is one, `velocity` is that of the load point: what
        rests is the machine, and a fit needs its stiffness.
    units
        Units of time and length in which messages speak of the record.
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
    normal_force: float | None = field(default=None, kw_only=True)
    source: str = field(default="", kw_only=True)
    load_point: Floats | None = field(default=None, kw_only=True)
    slip: Floats | None = field(default=None, kw_only=True)
    drive: Drive | None = field(default=None, kw_only=True)
    units: tuple[str, str] = field(default=("s", "m"), kw_only=True)
    read: str = field(default="", kw_only=True, repr=False)

    def __post_init__(self) -> None:
        time, velocity = timetable(self.time, self.velocity)
        friction = checks.positive("friction", checks.line("friction", self.friction))
        if friction.size != time.size:
            expected = f"one for each of the {time.size} times"
            raise InputError("friction", expected=expected, got=friction.size)
        for name, values in (("time", time), ("velocity", velocity), ("friction", friction)):
            object.__setattr__(self, name, values)
        if not self.si:
            object.__setattr__(self, "units", ("", ""))

    @classmethod
    def of_displacement(
        cls,
        time: ArrayLike,
        displacement: ArrayLike,
        friction: ArrayLike,
        *,
        strength_at_rest: bool = False,
        a: float | None = None,
        **about: Unpack[About],
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
        strength_at_rest, a, about
            As in a record, as `si`, `source` and others.

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
            names = about.get("units", ("s", "m")) if about.get("si", True) else ("", "")
            one, two = places[at : at + 2] / _scales(names)[1]
            raise InputError(
                "displacement",
                expected="a displacement that never falls, as the record slides in one direction",
                got=f"{two:.6g} after {one:.6g} {names[1]}".rstrip(),
                advice="Record.of_machine, which allows for noise; or cutting the record at the reversal",
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
            **about,
        )

    @classmethod
    def of_machine(
        cls,
        time: ArrayLike,
        friction: ArrayLike,
        *,
        load_point: ArrayLike | None = None,
        slip: ArrayLike | None = None,
        a: float | None = None,
        **about: Unpack[About],
    ) -> Record:
        """Make a record of what a machine measures, with noise: load point, slip of the slider, or both.

        What rests is the load point. Where only slip is measured, it is slip + friction/k, for the k that
        makes it straight between its kinks.

        Parameters
        ----------
        time, friction
            Shape (n,), as in a record.
        load_point, slip
            Displacements (length), shape (n,); one of them at least. They may fall by their noise.
        a, about
            As in a record: `normal_stress`, `normal_force`, `source`, `si`, `units`.

        Raises
        ------
        InputError
            As for a record; or the load point goes back.
        """
        times, values = checks.line("time", time), checks.line("friction", friction)
        places = {
            name: None if place is None else checks.line(name, place)
            for name, place in (("load_point", load_point), ("slip", slip))
        }
        name, along = next(
            ((name, place) for name, place in places.items() if place is not None), ("", times)
        )
        sizes = {name: place.size for name, place in places.items() if place is not None}
        if not name or any(size != times.size for size in [values.size, *sizes.values()]) or times.size < 3:
            got = f"{times.size} times, {values.size} friction coefficients, {sizes}"
            raise InputError(
                name or "load_point", expected="three displacements or more, one for each", got=got
            )
        timetable(times, np.zeros_like(times))
        if name == "slip":
            driven, compliance = drive_of_slip(times, along, values)
            if compliance == 0 and not (np.diff(along) < 0).any():
                return cls.of_displacement(times, along, values, a=a, **about)
        else:
            driven = drive_of(times, along)
        forward = np.maximum(driven.per_row(times), 0.0)
        record = cls(
            times,
            forward,
            values,
            drive=driven,
            a=a,
            load_point=places["load_point"],
            slip=places["slip"],
            **about,
        )
        _refuse_reversal(record, name)
        return record

    @property
    def short_rests(self) -> int:
        """Number of rests of a row or two."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], self.velocity == 0, [False]]).astype(int)))
        return int(np.count_nonzero(edges[1::2] - edges[::2] <= _SHORT))

    @property
    def scales(self) -> tuple[float, float]:
        """The units of time and length of messages in those of the record."""
        return _scales(self.units)

    def speed(self, velocity: float) -> str:
        """Write a velocity in these units."""
        (second, length), (time_unit, length_unit) = self.scales, self.units
        return f"{velocity * second / length:.4g} {length_unit}/{time_unit}".removesuffix(" /")

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


def _scales(names: tuple[str, str]) -> tuple[float, float]:
    second, length = (units.factor(name, base) for name, base in zip(names, ("s", "m"), strict=True))
    return second or 1.0, length or 1.0


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


def refuse_noise(record: Record) -> None:
    """Refuse velocities that rest for a row here and there, as a displacement with noise has them."""
    if (many := record.short_rests) > _FEW and not record.strength_at_rest:
        raise InputError(
            "record",
            expected="rests of the machine, longer than two rows",
            got=f"{many} short ones, as noise or rounding of the displacement makes them",
            advice="asperity.friction.Record.of_machine(time, friction, slip=...), which allows for noise",
        )


def _refuse_reversal(record: Record, name: str) -> None:
    """Refuse a load point that goes back."""
    assert record.drive is not None
    if (record.drive.velocity < 0).any():
        n, unit = int(np.argmax(record.drive.velocity < 0)), record.units[0]
        start, end = record.drive.edges(record.time)[n : n + 2] / record.scales[0]
        raise InputError(
            name.replace("_", " "),
            expected="a displacement that goes on in one direction",
            got=f"{record.speed(record.drive.velocity[n])} from {start:.6g} to {end:.6g} {unit}",
            advice="a part of the record, --from and --to",
        )


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
    refuse_noise(record)
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
