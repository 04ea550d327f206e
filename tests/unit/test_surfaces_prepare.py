"""The rules that make a measurement ready: filling, tilt, unit, periodicity."""

from typing import Any

import numpy as np
import pytest

from asperity.surfaces import levelling, prepare
from tests.refusals import refuses


def relaxed(heights: Any, sweeps: int = 4000) -> Any:
    """Harmonic filling by Jacobi sweeps, site by site: slow and obvious."""
    missing = [tuple(site) for site in np.argwhere(np.isnan(heights))]
    filled = np.where(np.isnan(heights), np.nanmean(heights), heights)
    for _ in range(sweeps):
        old = filled.copy()
        for site in missing:
            around = []
            for axis, n in enumerate(heights.shape):
                for step in (-1, 1):
                    other = list(site)
                    other[axis] += step
                    if 0 <= other[axis] < n:
                        around.append(old[tuple(other)])
            filled[site] = sum(around) / len(around)
    return filled


def holed(shape: Any, fraction: float, seed: int) -> Any:
    rng = np.random.default_rng(seed)
    heights = rng.normal(size=shape)
    heights[rng.random(shape) < fraction] = np.nan
    return heights


@pytest.mark.parametrize("shape", [(7, 6), (1, 9), (12,)])
def test_fill_equals_slow_relaxation(shape: Any) -> None:
    heights = holed(shape, 0.4, seed=8)
    heights.flat[0] = np.nan  # a corner too
    filled = prepare.fill(heights)
    np.testing.assert_allclose(filled, relaxed(heights), atol=1e-10)
    defined = ~np.isnan(heights)
    np.testing.assert_array_equal(filled[defined], heights[defined])


@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_fill_creates_no_summit(offset: float) -> None:
    # Offsets bring out rounding: a filled pixel must not stick out even by one unit in the last place.
    for seed in range(5):
        heights = holed((40, 40), 0.5, seed) + offset
        filled = prepare.fill(heights)
        padded = np.pad(filled, 1, constant_values=-np.inf)
        around = np.stack([padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]])
        assert not (filled > around.max(axis=0))[np.isnan(heights)].any()
        assert filled.max() == np.nanmax(heights)
        assert filled.min() == np.nanmin(heights)
    level = np.full((20, 20), 0.1)
    level[3:9, 2:17] = np.nan
    assert np.unique(prepare.fill(level)).tolist() == [0.1]


def test_mean_and_none() -> None:
    heights = np.array([[1.0, 2.0], [3.0, 90.0]])
    defined = np.array([[True, True], [True, False]])
    level, coefficients = levelling.remove_tilt(heights, defined, "mean")
    np.testing.assert_array_equal(level, heights - 2)
    assert coefficients == [2.0, 0.0, 0.0]
    same, nothing = levelling.remove_tilt(heights, defined, "none")
    np.testing.assert_array_equal(same, heights)
    assert nothing == [0.0, 0.0, 0.0]


def test_units_are_converted_or_kept_or_become_the_rms() -> None:
    heights = np.array([1.0, -1.0, 3.0, -3.0])
    for unit, target, factor in (
        ("m", "nm", 1e9),
        ("nm", "m", 1e-9),
        ("um", "mm", 1e-3),
        ("angstrom", "pm", 100.0),
        ("nm", "nm", 1.0),
    ):
        assert prepare.scale_factor(heights, unit, target, largest=3.0) == (factor, target)
    assert prepare.scale_factor(heights, "V", None, largest=3.0) == (1.0, "V")
    factor, unit = prepare.scale_factor(heights, "1", "rms", largest=3.0)
    assert unit == "rms"
    assert np.std(heights * factor) == pytest.approx(1.0)
    with refuses("unit"):
        prepare.scale_factor(heights, "V", "nm", largest=1.0)
    with refuses("unit"):  # what rounding leaves of a plane is no roughness to divide by
        prepare.scale_factor(np.array([0.0, 1e-15, 0.0]), "nm", "rms", largest=5.0)


@pytest.mark.parametrize(("ratio", "kept"), [(3.0, 4), (2.5, 4), (1.3, 9)])
def test_oblong_pixels_are_averaged_along_the_finer_axis(ratio: float, kept: int) -> None:
    heights = np.random.default_rng(1).normal(size=(5, 12))
    slow = np.zeros((5, kept))
    for pixel in range(kept):
        for place in range(12):
            overlap = min(place + 1, (pixel + 1) * ratio) - max(place, pixel * ratio)
            slow[:, pixel] += max(overlap, 0) / ratio * heights[:, place]
    coarse, size = prepare.square(heights, (ratio * 0.1, 0.1))
    np.testing.assert_allclose(coarse, slow, atol=1e-13)
    assert size == pytest.approx((ratio * 0.1, ratio * 0.1))
    turned, _ = prepare.square(heights.T, (0.1, ratio * 0.1))
    np.testing.assert_array_equal(turned, coarse.T)


def test_square_and_unknown_pixels_stay() -> None:
    heights = np.ones((4, 5))
    sizes: list[Any] = [None, (2.0, 2.0), (2.0, 2.01)]
    for size in sizes:
        left, kept = prepare.square(heights, size)
        assert left is heights
        assert kept == size
    with refuses("resample"):
        prepare.square(heights, (3.0, 1.0))


@pytest.mark.parametrize("shape", [(5, 4), (7,), (1, 3)])
def test_mirror_doubles_and_alters_nothing(shape: Any) -> None:
    heights = np.random.default_rng(0).normal(size=shape)
    mirrored = prepare.make_periodic(heights, "mirror")
    assert mirrored.shape == tuple(2 * n for n in shape)
    np.testing.assert_array_equal(mirrored[tuple(slice(n) for n in shape)], heights)
    for axis in range(heights.ndim):
        np.testing.assert_array_equal(mirrored, np.flip(mirrored, axis=axis))
    np.testing.assert_array_equal(prepare.make_periodic(heights, "wrap"), heights)


def test_taper_is_half_a_cosine_toward_the_mean_along_each_axis() -> None:
    def weight(n: int) -> Any:
        """Half a cosine over a tenth of n pixels, at their middles."""
        place = np.minimum(np.arange(n) + 0.5, n - np.arange(n) - 0.5)
        return np.where(place < 0.1 * n, 0.5 * (1 - np.cos(np.pi * place / (0.1 * n))), 1.0)

    profile = np.where(np.arange(40) % 2, 1.0, 5.0)  # deviations of -2 and 2 from the mean 3
    tapered = prepare.make_periodic(profile, "taper")
    np.testing.assert_allclose(tapered, 3 + weight(40) * (profile - 3), atol=1e-14)
    sign = np.where(np.add.outer(np.arange(20), np.arange(30)) % 2, 1.0, -1.0)
    tapered = prepare.make_periodic(sign, "taper")
    np.testing.assert_allclose(tapered, sign * np.outer(weight(20), weight(30)), atol=1e-14)
