r"""Late times: what `compliance` and the dilute theory tend to, beside the numbers that the paper gives.

Source: E. A. Jagla, *Towards a modeling of the time dependence of contact area between solid bodies*, the
figure of G, Eq. (ndet2) and the Summary ("t^(1/4)").
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import gamma

from asperity.base.checks import Floats, broadcast, line_or_plane, positive
from asperity.errors import InputError
from asperity.theory.indentation import site_stiffness
from asperity.theory.modes import mobility_ratio

#: Slope of G in ln(k0 R t) at late times on the square lattice, without R_tilde; the paper's a0 = 0.04.
LATE_SLOPE = 1 / (8 * math.pi)
#: Its intercept at ln(k0 R t) = 0; the paper's a1 = 0.3.
LATE_INTERCEPT = (10 * math.log(2) + np.euler_gamma) / (8 * math.pi)

_PAPER_SLOPE, _PAPER_INTERCEPT = 0.04, 0.3


def compliance_asymptote(
    x2: ArrayLike, viscous: ArrayLike = 0.0, dimension: int = 2, x1: ArrayLike | None = None
) -> Floats:
    """Late-time form of `compliance`.

    The leading term does not depend on x1. It is, with r = `viscous`,

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

    Expand the integrand at small lam at fixed x2 lam^2 (r = 0) or r x2 lam (r > 0). The terms of the paper
    are the first and third line of the first list (Fig. of G; Summary, "t^(1/4)").
    """
    dimension = line_or_plane(dimension)
    ratio = positive("x1", 1.0 if x1 is None else x1)
    first, time, r = broadcast(x1=ratio, x2=positive("x2", x2), viscous=mobility_ratio(viscous))
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
    following = 0.0 if x1 is None else np.where(r > 0, flowing_next, creeping_next)
    return np.asarray(np.where(r > 0, flowing, creeping) + following)[()]


def compliance_asymptote_paper(x2: ArrayLike) -> Floats:
    """Return 0.04 ln x2 + 0.3: the dotted line in the paper's figure of G, a0 and a1 rounded as printed.

    Only for comparison with the paper; `compliance_asymptote` has 1/(8 pi) = 0.03979 and 0.29876.
    """
    return np.asarray(_PAPER_SLOPE * np.log(positive("x2", x2)) + _PAPER_INTERCEPT)[()]


def late_slope(x1: ArrayLike, viscous: ArrayLike = 0.0, dimension: int = 2) -> Floats:
    """Late slope of the number of contacts, dN/N(0)/d ln t, in the dilute theory of exponential heights.

    k_eff/(8 pi k0), and k_eff/(4 pi k0) with R_tilde, however small: then wait for x2 >> 1/viscous^2. It is
    the slope of `exponential_growth`; `late_slope_paper` is the paper's Eq. (ndet2). In dimension 1 the
    growth is a power of time and has no such slope.
    """
    if line_or_plane(dimension) == 1:
        advice = "compliance_asymptote: on a line the growth is a power"
        raise InputError("dimension", expected="2", got=1, advice=advice)
    first, r = broadcast(x1=positive("x1", x1), viscous=mobility_ratio(viscous))
    return np.asarray(site_stiffness(first) * np.where(r > 0, 2 * LATE_SLOPE, LATE_SLOPE))[()]


def late_slope_paper(x1: ArrayLike) -> Floats:
    """Return 0.04 k1/k0, the slope in the paper's Eq. (ndet2), with its a0 as printed.

    Only for comparison with the paper. It takes k1 for the stiffness of a contact: too small by the factor
    x1 / site_stiffness(x1), see `late_slope`.
    """
    return np.asarray(_PAPER_SLOPE * positive("x1", x1))[()]
