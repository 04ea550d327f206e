"""The implicit integrator against the paper's own explicit algorithm."""

import numpy as np
import pytest

from asperity import press
from asperity.aging import creep
from asperity.solids import spring_lattice
from tests.history_reference import explicit_history
from tests.reference import settle_under_load
from tests.surfaces import uncorrelated

TIMES = [0.5, 2.0]


@pytest.mark.slow
@pytest.mark.parametrize(("k1", "R_viscous"), [(3.0, 0.0), (2.0, 0.3)])
def test_explicit_steps_converge_to_the_implicit_result_at_first_order(k1, R_viscous):
    rough = uncorrelated(32)
    load = 0.05 * rough.size
    spring = {"k0": 1.0, "k1": k1}
    contact = press(rough, spring_lattice(**spring, R=1.0, R_viscous=R_viscous), load=load)
    implicit = [frame.contact for frame in creep(contact, TIMES, rtol=1e-5)][1:]
    coarse, fine = (
        explicit_history(rough, lambda _: load, None, TIMES, dt, **spring, R=1.0, R_viscous=R_viscous)
        for dt in (0.02, 0.01)
    )
    for state, (_, far), (u, near) in zip(implicit, coarse, fine, strict=True):
        # Only the shape is compared: at constant load the mean of u0 follows from it.
        error_coarse = np.sqrt(np.mean((far - state.u0) ** 2))
        error_fine = np.sqrt(np.mean((near - state.u0) ** 2))
        assert 1.8 < error_coarse / error_fine < 2.2
        # Richardson: what is left when the first-order term is removed.
        left = np.sqrt(np.mean((2 * near - far - state.u0) ** 2))
        assert left < 0.05 * error_fine
        # Sites whose gap exceeds the explicit error agree one by one.
        clear = np.abs(u - rough) > 5 * error_fine
        assert not state.in_contact[clear].any()
        assert abs(int(np.sum(u == rough)) - state.area) <= 1


def test_instantaneous_contact_agrees_with_gauss_seidel():
    rough = uncorrelated(32)
    for load in (5.0, 100.0, 2000.0):
        contact = press(rough, spring_lattice(k0=1.0, k1=3.0), load=load)
        flat = np.full(rough.shape, rough.max())
        u, u0 = settle_under_load(flat, flat, rough, load, k0=1.0, k1=3.0)
        np.testing.assert_array_equal(u == rough, contact.in_contact)
        np.testing.assert_allclose(u, contact.u, atol=1e-9)
        np.testing.assert_allclose(u0, contact.u0, atol=1e-9)
