"""Measured values against hold time, from a table in a text file.

Lines that begin with #, % or ; are comments, and what follows a # within a line is one. Lines without any
number before the first line of numbers are headers. Columns are separated by semicolons, tabs, commas or
blanks, and numbers may have decimal commas: of these possibilities, the one that reads most cells of the
first lines as numbers.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
import pandas as pd

from asperity.errors import InputError
from asperity.fits.curve import Floats

_COMMENTS = ("#", "%", ";")
# A comma separates cells unless something else does.
_DIALECTS = ((";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", "."), (r"\s+", "."), (r"\s+", ","))
_LOOKED_AT = 100
"""First lines by which the separator is found."""

_GROUPED = re.compile(r"[+-]?\d{1,3}([,.' ]\d{3})+([.,]\d*)?")
"""A number with separators between thousands, that could not be read as it stands."""

_DATE = re.compile(r"\d{1,4}[-/.:]\d{1,2}[-/.:T ]?")
_LEAVE_OUT = "a # before a line to leave it out"


@dataclass(frozen=True, eq=False)
class Measurements:
    """Columns of a table of measurements.

    Attributes
    ----------
    time, value
        Hold times, not below 0, and values above 0, in the order of the file, shape (n,).
    stderr
        Standard errors of the values, above 0, shape (n,); or None.
    time_name, value_name
        Names of the columns in the file's header, or "" where it has none.
    """

    time: Floats
    value: Floats
    stderr: Floats | None
    time_name: str
    value_name: str


@dataclass(frozen=True, eq=False)
class _Table:
    """A text file, and how its table is written."""

    name: str
    lines: list[str]
    first: int
    """Index of the first line of numbers."""
    separator: str
    decimal: str
    columns: list[str]
    """Their names; empty strings where the file has none."""


def read_measurements(
    path: Path | str, *, time: int | str = 0, value: int | str = 1, stderr: int | str | None = None
) -> Measurements:
    """Read hold times and values, and if asked standard errors, from a table in a text file.

    Parameters
    ----------
    path
        A text file with one line for each measurement; also the ``aging.csv`` of a run.
    time, value, stderr
        The columns: a name in the file's header, or a number, counted from 0.

    Returns
    -------
    Measurements

    Raises
    ------
    InputError
        There is no such file or column, the file is no table of two columns or more, or a cell is not
        a finite number, a time below 0, a value or standard error not above 0; with the number of its line.
    """
    table = _table(Path(path))
    asked = {"time": time, "value": value} | ({} if stderr is None else {"stderr": stderr})
    columns = {name: _position(table, column) for name, column in asked.items()}
    if len(set(columns.values())) < len(columns):
        got = " and ".join(f"column {position}" for position in columns.values())
        raise InputError(str(path), expected=f"{' and '.join(columns)} in different columns", got=got)
    frame = _frame(table)
    read = {name: _checked(table, frame, position, name) for name, position in columns.items()}
    return Measurements(
        time=read["time"],
        value=read["value"],
        stderr=read.get("stderr"),
        time_name=table.columns[columns["time"]],
        value_name=table.columns[columns["value"]],
    )


def _table(path: Path) -> _Table:
    lines = _text(path).split("\n")
    head = list(islice(_content(lines), _LOOKED_AT))
    if not head:
        raise InputError(str(path), expected="a table of numbers", got="no line besides comments")
    scores = [_numeric_share([line for _, line in head], *dialect) for dialect in _DIALECTS]
    best = int(np.argmax(scores))
    separator, decimal = _DIALECTS[best]
    if scores[best] == 0:
        one = any(_is_number(line.strip(), ",") or _is_number(line.strip(), ".") for _, line in head)
        got = "one" if one else f"{head[-1][1].strip()[:40]!r}"
        raise InputError(str(path), expected="two columns of numbers or more", got=got)
    rows = [(i, _cells(line, separator)) for i, line in head]
    first, cells = next(row for row in rows if any(_is_number(cell, decimal) for cell in row[1]))
    # numpy and many instruments write the names as a comment: the last before the numbers.
    comments = [_cells(line.lstrip(" \t#%;"), separator) for line in lines[:first] if _is_comment(line)]
    headers = [row for i, row in rows if i < first] + comments[::-1]
    names = next((row for row in headers if len(row) == len(cells)), [""] * len(cells))
    return _Table(str(path), lines, first, separator, decimal, [name.strip("\"' ") for name in names])


def _text(path: Path) -> str:
    if path.is_dir() or not path.exists():
        got = "a folder" if path.is_dir() else "no such file"
        raise InputError(str(path), expected="a file with a table of numbers", got=got)
    content = path.read_bytes()
    wide = content.startswith((b"\xff\xfe", b"\xfe\xff"))
    try:
        text = content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")  # a µ of another age, in a header
    if "\0" in text:
        raise InputError(str(path), expected="text", got="binary data", advice="exporting it as CSV")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _content(lines: list[str]) -> Iterator[tuple[int, str]]:
    """Lines with their indices, without comments and empty lines."""
    for i, line in enumerate(lines):
        if not _is_comment(line) and (content := line.partition("#")[0]).strip():
            yield i, content


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENTS)


def _cells(line: str, separator: str) -> list[str]:
    cells = line.split(None if separator == r"\s+" else separator)
    return [cell.strip() for cell in cells]


def _is_number(cell: str, decimal: str) -> bool:
    if decimal == "," and "." in cell:
        return False
    try:
        float(cell.strip("\"'").replace(decimal, "."))
    except ValueError:
        return False
    return True


def _numeric_share(lines: list[str], separator: str, decimal: str) -> float:
    """Share of the cells that are numbers, averaged over the lines; lines of one cell count as none."""
    shares = []
    for line in lines:
        cells = _cells(line, separator)
        numeric = sum(_is_number(cell, decimal) for cell in cells)
        shares.append(numeric / len(cells) if len(cells) > 1 else 0.0)
    return float(np.mean(shares))


def _position(table: _Table, column: int | str) -> int:
    if str(column).strip() in table.columns:
        return table.columns.index(str(column).strip())
    if str(column).isdecimal() and int(column) < len(table.columns):
        return int(column)
    known = ", ".join(repr(name) for name in table.columns if name)
    choice = f"one of {known}, or " if known else ""
    expected = f"{choice}a number from 0 to {len(table.columns) - 1}"
    raise InputError(f"column {column!r} of {table.name}", expected=expected, got="no such column")


def _frame(table: _Table) -> pd.DataFrame:
    body = list(_content(table.lines[table.first :]))
    try:
        return pd.read_csv(
            io.StringIO("\n".join(line for _, line in body)),
            sep=table.separator,
            decimal=table.decimal,
            header=None,
            skipinitialspace=True,
            low_memory=False,
        )
    except pd.errors.ParserError as error:
        width = len(table.columns)
        long = (item for item in body if len(_cells(item[1], table.separator)) > width)
        i, line = next(long, body[-1])
        raise InputError(
            table.name,
            expected=f"{width} columns in line {table.first + i + 1}, as before",
            got=f"{line.strip()[:60]!r}",
        ) from error


def _checked(table: _Table, frame: pd.DataFrame, position: int, name: str) -> Floats:
    raw = frame[position]
    cells = raw
    if cells.dtype.kind not in "if":  # some cell is no number: find which
        cells = pd.to_numeric(cells.astype(str).str.replace(table.decimal, "."), errors="coerce")
    values = cells.to_numpy(dtype=np.float64)
    bad = ~np.isfinite(values) | (values < 0 if name == "time" else values <= 0)
    if not bad.any():
        return values
    row = int(np.argmax(bad))
    what = repr(table.columns[position]) if table.columns[position] else f"a {name}"
    i, line = next(islice(_content(table.lines[table.first :]), row, None))
    where, got = f"in line {table.first + i + 1}", f"{line.strip()[:60]!r}"
    if np.isfinite(values[row]):
        expected = f"{what} {'not below' if name == 'time' else 'above'} 0 {where}"
        raise InputError(table.name, expected=expected, got=got, advice=_LEAVE_OUT)
    cell = "" if pd.isna(raw.iloc[row]) else str(raw.iloc[row]).strip()
    fault = "missing" if not cell else "infinite" if np.isinf(values[row]) else "not a number"
    raise InputError(
        table.name,
        expected=f"{what} to be a number {where}",
        got=f"{got}, where it is {fault}",
        advice=_advice(frame, cell, table, all_bad=bool(np.isnan(values).all())),
    )


def _advice(frame: pd.DataFrame, cell: str, table: _Table, *, all_bad: bool) -> str:
    """What to do about a cell that is no number; "" is one that is missing."""
    if _GROUPED.fullmatch(cell):
        return "numbers without separators between thousands"
    if not all_bad:
        return _LEAVE_OUT
    numeric = [i for i in range(frame.shape[1]) if frame[i].dtype.kind in "if" and frame[i].notna().any()]
    names = ", ".join(repr(table.columns[i]) if table.columns[i] else str(i) for i in numeric)
    choice = f"--column-time and --column-value to choose columns of numbers ({names})"
    return f"{choice}; a hold time is a number, not a date" if _DATE.match(cell) else choice
