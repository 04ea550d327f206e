"""The ages of the sites in contact, of which an aging shear strength follows.

They belong to the rough surface, and move with it. A site that is found in contact at the end of a time step,
and was not at its beginning, touches from the middle of that step.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from asperity.ask.strength import ShearStrength
from asperity.contact.contact import Contact
from asperity.errors import InputError
from asperity.lattice import Field, Lattice, Mask
from asperity.protocols.schedule import Schedule


class Ages:
    """Ages of the sites of a contact that begins to touch, time; NaN off contact."""

    def __init__(self, strength: ShearStrength, contact: Contact) -> None:
        self.strength, self.lattice = strength, contact.lattice.embedding
        self.now = np.where(contact.in_contact, 0.0, np.nan)

    def creep(self, duration: float, speed: float, touching: Mask) -> None:
        """Age for a time step, at whose end these sites touch."""
        touching = self.lattice.cut(touching)
        before, aged = self.now[touching], np.full(self.now.shape, np.nan)
        new = float(self.strength.aged(0.0, duration / 2, speed * duration / 2))
        ages = self.strength.aged(before, duration, speed * duration)
        aged[touching] = np.where(np.isnan(before), new, ages)
        self.now = aged

    def slip(self, before: Iterable[Fraction], after: Iterable[Fraction], length: float) -> None:
        """Move with the rough surface, by the whole sites between two places; renew by a slip in no time."""
        sites = [round(new) - round(old) for old, new in zip(before, after, strict=True)]
        self.now = np.roll(self.strength.aged(self.now, 0.0, length), sites, range(len(sites)))

    def touch(self, touching: Mask) -> None:
        """At once these sites touch."""
        self.now = np.where(touching, np.nan_to_num(self.now), np.nan)


def check_strength(strength: ShearStrength, schedule: Schedule, lattice: Lattice) -> None:
    """`InputError` if the strength of a site that always touches would reach 0 within a history."""

    def left(part: float, age: float, duration: float, slip: float) -> float:
        return 1 + float(strength.grown(strength.aged(age, part * duration, part * slip)))

    age = 0.0
    for leg, (begin, end) in zip(schedule.legs, pairwise(schedule.switches), strict=True):
        shifts = leg.shifts(lattice)
        span = age, end - begin, 0.0 if shifts is None else shifts.count * shifts.length
        if left(1.0, *span) <= 0:
            when = begin + (end - begin) * float(brentq(left, 0.0, 1.0, span))
            expected, got = "a strength above 0 throughout the history", f"one that is 0 at time {when:.4g}"
            raise InputError("growth", expected=expected, got=got, advice="a growth nearer to 0")
        age = float(strength.aged(*span))
