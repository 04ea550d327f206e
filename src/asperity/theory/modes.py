r"""One mode of the elastic surface under a point load, and means over all of them.

With lam the eigenvalue of minus the Laplacian, x1 = k1/k0, x2 = k0 R t and r = R_tilde/R (paper, Eqs. (uq),
(u), (v0), (dosrs); it writes q^2 for lam), a mode under a unit force from x2 = 0 on has the depth

    [1 + (x1/lam) (1 - exp(-x2 z))] / (x1 + lam),      z = x1 lam (lam + r) / (x1 + lam)

The theory depends on the lattice only through the eigenvalues lam(q) of minus its Laplacian. So a mean over
wave vectors is an integral over lam with the density of states,

    line     rho(lam) = 1 / (pi sqrt(lam (4 - lam))),                        0 < lam < 4
    square   rho(lam) = K(m) / (2 pi^2),  m = 1 - ((lam - 4)/4)^2,           0 < lam < 8

(K: complete elliptic integral of parameter m; E. N. Economou, *Green's Functions in Quantum Physics*,
section 5.3, doi:10.1007/3-540-28841-4). The second is even about lam = 4, where it diverges like a logarithm.

The map lam = 4 / (1 + exp(-w)) sends w = -inf to the long waves lam = 0 and w = +inf to the singularity (for
the line: to the edge) lam = 4; the half above 4 is its mirror 8 - lam. In w the integrand decays
exponentially on both sides and is analytic for abs(Im w) < pi/4. So the trapezoidal rule of step h converges
like exp(-pi^2 / (2 h)) (L. N. Trefethen and J. A. C. Weideman, SIAM Review 56, 385 (2014),
doi:10.1137/130932132). Adaptive quadrature was not taken: the nodes would differ from one time to the next,
and with them the rounding of a curve.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipkm1, expit

from asperity.base.checks import Floats, broadcast, not_negative, positive

#: A function of lam, x1, x2, r.
Integrand = Callable[[Floats, Floats, Floats, Floats], Floats]
# Points times nodes held at once: 16 MB an array.
_BLOCK = 2_000_000
# Of the rule of step h = 1/8, and of what is left outside the nodes.
ROUNDING = 7e-18


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


def zone_nodes(dimension: int, log_scale: float, error: float = ROUNDING) -> tuple[Floats, Floats]:
    """Nodes and weights, shape (n,) each: ``sum(weight * f(lam))`` is the mean of f over the Brillouin zone.

    In 1 (line) or 2 dimensions (square lattice). Below exp(log_scale) f is that of lam = 0, times at most
    lam^0. The error is that of the mean, relative; the number of nodes grows as ln(error)^2.
    """
    step = math.pi**2 / (-2 * math.log(error))
    # On the line the density of states is lam^(-1/2): the tails are twice as long.
    reach = (3 - math.log(error)) * (2 if dimension == 1 else 1)
    lowest = min(log_scale - math.log(4), 0.0) - reach
    w = step * np.arange(math.floor(lowest / step), math.ceil(reach / step) + 1)
    below, above = expit(w), expit(-w)  # lam / 4 and (4 - lam) / 4, each without cancellation
    if dimension == 1:
        return 4 * below, step * np.sqrt(below * above) / math.pi
    weight = step * 4 * below * above * ellipkm1(above**2) / (2 * math.pi**2)
    mirrored = w > -reach  # below that the weights are lost in rounding
    lam = np.concatenate([4 * below, 4 + 4 * above[mirrored]])
    return lam, np.concatenate([weight, weight[mirrored]])


def torus_modes(shape: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Eigenvalues lam of a finite periodic lattice, without lam = 0, and how many modes share each."""
    lam = np.zeros(1)
    for length in shape:
        lam = np.add.outer(lam, 4 * np.sin(math.pi * np.arange(length) / length) ** 2).ravel()
    different, count = np.unique(lam[1:], return_counts=True)
    return different, count.astype(np.float64)
