"""Fits of measured data: order, repeats, weights, friction after Dieterich, and which law they prefer."""

import math
from collections import Counter

import numpy as np
import pytest

from asperity.fits import compare, growth_rate, logarithm, saturation
from tests.refusals import refuses

HOLD = np.repeat(np.geomspace(0.1, 1e5, 13), 3)
PER_DECADE = 0.01
"""Growth of static friction in a decade of hold time, as J. H. Dieterich found for rock: J. Geophys. Res. 77,
3690 (1972), doi:10.1029/JB077i020p03690."""
SLOPE = PER_DECADE / math.log(10)


def friction(seed: int, time: np.ndarray = HOLD) -> np.ndarray:
    noise = np.random.default_rng(seed).normal(size=time.size)
    return np.asarray(0.6 + SLOPE * np.log1p(time) + 0.003 * noise)


def test_intervals_cover_the_truth_of_noisy_friction() -> None:
    truth = {"C": SLOPE / 0.6, "t0": 1.0, "initial_area": 0.6, "slope": SLOPE}
    late = np.log(np.unique(HOLD[HOLD >= 30]))
    true_line = np.polyfit(late, SLOPE * np.log1p(np.exp(late)), 1)[0]
    hits: Counter[str] = Counter()
    for seed in range(100):
        mu = friction(seed)
        fit = logarithm(HOLD, mu)
        for name, value in truth.items():
            low, high = fit.interval(name)
            hits[name] += low <= value <= high
        rate = growth_rate(HOLD, mu, first=30, initial=0.6)
        low, high = rate.interval("slope")
        hits["line"] += low <= true_line <= high
    # 95 % expected, with a standard deviation of 2.2 %: a band of three.
    assert {name: 0.885 <= count / 100 <= 1.0 for name, count in hits.items()} == dict.fromkeys(hits, True)
    assert len(hits) == 5


def test_intervals_with_standard_errors_given_cover_too() -> None:
    stderr = np.where(HOLD < 10, 0.001, 0.006)
    hits = 0
    for seed in range(100):
        mu = 0.6 + SLOPE * np.log1p(HOLD) + stderr * np.random.default_rng(seed).normal(size=HOLD.size)
        fit = logarithm(HOLD, mu, stderr)
        low, high = fit.interval("slope")
        hits += low <= SLOPE <= high
        # Three parameters: C, t0 and A(0).
        chi_squared = np.sum(((mu - fit(HOLD)) / stderr) ** 2)
        assert fit.reduced_chi_squared == pytest.approx(chi_squared / (HOLD.size - 3))
    # 95 expected with a standard deviation of 2.
    assert 90 <= hits <= 99


@pytest.mark.parametrize("law", [logarithm, saturation])
def test_the_order_of_the_rows_means_nothing(law: type) -> None:
    mu, order = friction(0), np.random.default_rng(1).permutation(HOLD.size)
    one, other = law(HOLD, mu), law(HOLD[order], mu[order])
    assert pytest.approx(one.slope, rel=1e-6) == other.slope
    assert other.rms_residual == pytest.approx(one.rms_residual, rel=1e-9)


def test_repeating_a_row_is_halving_its_variance() -> None:
    time = np.unique(HOLD)
    mu, stderr = friction(2, time), np.full(time.size, 0.003)
    twice = logarithm(np.repeat(time, 2), np.repeat(mu, 2), np.repeat(stderr, 2))
    halved = logarithm(time, mu, stderr / math.sqrt(2))
    assert twice.slope == pytest.approx(halved.slope, rel=1e-6)
    assert twice.slope_stderr == pytest.approx(halved.slope_stderr, rel=1e-5)
    assert halved.degrees_of_freedom == math.inf


def test_several_values_at_time_zero_are_measurements() -> None:
    time = np.concatenate([np.zeros(3), HOLD])
    mu = np.concatenate([[0.598, 0.600, 0.604], friction(3)])
    fit = logarithm(time, mu)
    assert fit.points == time.size
    assert 0 < fit.initial_area_stderr < 0.002
    assert fit.initial_area != pytest.approx(mu[:3].mean(), abs=1e-9)
    # One is A(0) itself; unless its standard error says that it is a measurement.
    assert logarithm(time[2:], mu[2:]).initial_area == 0.604
    weighted = logarithm(time[2:], mu[2:], np.full(time.size - 2, 0.003))
    assert weighted.initial_area_stderr > 0


