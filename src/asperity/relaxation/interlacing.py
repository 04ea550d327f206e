"""Relaxation times from retardation times, and back: they interlace.

Relaxation in units of the instantaneous modulus, and creep in units of its inverse, with s = -x:

    s G(s) = p + sum_b g_b x tau_b/(x tau_b - 1) ,      s J(s) = 1 - sum_k j_k/(x theta_k - 1) - f/x

are inverse to each other. So the zeros of one are the poles of the other; both are monotonic between their
poles, and the residues follow from the slopes at the zeros.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asperity.base.checks import Floats
from asperity.solids.branches import ROUNDING


def merged(weights: Floats, times: Floats) -> tuple[Floats, Floats]:
    """Add up the weights of times that are equal but for rounding; times rise."""
    order = np.argsort(times)
    weights, times = weights[order], times[order]
    new = np.append(True, times[1:] > times[:-1] * (1 + ROUNDING))[: times.size]
    starts = np.flatnonzero(new)
    return (np.add.reduceat(weights, starts) if starts.size else weights), times[new]


def retardation(g: Floats, tau: Floats, p: float) -> tuple[Floats, Floats, float]:
    """Strengths, retardation times and fluidity, of shares and rising relaxation times."""
    if not g.size:
        return g, tau, 0.0
    rates = 1 / tau[::-1]
    low, high = rates[:-1], rates[1:]
    flow = float(g @ tau)
    if p > 0:  # a zero below all poles; the brackets are bounds of its equation p = sum_b g x tau/(1 - x tau)
        low = np.append(p / (flow + p * tau[-1]), low)
        high = np.append(min(p / flow, rates[0]), high)

    def modulus(x: Floats) -> Floats:
        x = x[:, None] * tau
        return np.asarray(p + (g * x / (x - 1)).sum(-1))

    zeros = _zeros(modulus, low, high)
    x = zeros[:, None] * tau
    with np.errstate(divide="ignore"):
        strengths = 1 / (g / (1 - x) * (x / (1 - x))).sum(-1)
    kept = strengths > 0
    return strengths[kept], 1 / zeros[kept], 0.0 if p > 0 else 1 / flow


def relaxation_rates(j: Floats, theta: Floats, f: float) -> Floats:
    """Rates 1/tau, of relative compliances, rising retardation times and fluidity (J0 = 1)."""
    rates = 1 / theta[::-1]
    total = float(j.sum())
    if not j.size:
        return np.array([f] if f > 0 else [])
    low = rates
    high = np.append(rates[1:], (1 + total + f * theta[0]) / theta[0])
    if f > 0:
        low = np.append(f / (1 + total + f * theta[-1]), low)
        high = np.append(min(rates[0], f), high)

    def compliance(x: Floats) -> Floats:
        return np.asarray((j / (x[:, None] * theta - 1)).sum(-1) + f / x - 1)

    return _zeros(compliance, low, high)


def _zeros(falling: Callable[[Floats], Floats], low: Floats, high: Floats) -> Floats:
    """Zeros between `low` and `high`, shape (n,), of a function that falls there, by bisection in log x."""
    lower, upper = np.zeros_like(low), np.log(np.maximum(high / low, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(80):
            middle = (lower + upper) / 2
            above = falling(low * np.exp(middle)) > 0
            lower, upper = np.where(above, middle, lower), np.where(above, upper, middle)
    return np.asarray(low * np.exp((lower + upper) / 2))
