"""Histories of load and separation: a list of legs, one after the other.

    P = asp.protocols
    protocol = [P.Hold(10.0), P.Step(load=160.0), P.Hold(100.0)]
    protocol = [P.Repeat([P.Ramp(5.0, load=400.0), P.Ramp(5.0, load=100.0)], count=3)]
    protocol = [P.Slide(50.0, velocity=0.1), P.Hold(1e3), P.Slide(50.0, velocity=0.1)]

Times run through the whole history. Durations are in the unit of time, loads and separations in those of
`asperity.press`, distances in that of the distance between sites. Where a contact has units, they may be
texts: ``Hold("10 min")``, ``Step(load="2 N")``, ``Slide("20 um", velocity="1 um/s")``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any, Literal

import numpy as np

from asperity.base import checks, units
from asperity.errors import LARGEST, InputError

__all__ = ["Hold", "Leg", "Ramp", "Repeat", "Slide", "Step"]
__dir__ = __all__.copy  # dir() lists the public names alone


_SAME_TIME = 1e-9
"""Relative difference of a sum of durations and a time that is meant to be it."""


_UNITS = {
    "duration": "s",
    "load": "N",
    "separation": "m",
    "approach": "m",
    "pressure": "Pa",
    "distance": "m",
    "velocity": "m/s",
}

_AXES = {"x": (0, 1), "-x": (0, -1), "y": (1, 0), "-y": (-1, 0)}

_MOST_LEGS = 100_000
"""Legs of a history, repetitions written out: each is a march of its own."""

_TARGETS = ("load", "separation", "pressure", "approach")
"""What a `Ramp` or a `Step` may prescribe."""


class Leg:
    """A part of a history: `Hold`, `Ramp`, `Step`, `Slide` or `Repeat`."""


@dataclass(frozen=True)
class Hold(Leg):
    """Nothing changes for a while.

    Parameters
    ----------
    duration
        How long, time > 0.
    hold
        What is held: ``"load"``, ``"separation"`` (the rigid body) or ``"area"`` (the load follows, so that
        the number of sites in contact stays); by default what was prescribed last.
    mobility
        Factor > 0 on the mobility of creep during this leg, as a change of temperature makes it.
    """

    duration: float
    hold: Literal["load", "separation", "area"] | None = None
    mobility: float = 1.0

    def __post_init__(self) -> None:
        _check(self, "duration", "mobility")
        if self.hold not in (None, "load", "separation", "area"):
            raise InputError("hold", expected="'load', 'separation' or 'area'", got=repr(self.hold))


class Change(Leg):
    """A leg that ends at another load or separation."""

    load: float | None
    separation: float | None
    pressure: float | None
    approach: float | None

    @property
    def target(self) -> str:
        """Which of these it prescribes."""
        return next(name for name in _TARGETS if getattr(self, name) is not None)


@dataclass(frozen=True)
class Ramp(Change):
    """The load or the separation changes linearly in time to a new value.

    Parameters
    ----------
    duration
        How long, time > 0.
    load
        The load at the end > 0.
    separation
        The separation at the end: the rigid body moves by what it differs from the mean of u0 at the
        beginning. Give this, the approach, the load or the pressure.
    pressure
        The load at the end over the nominal area > 0.
    mobility
        As in `Hold`.
    approach
        The approach at the end: how far the rigid body has moved since time 0, as the dataset has it.
    """

    duration: float
    load: float | None = None
    separation: float | None = None
    mobility: float = 1.0
    pressure: float | None = None
    approach: float | None = None

    def __post_init__(self) -> None:
        _check(self, "duration", "mobility")
        _check_target(self, "Ramp(10.0, load=400.0)")


@dataclass(frozen=True)
class Step(Change):
    """The load or the separation changes at once; the crept shape stays.

    Parameters
    ----------
    load
        The new load > 0.
    separation
        The new separation. Give this, the approach, the load or the pressure.
    pressure
        The new load over the nominal area > 0.
    approach
        The new approach, as in `Ramp`.
    """

    load: float | None = None
    separation: float | None = None
    pressure: float | None = None
    approach: float | None = None

    def __post_init__(self) -> None:
        _check_target(self, "Step(load=400.0)")

    @property
    def duration(self) -> float:
        """No time passes."""
        return 0.0


@dataclass(frozen=True)
class Slide(Leg):
    """The rough surface slides under the elastic body, whose crept shape stays with the body.

    It moves by whole sites, at once; between two shifts the contact creeps for the time that the velocity
    takes from site to site. What was prescribed last, the load or the separation, is held. The first shift is
    at the beginning of the leg. The distance is rounded to shifts; the leg lasts for distance / velocity.

    Parameters
    ----------
    distance
        How far > 0, in the unit of the distance between sites, which is 1 on a solid defined on sites.
    velocity
        How fast > 0, distance / time; `math.inf` or ``"inf"`` slides at once, so that nothing creeps.
    direction
        Where the rough surface goes: ``"x"`` along the last axis, ``"-x"``, ``"y"``, ``"-y"``; or the sites
        of one shift along each axis, such as ``(1, 1)``.
    substeps
        Shifts from site to site, >= 1. If there are several, heights between the sites are interpolated; see
        `asperity.slide`.
    every
        Record the states after one in so many shifts, and before the next one, >= 1.
    mobility
        As in `Hold`.
    """

    distance: float
    velocity: float
    direction: str | tuple[int, ...] = "x"
    substeps: int = 1
    every: int = 1
    mobility: float = 1.0

    def __post_init__(self) -> None:
        if isinstance(self.velocity, str | float) and self.velocity in ("inf", math.inf):
            object.__setattr__(self, "velocity", math.inf)
            _check(self, "distance", "mobility")
        else:
            _check(self, "distance", "velocity", "mobility")
        for name in ("substeps", "every"):
            object.__setattr__(self, name, checks.integer(name, getattr(self, name), least=1))
        object.__setattr__(self, "direction", checked_direction(self.direction))

    @property
    def duration(self) -> float:
        """Distance over velocity."""
        return self.distance / self.velocity


def checked_direction(direction: object) -> str | tuple[int, ...]:
    """One of the axes, or whole sites along each axis, in lowest terms.

    Raises
    ------
    InputError
        It is neither.
    """
    if isinstance(direction, str) and direction in _AXES:
        return direction
    expected = "'x', '-x', 'y', '-y', or whole numbers of sites along the axes"
    given = direction if isinstance(direction, tuple | list) else [direction]
    sites = [checks.integer("direction", n, least=-(2**31), expected=expected) for n in given]
    if len(sites) not in (1, 2) or not any(sites):
        raise InputError("direction", expected=expected, got=checks.shown(direction))
    return tuple(n // math.gcd(*sites) for n in sites)


def sites_along(direction: str | tuple[int, ...], dimension: int) -> tuple[int, ...]:
    """Sites along each axis of one shift in a direction.

    Raises
    ------
    InputError
        The surface has no such direction.
    """
    sites = _AXES[direction] if isinstance(direction, str) else direction
    if dimension == 1 and isinstance(direction, str) and not sites[0]:
        sites = sites[1:]
    if len(sites) != dimension:
        expected = "'x' or '-x' on a line" if dimension == 1 else "two numbers of sites, or 'x' or 'y'"
        raise InputError("direction", expected=expected, got=checks.shown(direction))
    return sites


@dataclass(frozen=True)
class Repeat(Leg):
    """Legs repeated.

    Parameters
    ----------
    legs
        The legs.
    count
        How many times they are done, >= 1; at most 100,000 legs in all.
    """

    legs: Sequence[Leg]
    count: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "count", checks.integer("count", self.count, least=1))
        object.__setattr__(self, "legs", tuple(legs_of(self.legs)))
        _check_length(self.count * len(self.legs), f"{self.count:,} times {len(self.legs):,}")


def legs_of(protocol: Sequence[Leg] | Leg) -> Iterator[Hold | Ramp | Step | Slide]:
    """Legs of a protocol one by one, repetitions written out.

    Raises
    ------
    InputError
        An entry is no leg, there is none, or there are more than 100,000.
    """
    if isinstance(protocol, Leg):
        protocol = [protocol]
    advice = "[asperity.protocols.Hold(10.0), asperity.protocols.Step(load=160.0)]"
    if not isinstance(protocol, Sequence) or len(protocol) == 0:
        raise InputError("protocol", expected="a list of legs", got=repr(protocol), advice=advice)
    total = sum(leg.count * len(leg.legs) if isinstance(leg, Repeat) else 1 for leg in protocol)
    _check_length(total, f"{total:,}")
    for leg in protocol:
        if isinstance(leg, Repeat):
            for _ in range(leg.count):
                yield from leg.legs  # type: ignore[misc]  # plain legs, as Repeat has written them out
        elif isinstance(leg, Hold | Ramp | Step | Slide):
            yield leg
        else:
            raise InputError(
                "protocol", expected="Hold, Ramp, Step, Slide or Repeat", got=repr(leg), advice=advice
            )


def _check_length(count: int, shown: str) -> None:
    """Refuse what would take days to follow, before it is written out."""
    if count > _MOST_LEGS:
        expected = f"at most {_MOST_LEGS:,} legs, repetitions written out"
        raise InputError("protocol", expected=expected, got=shown, advice="fewer repetitions")


def described(leg: Leg) -> dict[str, object]:
    """A leg as plain numbers and words, as configuration files write it."""
    values: dict[str, object] = {"kind": type(leg).__name__.lower()}
    for name, value in vars(leg).items():
        if isinstance(value, tuple):
            value = [described(part) if isinstance(part, Leg) else part for part in value]
        if value is not None and value != _USUAL.get(name):
            values[name] = "inf" if value == math.inf else value
    return values


def in_words(legs: Iterable[Mapping[str, Any]]) -> str:
    """Legs as `described` writes them, in one line: ``hold 10, repeat 3 (step load=160, hold 1)``."""
    words = []
    for leg in legs:
        short = {
            key: f"{value:g}" if isinstance(value, float | int) else str(value)
            for key, value in leg.items()
            if key != "legs"
        }
        said = [short.pop(key) for key in ("kind", "duration", "count") if key in short]
        said += [f"{key}={value}" for key, value in short.items() if value != f"{_USUAL.get(key)}"]
        said += [f"({in_words(leg['legs'])})"] if "legs" in leg else []
        words.append(" ".join(said))
    return ", ".join(words)


def leg_of(values: Mapping[str, Any]) -> Leg:
    """Make a leg of what `described` wrote."""
    arguments = {name: value for name, value in values.items() if name != "kind"}
    if "legs" in arguments:
        arguments["legs"] = [leg_of(part) for part in arguments["legs"]]
    return _KINDS[values["kind"]](**arguments)


_KINDS: dict[str, type[Leg]] = {kind.__name__.lower(): kind for kind in (Hold, Ramp, Repeat, Slide, Step)}

_USUAL = {"mobility": 1, "direction": "x", "substeps": 1, "every": 1}
"""What is not said of a leg."""


@dataclass(frozen=True)
class Schedule:
    """A protocol against the times at which it is recorded.

    Attributes
    ----------
    legs
        The legs, repetitions written out.
    switches
        Times at which they begin and end: one more than legs, the first 0.
    """

    legs: tuple[Hold | Ramp | Step | Slide, ...]
    switches: tuple[float, ...]

    @classmethod
    def of(cls, protocol: Iterable[Hold | Ramp | Step | Slide], times: np.ndarray) -> Schedule:
        """Lay out legs; a switch that is one of the times but for rounding is that time.

        Raises
        ------
        InputError
            Some time is after the end.
        """
        legs = tuple(protocol)
        switches = [0.0]
        for end in accumulate(leg.duration for leg in legs):
            near = times[np.searchsorted(times, end - _SAME_TIME * end) :][:1]
            switches.append(float(near[0]) if near.size and near[0] <= end + _SAME_TIME * end else end)
        if times.size and times[-1] > switches[-1]:
            raise InputError(
                "times",
                expected=f"times up to {switches[-1]:g}, where the protocol ends",
                got=f"{times[-1]:g}",
                advice="a longer last Hold, or fewer times",
            )
        return cls(legs, tuple(switches))

    @property
    def holds_separation(self) -> bool:
        """Whether the rigid body is held or moved in some leg."""
        return any(
            leg.hold == "separation" if isinstance(leg, Hold) else leg.target in ("separation", "approach")
            for leg in self.legs
            if not isinstance(leg, Slide)
        )

    @property
    def slides(self) -> bool:
        """Whether the rough surface slides in some leg."""
        return any(isinstance(leg, Slide) for leg in self.legs)


def _check(leg: Hold | Ramp | Slide, *names: str) -> None:
    """Make Python floats of numbers that are to be above 0."""
    for name in names:
        value = getattr(leg, name)
        object.__setattr__(leg, name, units.number(name, value, _UNITS.get(name, ""), least=1 / LARGEST))


def _check_target(leg: Ramp | Step, advice: str) -> None:
    target = checks.one_of(advice, **{name: getattr(leg, name) for name in _TARGETS})
    least = -LARGEST if target in ("separation", "approach") else 1 / LARGEST
    object.__setattr__(leg, target, units.number(target, getattr(leg, target), _UNITS[target], least=least))
