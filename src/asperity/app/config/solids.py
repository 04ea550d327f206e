"""The solids of a run: what each may be told, and the `asperity.solids.Solid` that it makes of it."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, cast, get_args

from pydantic import AfterValidator, BeforeValidator, Field, create_model, model_validator

from asperity.app.config.sections import (
    Branch,
    Constant,
    Energy,
    Modulus,
    OneOrTwo,
    Power,
    Pressure,
    Section,
    Size,
    Stiffness,
    Temperature,
    Velocity,
    Volume,
    any_of,
    by_kind,
    field_of,
    listed,
    usual,
)
from asperity.base.files import expanded
from asperity.base.parameters import parameters_of
from asperity.creep import LAWS, Eyring, LocalCreep
from asperity.errors import InputError

if TYPE_CHECKING:  # these need scipy, for which the help does not wait
    from asperity.relaxation import Fit, Material
    from asperity.solids import Solid

Poisson = Annotated[float, Field(gt=-1, le=0.5)]
OnePoisson = Annotated[list[Poisson], Field(min_length=1, max_length=1), BeforeValidator(listed)]
Plateau = Literal["plateau"]
TableModulus = Literal["young", "shear", "contact"]
Words = Annotated[list[str], BeforeValidator(lambda value: _as_words(listed(value)))]
PerDecade = Annotated[float, Field(ge=0.2, le=10)]
POISSON = 0.35
"""Poisson's ratio of a prediction to which none is given."""
_APPARATUS = "Stiffness of the apparatus that holds it, which may be inf; with it a separation can be held."
_HARDNESS = "Pressure under which the rough surface yields; on the lattice of springs, force of a site."
_SPAN = (1e-3, 1e6)
"""First and last time to record where the solid suggests none."""

OF_TABLES = {"kind": "table_kind", "modulus": "table_modulus"} | {
    name: name for name in ("columns", "units", "noise", "per_decade", "extrapolate")
}
"""Keys about a relaxation table, by the arguments of `asperity.relaxation.material`."""

_BEYOND = 10.0
"""How far the recorded times go beyond the relaxation times on either side."""


def _as_words(value: object) -> object:
    return (
        [str(word) if isinstance(word, int) else word for word in value] if isinstance(value, list) else value
    )


def _shares(branches: list[Branch]) -> list[Branch]:
    if (total := sum(share for share, _ in branches)) > 1 + 1e-12:
        raise ValueError(f"expected shares of at most 1 in sum, got {total:.6g}")
    return branches


Branches = Annotated[list[Branch], AfterValidator(_shares)]
"""Shares of the modulus that relax, and their times."""


class SolidSection(Section):
    """A solid, of one kind or another."""

    kind: str

    @property
    def span(self) -> tuple[float, float]:
        """First and last time to record where none is given."""
        return _SPAN

    @property
    def known(self) -> tuple[float, float] | None:
        """First and last time of which the solid is known, where that is limited."""
        return None

    @property
    def assumed(self) -> str:
        """What is assumed of the solid beyond what is known; empty where nothing is."""
        return ""

    @property
    def unused(self) -> str:
        """What a run does not use; empty where it uses all."""
        return ""

    def resolved(self) -> Self:
        """The same solid without files: with the numbers that they give."""
        return self

    @property
    def numbers(self) -> dict[str, Any]:
        """Arguments that are not keys of the same name and value."""
        return {}

    @property
    def given(self) -> dict[str, Any]:
        """What the function of `asperity.solids` that makes it takes, without what is not given."""
        made = self.numbers
        told = {name: made.get(name, getattr(self, name, None)) for name in signature(self.make).parameters}
        return {name: value for name, value in told.items() if value is not None}

    @property
    def make(self) -> Callable[..., Solid]:
        """The function that makes it, which is called like its kind."""
        import asperity.solids as solids

        made: Callable[..., Solid] = getattr(solids, self.kind)
        return made

    def build(self) -> Solid:
        """Make the solid."""
        return self.make(**self.given)


