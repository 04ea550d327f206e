"""Columns of a table: role and unit of each, from its name, a row of units, or the user."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np

from asperity.base import units as si
from asperity.base.checks import Floats
from asperity.base.words import shortened
from asperity.errors import LARGEST, InputError, Name
from asperity.sheets.tables import GROUPED, Table, read_table

Chosen = Sequence[int | str] | int | str
"""Columns by name or by number from 0: a list, or a text such as "0,1"."""

Units = Mapping[int | str, str] | Sequence[str] | str
"""Units by column: {"E": "MPa"}, "E=MPa" or a list of such texts."""

_ARGUMENT = r"(?:t|time|omega|ω|w|f|q|zeit|temps)"
_BRACKETS = re.compile(r"(.*?)[\s_,/]*[\[({<]\s*([^\[\](){}<>]*?)\s*[\])}>]")
_LOGARITHM = re.compile(r"(?i)(log_?10|log|lg|ln)(?:\s*\((.*)\)(.*)|[\s_.-]+(.*))")
_ANGULAR = re.compile(r"omega|ω|\bang\b|angul|radian|circular|kreis|winkel|pulsation|^w\b")
_CYCLES = re.compile(r"(?i)\b(?:r|cycles?|cyc|revs?|revolutions?|turns?|tours?|tr|u|umdr\w*|osc\w*)\b")
_RATIO = re.compile(r"(\w+) ?/ ?\1[ _(]*(?:0|o|n|nom|max|ref|i|inf)\)?")
_SCALED = {
    "a factor": re.compile(r"\b1e[+-]?\d|\b10 ?(?:\^|\*\*|[⁻⁰¹²³⁴-⁹])|[x×*·] ?10|(?<!\d)[×*·/] ?\d"),
    "a root": re.compile(r"(?i)sqrt|√|\broot\b|wurzel|racine|\^ ?[01]?[.,/]|^1 ?/"),
    "a logarithm": re.compile(r"(?i)(?:^|[\W_])(?:log_?10|log|lg|ln|logarithm\w*)(?:$|[\W\d_])"),
}
"""What stands in a name of other numbers than those of the quantity: to multiply by, or to divide?"""
_PARTS = re.compile(r"(?i)[%‰]|per ?cent|prozent|per ?mille?|promille|(?<![a-z])ppm|micro|[uµμ][eε]\b")
_DATE = re.compile(r"\d{1,4}[-/.:]\d{1,2}[-/.:T ]?")
_LEAVE_OUT = "a # before a line to leave it out"
_OF_TIME = {"Hz", "mHz", "kHz", "MHz", "GHz", "s", "ms", "us", "µs", "μs", "min", "h", "d"}
_EXAMPLES = {"s": "min", "Pa": "MPa", "1/Pa": "1/GPa", "rad/s": "rad/s", "m": "um", "m/s": "um/s", "": "um^2"}


@dataclass(frozen=True)
class Role:
    """A role of columns: its name, or "" for ignored columns; its unit, and its words.

    The unit is in Pint's spelling, "1" for a pure number and "" for any. The words are a pattern for names
    without units, in small letters, without accents, and with blanks for underscores.
    """

    name: str
    unit: str
    words: str


TIME = Role("time", "s", r"\btime\b|zeit|temps|duree|dauer|elapsed|ecoule|^t( ?/ ?a ?t)?$|^a ?t ?[*·]? ?t$")


class Columns:
    """The columns of a table, by the first of several roles whose words are in the name of each.

    `columns` choose, by default all. `units` replace those of the table. Names of `unknown` columns have no
    words of a role. `InputError` without such a table or column.
    """

    def __init__(
        self,
        path: Path | str | Table,
        roles: Sequence[Role],
        columns: Chosen | None = None,
        units: Units | None = None,
    ) -> None:
        self.table = path if isinstance(path, Table) else read_table(Path(path))
        self._roles, self._wanted = roles, {role.name: role for role in roles}
        meanings = [self._meaning(name) for name in self.table.names]
        self._parts = [parts for _, parts in meanings]
        self.logarithms = {at for at, parts in enumerate(self._parts) if parts.base is not None}
        numbers = {role for at, (role, _) in enumerate(meanings) if at not in self.logarithms}
        # Logarithms beside their numbers are left alone.
        alone = {at for at in self.logarithms if meanings[at][0] in numbers}
        self.roles = ["" if at in alone else role or "" for at, (role, _) in enumerate(meanings)]
        self.unknown = [at for at, (role, _) in enumerate(meanings) if role is None]
        self.chosen = [*range(len(self.roles))] if columns is None else positions(self.table, columns)
        self._stated = self._by_column(units)
        self._read: dict[int, str] = {}

    @cached_property
    def by_role(self) -> dict[str, int]:
        """Place of the column of each role; `InputError` if two have one role."""
        columns: dict[str, int] = {}
        for at in self.chosen:
            if (role := self.roles[at]) in columns:
                got = f"{self.table.names[columns[role]]!r} and {self.table.names[at]!r}"
                advice = Name("columns"), " with one of them"
                raise InputError(self.table.name, expected=f"one column of {role}", got=got, advice=advice)
            columns |= {role: at} if role else {}
        return columns

    @property
    def read(self) -> str:
        """One line on columns read and left out; `InputError` if `units` name other columns."""
        if others := [at for at in self._stated if at not in self._read]:
            expected = f"units of the columns that are read, {', '.join(map(str, self._read))}"
            raise InputError("units", expected=expected, got=f"one of column {others[0]}")
        names = [repr(name) for at, name in enumerate(self.table.names) if name and at not in self._read]
        left_out = shortened(f"; left out {', '.join(names)}" * bool(names), 120)
        return f"{self.table.name}: {', '.join(self._read.values())}, {len(self.table.lines)} rows{left_out}"

    def unit(self, role: str, at: int | None = None) -> str:
        """Unit of a column as written, "" for none; `InputError` if it is not understood."""
        return self._unit(self._wanted[role], self.by_role[role] if at is None else at)[0]

    def values(
        self, role: str, at: int | None = None, *, bare: bool = True, convert: bool = True, called: str = ""
    ) -> Floats:
        """Numbers of a column in the unit of the role; of logarithms the numbers themselves.

        Without a unit they stay as they are, if they may be `bare`; with one, unless they are to `convert`.
        `InputError`, with the line, if one is missing, or their unit is missing or not understood. What was
        read is `called` so in the line on it.
        """
        at, wanted = self.by_role[role] if at is None else at, self._wanted[role]
        base, name = self._parts[at].base, self.table.names[at]
        if base == 0:
            advice = "log10(...), lg(...) or ln(...) for its name"
            raise InputError(self._about(at), expected="a base of the logarithm", got="none", advice=advice)
        values = _finite(self.table, at, role)
        unit, factor = self._unit(wanted, at)
        if not (unit or bare or wanted.unit == "1"):
            raise self._no_unit(wanted, at, "none")
        if base:
            if (too_large := values > (most := math.log(LARGEST, base))).any():
                raise in_line(self.table, int(np.argmax(too_large)), at, role, f"of at most {most:.4g}")
            values = base**values
        words = f"{called or role} from {repr(name) if name else f'column {at}'}"
        words += f" in {unit}" * (unit not in ("", "1", "-"))
        words += f", {factor:.6g} rad/s each" * (wanted.unit == "rad/s" and "rad" not in unit)
        words += " without a unit" * (not unit and wanted.unit not in ("", "1"))
        self._read[at] = words + ", by its antilogarithm" * bool(base)
        return values * factor if convert else values

    def label(self, at: int) -> str:
        """Name of a column without its unit."""
        return self._parts[at].label.strip()

    def scaled(self, at: int) -> list[str]:
        """What stands in a name of other numbers than those of the quantity."""
        return [scale for scale, words in _SCALED.items() if words.search(self._parts[at].label)]

    def unit_text(self, at: int) -> str:
        """Unit of a column from a row of units, or else from its name, without a role."""
        return self.table.units[at] or self._parts[at].unit

    def _meaning(self, name: str) -> tuple[str | None, _Parts]:
        """Role of a name, and its parts: the first with a role; None without any."""
        every = _parts(name)
        for parts in every:
            if re.fullmatch(r"T([ _]?°?[CKF])?", parts.label.strip()):  # a temperature
                return "", parts
            roles = (role for role in self._roles if re.search(role.words, normal(parts.label)))
            if role := next(roles, None):
                return role.name, parts
        return None, every[0]

    def _unit(self, role: Role, at: int) -> tuple[str, float]:
        """Unit from the user, a row of units, or the name; and its factor to the unit of the role."""
        parts, name = self._parts[at], normal(self.table.names[at])
        below, beside = self.table.units[at], parts.unit
        if role.unit in ("1", "") and not parts.is_clear and re.fullmatch("[a-z]", beside):
            beside = ""  # mu_s is static friction
        text = self._stated.get(at) or below or beside
        scaled = self.scaled(at)
        scaled += ["a part of one"] * bool(role.unit == "1" and not below and _PARTS.search(parts.label))
        if at not in self._stated and scaled:
            raise self._no_unit(role, at, f"{scaled[0]} in the name")
        *words, last = name.split() or [""]
        if (
            not text
            and role.unit not in ("1", "")
            and words[-1:] != ["of"]
            and re.search(role.words, " ".join(words))
            and len(last) > 2
            and si.factor(last, last) is not None  # time_furlong
        ):
            written = [one for one in re.split(r"[\s_]+", self.table.names[at]) if normal(one) == last]
            word = (written or [last])[-1]
            mega = word[0] == "M" and si.factor(last[1:], last[1:])  # in small letters milli
            text = word if mega or si.factor(word, word) is not None else last
        if not text or not role.unit:
            return text, 1.0
        is_angular, is_stated = _ANGULAR.search(normal(parts.label)) is not None, at in self._stated
        factor = _in(text, role.unit, is_angular, is_stated=True) if is_stated else None
        if factor is None and (is_stated or not below or beside in ("", below)):  # not two units
            factor = _in(self._spelled(text), role.unit, is_angular)
        if factor is None:
            raise self._no_unit(role, at, repr(text))
        return text.removeprefix("in "), factor

    def _spelled(self, unit: str) -> str | None:
        """A unit in Pint's spelling; None of milli or mega among names and units in capitals alone."""
        written = "".join([*self.table.names, *self.table.units])
        units = [self.unit_text(at) for at in range(len(self._parts))]
        in_case = all(one in ("", "-", si.spelled(one)) for one in units)
        unclear = written.isupper() and not in_case and re.search(r"\bM(N|PA|HZ|J|W)\b", unit)
        return None if unclear else si.spelled(unit)

    def _no_unit(self, role: Role, at: int, got: str) -> InputError:
        example, name = _EXAMPLES.get(role.unit, role.unit), self.table.names[at]
        column = name if re.fullmatch(r"\w[\w ]*", name) else at
        expected = f"a unit of {role.name}, such as {example}"
        if at in self._stated:
            return InputError("units", expected=expected, got=got)
        if got == "none":
            cure = {"units": f"{column}={example}"}
            return InputError(self._about(at), expected=expected, got=got, cure=cure)
        # Another example would be another factor.
        advice = Name("units"), " with the one of its numbers"
        return InputError(self._about(at), expected=expected, got=got, advice=advice)

    def _about(self, at: int) -> str:
        return f"column {self.table.names[at] or at!r} of {self.table.name}"

    def _by_column(self, units: Units | None) -> dict[int, str]:
        """Units stated by the user, by place of the column; a role is a name, too."""
        if not isinstance(units, Mapping):
            parts = re.split(r"\s*[,;]\s*", units) if isinstance(units, str) else []
            several = len(parts) > 1 and all("=" in part for part in parts)
            pairs = parts if several else [units] if isinstance(units, str) else units or []
            if wrong := [pair for pair in pairs if "=" not in str(pair)]:
                raise InputError("units", expected="a column and its unit, such as 1=MPa", got=repr(wrong[0]))
            units = dict(str(pair).rpartition("=")[::2] for pair in pairs)
        roles = {}
        for column, unit in units.items():
            is_role = str(column) not in self.table.names and self.roles.count(str(column)) == 1
            at = self.roles.index(str(column)) if is_role else position(self.table, column)
            roles[at] = str(unit).strip()
        return roles


