"""The sections of the configuration of a run, and their keys.

Only the path of a measured surface has no default; the default load follows from the surface and the
solid. The flags of the command line are made of these models.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeAlias, cast

from pydantic import Field, PrivateAttr, model_validator

from asperity.app.config.sections import (
    Conductivity,
    Duration,
    Force,
    Load,
    LoadOverArea,
    OneOrTwo,
    Position,
    Positive,
    Pressure,
    Resistivity,
    Section,
    Share,
    Size,
    Time,
    Velocity,
    Work,
    any_of,
    field_of,
    listed,
    made,
    union_of,
    usual,
)
from asperity.app.config.solids import SOLIDS, SolidSection
from asperity.app.config.surfaces import SURFACES, SurfaceSection
from asperity.base.files import Format
from asperity.base.parameters import parameters_of
from asperity.errors import InputError
from asperity.protocols import KINDS as LEGS_OF_PROTOCOLS
from asperity.protocols import Leg, leg_of

FILES = {"surface": "path", "solid": "relaxation", "output": "measured"}
"""Keys that name files, by their sections."""

KINDS: Mapping[str, Mapping[str, type[Section]]] = {"surface": SURFACES, "solid": SOLIDS}
"""Sections of several kinds, and the models of each kind; the first is the usual one."""


if TYPE_CHECKING:
    from asperity.carried import Carried as CarriedQuantities

    AnySurface = SurfaceSection
    AnySolid = SolidSection
    AnyLeg: TypeAlias = "LegSection"
else:
    AnySurface, AnySolid = map(union_of, KINDS.values())


class Contact(Section):
    """A load, a pressure or a separation; by default about 1 % of the surface touches."""

    load: Load | None = usual(
        None,
        "Normal load; 0 before a ramp; may be negative with adhesion. "
        "By default 0.005 (k0 + k1) x rms height x sites; on a continuum see the pressure.",
    )
    pressure: LoadOverArea | None = usual(
        None,
        "Load over nominal area, in place of the load. By default, on a continuum, 0.005 E* x rms slope.",
    )
    separation: Position | None = usual(None, "Mean height of the undeformed solid, in place of the load.")

    @model_validator(mode="after")
    def _one_of_three(self) -> Self:
        if len(stated := self.model_dump(exclude_none=True)) > 1:
            got = "both" if len(stated) == 2 else "all"
            names = list(stated)
            raise ValueError(f"expected {', '.join(names[:-1])} or {names[-1]}, got {got}")
        return self


class Aging(Section):
    """The times to record ([0.0]: only the start and the limit), the constant quantity, and the tolerance."""

    first: Duration | None = usual(
        None,
        "First time to record. By default that of the relaxation table, else a tenth of the "
        "shortest relaxation time, else 0.001.",
    )
    last: Duration | None = usual(
        None,
        "Last time to record. By default that of the relaxation table, else ten times the "
        "longest relaxation time, else 1e+06.",
    )
    per_decade: Annotated[int, Field(ge=1, le=1000)] = usual(4, "Times to record in each decade.")
    times: Annotated[list[Time], Field(min_length=1)] | None = usual(
        None, "List of times to record, in place of first, last and times per decade."
    )
    hold: Literal["load", "separation"] | None = usual(
        None, "Quantity that stays constant while the contact ages. By default the one that pressed it."
    )
    rtol: Annotated[float, Field(ge=1e-6, le=0.1)] = usual(2e-3, "Relative tolerance of the time steps.")

    @model_validator(mode="after")
    def _check_times(self) -> Self:
        if self.times is None:
            return self
        if rivals := self.model_fields_set & {"first", "last", "per_decade"}:
            raise ValueError(f"expected times or {', '.join(sorted(rivals))}, got both")
        for earlier, later in pairwise(self.times):
            if later <= earlier:
                raise ValueError(
                    f"times: expected strictly increasing times, got {later:g} after {earlier:g}"
                )
        return self


class LegSection(Section):
    """A leg of `asperity.protocols`, of one kind or another; its keys are the parameters of that class."""

    kind: str
    _leg: Leg = PrivateAttr()

    @property
    def leg(self) -> Leg:
        """The leg itself."""
        return self._leg

    @model_validator(mode="after")
    def _possible(self) -> Self:
        try:
            self._leg = leg_of(self.model_dump(exclude_none=True))
        except InputError as error:
            names = error.name.replace(" and ", ", ").split(", ")
            expectation = (
                f"expected {any_of(names)}" if names[1:] else f"{error.name}: expected {error.expected}"
            )
            raise ValueError(f"{expectation}, got {error.got}") from None
        return self


class RepeatLeg(LegSection):
    """Legs repeated; see `asperity.protocols.Repeat`."""

    kind: Literal["repeat"] = "repeat"
    legs: list[AnyLeg] = Field(min_length=1, description="The legs that are repeated.")
    count: Annotated[int, Field(ge=1, le=100_000)] = Field(description="How often in all.")


def _section_of(kind: str, leg: type[Leg]) -> type[LegSection]:
    keys = {name: field_of(parameter) for name, parameter in parameters_of(leg).items()}
    return made(f"{leg.__name__}Leg", __name__, LegSection, kind, keys)


LEGS: dict[str, type[LegSection]] = {
    kind: RepeatLeg if kind == "repeat" else _section_of(kind, leg) for kind, leg in LEGS_OF_PROTOCOLS.items()
}
if not TYPE_CHECKING:
    AnyLeg = union_of(LEGS)


class Friction(Section):
    """The shear strength that gives friction from the contact area; none by default."""

    shear_strength: Pressure | None = usual(
        None, "Shear strength of the contacts; on the lattice of springs, force per site."
    )
    rate_coefficient: Share | None = usual(
        None, "Relative growth of the shear strength with ln(velocity). By default 0."
    )
    reference_velocity: Velocity | None = usual(None, "Sliding velocity that belongs to the shear strength.")

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.shear_strength is None and self.model_fields_set:
            raise ValueError(f"{min(self.model_fields_set)}: expected shear_strength beside it, got none")
        if self.rate_coefficient and self.reference_velocity is None:
            raise ValueError("rate_coefficient: expected reference_velocity beside it, got none")
        return self


class Carried(Section):
    """Stiffness, resistances, stick and pull-off of the contact on a half-space, recorded at each time."""

    stiffness: bool = usual(
        False, "Record the normal stiffness, and the tangential one if the solid has one Poisson's ratio."
    )
    resistivity: OneOrTwo[Resistivity] | None = usual(
        None, "Electrical resistivity, one value or one for each body: record the resistance."
    )
    conductivity: OneOrTwo[Conductivity] | None = usual(
        None, "Thermal conductivity, likewise: record the thermal resistance."
    )
    shear: Force | None = usual(None, "Shear force: record the fraction of the contact that sticks.")
    friction_coefficient: Positive | None = usual(
        None, "Local coefficient of friction under the shear force."
    )
    work_of_adhesion: Work | None = usual(
        None, "Work of adhesion: record the pull-off force, without further creep."
    )

    @model_validator(mode="after")
    def _both(self) -> Self:
        names = ("shear", "friction_coefficient")
        if (self.shear is None) != (self.friction_coefficient is None):
            other, name = names if self.shear is None else names[::-1]
            raise ValueError(f"{name}: expected {other} beside it, got none")
        return self


class Output(Section):
    """Maps, figures, and an instrument."""

    maps_at: list[Time] | None = usual(
        None, "Times at which the contact is stored and drawn. By default 0 and five others."
    )
    figures: list[Format] = usual(["png"], 'Formats of the figures; "" for none.')
    measured: str | None = usual(
        None,
        "Table of a measured contact area against time, with units: the figure of the area shows it, and the "
        "ratio measured / computed.",
    )
    pixel: Size | None = usual(
        None, "Pixel of a microscope through which the maps are seen; in sites if there are no units."
    )
    blur: Size | None = usual(None, "Full width at half maximum of its point spread function, likewise.")
    threshold: Share | None = usual(
        None, "Fraction of contact above which a pixel counts as contact. By default the fractions are added."
    )

    @property
    def instrument(self) -> dict[str, Any]:
        """Arguments of `asperity.observe`; empty for none."""
        return self.model_dump(include={"pixel", "blur", "threshold"}, exclude_none=True)

    @model_validator(mode="after")
    def _check_maps(self) -> Self:
        if self.threshold is not None and self.pixel is None and self.blur is None:
            raise ValueError("threshold: expected `pixel` or `blur` beside it, got neither")
        if self.maps_at == [] and self.instrument:
            raise ValueError(f"{next(iter(self.instrument))}: expected maps to look at, got maps_at = []")
        return self


SECTIONS: Mapping[str, type[Section]] = {
    "contact": Contact,
    "aging": Aging,
    "friction": Friction,
    "carried": Carried,
    "output": Output,
}
"""Sections of one kind."""


class RunConfig(Section):
    """The configuration of a run."""

    surface: AnySurface = SURFACES["gaussian"](kind="gaussian")
    solid: AnySolid = SOLIDS["spring_lattice"](kind="spring_lattice")
    contact: Contact = Contact()
    aging: Aging = Aging()
    protocol: list[AnyLeg] = Field(default=[])
    friction: Friction = Friction()
    carried: Carried = Carried()
    output: Output = Output()

    @model_validator(mode="after")
    def _check_times(self) -> Self:
        if self.protocol and "last" in self.aging.model_fields_set:
            raise ValueError("[aging] last: expected none beside a protocol, which says when it ends")
        if self.aging.times is None and not self.protocol and not self.span[0] < self.span[1]:
            raise ValueError("[aging] last: expected more than first, {:g}, got {:g}".format(*self.span))
        if self.protocol and self.aging.hold is not None:
            raise ValueError("[aging] hold: expected none beside a protocol, whose legs say what they hold")
        if self.contact.load == 0 and not (self.protocol and self.written_out[0].target):
            expected = "a protocol that begins with a ramp beside 0"
            raise ValueError(f"[contact] load: expected {expected}, got none; try --leg 'ramp 1 load=...'")
        if (measured := self.solid.known) is not None:
            first = next((time for time in self.aging.times or [self.span[0]] if time > 0), measured[0])
            if first < measured[0] * (1 - 1e-9) or self.end > measured[1] * (1 + 1e-9):
                key, origin, word = "relaxation", "a table", "plateau"
                if getattr(self.solid, "data_last", None) is not None:
                    key, origin, word = "data_last", "data", "model"
                got = "{:g} to {:g} s".format(*measured)
                expected = f"{origin} of the times to record, {first:g} to {self.end:g} s"
                advice = f'; try extrapolate = "{word}" (--extrapolate {word})'
                if word == "plateau":
                    advice = f"{advice}, or branches" if first >= measured[0] * (1 - 1e-9) else ""
                raise ValueError(f"[solid] {key}: expected {expected}, got {got}{advice}")
        for where, times in (("[aging] times", self.aging.times), ("[output] maps_at", self.output.maps_at)):
            late = max(times or [], default=-math.inf)
            if late > self.end * (1 + 1e-9):
                raise ValueError(f"{where}: expected times up to the last, {self.end:g}, got {late:g}")
        return self

    @model_validator(mode="after")
    def _check_loads(self) -> Self:
        if "adhesion" in self.solid.laws:
            return self
        pressing = [("[contact] load", self.contact.load), ("[contact] pressure", self.contact.pressure)]
        pressing += [
            (f"protocol[{number}] {leg.target}", leg.value(leg.duration, 0.0))
            for number, section in enumerate(self.protocol)
            for leg in section.leg.written_out()
            if leg.target in ("load", "pressure")
        ]
        for where, load in pressing:
            if load is not None and (load < 0 or (load == 0 and where != "[contact] load")):
                pulls = "adhesion = 'dugdale' (--adhesion dugdale) for loads that pull"
                advice = (
                    f"{-load:g}, which presses, or {pulls}" if load else "a small one, which lifts the body"
                )
                raise ValueError(f"{where}: expected more than 0, got {load:g}; try {advice}")
        return self

    @property
    def legs(self) -> tuple[Leg, ...]:
        """The legs of the protocol, if any."""
        return tuple(leg.leg for leg in self.protocol)

    @property
    def written_out(self) -> list[Leg]:
        """The legs one by one, without repetitions."""
        return [one for leg in self.legs for one in leg.written_out()]

    @property
    def span(self) -> tuple[float, float]:
        """First and last time to record, if not listed; with a protocol the first of each leg."""
        first, last = self.solid.span
        return self.aging.first or first, self.aging.last or last

    @property
    def carries(self) -> CarriedQuantities | None:
        """What to record besides load and area, if anything."""
        if not (facts := self.carried.model_dump(exclude_defaults=True)):
            return None
        from asperity.carried import Carried  # which brings the solvers

        for name in {"resistivity", "conductivity"} & facts.keys():
            facts[name] = tuple(facts[name]) if len(facts[name]) > 1 else facts[name][0]
        if "friction_coefficient" in facts:
            facts["friction"] = facts.pop("friction_coefficient")
        ratios = {*cast(list[float], listed(getattr(self.solid, "poisson", None)) or [])}
        if facts.pop("stiffness", False) and len(ratios) == 1:
            facts["poisson"] = ratios.pop()
        return Carried(**facts)

    @property
    def end(self) -> float:
        """The last time."""
        if not self.protocol:
            return self.span[1] if self.aging.times is None else self.aging.times[-1]
        return math.fsum(leg.duration for leg in self.written_out)
