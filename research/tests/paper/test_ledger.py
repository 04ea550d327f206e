"""Verdicts follow from numbers and ranges, never from anything else."""

import math

import numpy as np
import pytest
from scipy.special import ndtr

from asperity.fits.resampling import Estimate
from asperity_research.paper.claims.measures import crossing, exponent, growth_slope
from asperity_research.studies.ledger import Finding, Measurement, Verdict, exact
from asperity_research.studies.numbers import mean_of, within


def estimate(value, half, runs=4):
    return Estimate(value=value, stderr=half / 2, low=value - half, high=value + half, runs=runs)


def measurement(value, half, low=0.9, high=1.1, runs=4):
    return Measurement("a number", estimate(value, half, runs), low, high)


@pytest.mark.parametrize(
    ("value", "half", "verdict"),
    [
        (1.0, 0.05, Verdict.AGREES),
        (1.0, 0.2, Verdict.UNDECIDED),
        (1.2, 0.05, Verdict.DIFFERS),
        (0.8, 0.05, Verdict.DIFFERS),
        (1.1, 0.01, Verdict.UNDECIDED),
        (1.0, math.nan, Verdict.UNDECIDED),
    ],
)
def test_interval_decides(value, half, verdict):
    assert measurement(value, half).verdict is verdict


def test_ranges_with_one_side_and_numbers_without_an_interval():
    assert Measurement("more than 2", estimate(5.0, 1.0), low=2.0).verdict is Verdict.AGREES
    assert Measurement("at most 2", estimate(5.0, 1.0), high=2.0).verdict is Verdict.DIFFERS
    assert Measurement("none", exact(0.0), 0, 0).verdict is Verdict.AGREES
    assert Measurement("none", exact(1.0), 0, 0).verdict is Verdict.DIFFERS


AGREES, DIFFERS, OPEN = measurement(1.0, 0.05), measurement(2.0, 0.05), measurement(1.0, 0.5)


def finding(measured, corrected=()):
    return Finding("key", "Section 1", "a claim", tuple(measured), tuple(corrected), "so")


@pytest.mark.parametrize(
    ("measured", "corrected", "verdict"),
    [
        ([AGREES], [], Verdict.AGREES),
        ([AGREES, OPEN], [], Verdict.UNDECIDED),
        ([AGREES, OPEN, DIFFERS], [], Verdict.DIFFERS),
        ([DIFFERS], [AGREES], Verdict.CORRECTED),
        ([DIFFERS], [DIFFERS], Verdict.DIFFERS),
        ([DIFFERS], [OPEN, DIFFERS], Verdict.DIFFERS),
        ([DIFFERS, AGREES], [AGREES, OPEN], Verdict.UNDECIDED),
        ([AGREES], [DIFFERS], Verdict.AGREES),
        ([OPEN], [AGREES], Verdict.UNDECIDED),
    ],
)
def test_one_number_that_differs_decides_and_a_correction_counts_only_then(measured, corrected, verdict):
    assert finding(measured, corrected).verdict is verdict


def test_undecided_claims_say_what_it_would_take():
    # The interval is twice as wide as the way to the nearer end: four times the seeds.
    assert finding([measurement(1.0, 0.2, runs=5)]).needs == "about 20 seeds in place of 5"
    assert "end of its range" in finding([measurement(1.1001, 0.2)]).needs
    assert finding([measurement(1.0, math.nan, runs=1)]).needs == "more than one seed"
    assert finding([measurement(1.0, 0.2, runs=1)]).needs == "a narrower interval"
    assert finding([AGREES]).needs == ""
    corrected = finding([DIFFERS, AGREES], [AGREES, measurement(1.0, 0.5, low=0.75, high=1.25)])
    assert corrected.waits_for_correction
    assert corrected.needs == "about 16 seeds in place of 4"
    assert not finding([OPEN], [AGREES]).waits_for_correction


def test_measures_on_known_curves():
    x = np.geomspace(1, 1e4, 9)
    assert exponent(x, 3 * x**0.7) == pytest.approx(0.7, abs=1e-13)
    load = np.array([0.1, 1.0, 3.0, 9.0])
    fraction = ndtr(0.5 * load - 1)
    assert crossing(load, fraction, 0.5) == pytest.approx(2.0)
    assert math.isnan(crossing(load, fraction, 1e-3))
    time = np.append(0.0, x)
    area = np.append(10.0, 10 + 10 * 0.3 * np.log(x))
    assert growth_slope(time, area, 1.0, 100.0) == pytest.approx(0.3, abs=1e-13)
    assert within(x, 1.0, 100.0).sum() == 5


def test_intervals_cover_the_truth():
    # Exponents of noisy power laws: 95 % intervals of ensembles of 5 should hold the true one about as often.
    rng = np.random.default_rng(0)
    x = np.geomspace(1, 100, 6)
    inside = 0
    for _ in range(400):
        samples = x**0.8 * (1 + 0.1 * rng.standard_normal((5, 6)))
        here = mean_of(lambda mean: exponent(x, mean), samples)
        inside += int(here.low <= 0.8 <= here.high)
    assert 0.91 <= inside / 400 <= 0.98
