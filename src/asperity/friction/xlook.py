"""Binary records of xlook, a program of rock laboratories, with a calibration of their bits.

The file: a name of 20 bytes, four big-endian int32 (rows, columns, two unused), 32 headers of 84 bytes (name
of 13, unit of 13, ...), then the columns as big-endian float32, often in bits of the converter.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from asperity.base import units
from asperity.errors import InputError
from asperity.sheets.tables import Table, text_of

_START, _HEADERS, _HEADER, _NAME = 36, 32, 84, 13
_CALIBRATION = "a calibration, a text file with a line for each column: factor, unit, zero in bits"
_ROLES = {"time": "time", "vert_disp": "load point", "vert_load": "shear", "hor_load": "normal"}
"""Quantities of the columns of a biaxial apparatus, in which the vertical ram shears."""


def is_xlook(path: Path) -> bool:
    """Whether the size of a file is that in its first bytes."""
    if not path.is_file() or path.stat().st_size <= _START + _HEADERS * _HEADER:
        return False
    with path.open("rb") as stream:
        rows, columns = np.frombuffer(stream.read(_START)[20:28], ">i4").tolist()
    size = _START + _HEADERS * _HEADER + 4 * rows * columns
    return bool(rows > 0 and 0 < columns <= _HEADERS and path.stat().st_size == size)


def read_xlook(path: Path, calibration: Path | str | None) -> Table:
    """Read a binary record; `InputError` for bits without a calibration, or a wrong one."""
    content = path.read_bytes()
    rows, many = np.frombuffer(content[20:28], ">i4").tolist()
    headers = [content[_START + n * _HEADER :][: 2 * _NAME] for n in range(many)]
    names, stated = ([_text(header[at : at + _NAME]) for header in headers] for at in (0, _NAME))
    values = np.frombuffer(content, ">f4", offset=_START + _HEADERS * _HEADER).reshape(many, rows).T
    values = values.astype(np.float64)
    if calibration is not None:
        lines = _lines(Path(calibration), names)
        factors, stated, zeros, headings = (list(part) for part in zip(*lines, strict=True))
        values = (values - np.array(zeros)) * np.array(factors)
        names = [name or _called(old, unit) for old, unit, name in zip(names, stated, headings, strict=True)]
    elif "bits" in stated:
        got = ", ".join(f"{name} in {unit}" for name, unit in zip(names, stated, strict=True))
        raise InputError(str(path), expected=_CALIBRATION, got=got, advice="calibration=FILE")
    for n, name in enumerate(names):
        if name == "time" and (np.diff(values[:, n]) <= 0).mean() > 0.1:
            values[:, n] = np.cumsum(values[:, n])  # steps from row to row
    return Table(str(path), names, stated, values, [(n, "") for n in range(1, rows + 1)], ",")


def _text(content: bytes) -> str:
    return content.partition(b"\0")[0].decode("latin-1").strip(" .")


def _called(name: str, unit: str) -> str:
    """The quantity of a column by its name, and of a load (stress or force) by its unit."""
    role = _ROLES.get(name.lower(), "")
    if role in ("shear", "normal"):
        role += " stress" if units.factor(unit, "Pa") else " force"
    return role if unit else ""


def _lines(path: Path, names: list[str]) -> list[tuple[float, str, float, str]]:
    """Factor, unit, zero in bits and name of each column; unit and name are empty for one to leave alone."""
    lines = (line.partition("#")[0].strip() for line in text_of(path).split("\n"))
    columns = []
    for line in filter(None, lines):
        cells = [cell.strip() for cell in re.split(r"[,;\t]", line)]
        if cells[0] == "-":
            columns.append((1.0, "", 0.0, ""))
            continue
        try:
            more = [cells[2] or "0", *cells[3:]] if len(cells) > 2 else ["0"]
            columns.append((float(cells[0]), cells[1], float(more[0]), "".join(more[1:])))
        except (ValueError, IndexError):
            raise InputError(str(path), expected=_CALIBRATION, got=repr(line)) from None
    if len(columns) != len(names):
        expected, advice = f"{len(names)} lines, for {', '.join(names)}", "- for a column to leave alone"
        raise InputError(str(path), expected=expected, got=len(columns), advice=advice)
    return columns
