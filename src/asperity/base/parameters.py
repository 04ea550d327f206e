"""Parameters of laws and legs: one annotation of a field says its unit, its bounds and what it is.

    rate: Annotated[float, Gt(0), Quantity("velocity", "m/s", "v0")]

The check of the argument in Python, the key in TOML with its flag and its field on the page, the name in
results and the symbol under figures are made of it.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from annotated_types import Ge, Gt, Le, Lt

from asperity.base import checks, units
from asperity.base.words import InUnits
from asperity.errors import InputError


@dataclasses.dataclass(frozen=True)
class Quantity:
    """What a number is: its meaning in words, its unit in SI (empty for a pure number), and its symbol."""

    meaning: str
    unit: str = ""
    symbol: str = ""


_BOUNDS = ((Ge, "ge", "least"), (Gt, "gt", "above"), (Le, "le", "most"), (Lt, "lt", "below"))


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A field of a class as its annotation has it.

    `kinds` are the types or words that it may be, `facts` what the annotation says besides: bounds, and what
    it is. Without a default it is `dataclasses.MISSING`.
    """

    kinds: tuple[Any, ...]
    facts: tuple[Any, ...]
    default: object

    @property
    def quantity(self) -> Quantity:
        """What it is."""
        return next(fact for fact in self.facts if isinstance(fact, Quantity))

    @property
    def bounds(self) -> dict[str, float]:
        """Bounds of the number, as `asperity.base.checks.number` takes them."""
        return {
            word: getattr(fact, name)
            for fact in self.facts
            for kind, name, word in _BOUNDS
            if isinstance(fact, kind)
        }

    @property
    def optional(self) -> Parameter:
        """The same that need not be given."""
        return Parameter((*self.kinds, NoneType), self.facts, None)

    def checked(self, name: str, value: object) -> object:
        """The value as a number of Python within the bounds, or one of the words; `InputError` otherwise."""
        if value is None and NoneType in self.kinds:
            return None
        if float in self.kinds:
            if "inf" in self.kinds and isinstance(value, str | float) and value in ("inf", math.inf):
                return math.inf
            number = units.number(name, value, self.quantity.unit, **self.bounds)
            return value if isinstance(value, InUnits) else number
        if int in self.kinds:
            return checks.integer(name, value, **self.bounds)  # type: ignore[arg-type]
        words = [kind for kind in self.kinds if kind is not NoneType]
        if all(isinstance(word, str) for word in words) and value not in words:
            expected = f"{', '.join(map(repr, words[:-1]))} or {words[-1]!r}"
            raise InputError(name, expected=expected, got=repr(value))
        return value


def parameters_of(kind: type) -> dict[str, Parameter]:
    """Parameters of a dataclass by name: the fields that are annotated with more than a type."""
    return _read(kind)


@functools.cache
def _read(kind: type) -> dict[str, Parameter]:
    hints = get_type_hints(kind, include_extras=True)
    fields = {field.name: field for field in dataclasses.fields(kind)}
    return {
        name: Parameter(tuple(_kinds(get_args(hints[name])[0])), hints[name].__metadata__, field.default)
        for name, field in fields.items()
        if get_origin(hints[name]) is Annotated
    }


def _kinds(hint: Any) -> list[Any]:
    """Types and words of a hint, one by one."""
    if get_origin(hint) in (None, tuple):
        return [hint]
    if get_origin(hint) is Literal:
        return list(get_args(hint))
    return [kind for part in get_args(hint) for kind in _kinds(part)]


class Checked:
    """A frozen dataclass whose parameters are checked when it is made."""

    def __post_init__(self) -> None:
        for name, parameter in parameters_of(type(self)).items():
            object.__setattr__(self, name, parameter.checked(name, getattr(self, name)))