def normal(text: str) -> str:
    """A name in small letters, without arguments and accents, and with blanks for underscores."""
    text = re.sub('["”]', "''", re.sub("[’ʹ´′]", "'", text)).replace("œ", "oe")
    text = unicodedata.normalize("NFKD", text).replace("′", "'")
    text = "".join(c for c in text if not unicodedata.combining(c)).lower()
    return " ".join(re.sub(rf"\({_ARGUMENT}\)", " ", text).replace("_", " ").split())


@dataclass(frozen=True)
class _Parts:
    """Label and unit of a name, whether a bracket or slash separates them, and the base of a logarithm.

    The base is 0 for one that is not stated, and None where the column has the numbers themselves.
    """

    label: str
    unit: str = ""
    is_clear: bool = False
    base: float | None = None


def _parts(name: str) -> list[_Parts]:
    if logarithm := _LOGARITHM.fullmatch(name):
        base = {"log": 0.0, "ln": math.e}.get(logarithm[1].lower(), 10.0)
        inner = f"{logarithm[2]}{logarithm[3]}" if logarithm[2] else logarithm[4]
        return [replace(parts, base=base) for parts in _parts(inner)]
    if bracket := _BRACKETS.fullmatch(name):
        label, inner = bracket.groups()
        if not re.fullmatch(f"{_ARGUMENT}|0", inner if len(inner) == 1 else inner.lower()):  # (W) is a unit
            return [_Parts(label, inner, is_clear=True), _Parts(name)]
    pairs = [
        _Parts(label, unit, is_clear="/" in separator[0])
        for separator in re.finditer(r"\s*/\s*|\s+[-–]\s+|[_,:\s]+", name)
        if (label := name[: separator.start()])
        and not label.endswith(" of")
        and (unit := name[separator.end() :])
        and ("/" in separator[0] or si.is_usual(unit))
        and not _RATIO.fullmatch(normal(f"{label}/{unit}"))
    ]
    first, _, rest = name.partition(" ")
    if (rest and len(first) > 1 and si.is_usual(first)) or first == "%":
        pairs.append(_Parts(rest, first))
    return [*pairs, _Parts(name, name if len(name) > 3 and si.is_usual(name) else "")]  # minutes


