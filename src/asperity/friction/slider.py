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
    normal: NormalStress

    def elastic(self, shape: Shape) -> Floats:
        """Return a w + b s, the change of friction since the beginning, shape (n,)."""
        return np.asarray(self.states @ np.array([shape.a, shape.b]))

    def stretch(self, shape: Shape) -> Floats:
        """Return the lengthening of the spring since the beginning, shape (n,)."""
        sigma, first = self.normal.at(self.time), self.normal.friction
        return np.asarray((sigma * (first + self.elastic(shape)) - sigma[0] * first) / shape.k)


def follow(
    law: StateLaw, shape: Shape, drive: Drive, time: Floats, normal: NormalStress | None = None
) -> Course:
    """Integrate through a record; `RunsAwayError` if that fails, as in stick-slip.

    A parameter or a kink may be complex: see `asperity.friction.marching`.
    """
    edges = drive.edges(time)
    if (np.diff(edges.real) <= 0).any():
        raise RunsAwayError
    normal = normal or NormalStress(time[[0, -1]], np.ones(2), 0.0)
    edges = normal.edges(edges)
    velocity, sigma, lasts = drive.along(edges), normal.at(edges), np.diff(edges)
    rows = np.concatenate([[0], np.searchsorted(time, edges[1:-1].real), [time.size]])
    kind = np.result_type(*shape, edges, velocity)
    state, states, work = np.zeros(2, kind), np.empty((time.size, 2), kind), np.empty((2, 6), kind)
    for n, last in enumerate(lasts):
        places = np.concatenate([[0.0], (time[rows[n] : rows[n + 1]] - edges[n]) / last, [1.0]]).astype(kind)
        inside = np.empty((places.size, 2), kind)
        inside[0] = state
        speeds, rise = last * velocity[[0, n]], sigma[n + 1] - sigma[n]
        numbers = tuple(np.array([*shape, *speeds, normal.friction, sigma[n], rise], kind))
        if not march(law == "aging", numbers, places, _TOLERANCE, _STEPS, METHOD, work, inside):
            raise RunsAwayError
        states[rows[n] : rows[n + 1]], state = inside[1:-1], inside[-1]
    return Course(states, time, normal)
