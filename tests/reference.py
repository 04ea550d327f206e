"""The paper's own algorithm, slow and obvious: the judge of the implicit integrator.

Projected Gauss-Seidel sweeps of Eq. (us) for u; a feedback loop (regula falsi on the mean of u0) that holds
the normal load. No transforms, no active sets. `history_reference` has the explicit steps of Eq. (dosrs).
"""

import numpy as np


def settle(u, u0, heights, *, k0, k1, accuracy=1e-13, most=np.inf):
    """Sweep u red and black until no site moves; shape of even lengths. No site bears more than ``most``."""
    color, sites = np.indices(u.shape).sum(axis=0) % 2, np.arange(u.size).reshape(u.shape)
    around = np.array([np.roll(sites, step, axis) for axis in range(u.ndim) for step in (1, -1)])
    halves = [(sites[color == one], around[:, color == one]) for one in (0, 1)]
    stiffness, found, anchors, lowest = 2 * u.ndim * k0 + k1, u.ravel().copy(), u0.ravel(), heights.ravel()
    while True:
        before = found.copy()
        for here, neighbors in halves:
            free = (k0 * found[neighbors].sum(axis=0) + k1 * anchors[here]) / stiffness
            found[here] = np.minimum(np.maximum(lowest[here], free), free + most / stiffness)
        if np.abs(found - before).max() < accuracy:
            return found.reshape(u.shape)


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
