"""The paper's own algorithm, slow and obvious: the judge of the implicit integrator.

Explicit Euler steps of Eq. (dosrs) for u0; projected Gauss-Seidel sweeps of Eq. (us) for u; a feedback
loop (regula falsi on the mean of u0) that holds the normal load. No transforms, no active sets.
"""

import numpy as np

from tests.independent import laplacian


def settle(u, u0, heights, *, k0, k1, accuracy=1e-13):
    """Sweep u red and black until no site moves; shape of even lengths."""
    color = np.indices(heights.shape).sum(axis=0) % 2 == 0
    while True:
        before = u.copy()
        for site in (color, ~color):
            neighbors = laplacian(u) + 2 * u.ndim * u
            relaxed = np.maximum(heights, (k0 * neighbors + k1 * u0) / (2 * u.ndim * k0 + k1))
            u = np.where(site, relaxed, u)
        if np.abs(u - before).max() < accuracy:
            return u


def settle_under_load(u, u0, heights, load, *, k0, k1):
    """Shift u0 rigidly until the springs to the bulk carry the load."""

    def excess(shift):
        nonlocal u
        u = settle(u, u0 + shift, heights, k0=k0, k1=k1)
        return np.sum(k1 * (u - u0 - shift)) - load

    step = load / (heights.size * k1)
    here, value = 0.0, excess(0.0)
    there = here + (step if value > 0 else -step)
    for _ in range(100):
        if abs(value) <= 1e-11 * load:
            return u, u0 + here
        other = excess(there)
        slope = (other - value) / (there - here)
        here, value = there, other
        there = here - value / slope
    raise AssertionError("the feedback on the load did not settle")


def explicit_run(heights, load, times, dt, *, k0, k1, R, R_viscous=0.0):
    """Return (u, u0) at each time, all of which are multiples of dt; u0 starts flat."""
    u0 = np.full(heights.shape, heights.max())
    u, u0 = settle_under_load(np.maximum(u0, heights), u0, heights, load, k0=k0, k1=k1)
    states, step = [], 0
    for time in times:
        while step < round(time / dt):
            pull = k1 * (u0 - u)
            u0 = u0 + dt * (R * laplacian(pull) - R_viscous * pull)
            u, u0 = settle_under_load(u, u0, heights, load, k0=k0, k1=k1)
            step += 1
        states.append((u, u0))
    return states