def test_noise_that_ends_low_is_no_decline() -> None:
    mu = friction(4)
    mu[-1] = 0.59
    assert mu[-1] < mu[0]
    assert logarithm(HOLD, mu).slope > 0
    with refuses("area"):
        logarithm(HOLD[::3], 1 / (1 + HOLD[::3]))


def test_many_values_go_the_same_way() -> None:
    time = np.repeat(np.append(0.0, np.geomspace(1e-2, 1e4, 40)), 80)
    rng = np.random.default_rng(5)
    area = 3 - 2 * (1 + time / 10) ** -0.3 + 0.01 * rng.normal(size=time.size)
    fit = saturation(time, area)
    assert fit.points == 3280
    for name, value in (("a", 3.0), ("q", 0.3), ("t0", 10.0), ("initial_area", 1.0)):
        assert abs(getattr(fit, name) - value) < 4 * getattr(fit, f"{name}_stderr")
    # The minimum is that of all points, not of means over bins: the means at each time have the same one.
    mean, sigma = area.reshape(-1, 80).mean(axis=1), np.full(41, 0.01 / math.sqrt(80))
    assert fit.q == pytest.approx(saturation(time[::80], mean, sigma).q, rel=1e-4)


TIME = np.append(0.0, np.geomspace(1e-2, 1e6, 40))


def verdicts(model: np.ndarray, spread: float, seeds: int = 12) -> Counter[str]:
    rng = np.random.default_rng(6)
    found: Counter[str] = Counter()
    for _ in range(seeds):
        area = model + spread * rng.normal(size=TIME.size) * (TIME > 0)
        found[compare(TIME, area).verdict] += 1
    return found


def test_the_law_that_made_the_data_is_preferred() -> None:
    logs = verdicts(1 + 0.2 * np.log1p(TIME / 5), 0.02)
    assert logs["logarithm"] >= 10
    assert logs["saturation"] <= 1
    assert verdicts(3 - 2 * (1 + TIME / 10) ** -0.3, 0.02) == {"saturation": 12}
    # A tenth of a decade's growth in noise: nothing can be told of either.
    short = np.geomspace(1, 20, 12)
    few = compare(short, 0.6 + 0.004 * np.log1p(short) + 0.003 * np.random.default_rng(7).normal(size=12))
    assert few.verdict == "undecided"


def test_exact_data_are_decided() -> None:
    logs = compare(TIME, 1 + 0.2 * np.log1p(TIME / 5))
    assert logs.verdict == "logarithm"
    # The price of the parameter: 2 k + 2 k (k + 1)/(n - k - 1), n = 40, k = 3 or 4 with the variance.
    assert logs.delta_aicc == pytest.approx((6 + 24 / 36) - (8 + 40 / 35), rel=1e-9)
    power = compare(TIME, 3 - 2 * (1 + TIME / 10) ** -0.3)
    assert power.verdict == "saturation"
    assert power.relative_likelihood < 1e-50


def test_correlated_errors_count_less() -> None:
    rng = np.random.default_rng(8)
    time = np.append(0.0, np.geomspace(1e-2, 1e6, 400))
    white = rng.normal(size=400)
    red = np.empty(400)
    red[0] = white[0]
    for i in range(1, 400):
        red[i] = 0.9 * red[i - 1] + math.sqrt(1 - 0.9**2) * white[i]
    model = 1 + 0.2 * np.log1p(time / 5)
    independent = compare(time, model + 0.02 * np.append(0, white))
    correlated = compare(time, model + 0.02 * np.append(0, red))
    assert independent.effective_points > 350
    assert correlated.autocorrelation == pytest.approx(0.9, abs=0.06)
    rho = correlated.autocorrelation
    assert correlated.effective_points == pytest.approx(400 * (1 - rho) / (1 + rho))
    assert correlated.verdict != "saturation"


def test_comparison_with_standard_errors_is_that_of_chi_squared() -> None:
    mu, stderr = friction(9), np.full(HOLD.size, 0.003)
    found = compare(HOLD, mu, stderr)
    chi = [float(np.sum(((mu - fit(HOLD)) / stderr) ** 2)) for fit in (found.logarithm, found.saturation)]
    n = HOLD.size
    price = (6 + 24 / (n - 4)) - (8 + 40 / (n - 5))
    assert found.delta_aicc == pytest.approx(chi[0] - chi[1] + price, abs=1e-6)
    assert found.relative_likelihood == pytest.approx(math.exp(-abs(found.delta_effective) / 2))


def test_too_few_to_compare() -> None:
    time = np.geomspace(1, 1e3, 6)
    with refuses("time"):
        compare(time, 1 + 0.1 * np.log1p(time))
