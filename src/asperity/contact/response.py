"""What else a contact measures: the rim of its area, and how stiffly it resists a little more load."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from asperity.contact.active_set import ActiveSet
from asperity.contact.interface import Interface
from asperity.contact.mechanics import Prescribed
from asperity.contact.problem import TOLERANCE, Guess
from asperity.contact.system import System
from asperity.lattice import Lattice, Mask

RIM = (math.pi - 1 + math.log(2)) / 24
"""Part of the area of a site by which each of its sides on the rim overestimates a smooth contact.

V. A. Yastrebov, G. Anciaux, J.-F. Molinari, Tribol. Int. 114, 161 (2017), DOI 10.1016/j.triboint.2017.04.023.
"""


def rim_sides(in_contact: Mask, lattice: Lattice) -> int:
    """Number of pairs of neighbors of which one is in contact, over periodic edges too."""
    sides = 0
    for axis in range(lattice.dimension):
        differ = in_contact != np.roll(in_contact, 1, axis)
        if lattice.edges != "periodic":
            differ = differ[(slice(None),) * axis + (slice(1, None),)]
        sides += int(np.count_nonzero(differ))
    return sides


def normal_stiffness(system: System, in_contact: Mask) -> float:
    """Increase of the load per approach of the rigid body, at once, the contacts staying what they are.

    The contacts, one rigid punch, are pressed with a unit of load.
    """
    if not in_contact.any():
        return 0.0
    flat = np.where(in_contact, 0.0, -np.inf)
    step = system.mechanics.spectral.implicit_step(0.0)
    problem = replace(step.problem(flat, 0.0, Prescribed(1.0, 0.0)), interface=Interface(low=-math.inf))
    guess = Guess(np.zeros_like(flat), in_contact)
    u = ActiveSet().solve(problem, guess, TOLERANCE).u
    _, position = step.stretch(u, 0.0, Prescribed(1.0, 0.0))
    return -1.0 / position if position < 0 else math.inf
