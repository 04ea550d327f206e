"""What sections are made of: strict tables, and numbers that may be written with units."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import MISSING, dataclass
from types import NoneType
from typing import Annotated, Any, Literal, TypeVar, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from asperity.base.parameters import Parameter
from asperity.base.words import InUnits, has_unit
from asperity.creep.eyring import joules
from asperity.errors import LARGEST, InputError

_T = TypeVar("_T")


class Section(BaseModel):
    """A table of the configuration: no unknown keys, no silent conversions, no infinities."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


def usual(default: object, description: str) -> Any:
    """What a key is where it is not given, and what it means."""
    return Field(default=default, description=description)


def by_kind(*models: type[Section]) -> dict[str, type[Section]]:
    """Models by the kind, or the kinds, that each is of; the first is the usual one."""
    return {kind: model for model in models for kind in get_args(model.model_fields["kind"].annotation)}


@dataclass(frozen=True)
class InUnit:
    """Take a text with a unit for a number in SI; anything else is checked as it is.

    An energy may be one for each mole.
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
            raise ValueError(f"expected {error.expected}, got {error.got}") from None
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


Several = Annotated[list[_T], Field(min_length=1), BeforeValidator(listed)]
OneOrTwo = Annotated[list[_T], Field(min_length=1, max_length=2), BeforeValidator(listed)]
"""One of two bodies or axes, or of each."""
Share = Annotated[float, Field(ge=0, le=1)]
Real = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, Field(gt=0, le=LARGEST)]
Constant = Annotated[float, Field(ge=0, le=1e30)]
"""A stiffness or a mobility; steps of creep use its products in single precision, which ends at 3e38."""
Time = Annotated[float, Field(ge=0, le=1e30), InUnit("s")]
Duration = Annotated[float, Field(gt=0, le=1e30), InUnit("s")]
FirstForce = Annotated[float, Field(ge=0, le=LARGEST), InUnit("N")]
"""A load at the beginning, from which a ramp may go up."""
Force = Annotated[float, Field(gt=0, le=LARGEST), InUnit("N")]
Pressure = Annotated[float, Field(gt=0, le=LARGEST), InUnit("Pa")]
Modulus = Annotated[float, Field(gt=0, le=1e30), InUnit("Pa")]
Size = Annotated[float, Field(gt=0, le=LARGEST), InUnit("m")]
Position = Annotated[float, Field(ge=-LARGEST, le=LARGEST), InUnit("m")]
Velocity = Annotated[float, Field(gt=0, le=LARGEST), InUnit("m/s")]
Stiffness = Annotated[float, Field(gt=0, allow_inf_nan=True), InUnit("N/m")]
Energy = Annotated[float, Field(gt=0, le=LARGEST), InUnit("J")]
Volume = Annotated[float, Field(gt=0, le=LARGEST), InUnit("m^3")]
Resistivity = Annotated[float, Field(gt=0, le=LARGEST), InUnit("ohm m")]
Conductivity = Annotated[float, Field(gt=0, le=LARGEST), InUnit("W/m/K")]
Temperature = Annotated[float, Field(gt=0, le=LARGEST), InUnit("K")]


def annotation_of(parameter: Parameter) -> Any:
    """How a key is checked that is a parameter of a class of the library."""
    kinds, unit = parameter.kinds, parameter.quantity.unit
    words = tuple(kind for kind in kinds if isinstance(kind, str))
    if float in kinds and words:
        key: Any = Annotated[
            (
                float,
                *parameter.facts,
                Field(allow_inf_nan=True),
                InUnit(unit),
                BeforeValidator(lambda one: math.inf if one == "inf" else one),
            )
        ]
    elif float in kinds:
        key = Annotated[(Real, *parameter.facts, *([InUnit(unit)] if unit else []))]
    else:
        key = Literal[words] if words else Annotated[(int, *parameter.facts)]
    return key | None if NoneType in kinds else key


def field_of(parameter: Parameter) -> Any:
    """The same with its default and what it is."""
    what, default = parameter.quantity, parameter.default
    said = f"Its {what.meaning} {what.symbol}." if what.symbol else f"{what.meaning}."
    said = said[0].upper() + said[1:]
    return annotation_of(parameter), Field(... if default is MISSING else default, description=said)


Branch = Annotated[tuple[Share, Duration], BeforeValidator(_paired)]
"""A share of the modulus, and a relaxation time."""
Place = Annotated[tuple[Position, Position], BeforeValidator(_paired)]
"""A place on the lattice."""
Power = Annotated[tuple[Positive, Annotated[float, Field(ge=-2, le=4)]], BeforeValidator(_paired)]
"""A mobility, and the power of the wave number with which it goes."""
