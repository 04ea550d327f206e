"""The one door through which heights come in."""

from __future__ import annotations

import numpy as np

from asperity.errors import LARGEST, InputError
from asperity.lattice import Field


def check_heights(heights: object) -> Field:
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
    if np.ma.isMaskedArray(heights):
        masked = np.argwhere(np.ma.getmaskarray(heights))
        if len(masked):
            raise InputError(
                "heights",
                expected="an array without masked entries",
                got=f"{len(masked)} masked of {np.size(heights)}, the first at {masked[0].tolist()}",
                advice="filling them: asperity.surfaces.read(path, undefined='fill') does for files",
            )
    array = _as_real_array(heights)
    if array.ndim not in (1, 2):
        raise InputError(
            "heights",
            expected="one or two dimensions",
            got=f"{array.ndim} dimensions, shape {array.shape}",
            advice="one layer of it, heights[0]" if array.ndim > 2 else "a profile or a surface",
        )
    if array.size == 0:
        raise InputError(
            "heights", expected="at least one height", got=f"an empty array, shape {array.shape}"
        )
    with np.errstate(over="ignore"):  # a long double that overflows becomes infinite, and is reported below
        result = np.array(array, dtype=np.float64, order="C", copy=True)
    _require_finite(result)
    if float(np.abs(result).max()) > LARGEST:
        raise InputError("heights", expected=f"heights up to {LARGEST:g}", got="larger ones")
    return result


def _as_real_array(heights: object) -> np.ndarray:
    """Turn anything into an array of a real numeric type."""
    expected = "an array of real numbers"
    # The array of a quantity of pint (magnitude), astropy or unyt (to_value) has lost its unit.
    if hasattr(heights, "magnitude") or hasattr(heights, "to_value"):
        advice = "its numbers in one unit, such as heights.to('um').magnitude or heights.to_value('um')"
        raise InputError(
            "heights", expected=expected, got=f"a {type(heights).__name__} with a unit", advice=advice
        )
    try:
        array = np.asarray(heights)
    except InputError:  # of a Surface whose pixels are not square
        raise
    except (TypeError, ValueError) as error:
        raise InputError("heights", expected=expected, got=f"{type(heights).__name__} ({error})") from error
    if array.dtype.kind not in "iuf":
        advice = "heights.real" if array.dtype.kind == "c" else ""
        got = f"{type(heights).__name__} of type {array.dtype}"
        raise InputError("heights", expected=expected, got=got, advice=advice)
    return array


def _require_finite(heights: Field) -> None:
    finite = np.isfinite(heights)
    if finite.all():
        return
    nans = int(np.isnan(heights).sum())
    infinite = int(heights.size - finite.sum()) - nans
    first = np.argwhere(~finite)[0].tolist()
    raise InputError(
        "heights",
        expected="finite numbers",
        got=f"{nans} NaN and {infinite} infinite of {heights.size}, the first at {first}",
        advice="filling them: asperity.surfaces.read(path, undefined='fill') does for files",
    )
