"""Fits of A(t): exact data, noise with known spread, measurements, and which law the data prefer."""

import math
from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import least_squares
from scipy.signal import lfilter
from scipy.stats import t

from asperity.fits import SaturationFit, compare, logarithm, saturation
from tests.refusals import each_refuses, refuses

TIME = np.concatenate([[0.0], np.logspace(-2, 6, 60)])
HOLD = np.repeat(np.geomspace(0.1, 1e5, 13), 3)
PER_DECADE = 0.01
"""Growth of static friction in a decade of hold time, as J. H. Dieterich found for rock: J. Geophys. Res. 77,
3690 (1972), doi:10.1029/JB077i020p03690."""
SLOPE = PER_DECADE / math.log(10)


def saturating(time, a, q, t0):
    return a - (a - 1) / (1 + time / t0) ** q


def noisy(seed=1):
    area = saturating(TIME, 3.0, 0.3, 10.0) * (1 + 1e-3 * np.random.default_rng(seed).normal(size=TIME.size))
    area[0] = 1.0
    return area


def friction(seed):
    return 0.6 + SLOPE * np.log1p(HOLD) + 0.003 * np.random.default_rng(seed).normal(size=HOLD.size)


@pytest.mark.parametrize(
    ("a", "q", "t0", "first"), [(1.5, 1.0, 100.0, 0), (40.0, 0.02, 0.1, 1), (2.0, 5.0, 1e4, 1)]
)
def test_saturation_recovers_exact_parameters_and_keeps_a_known_limit(a, q, t0, first):
    time = TIME[first:]
    fit = saturation(time, 7 * saturating(time, a, q, t0))
    assert (fit.a, fit.q, fit.t0) == pytest.approx((a, q, t0), rel=1e-8)
    assert pytest.approx((a - 1) * q, rel=1e-8) == fit.C
    assert fit.initial_area == pytest.approx(7, rel=1e-10)
    assert fit.rms_residual < 1e-12
    assert fit.r_squared == pytest.approx(1, abs=1e-12)
    limited = saturation(TIME, 7 * saturating(TIME, a, q, t0), limit=7 * a)
    assert (limited.a, limited.q, limited.t0) == pytest.approx((a, q, t0), rel=1e-8)
    assert (limited.a_stderr, limited.degrees_of_freedom) == (0, TIME.size - 3)
    # Another limit: the search of scipy, in t0 and q alone, finds the same.
    other = saturation(TIME, saturating(TIME, a, q, t0), limit=1.1 * a)

    def misfit(logs):
        return saturating(TIME, 1.1 * a, *np.exp(logs)) - saturating(TIME, a, q, t0)

    found = least_squares(misfit, np.log([q, t0]), xtol=1e-14, ftol=1e-14)
    assert (other.q, other.t0) == pytest.approx(np.exp(found.x), rel=1e-5)
    assert other.a == pytest.approx(1.1 * a, rel=1e-14)


@pytest.mark.parametrize(("C", "t0", "first"), [(0.01, 50.0, 0), (4.0, 0.02, 1)])
def test_logarithm_recovers_exact_parameters(C, t0, first):
    fit = logarithm(TIME[first:], 0.02 * (1 + C * np.log1p(TIME[first:] / t0)))
    assert (fit.C, fit.t0, fit.initial_area) == pytest.approx((C, t0, 0.02), rel=1e-8)
    assert fit.rms_residual < 1e-12


KNOWN: dict[str, float] = {"a": 3.0, "q": 0.4, "t0": 10.0, "C": 0.8, "initial_area": 1.0}
CASES: dict[str, tuple[Callable[..., Any], str]] = {
    "saturation": (saturation, "a q t0 C"),
    "saturation and A(0)": (saturation, "a q t0 C initial_area"),
    "saturation below a limit": (partial(saturation, limit=3.0), "q t0"),
    "logarithm": (logarithm, "C t0"),
    "logarithm of errors that are known": (partial(logarithm, stderr=np.full(60, 2e-3)), "C t0 initial_area"),
}


