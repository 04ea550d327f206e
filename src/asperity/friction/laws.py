r"""Rate-and-state friction, and its state in closed form for ln V linear in slip.

The friction coefficient depends on the slip velocity V and on a state theta (time), which is the age of the
contacts (J. H. Dieterich, J. Geophys. Res. 84, 2161 (1979), doi:10.1029/JB084iB05p02161; A. Ruina, J.
Geophys. Res. 88, 10359 (1983), doi:10.1029/JB088iB12p10359):

    mu = mu_0 + a ln(V/V_0) + b ln(V_0 theta/D_c)
    aging law   d theta/dt = 1 - V theta/D_c
    slip law    d theta/dt = -(V theta/D_c) ln(V theta/D_c)

If the normal stress sigma changes, ln theta falls by (alpha/b) ln(sigma_2/sigma_1), and the friction
coefficient by alpha ln(sigma_2/sigma_1) (M. F. Linker, J. H. Dieterich, J. Geophys. Res. 97, 4923 (1992),
doi:10.1029/92JB00017).

Over a time t in which a contact slips x D_c, and ln V rises by 2 c, linearly in slip, to ln V_end, both have
solutions:

    aging   theta = theta_start exp(-x) + (x D_c/V_end) (1 - exp(-z))/z,  z = x - 2 c
    slip    ln theta = exp(-x) ln theta_start + (1 - exp(-x)) (ln(D_c/V_end) + 2 c (1/x - 1/(exp(x) - 1)))

A record is a chain of such times, without errors of an integrator. The slip of each interval gives its mean
velocity x D_c/t = V_end c/(sinh(c) exp(c)), and neighboring means give c, limited to 0 beside a jump
(`half_changes`). Both chains are sums of positive terms, which are added in the logarithm, so no number
overflows. At rest the aging law gives theta_start + t, the slip law theta_start.

Here V is the velocity of slip; `asperity.friction.slider` has a machine whose load point pulls by a spring.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.results.tabor import coming_velocity

StateLaw = Literal["aging", "slip"]
STATE_LAWS: tuple[StateLaw, ...] = ("aging", "slip")

_SHORT = 1e-3
"""Slip over D_c below which a series replaces 1/x - 1/(exp(x) - 1), to 1e-12."""


@dataclass(frozen=True, kw_only=True)
class RateAndState:
    """Rate-and-state friction with its parameters.

    Parameters
    ----------
    law
        Law of the state: ``"aging"`` (Dieterich) or ``"slip"`` (Ruina).
    a
        Direct effect of the velocity; 0 for a shear strength without it.
    b
        Effect of the state.
    D_c
        Slip over which the state forgets (length), above 0.
    mu_0
        Friction coefficient of steady sliding at V_0.
    V_0
        Reference velocity (length/time), above 0.
    alpha
        Effect of a change of the normal stress on the state.
    """

    law: StateLaw = "aging"
    a: float
    b: float
    D_c: float
    mu_0: float
    V_0: float
    alpha: float = 0.0

    def __post_init__(self) -> None:
        checks.choice("law", self.law, STATE_LAWS)
        for name in ("a", "b", "mu_0", "alpha"):
            object.__setattr__(self, name, checks.number(name, getattr(self, name)))
        for name in ("D_c", "V_0"):
            object.__setattr__(self, name, checks.number(name, getattr(self, name), above=0.0))

    def state(
        self,
        time: ArrayLike,
        velocity: ArrayLike,
        start: float | None = None,
        normal: ArrayLike | None = None,
    ) -> Floats:
        """Return the state theta of a record.

        Parameters
        ----------
        time
            Times that never fall, shape (n,).
        velocity
            Mean velocity of slip in the interval that ends at each time, shape (n,), not below 0; at the
            first time, that of the first interval. It is constant where it is the same for two intervals or
            more; see `half_changes`.
        start
            State at the first time, not below 0, and above 0 for the slip law; by default that of steady
            sliding at the first velocity above 0.
        normal
            Normal stress (any unit) in the interval that ends at each time, shape (n,), above 0: it changes
            at times of the record, at which the state is the one before. By default it is constant.

        Returns
        -------
        ndarray
            theta (time), shape (n,). `InputError` if nothing slides and no start is given.
        """
        times, velocities = timetable(time, velocity)
        if start is None:
            start = self.D_c / first_velocity(velocities)
        start = checks.number("start", start, least=0.0)
        if start == 0 and self.law == "slip":
            raise InputError("start", expected="a state above 0 for the slip law", got=start)
        with np.errstate(divide="ignore"):
            log = float(np.log(start))
        falls = self._falls(times, normal)
        state, ends = np.empty(times.size), [0, *np.flatnonzero(falls).tolist(), times.size - 1]
        for first, last in pairwise(ends):
            rows = slice(first, last + 1)
            part = log_state(self.law, times[rows], velocities[rows], self.D_c, log - falls[first])
            state[rows] = np.append(log, part[1:])
            log = float(part[-1])
        return np.exp(state)

    def _falls(self, time: Floats, normal: ArrayLike | None) -> Floats:
        """Fall of ln theta after each time, shape (n,)."""
        if normal is None or self.alpha == 0:
            return np.zeros(time.size)
        stress = checks.positive("normal", checks.history(time=time, normal=normal)[1])
        if self.b == 0:
            raise InputError("b", expected="a number other than 0 beside alpha", got=self.b)
        return np.append(self.alpha / self.b * np.diff(np.log(stress)), 0.0)

    def friction(
        self,
        time: ArrayLike,
        velocity: ArrayLike,
        start: float | None = None,
        normal: ArrayLike | None = None,
    ) -> Floats:
        """Return the friction coefficient of a record, shape (n,), with the parameters of `state`.

        At rest it is the strength against slip at the next velocity.
        """
        state = self.state(time, velocity, start, normal)
        direct = self.a * log_velocity(*timetable(time, velocity), self.V_0)
        with np.errstate(divide="ignore"):
            return np.asarray(self.mu_0 + direct + self.b * np.log(self.V_0 * state / self.D_c))

    def steady_friction(self, velocity: ArrayLike) -> Floats:
        """Return the friction of steady sliding, mu_0 + (a - b) ln(V/V_0), at velocities of any shape."""
        velocities = checks.positive("velocity", velocity)
        return np.asarray(self.mu_0 + (self.a - self.b) * np.log(velocities / self.V_0))[()]


def timetable(time: ArrayLike, velocity: ArrayLike) -> tuple[Floats, Floats]:
    """Check times, which never fall, and velocities, not below 0."""
    times, velocities = checks.history(time=time, velocity=velocity)
    if (velocities < 0).any():
        expected = "velocities not below 0, as the record slides in one direction"
        advice = "cutting the record at the reversal, or smoothing a noisy displacement"
        raise InputError("velocity", expected=expected, got=float(velocities.min()), advice=advice)
    return times, velocities


def first_velocity(velocity: Floats) -> float:
    """Return the first velocity above 0."""
    slides = velocity > 0
    if not slides.any():
        raise InputError("velocity", expected="a velocity above 0 somewhere", got="rest at all times")
    return float(velocity[np.argmax(slides)])


def half_changes(time: Floats, velocity: Floats) -> Floats:
    """Half the change of ln V within each interval, shape (n,), from the means of the intervals around it.

    It is the monotonized central slope of B. van Leer (J. Comput. Phys. 23, 276 (1977),
    doi:10.1016/0021-9991(77)90095-X), with ln V in the range of its neighbors. So V is constant beside a
    jump, a rest, an extremum, and two entries of one time.
    """
    slip = velocity * np.diff(time, prepend=time[0])
    slides = slip > 0
    mean = np.log(np.where(slides, velocity, 1.0))
    change = np.where(slides[1:] & slides[:-1], np.diff(mean), 0.0)
    before, after = np.append(0.0, change), np.append(change, 0.0)
    reach = np.append(0.0, slip[:-1]) + 2 * slip + np.append(slip[1:], 0.0)
    central = np.abs(before + after) * np.divide(slip, reach, out=np.zeros_like(slip), where=slides)
    half = np.minimum(central, np.minimum(np.abs(before), np.abs(after)))
    return np.where(np.sign(before) == np.sign(after), np.sign(before) * half, 0.0)


def log_velocity(time: Floats, velocity: Floats, V_0: float) -> Floats:
    """Logarithm of V/V_0 at the end of each interval, with `coming_velocity` at rest; 0 without any slip."""
    coming = coming_velocity(velocity * np.exp(_log_end(half_changes(time, velocity))))
    return np.log(np.divide(coming, V_0, out=np.ones_like(velocity), where=coming > 0))


def _log_end(half: Floats) -> Floats:
    """Logarithm of the velocity at the end of an interval over its mean."""
    return half + np.log(np.divide(np.sinh(half), half, out=np.ones_like(half), where=half != 0))


def log_state(law: StateLaw, time: Floats, velocity: Floats, D_c: float, start: float) -> Floats:
    """Logarithm of theta at each time, shape (n,), from that at the first time."""
    duration = np.diff(time, prepend=time[0])
    slid = velocity * duration / D_c  # x of each interval; the first has no length
    total = np.cumsum(slid)
    half = half_changes(time, velocity)
    end = _log_end(half)
    lost = -np.expm1(-slid)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if law == "aging":
            # Growth of theta in each interval: its duration, less the loss by slip.
            z = slid - 2 * half
            added = np.log(duration * np.where(z == 0, 1.0, -np.expm1(-z) / z)) - end
            added[0] = start
            return np.asarray(np.logaddexp.accumulate(added + total) - total)
        late = np.where(slid > _SHORT, 1 / slid - 1 / np.expm1(slid), 0.5 - slid / 12)
        steady = np.where(velocity > 0, np.log(D_c / velocity) - end + 2 * half * late, start)
        floor = min(float(steady.min()), start)
        # ln theta is a mean of its start and of steady states, with weights that sum to 1.
        added = np.log(lost) + np.log(steady - floor)
        added[0] = np.log(start - floor)
        return np.asarray(floor + np.exp(np.logaddexp.accumulate(added + total) - total))
