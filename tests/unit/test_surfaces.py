"""The door of the solver, the statistics of what came through it, and what a surface can be asked for."""

import dataclasses
import math
from functools import partial
from typing import Any

import numpy as np
import pytest
import scipy.stats

import asperity
from asperity.base.rows import words_of
from asperity.surfaces import Surface, check_heights, check_square, combined, gaussian, read, statistics
from asperity.surfaces.provenance import understood
from tests.refusals import each_refuses, refuses

ROUGH = gaussian((24, 30), seed=4)
SIZED = Surface(ROUGH, "nm", (0.5, 0.25), "um", {"file": "a.npy", "periodic_rule": "mirror"})
pytestmark = pytest.mark.usefixtures("here")


def test_door_accepts_whatever_is_an_array_and_never_aliases_it():
    mine = np.array([[1.0, 2, 3], [4, 5, 6]])
    # Other types of arrays are given to all public functions, in test_public_calls.
    for heights in ([[1, 2, 3], [4, 5, 6]], mine.T.copy().T, mine, np.ma.masked_array(mine), Surface(mine)):
        result = check_heights(heights)
        assert type(result) is np.ndarray
        assert result.dtype == np.dtype("=f8")
        assert result.flags.c_contiguous
        assert result.flags.writeable
        assert not np.shares_memory(result, mine)
        np.testing.assert_array_equal(result, mine)
    assert (check_heights([1.0]).shape, check_heights([[1.0]]).shape) == ((1,), (1, 1))


def test_door_refuses_masked_heights_and_numbers_beyond_the_range_of_others():
    # What is no number is given to all public functions, in test_public_calls.
    with refuses("heights", "2 masked of 4"):
        check_heights(np.ma.masked_equal([[0.0, 1.0], [7.0, 7.0]], 7.0))
    if (wide := np.finfo(np.longdouble).max) > np.finfo(float).max:
        with refuses("heights", "0"):
            check_heights(np.array([wide, 0]))


def test_statistics_agree_with_scipy():
    heights = gaussian((60, 50), rms=2.0, seed=3) ** 3
    measured = statistics(heights)
    assert measured.shape == (60, 50)
    assert (measured.minimum, measured.maximum) == (heights.min(), heights.max())
    assert measured.mean == pytest.approx(np.mean(heights))
    assert measured.rms_height == pytest.approx(np.std(heights))
    assert measured.skewness == pytest.approx(scipy.stats.skew(heights, axis=None))
    assert measured.kurtosis == pytest.approx(scipy.stats.kurtosis(heights, axis=None, fisher=False))


def test_slope_of_a_plane_and_curvature_of_a_paraboloid_are_exact():
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
    assert statistics(bowl, (0.5, 2.0)).rms_curvature == pytest.approx((6 / 0.25 + 4 / 4) / 2)
    assert statistics(bowl[:, 0]).rms_curvature == pytest.approx(6)
    for small in (bowl[:2], bowl[:, :2], bowl[0, :2]):
        assert statistics(small).rms_curvature == 0
    wrong: list[Any] = [(1.0,), (1.0, 0.0)]
    each_refuses(*(("pixel_size", statistics, plane, size) for size in wrong), got="(1.0,) | 0.0")


def test_flat_and_small_and_periodic_surfaces():
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


def test_surface_is_an_array_that_cannot_be_changed():
    mine = np.eye(3)
    surface = Surface(mine, unit="nm")
    mine[0, 0] = 9
    assert surface.heights[0, 0] == 1
    with pytest.raises(ValueError, match="read-only"):
        surface.heights[0, 0] = 2
    assert np.asarray(surface) is surface.heights
    np.array(surface)[0, 0] = 5
    assert surface.heights[0, 0] == 1
    assert np.asarray(surface, dtype=np.float32).dtype == np.float32


def test_a_part_by_pixels_and_by_lengths():
    part = SIZED.crop([2, 10, 5, 25])
    np.testing.assert_array_equal(part.heights, ROUGH[2:10, 5:25])
    assert (part.unit, part.pixel_size, part.length_unit) == ("nm", (0.5, 0.25), "um")
    # It is no longer made of mirror images.
    assert part.provenance == {"file": "a.npy", "crop": [2, 10, 5, 25]}
    assert part.scan is part
    assert (part.edges, SIZED.crop([0, 24, 0, 30]).edges) == ("reflecting", "periodic")
    np.testing.assert_array_equal(SIZED.crop([1000, 5000, 1250, 6250], "nm").heights, part.heights)
    np.testing.assert_array_equal(Surface(ROUGH[0]).crop((3, 30)).heights, ROUGH[0, 3:])
    with refuses("crop_unit", "'furlong'"):
        SIZED.crop([0, 1, 0, 5], "furlong")
    wrong: list[tuple[Surface, list[float], str]] = [
        (SIZED, [0, 10], "pixel"),
        (SIZED, [0, 10, 5, 31], "pixel"),
        (SIZED, [-2, 10, 5, 30], "pixel"),
        (SIZED, [10, 10, 5, 30], "pixel"),
        (SIZED, [0, 0.01, 0, 5], "um"),
        (Surface(ROUGH), [0, 1, 0, 1], "um"),
    ]
    each_refuses(
        *(("crop", surface.crop, bounds, unit) for surface, bounds, unit in wrong),
        got="[0, 10] | 5 to 31 | -2 to 10 | 10 to 10 | 0 to 0.01 um | none",
    )


