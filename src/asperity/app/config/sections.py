"""Strict tables, and numbers that may have units: the parts of sections."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, dataclass
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Len, Lt
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    create_model,
)
from pydantic_core import CoreSchema, core_schema

from asperity.base.parameters import Also, Parameter, Quantity, item_of, kinds_of, parameters_of
from asperity.base.words import InUnits, has_unit
from asperity.creep.eyring import joules
from asperity.errors import LARGEST, InputError
from asperity.surfaces.prepare import spelled

_T = TypeVar("_T")
_Section = TypeVar("_Section", bound="Section")


class Section(BaseModel):
    """A table of the configuration: no unknown keys, no silent conversions, no infinities."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


def usual(default: object, description: str) -> Any:
    """A key with its default and its description."""
    return Field(default=default, description=description)


def made(name: str, home: str, base: type[_Section], kind: str, keys: dict[str, Any]) -> type[_Section]:
    """A section of a kind, which pickle finds under its name in a module."""
    fields: dict[str, Any] = {"kind": (Literal[kind], kind), **keys}
    section = create_model(name, __base__=base, __module__=home, **fields)
    setattr(sys.modules[home], name, section)
    return section


def union_of(models: Mapping[str, type[Section]]) -> Any:
    """Any of these, as its kind says."""
    return Annotated[Union[tuple(models.values())], Field(discriminator="kind")]  # noqa: UP007


