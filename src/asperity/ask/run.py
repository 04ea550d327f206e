"""The sections of the configuration of a run, and their keys.

Only the path of a measured surface has no default; the default load follows from the surface and the
solid. The flags of the command line are made of these models.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Annotated, Any, Literal, cast

from annotated_types import Ge, Gt, Le, Len

from asperity.ask.carried import Carried as CarriedQuantities
from asperity.ask.legs import read_legs
from asperity.ask.question import OwnKeys, Question
from asperity.ask.section import (
    KINDS,
    Section,
    SectionError,
    arguments_of,
    home_of,
    keys_of_maker,
    kind_in,
    unknown_key,
)
from asperity.ask.solid import SOLIDS, SolidSection
from asperity.ask.strength import ShearStrength
from asperity.ask.surface import SURFACES, SurfaceSection
from asperity.base.checks import choice, shown
from asperity.base.files import Format, expanded, without_links
from asperity.base.parameters import Quantity
from asperity.errors import SHOWN_PROBLEMS, InputError, Name, Words
from asperity.protocols import Leg
from asperity.protocols.histories import start_of
from asperity.protocols.legs import described

FILES = {"surface": "path", "solid": "relaxation", "output": "measured"}
"""Keys that name files, by their sections."""

_USUAL_LOAD = "By default 0.005 (k0 + k1) x rms height x sites; on a continuum see the pressure."
_USUAL_PRESSURE = "By default, on a continuum, 0.005 E* x rms slope."
_USUAL_FIRST = (
    "By default that of the relaxation table, else 0.1 of the shortest relaxation time, else 0.001."
)
_USUAL_LAST = (
    "By default that of the relaxation table, else 10 times the longest relaxation time, else 1e+06."
)
_Time = Annotated[float, Ge(0), Le(1e30), Quantity("time", "s")]
_Span = Annotated[float | None, Gt(0), Le(1e30)]
_Share = Annotated[float | None, Ge(0), Le(1)]
_Size = Annotated[float | None, Gt(0)]


class Contact(Section):
    """A load, a pressure or a separation; by default about 1 % of the surface touches."""

    section = "contact"
    ways = (({"load"}, {"pressure"}, {"separation"}),)

    load: Annotated[
        float | None,
        Quantity(f"normal load; 0 before a ramp, below 0 with adhesion. {_USUAL_LOAD}", "N", of_line="N/m"),
    ] = None
    pressure: Annotated[
        float | None,
        Quantity(f"load over nominal area, in place of the load. {_USUAL_PRESSURE}", "Pa"),
    ] = None
    separation: Annotated[
        float | None, Quantity("mean height of the undeformed solid, in place of the load.", "m")
    ] = None


class Aging(Section):
    """The times to record ([0.0]: only the start and the limit), the constant quantity, and the tolerance."""

    section = "aging"
    ways = (({"times"}, {"first", "last", "per_decade"}),)

    first: Annotated[_Span, Quantity(f"first time to record. {_USUAL_FIRST}", "s", swept=False)] = None
    last: Annotated[_Span, Quantity(f"last time to record. {_USUAL_LAST}", "s", swept=False)] = None
    per_decade: Annotated[int, Ge(1), Le(1000), Quantity("times to record in each decade", swept=False)] = 4
    times: Annotated[
        Sequence[_Time] | None,
        Len(1),
        Quantity(
            "times to record, listed, in place of first, last and times per decade.",
            dimension="time",
            swept=False,
        ),
    ] = None
    hold: Annotated[
        Literal["load", "separation"] | None,
        Quantity("quantity that stays constant. By default the one that pressed it."),
    ] = None
    rtol: Annotated[float, Ge(1e-6), Le(0.1), Quantity("relative tolerance of the time steps")] = 2e-3

    def check(self) -> None:
        """Refuse listed times beside a span, and times that do not increase."""
        super().check()
        for earlier, later in pairwise(self.times or []):
            if later <= earlier:
                got = f"{later:g} after {earlier:g}"
                raise self.wrong("times", expected="strictly increasing times", got=got)


class Friction(Section):
    """The shear strength that gives friction from the contact area; none by default."""

    section, makes = "friction", ShearStrength
    needs = tuple(
        (key, ("shear_strength",)) for key in sorted(keys_of_maker(ShearStrength)) if key != "shear_strength"
    )

    @property
    def strength(self) -> ShearStrength | None:
        """The shear strength, if there is one."""
        return cast(ShearStrength | None, self.made())


class Carried(Section):
    """Stiffness, resistances, stick and pull-off of the contact on a half-space, recorded at each time."""

    section, makes = "carried", CarriedQuantities


class Output(Section):
    """Maps, figures, and an instrument."""

    section = "output"
    needs = (("threshold", ("pixel", "blur")),)

    maps_at: Annotated[
        Sequence[_Time] | None,
        Quantity(
            "times at which the contact is stored and drawn. By default 0 and five others.", swept=False
        ),
    ] = None
    figures: Annotated[
        Sequence[Format] | None, Quantity('formats of the figures; "" for none', swept=False)
    ] = ("png",)
    measured: Annotated[
        str | None,
        Quantity(
            "table of a measured contact area, or fraction of the nominal area, against time, with units: "
            "the figure of the area shows it, and the ratio measured / computed.",
            swept=False,
        ),
    ] = None
    pixel: Annotated[
        _Size,
        Quantity("pixel of a microscope through which the maps are seen, or in sites.", "m", swept=False),
    ] = None
    blur: Annotated[
        _Size,
        Quantity("full width at half maximum of its point spread function, likewise.", "m", swept=False),
    ] = None
    threshold: Annotated[
        _Share,
        Quantity(
            "fraction of contact above which a pixel counts as contact. By default the fractions are added.",
            swept=False,
        ),
    ] = None

    @property
    def instrument(self) -> dict[str, Any]:
        """Arguments of `asperity.observe`; empty for none."""
        return {name: one for name, one in self.table.items() if name in ("pixel", "blur", "threshold")}

    def check(self) -> None:
        """Refuse a threshold without an instrument, and an instrument without maps."""
        super().check()
        if self.maps_at == [] and self.instrument:
            name = next(iter(self.instrument))
            raise self.wrong(name, expected="maps to look at", got="maps_at = []")


KINDS["surface"], KINDS["solid"] = {**SURFACES}, {**SOLIDS}
KINDS.update({one.section: {"": one} for one in (Contact, Aging, Friction, Carried, Output)})
ORDER = list(KINDS)
"""All sections, in the order in which they are written and shown."""


@dataclass(frozen=True)
class RunConfig:
    """What a file asks: sections, the legs of a history, and the keys of a question other than a run."""

    surface: SurfaceSection = field(default_factory=SURFACES["gaussian"])
    solid: SolidSection = field(default_factory=SOLIDS["spring_lattice"])
    contact: Contact = field(default_factory=Contact)
    aging: Aging = field(default_factory=Aging)
    protocol: tuple[Leg, ...] = ()
    friction: Friction = field(default_factory=Friction)
    carried: Carried = field(default_factory=Carried)
    output: Output = field(default_factory=Output)
    own: OwnKeys | None = None

    @classmethod
    def read(cls, tables: Mapping[str, Any]) -> RunConfig:
        """Make one of tables by section; `SectionError` with all mistakes."""
        mistakes: list[InputError] = []
        parts: dict[str, Any] = {}
        for name in sorted(tables, key=lambda name: ORDER.index(name) if name in ORDER else len(ORDER)):
            try:
                parts[name] = _part(name, tables[name], advised=len(mistakes) < SHOWN_PROBLEMS)
            except SectionError as error:
                mistakes += error.mistakes
            except InputError as error:
                mistakes.append(error)
        if mistakes:
            raise SectionError(mistakes)
        start = start_of(parts.get("protocol"))
        if start and not getattr(parts.get("contact"), "table", None):
            parts["contact"] = Contact(**start)
        asked = [parts.pop(name) for name in KINDS.keys() & parts.keys() if name not in ORDER]
        config = cls(**parts, own=asked[0] if asked else None)
        try:
            config.check()
        except InputError as error:
            raise SectionError([error]) from None
        return config

    def but(self, **changes: Any) -> RunConfig:
        """The same with other sections."""
        return replace(self, **changes)

    @property
    def asked(self) -> str:
        """The section of the question; empty for a run."""
        return self.own.section if self.own else ""

    @property
    def question(self) -> type[Question]:
        """What is asked."""
        return self.own.question if self.own else Question

    @property
    def remarks(self) -> tuple[str, ...]:
        """A remark on keys that were given and are not used, if there are any."""
        idle = [
            f"[{section}] {key}"
            for section, keys in self.question.unused.items()
            for part in [getattr(self, section)]
            for key, value in vars(part).items()
            if key in keys and key in part.stated and value is not None
        ]
        return (f"the {self.asked or 'run'} does not use {', '.join(idle)}",) if idle else ()

    @property
    def used(self) -> RunConfig:
        """The same with the defaults of keys that the question does not use, and files found from anywhere.

        The branches of a table take its place, unless its spread is used.
        """
        places = {name: str(without_links(expanded(file))) for name, file in self.files.items()}
        config = self.with_files(places)
        if "solid" in self.question.unused:
            config = config.but(solid=config.solid.resolved())
        for name, keys in self.question.unused.items():
            part = getattr(config, name)
            usual = {key: part.keys[key].default for key in keys if key in part.keys}
            config = config.but(**{name: part.but(**usual)})
        return config

    @property
    def files(self) -> dict[str, str]:
        """The files that it names, by their sections."""
        named = {section: getattr(getattr(self, section), key, None) for section, key in FILES.items()}
        return {section: name for section, name in named.items() if name is not None}

    def with_files(self, names: Mapping[str, str]) -> RunConfig:
        """The same with other names of files, by their sections."""
        parts = {section: getattr(self, section).but(**{FILES[section]: names[section]}) for section in names}
        return self.but(**parts)

    @property
    def parts(self) -> dict[str, Section]:
        """Its sections, with that of the question."""
        return {name: getattr(self, name) for name in ORDER} | ({self.asked: self.own} if self.own else {})

    @property
    def tables(self) -> dict[str, Any]:
        """Tables of its sections, without what is None."""
        tables = {name: part.table for name, part in self.parts.items()}
        legs = {"protocol": [described(leg) for leg in self.protocol]} if self.protocol else {}
        return tables | legs

    def check(self) -> None:
        """Refuse sections that contradict each other."""
        if self.protocol:
            self._check_protocol()
        elif self.aging.times is None and not self.span[0] < self.span[1]:
            first, last = self.span
            raise self.aging.wrong("last", expected=f"more than first, {first:g}", got=f"{last:g}")
        if self.contact.load == 0 and not (self.protocol and self.written_out[0].target):
            expected = "a protocol that begins with a ramp beside 0, such as 'ramp 1 load=...'"
            raise self.contact.wrong("load", expected=expected, got="none")
        self._check_known()
        self._check_refused()
        for home, key in ((self.aging, "times"), (self.output, "maps_at")):
            late = max(getattr(home, key) or [], default=-math.inf)
            if late > self.end * (1 + 1e-9):
                expected = f"times up to the last, {self.end:g}"
                raise home.wrong(key, expected=expected, got=f"{late:g}")
        self._check_loads()

    def _check_protocol(self) -> None:
        for key, expected in (
            ("last", "none beside a protocol, which says when it ends"),
            ("hold", "none beside a protocol, whose legs say what they hold"),
        ):
            value = getattr(self.aging, key)
            if key in self.aging.stated and value is not None:
                raise self.aging.wrong(key, expected=expected, got=shown(value))
        start, pressed = start_of(self.protocol), self.contact.table
        if start and pressed != start:
            key, value = next(iter(pressed.items()))
            expected = "none beside a measured history, which says where it begins"
            raise self.contact.wrong(key, expected=expected, got=shown(value))

    def _check_known(self) -> None:
        """Refuse times beyond the data of the solid."""
        if (known := self.solid.known) is None:
            return
        first = next((time for time in self.aging.times or [self.span[0]] if time > 0), known[0])
        early, late = first < known[0] * (1 - 1e-9), self.end > known[1] * (1 + 1e-9)
        if early or late:
            of_data = self.solid.data_last is not None
            key, origin, word = (
                ("data_last", "data", "model") if of_data else ("relaxation", "a table", "plateau")
            )
            expected = f"{origin} of the times to record, {first:g} to {self.end:g} s"
            cure = {"extrapolate": word} if of_data or not early else {}
            advice: Words = (Name("branches"),) if cure and not of_data else ""
            got = "{:g} to {:g} s".format(*known)
            raise self.solid.wrong(key, expected=expected, got=got, cure=cure, advice=advice)

    def _check_refused(self) -> None:
        """Refuse keys that contradict the question."""
        for (section, key), expected in self.question.refused.items():
            part = getattr(self, section)
            value = getattr(part, key) if key else [described(leg)["kind"] for leg in part]
            if value not in (None, [], "load"):
                path = (section, key) if key else (section,)
                advice = "asperity run, which takes the same file"
                raise InputError(path[-1], expected=expected, got=shown(value), advice=advice, path=path)
        if self.question.pressed and not any(self.contact.table.values()):
            raise self.contact.wrong("pressure", expected="a pressure or a load", got="neither")

    def _check_loads(self) -> None:
        """Refuse loads that pull at a solid without adhesion."""
        if "adhesion" in self.solid.laws:
            return
        pressing: list[tuple[tuple[str | int, ...], Any]] = []
        pressing += [(("contact", key), getattr(self.contact, key)) for key in ("load", "pressure")]
        pressing += [
            (("protocol", number, leg.target), leg.value(leg.duration, 0.0))
            for number, repeated in enumerate(self.protocol)
            for leg in repeated.written_out()
            if leg.target in ("load", "pressure")
        ]
        for path, load in pressing:
            if load is not None and (load < 0 or (load == 0 and path != ("contact", "load"))):
                recorded = bool(start_of(self.protocol))
                cure = {"adhesion": "dugdale"} if load and not recorded else {}
                advice = "loads less the one that is measured out of contact" if recorded else ""
                facts: Any = {"got": f"{load:g}", "cure": cure, "advice": advice}
                raise InputError(str(path[-1]), expected="more than 0", **facts, path=path)

    @property
    def written_out(self) -> list[Leg]:
        """The legs one by one, without repetitions."""
        return [one for leg in self.protocol for one in leg.written_out()]

    @property
    def span(self) -> tuple[float, float]:
        """First and last time to record, if not listed; with a protocol the first of each leg."""
        first, last = self.solid.span
        return self.aging.first or first, self.aging.last or last

    @property
    def carries(self) -> CarriedQuantities | None:
        """What to record besides load and area, if anything."""
        facts = {name: one for name, one in arguments_of(CarriedQuantities, self.carried).items() if one}
        poisson = getattr(self.solid, "poisson", None)
        ratios = {*poisson} if isinstance(poisson, list) else {poisson} - {None}
        if self.carried.stiffness and len(ratios) == 1:
            facts["poisson"] = ratios.pop()
        return CarriedQuantities(**facts) if facts else None

    @property
    def recorded(self) -> CarriedQuantities | None:
        """The same, with friction of a strength whose contacts age; that of others needs no history."""
        strength = self.friction.strength
        if strength is None or not strength.ages:
            return self.carries
        return replace(self.carries or CarriedQuantities(), strength=strength)

    @property
    def end(self) -> float:
        """The last time."""
        if not self.protocol:
            return self.span[1] if self.aging.times is None else self.aging.times[-1]
        return math.fsum(leg.duration for leg in self.written_out)


def _part(name: str, table: Any, *, advised: bool) -> Any:
    """A section of a configuration from its table, or the legs of its history."""
    if name == "protocol":
        return read_legs(table)
    if isinstance(table, Section):
        return table
    kinds = KINDS.get(name)
    if kinds is None or not isinstance(table, dict):
        raise _outside(name, table, advised=advised)
    if "" in kinds:
        return kinds[""](**table)
    try:
        chosen = kinds[choice("kind", kind_in(name, table), tuple(kinds))]
    except InputError as error:
        raise error.about("kind", name, "kind") from None
    return chosen(**{key: value for key, value in table.items() if key != "kind"})


def _outside(name: str, content: object, *, advised: bool) -> InputError:
    """The mistake of what is no section; advice takes milliseconds."""
    if name in KINDS:
        return InputError(name, expected=f"a section [{name}]", got=shown(content), path=(name,))
    if isinstance(content, dict):
        return unknown_key(name, KINDS if advised else (), (name,), said="no such section")
    below = f"; it belongs below [{home}]" if (home := home_of(name)) else ""
    return InputError(name, said=f"stands outside any section{below}")
