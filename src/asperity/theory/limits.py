"""Limits that are known in closed form: every site in contact, contacts that all flow, or yield in shear.

With u = xi everywhere, the contact force of a site is (paper Eq. us, signs as in a force on the rough body)

    before creep    r = F/N + k1 (xi - mean xi) - k0 Lap xi
    relaxed         r = F/N - k0 Lap xi

(relaxed, each vertical spring carries F/N: paper, text below Eq. u0s), and full contact needs r >= 0
everywhere.
"""

from __future__ import annotations

import numpy as np
import scipy.ndimage
from numpy.typing import ArrayLike

from asperity.base import checks
from asperity.base.checks import Floats, broadcast, not_negative, positive, positives


def full_contact_load(heights: ArrayLike, *, k0: float, k1: float) -> float:
    """Smallest load F with every site in contact before any creep: N max[k1 (mean xi - xi) + k0 Lap xi].

    Parameters
    ----------
    heights
        Surface xi (length), shape (n,) or (n, m), periodic.
    k0, k1
        Stiffness between neighbors, not below 0, and of the vertical springs, above 0 (force per length).
    """
    xi = checks.heights("heights", heights)
    lateral, vertical = checks.number("k0", k0, least=0), checks.number("k1", k1, above=0)
    return xi.size * float(np.max(vertical * (np.mean(xi) - xi) + lateral * _laplacian(xi)))


def full_contact_load_relaxed(heights: ArrayLike, *, k0: float) -> float:
    """Smallest load F with every site in contact after all creep (R_tilde = 0): N k0 max Lap xi.

    It is 0 for k0 = 0, where creep makes every load enough.
    """
    xi = checks.heights("heights", heights)
    return xi.size * checks.number("k0", k0, least=0) * float(np.max(_laplacian(xi)))


def _laplacian(xi: Floats) -> Floats:
    """Sum over the nearest neighbors of the difference to them, periodic."""
    return np.asarray(scipy.ndimage.laplace(xi, mode="wrap"))


def flowing_area(time: ArrayLike, *, load: float, area: float, at: float, stress: float) -> Floats:
    r"""Return the area of contacts that flow by Eyring's law v0 sinh(s/s0), through one value of it.

    A contact that has flowed for a time t over a length L bears s = s0 ln(2 L/(v0 t)), which falls by s0 in
    every e-fold of time. If such contacts bear all of the load F, their area is F/s, and

        B = d ln A / d ln t = s0/s,        1/A(t) = 1/A(t1) - (s0/F) ln(t/t1).

    Parameters
    ----------
    time
        Times t > 0.
    load, area, at, stress
        F; A(t1); t1; s0, a pressure.

    Returns
    -------
    ndarray
        Shape of ``time``; infinite from the time on at which s has come down to 0, long before which the
        law of sinh ends this.

    Notes
    -----
    Contacts that do not flow yet bear a part of the load without growing, so B is at most s0/s.
    """
    t, force, first, since, scale = positives(time=time, load=load, area=area, at=at, stress=stress)
    inverse = 1 / first - scale / force * np.log(t / since)
    return np.divide(1.0, inverse, out=np.full_like(inverse, np.inf), where=inverse > 0)[()]


def static_friction(area: ArrayLike, load: ArrayLike, shear_strength: ArrayLike) -> Floats:
    """Return the coefficient of static friction, mu_s = sigma_S A / F_N.

    Contacts yield in shear at a force proportional to the real contact area (F. P. Bowden and D. Tabor, *The
    Friction and Lubrication of Solids*, Oxford, 1950; paper, Summary).

    The real contact area A and sigma_S (force per area) are not below 0, in one unit of area; in sites, say.
    The load F_N (force) is above 0.
    """
    touching, force, strength = broadcast(
        area=not_negative("area", area),
        load=positive("load", load),
        shear_strength=not_negative("shear_strength", shear_strength),
    )
    return np.asarray(strength * touching / force)[()]
