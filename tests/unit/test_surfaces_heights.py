"""The door of the solver, and the statistics of what came through it."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
import scipy.stats
import xarray

from asperity.errors import InputError
from asperity.surfaces import Statistics, Surface, check_heights, gaussian, statistics


@pytest.mark.parametrize(
    "heights",
    [
        [[1, 2, 3], [4, 5, 6]],
        np.array([[1, 2, 3], [4, 5, 6]], dtype=np.int8),
        np.array([[1, 2, 3], [4, 5, 6]], dtype=">f4", order="F"),
        np.array([[1, 4], [2, 5], [3, 6]], dtype=np.float16).T,
        np.ma.masked_array([[1, 2, 3], [4, 5, 6]]),
        xarray.DataArray([[1, 2, 3], [4, 5, 6]]),
        Surface(np.array([[1.0, 2, 3], [4, 5, 6]])),
    ],
)
def test_door_accepts_whatever_is_an_array(heights: Any) -> None:
    result = check_heights(heights)
    assert type(result) is np.ndarray
    assert result.dtype == np.dtype("=f8")
    assert result.flags.c_contiguous
    np.testing.assert_array_equal(result, [[1, 2, 3], [4, 5, 6]])


def test_door_never_aliases_the_callers_memory() -> None:
    mine = np.zeros((3, 3))
    for given in (mine, mine[:], np.ma.masked_array(mine), xarray.DataArray(mine)):
        result = check_heights(given)
        assert not np.shares_memory(result, mine)
        assert result.flags.writeable


def test_door_accepts_the_smallest_lattices() -> None:
    assert check_heights([1.0]).shape == (1,)
    assert check_heights([[1.0]]).shape == (1, 1)


@pytest.mark.parametrize(
    ("heights", "message"),
    [
        (1.0, "expected one or two dimensions, got 0 dimensions"),
        (np.zeros((2, 3, 4)), r"got 3 dimensions, shape \(2, 3, 4\); try one layer of it, heights\[0\]"),
        ([], r"expected at least one height, got an empty array, shape \(0,\)"),
        (np.zeros((3, 0)), r"an empty array, shape \(3, 0\)"),
        ([[1, 2], [3]], r"expected an array of real numbers, got list \("),
        ("rough", "expected an array of real numbers, got 'rough'"),
        (None, "expected an array of real numbers, got None"),
        ([True, False], "got list of type bool"),
        (np.zeros(3, dtype=complex), "of type complex128; try heights.real"),
        (np.array(["2020-01-01"], dtype="datetime64[D]"), "of type datetime64"),
        (np.array([1.0, None]), "of type object"),
    ],
)
def test_door_refuses_what_is_no_surface(heights: Any, message: Any) -> None:
    with pytest.raises(InputError, match=f"heights: .*{message}"):
        check_heights(heights)


def test_door_counts_what_is_not_finite() -> None:
    heights = np.zeros((4, 5))
    heights[1, 3] = heights[2, 0] = math.nan
    heights[3, 3] = -math.inf
    with pytest.raises(
        InputError, match=r"got 2 NaN and 1 infinite of 20, the first at \[1, 3\]; try filling"
    ):
        check_heights(heights)


def test_door_refuses_masked_entries() -> None:
    heights = np.ma.masked_equal([[0.0, 1.0], [7.0, 7.0]], 7.0)
    with pytest.raises(InputError, match=r"got 2 masked of 4, the first at \[1, 0\]; try filling"):
        check_heights(heights)


@pytest.mark.skipif(np.finfo(np.longdouble).max == np.finfo(float).max, reason="long double is double here")
def test_door_refuses_what_overflows() -> None:
    with pytest.raises(InputError, match="0 NaN and 1 infinite"):
        check_heights(np.array([np.longdouble("1e4000"), 0]))


def test_statistics_agree_with_scipy() -> None:
    heights = gaussian((60, 50), rms=2.0, seed=3) ** 3
    measured = statistics(heights)
    assert measured.shape == (60, 50)
    assert (measured.minimum, measured.maximum) == (heights.min(), heights.max())
    assert measured.mean == pytest.approx(np.mean(heights))
    assert measured.rms_height == pytest.approx(np.std(heights))
    assert measured.skewness == pytest.approx(scipy.stats.skew(heights, axis=None))
    assert measured.kurtosis == pytest.approx(scipy.stats.kurtosis(heights, axis=None, fisher=False))


def test_slope_of_a_plane_is_exact() -> None:
    i, j = np.meshgrid(np.arange(8.0), np.arange(6.0), indexing="ij")
    plane = 3.0 * i - 4.0 * j
    assert statistics(plane).rms_slope == pytest.approx(5.0)
    assert statistics(plane).slope_unit == "1/pixel"
    sized = statistics(plane, (0.5, 2.0))
    assert sized.rms_slope == pytest.approx(math.hypot(6.0, 2.0))
    assert sized.slope_unit == "1"
    # The seams drop by the whole plane: 7 steps of 3, and 5 steps of 4.
    assert sized.neighbor_steps == pytest.approx((3.0, 4.0))
    assert sized.seam_steps == pytest.approx((21.0, 20.0))
    assert sized.seam_ratio == pytest.approx(7.0)


def test_seam_of_a_periodic_profile_is_like_any_other_step() -> None:
    phase = 2 * np.pi * (np.arange(64) + 0.5) / 64
    # The seam of the sine lies on its steepest place: sqrt(2) of the rms slope.
    assert statistics(np.sin(phase)).seam_ratio == pytest.approx(math.sqrt(2), rel=0.02)


def test_flat_surfaces_have_no_shape_of_distribution() -> None:
    # 0.1 is no binary fraction: the mean of many of them is not 0.1, and a naive rms is not 0.
    measured = statistics(np.full((30, 30), 0.1))
    assert measured.rms_height == measured.rms_slope == measured.seam_ratio == 0
    assert math.isnan(measured.skewness)
    assert math.isnan(measured.kurtosis)


def test_a_single_site_has_no_neighbors() -> None:
    measured = statistics([[2.0]])
    assert measured.neighbor_steps == measured.seam_steps == (0.0, 0.0)
    assert measured.rms_slope == 0


def test_a_step_on_a_flat_axis_is_an_infinite_ratio() -> None:
    measured = dataclasses.replace(statistics([1.0, 1.0]), seam_steps=(1.0,))
    assert isinstance(measured, Statistics)
    assert measured.seam_ratio == math.inf


@pytest.mark.parametrize(
    ("size", "message"),
    [
        ((1.0,), "pixel_size: expected 2 numbers, one an axis"),
        ((1.0, 0.0), "pixel_size: expected finite numbers above 0"),
    ],
)
def test_statistics_refuse_other_pixel_sizes(size: Any, message: Any) -> None:
    with pytest.raises(InputError, match=message):
        statistics(np.eye(3), size)


def test_surface_is_an_array_that_cannot_be_changed() -> None:
    mine = np.eye(3)
    surface = Surface(mine, unit="nm")
    mine[0, 0] = 9
    assert surface.heights[0, 0] == 1
    assert surface.shape == (3, 3)
    with pytest.raises(ValueError, match="read-only"):
        surface.heights[0, 0] = 2
    assert np.asarray(surface) is surface.heights
    changed = np.array(surface)
    changed[0, 0] = 5
    assert surface.heights[0, 0] == 1
    assert np.asarray(surface, dtype=np.float32).dtype == np.float32
    np.testing.assert_allclose(np.mean(surface), 1 / 3)
    with pytest.raises(InputError, match="1 NaN"):
        Surface(np.array([1.0, math.nan]))


@pytest.mark.parametrize(
    ("unit", "size", "lateral", "slope", "slope_unit"),
    [
        ("nm", (0.5,), "um", 2e-3, "1"),  # 1 nm in 500 nm
        ("um", (0.5,), "um", 2.0, "1"),
        ("rms", (0.5,), "um", 2.0, "rms/um"),
        ("1", None, None, 1.0, "1/pixel"),
        ("nm", None, None, 1.0, "nm/pixel"),
        ("nm", (0.5,), None, 2.0, "nm/unit of length"),
    ],
)
def test_surface_converts_its_pixel_size_to_measure_its_slope(
    unit: Any, size: Any, lateral: Any, slope: Any, slope_unit: Any
) -> None:
    surface = Surface(np.arange(5.0), unit, size, lateral, {"undefined_pixels": 2})
    measured = surface.describe()
    assert measured.rms_slope == pytest.approx(slope)
    assert (measured.unit, measured.slope_unit, measured.undefined_pixels) == (unit, slope_unit, 2)
