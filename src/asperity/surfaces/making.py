"""A decorator that gives a unit to functions that make heights, and annotations of their arguments."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal, ParamSpec, Protocol, cast, overload

import numpy as np
from annotated_types import Ge, Gt, Le, Len, Lt
from numpy.typing import NDArray

from asperity.base import checks, units
from asperity.base.parameters import Quantity, Spelled, parameters_of
from asperity.base.readable import LENGTHS
from asperity.base.words import written_with_units
from asperity.errors import InputError, Name
from asperity.lattice import Field
from asperity.surfaces.prepare import spelled
from asperity.surfaces.surface import Surface

_P = ParamSpec("_P")

Length = float | str
_IN_UNIT = ("length unit", "height unit")
"""Dimensions of arguments that are lengths in the unit of the surface."""
Lengths = Length | Sequence[Length] | NDArray[np.float64]
"""One number, or several; each in m, or a text with a unit."""

MOST_SITES = 2**31
"""Sites along an axis: far beyond any memory, far below what numpy cannot count."""

Shape = Annotated[
    int | tuple[int, ...],
    *(Ge(1), Le(MOST_SITES), Len(1, 2)),
    Quantity("sites along each axis: 200 200, or 4096.", dimension="sites", usual=(200, 200)),
]
Positive = Annotated[float | None, Gt(0)]
Rng = int | np.random.Generator | None
Seed = Annotated[int, Ge(0), Lt(2**63), Quantity("seed of the random heights", swept=False)]
Rms = Annotated[float, Gt(0), Quantity("rms height", dimension="height unit")]
PixelSize = Annotated[
    Lengths | None,
    *(Gt(0), Len(1, 2)),
    Quantity(
        "distance between sites: one number, or one an axis.",
        key="spacing",
        dimension="length unit",
        usual=(1.0,),
        swept=False,
    ),
]
Unit = Annotated[
    Literal["m", "mm", "um", "nm", "pm"] | None,
    Spelled(spelled),
    Quantity("unit of the spacing and of all heights and wavelengths"),
]
_KEYWORD = inspect.Parameter.KEYWORD_ONLY
_ADDED = {"unit": "str | None", "pixel_size": "ArrayLike | str | None"}
"""Arguments that are added, and what they may be."""


class Maker(Protocol[_P]):
    """Makes heights, or with a unit a surface."""

    @overload
    def __call__(self, *args: Any, unit: str, **more: Any) -> Surface: ...  # type: ignore[overload-overlap]

    @overload
    def __call__(self, *args: _P.args, **more: _P.kwargs) -> Field: ...


def in_numbers(make: Callable[..., Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of a maker of heights, or keys, with texts such as ``"50 nm"`` as numbers in its ``unit``.

    Raises
    ------
    InputError
        A text is no length, or there is no unit that the numbers would be in.
    """
    unit, parameters, numbers = values.get("unit"), parameters_of(make), dict(values)
    others = {name for name, one in parameters.items() if one.quantity.dimension not in _IN_UNIT}
    for name in sorted({"pixel_size", "spacing", *parameters} & values.keys() - others):
        value = units.either(name, values[name], unit if isinstance(unit, str) else "m")
        written = any(written_with_units([value]))
        if unit is None and (written or (name == "pixel_size" and name not in parameters)):
            expected = ("the unit of all lengths beside ", Name(name))
            raise InputError("unit", expected=expected, got="none", cure={"unit": "um"})
        numbers[name] = np.asarray(value, dtype=np.float64).tolist() if written else value
    return numbers


def in_unit(make: Callable[_P, Field]) -> Maker[_P]:
    """Let a maker of heights take a ``unit``, and with it texts such as ``"50 nm"`` for lengths."""
    signature = inspect.signature(make)
    added = {name: kind for name, kind in _ADDED.items() if name not in signature.parameters}
    more = [inspect.Parameter(name, _KEYWORD, default=None, annotation=kind) for name, kind in added.items()]

    @functools.wraps(make)
    def call(*args: Any, unit: str | None = None, **options: Any) -> Any:
        if unit is not None:
            checks.choice("unit", unit := spelled(unit), LENGTHS)
        numbers = in_numbers(make, {"unit": unit, **options})
        heights = make(*args, **{name: x for name, x in numbers.items() if name not in added})
        if unit is None:
            return heights
        facts = {name: x for name, x in numbers.items() if isinstance(x, float | int | list | tuple)}
        size = numbers.get("pixel_size", numbers.get("spacing", 1.0))
        return Surface(heights, unit, size, unit, {"kind": make.__name__, **facts, "unit": unit})

    stated = signature.parameters.values()
    parameters = [one.replace(annotation=_ADDED.get(one.name, one.annotation)) for one in stated]
    whole = signature.replace(parameters=[*parameters, *more], return_annotation="Field | Surface")
    call.__signature__ = whole  # type: ignore[attr-defined]
    return cast(Maker[_P], call)
