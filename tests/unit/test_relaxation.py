"""Prony series against integrals of the relaxation modulus, and laws as series of a stated accuracy."""

import itertools
import math
from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import gamma

from asperity.relaxation import (
    PronySeries,
    arrhenius,
    check_branches,
    combined,
    fractional_zener,
    from_retardation,
    power_law,
    wlf,
)
from asperity.relaxation.laws import mittag_leffler
from tests.continua import talbot
from tests.refusals import each_refuses


def series(count, permanent, decades=8.0):
    rng = np.random.default_rng(count)
    shares = rng.dirichlet(np.ones(count)) * (1 - permanent)
    times = 10 ** rng.uniform(-decades / 2, decades / 2, count)
    return PronySeries(3.5, tuple(zip(shares.tolist(), times.tolist(), strict=True)))


def compliance_by_talbot(solid, time):
    """J(t) from its Laplace transform 1/(s^2 G(s))."""
    shares, times = np.array(solid.branches).T

    def transform(s):
        x = s * times
        return 1 / (s * solid.modulus * (solid.permanent + (shares * x / (1 + x)).sum()))

    return talbot(transform, time)


@pytest.mark.parametrize(("count", "permanent"), [(1, 0.3), (3, 0.0), (70, 1e-6)])
def test_creep_is_the_inverse_of_relaxation(count, permanent):
    solid = series(count, permanent)
    times = np.geomspace(1e-6, 1e6, 25)
    expected = [compliance_by_talbot(solid, time) for time in times]
    np.testing.assert_allclose(solid.compliance_at(times), expected, rtol=1e-7)
    assert solid.compliance_at(0.0) == 1 / 3.5
    if permanent:
        end = solid.compliance_at(1e300 if permanent > 1e-3 else 1e20)
        assert end == pytest.approx(1 / (3.5 * permanent), rel=1e-9)


def test_times_of_any_size():
    solid = PronySeries(1.0, ((0.5, 1e-100), (0.5, 1e100)))
    np.testing.assert_allclose(solid.compliance_at([0.0, 1e-80, 1.0]), [1.0, 2.0, 2.0])
    assert solid.compliance_at(1e200) == pytest.approx(2e100)
    np.testing.assert_allclose(solid.modulus_at([0.0, 1.0, 1e200]), [1.0, 0.5, 0.0])
    np.testing.assert_allclose(solid.loss([1e-100, 1.0, 1e100]), [0.25, 0.0, 0.25], atol=1e-99)


@pytest.mark.parametrize(("count", "permanent"), [(1, 0.0), (2, 0.4), (40, 0.0)])
def test_from_relaxation_to_creep_and_back(count, permanent):
    solid = series(count, permanent)
    strengths, times, fluidity = solid.retardation
    assert (fluidity == 0) == (permanent > 0)
    relaxation_times = [time for _, time in solid.branches]
    merged = np.sort(np.concatenate([times, relaxation_times]))  # they alternate
    assert set(merged[::2]) == set(relaxation_times)
    back = from_retardation(1 / 3.5, np.column_stack([strengths / 3.5, times]), fluidity / 3.5)
    np.testing.assert_allclose(np.array(back.branches), np.array(solid.branches), rtol=1e-9)
    assert back.permanent == pytest.approx(permanent, abs=1e-12)


def test_equal_times_are_one_branch_and_no_branches_an_elastic_solid():
    twice = PronySeries(2.0, ((0.1, 1.0), (0.2, 1.0), (0.3, 5.0)))
    once = PronySeries(2.0, ((0.3, 1.0), (0.3, 5.0)))
    t = np.geomspace(0.01, 100, 7)
    np.testing.assert_allclose(twice.compliance_at(t), once.compliance_at(t), rtol=1e-13)
    elastic = PronySeries(2.0)
    np.testing.assert_array_equal(elastic.compliance_at(t), 0.5)
    np.testing.assert_array_equal(elastic.modulus_at(t), 2.0)
    np.testing.assert_array_equal(elastic.effective_load(t, t), t)
    assert from_retardation(0.5, []) == elastic


