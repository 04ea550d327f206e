r"""Contacts on coarse grids: springs that get softer from grid to grid.

A contact holds the surface at one site. A grid of spacing 2^l cannot represent the dip around it, so
there the contact is a spring of finite stiffness, the one that makes the grid respond like the sites
do. In units of k0, a surface of stiffness S fixed at a random fraction a of its sites responds on
average like one of stiffness S + sigma, where sigma is the coherent potential,

    sigma G_0(sigma) = a,     G_l(sigma) = mean_q 1 / (S_l(q) + sigma),

S_l being S as grid l sees it (compare `asperity.contact.pinning`). A contact is then a spring p_l on
grid l with

    1 / p_(l+1) = 1 / p_l + G_l(sigma_l) - G_(l+1)(4 sigma_l),     1 / p_0 = 0,

sigma_l = 4^l sigma, the mean stiffness of the springs on a site of grid l: far up, the springs of N a
contacts add up to N sigma, the response of the whole. Only what stands out from the mean softens; and
nothing where all sites that share a coarse one are held, for no correction of that one moves any of them.

G is known in closed form. Off the mean square lattice, mean_q 1/(lam + x) = 1 / AGM(x + 4, sqrt(x (x + 8)))
(the elliptic integral of `asperity.theory.site_stiffness`, by the arithmetic-geometric mean), and S of a
creep step is a ratio of polynomials in lam, so that 1/(S + sigma) is a sum of two such terms.
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass

from asperity.solids import Springs


@dataclass(frozen=True)
class Tuning:
    """What decides how soft contacts are on coarse grids."""

    shared: float = 1.5
    """Factor on the softening: interpolation shares a contact among up to four springs that soften less.
    With it the springs of random contacts add up to N sigma."""


TUNING = Tuning()


def compliance(springs: Springs, level: int, sigma: float) -> float:
    """G_l(sigma), the compliance of a site of a coarse grid, in a step of springs in units of k0."""
    mass = 4.0**level
    bed, lag = springs.k1 * mass, 1.0 + springs.drag
    huge = 1e6  # stiffness on a site, in units of k0, beyond which its neighbors do not matter
    if bed / lag + sigma > huge:
        return 1.0 / (bed / lag + sigma + 4.0)
    spread = springs.spread / mass
    if spread * (8.0 + huge) < 1e-12 * lag:
        return _mean_inverse(bed / lag + sigma).real
    # 1/(S + sigma) = (lag + spread lam) / (spread (lam + x)(lam + y))
    linear = (lag + sigma * spread) / spread
    constant = (bed + sigma * lag) / spread
    x = (linear + cmath.sqrt(linear**2 - 4.0 * constant)) / 2.0
    y = constant / x
    if abs(x - y) < 1e-6 * abs(x):
        x, y = x * (1.0 + 1e-5), y * (1.0 - 1e-5)
    ratio = lag / spread
    return (((ratio - x) * _mean_inverse(x) - (ratio - y) * _mean_inverse(y)) / (y - x)).real


def softening(springs: Springs, level: int, sigma: float) -> float:
    """1 / p_(l+1) - 1 / p_l."""
    change = compliance(springs, level, sigma) - compliance(springs, level + 1, 4.0 * sigma)
    return max(TUNING.shared * change, 1e-9)


def _mean_inverse(x: complex) -> complex:
    """Mean of 1/(lam + x) over the Brillouin zone of the square lattice, for Re x > 0."""
    a, b = x + 4.0, cmath.sqrt(x) * cmath.sqrt(x + 8.0)
    while abs(a - b) > 1e-7 * abs(a):
        a, b = (a + b) / 2.0, cmath.sqrt(a) * cmath.sqrt(b)
    return 1.0 / a
