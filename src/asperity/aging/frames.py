"""What a march publishes, and from what it resumes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from numpy.typing import NDArray

from asperity.aging.ages import Ages
from asperity.aging.constant_area import ConstantArea
from asperity.aging.controller import Controller
from asperity.aging.separable import SeparableSteps
from asperity.aging.tr_bdf2 import Origin, State, Steps
from asperity.contact.bodies import Bodies
from asperity.contact.contact import Contact
from asperity.contact.problem import Solution
from asperity.contact.publish import contact_from
from asperity.contact.waves import friction_of_slopes, slope_along


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
    displacement, velocity
        Length that the rough surface has slid since the start, and how fast it slides in this leg.
    shift
        Sites along each axis by which it has moved since the start.
    way
        Sites along each axis of the last shift, or of the first one to come; none if it never slides.
    at_a_shift
        Whether it is to be recorded as the state just before or just after a shift.
    passing
        Whether more shifts follow at the same time.
    parted
        Whether the bodies part just after it, for adhesion bears no more, and the history ends.
    ages
        Ages of the sites in contact, for a shear strength that grows with them; they age on after it.
    steps_on
        The time steps that led here, from which a slide goes on; None after a jump.
    """

    time: float
    contact: Contact
    approach: float
    steps: int
    rejected: int
    iterations: int
    leg: int = 0
    displacement: float = 0.0
    velocity: float = 0.0
    shift: tuple[Fraction, ...] = ()
    way: tuple[Fraction, ...] = ()
    at_a_shift: bool = False
    passing: bool = False
    parted: bool = False
    ages: Ages | None = None
    steps_on: Steps | None = None

    @cached_property
    def hysteresis_friction(self) -> float:
        """Force of the slopes of the rough surface against its motion, or against that to come, if any."""
        contact = self.contact
        if not self.way:
            return math.nan
        slope = slope_along(contact.lattice, self.way)
        return friction_of_slopes(contact.lattice, slope, contact.heights, contact.u, contact.force)

    @property
    def hysteresis_friction_coefficient(self) -> float:
        """The same over the load; not a number without load."""
        return self.hysteresis_friction / (self.contact.load or math.nan)

    @property
    def solved_by(self) -> str:
        """Kind of the time steps that led here, or "".

        "exact" (see `asperity.aging.separable`), "springs" (by multigrid), "fields" (by Fourier modes, also
        where cycles got nowhere), "slides" (the same between shifts) or "laws".
        """
        return "" if self.steps_on is None else self.steps_on.kind

    @property
    def exact(self) -> bool:
        """Whether the contacts have no error of time steps."""
        return isinstance(self.steps_on, SeparableSteps)


@dataclass(frozen=True, eq=False)
class Midway:
    """State from which a new march resumes, at a time between two frames, to identical results.

    That are the kind of time steps and their arrays, what the rigid approach is measured from, the scale of
    the error, how long the next step is, what was counted since the last frame, how the area is kept, if it
    is, and whether the bodies are about to part.
    """

    time: float
    kind: str
    resume_state: Mapping[str, NDArray[Any]]
    origin: Origin
    deformation: float
    controller: Controller
    counts: Counts
    area: ConstantArea | None = None
    parting: bool = False


@dataclass
class Counts:
    """Steps taken, steps repeated, and iterations since the last frame."""

    steps: int = 0
    rejected: int = 0
    iterations: int = 0


def published(start: Bodies, now: Steps, state: State, origin: Origin, counts: Counts) -> Frame:
    """The present state of what a contact has become, in exact equilibrium."""
    system, (u, anchors, position, _) = now.system.at(now.time), state
    solution = Solution(u, u <= system.heights, counts.iterations, 0)
    contact = contact_from(system, solution, anchors, position, bodies=start)
    approach = now.approach(origin, contact.separation)
    return Frame(now.time, contact, approach, **vars(counts), steps_on=now)
