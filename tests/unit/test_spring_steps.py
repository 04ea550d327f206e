"""Time steps: their length by errors alone, and those of springs in corrections, against whole fields."""

import math
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.aging import creep
from asperity.aging.controller import TUNING, Controller, step_tolerance
from asperity.aging.field_steps import FieldSteps
from asperity.aging.spring_steps import SpringSteps
from asperity.aging.tr_bdf2 import Aim, extrapolation
from asperity.contact import ActiveSet, Multigrid, Separation
from asperity.contact.problem import TOLERANCE
from tests.surfaces import correlated, uncorrelated


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_extrapolation_continues_polynomials(count):
    places = [3.0, 2.5, 1.8, 1.2][:count]
    weights = extrapolation(places, 3.3)
    for power in range(count):
        assert np.dot(weights, np.power(places, power)) == pytest.approx(3.3**power, rel=1e-12)


CASES = [
    (uncorrelated(32), 3.0, 0.05, 0.0),
    (correlated(32), 0.1, 0.01, 0.2),
    (uncorrelated(32)[:27, :21], 1.0, 0.3, 0.05),
]


@pytest.mark.parametrize(("heights", "k1", "p", "R_viscous"), CASES)
@pytest.mark.parametrize("held", ["load", "separation"])
def test_a_step_agrees_with_one_of_whole_fields(heights, k1, p, R_viscous, held):
    heights = np.ascontiguousarray(heights)
    solid = asp.solids.spring_lattice(k0=1.0, k1=k1, R_viscous=R_viscous)
    contact = asp.press(heights, solid, load=p * heights.size)
    control = contact.control if held == "load" else Separation(contact.separation)
    system = contact.system(control)
    exact = FieldSteps.begin(system, ActiveSet(), contact)
    quick: Any = SpringSteps.begin(system, Multigrid(), contact)
    scale = contact.u.std()
    for duration in (0.1, 0.5, 3.0):
        aim = Aim((TOLERANCE, TOLERANCE), (1e-9 * scale, 1e-9 * scale))
        errors = [steps.attempt(duration, aim).error for steps in (quick, exact)]
        # Contacts hold what is left of errors where they are in the first, and on average in the other.
        assert errors[0] == pytest.approx(errors[1], rel=0.25, abs=1e-6 * scale)
        for steps in (quick, exact):
            steps.accept(exact.time + duration if steps is quick else quick.time)
        (u, w), there = (
            (one.u, contact.lattice.backward(one.stretch)) for one in (quick.instead().point, exact.point)
        )
        np.testing.assert_allclose(u, there[0], atol=5e-5 * scale)  # changes are single precision
        np.testing.assert_allclose(w, there[1], atol=5e-5 * scale)
        np.testing.assert_array_equal(quick.u <= system.heights, exact.point.u <= system.heights)
        extents = [steps.extent() for steps in (quick, exact)]
        for name in ("spread", "stretch", "largest"):
            assert getattr(extents[0], name) == pytest.approx(getattr(extents[1], name), rel=1e-4)


def test_steps_that_cycles_do_not_solve_are_left_to_the_fourier_solver():
    heights = uncorrelated(24)
    contact = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=3.0), load=30.0)
    times = np.geomspace(1e-2, 1e3, 6)
    usual, helped = (asp.age(contact, times, solver=Multigrid(max_cycles=n)) for n in (40, 0))
    np.testing.assert_allclose(helped.final.u0, usual.final.u0, atol=2e-4)
    assert helped.dataset["iterations"].values[1:].min() > 0
    mixed = asp.age(contact, times, solver=Multigrid(max_cycles=1))  # some by either
    np.testing.assert_allclose(mixed.final.u0, usual.final.u0, atol=2e-4)


def test_cycles_solve_every_step_where_the_creeping_springs_are_stiff():
    # From one contact on; without parts of corrections 22 of these steps are left to Fourier modes.
    heights = np.random.default_rng(0).exponential(size=(12, 12))
    contact = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=800.0), load=28.8)
    steps: Any = SpringSteps.begin(contact.system(None), Multigrid(), contact)
    allowed, left, time, duration = 1e-4 * heights.std(), 0, 0.0, 1e-4
    while time < 100.0:
        left += steps.attempt(duration, Aim((TOLERANCE, TOLERANCE), (allowed, allowed))).failure is not None
        time += duration
        steps.accept(time)
        duration = 0.15 * time
    assert left == 0


