"""Stiffness, resistance and partial slip of a contact."""

from __future__ import annotations

import math
from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from asperity.base import checks, units, views
from asperity.contact import ActiveSet, Contact, Load
from asperity.contact.contact import Each
from asperity.contact.instantaneous import pressed_anew
from asperity.contact.interface import Interface
from asperity.contact.partial_slip import PartialSlip, shear_ratio
from asperity.contact.problem import PUBLISHED, Guess
from asperity.contact.rigid_body import Prescribed
from asperity.errors import InputError
from asperity.lattice import Field, Lattice, Mask
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
    problem = replace(step.flat_problem(flat, 0.0, held).spectral(), interface=Interface(low=-math.inf))
    u = ActiveSet().solve(problem, Guess(np.zeros_like(flat), in_contact), PUBLISHED).u
    _, position = step.stretch_modes(lattice.forward(u), step.flat_modes(0.0), held)
    force = np.where(in_contact, problem.force(u), 0.0)
    return -position, -float(u[np.isfinite(contact.system().heights)].mean()), lattice.cut(force)


@views.defines(Contact._normal_stiffness)
def normal_stiffness(contact: Contact) -> float:
    """See `Contact.normal_stiffness`."""
    lowered = unit_response(contact)[0] if contact.area else math.inf
    return 1.0 / lowered if lowered > 0 else math.inf


def punch(contact: Contact, in_contact: Mask) -> Field:
    """Share of each site in the load of a rigid punch on these sites, on the solid of a contact."""
    if not in_contact.any():
        return np.zeros(in_contact.shape)
    return _flat_punch(contact, contact.lattice.embedding.extended(in_contact, beyond=False))[2]


@views.defines(Contact.tangential_stiffness)
def tangential_stiffness(contact: Contact, poisson: float) -> float:
    """See `Contact.tangential_stiffness`."""
    check_half_space("tangential_stiffness", contact.solid, contact.lattice)
    return shear_ratio(checks.number("poisson", poisson, above=-1, most=0.5)) * contact.normal_stiffness


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
    r"""Constriction resistance of a contact, from its normal stiffness k_n.

    1 / R = 2 k_n / (E* (rho_1 + rho_2)), with the sum of the resistivities of the two half-spaces (J. R.
    Barber, Proc. R. Soc. A 459, 53 (2003), DOI 10.1098/rspa.2002.1038); of one disc R is (rho_1 + rho_2) /
    (4 a), as R. Holm has it.
    """
    modulus = check_half_space("resistance", contact.solid, contact.lattice)
    stiffness = contact.normal_stiffness
    return modulus * resistivity / (2 * stiffness) if stiffness > 0 else math.inf


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
    raise InputError(
        name,
        expected="a half-space under a surface of two dimensions",
        got="a line contact" if lattice.dimension == 1 else f"a {solid.kind.replace('_', ' ')}",
        advice="asperity.solids.half_space(modulus=...)",
    )


def sheared(contact: Contact, shear: float | str, friction: float) -> tuple[float, float]:
    """Shear force, in the units of a contact, and coefficient of friction."""
    force = checks.number("shear", units.converted("shear", shear, "N", si=contact.si), above=0)
    return force, checks.number("friction", friction, above=0)


@views.defines(Contact.partial_slip)
def partial_slip(
    contact: Contact, shear: float | str, friction: float, poisson: float | None = None
) -> PartialSlip:
    """See `Contact.partial_slip`."""
    check_half_space("partial_slip", contact.solid, contact.lattice)
    if contact.solid.adhesion is not None:
        expected = "a solid without adhesion"
        raise InputError("partial_slip", expected=expected, got="one with adhesion")
    force, mu = sheared(contact, shear, friction)
    ratio = None if poisson is None else checks.number("poisson", poisson, above=-1, most=0.5)
    if force >= mu * contact.load:
        expected = f"less than friction times load, {mu * contact.load:.6g}: from there on the bodies slide"
        raise InputError("shear", expected=expected, got=f"{force:.6g}", advice="less shear, or more load")
    # The tolerance is that of the whole contact, also where a small load sticks.
    held = Load(max(contact.load - force / mu, float(np.finfo(float).eps) * contact.load))
    stuck = pressed_anew(contact, held, least_force=contact.residual_scale)
    stick, traction = stuck.in_contact & contact.in_contact, mu * (contact.pressure - stuck.pressure)
    return PartialSlip(force, mu, stick, contact.in_contact & ~stick, traction, ratio, contact, stuck)
