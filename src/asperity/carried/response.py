"""Stiffness, resistance and partial slip of a contact."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from weakref import WeakKeyDictionary

import numpy as np

from asperity.base import checks, units, views
from asperity.carried.shear import Shear, compliances, stiffness_along
from asperity.contact import ActiveSet, Contact
from asperity.contact.arrays import inverse
from asperity.contact.contact import Direction, Each
from asperity.contact.interface import Interface
from asperity.contact.partial_slip import PartialSlip
from asperity.contact.problem import PUBLISHED, Guess, SpectralProblem
from asperity.contact.rigid_body import Prescribed
from asperity.errors import InputError
from asperity.lattice import Field, Lattice, Mask, Spectrum
from asperity.solids import Solid

_RESPONSES: WeakKeyDictionary[Contact, tuple[float, float, Field]] = WeakKeyDictionary()
"""Results of `unit_response`, kept while the contact lives."""


def unit_response(contact: Contact) -> tuple[float, float, Field]:
    """Displacements of rigid body and mean surface under a unit of load, and the force of each site."""
    if contact not in _RESPONSES:
        _RESPONSES[contact] = _flat_punch(contact, contact.relative[2])
    return _RESPONSES[contact]


def _flat_punch(contact: Contact, in_contact: Mask) -> tuple[float, float, Field]:
    """The same for a rigid flat punch on these sites, on the solid of a contact."""
    flat = np.where(in_contact, 0.0, -np.inf)
    mechanics, held = contact.system().mechanics, Prescribed(1.0, 0.0)
    step, lattice = mechanics.implicit_step(0.0), mechanics.lattice
    u, force = _bonded(step.problem(flat, 0.0, held).spectral(), in_contact)
    _, position = step.stretch_modes(lattice.forward(u), step.modes_of(0.0), held)
    return -position, -float(u[np.isfinite(contact.system().heights)].mean()), lattice.cut(force)


def _bonded(problem: SpectralProblem, sites: Mask) -> tuple[Field, Field]:
    """Surface and forces where just these sites touch, in tension, too."""
    problem = replace(problem, interface=Interface(low=-math.inf))
    u = ActiveSet().solve(problem, Guess(np.zeros(sites.shape), sites), PUBLISHED).u
    return u, np.where(sites, problem.force(u), 0.0)


@views.defines(Contact._normal_stiffness)
def normal_stiffness(contact: Contact) -> float:
    """See `Contact.normal_stiffness`."""
    if not contact.area:
        return 0.0
    # Many contacts of a pull keep this number; the forces would take their memory.
    lowered = (_RESPONSES.get(contact) or _flat_punch(contact, contact.relative[2]))[0]
    return 1.0 / lowered if lowered > 0 else math.inf


def stiffness_of_contact(contact: Contact) -> float:
    """Normal stiffness without that of the apparatus, in series."""
    compliance = 1 / contact.normal_stiffness - 1 / (contact.solid.apparatus or math.inf)
    return 1 / compliance if compliance > 0 else math.inf


def punch(contact: Contact, in_contact: Mask) -> Field:
    """Share of each site in the load of a rigid punch on these sites, on the solid of a contact."""
    if not in_contact.any():
        return np.zeros(in_contact.shape)
    return _flat_punch(contact, contact.lattice.embedding.extended(in_contact, beyond=False))[2]


@views.defines(Contact.tangential_stiffness)
def tangential_stiffness(contact: Contact, poisson: float, direction: Direction | None = None) -> float:
    """See `Contact.tangential_stiffness`."""
    check_half_space("tangential_stiffness", contact.solid, contact.lattice)
    return stiffness_along(compliances(contact, poisson)[0], direction)


@views.defines(Contact.tangential_compliance)
def tangential_compliance(contact: Contact, poisson: float) -> Field:
    """See `Contact.tangential_compliance`."""
    check_half_space("tangential_compliance", contact.solid, contact.lattice)
    return np.array(compliances(contact, poisson)[0])


@views.defines(Contact.resistance)
def resistance(contact: Contact, resistivity: Each) -> float:
    """See `Contact.resistance`."""
    return _of_constrictions(contact, sum(_of_both("resistivity", resistivity, "ohm m", si=contact.si)))


@views.defines(Contact.thermal_resistance)
def thermal_resistance(contact: Contact, conductivity: Each) -> float:
    """See `Contact.thermal_resistance`."""
    first, second = _of_both("conductivity", conductivity, "W/m/K", si=contact.si)
    return _of_constrictions(contact, 1 / first + 1 / second)


def _of_constrictions(contact: Contact, resistivity: float) -> float:
    r"""Constriction resistance of a contact, from its normal stiffness k_n without an apparatus.

    1 / R = 2 k_n / (E* (rho_1 + rho_2)), with the sum of the resistivities of the two half-spaces (J. R.
    Barber, Proc. R. Soc. A 459, 53 (2003), DOI 10.1098/rspa.2002.1038); of one disc R is (rho_1 + rho_2) /
    (4 a), as R. Holm has it.
    """
    modulus = check_half_space("resistance", contact.solid, contact.lattice)
    return modulus * resistivity / (2 * stiffness_of_contact(contact)) if contact.area else math.inf


def _of_both(name: str, values: Each, unit: str, *, si: bool) -> tuple[float, float]:
    """Two numbers, one a body, from a pair or one for both."""
    pair = values if isinstance(values, list | tuple) else (values, values)
    if len(pair) != 2:
        raise InputError(name, expected="one number, or one of each body", got=checks.shown(values))
    a, b = (checks.number(name, units.converted(name, value, unit, si=si), above=0) for value in pair)
    return a, b


def check_half_space(name: str, solid: Solid, lattice: Lattice) -> float:
    """Contact modulus of a half-space; `InputError` for other solids."""
    if solid.modulus is not None and solid.half_space and lattice.dimension == 2:
        return solid.modulus
    got = "a line contact" if lattice.dimension == 1 else f"a {solid.kind.replace('_', ' ')}"
    advice = "" if lattice.dimension == 1 else "asperity.solids.half_space(modulus=...)"
    raise InputError(name, expected="a half-space under a surface of two dimensions", got=got, advice=advice)


def sheared(contact: Contact, shear: float | str, friction: float) -> tuple[float, float]:
    """Shear force, in the units of a contact, and coefficient of friction."""
    force = checks.number("shear", units.converted("shear", shear, "N", si=contact.si), above=0)
    return force, checks.number("friction", friction, above=0)


@views.defines(Contact.partial_slip)
def partial_slip(
    contact: Contact,
    shear: float | str,
    friction: float,
    poisson: float | None = None,
    direction: Direction = "x",
) -> PartialSlip:
    """See `Contact.partial_slip`."""
    check_half_space("partial_slip", contact.solid, contact.lattice)
    if contact.solid.adhesion is not None:
        raise InputError("partial_slip", expected="a solid without adhesion", got="one with adhesion")
    force, mu = sheared(contact, shear, friction)
    ratio = None if poisson is None else checks.number("poisson", poisson, above=-1, most=0.5)
    if force >= mu * contact.load:
        expected = f"less than friction times load, {mu * contact.load:.6g}: from there on the bodies slide"
        raise InputError("shear", expected=expected, got=f"{force:.6g}", advice="less shear, or more load")
    shear_of, touching = Shear.of(contact, ratio or 0.0), contact.relative[2]
    lattice, compliance = shear_of.lattice, shear_of.along(direction)
    most = mu * lattice.extended(contact.force, beyond=0.0)
    punch = np.where(touching, lattice.apply(compliance, most), -np.inf)
    left = max(mu * contact.load - force, float(np.finfo(float).eps) * mu * contact.load)
    problem = _problem(lattice, compliance, punch, left)
    solution = ActiveSet().solve(problem, Guess(np.zeros(lattice.shape), touching), PUBLISHED)
    stick = solution.in_contact
    traction = most - np.where(stick, problem.force(solution.u), 0.0)
    slipped = np.where(touching, solution.u - problem.heights, 0.0)
    return PartialSlip(
        *(force, mu, lattice.cut(stick), lattice.cut(touching & ~stick)),
        lattice.cut(traction) / lattice.cell,
        ratio,
        float(lattice.apply(compliance, traction)[stick].mean()),
        4 * float(np.vdot(most, slipped)),
        partial(_stiffness_together, lattice, compliance, stick),
    )


def _problem(lattice: Lattice, compliance: Spectrum, heights: Field, load: float) -> SpectralProblem:
    """The contact problem of a compliance under a load."""
    stiffness, right = inverse(compliance), lattice.flat_modes(-load / lattice.sites)
    stiffness.flat[0] = 0.0
    return SpectralProblem(lattice, heights - heights.max(), stiffness, right)


def _stiffness_together(lattice: Lattice, compliance: Spectrum, sites: Mask) -> float:
    """Stiffness of sites that are displaced together."""
    if sites.all():
        return math.inf
    _, force = _bonded(_problem(lattice, compliance, np.where(sites, 0.0, -np.inf), 1.0), sites)
    return 1 / float(lattice.apply(compliance, force)[sites].mean())
