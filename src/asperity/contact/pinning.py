r"""How strongly the contacts pin the surface, on average: the preconditioner's one number.

A free surface of stiffness S, fixed at a random fraction a of its sites, responds on average like a
surface of stiffness S + sigma. The coherent-potential condition for sigma is

    sigma * mean_q [ 1 / (S(q) + sigma) ] = a,

whose left side rises from 0 to 1 with sigma: one root, no parameter. (Coherent potential: P. Soven,
Phys. Rev. 156, 809 (1967), DOI 10.1103/PhysRev.156.809; B. Velicky, S. Kirkpatrick, H. Ehrenreich,
Phys. Rev. 175, 747 (1968), DOI 10.1103/PhysRev.175.747.)
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from asperity.lattice import Lattice, Spectrum

_SAMPLES = 2048
"""Modes looked at: sigma need only be good to some ten percent, and costs less than a transform so."""


def effective_pinning(lattice: Lattice, stiffness: Spectrum, contact_fraction: float) -> float:
    """Sigma for a stiffness spectrum and a fraction 0 < a <= 1 of sites in contact; same unit as S."""
    stride = max(1, stiffness.size // _SAMPLES) | 1  # odd: never in step with the rows of the lattice
    sample = stiffness.ravel()[::stride]
    weight = np.broadcast_to(lattice.multiplicity, stiffness.shape).ravel()[::stride].copy()
    # The mode at wave vector 0 stands for itself alone: with few contacts it decides.
    weight[1:] *= (lattice.sites - weight[0]) / max(weight[1:].sum(), 1.0)
    weight /= weight.sum()
    stiffest = float(sample.max())
    if stiffest == 0:
        return 1.0

    def excess(log_sigma: float) -> float:
        sigma = np.exp(log_sigma)
        return float(np.dot(weight, sigma / (sample + sigma))) - contact_fraction

    low, high = np.log(stiffest) - 40.0, np.log(stiffest) + 20.0
    if excess(low) >= 0:
        return float(np.exp(low))
    if excess(high) <= 0:
        return float(np.exp(high))
    return float(np.exp(brentq(excess, low, high, xtol=0.05)))
