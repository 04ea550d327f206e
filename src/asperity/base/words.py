"""Text that people write and read: numbers, misspelled names, sizes and durations."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from difflib import get_close_matches
from typing import Any, Self

_WITH_UNIT = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*(?![eE][+-]?\d)[^\d\s,.].*")
_ONE_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?(\s*[^\W\d][^,]*)?")

PLAIN = {
    **{"µ": "u", "μ": "u", "²": "^2", "³": "^3", "⁴": "^4", "Å": "angstrom", "Ω": "ohm", "−": "-", "×": "x"},
    **{"χ": "chi", "θ": "theta", "→": "to", "±": "+-", "\u00a0": " ", "\u202f": " "},
}
"""Letters that not every terminal and no header of a table has, and what stands for them."""

UNKNOWN = "unknown: too few patches"
"""Why a scan has no band."""

MEANT = {
    **{"spacing": "pixel_size", "file": "path", "frictionless": "bonded", "E": "young", "nu": "poisson"},
    "friction": "friction_coefficient",
}
"""Arguments and keys that people write, and what to write where there is such a one."""


class InUnits(float):
    """A number that was written with a unit; its value is in SI.

    Of what has another unit for a line contact, `dimensions` are those of a surface that has this one, and
    `other` is the unit for others.
    """

    written: str
    unit: str
    dimensions: int | None
    other: str

    @classmethod
    def of(
        cls, value: float, written: str, unit: str, dimensions: int | None = None, other: str = ""
    ) -> Self:
        """Make one that remembers how it was written, and its unit in SI."""
        number = cls(value)
        number.written, number.unit = written, unit
        number.dimensions, number.other = dimensions, other
        return number


def written_with_units(table: object) -> Iterator[InUnits]:
    """Numbers that were written with a unit, within tables and lists."""
    if isinstance(table, InUnits):
        yield table
    elif isinstance(table, Mapping):
        for value in table.values():
            yield from written_with_units(value)
    elif isinstance(table, list | tuple):
        for value in table:
            yield from written_with_units(value)


def band_ends(ends: Iterable[float], say: Callable[[float], str] = "{:.4g}".format) -> str:
    """Two ends of the band of a scan, or, where they are NaN, why they are unknown."""
    low, high = ends
    if math.isnan(low):
        return UNKNOWN
    return f"{say(low)} to {say(high)}"


def to_digits(value: float, digits: int) -> str:
    """Write a number to so many digits: "-" for NaN, which is a number that does not exist."""
    if math.isfinite(value):
        return f"{value:.{digits}g}"
    return "-" if math.isnan(value) else "infinite" if value > 0 else "-infinite"


def finite(value: Any) -> Any:
    """Replace numbers that are not finite by null, for JSON."""
    if isinstance(value, Mapping):
        return {str(key): finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [finite(one) for one in value]
    if hasattr(value, "item"):  # of NumPy
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def number(word: str) -> object:
    """Read a number; a word that is none stays as it is."""
    for kind in (int, float):
        with suppress(ValueError):
            return kind(word)
    return word


def numbers(words: Iterable[str], *, whole: bool) -> list[object]:
    """Read a list of numbers, separated by spaces or commas.

    ``0,5`` may be one number with a decimal comma, or two: it stays a word, unless the numbers are whole.
    ``0.1,1`` and ``1,2,3`` can be read in one way only. An x separates whole numbers too: ``200x200``.
    Where words have units, each is one number: ``10 ms``.
    """
    words = list(words)
    if not whole and any(map(has_unit, words)):
        return [number(word.strip()) for word in words]
    values: list[object] = []
    for word in " ".join(words).split():
        if not whole and has_decimal_comma(word):
            values.append(word)
        else:
            separated = word.replace("x", ",") if whole else word
            values += [number(part) for part in separated.split(",") if part]
    return values


def as_text(value: Any) -> Any:
    """Write one number of Pint, or of xarray with its unit, as a text with a unit; leave others alone."""
    if hasattr(type(value), "magnitude") and hasattr(type(value), "units"):
        return f"{value.magnitude} {value.units:~}".replace(" ** ", "^")
    unit = unit_of(value)
    return f"{value.item()!r} {unit}" if unit and value.size == 1 else value


def unit_of(array: Any) -> str:
    """The unit that an array of xarray states; empty without one, and for a lattice's own units."""
    if not (hasattr(array, "attrs") and hasattr(array, "item")):
        return ""
    unit = str(array.attrs.get("units", ""))
    return "" if unit == "1" or re.search(r"\bunit|\bsite|\bspacing", unit) else unit


