"""What is called a 95 % band holds the truth in about 95 of 100 cases; see `benchmarks`."""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import binom

from tests import CASES

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def coverage(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("coverage_of_bands")


def areas(found):
    """Bands of areas and resistances, of all in a prediction."""
    return {name: part for name, part in found.items() if "contact_area" in name or "resistance" in name}


BANDS: dict[str, tuple[Callable[[Any], Any], int, int]] = {
    "a held load": (lambda of: areas(of.predicted("held", 64, CASES, tables=10)), CASES, 6),
    "a dropped load": (
        lambda of: areas(of.predicted("dropped", 64, CASES // 3, tables=10)),
        CASES // 3,
        6,
    ),
    "laws": (lambda of: of.tabulated(64, CASES), CASES, 20),
    "steady sliding": (lambda of: of.slid(64, CASES), CASES, 12),
    "parameters of a ball": (lambda of: dict(enumerate(of.ball(CASES))), CASES, 3),
}
"""What holds the truth, among how many cases, and how many bands there are."""


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("what", BANDS)
def test_bands_hold_the_mean_of_all_surfaces_and_intervals_the_parameters(coverage, what):
    found_by, cases, count = BANDS[what]
    found = found_by(coverage)
    least, most = np.asarray(binom.ppf([0.001, 0.999], cases, 0.95)) / cases
    assert len(found) == count
    for name, part in found.items():
        cautious = what == "laws" and "approach" in name
        assert least <= part <= (1 if cautious else most), name
