"""The rim of a contact, by which counting sites overestimates its area."""

from __future__ import annotations

import math

import numpy as np

from asperity.lattice import Lattice, Mask

RIM = (math.pi - 1 + math.log(2)) / 24
"""Part of the area of a square site by which each of its sides on the rim overestimates a smooth contact.

V. A. Yastrebov, G. Anciaux, J.-F. Molinari, Tribol. Int. 114, 161 (2017), DOI 10.1016/j.triboint.2017.04.023.
"""


def rim_sides(in_contact: Mask, lattice: Lattice, body: Mask | None = None) -> float:
    """Length of the sides between sites of the body of which one is in contact, over periodic edges too.

    The unit is the side of a square site of the same area: where rims have all directions, oblong sites
    overestimate as square ones do. A contact that ends where the body does is counted exactly.
    """
    sides = 0.0
    for axis, step in enumerate(lattice.spacing):
        differ = in_contact != np.roll(in_contact, 1, axis)
        if body is not None:
            differ &= body & np.roll(body, 1, axis)
        if lattice.edges != "periodic":
            differ = differ[(slice(None),) * axis + (slice(1, None),)]
        sides += int(np.count_nonzero(differ)) * math.sqrt(lattice.cell) / step
    return sides