@pytest.mark.parametrize("count", [40, pytest.param(200, marks=pytest.mark.slow)])
@pytest.mark.parametrize("case", CASES)
def test_standard_errors_are_the_spread_of_fits_to_noise(case, count):
    law, said = CASES[case]
    names, rng = said.split(), np.random.default_rng(21)
    time = TIME[1:] if "initial_area" in names else TIME
    model = saturating(time, 3.0, 0.4, 10.0) if "saturation" in case else 1 + 0.8 * np.log1p(time / 10)
    rows = []
    for _ in range(count):
        fit = law(time, model + 2e-3 * rng.normal(size=time.size) * (time > 0))
        rows.append([(getattr(fit, n) - KNOWN[n]) / getattr(fit, f"{n}_stderr") for n in names])
    pull = np.array(rows)
    # The spread has a standard error of 1/sqrt(2 count), the mean one of 1/sqrt(count): three of these.
    assert pull.std(axis=0) == pytest.approx(np.ones(len(names)), abs=3 / math.sqrt(2 * count))
    assert pull.mean(axis=0) == pytest.approx(np.zeros(len(names)), abs=3.1 / math.sqrt(count))
    # 99.7 % are expected within 3.
    assert (np.abs(pull) < 3).mean() > 0.985


@pytest.mark.parametrize("law", [saturation, logarithm])
def test_prediction_residual_and_r_squared_say_the_same(law):
    area = noisy()
    fit = law(TIME, area)
    assert (fit.initial_area, fit.initial_area_stderr, fit.predict(0.0)) == (1.0, 0.0, 1.0)
    after = fit.predict(TIME[1:])
    assert fit.rms_residual == pytest.approx(np.sqrt(np.mean((after / area[1:] - 1) ** 2)), rel=1e-12)
    squares = np.sum((after - area[1:]) ** 2) / np.sum((area[1:] - area[1:].mean()) ** 2)
    assert fit.r_squared == pytest.approx(1 - squares, rel=1e-12)
    reach = t.ppf(0.975, fit.degrees_of_freedom) * np.array([fit.C_stderr, fit.t0_stderr / fit.t0])
    assert fit.interval("C") == pytest.approx((fit.C - reach[0], fit.C + reach[0]))
    assert fit.interval("t0") == pytest.approx(fit.t0 * np.exp([-reach[1], reach[1]]))
    assert np.array_equal(fit(TIME), fit.predict(TIME))
    assert np.array_equal(fit.area_ratio(TIME) * fit.initial_area, fit.predict(TIME))
    if isinstance(fit, SaturationFit):
        assert fit.area_ratio(TIME) == pytest.approx(saturating(TIME, fit.a, fit.q, fit.t0), rel=1e-12)
        assert fit.area_ratio(1e300) == pytest.approx(fit.a, rel=1e-12)
    with refuses("time", "-1.0"):
        fit.predict([1.0, -1.0])


def test_pure_logarithm_leaves_a_open_but_not_C():
    area = 1 + 0.3 * np.log1p(TIME / 2)
    fit = saturation(TIME, area)
    assert (fit.C, fit.t0) == pytest.approx((0.3, 2.0), rel=1e-5)
    assert math.isfinite(fit.a)
    assert fit.a_stderr == math.inf
    assert fit.q < 1e-6
    assert fit.predict(TIME) == pytest.approx(area, rel=1e-6)


@pytest.mark.parametrize("law", [saturation, logarithm])
def test_a_late_piece_of_a_logarithm_does_not_determine_its_beginning(law):
    """Along a valley the squares hardly change: a search for the last digit would creep there."""
    time, noise = np.geomspace(10, 3e3, 36), np.random.default_rng(8).normal(size=36)
    fit = law(time, 1 + 0.004 * np.log1p(time / 4e-3) + 6e-4 * noise)
    assert fit.rms_residual == pytest.approx(6e-4, rel=0.3)
    assert all(math.isfinite(value) for value in (fit.C, fit.t0, fit.initial_area, fit.initial_area_stderr))
    assert fit.t0_stderr > fit.t0