@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
def test_a_band_of_waves(edges):
    """Waves of 20, 6 and 2.5 units of length on oblong pixels: the middle one is kept, and so is the mean."""
    size, shape = (0.5, 0.25), (40, 60)
    x = [d * (np.arange(n) + 0.5) for n, d in zip(shape, size, strict=True)]
    along = np.cos(2 * np.pi * x[0] / 20)[:, None] + np.zeros(shape)  # a whole period down
    across = np.cos(2 * np.pi * x[1] / 7.5)[None, :] + np.zeros(shape)  # two to the right
    short = np.cos(2 * np.pi * x[0] / 2.5)[:, None] * np.cos(2 * np.pi * x[1] / 3)[None, :]
    surface = Surface(5 + along + across + short, "nm", size, "um", edges=edges)
    np.testing.assert_allclose(surface.band(longest=15, shortest=3).heights, 5 + across, atol=1e-12)
    np.testing.assert_allclose(surface.band(shortest=3).heights, 5 + along + across, atol=1e-12)
    np.testing.assert_allclose(surface.band(longest=7.5).heights, 5 + across + short, atol=1e-12)
    assert surface.band(longest=15, shortest=3).provenance == {"longest": 15.0, "shortest": 3.0}
    np.testing.assert_array_equal(surface.band().heights, surface.heights)
    wrong = (("longest", {"longest": 0}), ("shortest", {"shortest": 3.0, "longest": 2.0}))
    each_refuses(*((name, partial(surface.band, **limits)) for name, limits in wrong), got="0 | 3")


def test_a_band_of_a_reflecting_surface_is_that_of_its_mirror_images():
    np.save("a.npy", ROUGH)
    limits: dict[str, Any] = {"shortest": 4.0, "longest": 20.0}
    images, alone = (read("a.npy", periodic=rule, tilt="mean", **limits) for rule in ("mirror", "reflect"))
    assert (images.edges, alone.edges, alone.shape) == ("periodic", "reflecting", ROUGH.shape)
    np.testing.assert_array_equal(images.scan.heights, alone.heights)
    again = read("a.npy", tilt="mean", periodic="mirror").band(**limits)
    np.testing.assert_allclose(again.heights, images.heights, atol=1e-13)
    assert (images.provenance["shortest"], alone.provenance["periodic_rule"]) == (4.0, "reflect")
    wrapped = read("a.npy", periodic="wrap", tilt="mean", **limits)
    kept = Surface(ROUGH - ROUGH.mean()).band(**limits)
    np.testing.assert_allclose(wrapped.heights, kept.heights, atol=1e-13)


def test_a_part_is_cut_out_before_anything_else():
    holed = ROUGH + 100 + np.arange(30)
    holed[0, 0] = np.nan
    np.save("a.npy", holed)
    np.save("part.npy", holed[4:20, 6:30])
    options: dict[str, Any] = {"pixel_size": (2.0, 1.0), "length_unit": "nm", "file_unit": "nm"}
    part = read("a.npy", crop=[8, 40, 6, 30], crop_unit="nm", undefined="refuse", **options)
    same = read("part.npy", undefined="refuse", **options)
    np.testing.assert_array_equal(part.heights, same.heights)
    assert part.provenance["crop"] == [4, 20, 6, 30]
    assert part.provenance["tilt_coefficients"] == same.provenance["tilt_coefficients"]
    assert (part.unit, part.pixel_size, part.length_unit) == ("nm", (2.0, 1.0), "nm")


def test_two_rough_bodies_are_the_sum():
    first = Surface(ROUGH, "um", (0.5, 0.5), "um", {"file": "a.npy"})
    second = Surface(1e3 * ROUGH[::-1], "nm", (500, 500), "nm", {"file": "b.npy"})
    both = combined(first, second)
    np.testing.assert_allclose(both.heights, ROUGH + ROUGH[::-1], rtol=1e-14)
    assert (both.unit, both.pixel_size, both.length_unit) == ("um", (0.5, 0.5), "um")
    assert both.provenance == {"file": "a.npy", "other": "b.npy"}
    relative = Surface(ROUGH, "rms")
    wrong: list[Any] = [
        (first, Surface(ROUGH[1:], "um", (0.5, 0.5), "um")),
        (first, Surface(ROUGH, "um", (0.5, 0.4), "um")),
        (first, Surface(ROUGH, "um")),
        (first, Surface(ROUGH, "1", (0.5, 0.5), "um")),
        (first, Surface(ROUGH, "um", (0.5, 0.5), "um", edges="reflecting")),
        (first, ROUGH),
        (relative, relative),
    ]
    each_refuses(
        *(("second", combined, one, other) for one, other in wrong),
        got="(23, 30) | 0.5 x 0.4 um | unknown | heights in '1' | reflecting | ndarray | ",
    )


