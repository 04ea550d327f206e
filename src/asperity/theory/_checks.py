"""The door of the room `theory`: every number that is given is checked here, once."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError

Floats = NDArray[np.float64]


def numbers(name: str, value: ArrayLike) -> Floats:
    """Real numbers of any shape, as float64; `InputError` for anything else."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(name, expected="real numbers", got=repr(value)) from error
    if np.isnan(array).any():
        raise InputError(name, expected="real numbers", got="NaN among them")
    return array


def positive(name: str, value: ArrayLike) -> Floats:
    """Finite numbers above zero."""
    array = numbers(name, value)
    wrong = ~(np.isfinite(array) & (array > 0))
    if wrong.any():
        raise InputError(name, expected="finite numbers above 0", got=float(array[wrong].flat[0]))
    return array


def non_negative(name: str, value: ArrayLike, *, infinity: str = "") -> Floats:
    """Numbers not below zero; infinity is refused with this advice, or welcome where it is ``"welcome"``."""
    array = numbers(name, value)
    if (array < 0).any():
        raise InputError(name, expected="numbers not below 0", got=float(array.min()))
    if infinity != "welcome" and np.isinf(array).any():
        raise InputError(name, expected="finite numbers", got="inf", advice=infinity)
    return array


def broadcast(**arrays: Floats) -> list[Floats]:
    """Broadcast arrays against each other; `InputError` names them where their shapes do not match."""
    try:
        return list(np.broadcast_arrays(*arrays.values()))
    except ValueError as error:
        raise InputError(
            ", ".join(arrays),
            expected="shapes that broadcast against each other",
            got=", ".join(str(array.shape) for array in arrays.values()),
            advice="x1[:, None] with x2[None, :] for a table",
        ) from error


def creep_numbers(x1: ArrayLike, x2: ArrayLike, viscous: ArrayLike) -> list[Floats]:
    """Check k1/k0, k0 R t and R_tilde/R, broadcast against each other."""
    return broadcast(
        x1=positive("x1", x1),
        x2=non_negative("x2", x2, infinity="torus_compliance, which has a relaxed state"),
        viscous=non_negative("viscous", viscous, infinity="a large number"),
    )


def one(name: str, value: Floats) -> float:
    """One number of an array that should hold no more."""
    if value.ndim != 0:
        raise InputError(name, expected="one number", got=f"shape {value.shape}")
    return float(value)


def history(x2: ArrayLike, **values: ArrayLike) -> list[Floats]:
    """Times that never decrease and finite values at each of them: shape (n,), n at least 1."""
    arrays = {"x2": numbers("x2", x2)} | {name: numbers(name, value) for name, value in values.items()}
    times = arrays["x2"]
    if times.ndim != 1 or times.size == 0:
        raise InputError("x2", expected="times, shape (n,), n at least 1", got=f"shape {times.shape}")
    for name, array in arrays.items():
        if array.shape != times.shape:
            raise InputError(
                name, expected=f"a value a time, shape {times.shape}", got=f"shape {array.shape}"
            )
        if not np.isfinite(array).all():
            raise InputError(name, expected="finite numbers", got="inf among them")
    if (np.diff(times) < 0).any():
        raise InputError(
            "x2",
            expected="times that do not decrease",
            got="a decrease",
            advice="the same time twice for a jump",
        )
    return list(arrays.values())


def line_or_plane(dimension: int) -> int:
    """Return the dimension of the lattice: 1 or 2."""
    if dimension not in (1, 2):
        raise InputError("dimension", expected="1 (line contact) or 2", got=repr(dimension))
    return dimension


def rough_surface(name: str, heights: ArrayLike) -> Floats:
    """Heights of a lattice of one or two dimensions: finite, not empty."""
    array = numbers(name, heights)
    if array.ndim not in (1, 2) or array.size == 0:
        raise InputError(
            name, expected="an array of one or two dimensions, not empty", got=f"shape {array.shape}"
        )
    if not np.isfinite(array).all():
        raise InputError(name, expected="finite heights", got="inf among them")
    return array
