"""What is called a 95 % band holds the truth in about 95 of 100 cases; see `benchmarks`."""

import importlib
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom

from tests import CASES

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def coverage(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("coverage_of_bands")


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize(("history", "cases"), [("held", CASES), ("dropped", CASES // 3)])
def test_bands_of_area_and_resistance_hold_the_mean_of_all_surfaces(coverage, history, cases):
    found = coverage.predicted(history, 64, cases, tables=10)
    least, most = np.asarray(binom.ppf([0.001, 0.999], cases, 0.95)) / cases
    names = [name for name in found if "contact_area" in name or "resistance" in name]
    assert len(names) == 6
    for name in names:
        assert least <= found[name] <= most, name


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_bands_of_laws_hold_the_mean_of_all_surfaces(coverage):
    found = coverage.tabulated(64, CASES)
    least, most = np.asarray(binom.ppf([0.001, 0.999], CASES, 0.95)) / CASES
    assert len(found) == 20
    for name, part in found.items():
        assert least <= part <= (1 if "approach" in name else most), name


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_bands_of_steady_sliding_hold_the_mean_of_all_surfaces(coverage):
    found = coverage.slid(64, CASES)
    least, most = np.asarray(binom.ppf([0.001, 0.999], CASES, 0.95)) / CASES
    assert len(found) == 12
    for name, part in found.items():
        assert least <= part <= most, name


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_intervals_of_a_ball_hold_its_parameters(coverage):
    held = coverage.ball(CASES)
    least, most = np.asarray(binom.ppf([0.001, 0.999], CASES, 0.95)) / CASES
    assert np.all((least <= held) & (held <= most))
