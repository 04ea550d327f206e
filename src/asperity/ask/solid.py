"""The solids of a run: sections made from the functions of `asperity.solids`."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import Annotated, Any, Literal, Self, cast, get_args

from annotated_types import Gt, Le, Len

from asperity.ask.laws import ACTIVATED, KEYS, KEYS_OF_LAWS, OF_LAWS
from asperity.ask.section import Keys, Section, arguments_of, keys_of_maker
from asperity.base.calls import outside
from asperity.base.checks import any_of
from asperity.base.files import expanded
from asperity.base.parameters import Law, Quantity, check_needs, parameters_of
from asperity.creep import Eyring
from asperity.errors import InputError, Name, Words, named
from asperity.relaxation import Fit, Material, material
from asperity.solids import KINDS, LAWS, Solid
from asperity.solids.arguments import POISSON, Branches

MAKERS: dict[str, Callable[..., Solid]] = KINDS | {
    name: make for name, make in outside("asperity.solids") if name not in KINDS
}
"""What makes solids, by kind, also those of other distributions."""

_SPAN = (1e-3, 1e6)
"""First and last time to record where the solid suggests none."""

_BEYOND = 10.0
"""How far the recorded times go beyond the relaxation times on either side."""

TableModulus = Literal["young", "shear", "contact"]
_OF_BRANCHES = "{} time of the data that gave the branches; {} times need extrapolate = model."

OF_TABLES = {name: one.quantity.key or name for name, one in parameters_of(material).items()}
"""Keys about a relaxation table, by the arguments of `asperity.relaxation.material`."""

_Moment = Annotated[float | None, Gt(0), Le(1e30)]


class _Data:
    relaxation: Annotated[
        str | None,
        Quantity(
            "table of the relaxation: modulus, creep compliance, or storage and loss moduli against time or "
            "frequency. It gives the branches; and Young's modulus, if no modulus is given.",
            swept=False,
        ),
    ] = None
    table_modulus: Annotated[
        TableModulus | None,
        Quantity(
            "modulus in the table. By default the one that its header names, else Young's modulus.",
            swept=False,
        ),
    ] = None
    data_first: Annotated[_Moment, Quantity(_OF_BRANCHES.format("first", "earlier"), "s", swept=False)] = None
    data_last: Annotated[_Moment, Quantity(_OF_BRANCHES.format("last", "later"), "s", swept=False)] = None


_FIELDS = keys_of_maker(_Data)
OF_DATA: Keys = {"relaxation": _FIELDS["relaxation"]} | keys_of_maker(material) | _FIELDS
"""Keys about the data of the branches of a solid, which a relaxation table may give."""


_BESIDE = {"extrapolate": ("relaxation", "data_last"), "temperature": ("relaxation", "creep")}
"""Keys about a table that have a meaning without one, and what gives it."""


class SolidSection(Section):
    """A solid, of one kind or another; a table may give the branches and the modulus of a continuum."""

    section = "solid"
    ways = (
        ({"modulus"}, {"young"}),
        ({"branches"}, {"relaxation"}, {"flow"}, {"draws"}),
        ({*ACTIVATED}, {"creep_rate", "creep_stress"}),
    )
    needs = (
        *((key, ("branches",)) for key in ("draws", "data_first", "data_last")),
        *((key, _BESIDE.get(key, ("relaxation",))) for key in (*OF_TABLES.values(), "table_modulus")),
    )

    relaxation: Any = None
    data_last: Any = None
    extrapolate: Any = None
    """Of kinds that have no such keys."""

    @property
    def given(self) -> dict[str, Any]:
        """Arguments of `make`, as far as they are given."""
        return arguments_of(self.make, self) | self.laws | self._of_table

    def build(self) -> Solid:
        """Make the solid."""
        solid: Solid = self.make(**self.given)
        return solid

    @property
    def laws(self) -> dict[str, Law]:
        """The local law of creep, from numbers or from its activation, and the law of adhesion, if any."""
        facts = {key: value for key, value in vars(self).items() if value is not None}
        laws: dict[str, Law] = {}
        for kind in filter(facts.__contains__, LAWS):
            law = LAWS[kind][facts[kind]]
            if kind == "creep" and "temperature" in facts:
                activation = {key.removeprefix("creep_"): facts[key] for key in ACTIVATED}
                laws[kind] = Eyring.activated(**activation)
            else:
                laws[kind] = law(**{name: facts[f"{kind}_{name}"] for name in parameters_of(law)})
        return laws

    def check(self) -> None:
        """Refuse keys that contradict each other, and a solid that cannot be."""
        for law in KEYS_OF_LAWS:
            if getattr(self, law, None) == "none":
                vars(self)[law] = None
        self._check_data()
        for law in KEYS_OF_LAWS:
            self._check_law(law)
        with self.located():
            check_needs(self, self.needs if "relaxation" in self.keys else ())
            self.build()

    @property
    def material(self) -> Material:
        """The solid with what the data of its branches tell: their times, and their spread."""
        if self.of_table is not None:
            return replace(self.of_table, solid=self.build())
        draws = getattr(self, "draws", None)
        return replace(material(self.build(), draws=draws), span=self.known or (0.0, math.inf))

    def _check_law(self, kind: str) -> None:
        """Refuse keys of a law that are not those of one law."""
        kinds, law = KEYS_OF_LAWS[kind], getattr(self, kind, None)
        given = {name for name in OF_LAWS[kind] if getattr(self, name, None) is not None}
        if law is None and getattr(self, "relaxation", None) is not None:
            given.discard("temperature")  # that of the table
        ways = [way for way in kinds.get(law or "", []) if way <= self.keys.keys()]
        if law is None and given:
            laws = [name for name, ways in kinds.items() if given <= set().union(*ways)]
            expected: Words = (any_of(laws or kinds), " beside ", *named(sorted(given)))
            raise self.wrong(kind, expected=expected, got="none")
        if law is not None and given not in ways:
            options = [part for way in ways for part in (" or ", *named(sorted(way)))][1:]
            raise self.wrong(
                kind, expected=(*options, f" beside {law}"), got=", ".join(sorted(given)) or "none"
            )

    def __init__(self, **table: Any) -> None:
        super().__init__(**self._with_usual(table))

    @classmethod
    def _with_usual(cls, table: dict[str, Any]) -> dict[str, Any]:
        """Read shear, young or contact as kind of the modulus in the table; set the usual Poisson's ratio."""
        if "poisson" in cls.keys and cls.keys["poisson"].default is None:
            bodies = table.get("young") or table.get("relaxation")
            bodies = [bodies] if isinstance(bodies, float | int | str) else bodies
            lacks = table.get("poisson") is None and table.get("modulus") in (None, "young", "shear")
            if lacks and isinstance(bodies, list) and table.get("table_modulus") != "contact":
                table = {**table, "poisson": [POISSON] * len(bodies)}
        if "table_modulus" in cls.keys and table.get("modulus") in get_args(TableModulus):
            return {**table, "table_modulus": table["modulus"], "modulus": None}
        return table

    def _check_data(self) -> None:
        if self.relaxation is not None:
            self._check_table()
        elif "relaxation" in self.keys and self.modulus is None and self.young is None:
            expected = "modulus, young and poisson, or relaxation and poisson"
            raise self.wrong(expected=expected, got="none", advice=(Name("young"),))
        elif self.extrapolate not in (None, "model"):
            expected, cure = "model, for branches of data", {"extrapolate": "model"}
            raise self.wrong("extrapolate", expected=expected, got=self.extrapolate, cure=cure)

    def _check_table(self) -> None:
        for key in ("branches", "creep"):
            if getattr(self, key, None):
                expected = "none beside a relaxation table, which is that of a linear solid"
                raise self.wrong(key, expected=expected, got="both", advice="one of them")
        if isinstance(self.young, list) and len(self.young) > 1:
            advice = "asperity.relaxation"
            raise self.wrong("relaxation", expected="one body beside it", got="two", advice=advice)
        try:
            _ = self.of_table
        except InputError as error:
            key = (OF_TABLES | {"modulus": "modulus"}).get(error.name, "")
            raise error.about(key or error.name, "solid", key or "relaxation", keys=OF_TABLES) from None

    @property
    def of_table(self) -> Material | None:
        """The material of the table."""
        if self.relaxation is None:
            return None
        path = expanded(self.relaxation)
        changed = path.stat().st_mtime_ns if path.exists() else 0
        how = {name: getattr(self, key) for name, key in OF_TABLES.items()}
        how |= {"modulus": self.modulus or self.table_modulus, **self._of_one_body}
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
    def span(self) -> tuple[float, float]:
        """The times of the data; else a tenth of the shortest relaxation time and ten times the longest."""
        if self.of_data and self.of_data[0]:
            return self.of_data
        if self.fit is not None:
            return self.fit.data.span
        branches = self._of_table.get("branches", self.branches) if "relaxation" in self.keys else ()
        times = [time for _, time in (*branches, *getattr(self, "base_branches", []))]
        return (min(times) / _BEYOND, max(times) * _BEYOND) if times else _SPAN

    @property
    def known(self) -> tuple[float, float] | None:
        """First and last time of the data of table or branches, or assumed beyond them; None without."""
        if self.fit is not None:
            return self.fit.series.span
        return None if self.extrapolate == "model" else self.of_data

    def resolved(self) -> Self:
        """The same solid with the branches and the modulus that a table gives."""
        if self.relaxation is None:
            return self
        facts = {name: value for name, value in self.table.items() if name not in ("kind", *OF_DATA)}
        if math.isfinite((span := cast(Any, self.known))[1]):
            facts |= dict(zip(("data_first", "data_last"), span, strict=True))
        return type(self)(**facts | self._of_table)