@pytest.mark.parametrize("permanent", [0.0, 0.3])
def test_effective_load_is_the_integral_of_the_compliance(permanent):
    """By quadrature: jumps of the load times J, and slopes times the integral of J over each piece."""
    solid = series(3, permanent, decades=2.0)
    times, loads = np.array([0.0, 1.0, 3.0, 3.0, 4.0]), np.array([1.0, 2.0, 2.0, 2.6, 3.5])
    effective = solid.effective_load(times, loads)
    for end, found in zip(times[[1, 2, 4]], effective[[1, 2, 4]], strict=True):

        def answer(s, end=end):
            return solid.modulus * float(solid.compliance_at(end - s))

        expected = answer(0.0) + (0.6 * answer(3.0) if end > 3 else 0.0)
        for i in (0, 1, 3):
            if times[i + 1] <= end:
                slope = (loads[i + 1] - loads[i]) / (times[i + 1] - times[i])
                expected += slope * quad(answer, times[i], times[i + 1], epsrel=1e-11)[0]
        assert found == pytest.approx(expected, rel=1e-9)


def test_effective_load_does_not_depend_on_how_the_history_is_cut():
    solid = series(12, 1e-3, decades=10.0)
    coarse = solid.effective_load([0.0, 10.0], [0.0, 5.0])
    fine_times = np.concatenate([[0.0], np.geomspace(1e-12, 10.0, 3000)])
    fine = solid.effective_load(fine_times, fine_times / 2)
    assert fine[-1] == pytest.approx(coarse[-1], rel=1e-12)
    maxwell = PronySeries(2.0, ((1.0, 4.0),))  # a fluid: E = F + integral F/tau
    assert maxwell.effective_load([0.0, 2.0], [0.0, 6.0])[-1] == pytest.approx(6 + 6 / 4, rel=1e-14)


def test_dynamic_moduli_are_the_transform_of_relaxation():
    solid = PronySeries(2.0, ((0.3, 0.2), (0.5, 3.0)))
    end = 2.0 * solid.permanent
    for omega in (0.1, 1.0, 8.0):
        part: dict[str, Any] = {"wvar": omega, "epsabs": 1e-12, "limit": 400}
        storage, loss = (
            omega * quad(lambda t: float(solid.modulus_at(t)) - end, 0, 80, weight=weight, **part)[0]
            for weight in ("sin", "cos")
        )
        assert solid.storage(omega) == pytest.approx(end + storage, rel=1e-8)
        assert solid.loss(omega) == pytest.approx(loss, rel=1e-8)
    assert [solid.storage(0.0), solid.loss(0.0)] == pytest.approx([0.4, 0])
    assert solid.storage(1e90) == pytest.approx(2.0)


def test_two_bodies_add_their_compliances():
    one, other = series(5, 0.2), PronySeries(0.7, ((0.4, 2.0), (0.6, 30.0)), span=(1e-3, 1e3), error=0.02)
    both = combined(one, other)
    t = np.geomspace(1e-5, 1e5, 21)
    np.testing.assert_allclose(
        both.compliance_at(t), one.compliance_at(t) + other.compliance_at(t), rtol=1e-11
    )
    assert both.permanent == 0
    assert (both.span, both.error) == ((1e-3, 1e3), 0.02)


def test_temperature_shifts_all_times():
    solid = PronySeries(2.0, ((0.4, 2.0), (0.6, 30.0)), span=(1.0, 10.0))
    warm = solid.shifted(0.1)
    np.testing.assert_allclose(warm.modulus_at([0.1, 1.0]), solid.modulus_at([1.0, 10.0]), rtol=1e-14)
    assert warm.span == (0.1, 1.0)
    # Lowering 1/T by R ln(10)/Q speeds relaxation up tenfold.
    warmer = 1 / (1 / 300.0 - 8.31446261815324 * math.log(10) / 80e3)
    assert arrhenius(80e3, warmer, 300.0) == pytest.approx(0.1)
    assert math.log10(wlf(17.44, 51.6, 400.0, 373.0)) == pytest.approx(-17.44 * 27 / 78.6)


def test_branches_are_sorted_and_nothing_is_merged():
    assert check_branches([(0.2, 3), (0.3, 1.0), (0.1, 3.0)]) == ((0.3, 1.0), (0.2, 3.0), (0.1, 3.0))
    assert check_branches(np.array([[0.5, 2.0]])) == ((0.5, 2.0),)
    assert check_branches(iter([])) == ()
    tenths = PronySeries(1.0, check_branches([(0.1, 10.0**k) for k in range(10)]))
    assert tenths.permanent == 0  # in spite of rounding