def _in(unit: str | None, target: str, is_angular: bool, is_stated: bool = False) -> float | None:
    """Factor of a unit to another; None for another kind, and for cycles of angular quantities."""
    if unit is None or target != "rad/s":
        return None if unit is None else 1.0 if unit == target else si.factor(unit, target)
    if re.search("rad|deg|°", unit):
        return None if "grad" in unit.lower() else si.factor(unit.replace("°", "deg"), target)
    counted = re.sub("[rc]pm", "1/min", re.sub("[rc]ps", "1/s", unit))
    counted = _CYCLES.sub("1", counted)
    if not _OF_TIME.issuperset(re.findall("[A-Za-zµμ]+", counted)):  # Pint takes a turn for 2 pi
        return None
    if (factor := si.factor(counted, "1/s")) is None or ("Hz" in unit and is_angular and not is_stated):
        return None
    return factor * (1 if is_angular and counted == unit and "Hz" not in unit else 2 * math.pi)


def _finite(table: Table, at: int, role: str) -> Floats:
    """Numbers of a column; `InputError` with the line of a missing one."""
    values = table.values[:, at]
    if (finite := np.isfinite(values)).all():
        return values
    row, advice = int(np.argmin(finite)), _LEAVE_OUT
    cell = table.cell(row, at)
    if GROUPED.fullmatch(cell):
        advice = "numbers without separators between thousands"
    elif not finite.any():
        numeric = np.flatnonzero(np.isfinite(table.values).any(axis=0))
        names = ", ".join(repr(table.names[i]) if table.names[i] else str(i) for i in numeric)
        advice = f"to choose columns of numbers ({names})"
        advice += f"; a {role} is a number, not a date" * bool(_DATE.match(cell))
    raise in_line(table, row, at, role, "to be a number", advice)


