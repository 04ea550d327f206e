"""Verdicts follow from numbers and ranges, never from anything else."""

import math

import numpy as np
import pytest
from scipy.special import ndtr

from asperity.fits.resampling import Estimate
from asperity_research.paper.claims.measures import between, crossing, exponent, growth_slope
from asperity_research.studies.ledger import Finding, Measurement, Verdict, exact, together
from asperity_research.studies.numbers import mean_of


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


def test_range_may_have_one_side():
    assert Measurement("more than 2", estimate(5.0, 1.0), low=2.0).verdict is Verdict.AGREES
    assert Measurement("at most 2", estimate(5.0, 1.0), high=2.0).verdict is Verdict.DIFFERS


def test_exact_numbers_have_no_interval():
    assert Measurement("none", exact(0.0), 0, 0).verdict is Verdict.AGREES
    assert Measurement("none", exact(1.0), 0, 0).verdict is Verdict.DIFFERS


def test_together_one_that_differs_decides():
    agrees, differs, open_ = measurement(1.0, 0.05), measurement(2.0, 0.05), measurement(1.0, 0.5)
    assert together([agrees]) is Verdict.AGREES
    assert together([agrees, open_]) is Verdict.UNDECIDED
    assert together([agrees, open_, differs]) is Verdict.DIFFERS


def finding(measured, corrected=()):
    return Finding("key", "Section 1", "a claim", tuple(measured), tuple(corrected), "so")


def test_a_correction_counts_only_where_the_letter_differs():
    agrees, differs, open_ = measurement(1.0, 0.05), measurement(2.0, 0.05), measurement(1.0, 0.5)
    assert finding([differs], [agrees]).verdict is Verdict.CORRECTED
    assert finding([differs], [differs]).verdict is Verdict.DIFFERS
    assert finding([differs], [open_, differs]).verdict is Verdict.DIFFERS
    assert finding([differs]).verdict is Verdict.DIFFERS
    assert finding([agrees], [differs]).verdict is Verdict.AGREES
    assert finding([open_], [agrees]).verdict is Verdict.UNDECIDED


def test_a_claim_whose_correction_is_undecided_is_undecided():
    agrees, differs = measurement(1.0, 0.05), measurement(2.0, 0.05)
    still_open = finding([differs, agrees], [agrees, measurement(1.0, 0.5, low=0.75, high=1.25)])
    assert still_open.verdict is Verdict.UNDECIDED
    assert still_open.waits_for_correction
    assert still_open.needs == "about 16 seeds in place of 4"
    as_it_stands = finding([measurement(1.0, 0.2)], [agrees])
    assert as_it_stands.verdict is Verdict.UNDECIDED
    assert not as_it_stands.waits_for_correction


def test_undecided_claims_say_what_it_would_take():
    # The interval is twice as wide as the way to the nearer end: four times the seeds.
    assert finding([measurement(1.0, 0.2, runs=5)]).needs == "about 20 seeds in place of 5"
    assert "end of its range" in finding([measurement(1.1001, 0.2)]).needs
    assert finding([measurement(1.0, math.nan, runs=1)]).needs == "more than one seed"
    assert finding([measurement(1.0, 0.05)]).needs == ""


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
    assert between(x, 1.0, 100.0).sum() == 5


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
