"""Multigrid for the lattice of springs: coarse grids, pins on them, and the two problems solved."""

from asperity.contact.multigrid.solver import Multigrid as Multigrid
