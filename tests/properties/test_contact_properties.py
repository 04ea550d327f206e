"""Any surface, any solid, any load: the conditions of contact hold."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from asperity import press, relax
from asperity.aging import creep
from asperity.contact.contact import control_of
from asperity.solids import spring_lattice
from tests.independent import assert_equilibrium

pytestmark = pytest.mark.random

shapes = st.one_of(st.tuples(st.integers(1, 12)), st.tuples(st.integers(1, 7), st.integers(1, 7)))
# Few distinct values: plateaus, ties and flat surfaces are where sets of contacts are ambiguous.
stepped = shapes.flatmap(lambda shape: hnp.arrays(float, shape, elements=st.integers(-3, 3).map(float)))
smooth = shapes.flatmap(lambda shape: hnp.arrays(float, shape, elements=st.floats(-1, 1, width=16)))
surfaces = st.one_of(stepped, smooth)
stiffness = st.floats(-2, 2).map(lambda exponent: 10.0**exponent)
loads = st.floats(-3, 2).map(lambda exponent: 10.0**exponent)
modest = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])


@modest
@given(surfaces, stiffness, st.floats(-5, 5, width=32))
def test_pressed_at_a_separation(rough, k1, separation):
    contact = press(rough, spring_lattice(k0=1.0, k1=k1), separation=separation)
    assert_equilibrium(contact, k0=1.0, k1=k1, load_may_vanish=contact.area == 0)
    assert contact.area > 0 or separation >= rough.max() - 1e-12


@modest
@given(surfaces, stiffness, loads, st.sampled_from([0.0, 0.3]), st.sampled_from(["load", "separation"]))
def test_pressed_under_load_aged_and_relaxed(rough, k1, p, R_viscous, hold):
    load = p * rough.size
    contact = press(rough, spring_lattice(k0=1.0, k1=k1, R_viscous=R_viscous), load=load)
    for end in (contact, relax(contact)):
        assert_equilibrium(end, k0=1.0, k1=k1, load=load)
    held = contact.load if hold == "load" else None
    for frame in creep(contact, [1e-2, 1.0, 1e2], control=control_of(contact, hold), rtol=1e-2):
        assert_equilibrium(frame.contact, k0=1.0, k1=k1, load=held, load_may_vanish=True)
