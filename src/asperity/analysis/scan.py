"""Lengths in readable units."""

from __future__ import annotations

import math

from asperity.surfaces.prepare import is_length, length_factor

_DISPLAY_UNITS = ("pm", "nm", "um", "mm", "m")
"""Units of length in which figures count, rising by thousands."""

_PLAIN = (1e-2, 1e5)
"""Range of numbers without a unit that are written as they are."""


def readable(unit: str, span: float) -> tuple[str, float]:
    """Choose the unit in which a span is a number from 1 to 1000, and the factor to it.

    Numbers without a unit ("1") that are very small or large get a power of ten in its place, "1e-06".
    """
    if is_length(unit) and span > 0:
        for name in _DISPLAY_UNITS:
            factor = length_factor(unit, name) if name != unit else 1.0
            if 1 <= span * factor < 1000:
                return name, factor
    if unit == "1" and span > 0 and not _PLAIN[0] <= span < _PLAIN[1]:
        exponent = 3 * math.floor(math.log10(span) / 3)
        return f"1e{exponent:+03d}", 10.0**-exponent
    return unit, 1.0
