"""Power laws, growth rates, the jackknife and ensembles: closed forms, known spread, and what stays open."""

import math
from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.stats import linregress, sem, t

from asperity.fits import (
    ensemble,
    growth_rate,
    jackknife,
    local_exponent,
    logarithm,
    power_law,
    saturation,
)
from tests.refusals import each_refuses

X = np.geomspace(0.1, 1e4, 12)
TIME = np.append(0.0, np.geomspace(1e-2, 1e4, 25))
RUNS = np.random.default_rng(0).normal(5.0, 1.0, size=(12, 3))


def noise(size, seed):
    return np.random.default_rng(seed).normal(size=size)


def test_power_law_agrees_with_linear_regression():
    y = 2 * X**0.8 * np.exp(0.1 * noise(X.size, 0))
    fit, line = power_law(X[::-1], y[::-1]), linregress(np.log(X), np.log(y))
    assert fit.exponent == pytest.approx(line.slope, rel=1e-12)
    assert fit.exponent_stderr == pytest.approx(line.stderr, rel=1e-10)
    assert fit.prefactor == pytest.approx(math.exp(line.intercept), rel=1e-12)
    assert fit.prefactor_stderr == pytest.approx(fit.prefactor * line.intercept_stderr, rel=1e-10)
    assert fit.r_squared == pytest.approx(line.rvalue**2, rel=1e-10)
    assert fit.rms_residual == pytest.approx(np.sqrt(np.mean((1 - fit(X) / y) ** 2)), rel=1e-10)
    assert fit.points == 12
    # The interval of the prefactor is one of its logarithm.
    low, high = fit.interval("prefactor")
    assert low * high == pytest.approx(fit.prefactor**2)


def test_standard_errors_are_weights_and_are_believed():
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


def test_local_exponent():
    middle, exponent = local_exponent(X, 7 * X**1.5)
    np.testing.assert_allclose(exponent, 1.5, rtol=1e-12)
    np.testing.assert_allclose(middle, np.sqrt(X[1:] * X[:-1]))
    # Exact for a law that bends: d ln(1 + x)/d ln x between x = 1 and x = 3 is ln 2/ln 3.
    _, bent = local_exponent([3.0, 1.0], [4.0, 2.0])
    assert bent == pytest.approx([math.log(2) / math.log(3)])
    # Repeated x count as their geometric mean.
    _, averaged = local_exponent([1.0, 2.0, 2.0], [1.0, 2.0, 8.0])
    assert averaged == pytest.approx([2.0])


def test_rate_of_an_exact_logarithm_or_power():
    area = np.append(5.0, 6 + 0.4 * np.log(TIME[1:]))
    rate = growth_rate(TIME, area)
    assert (rate.B, rate.slope, rate.initial_area) == pytest.approx((0.4 / 5, 0.4, 5), rel=1e-12)
    assert abs(rate.curvature) < 1e-10
    assert rate.straight
    assert (rate.first, rate.last) == pytest.approx((0.01, 1e4))
    np.testing.assert_allclose(rate.predict(TIME[1:]), area[1:], rtol=1e-12)
    power = growth_rate(TIME[1:], 3 * TIME[1:] ** 0.05, initial=2.0)
    assert power.relative == pytest.approx(0.05, rel=1e-12)
    assert pytest.approx(power.slope / 2) == power.B


def test_rate_agrees_with_linear_regression_in_its_window():
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


def test_curvature_is_the_change_of_the_slope():
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


def test_few_points_do_not_tell_a_line_from_a_curve():
    z = np.arange(4.0)
    y = 10 + z + np.array([0.008, -0.024, 0.024, -0.008]) - 0.02 * (z - 1.5) ** 2
    rate = growth_rate(np.exp(z), y, initial=1.0)
    # A parabola leaves one degree of freedom, of which the interval reaches 12.7 standard errors.
    reach = rate.curvature_reach
    assert reach == pytest.approx(t.ppf(0.975, 1) * rate.curvature_stderr)
    assert rate.interval("curvature") == pytest.approx((rate.curvature - reach, rate.curvature + reach))
    assert 2 * rate.curvature_stderr < 0.25 < reach
    assert rate.straight is None


def test_times_near_the_largest_numbers():
    time = np.geomspace(1e200, 1e204, 9)
    rate = growth_rate(time, 6 + 0.4 * np.log(time), initial=5.0)
    np.testing.assert_allclose(rate.predict(time), 6 + 0.4 * np.log(time))


def test_the_initial_area_and_its_error_stand_in_the_rate():
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