def _kept(share: float) -> float:
    from asperity.solids.continua import checked_permanent

    try:
        return checked_permanent(share)
    except InputError as error:
        raise ValueError(f"expected {error.expected}, got {error.got}") from None


def _listed(keys: set[str]) -> str:
    """Keys for a message, marked, so that where they came as flags it can name these."""
    return ", ".join(f"`{key}`" for key in sorted(keys))


FORMULAS = any_of(f"{name}, {law.formula}" for name, law in LAWS.items())
"""Laws of creep in words."""

KEYS_OF_LAWS: dict[str, list[set[str]]] = {
    name: [{f"creep_{of}" for of in parameters_of(law)}] for name, law in LAWS.items()
}
KEYS_OF_LAWS["eyring"].append({"creep_energy", "creep_volume", "creep_prefactor", "temperature"})
"""Keys that state each law of creep, in one way or another."""

ACTIVATION = KEYS_OF_LAWS["eyring"][-1]
OF_LAWS = {key for ways in KEYS_OF_LAWS.values() for way in ways for key in way}
"""Keys of local laws of creep."""

PREDICTED = {*OF_LAWS, *OF_TABLES.values(), "young", "poisson", "branches", "creep", "permanent", "hardness"}
"""Keys of a half-space that a prediction takes as flags."""

if TYPE_CHECKING:

    class _OfLaws(SolidSection):
        creep: str | None = None

else:  # keys of all laws
    _OfLaws = create_model(
        "_OfLaws",
        __base__=SolidSection,
        creep=(
            Annotated[
                Literal[(*LAWS, "none")] | None, AfterValidator(lambda word: None if word == "none" else word)
            ],
            usual(
                None,
                f"Local law of creep: {FORMULAS}; s is the pressure, "
                "or on the lattice of springs the force of a spring to the bulk.",
            ),
        ),
        **{
            f"creep_{name}": field_of(parameter.optional)
            for law in LAWS.values()
            for name, parameter in parameters_of(law).items()
        },
    )


class Creeping(_OfLaws):
    """A solid that may creep by a local law."""

    @model_validator(mode="after")
    def _one_law(self) -> Self:
        given = {name for name in OF_LAWS if getattr(self, name, None) is not None}
        told = _listed(given) or "none"
        if self.creep is None and given:
            laws = [name for name, ways in KEYS_OF_LAWS.items() if given <= set().union(*ways)]
            drop = told if getattr(self, "permanent", None) is None else f"{told}, `permanent`"
            advice = f"; try to drop {drop}" if "creep" in self.model_fields_set else ""
            raise ValueError(f"creep: expected {any_of(laws or LAWS)} beside {told}, got none{advice}")
        ways = [way for way in KEYS_OF_LAWS.get(self.creep or "", []) if way <= set(type(self).model_fields)]
        if self.creep is not None and given not in ways:
            expected = " or ".join(map(_listed, ways))
            raise ValueError(f"creep: expected {expected} beside {self.creep}, got {told}")
        return self

    @property
    def law(self) -> LocalCreep | None:
        """The local law of creep."""
        if self.creep is None:
            return None
        law = LAWS[self.creep]
        return law(**{name: getattr(self, f"creep_{name}") for name in parameters_of(law)})


class SpringLattice(Creeping):
    """The lattice of springs; see `asperity.solids.spring_lattice`."""

    kind: Literal["spring_lattice"] = "spring_lattice"
    k0: Constant = usual(1.0, "Stiffness of the springs between neighbors.")
    k1: Annotated[float, Field(gt=0, le=1e30)] = usual(3.0, "Stiffness of the springs to the bulk.")
    R: Constant = usual(1.0, "Mobility of creep that conserves the mean.")
    R_viscous: Constant = usual(0.0, "Mobility of viscous creep.")
    hardness: Pressure | None = usual(None, _HARDNESS)

    @property
    def numbers(self) -> dict[str, Any]:
        """See `SolidSection`."""
        return {"creep": self.law}


