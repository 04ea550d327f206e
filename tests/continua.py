"""Contacts of continua on lattices of any spacing and edges, made by hand; and the creep of branches."""

import numpy as np

from asperity.contact.bodies import Bodies
from asperity.contact.controls import control_from
from asperity.contact.instantaneous import first_contact
from asperity.lattice import Lattice


def pressed(heights, solid, *, load=None, separation=None, spacing=(), edges="periodic"):
    """Press a solid onto heights whose sites have a spacing, in any one unit of length."""
    heights = np.ascontiguousarray(heights, dtype=float)
    bodies = Bodies(heights, Lattice(heights.shape, spacing, edges), solid, {}, False)
    return first_contact(bodies, control_from(load, separation), start=None, solver=None)
