"""Checks of the numbers from which surfaces are made."""

from __future__ import annotations

import math
import numbers
import operator

from asperity.errors import InputError
from asperity.lattice import Lattice


def checked_number(name: str, value: object, *, expected: str) -> float:
    """Return `value` as a float if it is a finite real number; raise `InputError` otherwise."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise InputError(name, expected=expected, got=repr(value))
    return float(value)


def checked_positive(name: str, value: float) -> float:
    """Return `value` as a float if it is a positive, finite number; raise `InputError` otherwise."""
    expected = "a positive, finite number"
    number = checked_number(name, value, expected=expected)
    if number <= 0:
        raise InputError(name, expected=expected, got=repr(value))
    return number


def checked_integer(name: str, value: int, *, expected: str, least: int, advice: str = "") -> int:
    """Return `value` as an int if it is an integer of at least `least`; raise `InputError` otherwise.

    A float is refused even if it is whole: it mostly comes of a division that was meant to be exact.
    """
    try:
        integer = operator.index(value)
    except TypeError:
        raise InputError(name, expected=expected, got=repr(value), advice=advice) from None
    if isinstance(value, bool) or integer < least:
        raise InputError(name, expected=expected, got=repr(value), advice=advice)
    return integer


def checked_seed(seed: int) -> int:
    """Return `seed` if it is an integer that is not negative; raise `InputError` otherwise."""
    # None would ask numpy for entropy: a surface that nobody can make again.
    return checked_integer("seed", seed, expected="an integer, 0 or more", least=0)


def checked_shape(shape: int | tuple[int, ...]) -> tuple[int, ...]:
    """Return the shape of a lattice as a tuple; an integer is the length of a profile."""
    lengths = tuple(shape) if isinstance(shape, (tuple, list)) else (shape,)
    advice = "(200, 200), or 4096 for a line contact"
    checked = tuple(
        checked_integer("shape", n, expected="positive integers", least=1, advice=advice) for n in lengths
    )
    return Lattice(checked).shape
