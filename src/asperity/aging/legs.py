"""Follow a contact through the legs of a history: each is a march of its own from where the last one ended.

Contacts grow like the logarithm of the time since the last switch, so the length of the steps and the
guesses of where contacts will be begin anew with each leg. While the rough surface slides, each shift is such
a switch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
import scipy

from asperity.aging.ages import Ages
from asperity.aging.frames import Counts, Frame, Midway, published
from asperity.aging.march import TUNING, creep, fading_tolerance
from asperity.aging.slide_steps import SlideSteps
from asperity.aging.tr_bdf2 import Origin, Steps
from asperity.base import checks
from asperity.contact.choice import chosen_solver
from asperity.contact.contact import Contact, control_of
from asperity.contact.controls import Control, Course, Load, Separation
from asperity.contact.instantaneous import check_whole, pressed_anew, slid
from asperity.contact.problem import TOLERANCE, Accuracy, ContactSolver
from asperity.errors import InputError, PulledOff
from asperity.lattice import Field, Lattice
from asperity.protocols import Leg
from asperity.protocols.legs import Shifts
from asperity.protocols.schedule import Schedule
from asperity.solids import Solid


@dataclass(frozen=True, eq=False)
class LegMidway:
    """State from which a history resumes within a leg, to identical results.

    ``begun`` and ``approach`` are those at the beginning of the march in the leg, whose times are since then;
    ``control`` is what was prescribed at the beginning of the leg, and ``level`` the separation at which the
    approach was 0; ``shifts`` says how often the rough surface was shifted in this leg.
    """

    leg: int
    begun: float
    control: Control
    level: float
    approach: float
    midway: Midway
    shifts: int = 0


def check_slides(legs: Iterable[Leg], lattice: Lattice, solid: Solid) -> None:
    """Refuse slides without periodic edges, along an axis that is none, or by parts of sites that yield."""
    for leg in legs:
        if (shifts := leg.shifts(lattice)) is not None:
            check_whole(solid, shifts.sites)


def _moved(place: Frame, shifts: Shifts, count: int) -> Frame:
    """Where a number of shifts leads from a place."""
    shift = tuple(old + count * new for old, new in zip(place.shift, shifts.sites, strict=True))
    moved = place.displacement + count * shifts.length
    return replace(place, displacement=moved, shift=shift, way=shifts.sites)


def follow(
    contact: Contact,
    schedule: Schedule,
    times: Field,
    *,
    rtol: float,
    solver: ContactSolver | None,
    exact: bool = True,
    resume: LegMidway | None = None,
    after_step: Callable[[Callable[[], LegMidway]], None] | None = None,
    ages: Ages | None = None,
) -> Iterator[Frame]:
    """Yield a frame at time 0, at each of the times, at the end of each leg and at shifts.

    At a step and at a shift there are two, before and after. Times are > 0, strictly increasing, and none is
    after the end of the last leg; ``rtol``, ``solver`` and ``exact`` are those of `asperity.age`. ``resume``
    is where to go on, and ``after_step`` is called after each step with what makes that. Frames have the
    ``ages``, which begin as those of the start. Where the bodies part, the last state in contact comes again,
    and ends the history.
    """
    way = _Way(contact, times, rtol, solver, exact, after_step, ages)
    try:
        yield from _through(way, schedule, resume)
    except PulledOff:
        yield replace(way.now, parted=True)


def _through(way: _Way, schedule: Schedule, resume: LegMidway | None) -> Iterator[Frame]:
    """Yield the frames of all legs; see `follow`."""
    lattice = way.contact.lattice
    first = next((shifts.sites for leg in schedule.legs if (shifts := leg.shifts(lattice))), ())
    way.now = replace(way.now, way=first)
    if resume is None:
        yield way.now
    for number, leg in enumerate(schedule.legs):
        span = schedule.switches[number], schedule.switches[number + 1]
        resumed = resume if resume is not None and number == resume.leg else None
        shifts = leg.shifts(lattice)
        if resume is not None and number < resume.leg:
            if shifts is not None:
                way.now = _moved(way.now, shifts, shifts.count)
        elif shifts is not None:
            yield from way.slide(leg, shifts, number, span, resumed)
        elif leg.jumps:
            pressed = pressed_anew(way.now.contact, way.target(leg), way.solver)
            yield way.at_once(pressed, replace(way.now, time=span[1], leg=number, velocity=0.0))
        else:
            if resumed is not None:
                way.resume()
            yield from way.creep(leg, number, span, resumed)


@dataclass(eq=False)
class _Way:
    """A contact on its way through a history, ``now`` at a frame; arguments as those of `follow`."""

    contact: Contact
    times: Field
    rtol: float
    solver: ContactSolver | None
    exact: bool
    after_step: Callable[[Callable[[], LegMidway]], None] | None
    ages: Ages | None

    def __post_init__(self) -> None:
        start, at_rest = self.contact, (Fraction(0),) * self.contact.lattice.dimension
        self.now = Frame(0.0, start, 0.0, 0, 0, start.iterations, shift=at_rest, ages=self.ages)

    def resume(self) -> None:
        """Set a contact above the shifted heights; any will do to resume from."""
        if any(self.now.shift):
            self.now = replace(self.now, contact=self.shifted(self.now.shift, self.now.shift))

    def shifted(self, shift: tuple[Fraction, ...], by: tuple[Fraction, ...]) -> Contact:
        """The contact when the heights have come to a place, by a last shift."""
        return slid(self.now.contact, self.heights_at(shift, by), by, self.solver)

    def heights_at(self, shift: tuple[Fraction, ...], by: tuple[Fraction, ...]) -> Field:
        """The heights when they have come to a place, by a last shift."""
        contact, heights, way = self.now.contact, self.contact.heights, shift
        if all(sites.denominator == 1 for sites in (*shift, *by)):  # exact, and heights may have yielded
            heights, way = contact.heights, by
        return contact.lattice.shifted(heights, way)

    def shift(
        self, n: int, shift: tuple[Fraction, ...], by: tuple[Fraction, ...]
    ) -> tuple[Contact, SlideSteps | None]:
        """The contact just after the shift number n of a slide, and steps that go on if such suit it."""
        contact = self.now.contact
        if (steps := self.slide_steps(n)) is not None:
            heights, deformation = self.heights_at(shift, by), float(steps.point.u.std())
            accuracy = Accuracy(TOLERANCE, TUNING.published * fading_tolerance(self.rtol) * deformation)
            steps = steps.shifted(heights, [round(sites) for sites in by], accuracy)
            if (state := steps.state()).moved <= self.rtol * deformation:  # the solver may leave it
                bodies = contact.with_heights(heights, contact.permanent_indentation)
                counts = Counts(iterations=steps.iterations)
                return published(bodies, steps, state, Origin(0.0), counts).contact, steps
        return self.shifted(shift, by), None

    def slide_steps(self, n: int) -> SlideSteps | None:
        """Steps before the shift number n of a slide, those so far or new ones, if such suit the contact."""
        contact, steps = self.now.contact, self.now.steps_on
        if not contact.force.any():
            return None
        if n and isinstance(steps, SlideSteps):
            return steps
        system = contact.system()
        solver = chosen_solver(self.solver, system)
        return SlideSteps.resting(system, solver, contact) if SlideSteps.suits(system, solver) else None

    def at_once(self, contact: Contact, place: Frame, slip: float = 0.0) -> Frame:
        """The frame of a contact that was pressed instantly, at a place, to which it slipped in no time."""
        approach = self.now.approach + self.now.contact.separation - contact.separation
        spent: dict[str, Any] = {"steps": 0, "rejected": 0, "iterations": contact.iterations}
        if self.ages is not None:
            self.ages.slip(self.now.shift, place.shift, slip)
            self.ages.touch(contact.in_contact)
        self.now = replace(place, contact=contact, approach=approach, steps_on=None, **spent)
        return self.now

    def slide(
        self, leg: Leg, shifts: Shifts, number: int, span: tuple[float, float], resume: LegMidway | None
    ) -> Iterator[Frame]:
        """Shift, creep until the next shift, and so on."""
        begun, end = span
        lasting, start = shifts.length / leg.speed, self.now
        for n in range(0 if resume is None else resume.shifts - 1, shifts.count):
            steps, last, since = None, n + 1 == shifts.count, begun + n * lasting
            moved = replace(_moved(start, shifts, n + 1), leg=number, velocity=leg.speed)
            if resume is None:
                recorded = n % leg.every == 0 or (last and lasting == 0)
                place = replace(moved, time=since, at_a_shift=recorded, passing=lasting == 0 and not last)
                slip = 0.0 if lasting else shifts.length
                if lasting:
                    contact, steps = self.shift(n, moved.shift, shifts.sites)
                else:
                    contact = self.shifted(moved.shift, shifts.sites)
                yield self.at_once(contact, place, slip)
            else:
                self.now = moved
                self.resume()
            if lasting > 0:
                span = since, end if last else begun + (n + 1) * lasting
                yield from self.creep(leg, number, span, resume, n + 1, steps)
            resume = None

    def creep(
        self,
        leg: Leg,
        number: int,
        span: tuple[float, float],
        resume: LegMidway | None,
        shifts: int = 0,
        steps: SlideSteps | None = None,
    ) -> Iterator[Frame]:
        """March through a span of time."""
        now, (begun, end), deformation = self.now, span, 0.0
        stops = np.union1d(self.times[(self.times > begun) & (self.times < end)], [end])
        start, level = (self.start(leg), self.level) if resume is None else (resume.control, resume.level)
        control = self.prescribed(leg, start, level, end - begun)
        if resume is not None:
            begun, control = resume.begun, control.after((resume.begun - begun) * leg.mobility)
            stops = stops[(stops - begun) * leg.mobility >= resume.midway.time]
            if self.ages is not None:
                self.ages.begin(resume.midway.resume_state["ages"])
        elif control.course and not now.contact.force.any() and now.contact.has_not_crept:
            begun, control, deformation = yield from self.touch(control, leg, number, begun, stops)
            stops = stops[stops > begun]
            if not stops.size:
                return
        approach = self.now.approach if resume is None else resume.approach

        def keep(midway: Callable[[], Midway], lasted: float, state: Steps) -> None:
            if self.ages is not None:
                self.ages.creep(lasted / leg.mobility, leg.speed, state.touching)
            if self.after_step is not None:
                where = number, begun, start, level, approach
                self.after_step(lambda: LegMidway(*where, self.kept(midway()), shifts))

        frames = creep(
            self.now.contact,
            (stops - begun) * leg.mobility,
            control=control,
            keep_area=leg.hold == "area",
            rtol=self.rtol,
            solver=self.solver,
            exact=self.exact,
            deformation=deformation,
            steps=steps,
            midway=None if resume is None else resume.midway,
            after_step=keep,
        )
        if resume is None:
            next(frames)  # its start is known
        of_march = dict(zip(((stops - begun) * leg.mobility).tolist(), stops.tolist(), strict=True))
        for frame in frames:  # the last one is between the stops where the bodies part
            time = of_march.get(frame.time, begun + frame.time / leg.mobility)
            self.now = replace(
                frame,
                time=time,
                approach=approach + frame.approach,
                leg=number,
                displacement=now.displacement,
                velocity=leg.speed,
                shift=now.shift,
                ages=self.ages,
                way=now.way,
                at_a_shift=shifts > 0 and time == end and shifts % leg.every == 0,
            )
            yield self.now

    def kept(self, midway: Midway) -> Midway:
        """A place in a march with the present ages."""
        if self.ages is None:
            return midway
        return replace(midway, resume_state={**midway.resume_state, "ages": self.ages.now})

    def touch(
        self, control: Control, leg: Leg, number: int, begun: float, stops: Field
    ) -> Generator[Frame, None, tuple[float, Control, float]]:
        """Go, from where nothing is deformed, to where a march can begin: its time, control and deformation.

        Errors need a deformation to be relative to: until the first time with contact, that at this time. The
        first ``rtol`` of the way to it is applied at once; the creep before is rtol^2 / 2 of that at the
        first state.
        """
        now, pace, law = self.now, leg.mobility, self.contact.solid.adhesion
        top = float(self.now.contact.heights.max()) + (0.0 if law is None else law.reach)
        times, touching = _resolved(control, begun, float(stops[-1]), pace), begun

        def at(time: float) -> Control:
            return control.at((time - begun) * pace)

        near = 1
        if not control.load_controlled:
            near = next((n for n, time in enumerate(times) if at(time).value < top), 0)
            way = times[near - 1 : near + 1]
            touching = _root(lambda time: at(time).value - top, *way) if near else math.inf
        for time in stops[stops <= touching].tolist():
            apart = pressed_anew(now.contact, at(time), self.solver)
            yield self.at_once(apart, replace(now, time=time, leg=number))
        if not (stops > touching).any():
            return math.inf, control, 0.0
        reached = min(float(stops[stops > touching][0]), times[near])
        first, begun_at = pressed_anew(now.contact, at(reached), self.solver), touching
        begun_at += self.rtol * (reached - touching)
        start = pressed_anew(now.contact, at(begun_at), self.solver, least_force=first.residual_scale)
        self.at_once(start, now)
        return begun_at, control.after((begun_at - begun) * pace), float(first.u.std())

    @property
    def level(self) -> float:
        """Separation at which the approach was 0: under viscous creep the body is not at the mean of u0."""
        return self.now.contact.separation + self.now.approach

    def start(self, leg: Leg) -> Control:
        """What is prescribed when a leg begins."""
        contact = self.now.contact
        if not leg.target:
            return control_of(contact, leg.hold)
        if leg.moves_the_body:
            return Separation(contact.separation)
        return contact.control if contact.control.load_controlled else control_of(contact, "load")

    def target(self, leg: Leg) -> Control:
        """What a leg prescribes instantly."""
        kind, zero, unit = self.measured(leg, self.level)
        return kind(zero + unit * checks.number(leg.target, leg.value(0.0, math.nan)))

    def measured(self, leg: Leg, level: float) -> tuple[type[Control], float, float]:
        """What a leg prescribes, with the zero and the unit of its values."""
        units = {"load": 1.0, "pressure": self.contact.nominal_area}
        if leg.target in units:
            return Load, 0.0, units[leg.target]
        return (Separation, level, -1.0) if leg.target == "approach" else (Separation, 0.0, 1.0)

    def prescribed(self, leg: Leg, start: Control, level: float, lasting: float) -> Control:
        """What a leg prescribes, in times since its beginning and as fast as its mobility lets time pass."""
        if not leg.target:
            return start
        _, zero, unit = self.measured(leg, level)
        first, pace = (start.value - zero) / unit, leg.duration / (lasting * leg.mobility)

        def at(time: float) -> float:
            return zero + unit * checks.number(leg.target, leg.value(time * pace, first))

        if abs(at(0.0) - start.value) > 1e-9 * max(abs(zero), abs(start.value)):
            expected, got = f"legs that begin at what is prescribed, {start.value:g}", f"{at(0.0):g}"
            raise InputError("protocol", expected=expected, got=got, advice="a Step before it")
        return replace(start, course=Course(at, min(leg.longest, leg.duration) / pace, leg.rises(first)))


def _resolved(control: Control, begin: float, end: float, pace: float) -> list[float]:
    """Times between which what is prescribed is followed."""
    count = max(1, math.ceil((end - begin) * pace / control.longest))
    return [begin + (end - begin) * n / count for n in range(count)] + [end]


def _root(function: Callable[[float], float], begin: float, end: float) -> float:
    """Where a function is 0 between times at which its signs differ, to the last digits."""
    eps = float(np.finfo(float).eps)
    return float(scipy.optimize.brentq(function, begin, end, xtol=eps**2 * (end - begin), rtol=4 * eps))