def by_its_spectrum(n, x):
    """E_n(-x^n) as an integral over ln(rate), of exp(-rate x) times the known spectrum."""

    def integrand(y):
        spectrum = math.sin(n * math.pi) / (2 * math.pi * (math.cosh(n * y) + math.cos(n * math.pi)))
        return spectrum * math.exp(-x * math.exp(y))

    top = math.log(700 / x)
    cuts = sorted({-50 / n, -5 / n, -1.0, 0.0, 1.0, top - 3, top})
    parts = itertools.pairwise(cuts)
    return sum(quad(integrand, a, b, epsabs=1e-15, epsrel=1e-12, limit=400)[0] for a, b in parts if b <= top)


@pytest.mark.parametrize("n", [0.1, 0.5, 0.97])
def test_the_mittag_leffler_function(n):
    x = np.array([1e-4, 0.03, 0.5, 1.0, 4.0, 60.0])
    late = 1e30 ** (1 / n)  # E_n(-t^n) = t^-n / Gamma(1 - n) at late times
    assert mittag_leffler(n, np.array(late)) == pytest.approx(1e-30 / gamma(1 - n), rel=1e-10)
    np.testing.assert_allclose(mittag_leffler(n, x), [by_its_spectrum(n, t) for t in x], rtol=1e-9)
    small = np.array([1e-9, 1e-6]) if n > 0.3 else np.array([1e-40, 1e-30])
    power_series = sum((-(small**n)) ** k / gamma(1 + n * k) for k in range(40))
    np.testing.assert_allclose(mittag_leffler(n, small), power_series, rtol=1e-12)
    assert mittag_leffler(n, np.array(0.0)) == pytest.approx(1.0, abs=1e-13)
    t = np.geomspace(1e-8, 3, 20)
    np.testing.assert_allclose(mittag_leffler(1 - 1e-9, t), np.exp(-t), rtol=1e-7)


@pytest.mark.parametrize(
    ("exponent", "accuracy", "most"), [(0.05, 0.05, 16), (0.9, 0.01, 23), (0.05, 1e-4, 40), (0.9, 1e-6, 60)]
)
def test_a_power_law_to_its_accuracy(exponent, accuracy, most):
    first, last = 2e-3, 5e6
    found = power_law(modulus=7.0, exponent=exponent, time=10.0, first=first, last=last, accuracy=accuracy)
    t = np.geomspace(first, last, 2011)
    deviation = np.abs(found.modulus_at(t) / (7.0 * (t / 10.0) ** -exponent) - 1).max()
    assert deviation <= found.error * 1.001
    assert found.error <= accuracy
    assert found.span == (first, last)
    assert len(found.branches) < most


EXPONENTS = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)


@pytest.mark.parametrize("accuracy", [1e-2, 1e-3, 1e-6])
def test_creep_under_a_power_law_and_a_fractional_zener_solid_is_as_accurate(accuracy):
    """1/(s^2 G(s)) is a Mittag-Leffler function for a fractional Zener solid, and a power for a power law."""
    for n in EXPONENTS:
        for first, last in ((1.0, 10.0), (1e-3, 1e7)):
            found = power_law(modulus=7, exponent=n, time=0.5, first=first, last=last, accuracy=accuracy)
            t = np.geomspace(first, last, 60)
            creep = (t / 0.5) ** n / (7 * gamma(1 + n) * gamma(1 - n))
            assert np.abs(found.compliance_at(t) / creep - 1).max() <= accuracy, (n, first)
        for relaxed, first in ((0.0, 1e4), (0.1, 1e-3)) if n in (0.2, 0.5, 0.95) else ():
            found = fractional_zener(
                instantaneous=1, relaxed=relaxed, exponent=n, time=1, first=first, last=1e5, accuracy=accuracy
            )
            t = np.geomspace(first, 1e5, 60)
            creep = 1 + t**n / gamma(1 + n)
            if relaxed:
                creep = 10 - 9 * mittag_leffler(n, relaxed ** (1 / n) * t)
            assert np.abs(found.compliance_at(t) / creep - 1).max() <= accuracy, (n, relaxed, first)


