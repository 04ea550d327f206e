"""Order of convergence, the meaning of rtol, and the accuracy of contact counts."""

import numpy as np
import pytest

from asperity.aging import creep
from asperity.aging.march import DEFAULT_RTOL
from asperity.aging.tr_bdf2 import Point, take_step
from asperity.contact import ActiveSet, press
from asperity.contact.problem import TOLERANCE
from asperity.solids import spring_lattice
from tests.surfaces import correlated, uncorrelated


def deviation(frames, reference):
    """Largest error of u0 over the frames, relative to the largest deformation until then."""
    deformation = np.maximum.accumulate([frame.contact.u.std() for frame in reference])
    return max(
        np.sqrt(np.mean((frame.contact.u0 - exact.contact.u0) ** 2)) / scale
        for frame, exact, scale in zip(frames, reference, deformation, strict=True)
    )


def test_equal_steps_converge_at_second_order():
    # Full contact, where the equations are linear: no contact events spoil the order.
    rough = 0.01 * uncorrelated(16)
    contact = press(rough, spring_lattice(k0=1.0, k1=1.0), load=10.0 * rough.size)
    assert contact.area == rough.size
    system = contact.system
    lattice = system.lattice
    surface = lattice.forward(contact.u - system.datum)
    shape = lattice.forward(contact.u0 - system.datum)
    end = 1.0
    decay = np.exp(-end * system.spectra.mobility * system.spectra.creeping)
    exact = surface + decay * (shape - surface)
    exact.flat[0] = shape.flat[0]
    errors = []
    for steps in (8, 16, 32):
        point = Point.of(system, contact)
        for _ in range(steps):
            point = take_step(
                system, ActiveSet(), end / steps, point, None, tolerances=(TOLERANCE, TOLERANCE)
            ).end
        errors.append(np.linalg.norm(lattice.forward(point.shape) - exact))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.8).all()
    assert (orders < 2.2).all()


def test_l_stability_kills_stiff_modes_in_one_step():
    rough = 0.01 * uncorrelated(16)
    contact = press(rough, spring_lattice(k0=1.0, k1=1.0), load=10.0 * rough.size)
    system = contact.system
    point = Point.of(system, contact)
    end = take_step(system, ActiveSet(), 1e9, point, None, tolerances=(TOLERANCE, TOLERANCE)).end
    before, after = (np.abs(moment.stretch - moment.stretch.mean()).max() for moment in (point, end))
    assert after < 1e-6 * before


@pytest.mark.parametrize(
    ("rough", "k1", "p", "R_viscous", "hold"),
    [
        (uncorrelated(32), 3.0, 0.02, 0.0, "load"),
        (uncorrelated(32), 1.0, 1e-3, 0.0, "load"),
        (uncorrelated(32), 100.0, 0.02, 0.0, "load"),
        (uncorrelated(32), 3.0, 0.1, 1.0, "load"),
        (uncorrelated(32), 3.0, 0.2, 0.1, "separation"),
        (correlated(32), 0.1, 0.05, 0.0, "load"),
        (correlated(32), 3.0, 0.2, 0.0, "separation"),
    ],
)
def test_rtol_bounds_the_error(rough, k1, p, R_viscous, hold):
    contact = press(rough, spring_lattice(k0=1.0, k1=k1, R_viscous=R_viscous), load=p * rough.size)
    times = np.geomspace(1e-3, 1e6, 10)
    reference = list(creep(contact, times, hold=hold, rtol=2e-5))
    for rtol in (1e-2, 2e-3, 2e-4):
        achieved = deviation(list(creep(contact, times, hold=hold, rtol=rtol)), reference)
        assert achieved < rtol
        assert achieved > rtol / 100  # the tolerance is used, not merely respected


def test_times_are_reached_exactly():
    contact = press(uncorrelated(16), spring_lattice(k0=1.0, k1=3.0), load=10.0)
    times = [0.1, 0.1 + 1e-13, 0.3, 7.0]
    assert [frame.time for frame in creep(contact, times)] == [0.0, *times]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rough", "k1", "p"),
    [(uncorrelated(200), 3.0, 0.02), (uncorrelated(200), 10.0, 0.1), (correlated(200), 10.0, 0.02)],
)
def test_contact_counts_at_a_tenth_of_the_tolerance(rough, k1, p):
    contact = press(rough, spring_lattice(k0=1.0, k1=k1), load=p * rough.size)
    times = np.geomspace(1e-3, 1e6, 37)
    usual = np.array([frame.contact.area for frame in creep(contact, times)])
    strict = np.array([frame.contact.area for frame in creep(contact, times, rtol=DEFAULT_RTOL / 10)])
    assert np.abs(usual / strict - 1).max() <= 0.005
