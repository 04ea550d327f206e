"""The seam where another array library plugs in: CuPy, for example, to compute on a graphics card.

Solvers written to the array API standard (https://data-apis.org/array-api) take their functions from
`library` and hand numpy arrays back by `to_numpy`; transforms are those of `asperity.lattice`.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError, MissingExtraError
from asperity.lattice import Spectrum, namespace


def library(name: str) -> Any:
    """The array library of this name, in the dialect of the standard; refused if it lacks its transforms."""
    if name == "numpy":
        return np
    try:
        module = import_module(name)
    except ImportError as error:
        raise MissingExtraError(
            f"arrays={name!r} needs the library {name}, which is not installed"
        ) from error
    try:
        xp = namespace(module.empty(1))
        xp.fft.rfftn  # noqa: B018  (an extension of the standard, which a library may lack)
    except (AttributeError, TypeError) as error:
        raise InputError(
            "arrays",
            expected="an array library of the array API standard, with fft",
            got=repr(name),
            advice="'cupy'",
        ) from error
    return xp


def to_numpy(array: Any) -> NDArray[Any]:
    """Bring an array of any library to the host."""
    if isinstance(array, np.ndarray):
        return array
    if hasattr(array, "get"):  # CuPy
        return np.asarray(array.get())
    if hasattr(array, "cpu"):  # PyTorch
        return np.asarray(array.cpu().numpy())
    return np.array(np.from_dlpack(array))


def largest(field: NDArray[Any], xp: Any) -> float:
    """Largest magnitude in a field."""
    return max(float(xp.max(field)), -float(xp.min(field)))


def inner(a: NDArray[np.floating], b: NDArray[np.floating], xp: Any) -> float:
    """Inner product of two fields, summed in double precision over the rows.

    Not over the whole field at once: the linear-algebra library would divide it among threads, which gain
    nothing on so little work, and the last digits would depend on their number.
    """
    if a.ndim == 1:
        return float(xp.sum(a * b, dtype=xp.float64))
    return float(xp.sum(xp.vecdot(a, b), dtype=xp.float64))


def inverse(spectrum: Spectrum) -> Spectrum:
    """1 / S, and 0 where S vanishes."""
    return np.divide(1.0, spectrum, out=np.zeros_like(spectrum), where=spectrum > 0)