@pytest.mark.parametrize(
    ("exponent", "relaxed", "accuracy"), [(0.2, 0.0, 1e-5), (0.5, 0.02, 0.01), (1.0, 0.0, 0.01)]
)
def test_a_fractional_zener_solid_to_its_accuracy(exponent, relaxed, accuracy):
    first, last = 1e-4, 10.0 if exponent == 1 else 1e5
    moduli = {"instantaneous": 4.0, "relaxed": 4 * relaxed}
    found = fractional_zener(**moduli, exponent=exponent, time=0.5, first=first, last=last, accuracy=accuracy)
    t = np.geomspace(first, last, 40)
    exact = np.array([by_its_spectrum(exponent, x) for x in t / 0.5]) if exponent < 1 else np.exp(-t / 0.5)
    deviation = np.abs(found.modulus_at(t) / (4 * (relaxed + (1 - relaxed) * exact)) - 1).max()
    assert deviation <= found.error * 1.001 + 1e-9
    assert found.error <= accuracy
    assert found.modulus == 4.0
    assert found.modulus_at(0.0) == pytest.approx(4.0, rel=1e-14)
    assert found.permanent == pytest.approx(relaxed, abs=1e-12)
    assert exponent < 1 or len(found.branches) <= 2


def test_wrong_numbers_are_refused_in_one_line():
    solid = series(3, 0.2)
    power = partial(power_law, modulus=2.0, exponent=0.5, time=1.0)
    zener = partial(fractional_zener, instantaneous=2.0, time=1.0, first=0.1)
    branches: list[tuple[str, Any]] = [
        ("branches", [(0.6, 1.0), (0.5, 2.0)]),
        ("share of branch 2", [(0.1, 1.0), (0.0, 1.0)]),
        ("relaxation time of branch 1", [(0.1, math.inf)]),
        ("branch 1", [(0.1, 1.0, 2.0)]),
        ("branch 1", [0.1, 1.0]),
        ("branches", "0.1"),
        ("branches", np.array([0.1, 1.0])),
    ]
    calls: list[tuple[str, Any]] = [
        *((name, partial(check_branches, wrong)) for name, wrong in branches),
        ("modulus", lambda: PronySeries(-1.0)),
        ("times", lambda: solid.effective_load([2.0, 1.0], [1.0, 1.0])),
        ("loads", lambda: solid.effective_load([1.0, 2.0], [1.0])),
        ("time", lambda: solid.compliance_at(-1.0)),
        ("span", lambda: PronySeries(1.0, span=(2.0, 1.0))),
        ("delayed", lambda: from_retardation(1.0, [0.1, 1.0])),  # type: ignore[list-item]
        ("factor", lambda: solid.shifted(0.0)),
        ("temperature", lambda: arrhenius(80e3, -5, 300)),
        ("temperature", lambda: wlf(17.44, 51.6, 321.0, 373.0)),
        ("temperature", lambda: wlf(17.44, 51.6, 322.0, 373.0)),
        ("temperature", lambda: wlf(17.44, 51.6, 373.0 - 51.6 + 1e-13, 373.0)),
        ("temperature", lambda: arrhenius(80e3, 900.0, 20.0)),
        ("exponent", lambda: power(exponent=1.0, first=0.1, last=10.0)),
        ("last", lambda: power(first=10.0, last=1.0)),
        ("last", lambda: power(first=1e-30, last=1e30)),
        ("accuracy", lambda: power(first=0.1, last=10.0, accuracy=1e-9)),
        ("relaxed", lambda: zener(relaxed=5.0, exponent=0.5, last=10.0)),
        ("last", lambda: zener(relaxed=0.0, exponent=1, last=1e4)),
        ("exponent", lambda: zener(relaxed=0.0, exponent=1.5, last=10.0)),
    ]
    each_refuses(
        *calls,
        got=(
            "1.1 together | 0.0 | inf | (0.1, 1.0, 2.0) | 0.1 | '0.1' | shape (2,) | -1.0 | "
            "2.0 before 1.0 | shape (1,) | -1.0 | (2.0, 1.0) | shape (2,) | 0.0 | -5 | 321 K"
            " | above 1e100 (nothing relaxes) at 322 K | above 1e100 (nothing relaxes) at 321.4 K"
            " | below 1e-100 (all has relaxed) at 900 K | 1.0 | "
            "1.0 | 60.0 | 1e-09 | 5.0 | 0 | 1.5"
        ),
    )
