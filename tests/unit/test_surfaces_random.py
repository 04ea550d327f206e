"""Surfaces made at random: their laws, their seeds, and what they refuse."""

import math
from typing import Any

import numpy as np
import pytest
import scipy.stats

from asperity.surfaces import exponential, gaussian, self_affine
from tests.refusals import refuses

MAKERS = [gaussian, exponential]


@pytest.mark.parametrize(
    ("make", "law"), [(gaussian, scipy.stats.norm(scale=2.5)), (exponential, scipy.stats.expon(scale=2.5))]
)
def test_uncorrelated_heights_follow_their_law(make: Any, law: Any) -> None:
    heights = make((300, 300), rms=2.5, seed=11)
    # A right law fails this at one seed in a thousand; the seed is fixed.
    assert scipy.stats.kstest(heights.ravel(), law.cdf).pvalue > 1e-3
    # The standard error of the variance is sqrt((kurtosis - 1) / N) of it.
    kurtosis = 3 + float(law.stats("k"))
    assert heights.var() == pytest.approx(2.5**2, rel=4 * math.sqrt((kurtosis - 1) / heights.size))


@pytest.mark.parametrize("make", MAKERS)
def test_neighbors_are_uncorrelated(make: Any) -> None:
    heights = make((300, 300), seed=5)
    deviation = heights - heights.mean()
    for axis in (0, 1):
        correlation = np.mean(deviation * np.roll(deviation, 1, axis=axis)) / heights.var()
        assert abs(correlation) < 4 / math.sqrt(heights.size)


@pytest.mark.parametrize("make", MAKERS)
def test_rms_is_a_scale_and_seed_a_name(make: Any) -> None:
    for shape, expected in ((7, (7,)), ((7,), (7,)), ((3, 5), (3, 5)), (np.int64(4), (4,))):
        heights = make(shape, seed=2)
        assert heights.shape == expected
        assert heights.dtype == np.float64
        np.testing.assert_allclose(make(shape, rms=3.0, seed=2), 3 * heights, rtol=1e-15)
        np.testing.assert_array_equal(make(shape, seed=np.int64(2)), heights)
        assert not np.array_equal(make(shape, seed=3), heights)


def slow_self_affine(size: Any, hurst: Any, delta: Any, seed: Any) -> Any:
    """The paper's text, site by site; the random values are drawn in the same order as in the package."""
    rng = np.random.default_rng(seed)
    xi = [[0.0] * size for _ in range(size)]
    side = size
    while side >= 2:
        half = side // 2
        distance = side / 2**0.5
        for i in range(half, size, side):
            for j in range(half, size, side):
                corners = [xi[(i + a) % size][(j + b) % size] for a in (-half, half) for b in (-half, half)]
                xi[i][j] = sum(corners) / 4 + rng.normal(0.0, distance**hurst * delta)
        distance /= 2**0.5
        turned = [(i, j) for i in range(half, size, side) for j in range(0, size, side)]
        turned += [(i, j) for i in range(0, size, side) for j in range(half, size, side)]
        known = [list(row) for row in xi]
        for i, j in turned:
            around = [
                known[(i + a) % size][(j + b) % size]
                for a, b in ((half, 0), (-half, 0), (0, half), (0, -half))
            ]
            xi[i][j] = sum(around) / 4 + rng.normal(0.0, distance**hurst * delta)
        side = half
    return np.array(xi)


@pytest.mark.parametrize(("size", "hurst", "delta"), [(2, 0.5, 0.01), (4, 1.0, 1.0), (32, 0.3, 0.2)])
def test_self_affine_equals_the_paper_site_by_site(size: Any, hurst: Any, delta: Any) -> None:
    fast = self_affine(size, hurst=hurst, delta=delta, seed=9)
    np.testing.assert_allclose(
        fast, slow_self_affine(size, hurst, delta, 9), rtol=0, atol=1e-13 * np.abs(fast).max()
    )


def structure_exponent(size: Any, hurst: Any, lags: Any, seeds: Any) -> Any:
    """Half the slope of <[xi(r) - xi(0)]^2> in r, both logarithmic."""
    structure = np.zeros(len(lags))
    for seed in range(seeds):
        xi = self_affine(size, hurst=hurst, seed=seed)
        structure += [np.mean((xi - np.roll(xi, r, 0)) ** 2 + (xi - np.roll(xi, r, 1)) ** 2) for r in lags]
    return np.polyfit(np.log(lags), np.log(structure), 1)[0] / 2


def test_structure_function_grows_with_the_hurst_exponent() -> None:
    # Midpoints without further additions approach the exponent from below as the range of scales opens: the
    # larger squares leave a background that is smooth, so its increments grow with the distance itself.
    near = structure_exponent(1024, 0.5, [8, 16, 32, 64], 4)
    far = structure_exponent(128, 0.5, [8, 16, 32], 40)
    assert far < near < 0.5
    assert near == pytest.approx(0.5, abs=0.04)
    assert structure_exponent(1024, 0.3, [8, 16, 32, 64], 2) == pytest.approx(0.3, abs=0.02)


def test_wrong_numbers_are_refused() -> None:
    def call(make: Any, *shape: Any, **options: Any) -> None:
        with refuses(next(iter(options)) if options else "shape" if make is not self_affine else "size"):
            make(*shape, **options)

    # Other types of numbers are tried on all public functions, in test_public_calls.
    for size in (1, 0, 3, 100):
        call(self_affine, size)
    for hurst in (0, 1.01):
        call(self_affine, 8, hurst=hurst)
    for width in (0, -1.0):
        call(self_affine, 8, delta=width)
    makers: list[Any] = [*MAKERS, self_affine]
    for make in makers:
        call(make, 8, seed=-1)
