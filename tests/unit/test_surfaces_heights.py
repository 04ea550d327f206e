"""The door of the solver, and the statistics of what came through it."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
import scipy.stats
import xarray

from asperity.errors import InputError
from asperity.surfaces import Surface, check_heights, gaussian, statistics
from tests.refusals import refuses


def test_door_accepts_whatever_is_an_array_and_never_aliases_it() -> None:
    mine = np.array([[1.0, 2, 3], [4, 5, 6]])
    for heights in (
        [[1, 2, 3], [4, 5, 6]],
        mine.astype(np.int8),
        np.array(mine, dtype=">f4", order="F"),
        np.array([[1, 4], [2, 5], [3, 6]], dtype=np.float16).T,
        mine,
        np.ma.masked_array(mine),
        xarray.DataArray(mine),
        Surface(mine),
    ):
        result = check_heights(heights)
        assert type(result) is np.ndarray
        assert result.dtype == np.dtype("=f8")
        assert result.flags.c_contiguous
        assert result.flags.writeable
        assert not np.shares_memory(result, mine)
        np.testing.assert_array_equal(result, mine)
    assert (check_heights([1.0]).shape, check_heights([[1.0]]).shape) == ((1,), (1, 1))


class Quantity:
    """What a quantity of pint looks like from outside."""

    magnitude = np.ones((3, 3))
    units = "micrometer"

    def __str__(self) -> str:
        return "ones micrometer"

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return self.magnitude


def test_door_refuses_what_is_no_surface() -> None:
    holed = np.zeros((4, 5))
    holed[1, 3] = holed[2, 0] = math.nan
    holed[3, 3] = -math.inf
    wrong: list[Any] = [
        1.0,
        np.zeros((2, 3, 4)),
        [],
        np.zeros((3, 0)),
        "rough",
        None,
        [True, False],
        np.zeros(3, dtype=complex),
        np.array(["2020-01-01"], dtype="datetime64[D]"),
        np.array([1.0, None]),
        holed,
        np.ma.masked_equal([[0.0, 1.0], [7.0, 7.0]], 7.0),
        Quantity(),
    ]
    if np.finfo(np.longdouble).max > np.finfo(float).max:
        wrong.append(np.array([np.longdouble("1e4000"), 0]))
    for heights in wrong:
        with refuses("heights"):
            check_heights(heights)
    with pytest.raises(InputError):  # in words of numpy's
        check_heights([[1, 2], [3]])


def test_statistics_agree_with_scipy() -> None:
    heights = gaussian((60, 50), rms=2.0, seed=3) ** 3
    measured = statistics(heights)
    assert measured.shape == (60, 50)
    assert (measured.minimum, measured.maximum) == (heights.min(), heights.max())
    assert measured.mean == pytest.approx(np.mean(heights))
    assert measured.rms_height == pytest.approx(np.std(heights))
    assert measured.skewness == pytest.approx(scipy.stats.skew(heights, axis=None))
    assert measured.kurtosis == pytest.approx(scipy.stats.kurtosis(heights, axis=None, fisher=False))


def test_slope_of_a_plane_and_curvature_of_a_paraboloid_are_exact() -> None:
    i, j = np.meshgrid(np.arange(9.0), np.arange(7.0), indexing="ij")
    plane, bowl = 3.0 * i - 4.0 * j, 3 * i**2 + 2 * j**2 + 5 * i * j
    assert statistics(plane).rms_slope == pytest.approx(5.0)
    sized = statistics(plane, (0.5, 2.0))
    assert sized.rms_slope == pytest.approx(math.hypot(6.0, 2.0))
    assert (statistics(plane).slope_unit, sized.slope_unit) == ("1/pixel", "1")
    # The seams drop by the whole plane: 8 steps of 3, and 6 steps of 4.
    assert sized.neighbor_steps == pytest.approx((3.0, 4.0))
    assert sized.seam_steps == pytest.approx((24.0, 24.0))
    assert sized.seam_ratio == pytest.approx(8.0)
    assert statistics(bowl).rms_curvature == pytest.approx((6 + 4) / 2)
    assert statistics(bowl, (0.5, 2.0)).rms_curvature == pytest.approx((6 / 0.25 + 4 / 4) / 2)
    assert statistics(bowl[:, 0]).rms_curvature == pytest.approx(6)
    for small in (bowl[:2], bowl[:, :2], bowl[0, :2]):
        assert statistics(small).rms_curvature == 0
    wrong: list[Any] = [(1.0,), (1.0, 0.0)]
    for size in wrong:
        with refuses("pixel_size"):
            statistics(plane, size)


def test_flat_and_small_and_periodic_surfaces() -> None:
    phase = 2 * np.pi * (np.arange(64) + 0.5) / 64
    # The seam of the sine lies on its steepest place: sqrt(2) of the rms slope.
    assert statistics(np.sin(phase)).seam_ratio == pytest.approx(math.sqrt(2), rel=0.02)
    # 0.1 is no binary fraction: the mean of many of them is not 0.1, and a naive rms is not 0.
    flat = statistics(np.full((30, 30), 0.1))
    assert flat.rms_height == flat.rms_slope == flat.seam_ratio == 0
    assert math.isnan(flat.skewness)
    assert math.isnan(flat.kurtosis)
    single = statistics([[2.0]])
    assert single.neighbor_steps == single.seam_steps == (0.0, 0.0)
    assert single.rms_slope == 0
    assert dataclasses.replace(statistics([1.0, 1.0]), seam_steps=(1.0,)).seam_ratio == math.inf


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


@pytest.mark.parametrize(
    ("unit", "size", "lateral", "across", "slope_unit", "curvature_unit"),
    [
        ("nm", (0.5,), "um", 500, "1", "1/nm"),  # 1 nm in 500 nm
        ("rms", (0.5,), "um", 0.5, "rms/um", "rms/um^2"),
        ("1", None, None, 1.0, "1/pixel", "1/pixel^2"),
        ("nm", None, None, 1.0, "nm/pixel", "nm/pixel^2"),
        ("nm", (0.5,), None, 0.5, "nm/unit of length", "nm/(unit of length)^2"),
    ],
)
def test_surface_converts_its_pixel_size_to_measure_its_slope(
    unit: Any, size: Any, lateral: Any, across: float, slope_unit: str, curvature_unit: str
) -> None:
    ramp, bowl = (
        Surface(np.arange(5.0) ** n, unit, size, lateral, {"undefined_pixels": 2}).describe() for n in (1, 2)
    )
    assert ramp.rms_slope == pytest.approx(1 / across)
    assert bowl.rms_curvature == pytest.approx(2 / across**2)
    assert (ramp.unit, ramp.slope_unit, ramp.curvature_unit) == (unit, slope_unit, curvature_unit)
    assert ramp.undefined_pixels == 2
