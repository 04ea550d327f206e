"""Records of friction: times, the velocity of slip, and the friction coefficient."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks, units, views
from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.friction.laws import timetable
from asperity.friction.loading import STEP, Drive, drive_of, drive_of_slip, variance
from asperity.friction.normal_stress import changes

_GAP, _PART = 10.0, "a part of the record"
"""Interval between rows, over their median, that may hide a hold; advice."""

RUN_IN, HOLD, STEPPED = 0, 1, 2
"""Kinds of events."""


class About(TypedDict, total=False):
    """Other facts of a record."""

    strength_at_rest: bool
    a: float | None
    si: bool
    normal_stress: float | None
    normal_force: float | None
    normal: Floats | None
    source: str
    read: str
    units: tuple[str, str]


@dataclass(frozen=True, eq=False, repr=False)
class Record(views.Brief):
    """Friction of a contact that slides and rests.

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
        Whether friction at rest is the strength that a slip would meet, as in simulations. In an experiment
        it is the force of the machine, which is not fitted.
    a
        The direct effect, if it is known: 0 for a simulation with a constant shear strength.
    si
        Whether times are in s and lengths in m; else they are in units of the simulation.
    normal_stress, normal_force
        Mean normal stress (Pa) and force (N), if they are known, for the unit of a stiffness.
    normal
        Normal stress or force over its mean, shape (n,), if it changes; else None. A fit needs the stiffness
        of the machine then.
    load_point, slip
        Measured displacements, with noise, of the load point of a machine and of the slider, shape (n,); or
        None.
    drive
        The load point as straight segments, or None. Velocity and rests are those of the load point then, and
        a fit needs the stiffness of the machine.
    source, read, units
        Origin of the record; its columns; units of time and length in messages.
    """

    time: Floats
    velocity: Floats
    friction: Floats
    strength_at_rest: bool = field(default=False, kw_only=True)
    a: float | None = field(default=None, kw_only=True)
    si: bool = field(default=True, kw_only=True)
    normal_stress: float | None = field(default=None, kw_only=True)
    normal_force: float | None = field(default=None, kw_only=True)
    normal: Floats | None = field(default=None, kw_only=True)
    source: str = field(default="", kw_only=True)
    load_point: Floats | None = field(default=None, kw_only=True)
    slip: Floats | None = field(default=None, kw_only=True)
    drive: Drive | None = field(default=None, kw_only=True)
    units: tuple[str, str] = field(default=("s", "m"), kw_only=True)
    read: str = field(default="", kw_only=True, repr=False)

    def __post_init__(self) -> None:
        time, velocity = timetable(self.time, self.velocity)
        numbers = {"time": time, "velocity": velocity}
        for name in ("friction", *["normal"] * (self.normal is not None)):
            numbers[name] = checks.positive(name, checks.history(time=time, **{name: getattr(self, name)})[1])
        for name, values in numbers.items():
            object.__setattr__(self, name, values)
        if not self.si:
            object.__setattr__(self, "units", ("", ""))

    @classmethod
    def of_displacement(
        cls, time: ArrayLike, displacement: ArrayLike, friction: ArrayLike, **about: Unpack[About]
    ) -> Record:
        """Make a record of the displacement (length) in place of the velocity.

        The velocity of an interval is its displacement over its duration. If the contact slips between two
        entries of one time, only the entry before the slip is kept. Simulated contacts are oldest there: see
        docs/rate_and_state.md for the effect of whole sites on mu_0, b and D_c.

        The three have shape (n,), and the displacement never falls; `about` are further arguments of
        `Record`.
        """
        times, places = checks.line("time", time), checks.line("displacement", displacement)
        values = checks.line("friction", friction)
        if not times.size or places.size != times.size or values.size != times.size:
            got = f"{times.size} times, {places.size} displacements, {values.size} friction coefficients"
            raise InputError("displacement", expected="one for each time and friction", got=got)
        kept = ~after_slips(times, places)
        times, places, values = times[kept], places[kept], values[kept]
        if (normal := about.get("normal")) is not None:
            about["normal"] = checks.line("normal", normal)[kept]
        falls = np.diff(places) < 0
        if falls.any():
            at = int(np.argmax(falls))
            names = about.get("units", ("s", "m")) if about.get("si", True) else ("", "")
            lower, upper = places[at : at + 2] / _scales(names)[1]
            expected = "a displacement that never falls, as the record slides in one direction"
            got = f"{upper:.6g} after {lower:.6g} {names[1]}".rstrip()
            advice = "Record.of_machine, which allows for noise; or cutting the record at the reversal"
            raise InputError("displacement", expected=expected, got=got, advice=advice)
        durations = np.diff(times)
        with np.errstate(invalid="ignore", divide="ignore"):
            velocity = np.append(np.nan, np.diff(places) / durations)
        # The first time, and the second of two entries at one time, have the velocity of what follows.
        for at in np.flatnonzero(~np.isfinite(velocity))[::-1]:
            velocity[at] = velocity[at + 1] if at + 1 < velocity.size else 0.0
        return cls(times, velocity, values, **about)

    @classmethod
    def of_machine(
        cls,
        time: ArrayLike,
        friction: ArrayLike,
        *,
        load_point: ArrayLike | None = None,
        slip: ArrayLike | None = None,
        **about: Unpack[About],
    ) -> Record:
        """Make a record of noisy measurements of a machine: load point, slip of the slider, or both.

        Rests are those of the load point. If only slip is measured, the load point is slip + friction/k, with
        the k that makes it straight between its kinks.

        Displacements have shape (n,), and may fall by their noise; at least one is needed. `about` are
        further arguments of `Record`. `InputError` for a load point that goes back, or rests without rows.
        """
        times, values = checks.line("time", time), checks.line("friction", friction)
        measured = {"load_point": load_point, "slip": slip}
        given = {name: place for name, place in measured.items() if place is not None}
        places: dict[str, Any] = {name: checks.line(name, place) for name, place in given.items()}
        name = next(iter(places), "load_point")
        sizes = {values.size, *(place.size for place in places.values())}
        if not places or sizes != {times.size} or times.size < 3:
            got = f"{times.size} times, {values.size} friction coefficients"
            got += "".join(f", {place.size} of {kind}" for kind, place in places.items())
            raise InputError(name, expected="three displacements or more, one for each", got=got)
        checks.history(time=times)
        if name == "slip":
            normal = about.get("normal")
            force = values if normal is None else values * normal
            driven, prescribed = drive_of_slip(times, places[name], force)
            if prescribed:
                return cls.of_displacement(times, places[name], values, **about)
        else:
            driven = drive_of(times, places[name])
        record = cls(times, driven.per_row(times), values, drive=driven, **places, **about)
        if (driven.velocity < 0).any():
            n, unit = int(np.argmax(driven.velocity < 0)), record.units[0]
            start, end = driven.edges(times)[n : n + 2] / record.scales[0]
            got = f"{record.speed(driven.velocity[n])} from {start:.6g} to {end:.6g} {unit}"
            expected, advice = "a displacement that goes on in one direction", _PART
            if name == "slip":
                expected = "slip whose load point, slip + friction/k, goes on in one direction for some k"
                advice = "a column of the load point, more rows in each hold, or a part of the record"
            raise InputError(name.replace("_", " "), expected=expected, got=got, advice=advice)
        gaps, least = np.diff(times), np.diff(driven.place(times)) / 2
        least -= 5 * math.sqrt(variance(times, places[name]))
        lost = (gaps > _GAP * np.median(gaps)) & (np.diff(places[name]) < least)
        if name == "load_point" and lost.any():
            start, end = times[int(np.argmax(lost)) :][:2] / record.scales[0]
            got = f"a rest without rows between {start:.6g} and {end:.6g} {record.units[0]}"
            raise InputError("load point", expected="four rows or more in each hold", got=got, advice=_PART)
        return record

    def between(self, start: float, stop: float = math.inf) -> Record:
        """Return the rows of a record of a machine between two times, with the kinks there."""
        assert self.drive is not None
        kept = (self.time >= start) & (self.time <= stop)
        columns = {name: values for name, values in vars(self).items() if isinstance(values, np.ndarray)}
        rows: dict[str, Any] = {name: values[kept] for name, values in columns.items()}
        return replace(self, drive=self.drive.between(start, stop), **rows)

    @property
    def scales(self) -> tuple[float, float]:
        """The units of time and length in messages, in those of the record."""
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
    def pressing(self) -> Floats:
        """Normal stress over its mean, shape (n,)."""
        return np.ones_like(self.time) if self.normal is None else self.normal

    @property
    def presses_anew(self) -> bool:
        """Whether the normal stress changes."""
        return self.normal is not None and changes(self.time, self.normal)

    @property
    def finest_slip(self) -> float:
        """Smallest slip between two values, which resolves no smaller D_c."""
        slips = np.diff(self.displacement)
        return float(slips[slips > 0].min())

    @property
    def steps(self) -> NDArray[np.bool_]:
        """Whether the velocity of slip steps between neighboring entries, shape (n - 1,)."""
        before, now = self.velocity[:-1], self.velocity[1:]
        with np.errstate(divide="ignore", invalid="ignore"):
            return (before > 0) & (now > 0) & (np.abs(np.log(now / before)) > math.log(STEP))

    @property
    def events(self) -> NDArray[np.intp]:
        """Event of each entry, shape (n,): 0 the run-in, 1 a rest and the slip after it, 2 a step."""
        change = np.where(self.velocity[1:] == 0, HOLD, np.where(self.steps, STEPPED, -1))
        change = np.append(HOLD if self.velocity[0] == 0 else RUN_IN, change)
        return np.asarray(change[np.maximum.accumulate(np.where(change >= 0, np.arange(change.size), 0))])


def _scales(names: tuple[str, str]) -> tuple[float, float]:
    second, length = (units.factor(name, base) for name, base in zip(names, ("s", "m"), strict=True))
    return second or 1.0, length or 1.0


def after_slips(time: Floats, displacement: Floats) -> NDArray[np.bool_]:
    """Mask of the entries after a slip at one time, shape (n,)."""
    return np.append(False, (np.diff(time) == 0) & (np.diff(displacement) != 0))
