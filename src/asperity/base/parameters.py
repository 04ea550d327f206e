"""Parameters of laws, legs, surfaces and solids: one annotation has type, bounds, unit and meaning.

    rate: Annotated[float, Gt(0), Quantity("velocity", "m/s", "v0")]

Check in Python, key in TOML, flag, field on the page, name in results and symbol in figures follow from it.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, ClassVar, Literal, Union, get_args, get_origin, get_type_hints

from annotated_types import Len

from asperity.base import checks, units
from asperity.errors import InputError, named


@dataclasses.dataclass(frozen=True)
class Quantity:
    """A quantity: what it is, its SI unit (empty for a pure number), and its symbol.

    Attributes
    ----------
    text
        Its meaning, and after a comma, a colon, a semicolon or a period more words for the help.
    dimension
        Dimension of the records, a key of the units of results; by default it follows from the unit.
    key
        Name of the key, by default that of the argument. A switch with another name means the opposite.
    usual
        Default of the key, by default that of the argument.
    swept
        Whether a campaign may take several values.
    of_line
        SI unit for a line contact, if it is another one.
    """

    text: str
    unit: str = ""
    symbol: str = ""
    dimension: str = ""
    key: str = ""
    usual: Any = ...
    swept: bool = True
    of_line: str = ""

    @property
    def meaning(self) -> str:
        """Its meaning alone."""
        return re.split(r"[,:;.](?= |$)", self.text)[0]

    @property
    def help(self) -> str:
        """All of the text, as a sentence or several."""
        if self.symbol:
            return f"Its {self.meaning} {self.symbol}."
        return f"{self.text[0].upper()}{self.text[1:]}{'.' * (self.text[-1] != '.')}"


@dataclasses.dataclass(frozen=True)
class Also:
    """A check of a value besides its type and bounds: takes the name and the value, raises `InputError`."""

    check: Callable[[str, Any], Any]


@dataclasses.dataclass(frozen=True)
class Spelled:
    """How other spellings of a word are read, such as the micro sign of a unit."""

    read: Callable[[Any], Any]


_DIMENSIONS = {
    **{"Pa": "pressure", "m": "length", "s": "time", "N": "force", "m/s": "velocity", "N/m": "stiffness"},
    "J/m^2": "energy / area",
}
_PLAIN = {float, int, bool, str, NoneType, Path}
_BOUNDS = {"ge": "least", "gt": "above", "le": "most", "lt": "below"}


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A field of a class, or an argument of a function, as its annotation has it.

    `hint` is its type, and `facts` are bounds and quantity. `default` may be `dataclasses.MISSING`.
    """

    hint: Any
    facts: tuple[Any, ...]
    default: object

    @functools.cached_property
    def kinds(self) -> tuple[Any, ...]:
        """Types and words that it may be, one by one."""
        return tuple(kinds_of(self.hint))

    @functools.cached_property
    def quantity(self) -> Quantity:
        """Meaning, unit and symbol."""
        return next(fact for fact in self.facts if isinstance(fact, Quantity))

    @property
    def recorded(self) -> tuple[str, str]:
        """Long name and dimension of its records; words have none."""
        stated, is_number = self.quantity, any(part in str(self.hint) for part in ("float", "int"))
        usual = _DIMENSIONS.get(stated.unit, stated.unit or "1") if is_number else ""
        return stated.meaning, stated.dimension or usual

    @property
    def bounds(self) -> dict[str, float]:
        """Bounds of the number, as `asperity.base.checks.number` takes them."""
        found = ((name, fact) for fact in self.facts for name in _BOUNDS if hasattr(fact, name))
        return {_BOUNDS[name]: getattr(fact, name) for name, fact in found}

    @property
    def optional(self) -> Parameter:
        """The same parameter, optional."""
        return Parameter(self.hint | None, self.facts, None)

    @property
    def words(self) -> tuple[str, ...]:
        """Words of which it is one; empty where it may be a number, too."""
        return () if float in self.kinds else tuple(kind for kind in self.kinds if isinstance(kind, str))

    @functools.cached_property
    def item(self) -> Parameter | None:
        """One entry, of a list."""
        hint = next(filter(None, map(item_of, self.kinds)), None)
        if hint is None:
            return None
        hint, *facts = _apart(hint)
        outer = [fact for fact in self.facts if not isinstance(fact, Len | Also)]
        return Parameter(hint, (*facts, *outer), dataclasses.MISSING)

    @functools.cached_property
    def pair(self) -> tuple[Parameter, ...]:
        """Both entries, of a pair; else empty."""
        pairs = (kind for kind in self.kinds if get_origin(kind) is tuple and ... not in get_args(kind))
        entries = () if Path in self.kinds else get_args(next(pairs, None))
        return tuple(
            Parameter(hint, tuple(facts), dataclasses.MISSING) for hint, *facts in map(_apart, entries)
        )

    @property
    def unit(self) -> str:
        """Unit of a number alone, and of one with a unit; empty for a pure number."""
        return next((fact.unit for fact in self.facts if isinstance(fact, Quantity) and fact.unit), "")

    @property
    def as_key(self) -> Parameter:
        """The same as a key of a table, with its own default."""
        default = self.default if self.quantity.usual is ... else self.quantity.usual
        if self.quantity.key and isinstance(default, bool):
            default = not default
        if self.item and not self.words and default not in (None, dataclasses.MISSING):
            default = list(default) if isinstance(default, tuple) else [default]
        return dataclasses.replace(self, default=default)

    def read(self, name: str, value: object) -> Any:
        """The value as tables have it: lists for several, pairs as tuples, numbers in SI.

        `InputError`, about the name, for another type, and for what is out of bounds.
        """
        if value is None and (NoneType in self.kinds or self.default is None):
            return None
        taken = self._taken(name, value)
        for fact in self.facts:
            if isinstance(fact, Also):
                fact.check(name, taken)
        return taken

    def _taken(self, name: str, value: object) -> Any:
        own = tuple(kind for kind in self.kinds if isinstance(kind, type) and kind not in _PLAIN)
        if own and isinstance(value, own):
            return value
        if self.words and (self.item is None or isinstance(value, str)):
            spelled = next((fact.read for fact in self.facts if isinstance(fact, Spelled)), None)
            return checks.choice(name, spelled(value) if spelled else value, self.words)
        if (item := self.item) is not None:
            return self._list(name, value, item)
        if self.pair:
            if not isinstance(value, list | tuple) or len(value) != len(self.pair):
                raise InputError(name, expected="pairs of two numbers", got=checks.shown(value))
            return tuple(part.read(name, one) for part, one in zip(self.pair, value, strict=True))
        if float in self.kinds:
            return self._number(name, value[0] if isinstance(value, list) and len(value) == 1 else value)
        if bool in self.kinds:
            return checks.switch(name, value)
        if int in self.kinds and not (str in self.kinds and isinstance(value, str)):
            bounds = self.bounds
            least = bounds.get("least", bounds.get("above", -(2**63)) + 1)
            most = bounds.get("most", bounds.get("below", 2**63) - 1)
            return checks.integer(name, value, least=int(least), most=int(most))
        return checks.text(name, value)

    def _list(self, name: str, value: object, item: Parameter) -> list[Any]:
        classes = tuple(kind for kind in (*self.kinds, int) if isinstance(kind, type))
        alone = classes[:-1] and isinstance(value, classes) and not isinstance(value, bool)
        values = [value] if alone else value
        if isinstance(values, Iterable) and not isinstance(values, str | Mapping):
            values = list(values)
        if not isinstance(values, list):
            raise InputError(name, expected="a list", got=checks.shown(value))
        sizes = next((fact for fact in self.facts if isinstance(fact, Len)), Len(0))
        if len(values) < sizes.min_length or (sizes.max_length and len(values) > sizes.max_length):
            most = f" and at most {sizes.max_length}" if sizes.max_length else ""
            expected = f"at least {sizes.min_length}{most} in the list"
            raise InputError(name, expected=expected, got=checks.shown(value))
        return [item.read(name, one) for one in values]

    def _number(self, name: str, value: object) -> float:
        if "inf" in self.kinds and isinstance(value, str | float) and value in ("inf", math.inf):
            return math.inf
        of_line = next((fact.of_line for fact in self.facts if isinstance(fact, Quantity)), "")
        return units.number(name, value, self.unit, of_line=of_line, **self.bounds)


