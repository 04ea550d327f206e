"""Points x, y, z of a regular grid, as instruments list them that leave out undefined pixels."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from asperity.errors import SurfaceFileError
from asperity.lattice import Field

_OFF = 0.1  # how far a point may be off its grid, in spacings; coordinates are written with few digits
_SAME = 1e-6  # difference of two coordinates that is rounding, as a part of the side of the scan
_SPARSE = 10  # pixels for each point beyond which points are said to lie on no grid
_DOUBLED = 0.01  # part of the points that may share x and y with others, where columns are taken for points


def are_points(matrix: Field) -> bool:
    """Whether three columns are evidently x, y, z: few values of x and y, in pairs that hardly repeat."""
    rows, columns = matrix.shape
    if columns != 3 or rows < 4 or not np.isfinite(matrix[:, :2]).all():
        return False
    distinct = [np.unique(matrix[:, column]).size for column in (0, 1)]
    pairs = np.unique(matrix[:, :2], axis=0).shape[0]
    return min(distinct) > 1 and distinct[0] * distinct[1] <= 2 * rows and pairs >= (1 - _DOUBLED) * rows


def grid_of(name: str, points: Field) -> tuple[Field, tuple[float, float]]:
    """Heights of the pixels, NaN where there is no point, and the distance between rows and between columns.

    Points have the shape (n, 3); x goes to the right and y upward.
    """
    x, y, z = points[~np.isnan(points[:, 2])].T
    column, row = _numbered(x), _numbered(-y)
    if column is None or row is None or (row[0].max() + 1.0) * (column[0].max() + 1.0) > _SPARSE * z.size:
        expected, got = "points x, y, z of a regular grid", f"{len(points)} scattered points"
        advice = "heights interpolated to a grid, or the name .txt for a matrix of heights with three columns"
        raise SurfaceFileError(name, expected=expected, got=got, advice=advice)
    heights = np.full((row[0].max() + 1, column[0].max() + 1), np.nan)
    heights[row[0], column[0]] = z
    double = np.flatnonzero(heights[row[0], column[0]] != z)
    if double.size:
        at = f"x = {x[double[0]]:g}, y = {y[double[0]]:g}"
        got = f"another height for {double.size} of them, the first at {at}"
        raise SurfaceFileError(name, expected="one height for each point of the grid", got=got)
    return heights, (row[1], column[1])


def _numbered(places: Field) -> tuple[NDArray[np.intp], float] | None:
    """Numbers of the lines of a grid on which points lie, and their distance; None where there is no grid."""
    with np.errstate(over="ignore", invalid="ignore"):  # of coordinates that are no numbers
        from_first = places - places.min(initial=np.inf)
    side = float(from_first.max(initial=0.0))
    if not math.isfinite(side):
        return None
    gaps = np.diff(np.unique(from_first))
    gaps = gaps[gaps > _SAME * side]
    if not gaps.size:
        return None
    # Of equal gaps, but for rounding: a line without any point leaves one of two spacings or more.
    step = side / round(side / float(gaps[gaps < 1.5 * gaps.min()].mean()))
    number = np.rint(from_first / step)
    if np.abs(from_first / step - number).max() > _OFF:
        return None
    return number.astype(np.intp), step
