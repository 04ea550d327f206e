"""Surfaces that are made in a unit: one decorator gives it to all functions that make heights."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, Protocol, overload

from asperity.base import checks, units
from asperity.base.words import written_with_units
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.surfaces.prepare import LENGTHS
from asperity.surfaces.surface import Surface


class Maker(Protocol):
    """Makes heights, or with a unit a surface."""

    @overload
    def __call__(self, *args: Any, unit: str, **given: Any) -> Surface: ...

    @overload
    def __call__(self, *args: Any, **given: Any) -> Field: ...


def in_unit(*lengths: str) -> Callable[[Callable[..., Field]], Maker]:
    """Let what makes heights take a ``unit``, and with it texts such as ``"50 nm"`` for these arguments."""

    def decorated(make: Callable[..., Field]) -> Maker:
        signature = inspect.signature(make)
        added = [name for name in ("unit", "pixel_size") if name not in signature.parameters]
        more = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None) for name in added]

        @functools.wraps(make)
        def call(*args: Any, unit: str | None = None, **given: Any) -> Any:
            sizes = {name: given[name] for name in (*lengths, "spacing", "pixel_size") if name in given}
            sizes = {name: units.either(name, value, unit or "m") for name, value in sizes.items()}
            if unit is None:
                written = (name for name, value in sizes.items() if any(written_with_units([value])))
                if odd := next((name for name in (*added, *written) if name in given), None):
                    expected = f"the unit of all lengths beside {odd}"
                    raise InputError("unit", expected=expected, got="none", advice="unit='um'")
                return make(*args, **given)
            checks.choice("unit", unit, LENGTHS)
            heights = make(*args, **{name: one for name, one in (given | sizes).items() if name not in added})
            facts = {name: one for name, one in given.items() if isinstance(one, float | int | list | tuple)}
            size = sizes.get("pixel_size", sizes.get("spacing", 1.0))
            return Surface(heights, unit, size, unit, {"kind": make.__name__, **facts, "unit": unit})

        whole = signature.replace(parameters=[*signature.parameters.values(), *more])
        call.__signature__ = whole  # type: ignore[attr-defined]
        return call

    return decorated
