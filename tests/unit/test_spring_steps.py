"""Steps in corrections on the lattice of springs, against steps of whole fields, and their parts."""

import numpy as np
import pytest

import asperity as asp
from asperity.aging.field_steps import FieldSteps
from asperity.aging.spring_steps import SpringSteps
from asperity.aging.tr_bdf2 import Aim, extrapolation
from asperity.contact import ActiveSet, Multigrid, Separation
from asperity.contact.multigrid.loops import Sites, rows
from asperity.contact.multigrid.processor import Processor
from asperity.contact.multigrid.two_fields import _relaxed
from asperity.contact.problem import TOLERANCE
from tests.surfaces import correlated, uncorrelated

SHAPES = [(16, 24), (17, 9), (8, 31), (25, 16)]


def packed(field, mirrored=False):
    """A field as multigrid has it, with images."""
    parted = Processor().packed(field)
    for row in parted:
        rows.wrap(row, Sites(len(field), len(field[0]), mirrored))
    return parted


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("mirrored", [False, True])
def test_rows_come_back_in_order(shape, mirrored):
    field = np.random.default_rng(0).normal(size=shape).astype(np.float32)
    parted = packed(field, mirrored)
    np.testing.assert_array_equal(Processor().unpacked(parted, Sites(shape[0], shape[1], mirrored)), field)
    first, end = (0, -1) if mirrored else (-1, 0)
    np.testing.assert_array_equal(parted[:, 1, 0], field[:, first])  # the column before the first
    last = (shape[1] - 1) % 2
    np.testing.assert_array_equal(parted[:, 1 - last, -1], field[:, end])  # and the one after the last


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
    quick = SpringSteps.begin(system, Multigrid(), contact)
    scale = contact.u.std()
    for duration in (0.1, 0.5, 3.0):
        aim = Aim((TOLERANCE, TOLERANCE), (1e-9 * scale, 1e-9 * scale))
        errors = [steps.attempt(duration, aim).error for steps in (quick, exact)]
        # Contacts hold what is left of errors where they are in the first, and on average in the other.
        assert errors[0] == pytest.approx(errors[1], rel=0.25, abs=1e-6 * scale)
        for steps in (quick, exact):
            steps.accept(exact.time + duration if steps is quick else quick.time)
        fields = exact.point.u, contact.lattice.backward(exact.point.stretch)
        for here, there in zip(quick.state()[:2], fields, strict=True):
            np.testing.assert_allclose(here, there, atol=5e-5 * scale)  # changes are single precision
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


@pytest.mark.parametrize(("part", "growth"), [(1.0, -2.7), (0.27, 0.5), (1.2, -0.99)])
def test_part_of_a_correction_removes_an_error_of_one_kind(part, growth):
    before = np.random.default_rng(0).normal(size=(5, 7)).astype(np.float32)
    taken = _relaxed(part, before, np.float32(growth) * before)
    assert 1.0 - taken * (1.0 - growth) / part == pytest.approx(0.0, abs=1e-5)


def test_cycles_solve_every_step_where_the_creeping_springs_are_stiff():
    # From one contact on; without parts of corrections 22 of these steps are left to Fourier modes.
    heights = np.random.default_rng(0).exponential(size=(12, 12))
    contact = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=800.0), load=28.8)
    steps = SpringSteps.begin(contact.system(None), Multigrid(), contact)
    allowed, left, time, duration = 1e-4 * heights.std(), 0, 0.0, 1e-4
    while time < 100.0:
        left += steps.attempt(duration, Aim((TOLERANCE, TOLERANCE), (allowed, allowed))).failure is not None
        time += duration
        steps.accept(time)
        duration = 0.15 * time
    assert left == 0
