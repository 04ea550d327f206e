"""Creep of a contact through given times, in time steps whose estimated error stays below a tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity.aging import constant_area
from asperity.aging.constant_area import ConstantArea
from asperity.aging.controller import Controller, step_tolerance
from asperity.aging.field_steps import FieldSteps
from asperity.aging.frames import Counts, Frame, Midway, published
from asperity.aging.local_steps import LocalSteps
from asperity.aging.separable import SeparableSteps
from asperity.aging.slide_steps import SlideSteps
from asperity.aging.spring_steps import SpringSteps
from asperity.aging.tr_bdf2 import Aim, Origin, Steps
from asperity.base import checks
from asperity.contact.choice import chosen_solver
from asperity.contact.contact import Contact
from asperity.contact.controls import Control, Load
from asperity.contact.problem import TOLERANCE, ContactSolver
from asperity.contact.system import System
from asperity.errors import ConvergenceError, InputError, PulledOff
from asperity.lattice import Field

DEFAULT_RTOL = 2e-3
"""Area within a few tenths of a percent; measured in ``tests/physics/test_time_accuracy.py``."""

SMALLEST_RTOL, LARGEST_RTOL = 1e-6, 0.1
"""The number of time steps grows as rtol^(-1/2); rtol below 1e-6 is refused as too slow."""


@dataclass(frozen=True)
class Tuning:
    """Numbers chosen by measurement."""

    unnoticed: float = 0.3
    """Error of u0 that a solver may leave in one stage, in units of the error allowed to a time step."""

    published: float = 0.01
    """The same in the last stage before a frame."""

    passing: float = 5e-4
    """Tolerance of contact problems on the way, in units of rtol."""

    parting: float = 1e-4
    """Part of the time of a march to which it is known when bodies part."""

    fading: float = 5.0
    """Factor on rtol for steps of a slide, whose errors fade: those before a shift are forgotten after it.

    Then u0 errs by 0.1 to 0.8 of rtol, at rtol from 1e-4 to 2e-3, over 3 to 20 shifts of half-spaces with
    three or four branches, on 24 x 24 to 64 x 64 sites, at speeds over four decades.
    """


TUNING = Tuning()

AfterStep = Callable[[Callable[[], Midway], float, Steps], None]

_SUITING: Any = SeparableSteps, LocalSteps, SpringSteps, FieldSteps
"""Kinds of time steps, of which the first that suits is taken."""

_KINDS: Any = {kind.kind: kind for kind in (*_SUITING, SlideSteps)}


def creep(
    contact: Contact,
    times: ArrayLike,
    *,
    control: Control | None = None,
    keep_area: bool = False,
    rtol: float = DEFAULT_RTOL,
    solver: ContactSolver | None = None,
    exact: bool = True,
    deformation: float = 0.0,
    steps: SlideSteps | None = None,
    midway: Midway | None = None,
    after_step: AfterStep | None = None,
) -> Iterator[Frame]:
    """Yield a frame at time 0 and then at exactly each of the times, under one control.

    Parameters
    ----------
    contact, times, rtol, solver, exact
        As those of `asperity.age`.
    control
        What is prescribed, a function of these times; by default what the contact was pressed by.
    keep_area
        Whether the load changes so that the area stays what it is; ``control`` is then the load at first.
    deformation
        What errors are relative to at least, length.
    steps
        Those after a shift, at time 0, in place of those that suit the contact.
    midway
        Go on from here, above the same surface, with all other arguments as at first.
    after_step
        Called after each step with what makes the state from which to go on, the duration and the state.

    Raises
    ------
    InputError, ConvergenceError
        As those of `asperity.age`.
    """
    stops, rtol = checks.times("times", times), check_rtol(rtol)
    stops = stops[stops > 0]
    if midway is not None and "heights" in midway.resume_state:
        arrays = midway.resume_state
        contact = contact.resting_on(arrays["heights"], arrays["indentation"])
        system = contact.system(control).lowered(arrays["obstacle"])
    else:
        system = contact.system(control) if steps is None else steps.system
    if keep_area and contact.area < (fewest := constant_area.TUNING.fewest_sites) and midway is None:
        expected = f"at least {fewest} sites in contact to keep the area"
        raise InputError("hold", expected=expected, got=contact.area, advice="a larger surface or more load")
    march = _March(contact, chosen_solver(solver, system), rtol, after_step)
    if midway is None:
        march.begin(system, exact, keep_area, deformation, steps)
    else:
        march.resume(system, midway)
        stops = stops[stops >= midway.time]
    march.now.check(stops)
    return march.frames(stops, from_start=midway is None)


def fading_tolerance(rtol: float) -> float:
    """Error that one time step may have whose error fades, in deformations."""
    return step_tolerance(TUNING.fading * rtol)


def check_rtol(rtol: float) -> float:
    """Check the tolerance; see `creep`."""
    expected = f"a number from {SMALLEST_RTOL:g} to {LARGEST_RTOL:g}"
    advice = f"rtol={DEFAULT_RTOL:g}"
    return checks.number(
        "rtol", rtol, least=SMALLEST_RTOL, most=LARGEST_RTOL, expected=expected, advice=advice
    )


class _March:
    """Adaptive steps from stop to stop.

    Errors are relative to the largest ``deformation`` so far; ``area`` chooses the load, where the area is
    kept. Once bodies were ``parting`` in a step that was too long, any state may be the last in contact.
    """

    now: Steps
    deformation: float

    def __init__(
        self,
        start: Contact,
        solver: ContactSolver,
        rtol: float,
        after_step: AfterStep | None,
    ) -> None:
        self.start, self.solver, self.after_step = start, solver, after_step
        self.rtol, self.controller = rtol, Controller(step_tolerance(rtol))
        self.passing = max(TOLERANCE, TUNING.passing * rtol)
        self.area: ConstantArea | None = None
        self.origin, self.counts, self.parting = Origin(start.separation), Counts(), False

    def frames(self, stops: Field, *, from_start: bool) -> Iterator[Frame]:
        """Integrate and publish."""
        start = self.start
        if from_start:
            yield Frame(0.0, start, approach=0.0, steps=0, rejected=0, iterations=start.iterations)
        for stop in stops.tolist():
            try:
                self.advance_to(stop)
            except PulledOff:
                if self.counts.steps:
                    yield self.published()
                raise
            yield self.published()

    def published(self) -> Frame:
        """The present state."""
        state = self.now.state()
        # No step has estimated what balancing the forces moves u0 by.
        if self.relative(state.moved, self.deformation) * self.controller.tolerance > self.rtol:
            raise ConvergenceError(
                f"aging: forces that the solver left move u0 by {state.moved:.1e}, more than rtol allows; "
                "try another solver"
            )
        frame = published(self.start, self.now, state, self.origin, self.counts)
        self.counts = Counts()
        return frame

    def begin(
        self, system: System, exact: bool, keep_area: bool, deformation: float, steps: SlideSteps | None
    ) -> None:
        """At the start."""
        start = self.start
        if keep_area:  # the load falls, so that no contact is exact
            self.area = ConstantArea(float(start.area), 0.0, system.control.value, float(start.area))
        kinds = [kind for kind in _SUITING if kind is not SeparableSteps or (exact and not keep_area)]
        # A kind that does not suit this solid begins with nothing.
        self.now = steps or next(filter(None, (kind.begin(system, self.solver, start) for kind in kinds)))
        self.deformation = 0.0
        self.raise_deformation()
        # The first step follows what creeps here, however large a deformation errors are measured by.
        if steps is None:
            self.controller.begin(self.deformation, self.now.speed())
        else:
            self.controller = Controller(fading_tolerance(self.rtol), steps.length)
        self.deformation = max(self.deformation, deformation)

    def resume(self, system: System, midway: Midway) -> None:
        """Where another march was."""
        self.origin, self.counts = copy(midway.origin), copy(midway.counts)
        self.controller, self.area = copy(midway.controller), copy(midway.area)
        self.deformation, self.parting = midway.deformation, midway.parting
        if self.area is not None:
            system = replace(system, control=Load(self.area.load))
        self.now = _KINDS[midway.kind](system, self.solver, midway.resume_state)
        self.extent = self.now.extent()

    def midway(self) -> Midway:
        """State from which a new march resumes."""
        arrays = self.now.resume_state()
        if self.now.system.yields:
            heights, indentation = self.start.heights, self.start.permanent_indentation
            arrays |= {"heights": heights, "indentation": indentation, "obstacle": self.now.system.heights}
        march: Any = self.origin, self.deformation, self.controller, self.counts, self.area, self.parting
        return Midway(self.now.time, self.now.kind, arrays, *map(copy, march))

    def raise_deformation(self) -> None:
        """Set the scale of the error to the largest deformation so far."""
        self.extent = extent = self.now.extent()
        scale = extent.spread
        if scale <= self.rounding() or self.now.system.free_mean:
            # A flat surface, or one whose mean creeps too: the stretch of the creeping springs.
            scale = max(scale, extent.stretch)
        self.deformation = max(self.deformation, scale)

    def rounding(self) -> float:
        """Error of u0 that rounding alone makes."""
        return 64 * float(np.finfo(float).eps) * self.extent.largest

    @property
    def unnoticed(self) -> float:
        """Error of u0 that a solver may leave in a stage on the way."""
        return TUNING.unnoticed * self.controller.tolerance * self.deformation

    def relative(self, error: float, scale: float) -> float:
        """Error of a length in units of what is allowed."""
        if error <= self.rounding():  # shorter steps would not make it less
            return 0.0
        if not (math.isfinite(error) and scale > 0):
            return math.inf
        return error / (self.controller.tolerance * scale)

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # what is not finite is found and refused
    def advance_to(self, stop: float) -> None:
        """Step until the time is exactly ``stop``."""
        controller = self.controller
        failure: ConvergenceError | PulledOff | None = None
        while (time := self.now.time) < stop:
            longest = self.area.longest() if self.area else self.now.system.control.longest
            length = controller.step(time, stop, longest)
            landing = length == stop - time
            parted = isinstance(failure, PulledOff) and length <= TUNING.parting * time
            if parted or controller.is_stuck(time, length):
                shrank = ConvergenceError(
                    f"aging: steps shrank to {length:.1e} at time {time:.3e}, too short to get "
                    f"to {stop:.3e}; try a larger rtol, or asperity.relax for what comes in the end"
                )
                self.fall_back(failure or shrank)
                continue
            if self.area:
                self.now.system = replace(self.now.system, control=self.area.load_for(length))
            attempt = self.now.attempt(length, self.aim(landing or self.parting, stop - time - length))
            failure = attempt.failure
            self.parting |= isinstance(failure, PulledOff)
            self.counts.iterations += attempt.iterations
            error = max(
                self.relative(attempt.error, self.deformation),
                self.relative(attempt.mean_error - self.unnoticed, self.deformation + attempt.mean),
            )
            if error <= 1 and self.area and self.area.misses(self.now.contacts_tried()):
                continue  # the same step under another load, until it keeps the area
            if controller.accepts(length, error):
                self.take(stop if landing else time + length)
            else:
                self.counts.rejected += 1
                if self.area:
                    self.area.begin_step()

    def aim(self, landing: bool, left: float) -> Aim:
        """Accuracy of the next time step; ``landing`` if it leads to a frame, a time ``left`` after it."""
        # Where their number is prescribed, contacts have to settle.
        tolerance, allowed = TOLERANCE if self.area else self.passing, self.unnoticed
        if landing:
            tolerance, allowed = TOLERANCE, TUNING.published * self.controller.tolerance * self.deformation
        return Aim((self.passing, tolerance), (self.unnoticed, allowed), self.deformation, left)

    def fall_back(self, failure: ConvergenceError | PulledOff) -> None:
        """Go on by another kind of steps; raise the failure if there is none."""
        if (others := self.now.instead()) is None:
            raise failure
        self.now = others
        self.controller.start_over(self.now.time)

    def take(self, time: float) -> None:
        """Accept the step that was tried and ends at a time."""
        since, control = self.now.time, self.now.system.control
        contacts = self.now.contacts_tried() if self.area else 0
        self.counts.steps += 1
        self.now.accept(time)
        self.origin.passed(control, since, time)  # after the step, as a rejected one passes nothing
        if self.area:
            self.area.accept(time, contacts, control.at(time).value)
        self.raise_deformation()
        if self.after_step is not None:
            self.after_step(self.midway, time - since, self.now)
