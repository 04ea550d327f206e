"""Bodies pulled apart to the last contact, and pressed again, without creep."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from asperity.contact.contact import Contact
from asperity.contact.controls import Control, Load, Separation
from asperity.contact.instantaneous import pressed_anew
from asperity.contact.problem import ContactSolver
from asperity.errors import PulledOff
from asperity.lattice import Field


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

    peak: float = 1e-3
    """Share of the largest tension that states may miss."""

    lost: float = 5e-3
    """Share of the energy lost that states may miss, rms."""

    work: float = 1e-4
    """The same, over the work of all loads: a loop may have hardly any area."""


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
    while step > min(TUNING.least * change, max(-TUNING.peak * states[-1].load, TUNING.least**3 * change)):
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


def refine(approach: list[Contact], retreat: list[Contact], solver: ContactSolver | None) -> None:
    """Insert states into a retreat and an approach by separation, for the largest tension and the loop."""
    _refine_peak(retreat, solver)
    _refine_area(approach, retreat, solver)


def _refine_peak(retreat: list[Contact], solver: ContactSolver | None) -> None:
    """Halve steps until no tension between states can be much above the largest.

    Between states the tension rises at most as fast as with unchanged contacts, for these only break.
    """
    while True:
        place, load, stiffness = _numbers(retreat)
        bound = load[:-1] - stiffness[:-1] * np.diff(place)
        if bound.min() >= (1 + TUNING.peak) * min(load.min(), 0.0):
            return
        _halve(retreat, int(bound.argmin()), solver)


def _refine_area(approach: list[Contact], retreat: list[Contact], solver: ContactSolver | None) -> None:
    """Halve steps until trapezoids give the energy lost; their errors are independent of each other."""
    while True:
        numbers = [_numbers(branch) for branch in (approach, retreat)]
        missed = [_missed(*branch) for branch in numbers]
        work = [np.trapezoid(load, place) for place, load, _ in numbers]
        if math.hypot(*missed[0], *missed[1]) <= TUNING.lost * abs(sum(work)) + TUNING.work * abs(work[0]):
            return
        worst = int(missed[0].max() < missed[1].max())
        _halve((approach, retreat)[worst], int(missed[worst].argmax()), solver)


def _missed(place: Field, load: Field, stiffness: Field) -> Field:
    """Largest error of each trapezoid: the load follows unchanged contacts, until it jumps."""
    step = np.diff(place)
    jump = np.diff(load) + np.maximum(stiffness[1:], stiffness[:-1]) * step
    return np.asarray(abs(jump * step) / 2)


def _numbers(states: list[Contact]) -> Field:
    """Separations, loads and normal stiffnesses, shape ``(3, states)``."""
    return np.transpose([(state.separation, state.load, state.normal_stiffness) for state in states])


def _halve(states: list[Contact], place: int, solver: ContactSolver | None) -> None:
    """Insert the state half way from one to the next."""
    before, after = states[place : place + 2]
    middle = Separation((before.separation + after.separation) / 2)
    states.insert(place + 1, pressed_anew(before, middle, solver))
