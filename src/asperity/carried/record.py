"""Carried quantities that a history records: which, and for which materials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.carried.pull_off import pull_off_force
from asperity.carried.response import check_half_space, sheared
from asperity.contact import Contact
from asperity.contact.contact import Each
from asperity.errors import InputError
from asperity.lattice import Mask


@dataclass(frozen=True)
class Carried:
    """Carried quantities of a half-space to record beside the normal stiffness; for `asperity.age`.

    Parameters
    ----------
    resistivity
        Record ``resistance``; see `Contact.resistance`.
    conductivity
        Record ``thermal_resistance``; see `Contact.thermal_resistance`.
    poisson
        Record ``tangential_stiffness``; see `Contact.tangential_stiffness`.
    shear, friction
        Record ``stick_fraction``, the share of the contact that sticks under this shear force, applied at
        that time, with this coefficient of friction. It is 0 where the bodies slide: at loads up to
        shear / friction. See `Contact.partial_slip`.
    work_of_adhesion
        Record ``pull_off``, the force that pulls the contact apart at that time, with this work of adhesion;
        0 without contact, NaN in full contact. See `Contact.pull_off`.

    Raises
    ------
    InputError
        Only one of shear and friction is given.
    """

    resistivity: Each | None = None
    conductivity: Each | None = None
    poisson: float | None = None
    shear: float | str | None = None
    friction: float | None = None
    work_of_adhesion: float | str | None = None

    def __post_init__(self) -> None:
        if (self.shear is None) != (self.friction is None):
            got = "friction" if self.shear is None else "shear"
            raise InputError("shear and friction", expected="both or none of them", got=f"{got} alone")

    def of(self, contact: Contact) -> dict[str, float]:
        """Carried quantities of a contact, by the names of the columns.

        Raises
        ------
        InputError
            The solid is no half-space, or a number is out of range.
        """
        check_half_space("carried", contact.solid, contact.lattice)
        numbers = {"normal_stiffness": contact.normal_stiffness}
        if self.poisson is not None:
            numbers["tangential_stiffness"] = contact.tangential_stiffness(self.poisson)
        if self.resistivity is not None:
            numbers["resistance"] = contact.resistance(self.resistivity)
        if self.conductivity is not None:
            numbers["thermal_resistance"] = contact.thermal_resistance(self.conductivity)
        if self.work_of_adhesion is not None:
            numbers["pull_off"] = pull_off_force(contact, self.work_of_adhesion)
        for stick in self.maps(contact).values():
            numbers["stick_fraction"] = np.count_nonzero(stick) / max(contact.area, 1)
        return numbers

    def maps(self, contact: Contact) -> dict[str, Mask]:
        """Maps of a contact by name: which sites ``stick``; empty without shear."""
        if self.shear is None or self.friction is None:
            return {}
        force, mu = sheared(contact, self.shear, self.friction)
        slides = force >= mu * contact.load
        none = np.zeros(contact.heights.shape, dtype=bool)
        return {"stick": none if slides else contact.partial_slip(force, mu).stick}