def in_line(
    table: Table, row: int, at: int, role: str, expected: str, advice: str = _LEAVE_OUT
) -> InputError:
    """The error about a cell, with its column and line."""
    name, (number, line) = table.names[at], table.lines[row]
    expected = f"{repr(name) if name else f'a {role}'} {expected} in line {number}"
    return InputError(table.name, expected=expected, got=repr(line.strip()[:60]), advice=advice)


def check_one_series(table: Table, at: int) -> None:
    """Refuse blocks of rows, between which lines without numbers stand, that overlap in a column.

    Rows without a line between them may stand in any order: they are one series.
    """
    numbers, column = np.array([number for number, _ in table.lines]), table.values[:, at]
    starts = np.flatnonzero(np.diff(numbers, prepend=numbers[:1]) > 1)
    blocks = [block for block in np.split(np.arange(len(numbers)), starts) if block.size > 1]
    for before, after in pairwise(blocks):
        (low, high), (least, most) = ((column[rows].min(), column[rows].max()) for rows in (before, after))
        if low < most and least < high:
            expected = f"one series of {table.names[at] or f'column {at}'}"
            got = f"one up to line {numbers[before[-1]]}, another from line {numbers[after[0]]} on"
            advice = "a file of one of them; of one series no lines between its rows"
            raise InputError(table.name, expected=expected, got=got, advice=advice)


def named(table: Table) -> str:
    """Names of the columns of a table, for messages."""
    names = ", ".join(repr(name) for name in table.names if name)[:120]
    return f"columns {names}" if names else f"{len(table.names)} columns without names"


def positions(table: Table, columns: Chosen) -> list[int]:
    """Places of columns, from names and numbers from 0, also several in one text."""
    places = []
    for column in [columns] if isinstance(columns, int | str) else columns:
        text = str(column).strip()
        inner = text.strip("[]() ")
        by_marks = (re.split(r"\s*[,;]\s*", one) for one in (text, inner))
        ways = [[text], *by_marks, re.findall(r"[^,;\s]+", inner)]
        known = (words for words in ways if all(word in table.names or word.isdecimal() for word in words))
        places += [position(table, word) for word in next(known, [text]) or [text]]
    return places


def position(table: Table, column: int | str) -> int:
    """Place of a column, from its name or its number from 0; `InputError` if there is none."""
    name = str(column).strip()
    if name in table.names:
        return table.names.index(name)
    if name.isdecimal() and int(name) < len(table.names):
        return int(name)
    choices = f"one of {named(table).removeprefix('columns ')}, or " if any(table.names) else ""
    expected = f"{choices}a number from 0 to {len(table.names) - 1}"
    raise InputError(f"column {column!r} of {table.name}", expected=expected, got="no such column")
