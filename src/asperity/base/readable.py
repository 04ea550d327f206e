"""Quantities in units in which people read them."""

from __future__ import annotations

import math
import re
from typing import TypeGuard

from asperity.base.words import to_digits

_EXPONENTS = {"km": 3, "m": 0, "cm": -2, "mm": -3, "um": -6, "nm": -9, "angstrom": -10, "pm": -12, "fm": -15}
"""Powers of ten of the units of length."""

LENGTHS = tuple(_EXPONENTS)
"""Units of length."""

_DISPLAY_UNITS = ("pm", "nm", "um", "mm", "m")
"""Units of length of figures and texts, rising by thousands."""

_PREFIXES = {"": 1.0, "p": 1e-12, "n": 1e-9, "u": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9, "T": 1e12}
_PREFIXED = {
    "m^2": ("p", "n", "u", "m", ""),
    "m^3": ("n", "u", "m", ""),
    "m/s": ("p", "n", "u", "m", ""),
    "eV": ("m", "", "k"),
    "K": ("m", ""),
    "N": ("p", "n", "u", "m", "", "k", "M"),
    "N/m": ("n", "u", "m", "", "k", "M", "G"),
    "J": ("p", "n", "u", "m", "", "k", "M"),
    "J/m": ("p", "n", "u", "m", "", "k", "M"),
    "J/m^2": ("u", "m", "", "k"),
    "Pa": ("m", "", "k", "M", "G"),
    "Pa/m": ("", "k", "M", "G", "T"),
    "S/m^2": ("", "k", "M", "G"),
    "W/m^2/K": ("", "k", "M", "G"),
    "s": ("n", "u", "m", ""),
    "ohm": ("n", "u", "m", "", "k", "M"),
    "K/W": ("u", "m", "", "k", "M", "G"),
}
"""Prefixes of SI units other than the meter with which figures count, rising."""

_LEAST = {"m^2": 0.1}
"""The smallest number with a prefix, if not 1: 0.16 um^2 rather than 160000 nm^2."""

_PLAIN = (1e-2, 1e5)
"""Range of numbers without a unit that are written as they are."""

_MICRO = re.compile("^u(?=(?:m|N|J|Pa|s|ohm)\\b)")

_OWN = re.compile("unit|lattice|^$|^sites?$")
"""What is in the names of a user's own units, which are not written."""

_SMALLEST = 1e-3
"""The smallest number that is written with the smallest prefix; one below it is written without."""


def readable(unit: str, span: float) -> tuple[str, float]:
    """Choose the unit in which a span is a number from 1 to 1000, and the factor to it.

    Prefixes of areas are a million apart: their numbers are from 0.1 to 100 000.
    Numbers without a unit ("1") that are very small or large get a power of ten in its place, "1e-06".
    """
    if shown := display_unit(unit, span):
        return shown
    if unit in _PREFIXED and math.isfinite(span):
        power = {"m^2": 2, "m^3": 3}.get(unit, 1)
        least = _LEAST.get(unit, 1.0) * (1 - 1e-9)
        factors = {f"{prefix}{unit}": _PREFIXES[prefix] ** -power for prefix in _PREFIXED[unit]}
        fitting = [name for name, factor in factors.items() if abs(span) * factor >= least]
        name = fitting[-1] if fitting else unit if span == 0 else next(iter(factors))
        return name, factors[name]
    if unit == "1" and span > 0 and not _PLAIN[0] <= span < _PLAIN[1]:
        exponent = 3 * math.floor(math.log10(span) / 3)
        return f"1e{exponent:+03d}", 10.0**-exponent
    return unit, 1.0


def in_unit(value: float, unit: str) -> tuple[str, float]:
    """Unit in which a quantity is written, and the factor to it; "" for pure numbers and own units."""
    if not (unit in _PREFIXED or is_length(unit)) or not math.isfinite(value):
        return "" if unit == "1" or _OWN.search(unit) or not math.isfinite(value) else unit, 1.0
    name, factor = readable(unit, abs(value))
    return (unit, 1.0) if value and abs(value) * factor < _SMALLEST else (name, factor)


def written(value: float, unit: str, digits: int = 4) -> str:
    """Write a quantity: in SI with a prefix, of a user's own units the number alone; see `to_digits`."""
    name, factor = in_unit(value, unit)
    number = to_digits(value * factor, digits)
    number = f"{float(number):.0f}" if name and number.endswith(("e+03", "e+04", "e+05")) else number
    return f"{number} {name}".rstrip()


def printed(unit: str) -> str:
    """Spell a unit as it is printed: ``um^2`` as µm²."""
    return _MICRO.sub("µ", unit).replace("ohm", "Ω").replace("^2", "²").replace("^3", "³")


def is_length(unit: str | None) -> TypeGuard[str]:
    """Whether this is a unit of length that can be converted."""
    return unit in _EXPONENTS


def conversion(unit: str | None, target: str | None) -> float | None:
    """One `unit` in the `target` unit; None if one of them is no length."""
    return length_factor(unit, target) if is_length(unit) and is_length(target) else None


def display_unit(unit: str | None, span: float) -> tuple[str, float] | None:
    """Unit of length in which a span is a number from 1 to 1000, and the factor to it; else None."""
    for name in _DISPLAY_UNITS:
        factor = 1.0 if name == unit else conversion(unit, name)
        if factor is not None and 1 <= span * factor < 1000:
            return name, factor
    return None


def length_factor(unit: str, target: str) -> float:
    """One `unit` in the `target` unit; both are lengths."""
    power = _EXPONENTS[unit] - _EXPONENTS[target]
    # A division by a whole power of ten rounds once; a product with 1e-3 would round twice.
    return 10.0**power if power >= 0 else 1 / 10.0**-power
