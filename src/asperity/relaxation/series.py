r"""A generalized Maxwell solid as a Prony series: its relaxation, its creep, and its response to a load.

    G(t) = G0 [ p + sum_b g_b exp(-t/tau_b) ],        p = 1 - sum_b g_b

with the instantaneous modulus G0, shares g_b of it, relaxation times tau_b, and the permanent share p.
The creep compliance is the inverse of G by Carson's transform, s J(s) = 1/(s G(s)). It has the same form,
with retardation times theta_k that interlace the relaxation times:

    J(t) = [ 1 + f t + sum_k j_k (1 - exp(-t/theta_k)) ] / G0

The retardation rates are the zeros of s G(s) between its poles. Bisection finds them, so J is exact for any
number of branches and decades. The fluidity f is 0 unless p = 0.

References
----------
B. Gross, *Mathematical Structure of the Theories of Viscoelasticity* (Hermann 1953).
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.errors import LARGEST, InputError
from asperity.relaxation import interlacing
from asperity.solids.branches import ROUNDING, Branches, check_branches


@dataclass(frozen=True)
class PronySeries:
    """A generalized Maxwell solid: shares of one modulus, each with its relaxation time.

    Parameters
    ----------
    modulus
        Instantaneous modulus G0, above 0: of any kind, in any unit. J is in the inverse unit.
    branches
        Pairs of a share of G0 and a relaxation time, see `check_branches`; none for an elastic solid.
    span
        Times between which it approximates a law or data.
    error
        Largest relative error of this approximation; 0 if it is exact.
    """

    modulus: float
    branches: Branches = ()
    span: tuple[float, float] = (0.0, math.inf)
    error: float = 0.0

    def __post_init__(self) -> None:
        modulus = checks.number("modulus", self.modulus, least=1 / LARGEST, expected="a finite modulus > 0")
        object.__setattr__(self, "modulus", modulus)
        object.__setattr__(self, "branches", check_branches(self.branches))
        object.__setattr__(self, "error", checks.number("error", self.error, least=0))
        span = tuple(checks.not_negative("span", self.span, infinity="welcome").tolist())
        if len(span) != 2 or not span[0] <= span[1]:
            raise InputError("span", expected="a first and a last time", got=checks.shown(self.span))
        object.__setattr__(self, "span", span)

    def __repr__(self) -> str:
        first, last = self.span
        text = f"modulus {self.modulus:.4g}, {len(self.branches)} branches, permanent {self.permanent:.3g}"
        good = f", to {100 * self.error:.2g} % from {first:.3g} to {last:.3g}" if self.error else ""
        return f"<PronySeries: {text}{good}>"

    @property
    def permanent(self) -> float:
        """Share of the modulus that does not relax; 0 for a fluid."""
        share = 1 - math.fsum(share for share, _ in self.branches)
        return share if share > ROUNDING else 0.0

    def modulus_at(self, time: ArrayLike) -> Floats:
        """Relaxation modulus G(t): stress over a strain imposed at time 0, at times >= 0 of any shape."""
        t = checks.not_negative("time", time)[..., None]
        shares, times = self._columns
        with np.errstate(over="ignore"):
            return np.asarray(self.modulus * (self.permanent + (shares * np.exp(-t / times)).sum(-1)))

    def compliance_at(self, time: ArrayLike) -> Floats:
        """Creep compliance J(t): strain over a stress imposed at time 0, in 1/unit of the modulus; exact."""
        t = checks.not_negative("time", time)
        strengths, times, fluidity = self.retardation
        with np.errstate(over="ignore"):
            delayed = (strengths * -np.expm1(-t[..., None] / times)).sum(-1)
        return np.asarray((1 + fluidity * t + delayed) / self.modulus)

    def storage(self, frequency: ArrayLike) -> Floats:
        """Storage modulus G' at angular frequencies (radians per unit of time), the shape of `frequency`."""
        shares, times = self._columns
        x = checks.not_negative("frequency", frequency)[..., None] * times
        with np.errstate(divide="ignore"):
            return np.asarray(self.modulus * (self.permanent + (shares / (1 + (1 / x) ** 2)).sum(-1)))

    def loss(self, frequency: ArrayLike) -> Floats:
        """Loss modulus G'' at angular frequencies (radians per unit of time), the shape of `frequency`."""
        shares, times = self._columns
        x = checks.not_negative("frequency", frequency)[..., None] * times
        with np.errstate(divide="ignore"):
            return np.asarray(self.modulus * (shares / (x + 1 / x)).sum(-1))

    def shifted(self, factor: float) -> PronySeries:
        """Multiply every time by a factor, such as that of `arrhenius` or `wlf`."""
        factor = checks.number("factor", factor, least=1 / LARGEST, expected="a finite factor > 0")
        branches = tuple((share, factor * time) for share, time in self.branches)
        first, last = self.span
        return dataclasses.replace(self, branches=branches, span=(factor * first, factor * last))

    def effective_load(self, times: ArrayLike, loads: ArrayLike) -> Floats:
        """Load on the instantaneous solid that makes the same contact as a history of load.

            effective(t) = G0 integral J(t - s) dF(s)

        The load F is 0 before the first time, linear between the times, and jumps at the first time and at
        equal times. The integral is exact. A separable viscoelastic solid has the contact of the elastic
        solid at this load as long as F has never fallen.

        Parameters
        ----------
        times, loads
            Times that do not fall, and their loads F; shape (n,), as that of the result.

        Raises
        ------
        InputError
            The shapes differ, or times fall.

        References
        ----------
        E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27, 438 (1960).
        T. C. T. Ting, J. Appl. Mech. 33, 845 (1966).
        """
        t, F = checks.history(times=times, loads=loads)
        strengths, retardation_times, fluidity = self.retardation
        delayed, impulse = np.zeros_like(strengths), 0.0  # y_k: theta_k dy_k/dt = F - y_k; and integral F dt
        effective = F.copy()
        for i in range(t.size):
            if i and (tau := t[i] - t[i - 1]) > 0:
                x = tau / retardation_times
                late = _late_weight(x)
                delayed = delayed * np.exp(-x) + F[i - 1] * (-np.expm1(-x) - late) + F[i] * late
                impulse += tau * (F[i - 1] + F[i]) / 2
            effective[i] += strengths @ delayed + fluidity * impulse
        return effective

    @functools.cached_property
    def retardation(self) -> tuple[Floats, Floats, float]:
        """Creep of the solid: strengths j_k and retardation times theta_k, shape (m,), and fluidity f."""
        shares, times = interlacing.merged(*self._columns)
        return interlacing.retardation(shares, times, self.permanent)

    @property
    def _columns(self) -> Floats:
        return np.array(self.branches, dtype=np.float64).reshape(-1, 2).T


