"""The one door through which heights come in."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks, units
from asperity.base.words import as_text, has_unit
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.surfaces.prepare import is_length


def check_heights(heights: ArrayLike) -> Field:
    """Check heights and return them as the solver wants them.

    Parameters
    ----------
    heights
        Heights of a profile, shape ``(n,)``, or of a surface, shape ``(n, m)``: an array of integers
        or floats, nested lists of them, or anything that turns itself into one (``__array__``), such
        as a `Surface`, a masked array without masked entries or an xarray DataArray.

    Returns
    -------
    ndarray of float64, C-contiguous
        Always a copy: what the caller does to the original afterwards changes nothing.

    Raises
    ------
    InputError
        If the heights are not real numbers in one or two dimensions, are empty, or hold NaN,
        infinite or masked entries; the message says how many, and where the first one is.
    """
    return checks.heights("heights", heights)


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

    Where no unit is given, it is that of the first text, or the meter if that is none of the usual ones.
    """
    value = as_text(value)
    written = [value] if isinstance(value, str) else value
    texts = [as_text(side) for side in written if has_unit(side)] if isinstance(written, list | tuple) else []
    if texts:
        unit = texts[0].lstrip("+-.0123456789eE ").strip().replace("µ", "u").replace("μ", "u")
        length_unit = length_unit or (unit if is_length(unit) else "m")
        written = units.numbers("pixel_size", written, length_unit)
    if isinstance(value, str) and isinstance(written, list):
        (written,) = written
    return checked_spacing("pixel_size", written, axes), length_unit
