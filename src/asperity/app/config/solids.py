"""The solids of a run: sections made from the functions of `asperity.solids`."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, cast, get_args

from pydantic import BeforeValidator, Field, model_validator

from asperity.app.config.creep import ACTIVATED, ACTIVATION, KEYS, KEYS_OF_LAWS, OF_LAWS, marked
from asperity.app.config.sections import (
    Duration,
    InUnit,
    Section,
    Temperature,
    any_of,
    arguments_of,
    field_of,
    key_of,
    keys_of_maker,
    listed,
    made,
    sentence,
    usual,
)
from asperity.base.files import expanded
from asperity.base.parameters import Law, parameters_of
from asperity.creep import Eyring
from asperity.errors import LARGEST, InputError
from asperity.solids import KINDS, LAWS, Solid
from asperity.solids.arguments import POISSON, Branches

if TYPE_CHECKING:
    from asperity.relaxation import Fit, Material

Beyond = Literal["plateau", "model"]
TableModulus = Literal["young", "shear", "contact"]
Words = Annotated[list[str], BeforeValidator(lambda value: _as_words(listed(value)))]
PerDecade = Annotated[float, Field(ge=0.2, le=10)]
_SPAN = (1e-3, 1e6)
"""First and last time to record where the solid suggests none."""

_BEYOND = 10.0
"""How far the recorded times go beyond the relaxation times on either side."""


def _as_words(value: object) -> object:
    return (
        [str(word) if isinstance(word, int) else word for word in value] if isinstance(value, list) else value
    )


class OfTable(Section):
    """Keys about the data of the branches of a solid, which a relaxation table may give."""

    relaxation: str | None = usual(
        None,
        "Table of relaxation modulus, creep compliance, or storage and loss moduli, which "
        "gives the branches; and Young's modulus, if no modulus is given.",
    )
    table_kind: Literal["relaxation", "creep", "dynamic"] | None = usual(
        None, "Quantity in the table, if the names of its columns do not say it."
    )
    table_modulus: TableModulus | None = usual(
        None, "Modulus in the table. By default the one that its header names, else Young's modulus."
    )
    columns: Words | None = usual(
        None,
        "Columns by name, or by number from 0: time and modulus, time and compliance, or frequency, storage "
        "and loss modulus. By default those with such names.",
    )
    units: Words | None = usual(
        None, 'Units in place of those of the table: a column and its unit, such as "E=MPa".'
    )
    noise: Annotated[float, Field(ge=0, lt=1)] | None = usual(
        None, "Largest relative change in the wrong direction that counts as noise. By default 0.05."
    )
    per_decade: PerDecade | None = usual(
        None,
        "Relaxation times per decade of the table; fewer for noisy data. By default as few "
        "free times as fit within the noise, five at most, else 1 or 2 per decade.",
    )
    extrapolate: Beyond | None = usual(
        None,
        "Assumption beyond the times of the data. plateau: the modulus keeps the last value of the table. "
        "model: the branches continue. By default other times are refused.",
    )
    free_branches: Annotated[int, Field(ge=1)] | None = usual(
        None,
        "Number of free relaxation times in the fit of the table. By default the fewest whose misfit looks "
        "like noise, five at most; else 1 or 2 per decade.",
    )
    temperature: Temperature | None = usual(
        None,
        "Temperature of the contact, such as 40degC: for activated creep, or to shift a relaxation table "
        "from its own.",
    )
    reference: Temperature | None = usual(None, "Temperature of the table, such as 20degC.")
    activation_energy: Annotated[float, Field(gt=0, le=LARGEST), InUnit("J/mol")] | None = usual(
        None, "Activation energy of the relaxation times (Arrhenius), such as 100kJ/mol."
    )
    wlf: list[float] | None = usual(
        None,
        "In its place C1 and C2 of Williams, Landel and Ferry, for the decimal logarithm; C2 in K.",
    )
    data_first: Duration | None = usual(
        None, "First time of the data of the branches; earlier times need extrapolate = model."
    )
    data_last: Duration | None = usual(
        None, "Last time of the data of the branches; later times need extrapolate = model."
    )


_RENAMED = {"kind": "table_kind", "modulus": "table_modulus", "branches": "free_branches"}
_OTHERS = {*_RENAMED.values(), "relaxation", "data_first", "data_last"}
OF_TABLES = _RENAMED | {name: name for name in OfTable.model_fields if name not in _OTHERS}
"""Keys about a relaxation table, by the arguments of `asperity.relaxation.material`."""


class SolidSection(Section):
    """A solid, of one kind or another."""

    kind: str

    @property
    def make(self) -> Callable[..., Solid]:
        """The function of `asperity.solids` that makes it."""
        return KINDS[self.kind]

    @property
    def given(self) -> dict[str, Any]:
        """Arguments of `make`, as far as they are given."""
        return arguments_of(self.make, self) | self.laws

    def build(self) -> Solid:
        """Make the solid."""
        return self.make(**self.given)

    @property
    def laws(self) -> dict[str, Law]:
        """The local law of creep, from numbers or from its activation, and the law of adhesion, if any."""
        facts = {key: value for key, value in self if value is not None}
        laws: dict[str, Law] = {}
        for kind in filter(facts.__contains__, LAWS):
            law = LAWS[kind][facts[kind]]
            if kind == "creep" and "temperature" in facts:
                activation = {key.removeprefix("creep_"): facts[key] for key in ACTIVATION}
                laws[kind] = Eyring.activated(**activation)
            else:
                laws[kind] = law(**{name: facts[f"{kind}_{name}"] for name in parameters_of(law)})
        return laws

    @model_validator(mode="after")
    def _possible(self) -> Self:
        self.check()
        try:
            self.build()
        except InputError as error:
            raise ValueError(sentence(error)) from None
        return self

    def check(self) -> None:
        """Refuse keys of a law that are not those of one law, with `ValueError`."""
        keys = type(self).model_fields
        for kind, kinds in KEYS_OF_LAWS.items():
            law = getattr(self, kind, None)
            stated = {name for name in OF_LAWS[kind] if getattr(self, name, None) is not None}
            if law is None and getattr(self, "relaxation", None) is not None:
                stated.discard("temperature")  # that of the table
            named = marked(stated) or "none"
            ways = [way for way in kinds.get(law or "", []) if way <= keys.keys()]
            if law is None and stated:
                laws = [name for name, ways in kinds.items() if stated <= set().union(*ways)]
                drop = named if getattr(self, "permanent", None) is None else f"{named}, `permanent`"
                advice = f"; try to drop {drop}" if kind in self.model_fields_set else ""
                raise ValueError(f"{kind}: expected {any_of(laws or kinds)} beside {named}, got none{advice}")
            if law is not None and stated not in ways:
                raise ValueError(
                    f"{kind}: expected {' or '.join(map(marked, ways))} beside {law}, got {named}"
                )

    @property
    def span(self) -> tuple[float, float]:
        """First and last time to record where none is given."""
        return _SPAN

    @property
    def known(self) -> tuple[float, float] | None:
        """First and last time of the data of the solid, if they are limited."""
        return None

    @property
    def assumed(self) -> str:
        """Assumption beyond the data; empty for none."""
        return ""

    def resolved(self) -> Self:
        """The same solid without files: with the numbers that they give."""
        return self


class Continuum(SolidSection):
    """A solid with a modulus, and perhaps with branches that relax, which a table may give."""

    if TYPE_CHECKING:
        modulus: float | None
        young: list[float] | float | None
        poisson: list[float] | float | None
        branches: list[tuple[float, float]]
        relaxation: str | None
        extrapolate: Beyond | None
        data_first: float | None
        data_last: float | None

    @model_validator(mode="before")
    @classmethod
    def _modulus_of_table(cls, keys: Any) -> Any:
        """Read shear, young or contact as kind of the modulus in the table; set the usual Poisson's ratio."""
        if not cls.model_fields["poisson"].is_required() and isinstance(keys, dict):
            bodies = listed(keys.get("young") or keys.get("relaxation"))
            lacks = keys.get("poisson") is None and keys.get("modulus") in (None, "young", "shear")
            if lacks and isinstance(bodies, list) and keys.get("table_modulus") != "contact":
                keys = {**keys, "poisson": [POISSON] * len(bodies)}
        if isinstance(keys, dict) and keys.get("modulus") in get_args(TableModulus):
            return {**keys, "table_modulus": keys["modulus"], "modulus": None}
        return keys

    def check(self) -> None:
        """Refuse branches and a table, and keys of a table or of branches without, with `ValueError`."""
        if self.table is not None:
            for key in ("branches", "creep"):
                if getattr(self, key, None):
                    expected = "none beside a relaxation table, which is that of a linear solid"
                    raise ValueError(f"{key}: expected {expected}, got both; try `young` in its place")
        super().check()
        for key in ("draws", "data_first", "data_last"):
            if getattr(self, key, None) is not None and not self.branches:
                names = ("relaxation", "flow", "creep")
                others = (name for name in names if getattr(self, name, None) is not None)
                raise ValueError(f"{key}: expected branches beside it, got {next(others, 'none')}")
        if self.table is None:
            if self.modulus is None and self.young is None:
                expected = "modulus, young and poisson, or relaxation and poisson"
                raise ValueError(f"expected {expected}, got none; try `young`")
            of_branches = self.extrapolate == "model"
            if of_branches and self.data_last is None:
                raise ValueError("extrapolate: expected data_last beside model, got none")
            lacking = [key for key in OF_TABLES.values() if getattr(self, key) is not None]
            if getattr(self, "creep", None) is not None:
                lacking = [key for key in lacking if key != "temperature"]
            if lacking and not of_branches:
                of_data = lacking == ["extrapolate"] and self.data_last is not None
                advice = '; try extrapolate = "model" (--extrapolate model)' if of_data else ""
                raise ValueError(f"{lacking[0]}: expected relaxation beside it, got none{advice}")
            return
        if len(listed(self.young) or []) > 1:  # type: ignore[arg-type]
            raise ValueError("relaxation: expected one body beside it, got two; try asperity.relaxation")
        try:
            _ = self.of_table
        except InputError as error:
            of = (OF_TABLES | {"modulus": "modulus"}).get(error.name, f"relaxation: {error.name}")
            raise ValueError(sentence(error.about(of))) from None

    @property
    def table(self) -> Path | None:
        """The file of the relaxation, if there is one."""
        return None if self.relaxation is None else expanded(self.relaxation)

    @property
    def of_table(self) -> Material | None:
        """The material of the table."""
        if (path := self.table) is None:
            return None
        changed = path.stat().st_mtime_ns if path.exists() else 0
        how = {name: getattr(self, key) for name, key in OF_TABLES.items()}
        how |= {"modulus": self.modulus or how["modulus"]}
        how |= {name: one for name, one in self._of_one_body.items() if one is not None}
        asked = ((name, tuple(one) if isinstance(one, list) else one) for name, one in how.items())
        return _material(path, tuple((name, one) for name, one in asked if one is not None), changed)

    @property
    def _of_one_body(self) -> dict[str, float | None]:
        elastic = {"young": self.young, "poisson": self.poisson}
        return {name: one[0] if isinstance(one, list) else one for name, one in elastic.items()}

    @property
    def fit(self) -> Fit | None:
        """The table, fitted."""
        return None if (material := self.of_table) is None else material.fit

    @property
    def _of_table(self) -> dict[str, Any]:
        """Arguments that the table gives: branches, and a modulus where no other is given."""
        if (material := self.of_table) is None or material.fit is None:
            return {}
        facts: dict[str, Any] = {"branches": list(material.fit.series.branches)}
        if self.modulus is not None or self.young is not None:
            return facts
        modulus, ratio = material.fit.series.modulus, self._of_one_body["poisson"]
        if ratio is None:
            return facts | {"modulus": modulus}
        factors = {"shear": 2 * (1 + ratio), "contact": 1 - ratio**2}
        return facts | {"young": modulus * factors.get(str(material.facts["measured"]), 1)}

    @property
    def given(self) -> dict[str, Any]:
        """See `SolidSection`."""
        return super().given | self._of_table

    @property
    def of_data(self) -> tuple[float, float] | None:
        """First and last time of the data that gave the branches."""
        return None if self.data_last is None else (self.data_first or 0.0, self.data_last)

    @property
    def assumed(self) -> str:
        """Assumption beyond the table, or beyond the data of the branches."""
        if self.of_data is not None and self.extrapolate == "model":
            return "beyond the data, {:g} to {:g} s, the branches are assumed to go on".format(*self.of_data)
        return "" if self.fit is None else self.fit.assumed

    @property
    def maxwell(self) -> list[tuple[float, float]]:
        """Shares and relaxation times of all branches."""
        return cast(list[tuple[float, float]], self._of_table.get("branches", self.branches))

    @property
    def span(self) -> tuple[float, float]:
        """The times of the data; else a tenth of the shortest relaxation time and ten times the longest."""
        if self.of_data and self.of_data[0]:
            return self.of_data
        if self.fit is not None:
            return self.fit.data.span
        times = [time for _, time in (*self.maxwell, *getattr(self, "base_branches", []))]
        return (min(times) / _BEYOND, max(times) * _BEYOND) if times else _SPAN

    @property
    def known(self) -> tuple[float, float] | None:
        """First and last time of the data of table or branches, or assumed beyond them; None without."""
        if self.fit is not None:
            return self.fit.series.span
        return None if self.extrapolate == "model" else self.of_data

    def resolved(self) -> Self:
        """The same solid with the branches and the modulus that a table gives."""
        if self.table is None:
            return self
        facts = self.model_dump(exclude_none=True, exclude=set(OfTable.model_fields))
        if math.isfinite((span := cast(Any, self.known))[1]):
            facts |= dict(zip(("data_first", "data_last"), span, strict=True))
        return type(self).model_validate(facts | self._of_table)


