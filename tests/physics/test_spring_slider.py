"""Rate-and-state fits to slip that changes smoothly: a slider on a spring, integrated here; exact forms."""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import asperity as asp

F = asp.friction
LAW = {
    law: F.RateAndState(law=law, a=0.006, b=0.012, D_c=1.0, mu_0=0.6, V_0=1.0) for law in ("aging", "slip")
}
NOISE, ROWS = 4e-4, 120


def evolution(law, V, log_state):
    """Derivative of ln theta in time, as the law is printed."""
    x = V * np.exp(log_state)  # D_c = 1
    return (1 - x) / np.exp(log_state) if law == "aging" else -V * np.log(x)


@cache
def pulled(stiffness, law="aging"):
    """Record of a slider on a spring of this stiffness over (b - a)/D_c, pulled at 1, 10, 1, 10, 1.

    Each leg is 8 D_c long. mu = mu_0 + a ln V + b ln theta and d mu/dt = k (V_pulled - V) give d ln V/dt.
    The slip is part of the integration, so that nothing is interpolated.
    """
    is_law, time, state = LAW[law], np.zeros(1), np.zeros((3, 1))  # ln V, ln theta, slip
    k = stiffness * (is_law.b - is_law.a)
    for pull in (1.0, 10.0, 1.0, 10.0, 1.0):

        def rate(_, y, pull=pull):
            V, aging = np.exp(y[0]), evolution(law, np.exp(y[0]), y[1])
            return [(k * (pull - V) - is_law.b * aging) / is_law.a, aging, V]

        stops = 8.0 / pull * np.arange(1, ROWS + 1) / ROWS
        found = solve_ivp(
            rate, (0.0, stops[-1]), state[:, -1], t_eval=stops, method="Radau", rtol=1e-9, atol=1e-11
        )
        time, state = np.append(time, time[-1] + stops), np.hstack([state, found.y])
    friction = is_law.mu_0 + is_law.a * state[0] + is_law.b * state[1]
    return F.Record.of_displacement(time, state[2], friction, si=False)


@pytest.mark.parametrize(("law", "most"), [("aging", 0.005), ("slip", 0.01)])
@pytest.mark.parametrize("stiffness", [3.0, 300.0])
def test_the_parameters_of_a_soft_machine_are_those_of_the_law(stiffness, law, most):
    fit = F.rate_and_state(pulled(stiffness, law), law=law)
    for name in ("a", "b", "D_c"):
        assert getattr(fit, name) == pytest.approx(getattr(LAW[law], name), rel=most)


@pytest.mark.parametrize("law", ["aging", "slip"])
def test_friction_where_the_logarithm_of_velocity_is_linear_in_slip_is_exact(law):
    """V = exp(0.3 x); the first and the last interval, which have one neighbor, are left out."""
    slip = np.linspace(0.0, 12.0, 41)
    time = (1 - np.exp(-0.3 * slip)) / 0.3
    velocity = np.append(1.0, np.diff(slip) / np.diff(time))
    state = LAW[law].state(time, velocity, start=0.2)
    found = solve_ivp(
        lambda x, y: evolution(law, np.exp(0.3 * x), y) / np.exp(0.3 * x),
        (slip[4], slip[-2]),
        np.log(state[[4]]),
        t_eval=slip[4:-1],
        rtol=1e-11,
        atol=1e-12,
    )
    np.testing.assert_allclose(np.log(state[4:-1]), found.y[0], rtol=0, atol=1e-9)
    friction = LAW[law].friction(time, velocity, start=0.2)[4:-1]
    np.testing.assert_allclose(friction, 0.6 + 0.006 * 0.3 * slip[4:-1] + 0.012 * found.y[0], atol=1e-11)


def test_a_jump_between_rows_is_not_fitted():
    """The velocity at the end of that interval is not its mean: the row is followed, but not fitted."""
    truth = LAW["aging"]
    fine = np.linspace(0.0, 8.0, 801)
    time = np.concatenate([fine, 8.0 + fine[1:] / 10, 8.8 + fine[1:]])
    velocity = np.repeat([1.0, 10.0, 1.0], [801, 800, 800])
    friction, slip = truth.friction(time, velocity), np.cumsum(velocity * np.diff(time, prepend=0.0))
    kept = np.unique(np.append(np.r_[5:2401:10], 2400))  # rows of 0.1 D_c; jumps lie half-way
    fit = F.rate_and_state(F.Record.of_displacement(time[kept], slip[kept], friction[kept]))
    assert np.flatnonzero(~fit.used).size == 2
    for name in ("a", "b", "D_c"):
        assert getattr(fit, name) == pytest.approx(getattr(truth, name), rel=5e-3)
