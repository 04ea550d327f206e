"""Legs of a history, one by one and in lists."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Gt, Le

from asperity.base import checks
from asperity.base.parameters import Checked, Quantity, parameters_of
from asperity.errors import LARGEST, InputError

if TYPE_CHECKING:
    from asperity.lattice import Lattice

_AXES = {"x": (0, 1), "-x": (0, -1), "y": (1, 0), "-y": (-1, 0)}

_MOST_LEGS = 100_000
"""Most legs of a history, repetitions written out."""

_MOST_SHIFTS = _MOST_STEPS = 10**7

_Mobility = Annotated[float, Gt(0), Quantity("factor on the mobility of creep meanwhile")]
_Load = Annotated[float | None, Quantity("load at the end, below 0 where it pulls.", "N", of_line="N/m")]
_Separation = Annotated[float | None, Quantity("separation at the end; instead of the load", "m")]
_Pressure = Annotated[float | None, Quantity("load over nominal area at the end; instead of the load", "Pa")]
_Approach = Annotated[
    float | None,
    Quantity("how far the rigid body has moved at the end since time 0; instead of the load", "m"),
]

TARGETS = ("load", "pressure", "separation", "approach")
"""Quantities that a `Ramp` or a `Step` may prescribe."""

Say = Callable[[str, float], str]
"""Writes a value of a quantity of the results, with its unit."""


@dataclass(frozen=True)
class Shifts:
    """Shifts of a leg that slides: their number, and sites along each axis and length of each."""

    count: int
    sites: tuple[Fraction, ...]
    length: float


class Leg(Checked):
    """A part of a history: `Hold`, `Ramp`, `Step`, `Slide`, `Repeat`, or a class of your own.

    Derive a frozen dataclass with `target`, `value` and `words`. Annotate its fields with bounds and an
    `asperity.base.parameters.Quantity`.

    Attributes
    ----------
    duration
        Its duration.
    hold
        Quantity to hold; None for the last prescribed one.
    mobility
        Factor on the mobility of creep.
    speed
        Velocity of the rough surface.
    target
        Prescribed quantity: ``"load"``, ``"separation"``, ``"pressure"`` or ``"approach"``; empty if it stays
        constant.
    every
        One in so many shifts is recorded.
    """

    duration: float
    hold: Literal["load", "separation", "area"] | None = None
    mobility: float = 1.0
    speed: float = 0.0
    target: str = ""
    every: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        parameters = parameters_of(type(self))
        for name in sorted(vars(self).keys() - parameters):
            expected, advice = "a field whose annotation has a Quantity", "Annotated[float, Quantity(...)]"
            raise InputError(name, expected=expected, got="one without", advice=advice)
        if self.target or type(self).value is not Leg.value:
            checks.choice("target", self.target, TARGETS)
        if self.target and self.duration > 0:
            checks.number("longest", self.longest, least=self.duration / _MOST_STEPS)
        for name, parameter in parameters.items():
            value = getattr(self, name)
            if parameter.bounds.get("above") == 0 and value is not None and np.min(value) < 1 / LARGEST:
                got = f"{np.min(value):g}"
                raise InputError(name, expected=f"a number of at least {1 / LARGEST:g}", got=got)

    def value(self, time: float, start: float) -> float:
        """Prescribed value at a time since the beginning of the leg, where it was ``start``."""
        raise NotImplementedError

    def rises(self, start: float) -> bool:
        """Whether the prescribed value never falls; False, if in doubt, costs time and no accuracy."""
        del start
        return False

    @property
    def longest(self) -> float:
        """Longest time step that follows `value`, for instance a twentieth of a period."""
        return self.duration

    @property
    def rests(self) -> bool:
        """Whether only creep changes the contact."""
        return not (self.target or self.speed)

    @property
    def jumps(self) -> bool:
        """Whether the prescribed value changes instantly."""
        return bool(self.target) and self.duration == 0

    @property
    def moves_the_body(self) -> bool:
        """Whether the rigid body is held or moved."""
        return bool({self.hold, self.target} & {"separation", "approach"})

    def load_on(self, area: float) -> float | None:
        """Load at its end on a nominal area, if known beforehand."""
        del area
        return None

    def shifts(self, lattice: Lattice) -> Shifts | None:
        """Shifts of the rough surface; None for a leg that does not slide, `InputError` if it cannot."""
        del lattice
        return None

    def written_out(self) -> Iterator[Leg]:
        """Legs one by one, without repetitions."""
        yield self

    def words(self, say: Say) -> str:
        """The leg in words."""
        raise NotImplementedError

    @property
    def arguments(self) -> dict[str, object]:
        """Arguments that are not defaults."""
        parameters = parameters_of(type(self))
        return {name: value for name, value in vars(self).items() if value != parameters[name].default}


@dataclass(frozen=True)
class Hold(Leg):
    """Nothing changes for a while.

    Parameters
    ----------
    duration
        Time > 0.
    hold
        Constant quantity: ``"load"``, ``"separation"`` (the rigid body) or ``"area"`` (the load follows, so
        that the number of sites in contact stays); by default the last prescribed one.
    mobility
        Factor > 0 on the mobility of creep during this leg, as a change of temperature makes it.
    """

    duration: Annotated[float, Gt(0), Quantity("how long it lasts", "s")]
    hold: Annotated[
        Literal["load", "separation", "area"] | None,
        Quantity("quantity to hold; by default the last that was prescribed"),
    ] = None
    mobility: _Mobility = 1.0

    def words(self, say: Say) -> str:
        """See `Leg`."""
        verb = f"hold {self.hold} for" if self.hold else "hold for"
        return f"{verb} {say('time', self.duration)}{_faster(self)}"


class Change(Leg):
    """A leg that ends at another load or separation."""

    example: ClassVar[str]
    """Example of such a leg."""

    load: float | None
    separation: float | None
    pressure: float | None
    approach: float | None

    def __post_init__(self) -> None:
        checks.one_of(self.example, **{name: getattr(self, name) for name in TARGETS})
        super().__post_init__()

    @property
    def target(self) -> str:  # type: ignore[override]
        """The prescribed quantity."""
        return next(name for name in TARGETS if getattr(self, name) is not None)

    @property
    def end(self) -> float:
        """Its value at the end."""
        return float(getattr(self, self.target))

    def value(self, time: float, start: float) -> float:
        """See `Leg`."""
        return start + (self.end - start) * (time / self.duration) if self.duration else self.end

    def rises(self, start: float) -> bool:
        """See `Leg`."""
        return self.end >= start

    def load_on(self, area: float) -> float | None:
        """See `Leg`."""
        return self.load if self.pressure is None else self.pressure * area

    def _end(self, say: Say) -> str:
        """Its end in words."""
        quantity = "mean_contact_pressure" if self.target == "pressure" else self.target
        return f"{self.target} {say(quantity, self.end)}".replace("-", "\u2212")


@dataclass(frozen=True)
class Ramp(Change):
    """The load or the separation changes linearly in time to a new value.

    Parameters
    ----------
    duration
        Time >= 0; 0 is a `Step`.
    load, pressure, separation, approach
        One of these at the end: the load, > 0 without adhesion; the load over nominal area; the separation,
        for which the rigid body moves by the difference from the mean of u0 at the beginning; or the approach
        of the dataset, by which the rigid body has moved since time 0.
    mobility
        As in `Hold`.
    """

    duration: Annotated[float, Ge(0), Quantity("how long it lasts; 0 is a step", "s")]
    example = "Ramp(10.0, load=400.0)"

    load: _Load = None
    separation: _Separation = None
    mobility: _Mobility = 1.0
    pressure: _Pressure = None
    approach: _Approach = None

    def words(self, say: Say) -> str:
        """See `Leg`."""
        return f"ramp to {self._end(say)} in {say('time', self.duration)}{_faster(self)}"


@dataclass(frozen=True)
class Step(Change):
    """The load or the separation changes instantly; the crept shape stays.

    Parameters
    ----------
    load, pressure, separation, approach
        The new value of one of these, as in `Ramp`.
    """

    example = "Step(load=400.0)"

    load: _Load = None
    separation: _Separation = None
    pressure: _Pressure = None
    approach: _Approach = None

    duration = 0.0

    def words(self, say: Say) -> str:
        """See `Leg`."""
        return f"step to {self._end(say)}"


@dataclass(frozen=True)
class Slide(Leg):
    """The rough surface slides under the elastic body, whose crept shape stays with the body.

    It moves by whole sites, instantly; between two shifts the contact creeps for the time of a site at this
    velocity. The load or the separation, whichever was prescribed last, is held. The first shift is at the
    beginning of the leg. The distance is rounded to shifts; the leg lasts for distance / velocity.

    Parameters
    ----------
    distance
        Distance > 0, in the unit of the distance between sites, which is 1 on a solid defined on sites.
    velocity
        Velocity > 0, distance / time; ``"inf"`` slides instantly, without creep.
    direction
        Direction of the rough surface: ``"x"`` along the last axis, ``"-x"``, ``"y"``, ``"-y"``; or the sites
        of one shift along each axis, such as ``(1, 1)``.
    substeps
        Shifts from site to site, >= 1; heights between sites are interpolated, see `asperity.slide`.
    every
        Record the states after one in so many shifts, and before the next one, >= 1.
    mobility
        As in `Hold`.
    """

    distance: Annotated[float, Gt(0), Quantity("distance to slide; on the lattice of springs, in sites", "m")]
    velocity: Annotated[float | Literal["inf"], Gt(0), Quantity("sliding velocity; inf takes no time", "m/s")]
    direction: Annotated[
        Literal["x", "-x", "y", "-y"] | str | tuple[int, ...],
        Quantity("where the rough surface goes: x along the rows"),
    ] = "x"
    substeps: Annotated[
        int, Ge(1), Quantity("shifts from site to site; heights between sites are interpolated")
    ] = 1
    every: Annotated[int, Ge(1), Quantity("record before and after one shift in so many")] = 1
    mobility: _Mobility = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", checked_direction(self.direction))
        super().__post_init__()

    @property
    def speed(self) -> float:  # type: ignore[override]
        """Its velocity."""
        return float(self.velocity)

    @property
    def duration(self) -> float:  # type: ignore[override]
        """Distance over velocity."""
        return self.distance / self.speed

    def shifts(self, lattice: Lattice) -> Shifts:
        """See `Leg`."""
        check_edges(lattice)
        sites = sites_along(self.direction, lattice.dimension)
        length = lattice.length_of(sites) / self.substeps
        count = round(self.distance / length)
        if not 1 <= count <= _MOST_SHIFTS:
            expected = f"from {length:g}, which is one shift, to {_MOST_SHIFTS:g} of them"
            advice = "" if count else "more substeps"
            raise InputError("distance", expected=expected, got=f"{self.distance:g}", advice=advice)
        return Shifts(count, tuple(Fraction(n, self.substeps) for n in sites), length)

    def words(self, say: Say) -> str:
        """See `Leg`."""
        speed = say("velocity", self.speed) if self.duration else "once"
        return f"slide {say('displacement', self.distance)} at {speed}"


def check_edges(lattice: Lattice) -> None:
    """`InputError` unless the edges are periodic."""
    if lattice.edges != "periodic":
        got = f"one with {lattice.edges} edges"
        expected, cure = "a surface with periodic edges", {"periodic": "mirror"}
        raise InputError("slide", expected=expected, got=got, cure=cure)


def checked_direction(direction: object) -> str | tuple[int, ...]:
    """One of the axes, or whole sites along each axis, in lowest terms; `InputError` if it is neither."""
    if isinstance(direction, str) and direction in _AXES:
        return direction
    expected = "'x', '-x', 'y', '-y', or whole numbers of sites along the axes"
    components = direction if isinstance(direction, tuple | list) else [direction]
    sites = [checks.integer("direction", n, least=-(2**31), expected=expected) for n in components]
    if len(sites) not in (1, 2) or not any(sites):
        raise InputError("direction", expected=expected, got=checks.shown(direction))
    return tuple(n // math.gcd(*sites) for n in sites)


def sites_along(direction: str | tuple[int, ...], dimension: int) -> tuple[int, ...]:
    """Sites along each axis of one shift; `InputError` if the surface has no such direction."""
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
        Number of repetitions, >= 1; at most 100,000 legs in all.
    """

    legs: Annotated[Sequence[Leg], Quantity("the legs that are repeated")]
    count: Annotated[int, Ge(1), Le(_MOST_LEGS), Quantity("how often in all")]

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "legs", tuple(legs_of(self.legs)))
        _check_length(self.count * len(self.legs), f"{self.count:,} times {len(self.legs):,}")

    def written_out(self) -> Iterator[Leg]:
        """See `Leg`."""
        for _ in range(self.count):
            yield from self.legs

    def words(self, say: Say) -> str:
        """See `Leg`."""
        return f"{self.count} × ({', '.join(leg.words(say) for leg in self.legs)})"


