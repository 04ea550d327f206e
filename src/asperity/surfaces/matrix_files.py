"""Plain matrices of heights in files: numpy's ``.npy``, and text.

A matrix carries no unit and no pixel size. Its first axis is the rows, its second the columns.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from tokenize import TokenError

import numpy as np

from asperity._version import __version__
from asperity.errors import SurfaceFileError
from asperity.lattice import Field
from asperity.surfaces.raw import RawSurface

_NPY_MAGIC = b"\x93NUMPY"
# What numpy raises for damaged headers, which it parses as Python.
_NPY_ERRORS = (ValueError, TypeError, EOFError, OSError, SyntaxError, OverflowError, MemoryError, TokenError)
# The order matters: a comma may be a decimal sign where semicolons or tabs separate, never the reverse.
_DELIMITERS: tuple[str | None, ...] = (";", "\t", ",", None)


def read_npy(path: Path) -> RawSurface:
    """Read a ``.npy`` file of real numbers; pickled objects are refused, not loaded.

    Raises
    ------
    SurfaceFileError
        If the file is of another kind, truncated, or holds anything but real numbers in one or two
        dimensions.
    """
    with path.open("rb") as file:
        magic = file.read(len(_NPY_MAGIC))
    if magic != _NPY_MAGIC[: len(magic)]:
        raise SurfaceFileError(
            str(path), expected="a .npy file", got="a file of another kind", advice="its true extension"
        )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about headers that numpy mends, of Python 2 or damaged
            # A memory map compares the size of the file with its header before anything is allocated.
            array = np.load(path, mmap_mode="r", allow_pickle=False)
    except _NPY_ERRORS as error:
        is_pickle = "Python objects" in str(error)
        got = "pickled Python objects" if is_pickle else f"a damaged or truncated file ({_one_line(error)})"
        advice = "numpy.save of an array of floats" if is_pickle else ""
        raise SurfaceFileError(
            str(path), expected="a .npy file of numbers", got=got, advice=advice
        ) from error
    if array.dtype.kind not in "iuf" or array.ndim not in (1, 2) or array.size == 0:
        raise SurfaceFileError(
            str(path),
            expected="real numbers in one or two dimensions",
            got=f"an array of type {array.dtype} and shape {array.shape}",
        )
    heights = np.array(array, dtype=np.float64, order="C", subok=False)
    return RawSurface(heights, format="npy", reader=f"asperity {__version__}")


def read_text(path: Path) -> RawSurface:
    """Read a matrix of heights from text in UTF-8.

    Numbers are separated by semicolons, tabs, commas or blanks: whatever splits the first line into
    numbers. ``#`` starts a comment; empty lines are skipped; ``NaN`` and, between delimiters, nothing
    at all stand for an undefined pixel. One row or one column is a profile.

    Raises
    ------
    SurfaceFileError
        If a line holds anything but numbers or has another count of them than the first, with the
        number of that line; if there is no number; or if the columns look like coordinates.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise SurfaceFileError(str(path), expected="text in UTF-8", got="a file of another kind") from error
    if "\0" in text:
        raise SurfaceFileError(str(path), expected="text in UTF-8", got="binary data")
    matrix = _parse(str(path), text)
    if 1 not in matrix.shape:
        _refuse_coordinates(str(path), matrix)
    heights = matrix.ravel() if 1 in matrix.shape else matrix
    return RawSurface(heights, format="text", reader=f"asperity {__version__}")


def _parse(name: str, text: str) -> Field:
    rows: list[list[float]] = []
    delimiter: str | None = None
    trailing = True  # whether every line so far ends with a delimiter, as some programs write it
    for number, line in enumerate(text.split("\n"), 1):
        content = line.partition("#")[0]
        # A line of nothing but tabs or commas is a row of undefined pixels; of nothing but blanks, no row.
        if not content.strip() and not (delimiter and delimiter in content):
            continue
        if not rows:
            delimiter = _guess_delimiter(content)
        row = _numbers(name, number, content, delimiter)
        if rows and len(row) != len(rows[0]):
            expected = f"{len(rows[0])} numbers in line {number}, as in the first row"
            raise SurfaceFileError(name, expected=expected, got=str(len(row)))
        trailing = trailing and delimiter is not None and content.rstrip("\r ").endswith(delimiter)
        rows.append(row)
    matrix = np.array(rows)
    matrix = matrix[:, :-1] if rows and trailing else matrix
    if matrix.size == 0:
        raise SurfaceFileError(name, expected="a matrix of numbers", got="no number at all")
    return matrix


def _guess_delimiter(content: str) -> str | None:
    """Delimiter that splits the line into numbers and blanks; None for blanks and as a last resort."""
    for delimiter in _DELIMITERS:
        if delimiter is not None and delimiter in content:
            try:
                cells = content.split(delimiter)
                _ = [float(cell) for cell in cells if cell.strip()]
            except ValueError:
                continue
            return delimiter
    return None


def _numbers(name: str, number: int, content: str, delimiter: str | None) -> list[float]:
    row = []
    for cell in content.split(delimiter):
        try:
            row.append(float(cell) if cell.strip() else np.nan)
        except ValueError:
            raise SurfaceFileError(
                name,
                expected=f"only numbers in line {number}",
                got=repr(cell.strip()[:40]),
                advice="a # before header lines, points as decimal signs, and NaN for undefined pixels",
            ) from None
    return row


def _refuse_coordinates(name: str, matrix: Field) -> None:
    """Refuse tables of (x, z) or (x, y, z): as a matrix they would be a strip of ramps."""
    rows, columns = matrix.shape
    if columns > 3 or rows < 4 or not np.isfinite(matrix[:, :-1]).all():
        return
    distinct = [np.unique(matrix[:, column]).size for column in range(columns - 1)]
    if columns == 2:
        step = np.diff(matrix[:, 0])
        is_table = step[0] != 0 and bool(np.allclose(step, step[0], rtol=1e-3, atol=0))
    else:
        is_table = distinct[0] * distinct[1] == rows and min(distinct) > 1
    if is_table:
        raise SurfaceFileError(
            name,
            expected="a matrix of heights",
            got=f"{columns} columns that look like coordinates and a height",
            advice="a file of the heights alone, one row of pixels a line",
        )


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:120]
