"""The ages of the sites in contact, of which an aging shear strength follows.

They belong to the rough surface, and move with it. A site that is found in contact at the end of a time step,
and was not at its beginning, touches from the middle of that step.
"""

from __future__ import annotations

import math
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
        self.begin(np.where(contact.in_contact, 0.0, np.nan))

    def begin(self, ages: Field) -> None:
        """Go on from ages."""
        self.now = np.array(ages, order="C")
        self.touching = ~np.isnan(self.now)

    def creep(self, duration: float, speed: float, touching: Mask) -> None:
        """Age for a time step, at whose end these sites touch; in place, which saves most of the time."""
        touching, slip = self.lattice.cut(touching), speed * duration
        kept, more = self.strength.renewed(duration, slip)
        if kept != 1:
            self.now *= kept
        self.now += more
        self.touch(touching, self.strength.renewed(duration / 2, slip / 2)[1])

    def slip(self, before: Iterable[Fraction], after: Iterable[Fraction], length: float) -> None:
        """Move with the rough surface, by the whole sites between two places; renew by a slip in no time."""
        sites = [round(new) - round(old) for old, new in zip(before, after, strict=True)]
        self.begin(np.roll(self.now * self.strength.renewed(0.0, length)[0], sites, range(len(sites))))

    def means(self, contact: Contact) -> dict[str, float]:
        """Mean age, and mean relative growth of the strength, of a published contact; NaN and 0 without."""
        ages = self.now[contact.in_contact]
        ages[np.isnan(ages)] = 0.0  # by rounding, sites more may touch
        if not ages.size:
            return {"contact_age_mean": math.nan, "grown": 0.0}
        return {"contact_age_mean": float(ages.mean()), "grown": float(self.strength.grown(ages).mean())}

    def touch(self, touching: Mask, new: float = 0.0) -> None:
        """These sites touch; those that did not before have a new age."""
        changed = np.flatnonzero(touching != self.touching)
        self.now.ravel()[changed] = np.where(touching.ravel()[changed], new, np.nan)
        self.touching = touching


def check_strength(strength: ShearStrength, schedule: Schedule, lattice: Lattice) -> None:
    """`InputError` if the strength of a site that always touches would reach 0 within a history."""

    def aged(part: float, age: float, duration: float, slip: float) -> float:
        kept, more = strength.renewed(part * duration, part * slip)
        return kept * age + more

    def left(*leg: float) -> float:
        return 1 + float(strength.grown(aged(*leg)))

    age = 0.0
    for leg, (begin, end) in zip(schedule.legs, pairwise(schedule.switches), strict=True):
        shifts = leg.shifts(lattice)
        span = age, end - begin, 0.0 if shifts is None else shifts.count * shifts.length
        if left(1.0, *span) <= 0:
            when = begin + (end - begin) * float(brentq(left, 0.0, 1.0, span))
            expected, got = "a strength above 0 throughout the history", f"one that is 0 at time {when:.4g}"
            raise InputError("growth", expected=expected, got=got, advice="a growth nearer to 0")
        age = aged(1.0, *span)
