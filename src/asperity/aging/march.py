"""Creep of a contact through given times, in time steps whose estimated error stays below a tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.aging.constant_area import FEWEST_SITES, ConstantArea
from asperity.aging.local_steps import LocalSteps
from asperity.aging.separable import SeparableSteps
from asperity.aging.spring_steps import SpringSteps
from asperity.aging.tr_bdf2 import Aim, FieldSteps, Steps
from asperity.base import checks
from asperity.contact.choice import chosen_solver
from asperity.contact.controls import Control, Load
from asperity.contact.mechanics import SpringMechanics
from asperity.contact.multigrid import Multigrid
from asperity.contact.problem import TOLERANCE, ContactSolver, Solution
from asperity.contact.state import AnchorModes, Contact
from asperity.contact.system import System
from asperity.errors import ConvergenceError, InputError
from asperity.lattice import Field

DEFAULT_RTOL = 2e-3
"""Area within a few tenths of a percent; measured in ``tests/physics/test_time_accuracy.py``."""

SMALLEST_RTOL, LARGEST_RTOL = 1e-6, 0.1
"""The number of time steps grows as rtol^(-1/2); rtol below 1e-6 is refused as too slow."""

STEP_TOLERANCE = 3.0
"""One time step may err by ``(STEP_TOLERANCE * rtol) ** 1.5`` deformations.

The errors of a second-order method whose steps err by e each add up to a multiple of e^(2/3). That
multiple was measured to lie between 0.03 and 0.29 over 20 cases (k1/k0 from 0.01 to 100, contact
fractions from 0.002 to 0.5, two kinds of surface, both controls, with viscous creep and without), so
that the sum stays below ``rtol``. (With contact problems solved exactly; what `UNNOTICED` adds is in the
tests of ``rtol``, which hold with it.)
"""

UNNOTICED = 0.3
"""Error of u0 that a solver may leave in one stage, in units of what one time step may err.

In the last time step before a frame, a thirtieth of it.
"""

_LONGEST = 1e30
"""Longest time, in units of the time in which the fastest mode creeps; single precision ends at 1e38."""

_MOST_STEPS = 60.0
"""Time steps, taken or repeated, in which time must at least double, in units of tolerance^(-1/3).

Steps of a method whose error grows like their cube are as many as these units.
"""

_MANY_STEPS = 12.0
"""Those after which steps on the lattice of springs go on in double precision and by Fourier modes.

