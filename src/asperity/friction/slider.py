r"""A slider with rate-and-state friction, pulled by a spring.

    d mu/dt = k (V_lp - V),    V = V_1 exp(w),    mu = mu_1 + a w + b s,    s = ln(V_1 theta/D_c)
    aging law   ds/dt = (V_1 exp(-s) - V)/D_c
    slip law    ds/dt = -(V/D_c) (w + s)

Under a normal stress that changes, sigma over its mean, k/sigma replaces k, and (M. F. Linker, J. H.
Dieterich, J. Geophys. Res. 97, 4923 (1992), doi:10.1029/92JB00017)

    d mu/dt = ... - mu d ln sigma/dt,    ds/dt = ... - (alpha/b) d ln sigma/dt

The load point moves at constant V_lp between kinks, V_1 before the first, at which the slider moves steadily.
LSODA integrates w and s (A. C. Hindmarsh, Scientific Computing, 55 (1983); `scipy.integrate.odeint`).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.integrate import ODEintWarning, odeint

from asperity.base.checks import Floats
from asperity.friction.laws import StateLaw
from asperity.friction.loading import Drive
from asperity.friction.normal_stress import NormalStress

_TOLERANCE = 1e-8
_STEPS = 3000
"""Largest number of steps from row to row of a stable slider."""

_FORGOTTEN = 1e-7
"""Difference of w and s at a kink below which two courses are the same from there on."""


Rate = Callable[..., tuple[float, float]]


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
    """States (w, s) at each time, shape (n, 2), and at the beginning and each kink; the normal stress."""

    states: Floats
    starts: tuple[Floats, ...]
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
    law: StateLaw,
    shape: Shape,
    drive: Drive,
    time: Floats,
    base: Course | None = None,
    kink: int = 0,
    normal: NormalStress | None = None,
) -> Course:
    """Integrate through a record; `RunsAwayError` if that fails, as in stick-slip.

    If only one `kink` differs from a `base`, only the differing part of the course is integrated, unless the
    normal stress changes.
    """
    edges = drive.edges(time)
    if (np.diff(edges) <= 0).any():
        raise RunsAwayError
    if normal is not None:
        base, kink, edges = None, 0, normal.edges(edges)
    velocity = drive.along(edges)
    rows = np.concatenate([[0], np.searchsorted(time, edges[1:-1]), [time.size]])
    states = np.empty((time.size, 2)) if base is None else base.states.copy()
    starts: list[Floats] = [np.zeros(2)] if base is None else list(base.starts[: kink + 1])
    for n in range(kink, velocity.size):
        rate = _rate(law, shape, float(velocity[n]), float(velocity[0]))
        if normal is not None:
            rate = _pressed(rate, shape, normal, edges[n : n + 2], float(velocity[n]), float(velocity[0]))
        inside = slice(rows[n], rows[n + 1])
        states[inside], end = _integrated(rate, starts[n], time[inside] - edges[n], edges[n + 1] - edges[n])
        starts.append(end)
        if base is not None and n > kink and np.abs(end - base.starts[n + 1]).max() < _FORGOTTEN:
            states[rows[n + 1] :] = base.states[rows[n + 1] :]
            starts.extend(base.starts[n + 2 :])
            break
    return Course(states, tuple(starts), time, normal)


def _rate(law: StateLaw, shape: Shape, pulled: float, first: float) -> Rate:
    """Derivatives of w and s at the velocity `pulled` of the load point."""
    a, b, D_c, k, _ = shape
    exp, aging = math.exp, law == "aging"

    def rate(y: Floats, _: float) -> tuple[float, float]:
        w, s = y
        V = first * exp(w)
        grown = (first * exp(-s) - V) / D_c if aging else -V / D_c * (w + s)
        return (k * (pulled - V) - b * grown) / a, grown

    return rate


def _pressed(
    constant: Rate, shape: Shape, normal: NormalStress, ends: Floats, pulled: float, first: float
) -> Rate:
    """The same under a normal stress that is linear in time between two times."""
    a, b, _, k, alpha = shape
    start, end = normal.at(ends).tolist()
    slope, exp = (end - start) / float(ends[1] - ends[0]), math.exp

    def rate(y: Floats, t: float) -> tuple[float, float]:
        w, s = y
        faster, grown = constant(y, t)
        sigma = start + slope * t
        spring = k * (pulled - first * exp(w)) * (1 / sigma - 1)
        more = spring - (normal.friction + a * w + b * s - alpha) * slope / sigma
        return faster + more / a, grown - (alpha / b * slope / sigma if slope else 0.0)

    return rate


def _integrated(rate: Rate, start: Floats, times: Floats, end: float) -> tuple[Floats, Floats]:
    """States at the times since 0, and at the end."""
    initial = int(np.searchsorted(times, 1e-9 * end))  # rows at time 0, which LSODA refuses
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ODEintWarning)
        try:
            states, about = odeint(
                rate,
                start,
                np.concatenate([[0.0], times[initial:], [end]]),
                rtol=_TOLERANCE,
                atol=_TOLERANCE,
                mxstep=_STEPS,
                full_output=True,
            )
        except OverflowError:
            raise RunsAwayError from None
    if about["message"] != "Integration successful." or not np.isfinite(states).all():
        raise RunsAwayError
    return np.concatenate([np.broadcast_to(start, (initial, 2)), states[1:-1]]), states[-1]