class Continuum(SolidSection):
    """A solid with a modulus and with branches that relax."""

    not_beside_a_modulus: ClassVar[tuple[str, ...]] = ()

    modulus: Modulus | None = usual(None, "Contact modulus E* at once, before anything relaxes.")
    young: OneOrTwo[Modulus] | None = usual(
        None, "Young's modulus at once, in place of the contact modulus; of two bodies both."
    )
    poisson: OneOrTwo[Poisson] | None = usual(None, "Poisson's ratio, of two bodies both.")
    branches: Branches = usual(
        [], "A share of the modulus and the time in which it relaxes; as often as there are such."
    )
    relaxation: str | None = usual(
        None,
        "Table of a relaxation modulus, a creep compliance, or storage and loss moduli, "
        "that gives the branches; and Young's modulus, where no modulus is given.",
    )
    table_kind: Literal["relaxation", "creep", "dynamic"] | None = usual(
        None, "What that table holds, if the names of its columns do not say."
    )
    table_modulus: TableModulus | None = usual(
        None, "Which modulus it measures. By default what its names say, else Young's modulus."
    )
    columns: Words | None = usual(
        None,
        "Names or numbers, from 0, of its columns: time and modulus, time and compliance, or frequency, "
        "storage and loss modulus. By default those that are named so.",
    )
    units: Words | None = usual(
        None, 'Units of its columns in place of those of the table: a column and its unit, such as "E=MPa".'
    )
    noise: Annotated[float, Field(ge=0, lt=1)] | None = usual(
        None, "Largest relative change in the wrong direction that is taken for noise of it. By default 0.05."
    )
    per_decade: PerDecade | None = usual(
        None,
        "Relaxation times in each decade of that table: more of them for data with few distinct "
        "times, fewer for noisy data. By default the fewest free times whose misfit looks like noise, "
        "five at most, else 1 or 2 a decade.",
    )
    extrapolate: Plateau | None = usual(
        None,
        "What is assumed beyond the last time of that table: plateau, that the last modulus "
        "stays. By default later times are refused.",
    )

    @model_validator(mode="before")
    @classmethod
    def _modulus_of_table(cls, keys: Any) -> Any:
        """Take the word shear, young or contact as modulus for what the table measures."""
        if isinstance(keys, dict) and keys.get("modulus") in get_args(TableModulus):
            return {**keys, "table_modulus": keys["modulus"], "modulus": None}
        return keys

    @model_validator(mode="after")
    def _one_modulus(self) -> Self:
        given = [name for name in ("modulus", "young") if getattr(self, name) is not None]
        if len(given) == 2:
            raise ValueError("expected modulus or young, got both")
        if not given and self.relaxation is None:
            raise ValueError("expected modulus, young and poisson, or relaxation and poisson, got none")
        bodies, ratios = len(self.young or [1]), len(self.poisson or [])
        others = [key for key in OF_TABLES.values() if getattr(self, key) is not None]
        if self.relaxation is None and others:
            raise ValueError(f"{others[0]}: expected relaxation beside it, got none")
        if self.modulus is None and self.table_modulus != "contact" and bodies != ratios:
            advice = f"try poisson = {[POISSON] * bodies if bodies > 1 else POISSON}"
            raise ValueError(f"poisson: expected one for each of {bodies} in young, got {ratios}; {advice}")
        if self.relaxation is not None:
            if self.branches:
                raise ValueError("expected branches or relaxation, got both")
            if bodies > 1:
                raise ValueError("relaxation: expected one body beside it, got two; try asperity.relaxation")
            try:
                _ = self.fit
            except InputError as error:
                asked = error.name if error.name in OF_TABLES.values() else "relaxation"
                raise ValueError(f"{asked}: {error}") from None
        return self

    @property
    def of_table(self) -> Material | None:
        """What the table gives, and what it is taken for."""
        if self.relaxation is None:
            return None
        path = expanded(self.relaxation)
        changed = path.stat().st_mtime_ns if path.exists() else 0
        how = {name: getattr(self, key) for name, key in OF_TABLES.items()}
        how |= {"modulus": self.modulus or self.table_modulus}
        how |= {name: value[0] for name in ("young", "poisson") if (value := getattr(self, name))}
        asked = ((name, tuple(one) if isinstance(one, list) else one) for name, one in how.items())
        return _material(path, tuple((name, one) for name, one in asked if one is not None), changed)

    @property
    def fit(self) -> Fit | None:
        """The table, fitted."""
        return None if (made := self.of_table) is None else made.fit

    @property
    def assumed(self) -> str:
        """What is assumed beyond the table."""
        return "" if self.fit is None else self.fit.assumed

    @property
    def maxwell(self) -> list[Branch]:
        """Shares and relaxation times of all branches."""
        return self.branches if (fit := self.fit) is None else list(fit.series.branches)

    @property
    def contact_modulus(self) -> float:
        """Contact modulus at once."""
        from asperity.solids import contact_modulus

        if self.modulus is not None:
            return self.modulus
        if (made := self.of_table) is not None:
            return cast(float, made.solid.modulus)
        return contact_modulus(self.young or [], self.poisson or [])

    @property
    def numbers(self) -> dict[str, Any]:
        """See `SolidSection`; of the solids that have one ratio, that."""
        told = {"modulus": self.contact_modulus, "young": None, "branches": self.maxwell or None}
        return {**told, "poisson": next(iter(self.poisson or []), None)}

    @property
    def span(self) -> tuple[float, float]:
        """From a tenth of the shortest relaxation time to ten times the longest; of a table, its times."""
        if self.fit is not None:
            return self.fit.data.span
        times = self.times
        return (min(times) / _BEYOND, max(times) * _BEYOND) if times else _SPAN

    @property
    def times(self) -> list[float]:
        """Relaxation times."""
        return [time for share, time in self.maxwell if share > 0]

    @property
    def known(self) -> tuple[float, float] | None:
        """First and last time that a table knows of, or that are assumed beyond it; None without."""
        return None if (fit := self.fit) is None else fit.series.span

    def resolved(self) -> Self:
        """The same solid with the branches and the modulus that a table gives."""
        if self.relaxation is None:
            return self
        numbers: dict[str, object] = dict.fromkeys(("relaxation", *OF_TABLES.values()))
        numbers["branches"] = self.maxwell
        if self.modulus is None and self.young is None:
            numbers |= {"modulus": self.contact_modulus} | dict.fromkeys(self.not_beside_a_modulus)
        return self.model_copy(update=numbers)


