"""Priors of parameters: one of four distributions, in Python and in TOML."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from asperity.base import checks, units
from asperity.base.checks import Floats
from asperity.errors import InputError

KINDS: dict[str, tuple[str, str]] = {
    "uniform": ("low", "high"),
    "log_uniform": ("low", "high"),
    "normal": ("mean", "deviation"),
    "log_normal": ("median", "factor"),
}
"""Kinds of priors, and the two numbers of each; the factor of ``log_normal`` is one standard deviation."""

_ABOVE = {"deviation": 0.0, "factor": 1.0}
_REACH = 4.0

Given: TypeAlias = "Prior | Sequence[float | str] | Mapping[str, float | str]"
"""A prior, the ends of a range in ln, or a table as in TOML."""


@dataclass(frozen=True)
class Prior:
    """A prior distribution of one parameter.

    Parameters
    ----------
    kind
        ``"uniform"`` or ``"log_uniform"`` between two ends, ``"normal"``, or ``"log_normal"``.
    first, second
        Low and high end; mean and standard deviation; or median and the factor, above 1, that is one standard
        deviation. Ends of ``log_uniform`` and medians are above 0, else `InputError`.
    unit
        Unit of the parameter, ``""`` for a number.
    """

    kind: str
    first: float
    second: float
    unit: str = ""

    def __post_init__(self) -> None:
        checks.choice("kind", self.kind, tuple(KINDS))
        for name, field in zip(KINDS[self.kind], ("first", "second"), strict=True):
            above = _ABOVE.get(name, 0.0 if self.logarithmic else -math.inf)
            unit = "" if name == "factor" else self.unit
            number = float(units.number(name, getattr(self, field), unit, above=above))
            object.__setattr__(self, field, number)
        if self.bounded and not self.first < self.second:
            raise InputError("high", expected=f"more than low, {self.first:g}", got=self.second)

    @classmethod
    def of(cls, name: str, stated: Given, unit: str) -> Prior:
        """Make a prior of itself, a pair of ends, or a table such as ``{kind = "normal", mean = ...}``."""
        if isinstance(stated, Prior):
            return stated
        if isinstance(stated, list | tuple) and len(stated) == 2:
            stated = {"low": stated[0], "high": stated[1]}
        if not isinstance(stated, Mapping):
            expected = 'a pair of ends, or a table such as {kind = "uniform", low = 0, high = 1}'
            raise InputError(f"prior of {name}", expected=expected, got=checks.shown(stated))
        facts: dict[str, Any] = {"kind": "log_uniform", **stated}
        numbers = KINDS.get(str(facts["kind"]), ())
        if not numbers or set(facts) != {"kind", *numbers}:
            expected = "; ".join(
                f"kind = {kind!r} with {' and '.join(names)}" for kind, names in KINDS.items()
            )
            raise InputError(f"prior of {name}", expected=expected, got=checks.shown(dict(stated)))
        try:
            first, second = (facts[number] for number in numbers)
            return cls(facts["kind"], first, second, unit)
        except InputError as error:
            raise error.about(f"prior of {name}, {error.name}") from error

    def at(self, x: Floats) -> Floats:
        """Values at coordinates x: from 0 to 1 between ends, else in standard deviations."""
        if self.logarithmic:
            return np.asarray(self.first ** (1 - x if self.bounded else 1.0) * self.second**x)
        return np.asarray(self.first + (self.second - self.first if self.bounded else self.second) * x)

    def drawn(self, random: np.random.Generator, count: int) -> Floats:
        """Coordinates of random draws."""
        return random.random(count) if self.bounded else random.standard_normal(count)

    def log_density(self, x: Floats) -> Floats:
        """Logarithm of the density of the coordinate, without its constant."""
        return np.where((x >= 0) & (x <= 1), 0.0, -np.inf) if self.bounded else -(x**2) / 2

    @property
    def reach(self) -> tuple[float, float]:
        """Bounds of the coordinate in a search."""
        return (0.0, 1.0) if self.bounded else (-_REACH, _REACH)

    @property
    def bounded(self) -> bool:
        """Whether it is a mere range; other priors count in fits as data do."""
        return self.kind.endswith("uniform")

    @property
    def logarithmic(self) -> bool:
        """Whether its coordinate is that of the logarithm."""
        return self.kind.startswith("log")

    @property
    def table(self) -> dict[str, float | str]:
        """The argument of `of`, with units."""
        unit = f" {self.unit}" if self.unit else ""
        named = dict(zip(KINDS[self.kind], (self.first, self.second), strict=True))
        facts = {
            name: f"{value:g}{unit}" if unit and name != "factor" else value for name, value in named.items()
        }
        return {"kind": self.kind, **facts}

    def __str__(self) -> str:
        first, second = (f"{value:.4g}" for value in (self.first, self.second))
        unit = f" {self.unit}" if self.unit else ""
        if self.bounded:
            return f"{first} to {second}{unit}, {'ln uniform' if self.logarithmic else 'uniform'}"
        return f"{first} × {second}^±1{unit}" if self.logarithmic else f"{first} ± {second}{unit}"