def _faster(leg: Leg) -> str:
    return f", mobility\u00a0×\u00a0{leg.mobility:.5g}" if leg.mobility != 1 else ""


def legs_of(protocol: Sequence[Leg] | Leg) -> Iterator[Leg]:
    """Legs one by one, repetitions written out; `InputError` for no leg, none or more than 100,000."""
    if isinstance(protocol, Leg):
        protocol = [protocol]
    advice = "[asperity.protocols.Hold(10.0), asperity.protocols.Step(load=160.0)]"
    several = protocol if isinstance(protocol, Sequence) and len(protocol) else [protocol]
    if others := [leg for leg in several if not isinstance(leg, Leg)]:
        raise InputError("protocol", expected="a list of legs", got=repr(others[0]), advice=advice)
    total = sum(leg.count * len(leg.legs) if isinstance(leg, Repeat) else 1 for leg in protocol)
    _check_length(total, f"{total:,}")
    for leg in protocol:
        yield from leg.written_out()


def _check_length(count: int, shown: str) -> None:
    """Refuse very many legs before they are written out."""
    if count > _MOST_LEGS:
        expected = f"at most {_MOST_LEGS:,} legs, repetitions written out"
        raise InputError("protocol", expected=expected, got=shown, advice="fewer repetitions")


def described(leg: Leg) -> dict[str, object]:
    """A leg as plain numbers and words, as configuration files write it."""
    values: dict[str, object] = {"kind": type(leg).__name__.lower()}
    for name, value in leg.arguments.items():
        if isinstance(value, tuple):
            value = [described(part) if isinstance(part, Leg) else part for part in value]
        values[name] = "inf" if value == math.inf else value
    return values


