"""Columns of a table by their names: what each holds, and in which unit."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from asperity.base import units
from asperity.base.checks import Floats
from asperity.base.tables import Table
from asperity.errors import InputError

_ARGUMENT = r"t|time|omega|ω|w|f|q"


@dataclass(frozen=True)
class Roles:
    """What columns can hold.

    `patterns` are roles, each with what is found in a name without its unit, in small letters; the first that
    matches counts, and the role "" is for columns to leave alone. `units` are those of each role, in Pint's
    spelling; "1" for a pure number.
    """

    patterns: tuple[tuple[str, str], ...]
    units: Mapping[str, tuple[str, ...]]

    def of(self, name: str) -> tuple[str, str | None]:
        """What a column holds, or "", and its unit: "" for none, None for one that does not fit."""
        bracket = re.fullmatch(r"(.*?)\s*[\[({]([^\[\](){}]*)[\])}]", name)
        if bracket and not re.fullmatch(_ARGUMENT, bracket[2].strip().lower()):
            role, unit = self._meaning(bracket[1]), _spelled(bracket[2])
            return role, unit if not role or self.fits(role, unit) else None
        for separator in re.finditer(r"\s*/\s*|[_,\s]+", name):
            role, unit = self._meaning(name[: separator.start()]), _spelled(name[separator.end() :])
            if role and unit and self.fits(role, unit):
                return role, unit
        return self._meaning(name), ""

    def fits(self, role: str, unit: str) -> bool:
        """Whether a unit is one of the role's kind."""
        return any(unit == target or units.factor(unit, target) is not None for target in self.units[role])

    def _meaning(self, label: str) -> str:
        if label.strip() == "T":  # a temperature
            return ""
        label = re.sub(rf"\(({_ARGUMENT})\)", "", label.lower()).replace("_", " ").strip()
        return next((role for role, pattern in self.patterns if re.search(pattern, label)), "")


def _spelled(unit: str) -> str:
    """A unit as Pint spells it."""
    return re.sub(r"^(per|1)/", "1/", unit.strip().removeprefix("in ").replace("_", "/"))


def finite(table: Table, position: int, role: str) -> Floats:
    """Numbers of a column; `InputError` with the line where one is missing."""
    name = table.names[position]
    values = table.values[:, position]
    if not (known := np.isfinite(values)).all():
        number, line = table.lines[int(np.argmin(known))]
        raise InputError(
            table.name,
            expected=f"{repr(name) if name else f'a {role}'} to be a number in line {number}",
            got=repr(line.strip()[:60]),
            advice="a # before a line to leave it out",
        )
    return values


def named(table: Table) -> str:
    """The columns of a table by their names, for messages."""
    names = ", ".join(repr(name) for name in table.names if name)[:120]
    return f"columns {names}" if names else f"{len(table.names)} columns without names"


def position(table: Table, column: int | str) -> int:
    """Where a column stands, by its name or its number from 0; `InputError` where there is none."""
    name = str(column).strip()
    if name in table.names:
        return table.names.index(name)
    if name.isdecimal() and int(name) < len(table.names):
        return int(name)
    known = f"one of {named(table).removeprefix('columns ')}, or " if any(table.names) else ""
    expected = f"{known}a number from 0 to {len(table.names) - 1}"
    raise InputError(f"column {column!r} of {table.name}", expected=expected, got="no such column")
