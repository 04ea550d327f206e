"""Parameters of laws, legs, surfaces and solids: one annotation has type, bounds, unit and meaning.

    rate: Annotated[float, Gt(0), Quantity("velocity", "m/s", "v0")]

Check in Python, key in TOML, flag, field on the page, name in results and symbol in figures follow from it.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from types import NoneType, UnionType
from typing import Annotated, Any, ClassVar, Literal, Union, get_args, get_origin, get_type_hints

from annotated_types import Ge, Gt, Le, Lt

from asperity.base import checks, units
from asperity.base.words import InUnits
from asperity.errors import InputError


@dataclasses.dataclass(frozen=True)
class Quantity:
    """A quantity: its meaning in words, its SI unit (empty for a pure number), and its symbol.

    Attributes
    ----------
    more
        Help text after the meaning, up to the last period.
    dimension
        Dimension of the records, a key of the units of results; by default it follows from the unit.
    key
        Name of the key, by default that of the argument. A switch with another name means the opposite.
    usual
        Default of the key, by default that of the argument.
    """

    meaning: str
    unit: str = ""
    symbol: str = ""
    more: str = "."
    dimension: str = ""
    key: str = ""
    usual: Any = ...


@dataclasses.dataclass(frozen=True)
class Also:
    """A check of a value besides its type and bounds: takes the name and the value, raises `InputError`."""

    check: Callable[[str, Any], Any]


_DIMENSIONS = {
    **{"Pa": "pressure", "m": "length", "s": "time", "N": "force", "m/s": "velocity", "N/m": "stiffness"},
    "J/m^2": "energy / area",
}
_BOUNDS = ((Ge, "ge", "least"), (Gt, "gt", "above"), (Le, "le", "most"), (Lt, "lt", "below"))


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A field of a class, or an argument of a function, as its annotation has it.

    `hint` is its type, and `facts` are bounds and quantity. `default` may be `dataclasses.MISSING`.
    """

    hint: Any
    facts: tuple[Any, ...]
    default: object

    @property
    def kinds(self) -> tuple[Any, ...]:
        """Types and words that it may be, one by one."""
        return tuple(kinds_of(self.hint))

    @property
    def quantity(self) -> Quantity:
        """Meaning, unit and symbol."""
        return next(fact for fact in self.facts if isinstance(fact, Quantity))

    @property
    def recorded(self) -> tuple[str, str]:
        """Long name and dimension of its records; words have none."""
        stated, plain = self.quantity, not any(part in str(self.hint) for part in ("float", "int"))
        dimension = "" if plain else _DIMENSIONS.get(stated.unit, stated.unit or "1")
        return stated.meaning, stated.dimension or dimension

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
        """The same parameter, optional."""
        return Parameter(self.hint | None, self.facts, None)

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


def parameters_of(kind: Callable[..., Any]) -> dict[str, Parameter]:
    """Parameters by name: fields of a dataclass, or arguments of a function, annotated with a `Quantity`."""
    return _read(kind)


@functools.cache
def _read(kind: Any) -> dict[str, Parameter]:
    hints = get_type_hints(kind, include_extras=True)
    fields: dict[str, Any] = dict(inspect.signature(kind).parameters)
    if isinstance(kind, type):
        fields = {field.name: field for field in dataclasses.fields(kind)}
    parameters = {}
    for name, field in fields.items():
        hint, *facts = _apart(hints.get(name))
        if any(isinstance(fact, Quantity) for fact in facts):
            default = dataclasses.MISSING if field.default is inspect.Parameter.empty else field.default
            parameters[name] = Parameter(hint, tuple(facts), default)
    return parameters


def _apart(hint: Any) -> tuple[Any, ...]:
    """Type and facts of an annotation, also of ``Length | None``."""
    if get_origin(hint) is Annotated:
        return get_args(hint)
    if get_origin(hint) in (Union, UnionType):
        parts = [_apart(part) for part in get_args(hint)]
        return (Union[tuple(part[0] for part in parts)], *(fact for part in parts for fact in part[1:]))  # noqa: UP007
    return (hint,)


def kinds_of(hint: Any) -> list[Any]:
    """Types and words of a hint, one by one; a sequence counts as one."""
    if get_origin(hint) is Literal:
        return list(get_args(hint))
    if get_origin(hint) in (Union, UnionType):
        return [kind for part in get_args(hint) for kind in kinds_of(part)]
    return [hint]


def item_of(kind: Any) -> Any:
    """Type of the items of a sequence of any length; None for other types."""
    origin, args = get_origin(kind), get_args(kind)
    return args[0] if origin is Sequence or (origin is tuple and args[1:] == (...,)) else None


class Checked:
    """A frozen dataclass whose parameters are checked when it is made."""

    def __post_init__(self) -> None:
        for name, parameter in parameters_of(type(self)).items():
            object.__setattr__(self, name, parameter.checked(name, getattr(self, name)))


class Law(Checked):
    """A law of a solid, whose parameters are recorded behind a prefix."""

    prefix: ClassVar[str]
    formula: ClassVar[str] = ""
    """The law in one line; empty where it is not known."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Numbers to record with every result."""
        return {f"{self.prefix}_{name}": getattr(self, name) for name in parameters_of(type(self))}

    def fingerprint(self) -> str:
        """Text that distinguishes it from other laws."""
        return repr(self)
