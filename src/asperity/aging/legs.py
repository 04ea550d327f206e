"""Follow a contact through the legs of a history: each is a march of its own from where the last one ended.

Contacts grow like the logarithm of the time since the last switch, so the length of the steps and the
guesses of where contacts will be begin anew with each leg.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from asperity.aging.march import Frame, Midway, creep
from asperity.contact.controls import Control, control_from
from asperity.contact.instantaneous import pressed_anew
from asperity.contact.problem import ContactSolver
from asperity.contact.state import Contact, control_of
from asperity.lattice import Field
from asperity.protocols import Hold, Ramp, Schedule, Step


@dataclass(frozen=True, eq=False)
class LegMidway:
    """State from which a history resumes within a leg, to identical results.

    Attributes
    ----------
    leg
        Its number in the history, from 0.
    control
        What is prescribed in it.
    approach
        Rigid approach since the start of the history, at its beginning.
    midway
        The march in it; times since its beginning.
    """

    leg: int
    control: Control
    approach: float
    midway: Midway


def follow(
    contact: Contact,
    schedule: Schedule,
    times: Field,
    *,
    rtol: float,
    solver: ContactSolver | None,
    exact: bool = True,
    resume: LegMidway | None = None,
    after_step: Callable[[LegMidway], None] | None = None,
) -> Iterator[Frame]:
    """Yield a frame at time 0, at each of the times and at the end of each leg: at a step before and after.

    Parameters
    ----------
    contact
        Where to start.
    schedule
        The history.
    times
        Strictly increasing times > 0, none after the end of the last leg.
    rtol, solver, exact
        As in `asperity.age`.
    resume
        Go on from here, with the frames after it; all other arguments as at first.
    after_step
        Called after each time step with the state from which to go on.
    """
    legs, switches = schedule.legs, schedule.switches
    now = Frame(0.0, contact, approach=0.0, steps=0, rejected=0, iterations=contact.iterations)
    if resume is None:
        yield now
    for number, leg in enumerate(legs):
        if resume is not None and number < resume.leg:
            continue
        begun, end = switches[number : number + 2]
        if isinstance(leg, Step):
            pressed = pressed_anew(now.contact, _target(now.contact, leg), solver)
            approach = now.approach + now.contact.separation - pressed.separation
            now = Frame(end, pressed, approach, 0, 0, pressed.iterations, number)
            yield now
            continue
        here = resume if resume is not None and number == resume.leg else None
        control = _control(now.contact, leg, end - begun) if here is None else here.control
        approach = now.approach if here is None else here.approach
        stops = np.union1d(times[(times > begun) & (times < end)], [end])
        if here is not None:
            stops = stops[(stops - begun) * leg.mobility >= here.midway.time]

        def keep(
            midway: Midway, number: int = number, control: Control = control, approach: float = approach
        ) -> None:
            if after_step is not None:
                after_step(LegMidway(number, control, approach, midway))

        frames = creep(
            now.contact,
            (stops - begun) * leg.mobility,
            control=control,
            keep_area=isinstance(leg, Hold) and leg.hold == "area",
            rtol=rtol,
            solver=solver,
            exact=exact,
            midway=None if here is None else here.midway,
            after_step=keep,
        )
        if here is None:
            next(frames)  # its start is known
        for time, frame in zip(stops.tolist(), frames, strict=True):
            now = replace(frame, time=time, approach=approach + frame.approach, leg=number)
            yield now


def _control(contact: Contact, leg: Hold | Ramp, lasting: float) -> Control:
    """What a leg prescribes, in times since its beginning and as fast as its mobility lets time pass."""
    if isinstance(leg, Hold):
        return control_of(contact, leg.hold)
    target = _target(contact, leg)
    start = contact.separation if leg.separation is not None else control_of(contact, "load").value
    return replace(target, value=start, rate=(target.value - start) / (lasting * leg.mobility))


def _target(contact: Contact, leg: Ramp | Step) -> Control:
    load = leg.load if leg.pressure is None else leg.pressure * contact.nominal_area
    return control_from(load, leg.separation)