class HalfSpace(Creeping, Continuum):
    """A half-space; see `asperity.solids.half_space`."""

    not_beside_a_modulus: ClassVar[tuple[str, ...]] = ("poisson",)

    kind: Literal["half_space"] = "half_space"
    draws: Annotated[list[Branches], Field(min_length=2)] | None = Field(
        default=None,
        exclude=True,  # no run uses them, and what was not used is not recorded
        description="Lists of branches that may be in place of these, such as draws of a posterior: their "
        "spread is in the band of a prediction.",
    )
    flow: Power | None = usual(
        None,
        "In place of branches: mobility of creep, and the power of the wave number with which "
        "it goes (-1 bulk flow, 0 dissolution, 1 and 2 diffusion in the volume and along the surface).",
    )
    creep_energy: Energy | None = usual(
        None,
        "Energy of activation Q; with the next three it gives Eyring's v0 = prefactor "
        "exp(-Q/kT) and s0 = kT/volume.",
    )
    creep_volume: Volume | None = usual(None, "Volume of activation.")
    creep_prefactor: Velocity | None = usual(None, "Velocity v0 far above Q = kT.")
    temperature: Temperature | None = usual(None, "Temperature of thermally activated creep.")
    permanent: Annotated[float, Field(ge=0, le=0.99), AfterValidator(_kept)] | None = usual(
        None, "Share of the modulus that does not creep by the local law. By default 0."
    )
    apparatus: Stiffness | None = usual(None, _APPARATUS)
    hardness: Pressure | None = usual(None, _HARDNESS)

    @property
    def law(self) -> LocalCreep | None:
        """The local law of creep, from numbers or from its activation."""
        if self.temperature is None:
            return super().law
        facts = {name: getattr(self, f"creep_{name}") for name in ("energy", "volume", "prefactor")}
        return Eyring.activated(**facts, temperature=self.temperature)

    @model_validator(mode="after")
    def _one_creep(self) -> Self:
        if self.modulus is not None and self.poisson is not None:
            raise ValueError("poisson: expected none beside the contact modulus, which holds it; try young")
        if self.flow is not None and (self.branches or self.relaxation is not None):
            raise ValueError("expected branches or flow, got both")
        if self.permanent and self.creep is None:
            raise ValueError(
                "permanent: expected a local law of creep beside it, got none; of branches it is the rest; "
                "try to drop permanent"
            )
        if self.creep is not None and (self.branches or self.relaxation is not None or self.flow is not None):
            raise ValueError("expected branches, flow or creep, got two of them")
        if self.draws is not None and not self.branches:
            others = (name for name in ("relaxation", "flow", "creep") if getattr(self, name) is not None)
            raise ValueError(f"draws: expected branches beside it, got {next(others, 'none')}")
        return self

    @property
    def material(self) -> Material:
        """What a prediction is of."""
        from asperity.relaxation import material

        table, solid = self.of_table, self.build()
        return material(solid, draws=self.draws) if table is None else replace(table, solid=solid)

    @property
    def unused(self) -> str:
        """See `SolidSection`."""
        return "" if self.draws is None else "a run does not use [solid] draws; asperity predict does"

    @property
    def numbers(self) -> dict[str, Any]:
        """See `SolidSection`."""
        return {**super().numbers, "poisson": None, "permanent": self.permanent or None, "creep": self.law}


