"""Power-law and fractional Zener relaxation as Prony series: the stated accuracy is the true one."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erfcx, gamma

from asperity.relaxation import fractional_zener, power_law
from asperity.relaxation.laws import mittag_leffler
from tests.refusals import refuses


def by_its_spectrum(n: float, x: float) -> float:
    """E_n(-x^n) as an integral over ln(rate), of exp(-rate x) times the known spectrum."""

    def integrand(y: float) -> float:
        spectrum = math.sin(n * math.pi) / (2 * math.pi * (math.cosh(n * y) + math.cos(n * math.pi)))
        return spectrum * math.exp(-x * math.exp(y))

    top = math.log(700 / x)
    cuts = sorted({-50 / n, -5 / n, -1.0, 0.0, 1.0, top - 3, top})
    parts = itertools.pairwise(cuts)
    return sum(quad(integrand, a, b, epsabs=1e-15, epsrel=1e-12, limit=400)[0] for a, b in parts if b <= top)


@pytest.mark.parametrize("n", [0.1, 0.5, 0.97])
def test_the_mittag_leffler_function(n: float) -> None:
    x = np.array([1e-4, 0.03, 0.5, 1.0, 4.0, 60.0])
    np.testing.assert_allclose(mittag_leffler(n, x), [by_its_spectrum(n, t) for t in x], rtol=1e-9)
    small = np.array([1e-9, 1e-6]) if n > 0.3 else np.array([1e-40, 1e-30])
    power_series = sum((-(small**n)) ** k / gamma(1 + n * k) for k in range(40))
    np.testing.assert_allclose(mittag_leffler(n, small), power_series, rtol=1e-12)
    t = np.geomspace(1e-8, 1e10, 41)
    np.testing.assert_allclose(mittag_leffler(0.5, t), erfcx(np.sqrt(t)), rtol=1e-11)
    np.testing.assert_allclose(mittag_leffler(1.0, t), np.exp(-t), rtol=1e-14)
    np.testing.assert_allclose(mittag_leffler(1 - 1e-9, t[:20]), np.exp(-t[:20]), rtol=1e-7)
    assert mittag_leffler(n, np.array(0.0)) == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize("accuracy", [0.05, 0.01, 1e-4, 1e-6])
@pytest.mark.parametrize("exponent", [0.05, 0.9])
def test_a_power_law_to_its_accuracy(exponent: float, accuracy: float) -> None:
    first, last = 2e-3, 5e6
    series = power_law(modulus=7.0, exponent=exponent, time=10.0, first=first, last=last, accuracy=accuracy)
    t = np.geomspace(first, last, 2011)
    deviation = np.abs(series.modulus_at(t) / (7.0 * (t / 10.0) ** -exponent) - 1).max()
    assert deviation <= accuracy
    assert deviation == pytest.approx(series.error, rel=0.05)
    assert series.span == (first, last)
    assert len(series.branches) < {0.05: 16, 0.01: 22, 1e-4: 40, 1e-6: 60}[accuracy]


@pytest.mark.parametrize("accuracy", [0.01, 1e-5])
@pytest.mark.parametrize("relaxed", [0.0, 0.02])
@pytest.mark.parametrize("exponent", [0.2, 0.5, 1.0])
def test_a_fractional_zener_solid_to_its_accuracy(exponent: float, relaxed: float, accuracy: float) -> None:
    first, last = 1e-4, 10.0 if exponent == 1 else 1e5
    series = fractional_zener(
        instantaneous=4.0,
        relaxed=4 * relaxed,
        exponent=exponent,
        time=0.5,
        first=first,
        last=last,
        accuracy=accuracy,
    )
    t = np.geomspace(first, last, 40)
    if exponent == 0.5:
        exact = erfcx(np.sqrt(t / 0.5))
    elif exponent == 1:
        exact = np.exp(-t / 0.5)
    else:
        exact = np.array([by_its_spectrum(exponent, x / 0.5) for x in t])
    deviation = np.abs(series.modulus_at(t) / (4 * (relaxed + (1 - relaxed) * exact)) - 1).max()
    assert deviation <= series.error * 1.001 + 1e-9
    assert series.error <= accuracy
    assert series.modulus == 4.0
    assert series.modulus_at(0.0) == pytest.approx(4.0, rel=1e-14)
    assert series.permanent == pytest.approx(relaxed, abs=1e-12)
    if exponent == 1:
        assert len(series.branches) <= 2 or accuracy < 1e-4


def test_wrong_numbers_are_refused() -> None:
    right = {"exponent": 0.5, "time": 1.0, "first": 0.1, "last": 10.0}
    for name, changed in (
        ("exponent", {"exponent": 1.0}),
        ("modulus", {"modulus": 0.0}),
        ("last", {"first": 10.0, "last": 1.0}),
        ("last", {"first": 1e-30, "last": 1e30}),
        ("accuracy", {"accuracy": 1e-9}),
    ):
        with refuses(name):
            power_law(**({"modulus": 2.0} | right | changed))
    for name, changed in (
        ("relaxed", {"relaxed": 5.0}),
        ("last", {"exponent": 1, "last": 1e4}),
        ("exponent", {"exponent": 1.5}),
    ):
        with refuses(name):
            fractional_zener(**({"instantaneous": 2.0, "relaxed": 0.0} | right | changed))
