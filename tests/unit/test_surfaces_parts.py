"""Parts of surfaces, bands of waves, sums of two, and surfaces in meters."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.surfaces import Surface, combined, gaussian, read, spectral, statistics
from tests.refusals import refuses

ROUGH = gaussian((24, 30), seed=4)


def test_a_part_by_pixels_and_by_lengths() -> None:
    surface = Surface(ROUGH, "nm", (0.5, 0.25), "um", {"file": "a.npy", "periodic_rule": "mirror"})
    part = surface.crop([2, 10, 5, 25])
    np.testing.assert_array_equal(part.heights, ROUGH[2:10, 5:25])
    assert (part.unit, part.pixel_size, part.length_unit) == ("nm", (0.5, 0.25), "um")
    # It is no longer made of mirror images.
    assert part.provenance == {"file": "a.npy", "crop": [2, 10, 5, 25]}
    assert part.scan is part
    np.testing.assert_array_equal(surface.crop([1.0, 5.0, 1.25, 6.25], "um").heights, part.heights)
    np.testing.assert_array_equal(surface.crop([1000, 5000, 1250, 6250], "nm").heights, part.heights)
    np.testing.assert_array_equal(Surface(ROUGH[0]).crop((3, 30)).heights, ROUGH[0, 3:])


@pytest.mark.parametrize(
    ("bounds", "unit", "message"),
    [
        ([0, 10], "pixel", r"crop: expected 4 numbers, top, bottom, left and right, got \[0, 10\]"),
        (
            [0, 10, 5, 31],
            "pixel",
            "crop: expected begin and end of a part, within 0 and 30 pixels, got 5 to 31",
        ),
        ([-2, 10, 5, 30], "pixel", "within 0 and 24 pixels, got -2 to 10"),
        ([10, 10, 5, 30], "pixel", "got 10 to 10"),
        ([0, 0.01, 0, 5], "um", r"crop: expected a part of a pixel, 0\.5 um, or more, got 0 to 0\.01 um"),
        ([0, 1, 0, 5], "furlong", "crop_unit: expected one of 'pixel', .*, got 'furlong'"),
    ],
)
def test_what_is_no_part_is_refused(bounds: Any, unit: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Surface(ROUGH, "nm", (0.5, 0.25), "um").crop(bounds, unit)


def test_a_part_by_lengths_needs_lengths() -> None:
    with pytest.raises(
        InputError, match="crop: expected pixels with a unit of length, to crop in um, got none"
    ):
        Surface(ROUGH).crop([0, 1, 0, 1], "um")


@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
def test_a_band_of_waves(edges: Any) -> None:
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
    with pytest.raises(InputError, match="shortest: expected a wavelength below the longest, 3, got 4"):
        surface.band(longest=3, shortest=4)
    with pytest.raises(InputError, match="longest: expected a finite number > 0"):
        surface.band(longest=0)


def test_a_band_of_a_reflecting_surface_is_that_of_its_mirror_images(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", ROUGH)
    options: dict[str, Any] = {"shortest": 4.0, "longest": 20.0, "tilt": "mean"}
    images = read(tmp_path / "a.npy", periodic="mirror", **options)
    alone = read(tmp_path / "a.npy", periodic="reflect", **options)
    assert (images.edges, alone.edges) == ("periodic", "reflecting")
    assert alone.shape == ROUGH.shape
    np.testing.assert_array_equal(images.scan.heights, alone.heights)
    scan = images.scan
    assert scan.scan is scan
    again = read(tmp_path / "a.npy", tilt="mean").band(shortest=4.0, longest=20.0)
    np.testing.assert_allclose(again.heights, images.heights, atol=1e-13)
    assert images.provenance["shortest"] == 4.0
    assert alone.provenance["periodic_rule"] == "reflect"
    wrapped = read(tmp_path / "a.npy", periodic="wrap", **options)
    kept = Surface(ROUGH - ROUGH.mean()).band(shortest=4.0, longest=20.0)
    np.testing.assert_allclose(wrapped.heights, kept.heights, atol=1e-13)


def test_a_part_is_cut_out_before_anything_else(tmp_path: Path) -> None:
    holed = ROUGH + 100 + np.arange(30)
    holed[0, 0] = np.nan
    np.save(tmp_path / "a.npy", holed)
    np.save(tmp_path / "part.npy", holed[4:20, 6:30])
    options: dict[str, Any] = {"pixel_size": (2.0, 1.0), "length_unit": "nm", "file_unit": "nm"}
    part = read(tmp_path / "a.npy", crop=[8, 40, 6, 30], crop_unit="nm", undefined="refuse", **options)
    same = read(tmp_path / "part.npy", undefined="refuse", **options)
    np.testing.assert_array_equal(part.heights, same.heights)
    assert part.provenance["crop"] == [4, 20, 6, 30]
    assert part.provenance["tilt_coefficients"] == same.provenance["tilt_coefficients"]
    assert (part.unit, part.pixel_size, part.length_unit) == ("nm", (2.0, 1.0), "nm")
    assert part.has_lengths


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"file_unit": "rms"}, "file_unit: expected one of None, 'm', .*, got 'rms'"),
        ({"length_unit": "nm"}, r"length_unit: expected pixels of known size, got none; try pixel_size"),
        ({"pixel_size": 0.0}, "pixel_size: expected finite numbers above 0"),
        ({"pixel_size": (1.0, 2.0, 3.0)}, "pixel_size: expected one number above 0, or 2, one an axis"),
        ({"shortest": 3.0, "longest": 2.0}, "shortest: expected a wavelength below the longest"),
        ({"crop": [0, 5, 0, 99]}, "crop: expected begin and end of a part, within 0 and 30 pixels"),
    ],
)
def test_options_of_files_are_checked(tmp_path: Path, options: Any, message: str) -> None:
    np.save(tmp_path / "a.npy", ROUGH)
    with pytest.raises(InputError, match=message):
        read(tmp_path / "a.npy", **options)


def test_two_rough_bodies_are_the_sum() -> None:
    first = Surface(ROUGH, "um", (0.5, 0.5), "um", {"file": "a.npy"})
    second = Surface(1e3 * ROUGH[::-1], "nm", (500, 500), "nm", {"file": "b.npy"})
    both = combined(first, second)
    np.testing.assert_allclose(both.heights, ROUGH + ROUGH[::-1], rtol=1e-14)
    assert (both.unit, both.pixel_size, both.length_unit) == ("um", (0.5, 0.5), "um")
    assert both.provenance == {"file": "a.npy", "other": "b.npy"}
    assert combined(Surface(ROUGH), Surface(ROUGH)).heights[3, 4] == 2 * ROUGH[3, 4]


@pytest.mark.parametrize(
    ("second", "message"),
    [
        (Surface(ROUGH[1:], "um", (0.5, 0.5), "um"), r"expected the shape of the first, \(24, 30\), got"),
        (Surface(ROUGH, "um", (0.5, 0.4), "um"), r"size of the first, 0\.5 x 0\.5 um, got 0\.5 x 0\.4 um"),
        (Surface(ROUGH, "um"), r"the pixel size of the first, 0\.5 x 0\.5 um, got unknown"),
        (Surface(ROUGH, "1", (0.5, 0.5), "um"), "heights that can be added to those .* got heights in '1'"),
        (
            Surface(ROUGH, "um", (0.5, 0.5), "um", edges="reflecting"),
            "the edges of the first, periodic, got refl",
        ),
        (ROUGH, "second: expected a Surface, got ndarray"),
    ],
)
def test_bodies_that_cannot_be_added(second: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        combined(Surface(ROUGH, "um", (0.5, 0.5), "um"), second)


def test_relative_heights_cannot_be_added() -> None:
    with pytest.raises(
        InputError, match="expected heights of one unit, got heights in units of the rms of each"
    ):
        combined(Surface(ROUGH, "rms"), Surface(ROUGH, "rms"))


def test_a_surface_in_meters() -> None:
    heights, spacing = Surface(ROUGH, "nm", (0.5, 0.25), "um").in_meters()
    np.testing.assert_allclose(heights, ROUGH * 1e-9, rtol=1e-15)
    assert spacing == pytest.approx((5e-7, 2.5e-7), rel=1e-15)


@pytest.mark.parametrize(
    ("surface", "known", "message"),
    [
        (Surface(ROUGH), False, "heights with a unit of length, got heights without a unit; try unit = 'nm'"),
        (Surface(ROUGH, "1", (1.0, 1.0)), False, "got heights without a unit"),
        (Surface(ROUGH, "1", (1.0, 1.0), "um"), True, "got heights without a unit"),
        (
            Surface(ROUGH, "rms", (1.0, 1.0), "um"),
            True,
            "got heights in units of their rms; try another unit",
        ),
        (Surface(ROUGH, "V", (1.0, 1.0), "um"), True, "got heights in 'V'"),
        (
            Surface(ROUGH, "nm"),
            True,
            "the distance between pixels, got heights in 'nm', and pixels of unknown",
        ),
        (
            Surface(ROUGH, "nm", (1.0, 1.0)),
            True,
            "with a unit of length, got pixels of 1 x 1 in no unit; try len",
        ),
        (Surface(ROUGH, "nm", (1.0, 2.0), "V"), True, "got pixels of 1 x 2 in 'V'"),
    ],
)
def test_a_surface_without_lengths_has_no_meters(surface: Surface, known: bool, message: str) -> None:
    assert surface.has_lengths is known
    with pytest.raises(InputError, match=message):
        surface.in_meters()


def test_a_surface_is_checked_when_it_is_made() -> None:
    with pytest.raises(InputError, match="pixel_size: expected one number above 0, or 2, one an axis"):
        Surface(ROUGH, "nm", (1.0,), "nm")
    with pytest.raises(InputError, match="edges: expected one of 'periodic', 'reflecting', got 'mirror'"):
        Surface(ROUGH, edges="mirror")  # type: ignore[arg-type]


def test_curvature_of_a_paraboloid_is_exact() -> None:
    i, j = np.meshgrid(np.arange(9.0), np.arange(7.0), indexing="ij")
    bowl = 3 * i**2 + 2 * j**2 + 5 * i * j
    assert statistics(bowl).rms_curvature == pytest.approx((6 + 4) / 2)
    assert statistics(bowl, (0.5, 2.0)).rms_curvature == pytest.approx((6 / 0.25 + 4 / 4) / 2)
    assert statistics(bowl[:, 0]).rms_curvature == pytest.approx(6)
    for small in (bowl[:2], bowl[:, :2], bowl[0, :2]):
        assert statistics(small).rms_curvature == 0


@pytest.mark.parametrize(
    ("surface", "curvature", "unit"),
    [
        (Surface(np.arange(9.0) ** 2, "nm", (0.5,), "um"), 2 / 500**2, "1/nm"),
        (Surface(np.arange(9.0) ** 2, "rms", (0.5,), "um"), 8.0, "rms/um^2"),
        (Surface(np.arange(9.0) ** 2), 2.0, "1/pixel^2"),
        (Surface(np.arange(9.0) ** 2, "nm", (0.5,)), 8.0, "nm/(unit of length)^2"),
    ],
)
def test_curvature_has_a_unit(surface: Surface, curvature: float, unit: str) -> None:
    measured = surface.describe()
    assert measured.rms_curvature == pytest.approx(curvature)
    assert measured.curvature_unit == unit


def test_a_surface_of_waves_is_unaltered_by_its_own_band() -> None:
    heights = spectral((64, 48), spacing=(1.0, 0.5), roll_off=20, cutoff=4)
    same = Surface(heights, pixel_size=(1.0, 0.5)).band(shortest=4.0)
    np.testing.assert_allclose(same.heights, heights, atol=1e-13)


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ({"pixel_size": "1 um"}, ((1.0, 1.0), "um")),
        ({"pixel_size": "0.5 \u00b5m", "unit": "nm"}, ((0.5, 0.5), "um")),
        ({"pixel_size": ("0.3 um", "200 nm")}, ((0.3, 0.2), "um")),
        ({"pixel_size": ["0.3 um", "200 nm"], "length_unit": "nm"}, ((300.0, 200.0), "nm")),
        ({"pixel_size": "1e-3 inch"}, ((2.54e-5, 2.54e-5), "m")),
    ],
)
def test_pixel_sizes_with_a_unit(tmp_path: Path, given: Any, kept: Any) -> None:
    heights = np.random.default_rng(0).normal(size=(6, 5))
    surface = Surface(heights, **given)
    assert surface.pixel_size == pytest.approx(kept[0])
    assert surface.length_unit == kept[1]
    np.save(tmp_path / "a.npy", heights)
    unit = {"file_unit": given.pop("unit", None)}
    same = read(tmp_path / "a.npy", periodic="wrap", **given, **unit)
    assert (same.pixel_size, same.length_unit) == (surface.pixel_size, surface.length_unit)


@pytest.mark.parametrize("wrong", ["1 kg", "1", "um", "-1 um", ("1 um", "x"), ("1 um",)])
def test_pixel_sizes_that_are_none(wrong: Any) -> None:
    with refuses("pixel_size"):
        Surface(np.ones((4, 5)), pixel_size=wrong)
