"""Carried quantities of a contact, as a history records them."""

from __future__ import annotations

import numpy as np

from asperity.ask.carried import Carried
from asperity.carried.pull_off import pull_off_force
from asperity.carried.response import check_half_space, sheared
from asperity.carried.shear import principal, stiffness_along
from asperity.contact import Contact
from asperity.lattice import Field, Mask


def quantities(carried: Carried, contact: Contact) -> dict[str, float]:
    """Carried quantities of a contact, by the names of the columns.

    Raises
    ------
    InputError
        The solid is no half-space, or a number is out of range.
    """
    if not carried.responds:
        return {}
    check_half_space("carried", contact.solid, contact.lattice)
    numbers = {"normal_stiffness": contact.normal_stiffness}
    if carried.poisson is not None:
        numbers |= tangential(contact.tangential_compliance(carried.poisson), carried)
    if carried.resistivity is not None:
        numbers["resistance"] = contact.resistance(carried.resistivity)
    if carried.conductivity is not None:
        numbers["thermal_resistance"] = contact.thermal_resistance(carried.conductivity)
    if carried.work_of_adhesion is not None:
        numbers["pull_off"] = pull_off_force(contact, carried.work_of_adhesion)
    for stick in maps(carried, contact).values():
        numbers["stick_fraction"] = np.count_nonzero(stick) / max(contact.area, 1)
    return numbers


def tangential(compliance: Field, carried: Carried) -> dict[str, float]:
    """Tangential stiffness along the direction asked for, or a mean, the softest and the stiffest one."""
    numbers = {"tangential_stiffness": stiffness_along(compliance, carried.along)}
    if carried.along is None:
        soft, stiff, _ = principal(compliance)
        numbers |= {"tangential_stiffness_soft": soft, "tangential_stiffness_stiff": stiff}
    return numbers


def maps(carried: Carried, contact: Contact) -> dict[str, Mask]:
    """Maps of a contact by name: which sites ``stick``; empty without shear."""
    if carried.shear is None or carried.friction_coefficient is None:
        return {}
    force, mu = sheared(contact, carried.shear, carried.friction_coefficient)
    if force >= mu * contact.load:  # it slides
        return {"stick": np.zeros(contact.heights.shape, dtype=bool)}
    return {"stick": contact.partial_slip(force, mu, carried.poisson, carried.along or "x").stick}