@pytest.mark.parametrize(
    ("control", "last"), [({"load": 2e4}, 1e6), ({"load": 2e4}, 1e28), ({"separation": -20.0}, 1e18)]
)
def test_springs_that_all_touch_end_up_alike(control, last):
    contact = asp.press(correlated(24, seed=8), asp.solids.spring_lattice(k0=0.0, k1=1.5, R=1.0), **control)
    assert contact.in_contact.all()
    final = asp.age(contact, [1e-3 * last, last]).final
    np.testing.assert_allclose(final.force, contact.force.mean(), rtol=1e-3)
    assert final.load == pytest.approx(contact.load, rel=1e-3)  # creep on no base keeps the mean


@pytest.mark.slow
@pytest.mark.parametrize(
    ("edges", "control", "mobilities"),
    [
        ("reflecting", {"load": 12.0}, (1.0, 0.0)),
        ("periodic", {"load": 12.0}, (0.0, 1.0)),
        ("periodic", {"separation": 1.2}, (1.0, 0.2)),
    ],
)
def test_histories_are_those_of_the_fourier_solver(edges, control, mobilities):
    rough = asp.surfaces.Surface(np.random.default_rng(2).normal(size=(16, 15)), edges=edges)
    solid = asp.solids.spring_lattice(k0=0.0, k1=2.0, R=mobilities[0], R_viscous=mobilities[1])
    contact, times = asp.press(rough, solid, **control), np.geomspace(1e-2, 1e3, 6)
    found, other = (
        list(creep(contact, times, rtol=2e-4, solver=solver)) for solver in (Multigrid(), asp.ActiveSet())
    )
    scale = 0.0
    for one, two in zip(found, other, strict=True):
        assert one.contact.residual < 1e-9
        if two.contact.load > 1e-3 * contact.load:  # less dies out
            assert np.count_nonzero(one.contact.in_contact ^ two.contact.in_contact) <= 2
        scale = max(scale, float(two.contact.u.std()))
        error = one.contact.anchors - two.contact.anchors
        assert (error - error.mean()).std() < 2e-4 * scale
        assert one.contact.load == pytest.approx(two.contact.load, abs=1e-3 * contact.load)


def test_nine_decades_take_few_cycles():
    heights = np.random.default_rng(6).normal(size=(64, 64))
    contact = asp.press(heights, asp.solids.spring_lattice(k0=0.0, k1=3.0), load=0.06 * heights.size)
    history = asp.age(contact, np.geomspace(1e-3, 1e6, 37)).dataset
    assert history["area"].values[-1] == heights.size
    steps = int((history["steps"] + history["rejected"]).sum())
    assert steps < 175  # 148
    assert int(history["iterations"].sum()) < 14 * steps  # 12


@pytest.mark.parametrize(("stops", "longest"), [(1000, math.inf), (1, 0.001)])
def test_stops_and_legs_that_make_steps_short_are_no_sign_of_being_stuck(stops, longest):
    controller, time, taken = Controller(step_tolerance(2e-3), 0.1), 1.0, 0
    for stop in np.linspace(1.0, 2.0, stops + 1)[1:].tolist():
        while time < stop:
            step = controller.step(time, stop, longest)
            assert not controller.is_stuck(time, step)
            assert controller.accepts(step, 0.5)
            time, taken = stop if step == stop - time else time + step, taken + 1
    assert taken >= 1000


def test_it_tells_when_it_is_stuck_and_starts_over_where_it_was():
    controller = Controller(1e-3, 0.5)
    for _ in range(TUNING.most_unsolved + 1):
        assert not controller.is_stuck(1.0, controller.length)
        controller.accepts(controller.length, math.inf)
    assert controller.is_stuck(1.0, controller.length)
    controller.start_over(1.0)
    assert controller.length == 0.5
    assert not controller.is_stuck(1.0, 0.5)
    assert controller.is_stuck(1.0, 1e-17)