def in_words(legs: Iterable[Mapping[str, Any]]) -> str:
    """Legs as `described` writes them, in one line: ``hold 10, repeat 3 (step load=160, hold 1)``."""
    words = []
    for leg in legs:
        usual = parameters_of(KINDS[leg["kind"]]) if leg["kind"] in KINDS else {}
        described, named = [leg["kind"]], []
        for key, value in leg.items():
            short = f"{value:g}" if isinstance(value, float | int) else str(value)
            if key in ("duration", "count"):
                described.append(short)
            elif key not in ("kind", "legs") and not (key in usual and value == usual[key].default):
                named.append(f"{key}={short}")
        nested = [f"({in_words(leg['legs'])})"] if "legs" in leg else []
        words.append(" ".join(described + named + nested))
    return ", ".join(words)


KINDS: dict[str, type[Leg]] = {kind.__name__.lower(): kind for kind in (Hold, Ramp, Step, Slide, Repeat)}
"""Legs by their kind in a configuration. Those added before `asperity.app` is imported have keys, too."""


def leg_of(values: Mapping[str, Any]) -> Leg:
    """Make a leg of what `described` wrote: by `KINDS` or the last class of this name and these fields."""
    arguments = {name: value for name, value in values.items() if name != "kind"}
    if "legs" in arguments:
        arguments["legs"] = [leg_of(part) for part in arguments["legs"]]
    kind, keys = values["kind"], set(arguments)
    named = [leg for leg in (*Leg.__subclasses__(), *Change.__subclasses__()) if leg.__name__.lower() == kind]
    matching = [KINDS[kind]] if kind in KINDS else [leg for leg in named if keys <= set(parameters_of(leg))]
    if not matching:
        raise InputError("protocol", expected="legs whose classes are imported", got=repr(kind))
    return matching[-1](**arguments)
