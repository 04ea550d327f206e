"""What else a contact measures: the rim of its area, how it resists more load, and what it conducts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from asperity.contact.active_set import ActiveSet
from asperity.contact.interface import Interface
from asperity.contact.mechanics import Prescribed
from asperity.contact.problem import PUBLISHED, Guess
from asperity.contact.system import System
from asperity.errors import InputError
from asperity.lattice import Lattice, Mask
from asperity.solids import Solid

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
    step, held = system.mechanics.implicit_step(0.0), Prescribed(1.0, 0.0)
    problem = replace(step.flat_problem(flat, 0.0, held).spectral(), interface=Interface(low=-math.inf))
    guess = Guess(np.zeros_like(flat), in_contact)
    u = ActiveSet().solve(problem, guess, PUBLISHED).u
    _, position = step.stretch_modes(system.mechanics.lattice.forward(u), step.flat_modes(0.0), held)
    return -1.0 / position if position < 0 else math.inf


def resistance(solid: Solid, lattice: Lattice, stiffness: float, resistivity: tuple[float, float]) -> float:
    r"""Constriction resistance of a contact, from its normal stiffness k_n.

    1 / R = 2 k_n / (E* (rho_1 + rho_2)), with the resistivities of the two half-spaces (J. R. Barber, Proc.
    R. Soc. A 459, 53 (2003), DOI 10.1098/rspa.2002.1038); of one disc R is (rho_1 + rho_2) / (4 a), as R.
    Holm has it.
    """
    modulus = check_half_space("resistance", solid, lattice)
    return modulus * sum(resistivity) / (2 * stiffness) if stiffness > 0 else math.inf


def check_half_space(name: str, solid: Solid, lattice: Lattice) -> float:
    """Contact modulus of a half-space; `InputError` for what has not the compliance of one."""
    if solid.modulus is not None and solid.half_space and lattice.dimension == 2:
        return solid.modulus
    raise InputError(
        name,
        expected="a half-space under a surface of two dimensions, whose normal displacements tell it",
        got="a line contact" if lattice.dimension == 1 else f"a {solid.kind.replace('_', ' ')}",
        advice="asperity.solids.half_space(modulus=...)",
    )


def shear_ratio(poisson: float | None) -> float:
    """Tangential over normal stiffness of a contact on a half-space, 2 (1 - nu) / (2 - nu).

    K. L. Johnson, *Contact Mechanics* (Cambridge 1985), section 7.2. `InputError` without Poisson's ratio.
    """
    if poisson is None:
        expected, advice = "Poisson's ratio, which displacements under shear depend on", "poisson=0.3"
        raise InputError("poisson", expected=expected, got="none", advice=advice)
    return 2 * (1 - poisson) / (2 - poisson)