@dataclass(frozen=True)
class InUnit:
    """Take a text with a unit for a number in SI; anything else is checked as it is.

    An energy may be one for each mole. A bare number is in `unit`.
    """

    unit: str

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(self, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return handler(schema) | {"unit": self.unit}

    def __call__(self, value: object, check: Callable[[object], float]) -> float:
        """Read a number, which remembers how it was written."""
        if not has_unit(value):
            return check(value)
        from asperity.base.units import quantity

        try:
            number = joules(str(value)) if self.unit == "J" else quantity(value, self.unit)
        except InputError as error:
            raise ValueError(sentence(error.about(""))) from None
        return InUnits.of(check(number), str(value), self.unit)


def listed(value: object) -> object:
    """Take one number, or one text, for a list of one."""
    return [value] if isinstance(value, float | int | str) and not isinstance(value, bool) else value


def _paired(value: object) -> object:
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise ValueError(f"expected pairs of numbers, such as [[0.3, 10.0]], got {value!r}")
    return tuple(value)


def any_of(words: Iterable[str]) -> str:
    """Words of which one is meant: ``one, two or three``."""
    *some, last = words
    return f"{', '.join(some)} or {last}" if some else last


OneOrTwo = Annotated[list[_T], Field(min_length=1, max_length=2), BeforeValidator(listed)]
"""One of two bodies or axes, or of each."""
Share = Annotated[float, Field(ge=0, le=1)]
Positive = Annotated[float, Field(gt=0, le=LARGEST)]
Time = Annotated[float, Field(ge=0, le=1e30), InUnit("s")]
Duration = Annotated[float, Field(gt=0, le=1e30), InUnit("s")]
Load = Annotated[float, Field(ge=-LARGEST, le=LARGEST), InUnit("N")]
LoadOverArea = Annotated[float, Field(ge=-LARGEST, le=LARGEST), InUnit("Pa")]
"""What presses, or pulls where bodies stick."""
Force = Annotated[float, Field(gt=0, le=LARGEST), InUnit("N")]
Pressure = Annotated[float, Field(gt=0, le=LARGEST), InUnit("Pa")]
Size = Annotated[float, Field(gt=0, le=LARGEST), InUnit("m")]
Position = Annotated[float, Field(ge=-LARGEST, le=LARGEST), InUnit("m")]
Velocity = Annotated[float, Field(gt=0, le=LARGEST), InUnit("m/s")]
Resistivity = Annotated[float, Field(gt=0, le=LARGEST), InUnit("ohm m")]
Conductivity = Annotated[float, Field(gt=0, le=LARGEST), InUnit("W/m/K")]
Work = Annotated[float, Field(gt=0, le=LARGEST), InUnit("J/m^2")]
Temperature = Annotated[float, Field(gt=0, le=LARGEST), InUnit("K")]


def key_of(hint: Any, *facts: Any) -> Any:
    """Pydantic type of a key, from the annotation of a parameter of the library."""
    if get_origin(hint) is Annotated:
        inner, *facts_inside = get_args(hint)
        return key_of(inner, *facts_inside, *facts)
    kinds = kinds_of(hint)
    words = tuple(kind for kind in kinds if isinstance(kind, str))
    pair = next((kind for kind in kinds if get_origin(kind) is tuple and ... not in get_args(kind)), None)
    item = next(filter(None, map(item_of, kinds)), None)
    key: Any
    if words and float not in kinds:
        key = Annotated[Literal[words], BeforeValidator(spelled)] if "um" in words else Literal[words]
    elif item is not None:
        key = list[key_of(item, *(fact for fact in facts if not isinstance(fact, Len | Also)))]  # type: ignore[misc]
        few = [BeforeValidator(listed)] if {float, int, str} & {*kinds} else []
        key = _with(key, *(fact for fact in facts if isinstance(fact, Len)), *few)
    elif Path in kinds:
        key = str
    elif pair is not None:
        key = Annotated[tuple[tuple(map(key_of, get_args(pair)))], BeforeValidator(_paired)]  # type: ignore[misc]
    elif float in kinds:
        key = _number(kinds, facts)
    elif bool in kinds:
        key = bool
    elif int in kinds:
        key = Annotated[int | str, BeforeValidator(_name_or_number)] if str in kinds else _within(int, facts)
    else:
        key = str
    key = _with(key, *(AfterValidator(_also(fact)) for fact in facts if isinstance(fact, Also)))
    return key | None if NoneType in kinds else key


def _with(key: Any, *facts: object) -> Any:
    return Annotated[(key, *facts)] if facts else key


def _number(kinds: list[Any], facts: tuple[Any, ...]) -> Any:
    quantity = next((fact for fact in facts if isinstance(fact, Quantity)), None)
    units = [InUnit(quantity.unit)] if quantity and quantity.unit else []
    alone = BeforeValidator(lambda one: one[0] if isinstance(one, list) and len(one) == 1 else one)
    if "inf" not in kinds:
        return Annotated[(_within(float, facts), *units, alone)]
    infinite = BeforeValidator(lambda one: math.inf if one == "inf" else one)
    return Annotated[(_within(float, facts, math.inf), Field(allow_inf_nan=True), *units, infinite)]


def _within(kind: type, facts: tuple[Any, ...], largest: float = LARGEST) -> Any:
    """A number within the bounds of its annotation; a finite float has both."""
    bounds = [fact for fact in facts if isinstance(fact, Gt | Ge | Lt | Le)]
    if kind is float and math.isfinite(largest):
        bounds += [] if any(isinstance(fact, Gt | Ge) for fact in bounds) else [Ge(-largest)]
        bounds += [] if any(isinstance(fact, Lt | Le) for fact in bounds) else [Le(largest)]
    return _with(kind, *bounds)


def _also(fact: Also) -> Callable[[Any], Any]:
    def checked(value: Any) -> Any:
        try:
            return fact.check("", value)
        except InputError as error:
            raise ValueError(sentence(error.about(""))) from None

    return checked


def sentence(error: InputError) -> str:
    """Message of an error of the library, with its advice."""
    advice = f"; try {error.advice}" if error.advice else ""
    return f"{error.name}: expected {error.expected}, got {error.got}{advice}".removeprefix(": ")


def _name_or_number(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise ValueError("expected the name or the number of a channel")
    return value


def field_of(parameter: Parameter) -> Any:
    """A key of a parameter, with default and help."""
    quantity, default = parameter.quantity, parameter.default
    default = default if quantity.usual is ... else quantity.usual
    if quantity.key and isinstance(default, bool):
        default = not default
    key = key_of(parameter.hint, *parameter.facts)
    if default is None and NoneType not in parameter.kinds:
        key = key | None
    if default not in (MISSING, None) and not isinstance(default, str) and any(map(item_of, parameter.kinds)):
        default = list(default) if isinstance(default, tuple) else [default]
    help_text = (
        f"Its {quantity.meaning} {quantity.symbol}." if quantity.symbol else quantity.meaning + quantity.more
    )
    help_text = help_text[0].upper() + help_text[1:]
    return key, Field(... if default is MISSING else default, description=help_text)


def keys_of_maker(make: Callable[..., Any]) -> dict[str, Any]:
    """Keys of a section: the annotated arguments of the function that makes a surface or a solid."""
    return {
        parameter.quantity.key or name: field_of(parameter) for name, parameter in parameters_of(make).items()
    }


def arguments_of(make: Callable[..., Any], section: Section) -> dict[str, Any]:
    """Arguments of such a function, from the keys that are given."""
    arguments = {}
    for name, parameter in parameters_of(make).items():
        value, kinds = getattr(section, parameter.quantity.key or name), {*parameter.kinds}
        if value is None or value == [] or (isinstance(value, bool) and parameter.quantity.key and not value):
            continue
        if isinstance(value, list) and {float, int} & kinds:
            value = value[0] if len(value) == 1 else tuple(value)
        arguments[name] = not value if isinstance(value, bool) and parameter.quantity.key else value
    return arguments