def _section_of(kind: str) -> type[SolidSection]:
    """The section of a kind, with the arguments of the function as keys, and keys that give some of these."""
    make = MAKERS[kind]
    keys = keys_of_maker(make)
    for law in filter(signature(make).parameters.__contains__, LAWS):
        keys |= KEYS[law]
    if "modulus" in keys and "creep" in keys:  # activation gives a stress in Pa
        keys |= ACTIVATED
    if keys.keys() >= {"young", "branches"}:  # which a table gives
        keys |= OF_DATA
    return SolidSection.of_kind(kind, make, keys)


class HalfSpace(_section_of("half_space")):  # type: ignore[misc]
    """A half-space; see `asperity.solids.half_space`."""

    draws: Annotated[
        Sequence[Branches] | None,
        Len(2),
        Quantity(
            "Other lists of branches, such as samples of a posterior: their spread is in the band "
            "of a prediction",
            swept=False,
        ),
    ] = None


SOLIDS: dict[str, type[SolidSection]] = {
    kind: HalfSpace if kind == "half_space" else _section_of(kind) for kind in MAKERS
}


@functools.lru_cache(maxsize=8)
def _material(path: Path, how: tuple[tuple[str, Any], ...], changed: int) -> Material:
    """The material of a table, cached by the time of its last change."""
    del changed
    return material(path, **dict(how))
