"""Order of convergence, the meaning of rtol, and the accuracy of contact counts."""

import numpy as np
import pytest
import scipy.linalg

from asperity import press
from asperity.aging import creep
from asperity.aging.field_steps import FieldSteps
from asperity.aging.march import DEFAULT_RTOL
from asperity.aging.spring_steps import SpringSteps
from asperity.aging.tr_bdf2 import Aim
from asperity.contact import ActiveSet, Load, Multigrid
from asperity.contact.problem import TOLERANCE
from asperity.contact.state import control_of
from asperity.solids import spring_lattice
from tests.independent import laplacian
from tests.surfaces import correlated, uncorrelated


def deviation(frames, reference):
    """Largest error of u0 over the frames, relative to the largest deformation until then."""
    deformation = np.maximum.accumulate([frame.contact.u.std() for frame in reference])
    return max(
        np.sqrt(np.mean((frame.contact.u0 - exact.contact.u0) ** 2)) / scale
        for frame, exact, scale in zip(frames, reference, deformation, strict=True)
    )


def exactly(contact, control, end):
    """U0 at a time, by the exponential of a dense matrix, while the set of contacts stays what it is.

    Off contact k0 L u + k1 (u - u0) = 0, in contact u is the height: u - u0 is affine in u0, and so is its
    rate k1 (R L + R_viscous) (u - u0). Under load control the mean of u0 is whatever carries the load.
    """
    n, touching = contact.heights.size, contact.in_contact.ravel()
    k0, k1, R, R_viscous = (contact.solid.parameters[name] for name in ("k0", "k1", "R", "R_viscous"))
    unit = np.eye(n).reshape(n, *contact.heights.shape)
    laplacian_of = np.array([laplacian(wave).ravel() for wave in unit])
    # Unknown: u everywhere, and the mean of u0. Columns: u0 without its mean, and what is constant.
    system, given = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    system[:n, :n] = np.where(touching[:, None], np.eye(n), k1 * np.eye(n) - k0 * laplacian_of)
    system[:n, n] = np.where(touching, 0.0, -k1)
    given[:n, :n] = np.where(touching, 0.0, k1) * np.eye(n)
    given[:n, n] = np.where(touching, contact.heights.ravel(), 0.0)
    load_held = isinstance(control, Load)
    if load_held:
        system[n], given[n, n] = np.append(np.full(n, k1), -n * k1), control.value
    else:
        system[n, n], given[n, n] = 1.0, 0.0
    solved = np.linalg.solve(system, given)
    stretch = solved[:n] - solved[n]
    stretch[:, :n] -= np.eye(n)
    rate = np.zeros((n + 1, n + 1))
    rate[:n] = k1 * (R_viscous * stretch - R * laplacian_of @ stretch)
    if load_held:
        rate[:n] -= rate[:n].mean(axis=0)
    u0 = contact.u0.ravel() - (contact.u0.mean() if load_held else 0.0)
    return (scipy.linalg.expm(end * rate) @ np.append(u0, 1.0))[:n]


def end_of_steps(steps, contact, control, end, count):
    """U0 after a number of equal steps of one kind."""
    system = contact.system(control)
    solver = Multigrid() if steps is SpringSteps else ActiveSet()
    state = steps.begin(system, solver, contact)
    for number in range(1, count + 1):
        attempt = state.attempt(end / count, Aim((TOLERANCE, TOLERANCE), (1e-8, 1e-8)))
        assert attempt.failure is None
        state.accept(end * number / count)
    u, (stretch,), *_ = state.state()
    return (u - stretch).ravel() + system.datum


