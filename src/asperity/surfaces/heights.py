"""Checks of heights and of the size of pixels."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks, units
from asperity.base.readable import is_length
from asperity.base.words import as_text, has_unit
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.surfaces.prepare import spelled


def check_heights(heights: ArrayLike) -> Field:
    """Check heights and return them as the solver wants them.

    Parameters
    ----------
    heights
        Heights of a profile, shape ``(n,)``, or of a surface, shape ``(n, m)``: an array of integers
        or floats, nested lists of them, or an object with ``__array__``: a `Surface`, a masked array
        without masked entries, an xarray DataArray. They are -inf where there is no body.

    Returns
    -------
    ndarray of float64, C-contiguous
        Always a copy.

    Raises
    ------
    InputError
        The heights are not real numbers in one or two dimensions, are empty, have no body at all, or hold
        NaN, +inf or masked entries; the message counts these and names the first.
    """
    return checks.heights("heights", heights, holes=True)


def checked_spacing(name: str, value: object, axes: int) -> tuple[float, ...]:
    """Distance between sites along each axis, from one positive number or one for each axis."""
    spacings = checks.positive(name, value)
    if spacings.shape not in ((), (axes,)):
        expected = f"one number above 0, or {axes}, one an axis" if axes > 1 else "one number above 0"
        raise InputError(name, expected=expected, got=checks.shown(value))
    return tuple(np.broadcast_to(spacings, axes).tolist())


def sides_of_pixels(
    value: object, axes: int, length_unit: str | None
) -> tuple[tuple[float, ...], str | None]:
    """Distance between pixels along each axis, and its unit; texts such as "1 um" are converted to it.

    By default the unit is that of the first text, or the meter if that is not a usual one.
    """
    length_unit = length_unit and spelled(length_unit)
    written = value if isinstance(value, list | tuple) else [value]
    if texts := [text for text in map(as_text, written) if has_unit(text)]:
        unit = spelled(texts[0].lstrip("+-.0123456789eE "))
        length_unit = length_unit or (unit if is_length(unit) else "m")
    sides = units.either("pixel_size", value, length_unit or "m")
    return checked_spacing("pixel_size", sides, axes), length_unit
