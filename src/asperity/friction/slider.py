r"""A slider with rate-and-state friction, pulled by a spring.

    d mu/dt = k (V_lp - V),    V = V_1 exp(w),    mu = mu_1 + a w + b s,    s = ln(V_1 theta/D_c)
    aging law   ds/dt = (V_1 exp(-s) - V)/D_c
    slip law    ds/dt = -(V/D_c) (w + s)

Under a normal stress that changes, sigma over its mean, k/sigma replaces k, and (M. F. Linker, J. H.
Dieterich, J. Geophys. Res. 97, 4923 (1992), doi:10.1029/92JB00017)

    d mu/dt = ... - mu d ln sigma/dt,    ds/dt = ... - (alpha/b) d ln sigma/dt

The load point moves at constant V_lp between kinks, V_1 before the first, at which the slider moves steadily.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from asperity.base.checks import Floats
from asperity.friction.laws import StateLaw
from asperity.friction.loading import Drive
from asperity.friction.marching import METHOD, march
from asperity.friction.normal_stress import NormalStress

_TOLERANCE, _STEPS = 1e-7, 30000


class Shape(NamedTuple):
    """Parameters of a course, besides the drive."""

    a: float
    b: float
    D_c: float
    k: float
    alpha: float = 0.0


class RunsAwayError(Exception):
    """Friction falls faster than the force of the spring."""


@dataclass(frozen=True, eq=False)
class Course:
    """States (w, s) at each time, shape (n, 2), and the normal stress."""

    states: Floats
    time: Floats
    normal: NormalStress | None = None

    def elastic(self, shape: Shape) -> Floats:
        """Return a w + b s, the change of friction since the beginning, shape (n,)."""
        return np.asarray(self.states @ np.array([shape.a, shape.b]))

    def stretch(self, shape: Shape) -> Floats:
        """Return the lengthening of the spring since the beginning, shape (n,)."""
        elastic, normal = self.elastic(shape), self.normal
        if normal is None:
            return elastic / shape.k
        sigma = normal.at(self.time)
        return np.asarray((sigma * (normal.friction + elastic) - sigma[0] * normal.friction) / shape.k)


def follow(
    law: StateLaw, shape: Shape, drive: Drive, time: Floats, normal: NormalStress | None = None
) -> Course:
    """Integrate through a record; `RunsAwayError` if that fails, as in stick-slip.

    A parameter or a kink may be complex: see `asperity.friction.marching`.
    """
    edges = drive.edges(time)
    if (np.diff(edges.real) <= 0).any():
        raise RunsAwayError
    if normal is not None:
        edges = normal.edges(edges)
    mu_1, sigma = (0.0, np.ones_like(edges)) if normal is None else (normal.friction, normal.at(edges))
    velocity, lasts = drive.along(edges), np.diff(edges)
    rows = np.concatenate([[0], np.searchsorted(time, edges[1:-1].real), [time.size]])
    kind = np.result_type(*shape, edges)
    state, states, work = np.zeros(2, kind), np.empty((time.size, 2), kind), np.empty((2, 6), kind)
    for n, last in enumerate(lasts):
        places = np.concatenate([[0.0], (time[rows[n] : rows[n + 1]] - edges[n]) / last, [1.0]]).astype(kind)
        inside = np.empty((places.size, 2), kind)
        inside[0] = state
        numbers = [*shape, velocity[0] * last, velocity[n] * last, mu_1, sigma[n], sigma[n + 1] - sigma[n]]
        p = tuple(np.array(numbers, kind))
        if not march(law == "aging", p, places, _TOLERANCE, _STEPS, METHOD, work, inside):
            raise RunsAwayError
        states[rows[n] : rows[n + 1]], state = inside[1:-1], inside[-1]
    return Course(states, time, normal)
