"""Measured values against hold time, from a table in a text file."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from asperity.base import views
from asperity.base.checks import Floats
from asperity.base.columns import position
from asperity.base.tables import GROUPED, MISSING, Table, read_table
from asperity.errors import InputError

_DATE = re.compile(r"\d{1,4}[-/.:]\d{1,2}[-/.:T ]?")
_LEAVE_OUT = "a # before a line to leave it out"


@dataclass(frozen=True, eq=False, repr=False)
class Measurements(views.Brief):
    """Columns of a table of measurements.

    Attributes
    ----------
    time, value
        Hold times, not below 0, and values above 0, in the order of the file, shape (n,).
    stderr
        Standard errors of the values, above 0, shape (n,); or None.
    time_name, value_name
        Names of the columns in the file's header, or "" where it has none.
    remarks
        What was decided about the table.
    """

    time: Floats
    value: Floats
    stderr: Floats | None
    time_name: str
    value_name: str
    remarks: tuple[str, ...] = ()


def read_measurements(
    path: Path | str,
    *,
    time: int | str | None = None,
    value: int | str | None = None,
    stderr: int | str | None = None,
) -> Measurements:
    """Read hold times and values, and if asked standard errors, from a table in a text file.

    Lines that begin with #, % or ; are comments; lines without any number before the first line of numbers
    are headers; semicolons, tabs, commas or blanks separate columns; numbers may have decimal commas.

    Parameters
    ----------
    path
        A text file with one line for each measurement; also the ``aging.csv`` of a run.
    time, value, stderr
        The columns: a name in the file's header, or a number, counted from 0. By default time and value
        are the first two, after the index 0, 1, 2, ... that pandas writes before them, if there is one.

    Raises
    ------
    InputError
        There is no such file or column, the file is no table of two columns or more, or a cell is not
        a finite number, a time below 0, a value or standard error not above 0; with the number of its line.
    """
    table = read_table(Path(path))
    indexed = _begins_with_index(table)
    asked = {"time": time, "value": value, "stderr": stderr}
    usual = {"time": int(indexed), "value": 1 + int(indexed), "stderr": None}
    chosen = {name: usual[name] if column is None else column for name, column in asked.items()}
    columns = {name: position(table, column) for name, column in chosen.items() if column is not None}
    if len(set(columns.values())) < len(columns):
        got = " and ".join(f"column {at}" for at in columns.values())
        raise InputError(str(path), expected=f"{' and '.join(columns)} in different columns", got=got)
    read = {name: _checked(table, at, name) for name, at in columns.items()}
    time_name, value_name = table.names[columns["time"]], table.names[columns["value"]]
    remark = f"column 0, without a name, counts the lines: took {time_name!r} for the hold times"
    return Measurements(
        time=read["time"],
        value=read["value"],
        stderr=read.get("stderr"),
        time_name=time_name,
        value_name=value_name,
        remarks=(remark,) if indexed and time is None else (),
    )


def _begins_with_index(table: Table) -> bool:
    """Whether the first column is what pandas writes: 0, 1, 2, ..., without a name among named columns."""
    name, *others = table.names
    counting = np.arange(len(table.lines))
    return (
        len(others) > 1
        and all(others)
        and name in ("", "Unnamed: 0")
        and np.array_equal(table.values[:, 0], counting)
    )


def _checked(table: Table, column: int, name: str) -> Floats:
    values = table.values[:, column]
    bad = ~np.isfinite(values) | (values < 0 if name == "time" else values <= 0)
    if not bad.any():
        return values
    row = int(np.argmax(bad))
    number, line = table.lines[row]
    what = repr(table.names[column]) if table.names[column] else f"a {name}"
    where, got = f"in line {number}", f"{line.strip()[:60]!r}"
    if np.isfinite(values[row]):
        expected = f"{what} {'not below' if name == 'time' else 'above'} 0 {where}"
        raise InputError(table.name, expected=expected, got=got, advice=_LEAVE_OUT)
    cell = table.cell(row, column)
    is_missing = cell.lower() in MISSING
    fault = "missing" if is_missing else "infinite" if np.isinf(values[row]) else "not a number"
    raise InputError(
        table.name,
        expected=f"{what} to be a number {where}",
        got=f"{got}, where it is {fault}",
        advice=_advice(table, cell, all_bad=bool(np.isnan(values).all())),
    )


def _advice(table: Table, cell: str, *, all_bad: bool) -> str:
    """What to do about a cell that is no number."""
    if GROUPED.fullmatch(cell):
        return "numbers without separators between thousands"
    if not all_bad:
        return _LEAVE_OUT
    numeric = np.flatnonzero(np.isfinite(table.values).any(axis=0))
    names = ", ".join(repr(table.names[i]) if table.names[i] else str(i) for i in numeric)
    choice = f"to choose columns of numbers ({names})"
    return f"{choice}; a hold time is a number, not a date" if _DATE.match(cell) else choice
