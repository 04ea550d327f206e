"""Words and numbers as HTML, and as plain text.

Texts of studies are plain, with the tags i, sub and sup; whatever else they hold is shown as it is.
"""

import math
import re

from markupsafe import Markup, escape

from asperity.errors import InputError
from asperity.fits import Estimate

UNKNOWN = "not determined"

_TAG = re.compile(r"(</?(?:i|sub|sup)>)")
_E_NOTATION = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]\d+)\b")
_LARGE, _SMALL, _NARROW = 1e5, 1e-3, 1e-6


def rich(text: str) -> Markup:
    """Return a text as HTML: tags i, sub and sup are kept, all else is escaped, 2e-05 has a power of ten.

    `InputError` for a tag that is not closed, or not in its turn: it would reach into what follows.
    """
    pieces, opened = [], list[str]()
    for index, piece in enumerate(_TAG.split(text)):
        if index % 2 and piece.startswith("</") and opened[-1:] == [piece.strip("</>")]:
            opened.pop()
        elif index % 2:
            opened.append(piece.strip("<>"))  # a tag that closes nothing stays, with its slash
        pieces.append(Markup(piece) if index % 2 else _words(piece))
    if opened:
        raise InputError("text", expected="tags i, sub and sup that are closed in turn", got=repr(text))
    return Markup("").join(pieces)


def plain(text: str) -> str:
    """Return a text without tags: F_N, 10^6, F^(0.8)."""
    raised = re.sub(r"<sup>([^<]{2,})</sup>", r"^(\1)", text).replace("<sup>", "^")
    return _TAG.sub("", raised.replace("<sub>", "_"))


def number(value: float) -> Markup:
    """Return a number to four digits; with a power of ten if it is large or small."""
    if math.isnan(value):
        return escape(UNKNOWN)
    if math.isinf(value):
        return escape("∞" if value > 0 else "−∞")
    mantissa, exponent = f"{value:.3e}".split("e")
    if value == 0 or _SMALL <= abs(value) < _LARGE:
        return _signed(_short(f"{value:.{max(0, 3 - int(exponent))}f}"))
    return _scaled(_short(mantissa), int(exponent))


def interval(estimate: Estimate) -> Markup:
    """Return a number with its 95 % interval in brackets, to the second digit of the interval's half width.

    Without brackets if nothing is random, one run does not tell, or the interval is beyond the sixth digit.
    """
    value, low, high = (float(end) for end in (estimate.value, estimate.low, estimate.high))
    largest = max(abs(value), abs(low), abs(high))
    if not math.isfinite(value + high - low) or high - low <= _NARROW * largest:
        return number(value)
    exponent = 0 if _SMALL <= largest < _LARGE else math.floor(math.log10(largest))
    scale = 10.0**exponent
    decimals = max(0, 1 - math.floor(math.log10((high - low) / 2 / scale)))
    written = [_signed(f"{end / scale:.{decimals}f}") for end in (value, low, high)]
    text = Markup("{} [{}, {}]").format(*written)
    return text if exponent == 0 else Markup("({}) × ").format(text) + _ten_to(exponent)


def bounds(low: float, high: float) -> Markup:
    """Return a range in words."""
    if math.isinf(low) and math.isinf(high):
        return escape("any number")
    if math.isinf(low):
        return escape("at most ") + number(high)
    if math.isinf(high):
        return escape("at least ") + number(low)
    return number(low) if low == high else number(low) + escape(" to ") + number(high)


def _words(text: str) -> Markup:
    """Escape a text without tags; with powers of ten."""
    parts = _E_NOTATION.split(text)
    pieces = [escape(parts[0])]
    for digits, exponent, after in zip(parts[1::3], parts[2::3], parts[3::3], strict=True):
        pieces += [_scaled(digits, int(exponent)), escape(after)]
    return Markup("").join(pieces)


def _scaled(digits: str, exponent: int) -> Markup:
    """Write digits times a power of ten; the power alone for 1."""
    power = _ten_to(exponent)
    return power if digits == "1" else _signed(digits) + escape(" × ") + power


def _short(digits: str) -> str:
    return digits.rstrip("0").rstrip(".") if "." in digits else digits


def _signed(digits: str) -> Markup:
    return escape(digits.replace("-", "−"))


def _ten_to(exponent: int) -> Markup:
    return Markup("10<sup>{}</sup>").format(_signed(str(exponent)))