def test_an_array_that_knows_its_time_is_fitted_alone():
    time = np.array([0.0, *np.geomspace(0.1, 100, 12)])
    area = xr.DataArray(50 * (3 - 2 * (1 + time / 2.0) ** -0.3), coords={"time": time}, dims="time")
    for law in (logarithm, saturation, compare):
        assert repr(law(area)) == repr(law(time, area.values))
    each_refuses(
        *(("area", logarithm, wrong) for wrong in (area.time, area.drop_vars("time"), area.values)),
        got="DataArray alone | DataArray alone | ndarray alone",
    )


def test_bad_data_are_named():
    growing, times = np.linspace(1.0, 2.0, 8), np.arange(8)
    wrong: list[tuple[str, Any, Any]] = [
        ("area", times, np.ones(8)),
        ("area", times, growing[::-1]),
        ("area", times, growing[:7]),
        ("area", times, growing - 1),
        ("area", times, np.where(growing > 1.5, np.nan, growing)),
        ("area", times, [1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 1.1]),
        ("time", times - 1, growing),
        ("time", np.zeros(8), growing),
        ("time", np.repeat([1, 2], 4), growing),
        ("time", [], []),
        ("time", times.reshape(2, 4), growing),
        ("time", "late", growing),
        ("time", times[:3], growing[:3]),
        ("time", times[1:4], growing[:3]),
        *(("time", [1.0, cell, 10.0, 100.0], growing[:4]) for cell in (1e-320, 1e120)),
    ]
    each_refuses(
        *((name, saturation, time, area) for name, time, area in wrong),
        got=(
            "1 at every time | 2 | 7 | 0.0 | 4 |  | -1 ... 6 | 1 | 2 | none | shape (2, 4) | 'late' | 2 | "
            "3 | 1e-320 | 1e+120"
        ),
    )
    for time, limit in ((TIME, 0.9), (TIME, math.nan), (TIME[1:], 3.0)):
        with refuses("limit", "areas" if limit == 3.0 else limit):
            saturation(time, saturating(time, 3.0, 0.3, 10.0), limit=limit)
    each_refuses(
        ("time", "6", compare, TIME[1:7], 1 + 0.1 * np.log1p(TIME[1:7])),
        ("area", "0.909091", logarithm, HOLD[::3], 1 / (1 + HOLD[::3])),
    )


def test_noise_that_ends_low_is_no_decline():
    mu = friction(4)
    mu[-1] = 0.59
    assert mu[-1] < mu[0]
    assert logarithm(HOLD, mu).slope > 0


def test_areas_that_grow_at_once_and_stay_have_no_variation_to_explain():
    fit = saturation([0.0, 1.0, 2.0, 4.0, 8.0, 16.0], [3.0, 4.0, 4.0, 4.0, 4.0, 4.0])
    assert np.isnan(fit.r_squared)
    np.testing.assert_allclose(fit.area_ratio(np.array([2.0, 16.0])), 4 / 3, rtol=0.1)


def test_several_values_at_time_zero_are_measurements():
    time = np.concatenate([np.zeros(3), HOLD])
    mu = np.concatenate([[0.598, 0.600, 0.604], friction(3)])
    fit = logarithm(time, mu)
    assert fit.points == time.size
    assert 0 < fit.initial_area_stderr < 0.002
    assert fit.initial_area != pytest.approx(mu[:3].mean(), abs=1e-9)
    # One is A(0) itself; unless its standard error says that it is a measurement.
    assert logarithm(time[2:], mu[2:]).initial_area == 0.604
    assert logarithm(time[2:], mu[2:], np.full(time.size - 2, 0.003)).initial_area_stderr > 0


