"""Fields of the two-dimensional lattice of springs by neighbor differences, without transforms."""

from __future__ import annotations

import numpy as np

from asperity.contact import kernels
from asperity.lattice import Field


def lattice_force(u: Field, stretch: Field, k0: float, k1: float) -> Field:
    """Force k0 L u + k1 w at every site, L minus the Laplacian."""
    force = np.empty_like(u)
    kernels.lattice_force(u, stretch, k0, k1, force, 0, len(u))
    return force


def bond_energy(u: Field) -> float:
    """Sum over the bonds of the squared difference between neighbors."""
    rows = np.empty(len(u))
    kernels.bond_energy(u, rows, 0, len(u))
    return float(rows.sum())
