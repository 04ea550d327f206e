"""What the figures share: colors that survive gray printing and color blindness, and number formats.

The hues are of the set of M. Okabe and K. Ito, "Color Universal Design" (2008), chosen so that their
luminances differ too. Styles are set on each artist: no global state is touched.
"""

from __future__ import annotations

import math

INK = "#000000"
BLUE = "#0072B2"
VERMILION = "#D55E00"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GRAY = "#8C8C8C"
HEIGHT_MAP = "cividis"
"""Height maps: luminance grows with height, readable with any color vision."""

RESOLUTION = 200
"""Dots per inch of figures that are written as pixels."""


def verbatim(text: str) -> str:
    """Write a text from outside, such as a file's name, so that nothing in it is read as mathematics."""
    return text.replace("$", r"\$")


def power(value: float) -> str:
    """Write a number for a label: 0.25, 1000, or with a power of ten."""
    if value == 0:
        return "0"
    if math.isinf(value):
        return r"\infty"
    exponent = math.floor(math.log10(abs(value)) + 1e-9)
    if -3 < exponent < 4:
        return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
    mantissa = value / 10.0**exponent
    digits = f"{mantissa:.2g}"
    head = "" if digits == "1" else rf"{digits} \times "
    return rf"{head}10^{{{exponent}}}"


def uncertain(value: float, error: float) -> str:
    """Write a number with its standard error, both to the decimals that the error's two digits have."""
    if not (math.isfinite(error) and error > 0):
        return f"{value:.4g}" if error == 0 else rf"{value:.3g} (undetermined)"
    if error > abs(value):
        return f"{value:.2g} ± {float(f'{error:.1g}'):g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    if decimals > 6 or abs(value) >= 1e5:
        return f"{value:.4g} ± {error:.1g}"
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def count(value: int) -> str:
    """Write a whole number with thin spaces between thousands."""
    return f"{value:,}".replace(",", "\u202f")


def with_unit(quantity: str, unit: str) -> str:
    """Label an axis: quantity and unit, where it has one."""
    return quantity if unit == "1" else f"{quantity} [{spelled(unit)}]"


def spelled(unit: str) -> str:
    """Spell a unit as it is printed."""
    return {"um": "µm", "angstrom": "Å", "rms": "rms height"}.get(unit, verbatim(unit))
