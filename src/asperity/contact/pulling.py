"""Bodies pulled apart to the last contact, and pressed again, without creep."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from asperity.contact.contact import Contact
from asperity.contact.controls import Control, Load, Separation
from asperity.contact.instantaneous import pressed_anew
from asperity.contact.problem import ContactSolver
from asperity.errors import PulledOff


@dataclass(frozen=True)
class Tuning:
    """Numbers of retreats and approaches."""

    first: float = 0.1
    """First step of a separation, in units of the reach of adhesion."""

    longest: float = 0.25
    """Longest step of a separation, in units of that reach."""

    least: float = 2**-9
    """Least step: of a separation in units of that reach, of a load in those of the usual step."""

    little: float = 0.4
    """Change of the load, over ``change``, below which the next step of a separation is twice as long."""


TUNING = Tuning()


def retreat(
    contact: Contact, kind: type[Control], change: float, solver: ContactSolver | None
) -> list[Contact]:
    """States from a contact to the last one before pull-off; by separation, to the first without contact.

    From state to state the load changes by at most ``change``, except at jumps.
    """
    states = [contact]
    if kind is Separation:
        for state in _through_separation(contact, 1, change, solver):
            states.append(state)
            if not state.force.any():
                return states
    step = change
    while step > TUNING.least * change:
        try:
            states.append(pressed_anew(states[-1], Load(states[-1].load - step), solver))
        except PulledOff:
            step /= 2
    return states


def approach(
    last: Contact, to: Contact, kind: type[Control], change: float, solver: ContactSolver | None
) -> list[Contact]:
    """States from the last of a retreat to the load or the separation where that began."""
    if kind is Separation:
        return [last, *_through_separation(last, -1, change, solver, to.separation)]
    loads = np.arange(change, to.load, change).tolist() + [to.load] * (to.load > 0)
    states: list[Contact] = []
    for load in loads:  # before the first one nothing attracts
        states.append(pressed_anew(states[-1] if states else last, Load(load), solver, apart=not states))
    return states


def _through_separation(
    state: Contact, sign: int, change: float, solver: ContactSolver | None, end: float | None = None
) -> Iterator[Contact]:
    """States at rising or falling separations, whose steps follow the change of the load."""
    law = state.solid.adhesion
    assert law is not None
    least, step = TUNING.least * law.reach, TUNING.first * law.reach
    while end is None or sign * (end - state.separation) > 0:
        place = state.separation + sign * step
        if end is not None and sign * (end - place) < least:
            place = end
        tried = pressed_anew(state, Separation(place), solver)
        by = abs(tried.load - state.load) / change
        if by > 1 and step > least:
            step = max(step / 2, least)
            continue
        state = tried
        yield state
        step = min(2 * step if by < TUNING.little else step, TUNING.longest * law.reach)
