"""Power laws and growth rates: exact data, known spread, windows, and data that leave something open."""

import math

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy.stats import linregress, t

from asperity.fits import growth_rate, local_exponent, power_law
from tests.refusals import refuses

X = np.geomspace(0.1, 1e4, 12)


def noise(size: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=size)


def test_power_law_recovers_exact_parameters() -> None:
    fit = power_law(X[::-1], 7 * X[::-1] ** -0.3)
    assert (fit.exponent, fit.prefactor) == pytest.approx((-0.3, 7), rel=1e-12)
    assert fit.exponent_stderr < 1e-12
    assert fit.r_squared == pytest.approx(1)
    assert fit.rms_residual < 1e-13
    assert fit.points == 12
    np.testing.assert_allclose(fit(X), 7 * X**-0.3, rtol=1e-12)


def test_power_law_agrees_with_linear_regression() -> None:
    y = 2 * X**0.8 * np.exp(0.1 * noise(X.size, 0))
    fit, line = power_law(X, y), linregress(np.log(X), np.log(y))
    assert fit.exponent == pytest.approx(line.slope, rel=1e-12)
    assert fit.exponent_stderr == pytest.approx(line.stderr, rel=1e-10)
    assert fit.prefactor == pytest.approx(math.exp(line.intercept), rel=1e-12)
    assert fit.prefactor_stderr == pytest.approx(fit.prefactor * line.intercept_stderr, rel=1e-10)
    assert fit.r_squared == pytest.approx(line.rvalue**2, rel=1e-10)
    assert fit.rms_residual == pytest.approx(np.sqrt(np.mean((1 - fit(X) / y) ** 2)), rel=1e-10)
    # The interval of the prefactor is one of its logarithm.
    low, high = fit.interval("prefactor")
    assert low * high == pytest.approx(fit.prefactor**2)


def test_standard_errors_are_weights_and_are_believed() -> None:
    y = 3 * X**0.5
    y[0] = 100
    stderr = 1e-3 * y
    stderr[0] = 1e3 * y[0]
    fit = power_law(X, y, stderr)
    assert fit.exponent == pytest.approx(0.5, abs=1e-6)
    # Relative errors s of ln y alone: the variance of the slope is s^2 / sum (ln x - mean ln x)^2.
    z = np.log(X[1:])
    assert fit.exponent_stderr == pytest.approx(1e-3 / np.sqrt(np.sum((z - z.mean()) ** 2)), rel=1e-4)
    assert fit.degrees_of_freedom == math.inf
    # All residuals are far below what the standard errors say.
    assert fit.reduced_chi_squared == pytest.approx(0, abs=1e-5)


def test_local_exponent() -> None:
    middle, exponent = local_exponent(X, 7 * X**1.5)
    np.testing.assert_allclose(exponent, 1.5, rtol=1e-12)
    np.testing.assert_allclose(middle, np.sqrt(X[1:] * X[:-1]))
    # Exact for a law that bends: d ln(1 + x)/d ln x between x = 1 and x = 3 is ln 2/ln 3.
    _, bent = local_exponent([3.0, 1.0], [4.0, 2.0])
    assert bent == pytest.approx([math.log(2) / math.log(3)])
    # Repeated x count as their geometric mean.
    _, averaged = local_exponent([1.0, 2.0, 2.0], [1.0, 2.0, 8.0])
    assert averaged == pytest.approx([2.0])


@pytest.mark.parametrize(
    ("x", "y", "name"),
    [
        ([0, 1, 2], [1, 2, 3], "x"),
        ([1, 2, 3], [1, -2, 3], "y"),
        ([1, 2], [1, 2], "x"),
        ([2, 2, 2], [1, 2, 3], "x"),
        ([1, 2, 3], [1, 2], "y"),
    ],
)
def test_power_laws_that_are_none(x: ArrayLike, y: ArrayLike, name: str) -> None:
    with refuses(name):
        power_law(x, y)


TIME = np.append(0.0, np.geomspace(1e-2, 1e4, 25))


def test_rate_of_an_exact_logarithm() -> None:
    area = np.append(5.0, 6 + 0.4 * np.log(TIME[1:]))
    rate = growth_rate(TIME, area)
    assert pytest.approx(0.4 / 5, rel=1e-12) == rate.B
    assert rate.slope == pytest.approx(0.4, rel=1e-12)
    assert rate.initial_area == 5
    assert abs(rate.curvature) < 1e-10
    assert rate.straight
    assert (rate.first, rate.last) == pytest.approx((0.01, 1e4))
    assert rate.points == 25
    np.testing.assert_allclose(rate.predict(TIME[1:]), area[1:], rtol=1e-12)


