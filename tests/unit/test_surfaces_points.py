"""Files of points x, y, z: of a regular grid with undefined pixels, and of none."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.errors import SurfaceFileError
from asperity.surfaces import Surface, read
from tests.refusals import refuses

X, Y = np.meshgrid(0.5 * np.arange(20), 0.3 * np.arange(15) - 7.0, indexing="ij")
GRID = np.stack([X, Y, np.sin(X) + np.cos(2 * Y)], axis=-1).reshape(-1, 3)
HOLES = [17, 100, 101, 230]


@pytest.fixture(autouse=True)
def _needs_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("SurfaceTopography", reason="needs asperity[instruments]")
    monkeypatch.chdir(tmp_path)


def as_found(points: Any, name: str = "points.xyz", digits: str = "%.9g", **options: Any) -> Surface:
    np.savetxt(name, points, fmt=digits)
    return read(name, tilt="none", periodic="wrap", **options)


@pytest.mark.parametrize("order", ["by rows", "shuffled"])
def test_points_that_are_left_out_are_undefined_pixels(order: str) -> None:
    whole = as_found(GRID)
    points = np.delete(GRID, HOLES, axis=0)
    if order == "shuffled":
        points = np.random.default_rng(0).permutation(points)
    holed = as_found(points)
    assert holed.provenance["undefined_pixels"] == len(HOLES)
    assert (holed.shape, holed.provenance["format"]) == (whole.shape, "xyz") == ((15, 20), "xyz")
    assert holed.pixel_size == pytest.approx((0.3, 0.5))
    assert whole.pixel_size == pytest.approx((0.3, 0.5))
    filled = np.zeros(300, dtype=bool)
    filled[HOLES] = True
    where = filled.reshape(20, 15).T[::-1]  # rows run downward, y upward
    np.testing.assert_array_equal(holed.heights[~where], whole.heights[~where])
    assert (holed.heights[where] != whole.heights[where]).all()


def test_coordinates_with_few_digits_and_lines_without_points() -> None:
    points = GRID[(np.abs(GRID[:, 0] - 3.0) > 0.1) & (np.abs(GRID[:, 1] + 6.1) > 0.1)]  # a column and a row
    rounded = points * [0.025, 0.041, 1]  # 0.0125 apart: with three digits 0.012 or 0.013
    found = as_found(rounded, digits="%.3f", max_undefined=0.2)
    assert found.shape == (15, 20)
    assert found.provenance["undefined_pixels"] == 20 + 15 - 1
    assert found.pixel_size == pytest.approx((0.0123, 0.0125), rel=0.01)


def test_the_same_point_twice_is_one() -> None:
    twice = as_found(np.vstack([GRID, GRID[7]]))
    np.testing.assert_array_equal(twice.heights, as_found(GRID).heights)
    with refuses("points.xyz", kind=SurfaceFileError):
        as_found(np.vstack([GRID, GRID[64] + [0, 0, 0.5]]))


def test_points_of_no_grid_are_refused() -> None:
    rng = np.random.default_rng(0)
    bent = GRID.copy()
    bent[:, 0] += 0.2 * np.sin(GRID[:, 1])
    endless = np.delete(GRID, 3, axis=0)
    endless[5, 1], endless[7, 0] = np.inf, np.nan
    far = np.vstack([GRID, [1e308, -1e308, 0], [-1e308, 1e308, 0]])
    line, point = GRID * [1, 0, 1], np.delete(GRID, 3, axis=0) * [0, 0, 1]
    for points in (rng.uniform(0, 20, (300, 3)), bent, line, point, endless, far):
        with refuses("points.xyz", kind=SurfaceFileError):
            as_found(points)
    with refuses("points.xyz", kind=SurfaceFileError):
        as_found(np.delete(GRID, slice(None, None, 5), axis=0))


def test_three_columns_of_text_are_refused_or_remarked() -> None:
    for points in (np.delete(GRID, HOLES, axis=0), np.vstack([GRID, GRID[7] + 0.1 * np.eye(3)[2]])):
        with refuses("points.txt", kind=SurfaceFileError):
            as_found(points, "points.txt")
    matrix = np.random.default_rng(1).normal(size=(300, 3))
    found = as_found(matrix, "heights.txt")
    assert found.shape == (300, 3)
    (remark,) = found.remarks
    assert remark.startswith("three columns, taken as pixels")
    assert as_found(matrix[:, :2].T, "heights.txt").remarks == ()