_BESIDE: dict[str, Any] = {
    name: (field.annotation, field)
    for name, field in HalfSpace.model_fields.items()
    if name in (*OF_TABLES.values(), "hardness", "temperature")
}
BesideTable = create_model(
    "BesideTable",
    __base__=Section,
    poisson=(OnePoisson | None, None),
    modulus=(TableModulus | None, None),
    **_BESIDE,
)
"""Keys of a half-space that a prediction takes beside a relaxation table."""


class Layer(Continuum):
    """A layer on a rigid base; see `asperity.solids.layer`."""

    kind: Literal["layer"] = "layer"
    poisson: OnePoisson = Field(description="Poisson's ratio.")
    thickness: Size = Field(description="Thickness of the layer or the film.")
    frictionless: bool = usual(
        False, "The layer slides on its base without friction; else it is bonded to it."
    )
    hardness: Pressure | None = usual(None, _HARDNESS)

    @property
    def numbers(self) -> dict[str, Any]:
        """See `SolidSection`."""
        return {**super().numbers, "bonded": False if self.frictionless else None}


class CoatedHalfSpace(Continuum):
    """A film on a half-space of another material; see `asperity.solids.coated_half_space`."""

    kind: Literal["coated_half_space"] = "coated_half_space"
    poisson: OnePoisson = Field(description="Poisson's ratio.")
    thickness: Size = Field(description="Thickness of the layer or the film.")
    base_modulus: Modulus = Field(description="Contact modulus of the base at once.")
    base_poisson: Poisson = Field(description="Poisson's ratio of the base.")
    base_branches: Branches = usual([], "A share of the modulus of the base and its relaxation time.")
    apparatus: Stiffness | None = usual(None, _APPARATUS)
    hardness: Pressure | None = usual(None, _HARDNESS)

    @property
    def times(self) -> list[float]:
        """Relaxation times of film and base."""
        return [*super().times, *(time for share, time in self.base_branches if share > 0)]

    @property
    def numbers(self) -> dict[str, Any]:
        """See `SolidSection`."""
        return {**super().numbers, "base_branches": self.base_branches or None}


SOLIDS = by_kind(SpringLattice, HalfSpace, Layer, CoatedHalfSpace)
AnySolid = Annotated[SpringLattice | HalfSpace | Layer | CoatedHalfSpace, Field(discriminator="kind")]


@functools.lru_cache(maxsize=8)
def _material(path: Path, how: tuple[tuple[str, Any], ...], changed: int) -> Material:
    """What a table gives; ``changed`` tells one state of the file from another."""
    from asperity.relaxation import material

    del changed
    return material(path, **dict(how))
