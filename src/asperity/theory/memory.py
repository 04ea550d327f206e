r"""One contact under a force that changes: the paper's hereditary integral, solved mode by mode.

The surface is linear, so under a force f(t) the site has the depth (Boltzmann; paper Eq. (vt), integrated)

    k0 u = int G(x2 - y) df(y) = f G(0) + int f(y) G'(x2 - y) dy

G is a sum of decaying exponentials, one for each mode, and each term of the integral obeys a differential
equation of its own. Let g be how far a mode lags behind its equilibrium under the force of the moment. Then
dg/dx2 = df/dx2 - z g. For a force that is linear in time this is solved exactly, without an error of the time
step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import exprel, hyp1f1

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.theory.modes import ROUNDING, decay, log_scale, zone_nodes


def response(x2: ArrayLike, force: ArrayLike, x1: float, viscous: float = 0.0, dimension: int = 2) -> Floats:
    """Depth of a site under any force, k0 u(0, t): exact for a force that is linear between the given times.

    Parameters
    ----------
    x2
        k0 R t, shape (n,), never decreasing. A time that is given twice is a jump of the force: the first
        entry is the state before it, the second that after it. Before the first time the force is 0.
    force
        At these times, shape (n,); any sign.

    The depth k0 u is a force, of shape (n,). Its instantaneous part, f(t) G(0), is the one that Eq. (vt)
    leaves out.
    """
    return _march(x2, force, x1, viscous, dimension)[0]


def response_rate(
    x2: ArrayLike,
    force: ArrayLike,
    x1: float,
    viscous: float = 0.0,
    dimension: int = 2,
    *,
    instantaneous: bool = True,
) -> Floats:
    """Speed of a site under any force, d(k0 u)/dx2: the paper's Eq. (vt) is v = R times this.

    Where the slope of the force changes, the speed jumps by G(0) times the change. The value is that of the
    interval that begins there; at the last time, and before a jump, of the one that ends there.

    Parameters
    ----------
    instantaneous
        Whether to include f'(t) G(0). False is the letter of Eq. (vt), which leaves it out; that loses
        nothing where the forces of all contacts sum to a constant load, as in the paper.
    """
    _, rate, slope, at_once = _march(x2, force, x1, viscous, dimension)
    return rate + slope * at_once if instantaneous else rate


@dataclass(frozen=True, eq=False)
class SiteMemory:
    """A site as a sum of modes that follow its force with a delay.

    Of its depth per force, ``at_once``, G(0), follows without delay, ``slow`` of each mode at its ``rate`` z.
    """

    at_once: float
    slow: Floats
    rate: Floats

    def step(self, duration: float) -> Step:
        """Factors of a step in which the force is linear in time; duration 0 is a jump."""
        y = self.rate * duration
        # 1 - (1 - exp(-y))/y without its cancellation at small y, and without an overflow at large y.
        late = np.minimum(y, 1e100)
        return Step(
            keep=np.exp(-y),
            gain=exprel(-y),
            recover=-self.slow * np.expm1(-y),
            follow=float(self.slow @ (late / 2 * hyp1f1(1, 3, -late))),
        )


class Step(NamedTuple):
    """From lags g, and a change df of the force, to the lags ``keep * g + gain * df``.

    The delayed part of the depth grows by ``recover @ g + follow * df``.
    """

    keep: Floats
    gain: Floats
    recover: Floats
    follow: float


def site_memory(
    x1: float, duration: float, viscous: float, dimension: int, error: float = ROUNDING
) -> SiteMemory:
    """Modes of a site, for histories of this duration (k0 R t); `error` as in `zone_nodes`."""
    scale = log_scale(np.asarray(x1), np.asarray(duration), np.asarray(viscous))
    lam, weight = zone_nodes(dimension, scale, error)
    per_force = weight / (x1 + lam)
    return SiteMemory(
        at_once=math.fsum(per_force),
        slow=per_force * (x1 / lam),
        rate=decay(lam, np.asarray(x1), np.asarray(viscous)),
    )


def _march(
    x2: ArrayLike, force: ArrayLike, x1: float, viscous: float, dimension: int
) -> tuple[Floats, Floats, Floats, float]:
    """Depth, delayed speed and slope of the force at every time, and G(0)."""
    times, forces = checks.history(x2=x2, force=force)
    memory = site_memory(
        checks.number("x1", x1, above=0),
        float(times[-1] - times[0]),
        checks.number("viscous", viscous, least=0),
        checks.line_or_plane(dimension),
    )
    lag = np.zeros_like(memory.rate)
    speed = memory.slow * memory.rate
    delayed, rate = np.zeros(times.size), np.zeros(times.size)
    durations, changes = np.diff(times, prepend=times[0]), np.diff(forces, prepend=0.0)
    grown = 0.0
    for i, (duration, change) in enumerate(zip(durations, changes, strict=True)):
        step = memory.step(float(duration))
        grown += float(step.recover @ lag) + step.follow * float(change)
        lag = step.keep * lag + step.gain * change
        delayed[i], rate[i] = grown, speed @ lag
    # Of the interval that begins at each time, else of the one that ends there.
    slope = np.divide(changes, durations, out=np.zeros(times.size), where=durations > 0)
    slope[:-1] = np.where(durations[1:] > 0, slope[1:], slope[:-1])
    return memory.at_once * forces + delayed, rate, slope, memory.at_once
