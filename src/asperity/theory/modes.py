r"""One mode of the elastic surface under a force that is the same for all modes: a point load.

With lam the eigenvalue of minus the Laplacian, x1 = k1/k0, x2 = k0 R t and r = R_tilde/R (paper, Eqs. (uq),
(u), (v0), (dosrs); it writes q^2 for lam), a mode under a unit force from x2 = 0 on has the depth

    [1 + (x1/lam) (1 - exp(-x2 z))] / (x1 + lam),      z = x1 lam (lam + r) / (x1 + lam)
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from asperity.base.checks import Floats, broadcast, not_negative, positive

#: A function of lam, x1, x2, r.
Integrand = Callable[[Floats, Floats, Floats, Floats], Floats]
# Points times nodes held at once: 16 MB an array.
_BLOCK = 2_000_000


def creep_numbers(
    x1: ArrayLike,
    x2: ArrayLike,
    viscous: ArrayLike,
    infinity: str = "torus_compliance, which has a relaxed state",
) -> list[Floats]:
    """Check k1/k0, k0 R t and R_tilde/R, broadcast against each other."""
    time = not_negative("x2", x2, infinity=infinity)
    return broadcast(x1=positive("x1", x1), x2=time, viscous=mobility_ratio(viscous))


def mobility_ratio(viscous: ArrayLike) -> Floats:
    """Check R_tilde/R."""
    return not_negative("viscous", viscous, infinity="a large number")


def decay(lam: Floats, x1: Floats, r: Floats) -> Floats:
    """Rate z of a mode, in units of k0 R."""
    return np.asarray((x1 / (x1 + lam)) * lam * (lam + r))


def depth(lam: Floats, x1: Floats, x2: Floats, r: Floats) -> Floats:
    """Depth of a mode, in units of 1/k0."""
    return np.asarray((1 - (x1 / lam) * np.expm1(-x2 * decay(lam, x1, r))) / (x1 + lam))


def sinking(lam: Floats, x1: Floats, x2: Floats, r: Floats) -> Floats:
    """Derivative of `depth` with respect to x2."""
    return np.asarray((x1 / (x1 + lam)) ** 2 * (lam + r) * np.exp(-x2 * decay(lam, x1, r)))


def log_scale(x1: Floats, x2: Floats, r: Floats) -> float:
    """Logarithm of the lam below which depths are that of lam = 0: least of x1, x2^(-1/2) and 1/(r x2)."""
    late = math.log(max(float(x2.max()), 1.0))
    viscosity = math.log(max(float(r.max()), 1e-300))
    return min(math.log(float(x1.min())), -late / 2, -late - viscosity)


def weighted_sum(
    integrand: Integrand, lam: Floats, weight: Floats, x1: Floats, x2: Floats, r: Floats
) -> Floats:
    """Sum of weight * integrand over the nodes, for every point, a block of points at a time."""
    points = [array.reshape(-1, 1) for array in (x1, x2, r)]
    total = np.empty(x1.size)
    rows = max(1, _BLOCK // max(1, lam.size))
    for start in range(0, x1.size, rows):
        part = slice(start, start + rows)
        total[part] = integrand(lam, points[0][part], points[1][part], points[2][part]) @ weight
    return total.reshape(x1.shape)
