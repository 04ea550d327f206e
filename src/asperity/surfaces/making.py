"""A decorator that gives a unit to functions that make heights, and annotations of their arguments."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal, ParamSpec, Protocol, cast, overload

import numpy as np
from annotated_types import Ge, Gt, Le, Len, Lt
from numpy.typing import NDArray

from asperity.base import checks, units
from asperity.base.parameters import Quantity
from asperity.base.words import written_with_units
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.surfaces.prepare import LENGTHS
from asperity.surfaces.surface import Surface

_P = ParamSpec("_P")

Length = float | str
Lengths = Length | Sequence[Length] | NDArray[np.float64]
"""One number, or several; each in m, or a text with a unit."""

MOST_SITES = 2**31
"""Sites along an axis: far beyond any memory, far below what numpy cannot count."""

Shape = Annotated[
    int | tuple[int, ...],
    *(Ge(1), Le(MOST_SITES), Len(1, 2)),
    Quantity(
        "sites along each axis", dimension="sites", more=": 200 200, or 4096 for a line.", usual=(200, 200)
    ),
]
Rng = int | np.random.Generator | None
Seed = Annotated[int, Ge(0), Lt(2**63), Quantity("seed of the random heights")]
Rms = Annotated[float, Gt(0), Quantity("rms height", dimension="height unit")]
PixelSize = Annotated[
    Lengths | None,
    *(Gt(0), Len(1, 2)),
    Quantity(
        "distance between sites",
        key="spacing",
        dimension="length unit",
        more=": one number, or one an axis.",
        usual=(1.0,),
    ),
]
Unit = Annotated[
    Literal["m", "mm", "um", "nm", "pm"] | None,
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


def in_unit(*lengths: str) -> Callable[[Callable[_P, Field]], Maker[_P]]:
    """Let a maker of heights take a ``unit``, and with it texts such as ``"50 nm"`` for these lengths."""

    def decorated(make: Callable[_P, Field]) -> Maker[_P]:
        signature = inspect.signature(make)
        added = {name: kind for name, kind in _ADDED.items() if name not in signature.parameters}
        more = [
            inspect.Parameter(name, _KEYWORD, default=None, annotation=kind) for name, kind in added.items()
        ]

        @functools.wraps(make)
        def call(*args: Any, unit: str | None = None, **options: Any) -> Any:
            sizes = {
                name: units.either(name, options[name], unit or "m")
                for name in (*lengths, "spacing", "pixel_size")
                if name in options
            }
            if unit is None:
                written = (name for name, value in sizes.items() if any(written_with_units([value])))
                if odd := next((name for name in (*added, *written) if name in options), None):
                    expected = f"the unit of all lengths beside {odd}"
                    raise InputError("unit", expected=expected, got="none", advice="unit='um'")
                return make(*args, **options)
            checks.choice("unit", unit, LENGTHS)
            in_numbers = {"unit": unit, **options, **sizes}
            heights = make(*args, **{name: x for name, x in in_numbers.items() if name not in added})
            facts = {name: x for name, x in options.items() if isinstance(x, float | int | list | tuple)}
            size = sizes.get("pixel_size", sizes.get("spacing", 1.0))
            return Surface(heights, unit, size, unit, {"kind": make.__name__, **facts, "unit": unit})

        parameters = [
            argument.replace(annotation=_ADDED.get(argument.name, argument.annotation))
            for argument in signature.parameters.values()
        ]
        whole = signature.replace(parameters=[*parameters, *more], return_annotation="Field | Surface")
        call.__signature__ = whole  # type: ignore[attr-defined]
        return cast(Maker[_P], call)

    return decorated