def has_unit(word: object) -> bool:
    """Whether a word looks like a number with a unit, or is a quantity of Pint."""
    word = as_text(word)
    return isinstance(word, str) and _WITH_UNIT.fullmatch(word) is not None


def has_decimal_comma(word: object) -> bool:
    """Whether a word may be a number with a decimal comma, and a unit."""
    return isinstance(word, str) and _ONE_COMMA.fullmatch(word) is not None


def uncertain(value: float, error: float) -> str:
    """Write a number with its standard error, both to the decimals that the error's two digits have."""
    if not (math.isfinite(error) and error > 0):
        return to_digits(value, 4) if error == 0 else f"{to_digits(value, 3)} (undetermined)"
    if error > abs(value):
        return f"{value:.2g} ± {float(f'{error:.1g}'):g}"
    number, of_error = to_error((value, error), error)
    return f"{number} ± {f'{error:.1g}' if 'e' in of_error else of_error}"


def to_error(values: Iterable[float], error: float) -> list[str]:
    """Write numbers to the decimals that the two digits of an error have; to four digits without one."""
    values = list(values)
    decimals = max(0, 1 - math.floor(math.log10(error))) if math.isfinite(error) and error > 0 else math.inf
    if decimals > 9 or max(map(abs, values)) >= 1e5:
        return [to_digits(value, 4) for value in values]
    return [f"{value:.{decimals}f}" for value in values]


def thousands(value: int) -> str:
    """Write a whole number with thin spaces between thousands."""
    return f"{value:,}".replace(",", "\u202f")


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


def counted(count: int, singular: str, plural: str = "") -> str:
    """Write how many there are of something: ``1 site``, ``2 sites``."""
    return f"{thousands(count)} {singular if count == 1 else plural or f'{singular}s'}"


def duration(seconds: float) -> str:
    """Write a time in the unit that suits it, to two digits."""
    if not math.isfinite(seconds):
        return "not determined"
    units = (("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0), ("seconds", 1.0))
    unit, length = next((u for u in units if seconds >= 1.5 * u[1]), units[-1])
    value = seconds / length
    return f"{value:.2g} {unit}" if value < 9.95 else f"{value:.0f} {unit}"


def data_size(count: float) -> str:
    """Write a number of bytes in the unit that suits it."""
    value = float(count)
    for unit in ("B", "kB", "MB", "GB"):
        if value < 1000:
            return f"{value:.3g} {unit}"
        value /= 1000
    return f"{value:.3g} TB"


def closest(word: str, choices: Iterable[str]) -> str | None:
    """The most similar name, with about two in three letters alike, without regard to case."""
    names = {name.casefold(): name for name in choices}
    near = get_close_matches(word.casefold(), names, n=1, cutoff=0.66)
    return names[near[0]] if near else None


def reason_of(error: BaseException) -> str:
    """Message of an error of a library, in one short line."""
    return shortened(" ".join(str(error).split()), 120) or type(error).__name__


def shortened(text: str, length: int = 80) -> str:
    """Cut a text that is too long for a line of a message."""
    return text if len(text) <= length else f"{text[: length - 3]}..."


def tables_to_toml(tables: Mapping[str, Any]) -> str:
    """Write tables as TOML, each list on one line, and each table of a list as a section."""
    import tomli_w

    text = tomli_w.dumps(tables, indent=100)  # which leaves no room for a table within a list
    text = text.encode(errors="replace").decode()  # TOML has no word for a name that is not in UTF-8
    # It writes an entry a line. Texts have no line breaks of their own, so lists end where these stand.
    text = re.sub(r",\n *\]", "]", text)
    return re.sub(r"\[\n +", "[", re.sub(r",\n +", ", ", text))
