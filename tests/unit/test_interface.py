"""The interface: which forces it allows, and how far forces break that."""

import math

import numpy as np
import pytest

from asperity.contact.interface import RIGID, Interface

FORCE = np.array([2.0, 1.0, -0.5, 0.0])
TOUCHING = np.array([True, True, True, False])


@pytest.mark.parametrize(
    ("interface", "worst"),
    [(RIGID, 0.5), (Interface(low=-0.2), 0.3), (Interface(low=-1.0), 0.0), (Interface(high=1.2), 0.8)],
)
def test_forces_beyond_a_bound_are_violations(interface, worst):
    assert interface.violation(FORCE, TOUCHING) == pytest.approx(worst / (2.5 / 3))


def test_where_it_yields_the_force_is_the_upper_bound():
    force, yielding = np.array([1.0, 0.9, 0.0]), np.array([True, True, False])
    assert Interface(high=1.0).violation(force, yielding, yielding) == pytest.approx(0.1 / 0.95)


def test_forces_are_brought_within_the_bounds():
    np.testing.assert_array_equal(Interface(-0.2, 1.5).allowed(FORCE, TOUCHING), [1.5, 1.0, -0.2, 0.0])


def test_sites_that_are_not_what_force_and_gap_say():
    gap = np.array([0.0, 0.0, 0.0, -1.0])
    none = np.zeros(4, dtype=bool)
    np.testing.assert_array_equal(RIGID.wrong(FORCE, gap, TOUCHING, none), [False, False, True, True])
    np.testing.assert_array_equal(
        Interface(-1.0, 1.5).wrong(FORCE, gap, TOUCHING, none), [True, False, False, True]
    )
    rising = np.array([-1.0, 1.0, -1.0, 1.0])
    np.testing.assert_array_equal(RIGID.wrong(FORCE, rising, none, TOUCHING), [False, True, False, False])
    assert not RIGID.yields
    assert Interface(high=math.pi).yields
