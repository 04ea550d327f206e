"""Load at which every site of a given surface touches: exact, for any periodic surface.

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
from asperity.base.checks import Floats


def full_contact_load(heights: ArrayLike, *, k0: float, k1: float) -> float:
    """Smallest load F with every site in contact before any creep: N max[k1 (mean xi - xi) + k0 Lap xi].

    Parameters
    ----------
    heights
        Surface xi (length), shape (n,) or (n, m), periodic.
    k0
        Stiffness between neighbors (force per length), not below 0.
    k1
        Stiffness of the vertical springs (force per length), above 0.

    Returns
    -------
    float
        Load (force); 0 for a flat surface.

    Raises
    ------
    InputError
        For heights that are not a finite array of one or two dimensions, or a stiffness out of range.
    """
    xi = checks.heights("heights", heights)
    lateral, vertical = checks.number("k0", k0, least=0), checks.number("k1", k1, above=0)
    return xi.size * float(np.max(vertical * (np.mean(xi) - xi) + lateral * _laplacian(xi)))


def full_contact_load_relaxed(heights: ArrayLike, *, k0: float) -> float:
    """Smallest load F with every site in contact after all creep (R_tilde = 0): N k0 max Lap xi.

    Arguments, result (0 also for k0 = 0, where creep makes every load enough) and errors are those of
    `full_contact_load`.
    """
    xi = checks.heights("heights", heights)
    return xi.size * checks.number("k0", k0, least=0) * float(np.max(_laplacian(xi)))


def _laplacian(xi: Floats) -> Floats:
    """Sum over the nearest neighbors of the difference to them, periodic."""
    return np.asarray(scipy.ndimage.laplace(xi, mode="wrap"))