def _section_of(kind: str) -> type[SolidSection]:
    """The section of a kind, with the arguments of the function as keys, and keys that give some of these."""
    make = KINDS[kind]
    base: type[SolidSection] = SolidSection
    keys = keys_of_maker(make)
    for law in filter(signature(make).parameters.__contains__, LAWS):
        keys |= KEYS[law]
    if "modulus" in keys:  # activation gives a stress in Pa
        keys |= {name: field_of(one) for name, one in ACTIVATED.items() if "creep" in keys}
    if keys.keys() >= {"young", "branches"}:  # which a table gives
        base = Continuum
        keys |= {name: (field.annotation, field) for name, field in OfTable.model_fields.items()}
    return made(f"{kind.title().replace('_', '')}Solid", __name__, base, kind, keys)


_Branches: Any = key_of(Branches)


class HalfSpace(_section_of("half_space")):  # type: ignore[misc]
    """A half-space; see `asperity.solids.half_space`."""

    draws: Annotated[list[_Branches], Field(min_length=2)] | None = Field(
        default=None,
        exclude=True,  # no run uses them, and what was not used is not recorded
        description="Other lists of branches, such as samples of a posterior: their spread is in the band "
        "of a prediction.",
    )

    @property
    def material(self) -> Material:
        """The material of a prediction."""
        from asperity.relaxation import material

        table: Material | None = self.of_table
        if table is not None:
            return replace(table, solid=self.build())
        return replace(material(self.build(), draws=self.draws), span=self.known or (0.0, math.inf))


SOLIDS: dict[str, type[SolidSection]] = {
    kind: HalfSpace if kind == "half_space" else _section_of(kind) for kind in KINDS
}


@functools.lru_cache(maxsize=8)
def _material(path: Path, how: tuple[tuple[str, Any], ...], changed: int) -> Material:
    """The material of a table, cached by the time of its last change."""
    from asperity.relaxation import material

    del changed
    return material(path, **dict(how))
