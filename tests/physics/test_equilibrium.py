"""Every published state, judged by an operator that no solver uses."""

import numpy as np
import pytest

from asperity import age, press, relax
from asperity.aging import creep
from asperity.contact.contact import control_of
from asperity.errors import ConvergenceError
from asperity.solids import spring_lattice
from tests.independent import assert_equilibrium
from tests.refusals import refuses
from tests.surfaces import correlated, uncorrelated


@pytest.mark.parametrize("k1", [0.01, 1.0, 100.0])
@pytest.mark.parametrize(("R_viscous", "hold"), [(0.0, "load"), (0.1, "load"), (0.1, "separation")])
def test_every_frame_of_an_aging_contact(k1, hold, R_viscous):
    rough = uncorrelated(48)
    solid = spring_lattice(k0=1.0, k1=k1, R_viscous=R_viscous)
    for p in (1e-5, 1e-3, 0.05, 2.0):
        load = p * rough.size
        contact = press(rough, solid, load=load)
        assert_equilibrium(relax(contact), k0=1.0, k1=k1, load=load)
        again = press(rough, solid, separation=contact.separation)
        assert_equilibrium(again, k0=1.0, k1=k1, load=load)
        for frame in creep(contact, np.geomspace(1e-3, 1e3, 7), control=control_of(contact, hold)):
            held = load if hold == "load" else None
            assert_equilibrium(frame.contact, k0=1.0, k1=k1, load=held)


@pytest.mark.parametrize("shape", [(1,), (2,), (7,), (1, 5), (2, 3), (9, 16)])
def test_lattices_of_any_shape(shape):
    rough = np.random.default_rng(3).normal(size=shape)
    solid = spring_lattice(k0=0.7, k1=2.0)
    load = 0.3 * rough.size
    contact = press(rough, solid, load=load)
    assert_equilibrium(contact, k0=0.7, k1=2.0, load=load)
    final = age(contact, [0.1, 10.0]).final
    assert_equilibrium(final, k0=0.7, k1=2.0, load=load)
    assert_equilibrium(relax(contact), k0=0.7, k1=2.0, load=load)


@pytest.mark.parametrize("load", [1e-3, None])
@pytest.mark.parametrize("creep", [False, True])
def test_the_level_of_the_heights_does_not_matter(load, creep):
    """Fields are kept relative to the highest point: an offset takes no digit but those of the heights."""
    solid, found = spring_lattice(k0=1.0, k1=1.0), []
    raised = uncorrelated(32) + 1e6
    for heights in (raised, raised - raised.max()):
        separation = float(heights.max()) - 0.5 if load is None else None
        contact = press(heights, solid, load=load, separation=separation)
        found.append(age(contact, [1.0]).final if creep else contact)
        assert_equilibrium(found[-1], k0=1.0, k1=1.0, load=load)
    raised, level = found
    assert raised.area == level.area
    assert raised.energy == pytest.approx(level.energy, rel=1e-9)
    np.testing.assert_allclose(raised.u, level.u + raised.datum, atol=2e-10)


def test_a_load_that_a_crept_shape_cannot_resolve_is_refused():
    aged = age(press(uncorrelated(32), spring_lattice(k0=1.0, k1=1.0), load=100.0), [10.0]).final
    with refuses(kind=ConvergenceError):
        press(aged, load=1e-9)


def test_warm_start_changes_the_work_and_not_the_result():
    rough = correlated(128)
    solid = spring_lattice(k0=1.0, k1=0.1)
    nearby = press(rough, solid, load=0.021 * rough.size)
    cold = press(rough, solid, load=0.02 * rough.size)
    warm = press(rough, solid, load=0.02 * rough.size, start=nearby)
    np.testing.assert_array_equal(warm.in_contact, cold.in_contact)
    np.testing.assert_allclose(warm.u, cold.u, atol=1e-8)
    assert warm.iterations < cold.iterations


def test_case_without_random_numbers():
    # Area, energy and mean of u0 were found for these heights by a separate prototype that used
    # constrained conjugate gradients on the forces; 12 digits.
    i, j = np.mgrid[:16, :16]
    rough = ((73 * i + 151 * j + 37 * i**2 + 29 * j**2 + 53 * i * j) % 257) / 257
    contact = press(rough, spring_lattice(k0=1.0, k1=3.0), load=20.0)
    assert contact.area == 38
    assert contact.energy == pytest.approx(1.220493755943, rel=1e-10)
    assert contact.separation == pytest.approx(0.825285282473, rel=1e-11)
