"""The paper's explicit algorithm along any history: the judge of protocols. Slow and obvious."""

from functools import cache

import numpy as np

from tests.independent import laplacian
from tests.reference import settle, settle_under_load
from tests.surfaces import uncorrelated


def explicit_history(heights, load_at, separation_at, times, dt, *, k0, k1, R, R_viscous=0.0, moved_by=None):
    """Return (u, u0) at each time, multiples of dt, in Euler steps from flat u0.

    ``moved_by``, a function of time, says by how many sites along each axis the heights have moved.

    One of ``load_at`` and ``separation_at`` is a function of time, the other None. What is prescribed at a
    time is what follows it: a jump at a time has happened then. The rigid body carries u0 along.
    """
    u0 = np.full(heights.shape, heights.max() if separation_at is None else separation_at(0.0))
    u = np.maximum(u0, heights)

    def equilibrium(u, u0, time):
        here = heights if moved_by is None else np.roll(heights, moved_by(time), axis=(0, 1))
        if separation_at is None:
            return settle_under_load(u, u0, here, load_at(time), k0=k0, k1=k1)
        return settle(u, u0, here, k0=k0, k1=k1), u0

    u, u0 = equilibrium(u, u0, 0.0)
    states, step = [], 0
    for time in times:
        while step < round(time / dt):
            rhs = k1 * (u0 - u)
            u0 = u0 + dt * (R * laplacian(rhs) - R_viscous * rhs)
            if separation_at is not None:
                u0 = u0 + separation_at((step + 1) * dt) - separation_at(step * dt)
            step += 1
            u, u0 = equilibrium(u, u0, step * dt)
        states.append((u, u0))
    return states


@cache
def second_order(change, prescribed, R_viscous, times=(0.25, 0.5, 0.75, 1.0), moved_by=None):
    """The same of 64 sites, whose load or separation changes, of two runs: errors of first order cancel."""
    load_at, separation_at = (change, None) if prescribed == "load" else (None, change)
    law = {"k0": 1.0, "k1": 3.0, "R": 1.0, "R_viscous": R_viscous, "moved_by": moved_by}
    history = uncorrelated(8), load_at, separation_at, times
    runs = (explicit_history(*history, 1 / steps, **law) for steps in (100, 200))
    return [(2 * u_fine - u, 2 * u0_fine - u0) for (u, u0), (u_fine, u0_fine) in zip(*runs, strict=True)]


def assert_follows(history, reference, scale):
    """The fields kept, at a jump those after it, are the reference's; gives them."""
    after = history.dataset.drop_duplicates("field_time", keep="last")
    for index, (u, u0) in enumerate(reference):
        np.testing.assert_allclose(after["u"].values[index], u, atol=2e-3 * scale)
        np.testing.assert_allclose(after["u0"].values[index], u0, atol=2e-3 * scale)
    return after
