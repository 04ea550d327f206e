"""Which solver a system gets when none is asked for."""

from __future__ import annotations

from asperity.contact.active_set import ActiveSet
from asperity.contact.multigrid import Multigrid
from asperity.contact.problem import ContactSolver
from asperity.contact.system import System


def usual_solver(system: System) -> ContactSolver:
    """`Multigrid` where neighbors say all there is to say, else `ActiveSet`."""
    suits = Multigrid.suits(system.springs, system.lattice.shape)
    return Multigrid() if suits else ActiveSet()