def test_many_values_go_the_same_way():
    time = np.repeat(np.append(0.0, np.geomspace(1e-2, 1e4, 40)), 80)
    rng = np.random.default_rng(5)
    area = saturating(time, 3.0, 0.3, 10.0) + 0.01 * rng.normal(size=time.size)
    fit = saturation(time, area)
    assert fit.points == 3280
    for name, value in (("a", 3.0), ("q", 0.3), ("t0", 10.0), ("initial_area", 1.0)):
        assert abs(getattr(fit, name) - value) < 4 * getattr(fit, f"{name}_stderr")
    # The minimum is that of all points, not of means over bins: the means at each time have the same one.
    mean, sigma = area.reshape(-1, 80).mean(axis=1), np.full(41, 0.01 / math.sqrt(80))
    assert fit.q == pytest.approx(saturation(time[::80], mean, sigma).q, rel=1e-4)


LATE = np.append(0.0, np.geomspace(1e-2, 1e6, 40))
LOGARITHM, POWER = 1 + 0.2 * np.log1p(LATE / 5), saturating(LATE, 3.0, 0.3, 10.0)


def test_the_law_that_made_the_data_is_preferred():
    rng = np.random.default_rng(6)
    verdicts: Counter[str] = Counter()
    for _ in range(12):
        verdicts[compare(LATE, LOGARITHM + 0.02 * rng.normal(size=LATE.size) * (LATE > 0)).verdict] += 1
        assert compare(LATE, POWER + 0.02 * rng.normal(size=41) * (LATE > 0)).verdict == "saturation"
    assert verdicts["logarithm"] >= 10
    assert verdicts["saturation"] <= 1
    # A tenth of a decade's growth in noise: nothing can be told of either.
    short = np.geomspace(1, 20, 12)
    few = compare(short, 0.6 + 0.004 * np.log1p(short) + 0.003 * np.random.default_rng(7).normal(size=12))
    assert few.verdict == "undecided"


def test_exact_data_are_decided():
    logs = compare(LATE, LOGARITHM)
    assert logs.verdict == "logarithm"
    # The price of the parameter: 2 k + 2 k (k + 1)/(n - k - 1), n = 40, k = 3 or 4 with the variance.
    assert logs.delta_aicc == pytest.approx((6 + 24 / 36) - (8 + 40 / 35), rel=1e-9)
    power = compare(LATE, POWER)
    assert power.verdict == "saturation"
    assert power.relative_likelihood < 1e-50


def test_correlated_errors_count_less():
    rng = np.random.default_rng(8)
    time = np.append(0.0, np.geomspace(1e-2, 1e6, 400))
    white = rng.normal(size=400)
    red = lfilter([math.sqrt(1 - 0.9**2)], [1, -0.9], white)
    model = 1 + 0.2 * np.log1p(time / 5)
    independent = compare(time, model + 0.02 * np.append(0, white))
    correlated = compare(time, model + 0.02 * np.append(0, red))
    assert independent.effective_points > 350
    rho = correlated.autocorrelation
    assert rho == pytest.approx(0.9, abs=0.06)
    assert correlated.effective_points == pytest.approx(400 * (1 - rho) / (1 + rho))
    assert correlated.verdict != "saturation"


def test_comparison_with_standard_errors_is_that_of_chi_squared():
    mu, stderr = friction(9), np.full(HOLD.size, 0.003)
    found = compare(HOLD, mu, stderr)
    chi = [float(np.sum(((mu - fit(HOLD)) / stderr) ** 2)) for fit in (found.logarithm, found.saturation)]
    n = HOLD.size
    price = (6 + 24 / (n - 4)) - (8 + 40 / (n - 5))
    assert found.delta_aicc == pytest.approx(chi[0] - chi[1] + price, abs=1e-6)
    assert found.logarithm.reduced_chi_squared == pytest.approx(chi[0] / (n - 3))  # C, t0 and A(0)
    assert found.relative_likelihood == pytest.approx(math.exp(-abs(found.delta_effective) / 2))