def of_weights(weights: Floats, times: Floats) -> PronySeries:
    """Series of weights, shape (m + 1,), of branches of times of shape (m,); the last one is permanent."""
    modulus = float(weights.sum())
    some = weights[:-1] > 0
    shares = weights[:-1][some] / modulus
    return PronySeries(modulus, tuple(zip(shares.tolist(), times[some].tolist(), strict=True)))


def from_retardation(
    compliance: float, delayed: Iterable[Sequence[float | str]], fluidity: float = 0.0
) -> PronySeries:
    """Convert creep to relaxation: the Prony series of a generalized Kelvin solid, exactly.

        J(t) = J0 + f t + sum_k J_k (1 - exp(-t/theta_k))

    Parameters
    ----------
    compliance
        Instantaneous compliance J0, above 0.
    delayed
        Pairs of a compliance J_k and its retardation time theta_k, both above 0.
    fluidity
        Rate of flow f under unit stress, compliance per time; 0 for a solid.
    """
    J0 = checks.number("compliance", compliance, least=1 / LARGEST, expected="a finite compliance > 0")
    f = checks.number("fluidity", fluidity, least=0) / J0
    array = checks.floats("delayed", delayed)
    if array.size and (array.ndim != 2 or array.shape[1] != 2):
        expected = "pairs of a compliance and a retardation time"
        raise InputError("delayed", expected=expected, got=f"shape {array.shape}")
    columns = checks.positive("delayed", array).reshape(-1, 2).T
    j, theta = interlacing.merged(columns[0] / J0, columns[1])
    rates = interlacing.relaxation_rates(j, theta, f)
    x = rates[:, None] * theta
    with np.errstate(divide="ignore"):
        shares = 1 / ((j / (1 - x) * (x / (1 - x))).sum(-1) + f / rates)
    # A solid: 1 - sum(shares) = 1/(1 + sum(j)). A fluid keeps nothing, in spite of rounding.
    shares *= (1 if f else j.sum() / (1 + j.sum())) / max(shares.sum(), 1e-300)
    kept = shares > 0
    return PronySeries(1 / J0, tuple(zip(shares[kept].tolist(), (1 / rates[kept]).tolist(), strict=True)))


def combined(one: PronySeries, other: PronySeries) -> PronySeries:
    """Two bodies in contact as one: at every time their compliances add up, 1/E* = 1/E1* + 1/E2*."""
    compliance, fluidity = 0.0, 0.0
    delayed: list[tuple[float, float]] = []
    for series in (one, other):
        series = checks.instance("one, other", series, PronySeries, "PronySeries(modulus, branches)")
        strengths, times, flow = series.retardation
        compliance += 1 / series.modulus
        fluidity += flow / series.modulus
        delayed += zip((strengths / series.modulus).tolist(), times.tolist(), strict=True)
    series = from_retardation(compliance, delayed, fluidity)
    span = max(one.span[0], other.span[0]), min(one.span[1], other.span[1])
    return dataclasses.replace(series, span=span, error=max(one.error, other.error))


def _late_weight(x: Floats) -> Floats:
    """Weight 1 - (1 - exp(-x))/x of the load at the end of a step of x retardation times."""
    series = x * (1 / 2 - x * (1 / 6 - x * (1 / 24 - x * (1 / 120 - x * (1 / 720 - x / 5040)))))
    return np.where(x < 0.02, series, 1 + np.expm1(-x) / np.maximum(x, 0.02))
