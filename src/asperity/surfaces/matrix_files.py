"""Plain matrices of heights in files: numpy's ``.npy`` and ``.npz``, and text.

A matrix carries no unit and no pixel size. Its first axis is the rows, its second the columns.
"""

from __future__ import annotations

import contextlib
import math
import warnings
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from asperity.base.tables import read_table
from asperity.base.version import __version__
from asperity.base.words import reason_of
from asperity.errors import SurfaceFileError
from asperity.lattice import Field
from asperity.surfaces.points import are_points
from asperity.surfaces.raw import RawSurface

_READER = f"asperity {__version__}"
_LABELS = 5  # columns from which a line 0, 1, 2, ... above heights with decimals is taken for their numbers


def read_npy(path: Path) -> RawSurface:
    """Read a ``.npy`` file of real numbers; pickled objects are refused, not loaded."""
    with _one_error(path, ".npy", npy.MAGIC_PREFIX), path.open("rb") as file:
        if fault := _fault(file, path.stat().st_size):
            advice = "numpy.save of an array of floats" if "objects" in fault else ""
            expected = "real numbers in one or two dimensions"
            raise SurfaceFileError(str(path), expected=expected, got=fault, advice=advice)
        file.seek(0)
        return RawSurface(_heights(npy.read_array(file)), format="npy", reader=_READER)


def read_npz(path: Path, channel: str | int | None) -> RawSurface:
    """Read one array of a ``.npz`` file, by its name or number; by None where there is a single one."""
    with _one_error(path, ".npz", b"PK"), zipfile.ZipFile(path) as archive:
        members = {}
        for info in archive.infolist():
            with archive.open(info) as file:
                if info.filename.endswith(".npy") and not _fault(file, info.file_size):
                    members[info.filename.removesuffix(".npy")] = info
        chosen = dict(enumerate(members)).get(channel, "") if isinstance(channel, int) else channel
        if chosen is None and len(members) == 1:
            (chosen,) = members
        if chosen not in members:
            known = ", ".join(f"{name!r} (number {i})" for i, name in enumerate(members))
            expected = f"as the channel one of its arrays of real numbers: {known}"
            if not members:
                expected = "an array of real numbers in one or two dimensions"
            got = "none" if channel is None or not members else repr(channel)
            raise SurfaceFileError(str(path), expected=expected, got=got)
        with archive.open(members[chosen]) as file:
            heights = _heights(npy.read_array(file))
    return RawSurface(heights, format="npz", reader=_READER, channel=chosen, channels=tuple(members))


@contextlib.contextmanager
def _one_error(path: Path, kind: str, magic: bytes) -> Iterator[None]:
    """Check how a file begins; turn whatever numpy and zipfile raise for damaged ones into one error."""
    with path.open("rb") as file:
        begin = file.read(len(magic))
    if begin != magic[: len(begin)]:
        got, advice = "a file of another kind", "its true extension"
        raise SurfaceFileError(str(path), expected=f"a {kind} file", got=got, advice=advice)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about headers that numpy mends, of Python 2 or damaged
            yield
    except (SurfaceFileError, MemoryError):
        raise
    # Headers are parsed as Python, members decompressed in four ways: a damaged byte leads anywhere.
    except Exception as error:
        got = f"a damaged or truncated file ({reason_of(error)})"
        raise SurfaceFileError(str(path), expected=f"a {kind} file of numbers", got=got) from error


def _fault(file: IO[bytes], size: int) -> str:
    """Say what is wrong with an array of which nothing but the header is read; "" if it may be heights.

    `ValueError` if the header is damaged, or promises more than the `size` bytes of the file.
    """
    try:
        header = npy.read_array_header_1_0 if npy.read_magic(file) == (1, 0) else npy.read_array_header_2_0
        shape, _, dtype = header(file)
    except (MemoryError, RecursionError) as error:  # of the parser
        raise ValueError("a damaged header") from error
    if dtype.hasobject:
        return "pickled Python objects"
    if dtype.kind not in "iuf" or len(shape) not in (1, 2) or min(shape) == 0:
        return f"an array of type {dtype} and shape {shape}"
    promised, there = math.prod(shape) * dtype.itemsize, size - file.tell()
    if min(shape) < 0 or promised > there:
        raise ValueError(f"the header promises {promised} bytes, there are {there}")
    return ""


def _heights(array: NDArray[np.generic]) -> Field:
    return np.array(array, dtype=np.float64, order="C")


def read_text(path: Path) -> RawSurface:
    """Read a matrix of heights from text, see `read_table`. One row or one column is a profile."""
    matrix = read_table(path, matrix=True, failure=SurfaceFileError).values
    matrix, remarks = _without_labels(matrix)
    if 1 not in matrix.shape:
        _refuse_coordinates(str(path), matrix)
        if matrix.shape[1] == 3 and matrix.shape[0] > 3:
            remarks += ("three columns, taken as pixels; points x, y, z are read from files named .xyz",)
    heights = _heights(matrix.ravel() if 1 in matrix.shape else matrix)
    return RawSurface(heights, format="text", reader=_READER, remarks=remarks)


def _without_labels(matrix: Field) -> tuple[Field, tuple[str, ...]]:
    """Leave out the numbers of lines and columns that pandas writes, and say so."""
    if (
        min(matrix.shape) > 1
        and math.isnan(matrix[0, 0])
        and _counts(matrix[0, 1:])
        and _counts(matrix[1:, 0])
    ):
        return matrix[1:, 1:], ("left out the numbers 0, 1, 2, ... of the columns and lines",)
    for turned, what in ((matrix, "columns"), (matrix.T, "lines")):
        labels, heights = turned[0], turned[1:]
        if labels.size >= _LABELS and _counts(labels) and (heights % 1 > 0).any():
            left = heights if turned is matrix else heights.T
            return left, (f"left out the numbers 0, 1, 2, ... of the {what}",)
    return matrix, ()


def _counts(labels: Field) -> bool:
    return np.array_equal(labels, np.arange(labels.size))


def _refuse_coordinates(name: str, matrix: Field) -> None:
    """Refuse tables of (x, z) or (x, y, z): as a matrix they would be a strip of ramps."""
    if matrix.shape[1] == 2 and matrix.shape[0] >= 4 and np.isfinite(matrix[:, 0]).all():
        step = np.diff(matrix[:, 0])
        is_table = step[0] != 0 and bool(np.allclose(step, step[0], rtol=1e-3, atol=0))
    else:
        is_table = are_points(matrix)
    if is_table:
        columns = matrix.shape[1]
        named = "the name .xyz for points of a grid, or " if columns == 3 else ""
        raise SurfaceFileError(
            name,
            expected="a matrix of heights",
            got=f"{columns} columns that look like coordinates and a height",
            advice=f"{named}a file of the heights alone, one row of pixels a line",
        )
