"""Texts with a unit, such as "1 MPa", and quantities of Pint, as numbers in a stated unit.

Pint knows the units. It is imported for the first unit that is no SI prefix on the stated one: that takes a
third of a second.
"""

from __future__ import annotations

import functools
import re
import tokenize
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.base import checks
from asperity.base.words import (
    InUnits,
    as_text,
    has_decimal_comma,
    has_unit,
    unit_of,
    written_with_units,
)
from asperity.errors import InputError

if TYPE_CHECKING:
    import pint

_AVOGADRO = 6.02214076e23
"""1/mol, exact in the SI; without scipy, whose import would delay the help of commands."""

_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")
# A product of units with exponents of one digit, and no more: Pint evaluates whatever it reads.
_FACTOR = r"\(?(?:1(?=[ /]|$)|[A-Za-zµμΩÅ°%]+(?:\^-?\d)?)\)?"
_UNIT = re.compile(rf"{_FACTOR}(?:(?: ?[*/] ?| ){_FACTOR}){{0,5}}")
_EXPONENT = re.compile(r"(?<=[A-Za-zΩÅ])(?:\*\*)?(-?\d)")
_TIMES = "s ms us µs μs ns min h d Hz mHz kHz MHz rad deg rpm"
_FORCES = "N mN uN µN μN nN pN kN MN cN daN lbf kgf"
_USUAL = f"{_TIMES} ks Pa hPa mbar kPa MPa GPa bar psi ksi {_FORCES} m cm mm um µm μm nm".split()
_IN_WORDS = {
    "s": r"secs?|seconds?|sek|sekunden?|secondes?",
    "min": r"mins|minutes?|minuten",
    "h": r"hrs?|hours?|std|stunden?|heures?",
    "d": r"days?|tage?|jours?",
    "m": r"met(?:er|re)s?",
    "mm": r"millimet(?:er|re)s?",
    "um": r"mic|microns?|mi[ck]romet(?:er|re)s?",
    "nm": r"nanomet(?:er|re)s?",
    "%": r"percent|prozent|pourcent|pct",
    "N": r"newtons?",
    "kgf": r"kp|kilopond",
}
_PURE = ("-", "--", "/", "ohne", "dimensionless")
_PREFIXES = {"": 1.0, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
_BASES = {"s", "m", "N", "Pa", "J", "K", "W", "Hz", "ohm", "rad"}
_WITHOUT_PREFIX = ("minute", "hour", "day", "week", "year")
"""Units that have no prefix, though Pint takes hh for hectohours."""

_RAISED, _LOWERED = re.compile("[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+"), str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_POWER = re.compile(r"10(?:\^|(?=-))(-?\d{1,2})(?:[ *]+(?=[A-Za-zµμ1])|(?=/|$))")
_WORD = re.compile("[A-Za-zµμΩÅ]+")
_EXAMPLES = {
    "Pa": "1 MPa",
    "1/Pa": "0.5 1/GPa",
    "N": "10 N",
    "m": "2 um",
    "s": "10 s",
    "m/s": "1 um/s",
    "1": "1 %",
    "Hz": "10 Hz",
    "rad/s": "60 rad/s",
    "m^3": "1 nm^3",
    "J": "1 eV",
    "K": "25 degC",
    "J/mol": "100 kJ/mol",
    "J/m^2": "50 mJ/m^2",
    "ohm m": "17 nohm m",
    "W/m/K": "0.2 W/m/K",
}
"""Quantities as people write them, by their units."""


def number(name: str, value: object, unit: str, *, of_line: str = "", **bounds: Any) -> float:
    """Check a number as `checks.number` does, or convert a text with a unit, such as ``"5 MPa"``.

    The unit may be another one for a line contact.
    A text becomes `InUnits`; callers ask `check_units` whether anything else has units.
    """
    text = as_text(value)
    if not (unit and isinstance(text, str)):
        checked = checks.number(name, value, **bounds)
        return value if isinstance(value, InUnits) else checked  # it is read twice, and remembers its unit
    if not has_unit(text):
        raise _no_quantity(name, text, unit)
    dimensions, other = 2 if of_line else None, of_line
    if of_line and (match := _NUMBER.fullmatch(text)) and factor(match[2], of_line) is not None:
        unit, dimensions, other = of_line, 1, unit
    amount = checks.number(name, quantity(text, unit, name), **bounds)
    return InUnits.of(amount, text, unit, dimensions, other)


def converted(
    name: str, value: float | str | None, unit: str, *, si: bool, of_line: str = "", dimensions: int = 2
) -> float | None:
    """Make a number of a text with a unit, checked by `check_units`; leave anything else to its checks."""
    value_in_unit = number(name, value, unit, of_line=of_line) if isinstance(as_text(value), str) else value
    check_units(value_in_unit, si=si, dimensions=dimensions, name=name)
    return value_in_unit  # type: ignore[return-value]


def numbers(name: str, values: object, unit: str) -> object:
    """Replace texts, one or several in a list, by numbers; leave anything else as it is."""
    if getattr(getattr(values, "magnitude", None), "ndim", 0) == 1:
        values = list(values)  # type: ignore[call-overload]
    elif (stated := unit_of(values)) and np.ndim(values) == 1:  # type: ignore[arg-type]
        values = [f"{one!r} {stated}" for one in np.asarray(values).tolist()]
    if isinstance(as_text(values), str):
        return [number(name, values, unit)]
    if isinstance(values, list | tuple) and any(isinstance(as_text(value), str) for value in values):
        return [number(name, value, unit) for value in values]
    return values


def either(name: str, value: object, unit: str) -> Any:
    """As `numbers`, but one text becomes one number."""
    return number(name, value, unit) if isinstance(as_text(value), str) else numbers(name, value, unit)


def check_units(*tables: object, si: bool, dimensions: int = 2, name: str = "units") -> None:
    """Refuse numbers with a unit in tables if nothing else has units; `InputError`.

    With `si` all is in SI. On a surface of one dimension forces are for each metre of its length: the error
    has that name.
    """
    for written in written_with_units(tables):
        if not si:
            expected = "plain numbers, as the surface or the solid has no units"
            advice = "half_space under Surface(heights, unit='um', pixel_size=..., length_unit='um')"
            raise InputError("units", expected=expected, got=repr(written.written), advice=advice)
        if written.dimensions not in (None, dimensions):
            whys = {1: "for each metre of the profile's length", 2: "as the surface is no profile"}
            expected = f"a number in {written.other}, {whys[dimensions]}"
            raise InputError(name, expected=expected, got=repr(written.written))


def quantity(value: object, unit: str, name: str = "quantity") -> float:
    """Convert a text such as ``"1 MPa"`` to a number in a unit; a number alone is in that unit already.

    The unit is in Pint's spelling: ``"Pa"``, ``"N"``, ``"J/mol"``. `InputError`, about the name, if it is
    no number, or its unit is unknown or of another kind.
    """
    value = as_text(value)
    if not isinstance(value, str):
        return checks.number(name, value)
    match, wrong = _NUMBER.fullmatch(value), _no_quantity(name, value, unit)
    if match is None:
        raise wrong
    amount = checks.number(name, float(match[1]), expected=str(wrong.expected))
    if not match[2]:
        return amount
    converted = _converted(amount, match[2], unit)
    if converted is None and unit == "J":  # of a bond, such as an energy of activation
        converted = _converted(amount / _AVOGADRO, match[2], "J/mol")
    if converted is None:
        raise wrong
    return checks.number(name, converted, expected=str(wrong.expected))


def _no_quantity(name: str, text: str, unit: str) -> InputError:
    match, example = _NUMBER.fullmatch(text), _EXAMPLES.get(unit, f"1 {unit}")
    cased = [word for word in _USUAL if match and match[2] and word.lower() == match[2].lower()]
    meant = next((word for word in cased if factor(word, unit) is not None), "")
    advice = f"{match[1]} {meant}, as case matters" if match and meant else ""
    advice = text.replace(",", ".") if has_decimal_comma(text) else advice
    expected = f"a quantity in {unit}, such as {example}"
    return InputError(name, expected=expected, got=checks.shown(text), advice=advice)


def usual_unit(unit: str) -> str:
    """A unit that people write for quantities of this one: MPa for Pa."""
    return _EXAMPLES.get(unit, f"1 {unit}").partition(" ")[2]


def is_usual(text: str) -> bool:
    """Whether a cell of a table looks like a unit: of usual ones, whatever their case, or a dash for none."""
    text = re.sub(r"^in[ _]", "", text.strip("[](){}<> "))
    words = [word for word in _WORD.findall(text) if word.lower() != "per"]
    # "std" is a standard deviation, too.
    are_units = (word in _USUAL or (_in_case(word) != word and word.lower() != "std") for word in words)
    return text in ("-", "%", "°C", "K") or (bool(words) and all(are_units))


def spelled(text: str) -> str | None:
    """A unit in Pint's spelling, from common spellings; None if its case leaves milli or mega open."""
    text = re.sub(r"^in[ _]", "", text.strip())
    text = re.sub(r"^(?:per|1)[ _/]+", "1/", text.rstrip(".")).replace("_", "/")
    words = {word: _in_case(word) for word in _WORD.findall(text)}
    if None in words.values():
        return None
    return "1" if text in _PURE else _WORD.sub(lambda match: str(words[match[0]]), text)


def _in_case(word: str) -> str | None:
    """A usual unit in its case: MPa for Mpa, but none for mpa, mPa or Ms."""
    near = [unit for unit in _USUAL if unit.lower() == word.lower()]
    if word in near or not near:
        in_words = (unit for unit, words in _IN_WORDS.items() if re.fullmatch(words, word.lower()))
        return word if near else next(in_words, word)
    if any(unit[0] in "mM" and unit[1:] in _USUAL for unit in near):
        near = [unit for unit in near if word[0] == unit[0] == "M"]
    return near[0] if near else None


def factor(unit: str, target: str) -> float | None:
    """Value of one `unit` in `target`; None where `unit` is unknown or of another kind."""
    return _converted(1.0, unit, target)


def _converted(amount: float, unit: str, target: str) -> float | None:
    prefix = _PREFIXES.get(unit.removesuffix(target))
    # Only the first unit has the prefix: mm^2 is (1e-3 m)^2, and k1/Pa is none.
    if prefix and unit.endswith(target) and target.partition("/")[0].split(" ")[0] in _BASES:
        return amount * prefix
    unit = _RAISED.sub(lambda match: f"^{match[0].translate(_LOWERED)}", unit).replace("·", "*")
    unit = re.sub(r"\s*/\s*", "/", _EXPONENT.sub(r"^\1", unit).replace("Ohm", "ohm"))
    unit = re.sub("[µμu]ε|µstrain|microstrain", "10^-6", unit)
    unit = re.sub("(?i)‰|per ?mille?|promille", "10^-3", unit)
    if power := _POWER.match(unit):
        amount, unit = amount * 10.0 ** int(power[1]), unit[power.end() :] or "1"
    unit = f"1{unit}" if unit.startswith("/") else unit
    if len(unit) > 40 or not _UNIT.fullmatch(unit):
        return None
    import pint

    registry = _registry()
    try:
        for word in _WORD.findall(unit):
            for multiple, name, _ in registry.parse_unit_name(word)[:1]:
                if multiple and name in _WITHOUT_PREFIX:
                    return None
        return float(registry.Quantity(amount, registry.parse_units(unit)).to(target).magnitude)
    except (pint.PintError, tokenize.TokenError, ArithmeticError, *_MISREAD):
        return None


# What Pint raises for texts that are no unit, besides its own errors.
_MISREAD = (AssertionError, AttributeError, KeyError, IndexError, SyntaxError, TypeError, ValueError)


@functools.cache
def _registry() -> pint.UnitRegistry[Any]:
    import pint

    return pint.UnitRegistry(cache_folder=None)
