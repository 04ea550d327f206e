"""Prony series: creep, effective loads and dynamic moduli against integrals of the relaxation modulus."""

import math
from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from asperity.relaxation import PronySeries, arrhenius, check_branches, combined, from_retardation, wlf
from tests.refusals import refuses


def series(count: int, permanent: float, decades: float = 8.0) -> PronySeries:
    rng = np.random.default_rng(count)
    shares = rng.dirichlet(np.ones(count)) * (1 - permanent)
    times = 10 ** rng.uniform(-decades / 2, decades / 2, count)
    return PronySeries(3.5, tuple(zip(shares.tolist(), times.tolist(), strict=True)))


def compliance_by_talbot(solid: PronySeries, time: float, nodes: int = 22) -> float:
    """J(t) from its Laplace transform 1/(s^2 G(s)), by J. Abate and P. P. Valko's fixed Talbot contour."""
    shares, times = np.array(solid.branches).T
    angle = np.arange(1, nodes) * math.pi / nodes
    r = 2 * nodes / (5 * time)
    s = r * angle * (1 / np.tan(angle) + 1j)
    sigma = angle + (angle / np.tan(angle) - 1) / np.tan(angle)

    def transform(s):
        x = s[:, None] * times
        return 1 / (s * solid.modulus * (solid.permanent + (shares * x / (1 + x)).sum(-1)))

    ends = 0.5 * math.exp(r * time) * transform(np.array([r]))[0]
    return float(r / nodes * (ends + np.sum(np.exp(time * s) * transform(s) * (1 + 1j * sigma))).real)


@pytest.mark.parametrize("permanent", [0.0, 1e-6, 0.3])
@pytest.mark.parametrize("count", [1, 3, 70])
def test_creep_is_the_inverse_of_relaxation(count: int, permanent: float) -> None:
    solid = series(count, permanent)
    times = np.geomspace(1e-6, 1e6, 25)
    expected = [compliance_by_talbot(solid, time) for time in times]
    np.testing.assert_allclose(solid.compliance_at(times), expected, rtol=1e-7)
    assert solid.compliance_at(0.0) == 1 / 3.5
    if permanent:
        end = solid.compliance_at(1e300 if permanent > 1e-3 else 1e20)
        assert end == pytest.approx(1 / (3.5 * permanent), rel=1e-9)


def test_times_of_any_size() -> None:
    solid = PronySeries(1.0, ((0.5, 1e-100), (0.5, 1e100)))
    np.testing.assert_allclose(solid.compliance_at([0.0, 1e-80, 1.0]), [1.0, 2.0, 2.0])
    assert solid.compliance_at(1e200) == pytest.approx(2e100)
    np.testing.assert_allclose(solid.modulus_at([0.0, 1.0, 1e200]), [1.0, 0.5, 0.0])
    np.testing.assert_allclose(solid.loss([1e-100, 1.0, 1e100]), [0.25, 0.0, 0.25], atol=1e-99)
    dense = PronySeries(1.0, tuple((1 / 300, 10**x) for x in np.linspace(-20, 20, 300)))
    t = np.geomspace(1e-15, 1e15, 13)
    np.testing.assert_allclose(
        dense.compliance_at(t), [compliance_by_talbot(dense, time) for time in t], rtol=1e-7
    )


@pytest.mark.parametrize("permanent", [0.0, 0.4])
@pytest.mark.parametrize("count", [1, 2, 40])
def test_from_relaxation_to_creep_and_back(count: int, permanent: float) -> None:
    solid = series(count, permanent)
    strengths, times, fluidity = solid.retardation
    assert (fluidity == 0) == (permanent > 0)
    assert len(times) == (count if permanent else count - 1)
    relaxation_times = [time for _, time in solid.branches]
    merged = np.sort(np.concatenate([times, relaxation_times]))  # they alternate
    assert set(merged[::2]) == set(relaxation_times)
    pairs = np.column_stack([strengths / 3.5, times])
    back = from_retardation(1 / 3.5, pairs, fluidity / 3.5)
    np.testing.assert_allclose(np.array(back.branches), np.array(solid.branches), rtol=1e-9)
    assert back.permanent == pytest.approx(permanent, abs=1e-12)


def test_equal_times_are_one_branch_and_no_branches_an_elastic_solid() -> None:
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
def test_effective_load_is_the_integral_of_the_compliance(permanent: float) -> None:
    """By quadrature: jumps of the load times J, and slopes times the integral of J over each piece."""
    solid = series(3, permanent, decades=2.0)
    times, loads = np.array([0.0, 1.0, 3.0, 3.0, 4.0]), np.array([1.0, 2.0, 2.0, 2.6, 3.5])
    effective = solid.effective_load(times, loads)
    for end, found in zip(times[[1, 2, 4]], effective[[1, 2, 4]], strict=True):

        def answer(s: float, end: float = end) -> float:
            return solid.modulus * float(solid.compliance_at(end - s))

        expected = answer(0.0) + (0.6 * answer(3.0) if end > 3 else 0.0)
        for i in (0, 1, 3):
            if times[i + 1] <= end:
                slope = (loads[i + 1] - loads[i]) / (times[i + 1] - times[i])
                expected += slope * quad(answer, times[i], times[i + 1], epsrel=1e-11)[0]
        assert found == pytest.approx(expected, rel=1e-9)


