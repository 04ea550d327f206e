"""Sums of fields, and forces and energies of the lattice of springs, by compiled loops."""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact import kernels
from asperity.lattice import Field


def combined(*terms: tuple[float, Field]) -> Field:
    """Sum of two or three multiples of fields, in one pass through memory."""
    shape = terms[0][1].shape
    known = [(float(factor), np.atleast_2d(np.ascontiguousarray(field))) for factor, field in terms]
    total = np.empty_like(known[0][1])
    kernel: Any = kernels.combine_2 if len(known) == 2 else kernels.combine_3
    kernel(*(item for term in known for item in term), total, 0, len(total))
    return total.reshape(shape)


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
