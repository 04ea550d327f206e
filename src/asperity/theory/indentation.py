r"""One contact under constant load: the compliance of a site, and how it grows.

A force f0 pushes one site from t = 0 on. The paper's Eqs. (uq) and (u) give the depth f0 G / k0 with

    G(x1, x2) = < [1 + (x1/lam) (1 - exp(-x2 z))] / (x1 + lam) >,   z = x1 lam (lam + r) / (x1 + lam)

with x1 = k1/k0, x2 = k0 R t, r = R_tilde/R (Eq. dosrs; 0 in the body of the paper), the brackets being
the mean over the Brillouin zone. Source: E. A. Jagla, *Towards a modeling of the time dependence of
contact area between solid bodies*, Eqs. (uq), (u), (v0), (dosrs) and the figure of G.

Where this differs from the letter of the paper:

* The paper writes q^2 for lam(q). Its constant a1 = 0.3 shows that the lattice's lam was computed: a
  q^2 dispersion on the square zone would give 0.2227.
* Its a0 = 0.04 is 1/(8 pi), `LATE_SLOPE`; its a1 = 0.3 is (10 ln 2 + Euler's gamma)/(8 pi), `LATE_INTERCEPT`.
* It treats a contact as a bare spring k1. A site also drags its neighbors: `site_stiffness`.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipkm1, gamma

from asperity.errors import InputError
from asperity.theory._checks import Floats, broadcast, line_or_plane, non_negative, positive
from asperity.theory.zone import torus_modes, zone_nodes

#: Slope of G in ln(k0 R t) at late times on the square lattice, without R_tilde; the paper's a0 = 0.04.
LATE_SLOPE = 1 / (8 * math.pi)
#: Its intercept at ln(k0 R t) = 0; the paper's a1 = 0.3.
LATE_INTERCEPT = (10 * math.log(2) + np.euler_gamma) / (8 * math.pi)

_Integrand = Callable[[Floats, Floats, Floats, Floats], Floats]
# Points times nodes held at once: 16 MB an array.
_BLOCK = 2_000_000


def compliance(x1: ArrayLike, x2: ArrayLike, viscous: ArrayLike = 0.0, dimension: int = 2) -> Floats:
    """Return the paper's G(x1, x2), Eq. (u): compliance of one site, in units of 1/k0.

    Parameters
    ----------
    x1
        k1/k0, above 0.
    x2
        k0 R t, the reduced time, not below 0.
    viscous
        R_tilde/R (Eq. dosrs), not below 0.
    dimension
        2 (square lattice) or 1 (line).

    Returns
    -------
    ndarray
        Shape of the broadcast arguments; a NumPy float if all are scalars. Accurate to 1e-14, relative,
        for x1 from 1e-3 to 1e4, x2 from 0 to 1e15 and viscous from 0 to 1e6.

    Raises
    ------
    InputError
        For a number out of range, and for shapes that do not broadcast.
    """
    return _zone_mean(_depth, x1, x2, viscous, dimension)


def compliance_rate(x1: ArrayLike, x2: ArrayLike, viscous: ArrayLike = 0.0, dimension: int = 2) -> Floats:
    """Return G'(x1, x2) = dG/dx2 of Eq. (v0): the site sinks at the speed v0 = f0 R G'.

    Arguments, result, accuracy and errors are those of `compliance`.
    """
    return _zone_mean(_sinking, x1, x2, viscous, dimension)


def compliance_asymptote(
    x2: ArrayLike, viscous: ArrayLike = 0.0, dimension: int = 2, x1: ArrayLike | None = None
) -> Floats:
    """Late-time form of `compliance`.

    The leading term knows nothing of x1. It is, with r = `viscous`,

        square, r = 0   (ln x2 + 10 ln 2 + gamma_E) / (8 pi)
        square, r > 0   (ln(32 r x2) + gamma_E) / (4 pi)
        line,   r = 0   Gamma(3/4) x2^(1/4) / pi
        line,   r > 0   sqrt(r x2 / pi)

    and, where `x1` is given, the next term of the expansion is added:

        square, r = 0   (4 - x1) / (64 x1 sqrt(pi x2))
        square, r > 0   (1/r - 1/8) / (4 pi r x2)
        line,   r = 0   Gamma(1/4) (6/x1 - 1) x2^(-1/4) / (32 pi)
        line,   r > 0   (1/x1 + 1/r - 1/4) / (4 sqrt(pi r x2))

    They hold once x2 >> 1, x2 >> 1/x1^2, and for r > 0 also x2 >> 1/r^2 and x2 >> 1/r. Between x2 = 1 and
    x2 = 1/r^2 a small r does not show yet: take r = 0 there.

    Parameters
    ----------
    x2
        k0 R t, above 0.
    viscous
        R_tilde/R, not below 0.
    dimension
        2 (square lattice) or 1 (line).
    x1
        k1/k0, above 0; None for the leading term alone.

    Returns
    -------
    ndarray
        Shape of the broadcast arguments; a NumPy float if all are scalars.

    Raises
    ------
    InputError
        For a number out of range, and for shapes that do not broadcast.

    Notes
    -----
    Expand the integrand at small lam at fixed x2 lam^2 (r = 0) or r x2 lam (r > 0). The terms of the paper
    are the first and third line of the first list (Fig. of G; Summary, "t^(1/4)").
    """
    line_or_plane(dimension)
    first = np.asarray(1.0) if x1 is None else positive("x1", x1)
    first, time, r = broadcast(
        x1=first,
        x2=positive("x2", x2),
        viscous=non_negative("viscous", viscous, infinity="a large number"),
    )
    s = np.where(r > 0, r * time, 1.0)  # 1: not read where r = 0
    per_r = 1 / np.where(r > 0, r, 1.0)
    if dimension == 2:
        creeping = LATE_SLOPE * np.log(time) + LATE_INTERCEPT
        flowing = (np.log(32 * s) + np.euler_gamma) / (4 * math.pi)
        creeping_next = (4 - first) / (64 * first * np.sqrt(math.pi * time))
        flowing_next = (per_r - 1 / 8) / (4 * math.pi * s)
    else:
        creeping = gamma(3 / 4) * time ** (1 / 4) / math.pi
        flowing = np.sqrt(s / math.pi)
        creeping_next = gamma(1 / 4) * (6 / first - 1) * time ** (-1 / 4) / (32 * math.pi)
        flowing_next = (1 / first + per_r - 1 / 4) / (4 * np.sqrt(math.pi * s))
    leading = np.where(r > 0, flowing, creeping)
    if x1 is None:
        return np.asarray(leading)[()]
    return np.asarray(leading + np.where(r > 0, flowing_next, creeping_next))[()]


def torus_compliance(
    x1: ArrayLike, x2: ArrayLike, shape: tuple[int, ...], viscous: ArrayLike = 0.0
) -> Floats:
    """Compliance k0 J_L of one contact on a finite periodic lattice: the mean over its modes.

    The height of the contact above the mean of u0 is F J_L(t). The mode q = 0 adds 1/(k1 N) at all times,
    with R_tilde as well: R_tilde moves the mean of u0, which the height is measured from.

    Parameters
    ----------
    x1
        k1/k0, above 0.
    x2
        k0 R t, not below 0; infinity gives the relaxed state.
    shape
        Sites along each axis: ``(n,)`` or ``(n, m)``.
    viscous
        R_tilde/R, not below 0.

    Returns
    -------
    ndarray
        Shape of the broadcast x1, x2, viscous; a NumPy float if all are scalars.

    Raises
    ------
    InputError
        For a number out of range, a shape that is not one or two positive lengths, and arguments that do
        not broadcast.
    """
    lengths = _lengths(shape)
    lam, count = torus_modes(lengths)
    sites = math.prod(lengths)
    first, time, r = broadcast(
        x1=positive("x1", x1),
        x2=non_negative("x2", x2, infinity="welcome"),
        viscous=non_negative("viscous", viscous, infinity="a large number"),
    )
    waves = _weighted_sum(_depth, lam, count / sites, first, time, r)
    return np.asarray(1 / (first * sites) + waves)[()]


def site_stiffness(x1: ArrayLike, dimension: int = 2) -> Floats:
    """Stiffness of one site before any creep, k_eff/k0 = 1 / G(x1, 0).

    On the square lattice pi (x1 + 4) / (2 K(m)) with m = (4/(x1 + 4))^2, on the line sqrt(x1 (x1 + 4)).
    The paper takes k1 instead, that is x1: wrong by 37 % at x1 = 10 and by a factor of almost four at x1 = 1.

    Parameters
    ----------
    x1
        k1/k0, above 0; any shape.
    dimension
        2 (square lattice) or 1 (line).

    Returns
    -------
    ndarray
        Shape of x1; a NumPy float for a scalar.

    Raises
    ------
    InputError
        For an x1 out of range or another dimension.
    """
    first = positive("x1", x1)
    if line_or_plane(dimension) == 1:
        return np.sqrt(first * (first + 4))[()]
    # K by 1 - m, which keeps its digits where m is near 1, that is at small x1.
    rest = first * (first + 8) / (first + 4) ** 2
    return np.asarray(math.pi * (first + 4) / (2 * ellipkm1(rest)))[()]


def _decay(lam: Floats, x1: Floats, r: Floats) -> Floats:
    """Rate z of a mode, in units of k0 R."""
    return np.asarray((x1 / (x1 + lam)) * lam * (lam + r))


def _depth(lam: Floats, x1: Floats, x2: Floats, r: Floats) -> Floats:
    return np.asarray((1 - (x1 / lam) * np.expm1(-x2 * _decay(lam, x1, r))) / (x1 + lam))


def _sinking(lam: Floats, x1: Floats, x2: Floats, r: Floats) -> Floats:
    return np.asarray((x1 / (x1 + lam)) ** 2 * (lam + r) * np.exp(-x2 * _decay(lam, x1, r)))


def _zone_mean(
    integrand: _Integrand, x1: ArrayLike, x2: ArrayLike, viscous: ArrayLike, dimension: int
) -> Floats:
    first, time, r = broadcast(
        x1=positive("x1", x1),
        x2=non_negative("x2", x2, infinity="torus_compliance, which has a relaxed state"),
        viscous=non_negative("viscous", viscous, infinity="a large number"),
    )
    line_or_plane(dimension)
    if first.size == 0:
        return np.zeros(first.shape)
    # Below the smallest of x1, x2^(-1/2) and 1/(r x2) nothing of the integrand changes any more.
    late = math.log(max(float(time.max()), 1.0))
    viscosity = math.log(max(float(r.max()), 1e-300))
    lam, weight = zone_nodes(dimension, min(math.log(float(first.min())), -late / 2, -late - viscosity))
    return _weighted_sum(integrand, lam, weight, first, time, r)[()]


def _weighted_sum(
    integrand: _Integrand, lam: Floats, weight: Floats, x1: Floats, x2: Floats, r: Floats
) -> Floats:
    """Sum of weight * integrand over the nodes, for every point, a block of points at a time."""
    points = [array.reshape(-1, 1) for array in (x1, x2, r)]
    total = np.empty(x1.size)
    rows = max(1, _BLOCK // max(1, lam.size))
    for start in range(0, x1.size, rows):
        part = slice(start, start + rows)
        total[part] = integrand(lam, points[0][part], points[1][part], points[2][part]) @ weight
    return total.reshape(x1.shape)


def _lengths(shape: tuple[int, ...]) -> tuple[int, ...]:
    try:
        lengths = tuple(operator.index(n) for n in shape)
    except TypeError:
        lengths = ()
    if len(lengths) not in (1, 2) or min(lengths) < 1:
        raise InputError(
            "shape", expected="one or two positive lengths", got=repr(shape), advice="(200, 200)"
        )
    return lengths
