"""Multigrid for the lattice of springs: kernels, coarse grids, pins, and the two problems solved."""

from asperity.contact.multigrid.solver import Multigrid

__all__ = ["Multigrid"]