def test_effective_load_does_not_depend_on_how_the_history_is_cut() -> None:
    solid = series(12, 1e-3, decades=10.0)
    coarse = solid.effective_load([0.0, 10.0], [0.0, 5.0])
    fine_times = np.concatenate([[0.0], np.geomspace(1e-12, 10.0, 3000)])
    fine = solid.effective_load(fine_times, fine_times / 2)
    assert fine[-1] == pytest.approx(coarse[-1], rel=1e-12)
    maxwell = PronySeries(2.0, ((1.0, 4.0),))  # a fluid: E = F + integral F/tau
    assert maxwell.effective_load([0.0, 2.0], [0.0, 6.0])[-1] == pytest.approx(6 + 6 / 4, rel=1e-14)


def test_dynamic_moduli_are_the_transform_of_relaxation() -> None:
    solid = PronySeries(2.0, ((0.3, 0.2), (0.5, 3.0)))
    for omega in (0.1, 1.0, 8.0):
        end = 2.0 * solid.permanent

        def transient(t: float, end: float = end) -> float:
            return float(solid.modulus_at(t)) - end

        storage = end + omega * quad(transient, 0, 80, weight="sin", wvar=omega, epsabs=1e-12, limit=400)[0]
        loss = omega * quad(transient, 0, 80, weight="cos", wvar=omega, epsabs=1e-12, limit=400)[0]
        assert solid.storage(omega) == pytest.approx(storage, rel=1e-8)
        assert solid.loss(omega) == pytest.approx(loss, rel=1e-8)
    assert solid.storage(0.0) == pytest.approx(0.4)
    assert solid.loss(0.0) == 0
    assert solid.storage(1e90) == pytest.approx(2.0)


def test_two_bodies_add_their_compliances() -> None:
    one, other = series(5, 0.2), PronySeries(0.7, ((0.4, 2.0), (0.6, 30.0)), span=(1e-3, 1e3), error=0.02)
    both = combined(one, other)
    t = np.geomspace(1e-5, 1e5, 21)
    np.testing.assert_allclose(
        both.compliance_at(t), one.compliance_at(t) + other.compliance_at(t), rtol=1e-11
    )
    assert both.permanent == 0
    assert (both.span, both.error) == ((1e-3, 1e3), 0.02)


def test_shifted_times() -> None:
    solid = PronySeries(2.0, ((0.4, 2.0), (0.6, 30.0)), span=(1.0, 10.0))
    warm = solid.shifted(0.1)
    np.testing.assert_allclose(warm.modulus_at([0.1, 1.0]), solid.modulus_at([1.0, 10.0]), rtol=1e-14)
    assert warm.span == (0.1, 1.0)


def test_branches_are_sorted_and_nothing_is_merged() -> None:
    assert check_branches([(0.2, 3), (0.3, 1.0), (0.1, 3.0)]) == ((0.3, 1.0), (0.2, 3.0), (0.1, 3.0))
    assert check_branches(np.array([[0.5, 2.0]])) == ((0.5, 2.0),)
    assert check_branches(iter([])) == ()
    tenths = PronySeries(1.0, check_branches([(0.1, 10.0**k) for k in range(10)]))
    assert tenths.permanent == 0  # in spite of rounding
    assert PronySeries(1.0, ((0.7, 1.0), (0.2, 2.0))).permanent == pytest.approx(0.1)


def test_wrong_numbers_are_refused_in_one_line() -> None:
    solid = series(3, 0.2)
    branches: list[tuple[str, Any]] = [
        ("branches", [(0.6, 1.0), (0.5, 2.0)]),
        ("share of branch 1", [(-0.1, 1.0)]),
        ("share of branch 2", [(0.1, 1.0), (0.0, 1.0)]),
        ("relaxation time of branch 1", [(0.1, 0.0)]),
        ("relaxation time of branch 1", [(0.1, math.inf)]),
        ("branch 1", [(0.1, 1.0, 2.0)]),
        ("branch 1", [0.1, 1.0]),
        ("branches", "0.1"),
        ("branches", np.array([0.1, 1.0])),
        ("branches", None),
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
        ("temperature", lambda: arrhenius(80e3, 5, 300)),
        ("temperature", lambda: wlf(17.44, 51.6, 321.0, 373.0)),
        ("temperature", lambda: wlf(17.44, 51.6, 322.0, 373.0)),
    ]
    for name, call in calls:
        with refuses(name):
            call()


def test_shift_factors() -> None:
    # Lowering 1/T by R ln(10)/Q speeds relaxation up tenfold.
    reference = 300.0
    warmer = 1 / (1 / reference - 8.31446261815324 * math.log(10) / 80e3)
    assert arrhenius(80e3, warmer, reference) == pytest.approx(0.1)
    assert arrhenius(80e3, 300, 300) == 1
    assert math.log10(wlf(17.44, 51.6, 400.0, 373.0)) == pytest.approx(-17.44 * 27 / 78.6)
    assert wlf(17.44, 51.6, 373.0, 373.0) == 1