Near rest rounding in single precision, and what cycles leave, can look like errors of steps.
"""

_MANY_REJECTIONS = 8
"""Rejections in a row after which they do, too: shorter steps are not more accurate."""

_MANY_FORGOTTEN = 2.0
"""Steps, in the same units, after which errors count by what is left of them at the next published state."""

_MOST_REJECTIONS = 50
"""Rejections in a row after which a step is not going to succeed."""


@dataclass(frozen=True, eq=False)
class Frame:
    """One moment of a creeping contact.

    Attributes
    ----------
    time
        Hold time since the start.
    contact
        The state.
    approach
        Rigid displacement of the upper body toward the lower since the start, length.
    steps, rejected, iterations
        Steps taken, steps repeated with a smaller length, and the solver's iterations, since the
        previous frame.
    leg
        Number of the leg of the history that it belongs to, from 0.
    exact
        Whether the contacts have no error of time steps; see `asperity.aging.separable`.
    displacement, velocity
        Length that the rough surface has slid since the start, and how fast it slides in this leg.
    shift
        Sites along each axis by which it has moved since the start.
    at_a_shift
        Whether it is to be recorded as the state just before or just after a shift.
    passing
        Whether more shifts follow at the same time.
    """

    time: float
    contact: Contact
    approach: float
    steps: int
    rejected: int
    iterations: int
    leg: int = 0
    exact: bool = False
    displacement: float = 0.0
    velocity: float = 0.0
    shift: tuple[Fraction, ...] = ()
    at_a_shift: bool = False
    passing: bool = False


@dataclass(frozen=True, eq=False)
class Midway:
    """State from which a new march resumes, at a time between two frames, to identical results.

    Attributes
    ----------
    time
        The time, since the start of the march.
    separation
        Mean of u0 at its start.
    impulse
        Integral of the load over time since its start, where the load is prescribed.
    resume_state
        The state: arrays of `Steps.resume_state`.
    deformation, length, steps, rejected, iterations
        Scale of the error, length of the next step, and counts since the last frame.
    area
        How the area is kept constant, if it is.
    """

    time: float
    separation: float
    impulse: float
    resume_state: Mapping[str, NDArray[Any]]
    deformation: float
    length: float
    steps: int
    rejected: int
    iterations: int
    area: ConstantArea | None = None


@dataclass(frozen=True)
class Pace:
    """How an earlier march of the same kind began: the length of its steps, and the scale of their errors."""

    length: float
    deformation: float


def creep(
    contact: Contact,
    times: ArrayLike,
    *,
    control: Control | None = None,
    keep_area: bool = False,
    rtol: float = DEFAULT_RTOL,
    solver: ContactSolver | None = None,
    exact: bool = True,
    pace: Pace | None = None,
    midway: Midway | None = None,
    after_step: Callable[[Midway], None] | None = None,
) -> Iterator[Frame]:
    """Yield a frame at time 0 and then at exactly each of the times, under one control.

    Parameters
    ----------
    contact
        Where to start, from `press`, `relax` or an earlier frame.
    times
        Strictly increasing times >= 0.
    control
        What is prescribed, constant or linear in time; by default what the contact was pressed by.
    keep_area
        Whether the load changes so that the area stays what it is; ``control`` is then the load at first.
    rtol
        Bound on the error of u0 at every time, rms over the sites, relative to the largest
        deformation reached so far: the rms of u about its mean (or of u - u0, if that is larger,
        where the mean of u0 creeps too or u is flat). See `STEP_TOLERANCE`.
    solver
        How to solve the contact problems; by default as `asperity.press` does.
    exact
        Whether to use the exact contact of a separable solid where it holds.
    pace
        What an earlier march tells of the length of steps.
    midway
        Go on from here, with the frames after it; all other arguments as at first, but for the contact,
        which may be any above the same surface.
    after_step
        Called after each step with the state from which to go on.

    Raises
    ------
    InputError
        The times or the tolerance cannot be used.
    ConvergenceError
        A contact problem was not solved, or steps shrank to nothing.
    """
    stops, tolerance = checks.times("times", times), check_rtol(rtol)
    stops = stops[stops > 0]
    if midway is not None and "heights" in midway.resume_state:
        arrays = midway.resume_state
        contact = contact.resting_on(arrays["heights"], arrays["indentation"])
        system = contact.system(control).lowered(arrays["obstacle"])
    else:
        system = contact.system(control)
    _check_pace(system, stops)
    if keep_area and contact.area < FEWEST_SITES and midway is None:
        raise InputError(
            "hold",
            expected=f"at least {FEWEST_SITES} sites in contact to keep the area",
            got=contact.area,
            advice="a larger surface or more load",
        )
    kind = _MarchAtConstantArea if keep_area else _March
    march = kind(contact, system, chosen_solver(solver, system), tolerance, exact, midway, after_step)
    if pace is not None and midway is None:
        march.length, march.deformation = pace.length, max(march.deformation, pace.deformation)
    if midway is not None:
        stops = stops[stops >= midway.time]
    return _frames(contact, stops, march, from_start=midway is None)


def _begin(system: System, solver: ContactSolver, start: Contact, exact: bool) -> Steps:
    """The steps that suit a system."""
    steps = SeparableSteps.begin(system, solver, start) if exact else None
    if steps is not None:
        return steps
    if system.mechanics.law is not None:
        return LocalSteps.begin(system, start)
    kind: Any = _kind_of_steps(system, solver)
    begun: Steps = kind.begin(system, solver, start)
    return begun


def _resume(system: System, solver: ContactSolver, arrays: Mapping[str, NDArray[Any]]) -> Steps:
    """The steps that left a state."""
    if "moments" in arrays:
        return LocalSteps(system, arrays)
    kind: Any = SeparableSteps if "loads" in arrays else SpringSteps if "times" in arrays else FieldSteps
    steps: Steps = kind(system, solver, arrays)
    return steps


def _kind_of_steps(system: System, solver: ContactSolver) -> type[FieldSteps] | type[SpringSteps]:
    mechanics = system.mechanics
    suited = isinstance(solver, Multigrid) and Multigrid.suits(mechanics)
    creeps = isinstance(mechanics, SpringMechanics) and mechanics.springs.creep
    return SpringSteps if suited and creeps else FieldSteps


def check_rtol(rtol: float) -> float:
    """Check the tolerance; see `creep`."""
    expected = f"a number from {SMALLEST_RTOL:g} to {LARGEST_RTOL:g}"
    advice = f"rtol={DEFAULT_RTOL:g}"
    return checks.number(
        "rtol", rtol, least=SMALLEST_RTOL, most=LARGEST_RTOL, expected=expected, advice=advice
    )


def _check_pace(system: System, stops: Field) -> None:
    """Refuse numbers that overflow single precision."""
    fastest = system.mechanics.fastest_creep
    if stops.size and fastest > 0 and stops[0] < 1 / _LONGEST:
        raise InputError(
            "times",
            expected=f"0, or times from {1 / _LONGEST:.0e}",
            got=f"{stops[0]:g}",
            advice="another unit of time",
        )
    if stops.size and fastest * stops[-1] > _LONGEST:
        raise InputError(
            "times",
            expected=f"times up to {_LONGEST / fastest:.2g}, long after all that creeps has crept",
            got=f"{stops[-1]:g}",
            advice="asperity.relax for what comes in the end",
        )
    if fastest > _LONGEST:
        raise InputError(
            "solid",
            expected=f"creep at rates (k1 R, k1 R_viscous) up to {_LONGEST:.0e}",
            got=f"{fastest:.2g}",
            advice="another unit of time",
        )


def _frames(start: Contact, stops: Field, march: _March, *, from_start: bool) -> Iterator[Frame]:
    """Integrate and publish."""
    if from_start:
        yield Frame(0.0, start, approach=0.0, steps=0, rejected=0, iterations=start.iterations)
    for stop in stops:
        march.advance_to(float(stop))
        yield march.frame(start)
        march.reset_counts()


class _March:
    """Adaptive steps from stop to stop."""

    def __init__(
        self,
        start: Contact,
        system: System,
        solver: ContactSolver,
        rtol: float,
        exact: bool,
        midway: Midway | None,
        after_step: Callable[[Midway], None] | None,
    ) -> None:
        self.start, self.system, self.after_step, self.streak = start, system, after_step, 0
        self.tolerance = (STEP_TOLERANCE * rtol) ** 1.5
        self.passing = max(TOLERANCE, rtol / 2000)
        self.reset_counts()
        if midway is None:
            self.separation, self.impulse = start.separation, 0.0
            self.now = _begin(self.system, solver, start, exact)
            self.deformation = 0.0
            self.raise_deformation()
            # The first step: u0 changes by a small part of the deformation.
            speed = self.now.speed()
            self.length = math.inf
            if speed > 0 and self.deformation > 0:
                self.length = 0.1 * self.tolerance ** (1 / 3) * self.deformation / speed
        else:
            self.now = _resume(self.system, solver, midway.resume_state)
            self.extent = self.now.extent()
            self.separation, self.impulse = midway.separation, midway.impulse
            self.deformation, self.length = midway.deformation, midway.length
            self.steps, self.rejected, self.iterations = midway.steps, midway.rejected, midway.iterations

    def reset_counts(self) -> None:
        """Count from zero."""
        self.steps = self.rejected = self.iterations = 0

    def midway(self) -> Midway:
        """State from which a new march resumes."""
        counts = (self.steps, self.rejected, self.iterations)
        start, arrays = (self.separation, self.impulse), self.now.resume_state()
        if self.system.yields:
            heights, indentation = self.start.heights, self.start.permanent_indentation
            arrays |= {"heights": heights, "indentation": indentation, "obstacle": self.system.heights}
        return Midway(self.now.time, *start, arrays, self.deformation, self.length, *counts)

    def frame(self, start: Contact) -> Frame:
        """Publish the present state."""
        system, (u, creep, position) = self.system.at(self.now.time), self.now.state()
        anchors = creep if isinstance(creep, AnchorModes) else u - system.balanced_stretch(u, creep)
        solution = Solution(u, u <= system.heights, self.iterations, 0)
        state = start.become(system, solution, anchors, position)
        approach = self.approach(state.separation)
        exact = isinstance(self.now, SeparableSteps)
        counts = (self.steps, self.rejected, self.iterations)
        return Frame(self.now.time, state, approach, *counts, exact=exact)

    def approach(self, separation: float) -> float:
        """Rigid approach: under load control, what viscous creep adds to the fall of the mean of u0."""
        if self.system.load is None:
            return -self.system.drift * self.now.time
        if isinstance(self.now, LocalSteps):
            return -self.now.position
        creep = self.system.mechanics.mean_mobility * self.impulse / self.system.sites
        return self.separation - separation + creep

    def raise_deformation(self) -> None:
        """Set the scale of the error to the largest deformation so far."""
        self.extent = extent = self.now.extent()
        scale = extent.spread
        if scale <= self.rounding() or self.system.free_mean:
            # A flat surface, or one whose mean creeps too: the stretch of the creeping springs.
            scale = max(scale, extent.stretch)
        self.deformation = max(self.deformation, scale)

    def rounding(self) -> float:
        """Error of u0 that rounding alone makes."""
        return 64 * float(np.finfo(float).eps) * self.extent.largest

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # what is not finite is found and refused
    def advance_to(self, stop: float) -> None:
        """Step until the time is exactly ``stop``."""
        begun, since = self.steps + self.rejected, self.now.time
        while self.now.time < stop:
            if self.now.time > 2 * since:
                begun, since = self.steps + self.rejected, self.now.time
            left = stop - self.now.time
            usual = self.longest()
            landing = usual >= left * (1 - 1e-9)
            # Two equal steps rather than a long one and a very short one.
            length = left if landing else left / 2 if 2 * usual > left else usual
            self.prepare(length)
            unnoticed = UNNOTICED * self.tolerance * self.deformation
            taken = (self.steps + self.rejected - begun) * self.tolerance ** (1 / 3)
            published = self.published(stop)
            if isinstance(self.now, SpringSteps):
                if taken > _MANY_FORGOTTEN and published > self.now.time:
                    self.now.forgetting = True
                if taken > _MANY_STEPS or self.streak > _MANY_REJECTIONS:
                    self.now = FieldSteps.going_on(self.now.system, self.now.time, self.now.state())
                    begun, since = self.steps + self.rejected, self.now.time
            stuck = taken > _MOST_STEPS
            if stuck or not (landing or self.now.time + length > self.now.time):
                raise ConvergenceError(
                    f"aging: steps shrank to {length:.1e} at time {self.now.time:.3e}, too short to get "
                    f"to {stop:.3e}; try a larger rtol, or asperity.relax for what comes in the end"
                )
            aim = Aim(
                (self.passing, TOLERANCE if landing else self.passing),
                (unnoticed, unnoticed / 30 if landing else unnoticed),
                published,
            )
            step = self.now.attempt(length, aim)
            self.iterations += step.iterations
            error = self.relative(step.error)
            # The error of a step grows like its cube; 0.9 leaves a margin.
            change = min(4.0, max(0.2, 0.9 * error ** (-1 / 3))) if error > 0 else 4.0
            if error > 1:
                self.reject(length, change)
                continue
            if self.misses():
                continue
            self.steps += 1
            self.streak = 0
            self.length = max(length * change, min(self.length, 4.0 * length))
            self.take(stop if landing else self.now.time + length)
            self.raise_deformation()
            if self.after_step is not None:
                self.after_step(self.midway())

    def longest(self) -> float:
        """Longest next time step."""
        return self.length

    def published(self, stop: float) -> float:
        """Time of the next state that matters.

        Every one does where the load changes, where what has yielded stays so, and where the mean creeps.
        """
        system = self.system
        return self.now.time if system.control.rate or system.yields or system.free_mean else stop

    def prepare(self, length: float) -> None:
        """Prescribe what is to be during the next time step."""

    def misses(self) -> bool:
        """Whether the step that was tried is to be repeated, although accurate."""
        return False

    def take(self, time: float) -> None:
        """Accept the step that ends at a time."""
        before, control = self.now.time, self.system.control
        self.now.accept(time)
        self.system = self.now.system
        if control.load_controlled:
            self.impulse += control.at((before + time) / 2).value * (time - before)

    def reject(self, length: float, change: float) -> None:
        """Try again with a shorter step."""
        self.rejected += 1
        self.streak += 1
        if self.streak > _MOST_REJECTIONS:
            raise ConvergenceError(
                f"aging: steps shrank to {length:.1e} at time {self.now.time:.3e}; try a larger rtol"
            )
        self.length = length * change

    def relative(self, error: float) -> float:
        """Error in units of what is allowed."""
        if error <= self.rounding():
            return 0.0
        if not (math.isfinite(error) and self.deformation > 0):
            return math.inf
        relative: float = error / (self.tolerance * self.deformation)
        return relative


class _MarchAtConstantArea(_March):
    """Adaptive steps in each of which the load is such that the area stays what it was."""

    def __init__(
        self,
        start: Contact,
        system: System,
        solver: ContactSolver,
        rtol: float,
        exact: bool,
        midway: Midway | None,
        after_step: Callable[[Midway], None] | None,
    ) -> None:
        del exact  # the load falls
        super().__init__(start, system, solver, rtol, False, midway, after_step)
        if midway is not None and midway.area is not None:
            self.area = replace(midway.area)
            self.prescribe(Load(self.area.load, since=self.area.time))
        else:
            self.area = ConstantArea(float(start.area), 0.0, system.control.value, float(start.area))

    def midway(self) -> Midway:
        """See `_March`."""
        return replace(super().midway(), area=replace(self.area))

    def prescribe(self, load: Load) -> None:
        """Set the load of the next time step."""
        self.system = self.now.system = replace(self.system, control=load)

    def longest(self) -> float:
        """See `_March`."""
        return min(self.length, self.area.longest())

    def published(self, stop: float) -> float:
        """See `_March`; the contacts of every state set the load of the next step."""
        del stop
        return self.now.time

    def prepare(self, length: float) -> None:
        """See `_March`."""
        self.prescribe(self.area.load_for(length))

    def misses(self) -> bool:
        """See `_March`."""
        return self.area.misses(self.now.contacts_tried())

    def reject(self, length: float, change: float) -> None:
        """See `_March`."""
        super().reject(length, change)
        self.area.begin_step()

    def take(self, time: float) -> None:
        """See `_March`."""
        contacts, load = self.now.contacts_tried(), self.system.control
        super().take(time)
        assert isinstance(load, Load)
        self.area.accept(time, contacts, load)