@pytest.mark.parametrize("end", [0.1, 10.0])
@pytest.mark.parametrize(("hold", "R_viscous"), [("load", 0.0), ("load", 0.1), ("separation", 0.1)])
@pytest.mark.parametrize("steps", [SpringSteps, FieldSteps])
def test_equal_steps_converge_at_second_order(steps, hold, R_viscous, end):
    # Few spikes of nearly one height: all touch all the time, so that no event spoils the order.
    rng = np.random.default_rng(0)
    rough = np.full((16, 16), -5.0)
    rough.flat[rng.choice(rough.size, 12, replace=False)] = rng.uniform(0.0, 0.1, 12)
    contact = press(rough, spring_lattice(k0=1.0, k1=3.0, R_viscous=R_viscous), load=20.0)
    control = control_of(contact, hold)
    assert contact.area == 12
    exact = exactly(contact, control, end)
    errors = []
    for count in (8, 16, 32):  # with more, what single precision rounds off begins to show
        u0 = end_of_steps(steps, contact, control, end, count)
        errors.append(np.linalg.norm(u0 - (u0.mean() if hold == "load" else 0.0) - exact))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.1)


def test_l_stability_kills_stiff_modes_in_one_step():
    rough = 0.01 * uncorrelated(16)
    contact = press(rough, spring_lattice(k0=1.0, k1=1.0), load=10.0 * rough.size)
    system = contact.system()
    steps = FieldSteps.begin(system, ActiveSet(), contact)
    steps.attempt(1e9, Aim((TOLERANCE, TOLERANCE), (0.0, 0.0)))
    stretches = [system.mechanics.lattice.backward(steps.tried[end].stretch) for end in (0, -1)]
    before, after = (np.abs(stretch - stretch.mean()).max() for stretch in stretches)
    assert after < 1e-6 * before


@pytest.mark.parametrize(
    ("rough", "k1", "p", "R_viscous", "hold"),
    [
        (uncorrelated(32), 3.0, 0.02, 0.0, "load"),
        (uncorrelated(32), 1.0, 1e-3, 0.0, "load"),
        (uncorrelated(32), 100.0, 0.02, 0.0, "load"),
        pytest.param(uncorrelated(96), 1000.0, 10.0, 0.0, "load", marks=pytest.mark.slow),
        pytest.param(correlated(48), 300.0, 3.0, 0.0, "load", marks=pytest.mark.slow),
        (uncorrelated(32), 3.0, 0.1, 1.0, "load"),
        pytest.param(uncorrelated(32), 3.0, 0.2, 0.1, "separation", marks=pytest.mark.slow),
        (correlated(32), 0.1, 0.05, 0.0, "load"),
        (correlated(32), 3.0, 0.2, 0.0, "separation"),
    ],
)
def test_rtol_bounds_the_error(rough, k1, p, R_viscous, hold):
    contact = press(rough, spring_lattice(k0=1.0, k1=k1, R_viscous=R_viscous), load=p * rough.size)
    times = np.geomspace(1e-3, 1e6, 10)
    control = control_of(contact, hold)
    reference = list(creep(contact, times, control=control, rtol=2e-5))
    for rtol in (1e-2, 2e-3, 2e-4):
        achieved = deviation(
            list(creep(contact, times, control=control_of(contact, hold), rtol=rtol)), reference
        )
        assert achieved < rtol
        assert achieved > rtol / 100  # the tolerance is used, not merely respected


def test_times_are_reached_exactly():
    contact = press(uncorrelated(16), spring_lattice(k0=1.0, k1=3.0), load=10.0)
    times = [0.1, 0.1 + 1e-13, 0.3, 7.0]
    assert [frame.time for frame in creep(contact, times)] == [0.0, *times]


@pytest.mark.parametrize(
    ("rough", "k1", "p"),
    [
        (uncorrelated(200), 3.0, 0.02),
        (uncorrelated(200), 10.0, 0.1),
        pytest.param(correlated(200), 10.0, 0.02, marks=pytest.mark.slow),  # cycles fail: 20 s
    ],
)
def test_contact_counts_at_a_tenth_of_the_tolerance(rough, k1, p):
    contact = press(rough, spring_lattice(k0=1.0, k1=k1), load=p * rough.size)
    times = np.geomspace(1e-3, 1e6, 37)
    usual = np.array([frame.contact.area for frame in creep(contact, times)])
    strict = np.array([frame.contact.area for frame in creep(contact, times, rtol=DEFAULT_RTOL / 10)])
    assert np.abs(usual / strict - 1).max() <= 0.003  # as docs/design.md has it
