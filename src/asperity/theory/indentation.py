r"""One contact under constant load: the compliance of a site, and how it grows.

A force f0 pushes one site from t = 0 on. The paper's Eqs. (uq) and (u) give the depth f0 G / k0 with

    G(x1, x2) = < [1 + (x1/lam) (1 - exp(-x2 z))] / (x1 + lam) >,   z = x1 lam (lam + r) / (x1 + lam)

with x1 = k1/k0, x2 = k0 R t, r = R_tilde/R (Eq. dosrs; 0 in the body of the paper), the brackets being
the mean over the Brillouin zone. Source: E. A. Jagla, *Towards a modeling of the time dependence of
contact area between solid bodies*, Eqs. (uq), (u), (v0), (dosrs) and the figure of G.

Where this differs from the letter of the paper:

* The paper writes q^2 for lam(q). Its constant a1 = 0.3 shows that the lattice's lam was computed: a q^2
  dispersion on the square zone gives [4 ln(2 pi) + gamma_E - 8 K/pi]/(8 pi) = 0.2227 (K: Catalan's
  constant).
* It treats a contact as a bare spring k1. A site also drags its neighbors: `site_stiffness`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipkm1

from asperity.base.checks import Floats, lattice_shape, line_or_plane, positive
from asperity.theory.modes import (
    Integrand,
    creep_numbers,
    depth,
    log_scale,
    sinking,
    torus_modes,
    weighted_sum,
)
from asperity.theory.panels import Dispersion, mean_nodes


def compliance(
    x1: ArrayLike,
    x2: ArrayLike,
    viscous: ArrayLike = 0.0,
    dimension: int = 2,
    *,
    dispersion: Dispersion = "lattice",
) -> Floats:
    """Return the paper's G(x1, x2), Eq. (u): compliance of one site, in units of 1/k0.

    Parameters
    ----------
    x1, x2, viscous, dimension
        k1/k0 above 0; k0 R t, the reduced time, and R_tilde/R (Eq. dosrs), not below 0; 2 (square lattice) or
        1 (line).
    dispersion
        What lam(q) is: that of the ``"lattice"``; of the ``"continuum"``, q^2 on the zone of components
        between -pi and pi, as the paper writes; or a function ``lam(qx, qy)`` (on the line, ``lam(q)``) of
        arrays of one shape, even in each component, above 0 but for lam(0) = 0.

    The relative error is below 1e-14 for x1 from 1e-3 to 1e4, x2 from 0 to 1e15, viscous from 0 to 1e6. For
    other dispersions, smooth within the zone except at q = 0, it is below 1e-13.
    """
    return _zone_mean(depth, x1, x2, viscous, dimension, dispersion)


def compliance_rate(
    x1: ArrayLike,
    x2: ArrayLike,
    viscous: ArrayLike = 0.0,
    dimension: int = 2,
    *,
    dispersion: Dispersion = "lattice",
) -> Floats:
    """Return G'(x1, x2) = dG/dx2 of Eq. (v0), as `compliance`: the site sinks at the speed v0 = f0 R G'."""
    return _zone_mean(sinking, x1, x2, viscous, dimension, dispersion)


def torus_compliance(
    x1: ArrayLike, x2: ArrayLike, shape: tuple[int, ...], viscous: ArrayLike = 0.0
) -> Floats:
    """Compliance k0 J_L of one contact on a finite periodic lattice: the mean over its modes.

    The height of the contact above the mean of u0 is F J_L(t). The mode q = 0 adds 1/(k1 N) at all times,
    with R_tilde as well: R_tilde moves the mean of u0, which the height is measured from.

    Parameters
    ----------
    x2
        k0 R t; infinite gives the relaxed state.
    shape
        Sites along each axis: ``(n,)`` or ``(n, m)``.
    """
    lengths = lattice_shape(shape)
    lam, count = torus_modes(lengths)
    sites = math.prod(lengths)
    first, time, r = creep_numbers(x1, x2, viscous, infinity="welcome")
    waves = weighted_sum(depth, lam, count / sites, first, time, r)
    return np.asarray(1 / (first * sites) + waves)[()]


def site_stiffness(x1: ArrayLike, dimension: int = 2) -> Floats:
    """Stiffness of one site before any creep, k_eff/k0 = 1 / G(x1, 0).

    On the square lattice pi (x1 + 4) / (2 K(m)) with m = (4/(x1 + 4))^2, on the line sqrt(x1 (x1 + 4)). The
    paper takes k1, that is x1. This is too small by 27 % at x1 = 10 and by a factor of almost four at x1 = 1.
    """
    first = positive("x1", x1)
    if line_or_plane(dimension) == 1:
        return np.sqrt(first * (first + 4))[()]
    # K by 1 - m, which keeps its digits where m is near 1, that is at small x1.
    rest = first * (first + 8) / (first + 4) ** 2
    return np.asarray(math.pi * (first + 4) / (2 * ellipkm1(rest)))[()]


def _zone_mean(
    integrand: Integrand,
    x1: ArrayLike,
    x2: ArrayLike,
    viscous: ArrayLike,
    dimension: int,
    dispersion: Dispersion,
) -> Floats:
    first, time, r = creep_numbers(x1, x2, viscous)
    dimension = line_or_plane(dimension)
    if first.size == 0:
        return np.zeros(first.shape)
    lam, weight = mean_nodes(dispersion, dimension, log_scale(first, time, r))
    return weighted_sum(integrand, lam, weight, first, time, r)[()]