def test_the_jackknife_of_a_mean_is_its_standard_error():
    found = jackknife(lambda sample: sample.mean(axis=0), RUNS)
    np.testing.assert_allclose(found.value, RUNS.mean(axis=0))
    np.testing.assert_allclose(found.stderr, sem(RUNS, axis=0))
    interval = t.interval(0.95, 11, loc=RUNS.mean(axis=0), scale=sem(RUNS, axis=0))
    np.testing.assert_allclose([found.low, found.high], interval)
    assert found.runs == 12
    single = jackknife(np.mean, RUNS[:1])
    assert float(single.value) == pytest.approx(RUNS[0].mean())
    assert np.isnan([single.stderr, single.low, single.high]).all()


def test_a_ratio_of_means_of_two_samples():
    x, y = RUNS[:, 0], RUNS[:, 1]
    found = jackknife(lambda x, y: y.mean() / x.mean(), (x, y))
    # Leading order: the residuals y - r x over the mean of x.
    ratio = y.mean() / x.mean()
    assert float(found.value) == pytest.approx(ratio)
    assert float(found.stderr) == pytest.approx(sem(y - ratio * x) / x.mean(), rel=0.05)


def test_an_ensemble_is_the_fit_of_the_mean_with_the_scatter_of_the_runs():
    # Curves of a logarithm that differ as a whole, as those of surfaces do.
    rng = np.random.default_rng(1)
    initial, growth = rng.normal(100, 5, size=(6, 1)), rng.normal(20, 2, size=(6, 1))
    areas = initial + growth * np.log1p(TIME / 2)
    found = ensemble(logarithm, TIME, areas)
    assert found.mean == logarithm(TIME, areas.mean(axis=0))
    assert set(found.parameters) == {"C", "t0", "initial_area", "slope"}
    assert found.runs == 6
    # The mean curve is a logarithm again, with the mean slope: its error is that of a mean.
    slope = found.parameters["slope"]
    assert float(slope.value) == pytest.approx(growth.mean(), rel=1e-6)
    assert float(slope.stderr) == pytest.approx(sem(growth, axis=None), rel=1e-5)
    # The curve itself is exact: the errors of a single fit know nothing of the scatter.
    assert found.mean.slope_stderr < 1e-6 * float(slope.stderr)
    # Any fit serves.
    assert set(ensemble(power_law, TIME[1:], areas[:, 1:]).parameters) == {"exponent", "prefactor"}
    assert {"a", "q"} < set(ensemble(saturation, TIME, areas).parameters)
    no_fit = lambda _, A: jackknife(np.mean, A)  # noqa: E731
    each_refuses(
        ("fit", "Estimate", ensemble, no_fit, TIME, areas),
        ("areas", "shape (26,)", ensemble, logarithm, TIME, areas[0]),
    )


def test_what_cannot_be_fitted_is_named():
    area = 1 + np.log1p(TIME)
    calls: list[tuple[str, Any, tuple[Any, ...], dict[str, Any]]] = [
        ("x", power_law, ([0, 1, 2], [1, 2, 3]), {}),
        ("y", power_law, ([1, 2, 3], [1, -2, 3]), {}),
        ("x", power_law, ([1, 2], [1, 2]), {}),
        ("x", power_law, ([2, 2, 2], [1, 2, 3]), {}),
        ("y", power_law, ([1, 2, 3], [1, 2]), {}),
        ("initial", growth_rate, (TIME[1:], area[1:]), {}),
        ("time", growth_rate, (TIME, area), {"first": 1e5}),
        ("initial", growth_rate, (TIME, area), {"initial": 0.0}),
        ("stderr", growth_rate, (TIME, area), {"stderr": np.zeros(TIME.size)}),
        ("name", growth_rate(TIME, area).interval, ("q",), {}),
        *(("samples", jackknife, (np.mean, runs), {}) for runs in (3.0, (np.ones(3), np.ones(4)), ())),
    ]
    each_refuses(
        *((name, partial(call, *given, **options)) for name, call, given, options in calls),
        got=(
            "0 ... 2 | -2.0 | 2 | 1 | 2 | none | 0 | 0.0 | 0.0 | 'q' | shapes () | shapes (3,) and (4,) | "
            "shapes none"
        ),
    )


@pytest.mark.parametrize("area", [228.0, 0.1])
def test_an_area_that_stays_has_no_growth_at_all(area):
    rate = growth_rate([0.0, 0.001, 0.0018, 0.01, 3.0], np.full(5, area))
    assert (rate.B, rate.B_stderr, rate.relative, rate.middle, rate.straight) == (0, 0, 0, area, None)
