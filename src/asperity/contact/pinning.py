r"""The mean stiffness with which contacts pin the surface, for the preconditioner.

A free surface of stiffness S, fixed at a random fraction a of its sites, responds on average like a
surface of stiffness S + sigma. The coherent-potential condition for sigma is

    sigma * mean_q [ 1 / (S(q) + sigma) ] = a,

whose left side rises from 0 to 1 with sigma: one root, no parameter. (Coherent potential: P. Soven,
Phys. Rev. 156, 809 (1967), DOI 10.1103/PhysRev.156.809; B. Velicky, S. Kirkpatrick, H. Ehrenreich,
Phys. Rev. 175, 747 (1968), DOI 10.1103/PhysRev.175.747.)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from asperity.lattice import Lattice, Spectrum


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    samples: int = 2048
    """Modes looked at: sigma need only be good to some ten percent, and costs less than a transform so."""

    closeness: float = 0.05
    """Error of ln sigma."""

    lowest: float = 40.0
    highest: float = 20.0
    """How far ln sigma is looked for below and above that of the largest stiffness."""


TUNING = Tuning()

_PLASTIC = sum(((9 + sign * math.sqrt(69)) / 18) ** (1 / 3) for sign in (1, -1))
_STEPS = (1 / _PLASTIC, 1 / _PLASTIC**2)
"""Powers of the plastic number, the real root of x^3 = x + 1."""


def effective_pinning(lattice: Lattice, stiffness: Spectrum, contact_fraction: float) -> float:
    """Sigma for a stiffness spectrum and a fraction 0 < a <= 1 of sites in contact; same unit as S."""
    modes = _spread_modes(stiffness.shape)
    sample = stiffness[modes]
    weight = np.broadcast_to(lattice.multiplicity, stiffness.shape)[modes]
    # The mode at wave vector 0 stands for itself alone: with few contacts it decides.
    weight[1:] *= (lattice.sites - weight[0]) / max(weight[1:].sum(), 1.0)
    weight /= weight.sum()
    stiffest = float(sample.max())
    if stiffest == 0:
        return 1.0

    return coherent_potential(lambda x: float(np.dot(weight, 1 / (sample + x))), contact_fraction, stiffest)


def coherent_potential(compliance: Callable[[float], float], fraction: float, stiffest: float) -> float:
    """Sigma for the compliance of a site, a function of sigma, and a fraction 0 < a <= 1 of contacts."""

    def excess(log_sigma: float) -> float:
        sigma = math.exp(log_sigma)
        return sigma * compliance(sigma) - fraction

    low, high = math.log(stiffest) - TUNING.lowest, math.log(stiffest) + TUNING.highest
    if excess(low) >= 0:
        return math.exp(low)
    if excess(high) <= 0:
        return math.exp(high)
    return math.exp(scipy.optimize.brentq(excess, low, high, xtol=TUNING.closeness))


@lru_cache
def _spread_modes(shape: tuple[int, ...]) -> tuple[NDArray[np.intp], ...]:
    """Indices of modes spread evenly over a spectrum, that of wave vector 0 first; all, if they are few.

    A stride through the flat array comes into step with rows of some lengths; multiples of irrational numbers
    do not.
    """
    if math.prod(shape) <= TUNING.samples:
        return np.unravel_index(np.arange(math.prod(shape)), shape)
    count = np.arange(TUNING.samples)
    places = tuple((count * step % 1.0 * n).astype(int) for step, n in zip(_STEPS, shape, strict=False))
    return np.unravel_index(np.unique(np.ravel_multi_index(places, shape)), shape)