def test_relative_rate_of_an_exact_power() -> None:
    rate = growth_rate(TIME[1:], 3 * TIME[1:] ** 0.05, initial=2.0)
    assert rate.relative == pytest.approx(0.05, rel=1e-12)
    assert pytest.approx(rate.slope / 2) == rate.B


def test_rate_agrees_with_linear_regression_in_its_window() -> None:
    area = 1 + 0.2 * np.log1p(TIME) + 0.01 * noise(TIME.size, 2)
    chosen = (TIME >= 1) & (TIME <= 1e3)
    rate = growth_rate(TIME[::-1], area[::-1], 1, 1e3)
    line = linregress(np.log(TIME[chosen]), area[chosen])
    assert rate.slope == pytest.approx(line.slope, rel=1e-10)
    assert rate.slope_stderr == pytest.approx(line.stderr, rel=1e-8)
    assert rate.B_stderr == pytest.approx(rate.slope_stderr / area[0])
    assert rate.points == chosen.sum()
    assert rate.interval("slope") == pytest.approx(
        t.interval(0.95, rate.points - 2, loc=line.slope, scale=line.stderr), rel=1e-8
    )


def test_curvature_is_the_change_of_the_slope() -> None:
    z = np.linspace(0, 4, 9)
    time = np.exp(z)
    # Slope 1 + z/2: from 1 to 3 about a mean of 2.
    rate = growth_rate(time, 10 + z + z**2 / 4, initial=1.0)
    assert rate.curvature == pytest.approx(1.0, rel=1e-10)
    assert not rate.straight
    # An S has like slopes at its ends, and another in its middle: -(z - 2)^3 + 20 z has 8, 20, 8.
    bent = growth_rate(time, 100 + 20 * z - (z - 2) ** 3, initial=1.0)
    assert abs(bent.curvature * bent.slope) == pytest.approx(12, rel=1e-9)
    assert not bent.straight
    # Three points tell of nothing but the line.
    few = growth_rate(time[:3], 10 + z[:3], initial=1.0)
    assert math.isnan(few.curvature)
    assert few.straight is None


def test_few_points_do_not_tell_a_line_from_a_curve() -> None:
    z = np.arange(4.0)
    y = 10 + z + np.array([0.008, -0.024, 0.024, -0.008]) - 0.02 * (z - 1.5) ** 2
    rate = growth_rate(np.exp(z), y, initial=1.0)
    # A parabola leaves one degree of freedom, of which the interval reaches 12.7 standard errors.
    assert rate.curvature_reach == pytest.approx(t.ppf(0.975, 1) * rate.curvature_stderr)
    assert rate.interval("curvature") == pytest.approx(
        (rate.curvature - rate.curvature_reach, rate.curvature + rate.curvature_reach)
    )
    assert 2 * rate.curvature_stderr < 0.25 < rate.curvature_reach
    assert rate.straight is None


def test_times_near_the_largest_numbers() -> None:
    time = np.geomspace(1e200, 1e204, 9)
    rate = growth_rate(time, 6 + 0.4 * np.log(time), initial=5.0)
    np.testing.assert_allclose(rate.predict(time), 6 + 0.4 * np.log(time))


def test_the_initial_area_and_its_error_stand_in_the_rate() -> None:
    time = np.concatenate([np.zeros(4), TIME[1:]])
    area = np.concatenate([[4.8, 5.0, 5.0, 5.2], 6 + 0.4 * np.log(TIME[1:])])
    rate = growth_rate(time, area)
    assert rate.initial_area == pytest.approx(5.0)
    # Standard error of a mean of four: their standard deviation over 2.
    assert rate.initial_area_stderr == pytest.approx(np.std(area[:4], ddof=1) / 2)
    assert rate.B_stderr == pytest.approx(rate.B * rate.initial_area_stderr / 5, rel=1e-6)
    weighted = growth_rate(time, area, stderr=np.full(time.size, 0.1))
    assert weighted.initial_area_stderr == pytest.approx(0.05)
    given = growth_rate(time, area, initial=2.0, initial_stderr=0.2)
    assert given.B_stderr / given.B == pytest.approx(0.1, rel=1e-6)


def test_bad_windows_are_named() -> None:
    area = 1 + np.log1p(TIME)
    with refuses("initial"):
        growth_rate(TIME[1:], area[1:])
    with refuses("time"):
        growth_rate(TIME, area, first=1e5)
    with refuses("initial"):
        growth_rate(TIME, area, initial=0.0)
    with refuses("stderr"):
        growth_rate(TIME, area, stderr=np.zeros(TIME.size))
    with refuses("name"):
        growth_rate(TIME, area).interval("q")