def test_a_surface_in_meters():
    heights, spacing = SIZED.in_meters()
    np.testing.assert_allclose(heights, ROUGH * 1e-9, rtol=1e-15)
    assert spacing == pytest.approx((5e-7, 2.5e-7), rel=1e-15)
    for surface, has_lengths in (
        (Surface(ROUGH, "1", (1.0, 1.0)), False),
        (Surface(ROUGH, "rms", (1.0, 1.0), "um"), True),
        (Surface(ROUGH, "nm"), True),
        (Surface(ROUGH, "nm", (1.0, 1.0)), True),
    ):
        assert surface.has_lengths is has_lengths
        with refuses("surface"):
            surface.in_meters()


def test_pixel_sizes_with_a_unit():
    np.save("a.npy", ROUGH)
    cases: list[tuple[dict[str, Any], tuple[float, float], str]] = [
        ({"pixel_size": "1 um"}, (1.0, 1.0), "um"),
        ({"pixel_size": "0.5 \u00b5m"}, (0.5, 0.5), "um"),
        ({"pixel_size": ("0.3 um", "200 nm")}, (0.3, 0.2), "um"),
        ({"pixel_size": ["0.3 um", "200 nm"], "length_unit": "nm"}, (300.0, 200.0), "nm"),
        ({"pixel_size": "1e-3 inch"}, (2.54e-5, 2.54e-5), "m"),
    ]
    for given, size, unit in cases:
        for surface in (Surface(ROUGH, **given), read("a.npy", periodic="wrap", **given)):
            assert surface.pixel_size == pytest.approx(size)
            assert surface.length_unit == unit


def test_a_surface_is_checked_when_it_is_made():
    wrong: list[Any] = ["1 kg", "1", "um", "-1 um", ("1 um", "x"), ("1 um",), (1.0,)]
    each_refuses(
        *(("pixel_size", partial(Surface, pixel_size=size), ROUGH) for size in wrong),
        got="'1 kg' | '1' | 'um' | -1.0 | 'x' | ['1 um'] | (1.0,)",
    )
    units: tuple[Any, ...] = ("1 parsec", "2 um", "kg", "V", "um^2", 3)
    for name in ("unit", "length_unit"):
        for unit in units:
            with refuses(name):
                Surface(ROUGH, **{"pixel_size": 1.0, name: unit})
    mirrored = partial(Surface, edges="mirror")  # type: ignore[arg-type]
    each_refuses(("edges", "'mirror'", mirrored, ROUGH), ("heights", "1", Surface, [1.0, np.nan]))


def test_oblong_pixels_are_refused_where_they_would_be_taken_as_square():
    np.save("a.npy", ROUGH)
    surface = read("a.npy", pixel_size=(1.0, 3.0))
    pressed = partial(asperity.press, solid=asperity.solids.spring_lattice(k0=1, k1=1), load=1)
    each_refuses(("heights", "1", check_square, surface), ("heights", "1", pressed, surface))
    # Pixels that are square, or nearly, or of unknown size, pass, and so does what has none.
    for size in ((2.0, 2.01), (2.0, 2.0), None):
        check_square(Surface(surface.heights, "nm", size, "nm"))
    check_square(surface.heights)


def test_what_was_understood_of_a_file_is_said():
    alone = {"channel": "h", "channels": ["h"], "undefined_by": [], "unit_from": ""}
    assert words_of(understood({})) == []
    assert words_of(understood(alone | {"size_from": "the file", "length_unit": ""})) == [
        ("channel", "h"),
        ("units", "pixels without a unit (from the file)"),
    ]
    facts = {"channel": "Height", "channels": ["Height", "Error"], "orientation": "row 0 is line 1"}
    facts |= {"undefined_by": ["NODATA_value -9999: 465 pixels", "undefined_value 0: 2 pixels"]}
    facts |= {"original_unit": "nm", "unit_from": "the file", "length_unit": "um", "size_from": "pixel_size"}
    assert words_of(understood(facts)) == [
        ("channel", "Height, of Height, Error"),
        ("orientation", "row 0 is line 1"),
        ("undefined", "NODATA_value -9999: 465 pixels; undefined_value 0: 2 pixels"),
        ("units", "heights in nm (from the file), pixels in um (from pixel_size)"),
    ]
