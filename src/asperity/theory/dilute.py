r"""Few contacts, far apart: the contact area of any law of heights, at any time.

Asperities that do not influence each other share the load as in Greenwood and Williamson's theory, with the
creep compliance J(t) = G/k0 for the elastic one:

    N0 E[(xi - d)+] = F J(t),      A = N0 Prob(xi > d)

with N0 sites and d the height of the mean of u0 (rigid offset). At constant load d only falls, so no contact
opens, the problem is linear, and history does not matter (E. H. Lee and J. R. M. Radok, J. Appl. Mech. 27,
438 (1960), doi:10.1115/1.3644020). For any other load: `population`.

Corrections to the paper (E. A. Jagla, section "Analytical Results"):

* Eq. (ndet) is dimensionally inconsistent, for v0 of Eq. (v0) contains f0. It should read
  N(t)/N(0) = 1 + (k_eff/f0) int v0 dt, with the stiffness k_eff = k0/G(x1, 0) of a site, not a spring k1.
  Together N(t)/N(0) = G(x1, x2)/G(x1, 0): `exponential_growth`.
  The paper's own expression, with f0 divided out, is `exponential_growth_paper`.
  In the same way N(0) is gamma F/k_eff, `contacts_at_start`, not gamma F/k1, `contacts_at_start_paper`.
* The late slope dN/N(0)/d ln t is k_eff/(8 pi k0), not a0 k1/k0 of Eq. (ndet2): `late_slope`,
  `late_slope_paper`.
* Eq. (vt) leaves out the instantaneous term f'(t) G(0)/k0, and the minus sign of Eq. (du0) is lost after it.
  Neither changes dN/dt: the first cancels in the sum over contacts at constant load, the second occurs twice.
  `response_rate` has both readings of the first.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.base.checks import Floats, line_or_plane, positive, positives
from asperity.errors import InputError
from asperity.theory.heights import HeightLaw
from asperity.theory.indentation import compliance, site_stiffness


def dilute_area(load_per_site: ArrayLike, compliance: ArrayLike, heights: HeightLaw) -> Floats:
    """Return the fraction of sites in contact, A/N0, in the dilute theory.

    Parameters
    ----------
    load_per_site
        F/N0 (force), above 0.
    compliance
        J(t) = `compliance(x1, x2) / k0` (length per force), above 0; one entry a time, say.
    heights
        Law of the heights, lengths in the same unit.

    Trust it while the contacts are apart: see `dilute_horizon`.
    """
    load, soft = positives(load_per_site=load_per_site, compliance=compliance)
    return heights.exceedance(heights.separation_for(load * soft))


def winkler_area(load_per_site: ArrayLike, k1: ArrayLike, heights: HeightLaw) -> Floats:
    """Return the fraction of sites in contact on independent springs (k0 = 0), A/N0; exact at every load.

    Without k0 nothing limits the creep, and the area of the relaxed state is the nominal one: this is the
    area before any creep.

    Parameters
    ----------
    k1
        Stiffness of a spring (force per length), above 0.
    """
    return dilute_area(load_per_site, 1 / positive("k1", k1), heights)


def dilute_horizon(area_fraction: ArrayLike, dimension: int = 2) -> Floats:
    """Reduced time k0 R t at which the dips around neighboring contacts meet.

    The dip that a contact makes spreads over a distance that grows as (k0 R t)^(1/4); the mean spacing of
    contacts is (A/N0)^(-1/dimension). They are equal at k0 R t = (A/N0)^(-4/dimension): an order of
    magnitude, no sharp end. It leaves out R_tilde, with which dips spread as (k0 R_tilde t)^(1/2).

    The fraction A/N0 is above 0 and at most 1.
    """
    fraction = positive("area_fraction", area_fraction)
    if (fraction > 1).any():
        raise InputError("area_fraction", expected="at most 1", got=float(fraction.max()), advice="A/N0")
    return np.asarray(fraction ** (-4 / line_or_plane(dimension)))[()]


def contacts_at_start(
    load: ArrayLike, rms: ArrayLike, x1: ArrayLike, *, k0: ArrayLike, dimension: int = 2
) -> Floats:
    """Return N(0) = F / (rms k_eff): contacts of exponential heights before any creep, in the dilute theory.

    F is the load on the whole surface (force), rms = 1/gamma of the paper's P(xi) (length), see
    `ExponentialHeights`, and k0 the stiffness between neighbors (force per length), all above 0.

    It holds while it is small against the number of sites, which is not an argument. The mean over surfaces
    is larger by one contact, because one site touches at no load.
    """
    force, length, first, lateral = positives(load=load, rms=rms, x1=x1, k0=k0)
    return np.asarray(force / (length * lateral * site_stiffness(first, dimension)))[()]


def contacts_at_start_paper(load: ArrayLike, rms: ArrayLike, x1: ArrayLike, *, k0: ArrayLike) -> Floats:
    """Return gamma F/k1, gamma = 1/rms: the N(t=0) that the paper gives below Eq. (ndet).

    Only for comparison with the paper. It takes k1 for the stiffness of a contact, which makes contacts too
    many by the factor site_stiffness(x1) / x1; `contacts_at_start` does not.
    """
    force, length, first, lateral = positives(load=load, rms=rms, x1=x1, k0=k0)
    return np.asarray(force / (length * lateral * first))[()]


def exponential_growth(x1: ArrayLike, x2: ArrayLike, viscous: ArrayLike = 0.0, dimension: int = 2) -> Floats:
    """Return A(t)/A(0) = G(x1, x2)/G(x1, 0): the dilute theory of exponential heights.

    The paper's Eq. (ndet), made dimensionally consistent and with the stiffness of a lattice site. The late d
    ln A / d ln t is 1/(ln x2 + 10 ln 2 + gamma_E) on the square lattice, without material parameters.
    """
    return np.asarray(compliance(x1, x2, viscous, dimension) * site_stiffness(x1, dimension))[()]


def exponential_growth_paper(
    x1: ArrayLike, x2: ArrayLike, viscous: ArrayLike = 0.0, dimension: int = 2
) -> Floats:
    """Return N(t)/N(0) = 1 + (k1/k0) [G(x1, x2) - G(x1, 0)]: the paper's Eq. (ndet), f0 divided out.

    Only for comparison with the paper. It takes k1 for the stiffness of a contact, which makes the growth too
    small by the factor x1 / site_stiffness(x1); `exponential_growth` does not.
    """
    grown = compliance(x1, x2, viscous, dimension) - 1 / site_stiffness(x1, dimension)
    return np.asarray(1 + positive("x1", x1) * grown)[()]