def parameters_of(kind: Callable[..., Any]) -> dict[str, Parameter]:
    """Parameters by name: fields of a class, or arguments of a function, annotated with a `Quantity`."""
    return _read(kind)


@functools.cache
def _read(kind: Any) -> dict[str, Parameter]:
    hints = get_type_hints(kind, include_extras=True)
    if isinstance(kind, type):
        usual = {name: getattr(kind, name, dataclasses.MISSING) for name in hints}
    else:
        usual = {name: one.default for name, one in inspect.signature(kind).parameters.items()}
    parameters = {}
    for name, default in usual.items():
        hint, *facts = _apart(hints.get(name))
        if any(isinstance(fact, Quantity) for fact in facts):
            stated = dataclasses.MISSING if default is inspect.Parameter.empty else default
            parameters[name] = Parameter(hint, tuple(facts), stated)
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


Needs = tuple[tuple[str, tuple[str, ...]], ...]
"""Arguments or keys, each with others of which it needs one beside it."""


def check_needs(thing: Any, needs: Needs) -> None:
    """Refuse what is given without one of those that it needs."""
    for name, others in needs:
        is_given = getattr(thing, name, None) != getattr(type(thing), name, None)
        if is_given and all(getattr(thing, other, None) in (None, []) for other in others):
            raise InputError(name, expected=(*named(others, " or "), " beside it"), got="none")


class Checked:
    """A frozen dataclass whose parameters are checked when it is made."""

    needs: ClassVar[Needs] = ()

    @classmethod
    def checked(cls) -> dict[str, Parameter]:
        """Parameters by the fields that they check."""
        return parameters_of(cls)

    def __post_init__(self) -> None:
        for name, parameter in self.checked().items():
            value = parameter.read(parameter.quantity.key or name, getattr(self, name))
            is_tuple = isinstance(value, list) and any(get_origin(kind) is tuple for kind in parameter.kinds)
            object.__setattr__(self, name, tuple(value) if is_tuple else value)
        check_needs(self, self.needs)


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
