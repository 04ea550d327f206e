"""Parts of surfaces, bands of waves, sums of two, and surfaces in meters."""

from typing import Any

import numpy as np
import pytest

from asperity.surfaces import Surface, combined, gaussian, read, spectral
from tests.refusals import refuses

ROUGH = gaussian((24, 30), seed=4)
SIZED = Surface(ROUGH, "nm", (0.5, 0.25), "um", {"file": "a.npy", "periodic_rule": "mirror"})


@pytest.fixture(autouse=True)
def _folder(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_part_by_pixels_and_by_lengths() -> None:
    part = SIZED.crop([2, 10, 5, 25])
    np.testing.assert_array_equal(part.heights, ROUGH[2:10, 5:25])
    assert (part.unit, part.pixel_size, part.length_unit) == ("nm", (0.5, 0.25), "um")
    # It is no longer made of mirror images.
    assert part.provenance == {"file": "a.npy", "crop": [2, 10, 5, 25]}
    assert part.scan is part
    assert part.edges == "reflecting"
    assert SIZED.crop([0, 24, 0, 30]).edges == "periodic"
    np.testing.assert_array_equal(SIZED.crop([1.0, 5.0, 1.25, 6.25], "um").heights, part.heights)
    np.testing.assert_array_equal(SIZED.crop([1000, 5000, 1250, 6250], "nm").heights, part.heights)
    np.testing.assert_array_equal(Surface(ROUGH[0]).crop((3, 30)).heights, ROUGH[0, 3:])
    with refuses("crop_unit"):
        SIZED.crop([0, 1, 0, 5], "furlong")
    wrong: list[tuple[Surface, list[float], str]] = [
        (SIZED, [0, 10], "pixel"),
        (SIZED, [0, 10, 5, 31], "pixel"),
        (SIZED, [-2, 10, 5, 30], "pixel"),
        (SIZED, [10, 10, 5, 30], "pixel"),
        (SIZED, [0, 0.01, 0, 5], "um"),
        (Surface(ROUGH), [0, 1, 0, 1], "um"),
    ]
    for surface, bounds, unit in wrong:
        with refuses("crop"):
            surface.crop(bounds, unit)


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
    with refuses("longest"):
        surface.band(longest=0)


def test_a_band_of_a_reflecting_surface_is_that_of_its_mirror_images() -> None:
    np.save("a.npy", ROUGH)
    options: dict[str, Any] = {"shortest": 4.0, "longest": 20.0, "tilt": "mean"}
    images, alone, wrapped = (
        read("a.npy", periodic=rule, **options) for rule in ("mirror", "reflect", "wrap")
    )
    assert (images.edges, alone.edges) == ("periodic", "reflecting")
    assert alone.shape == ROUGH.shape
    np.testing.assert_array_equal(images.scan.heights, alone.heights)
    scan = images.scan
    assert scan.scan is scan
    again = read("a.npy", tilt="mean").band(shortest=4.0, longest=20.0)
    np.testing.assert_allclose(again.heights, images.heights, atol=1e-13)
    assert (images.provenance["shortest"], alone.provenance["periodic_rule"]) == (4.0, "reflect")
    kept = Surface(ROUGH - ROUGH.mean()).band(shortest=4.0, longest=20.0)
    np.testing.assert_allclose(wrapped.heights, kept.heights, atol=1e-13)


def test_a_part_is_cut_out_before_anything_else() -> None:
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
    assert part.has_lengths


def test_two_rough_bodies_are_the_sum() -> None:
    first = Surface(ROUGH, "um", (0.5, 0.5), "um", {"file": "a.npy"})
    second = Surface(1e3 * ROUGH[::-1], "nm", (500, 500), "nm", {"file": "b.npy"})
    both = combined(first, second)
    np.testing.assert_allclose(both.heights, ROUGH + ROUGH[::-1], rtol=1e-14)
    assert (both.unit, both.pixel_size, both.length_unit) == ("um", (0.5, 0.5), "um")
    assert both.provenance == {"file": "a.npy", "other": "b.npy"}
    assert combined(Surface(ROUGH), Surface(ROUGH)).heights[3, 4] == 2 * ROUGH[3, 4]
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
    for one, other in wrong:
        with refuses("second"):
            combined(one, other)


def test_a_surface_in_meters() -> None:
    heights, spacing = SIZED.in_meters()
    np.testing.assert_allclose(heights, ROUGH * 1e-9, rtol=1e-15)
    assert spacing == pytest.approx((5e-7, 2.5e-7), rel=1e-15)
    for surface, has_lengths in (
        (Surface(ROUGH), False),
        (Surface(ROUGH, "1", (1.0, 1.0)), False),
        (Surface(ROUGH, "1", (1.0, 1.0), "um"), True),
        (Surface(ROUGH, "rms", (1.0, 1.0), "um"), True),
        (Surface(ROUGH, "V", (1.0, 1.0), "um"), True),
        (Surface(ROUGH, "nm"), True),
        (Surface(ROUGH, "nm", (1.0, 1.0)), True),
        (Surface(ROUGH, "nm", (1.0, 2.0), "V"), True),
    ):
        assert surface.has_lengths is has_lengths
        with refuses("surface"):
            surface.in_meters()


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
def test_pixel_sizes_with_a_unit(given: Any, kept: Any) -> None:
    surface = Surface(ROUGH, **given)
    assert surface.pixel_size == pytest.approx(kept[0])
    assert surface.length_unit == kept[1]
    np.save("a.npy", ROUGH)
    unit = {"file_unit": given.pop("unit", None)}
    same = read("a.npy", periodic="wrap", **given, **unit)
    assert (same.pixel_size, same.length_unit) == (surface.pixel_size, surface.length_unit)


def test_a_surface_is_checked_when_it_is_made() -> None:
    wrong: list[Any] = ["1 kg", "1", "um", "-1 um", ("1 um", "x"), ("1 um",), (1.0,)]
    for size in wrong:
        with refuses("pixel_size"):
            Surface(ROUGH, pixel_size=size)
    with refuses("edges"):
        Surface(ROUGH, edges="mirror")  # type: ignore[arg-type]
    with refuses("heights"):
        Surface(np.array([1.0, np.nan]))
