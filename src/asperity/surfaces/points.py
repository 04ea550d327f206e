"""Coordinates in tables of numbers: points of a grid or a profile, and labels of lines and columns."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from asperity.errors import SurfaceFileError
from asperity.lattice import Field

_OFF = 0.1  # largest distance of a point from its grid, in spacings; coordinates are written with few digits
_SAME = 1e-6  # largest difference of two equal coordinates, over the side of the scan
_SPARSE = 10  # largest number of pixels for each point of a grid
_DOUBLED = 0.01  # largest share of points that have x and y of others
_MOST = 6  # columns of a list of points: x, y, z and a few more quantities
_FEW = 5, 10  # least number of evenly spaced coordinates: exact ones, and those of few digits
_EVEN = 1e-3  # largest deviation from even spacing, in spacings
LARGEST_READ = 1e60  # larger numbers come of damage or a wrong byte order; moments of heights would overflow
_MISSING = 0.25  # share of missing lines of a grid above which rounding made the gaps


def are_points(matrix: Field) -> bool:
    """Whether columns are x, y, z, ...: few different x and y, in pairs that hardly repeat."""
    rows, columns = matrix.shape
    if not 3 <= columns <= _MOST or rows < 4 or not np.isfinite(matrix[:, :2]).all():
        return False
    distinct = [np.unique(matrix[:, column]).size for column in (0, 1)]
    pairs = np.unique(matrix[:, :2], axis=0).shape[0]
    return min(distinct) > 1 and distinct[0] * distinct[1] <= 2 * rows and pairs >= (1 - _DOUBLED) * rows


def coordinates(matrix: Field, *, sure: bool) -> list[int]:
    """Columns of x, y and z, or of x and z; none for a matrix of heights, unless coordinates are `sure`."""
    columns, first = matrix.shape[1], matrix[:, 0]
    number = int(columns > 3 and are_numbers(first) and are_points(matrix[:, 1:]))
    if number or are_points(matrix) or (sure and columns > 2):
        return [number, number + 1, number + 2]
    step = np.diff(first[np.isfinite(first)])
    ordered = len(step) == len(first) - 1 and ((step >= 0).all() or (step <= 0).all())
    profile = sure or (ordered and np.unique(first).size > 3 and not are_numbers(first))
    return [0, 1] if columns == 2 and profile else []


def even_step(places: Field) -> float | None:
    """Step of coordinates that are evenly spaced but for rounding of their digits; None for others."""
    if places.size < _FEW[0] or not np.abs(places).max() < LARGEST_READ:
        return None
    step = float(places[-1] - places[0]) / (places.size - 1)
    if step == 0:
        return None
    off = float(np.abs(places - np.linspace(places[0], places[-1], places.size)).max())
    digit = _last_digit(places, abs(step)) if places.size >= _FEW[1] else 0.0
    return step if off <= max(_EVEN * abs(step), 1.001 * digit) else None


def _last_digit(places: Field, step: float) -> float:
    """The power of ten, at most twice the step, of which all are multiples; 0 if there is none."""
    first = math.floor(math.log10(2 * step))
    for digit in (10.0**power for power in range(first, first - 4, -1)):
        if np.abs(places / digit - np.rint(places / digit)).max() < _EVEN:
            return digit
    return 0.0


def are_numbers(labels: Field) -> bool:
    """Whether labels are 0, 1, 2, ... or 1, 2, 3, ..., and so no coordinates."""
    return labels[0] in (0, 1) and np.array_equal(labels, labels[0] + np.arange(labels.size))


def without_labels(matrix: Field) -> tuple[Field, Field | None, Field | None]:
    """Separate heights from evenly spaced labels of the lines and of the columns; None without labels.

    If another line or column is evenly spaced, too, the first one has heights.
    """
    lines: Field | None = None
    columns: Field | None = None
    if _labels(matrix[:, 1:]):
        columns, matrix = matrix[0], matrix[1:]
    if _labels(matrix.T):
        lines, matrix = matrix[:, 0], matrix[:, 1:]
        columns = columns if columns is None else columns[1:]
    return matrix, lines, columns


def _labels(matrix: Field) -> bool:
    """Whether the first row, alone among the first ones, is evenly spaced."""
    return len(matrix) > 1 and bool(even_step(matrix[0])) and not any(map(even_step, matrix[1:4]))


def grid_of(name: str, points: Field) -> tuple[Field, tuple[float, ...]]:
    """Heights of the pixels, NaN where there is no point, and the distance between pixels along each axis.

    Points x, z of a profile have the shape (n, 2), points x, y, z the shape (n, 3); y is upward.
    """
    x, *y, z = points[~np.isnan(points[:, -1])].T
    every = (*(-places for places in y), x)
    axes = [places for places in every if places.max() > places.min()]  # of one line, one varies
    lines = [numbered for places in axes if (numbered := _numbered(places))]
    shape = tuple(int(number.max()) + 1 for number, _ in lines)
    if not shape or len(shape) < len(axes) or math.prod(shape) > _SPARSE * z.size:
        expected = f"points {'x, y, z' if y else 'x, z'} of a regular grid"
        got, advice = f"{len(points)} scattered points", "heights interpolated to a grid"
        raise SurfaceFileError(name, expected=expected, got=got, advice=advice)
    heights, at = np.full(shape, np.nan), tuple(number for number, _ in lines)
    heights[at] = z
    double = np.flatnonzero(heights[at] != z)
    if double.size:
        first = points[~np.isnan(points[:, -1])][double[0], :-1]
        where = ", ".join(f"{axis} = {place:g}" for axis, place in zip("xy", first, strict=False))
        got = f"another height for {double.size} of them, the first at {where}"
        raise SurfaceFileError(name, expected="one height for each point of the grid", got=got)
    return heights, tuple(step for _, step in lines)


def _numbered(places: Field) -> tuple[NDArray[np.intp], float] | None:
    """Number the lines of a grid on which points lie, and find their distance; None without a grid."""
    with np.errstate(over="ignore", invalid="ignore"):  # of coordinates that are no numbers
        from_first = places - places.min(initial=np.inf)
    side = float(from_first.max(initial=0.0))
    gaps = np.diff(np.unique(from_first))
    gaps = gaps[gaps > _SAME * side]  # none if the side is no number
    if not gaps.size:
        return None
    # Gaps of one spacing, but for rounding: a line without points leaves a gap of two or more.
    step = side / round(side / float(gaps[gaps < 1.5 * gaps.min()].mean()))
    number = np.rint(from_first / step)
    lines, line_of = np.unique(places, return_inverse=True)
    if lines.size <= (1 - _MISSING) * (side / step + 1) and (even := even_step(lines)):
        return line_of, even
    return None if np.abs(from_first / step - number).max() > _OFF else (number.astype(np.intp), step)
