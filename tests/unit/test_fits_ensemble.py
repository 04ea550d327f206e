"""The jackknife and ensembles: closed forms, slow ways to the same number, coverage."""

import math

import numpy as np
import pytest
from scipy.stats import sem, t

from asperity.fits import ensemble, growth_rate, jackknife, logarithm, power_law, saturation
from tests.refusals import refuses

RUNS = np.random.default_rng(0).normal(5.0, 1.0, size=(12, 3))


def test_the_jackknife_of_a_mean_is_its_standard_error() -> None:
    found = jackknife(lambda sample: sample.mean(axis=0), RUNS)
    np.testing.assert_allclose(found.value, RUNS.mean(axis=0))
    np.testing.assert_allclose(found.stderr, sem(RUNS, axis=0))
    low, high = t.interval(0.95, 11, loc=RUNS.mean(axis=0), scale=sem(RUNS, axis=0))
    np.testing.assert_allclose(found.low, low)
    np.testing.assert_allclose(found.high, high)
    assert found.runs == 12


def test_a_ratio_of_means_of_two_samples() -> None:
    x, y = RUNS[:, 0], RUNS[:, 1]
    found = jackknife(lambda x, y: y.mean() / x.mean(), (x, y))
    # Leading order: the residuals y - r x over the mean of x.
    ratio = y.mean() / x.mean()
    assert float(found.value) == pytest.approx(ratio)
    assert float(found.stderr) == pytest.approx(sem(y - ratio * x) / x.mean(), rel=0.05)


def test_the_interval_covers() -> None:
    rng = np.random.default_rng(3)
    hits = 0
    for _ in range(1000):
        found = jackknife(lambda sample: np.log(sample.mean()), rng.normal(10, 1, size=5))
        hits += bool(found.low <= math.log(10) <= found.high)
    # 950 expected with a standard deviation of 7: a band of three.
    assert 929 <= hits <= 971


def test_one_run_has_no_error() -> None:
    found = jackknife(np.mean, RUNS[:1])
    assert float(found.value) == pytest.approx(RUNS[0].mean())
    assert np.isnan([found.stderr, found.low, found.high]).all()


@pytest.mark.parametrize("samples", [np.empty((0, 3)), 3.0, (np.ones(3), np.ones(4)), ()])
def test_samples_without_runs_are_refused(samples: np.ndarray) -> None:
    with refuses("samples"):
        jackknife(np.mean, samples)


TIME = np.append(0.0, np.geomspace(0.1, 1e4, 15))


def runs(count: int, seed: int) -> np.ndarray:
    """Curves of a logarithm that differ as a whole, as those of surfaces do."""
    rng = np.random.default_rng(seed)
    initial, slope = rng.normal(100, 5, size=(count, 1)), rng.normal(20, 2, size=(count, 1))
    return np.asarray(initial + slope * np.log1p(TIME / 2))


def test_an_ensemble_is_the_fit_of_the_mean_with_the_scatter_of_the_runs() -> None:
    areas = runs(6, seed=1)
    found = ensemble(logarithm, TIME, areas)
    assert found.mean == logarithm(TIME, areas.mean(axis=0))
    assert set(found.parameters) == {"C", "t0", "initial_area", "slope"}
    assert found.runs == 6
    # The mean curve is a logarithm again, with the mean slope: its error is that of a mean.
    slopes = (areas[:, -1] - areas[:, 0]) / np.log1p(TIME[-1] / 2)
    slope = found.parameters["slope"]
    assert float(slope.value) == pytest.approx(slopes.mean(), rel=1e-6)
    assert float(slope.stderr) == pytest.approx(sem(slopes), rel=1e-5)
    # The curve itself is exact: the errors of a single fit know nothing of the scatter.
    assert found.mean.slope_stderr < 1e-6 * float(slope.stderr)
    assert float(found.parameters["initial_area"].stderr) == pytest.approx(sem(areas[:, 0]), rel=1e-6)


def test_the_interval_of_an_ensemble_covers() -> None:
    hits = [0, 0]
    for seed in range(200):
        found = ensemble(lambda t, A: growth_rate(t, A, first=100), TIME, runs(8, seed))
        B, slope = found.parameters["B"], found.parameters["slope"]
        late = np.log(TIME[TIME >= 100])
        truth = 20 * np.polyfit(late, np.log1p(np.exp(late) / 2), 1)[0]
        hits[0] += bool(slope.low <= truth <= slope.high)
        hits[1] += bool(B.low <= truth / 100 <= B.high)
    # 190 expected with a standard deviation of 3: a band of three.
    assert all(181 <= hit <= 199 for hit in hits)


def test_any_fit_serves() -> None:
    areas = runs(3, seed=2)
    power = ensemble(power_law, TIME[1:], areas[:, 1:])
    assert set(power.parameters) == {"exponent", "prefactor"}
    assert {"a", "q"} < set(ensemble(saturation, TIME, areas).parameters)
    single = ensemble(logarithm, TIME, areas[:1])
    assert np.isnan(float(single.parameters["C"].stderr))
    with refuses("fit"):
        ensemble(lambda _, A: jackknife(np.mean, A), TIME, areas)
    with refuses("areas"):
        ensemble(logarithm, TIME, areas[0])
