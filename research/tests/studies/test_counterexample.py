"""The smallest contact that loses a site after the load has fallen, in rational arithmetic."""

from fractions import Fraction

import numpy as np
import pytest

import asperity as asp
from research.tests.studies.exact_line import Line

HEIGHTS = [Fraction(k, 9) for k in (1, 3, 4, 5)]
HIGH, LOW = Fraction(12, 5), Fraction(12, 25)
THREE, TWO = (1, 2, 3), (2, 3)


@pytest.fixture
def line():
    return Line(HEIGHTS, 3)


def test_after_an_endless_wait_a_contact_is_lost(line):
    held, u, stretch, _ = line.contact(lambda held: line.relaxed(held, HIGH))
    assert held == THREE
    u0 = [a - b for a, b in zip(u, stretch, strict=True)]
    held, _, _, force = line.contact(lambda held: line.creeping(held, u0, LOW))
    assert held == THREE  # the step itself takes none
    assert force[1] == Fraction(1, 7650)
    held, _, _, force = line.contact(lambda held: line.relaxed(held, LOW))
    assert held == TWO
    assert (force[2], force[3]) == (Fraction(62, 675), Fraction(262, 675))


def test_after_a_wait_of_10_it_is_lost_between_0_170_and_0_172(line):
    flat = [Fraction(0)] * 4
    held, _, _, force = line.contact(lambda held: line.creeping(held, flat, HIGH))
    assert held == THREE
    # The set stays while the load stays: all forces and the gap at the start and later, with the bounds.
    for time in (1, 3, 10):
        u0, error = line.later(THREE, flat, HIGH, time)
        u, _, force = line.creeping(THREE, u0, HIGH)
        assert error < Fraction(1, 10**12)
        assert min(force[i] for i in THREE) > 100 * error
        assert u[0] - HEIGHTS[0] > 100 * error
    held, *_ = line.contact(lambda held: line.creeping(held, u0, LOW))
    assert held == THREE
    forces = {}
    for since in (Fraction(170, 1000), Fraction(172, 1000)):
        after, more = line.later(THREE, u0, LOW, since)
        u, _, force = line.creeping(THREE, after, LOW)
        # A force is at most 8 + 2 k1 times as sensitive as u0 is, and exp(M t) brings at most 2 of an error.
        assert 20 * (2 * error + more) < Fraction(1, 10**10)
        assert u[0] > HEIGHTS[0]
        forces[since] = force[1]
    before, behind = forces.values()
    assert before > Fraction(1, 10**7)
    assert behind < -Fraction(1, 10**7)


def test_the_engine_agrees():
    P = asp.protocols
    heights = np.array([float(x) for x in HEIGHTS])
    solid = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0)
    contact = asp.press(heights, solid, load=float(HIGH))
    legs = [P.Hold(10.0), P.Step(load=float(LOW)), P.Hold(10.0)]
    history = asp.age(contact, [10.0, 10.17, 10.172, 20.0], protocol=legs, rtol=1e-3)
    assert history.dataset["area"].values.tolist() == [3, 3, 3, 3, 2, 2]
