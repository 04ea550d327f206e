r"""TR-BDF2: the second-order, L-stable method by which u0 creeps; each stage is a contact problem.

One step of length h from (u0, f0), with f = M C (u - u0) the rate:

    stage 1   v = u0 + d h f0                    (trapezoid to t + 2 d h)
    stage 2   v = u0 + w h (f0 + f1)             (backward differences to t + h)
    each:     solve the implicit step of duration d h from v for u and u0, then f = M C (u - u0)

    d = 1 - 1/sqrt 2,   w = sqrt 2 / 4

Stage 2 is the result (stiffly accurate). The difference to the companion of order three,

    e = h [ (1 - 4 w)/3 f0 + 1/3 f1 - 2 d/3 f2 ] / (1 + d h z),     z = M C H / (H + C),

estimates its error. The denominator, with the free surface's decay rates z, keeps stiff modes from
being overrated. A load that changes in time enters at the stages' own times; a rigid body that moves
adds its velocity V to f, and the contact problem of a stage starts from v + d h V.
(R. E. Bank et al., IEEE Trans. Electron Devices 32, 1992 (1985),
DOI 10.1109/T-ED.1985.22232; M. E. Hosea, L. F. Shampine, Appl. Numer. Math. 20, 21 (1996),
DOI 10.1016/0168-9274(95)00115-8.)
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from asperity.contact.arrays import largest
from asperity.contact.mechanics import ImplicitStep
from asperity.contact.problem import ContactSolver, Guess
from asperity.contact.state import Contact
from asperity.contact.stencils import combined
from asperity.contact.system import System
from asperity.lattice import Field

DIAGONAL = 1.0 - 1.0 / math.sqrt(2.0)
WEIGHT = math.sqrt(2.0) / 4.0
ERROR_WEIGHTS = ((1 - 4 * WEIGHT) / 3, 1 / 3, -2 * DIAGONAL / 3)


@dataclass(frozen=True, eq=False)
class Point:
    """The state of the creeping system at one time, relative to the system's datum.

    ``stretch`` is w = u - u0, ``rate`` is d u0 / dt.
    """

    time: float
    u: Field
    stretch: Field
    rate: Field

    @property
    def u0(self) -> Field:
        """The creeping shape."""
        return combined((1.0, self.u), (-1.0, self.stretch))

    @classmethod
    def of(cls, system: System, contact: Contact) -> Point:
        """Take a published contact as the state at time 0."""
        stretch = contact.u - contact.u0
        return cls(0.0, contact.u - system.datum, stretch, system.creep_rate(stretch))


@dataclass(frozen=True, eq=False)
class Past:
    """A surface that was, from which to extrapolate."""

    time: float
    u: Field

    @classmethod
    def of(cls, point: Point) -> Past:
        """Remember a point."""
        return cls(point.time, point.u)


@dataclass(frozen=True, eq=False)
class Step:
    """The outcome of one time step: its end, the error of u0 (rms over sites) and the iterations spent."""

    end: Point
    error: float
    iterations: int


def take_step(
    system: System,
    solver: ContactSolver,
    duration: float,
    start: Point,
    earlier: Past | None,
    *,
    tolerances: tuple[float, float],
) -> Step:
    """Take one time step from ``start``.

    ``earlier`` helps to guess where the contacts will be; ``tolerances`` are those of the two contact
    problems.
    """
    implicit = system.mechanics.implicit_step(DIAGONAL * duration)
    u0, f0 = start.u0, start.rate

    middle, spent = _stage(
        system,
        implicit,
        DIAGONAL * duration,
        solver,
        time=start.time + 2 * DIAGONAL * duration,
        before=combined((1.0, u0), (DIAGONAL * duration, f0)),
        known=(earlier, start),
        tolerance=tolerances[0],
    )
    end, spent_again = _stage(
        system,
        implicit,
        DIAGONAL * duration,
        solver,
        time=start.time + duration,
        before=combined((1.0, u0), (WEIGHT * duration, f0), (WEIGHT * duration, middle.rate)),
        known=(Past.of(start), middle),
        tolerance=tolerances[1],
    )
    rates = (f0, middle.rate, end.rate)
    defect = combined(*zip(ERROR_WEIGHTS, rates, strict=True))
    error = duration * system.damped_rms(defect, DIAGONAL * duration)
    return Step(end, error, spent + spent_again)


def rms(field: Field) -> float:
    """Root mean square over the sites."""
    scale = largest(field, np)
    if not 0 < scale < math.inf:
        return scale
    field = field / scale
    return scale * math.sqrt(float(np.einsum("i,i->", field.ravel(), field.ravel())) / field.size)


def _stage(
    system: System,
    implicit: ImplicitStep,
    tau: float,
    solver: ContactSolver,
    *,
    time: float,
    before: Field,
    known: tuple[Past | None, Point],
    tolerance: float,
) -> tuple[Point, int]:
    """Solve one implicit stage that ends at ``time``; its end and the iterations spent."""
    anchors = before + tau * system.drift if system.drift else before
    system = system.at(time)
    guess = _extrapolate(time, *known)
    solution = solver.solve(system.problem(implicit, anchors), guess, tolerance)
    stretch = system.stretch(implicit, solution, anchors)
    pace = 1.0 / tau
    rate = combined((pace, solution.u), (-pace, stretch), (-pace, before))
    if system.control.load_controlled:
        rate -= rate.mean()
    return Point(time, solution.u, stretch, rate), solution.iterations


def _extrapolate(time: float, earlier: Past | None, latest: Point) -> Guess:
    """Continue the surface in the logarithm of time, which is how contacts grow."""
    if earlier is None:
        return Guess(latest.u)
    factor = ahead(earlier.time, latest.time, time)
    u = combined((1.0 + factor, latest.u), (-factor, earlier.u))
    return Guess(u, disposable=True)


def ahead(earlier: float, latest: float, time: float) -> float:
    """How far a time is ahead of the latest, over how far that is ahead of an earlier one.

    In the logarithm of time, in which contacts grow evenly; at most 2.
    """
    if earlier > 0:
        return min(math.log(time / latest) / math.log(latest / earlier), 2.0)
    return min((time - latest) / (latest - earlier), 2.0)


@dataclass(frozen=True)
class Attempt:
    """Outcome of a time step that is tried: the error of u0 (rms over sites), and the iterations spent."""

    error: float
    iterations: int


@dataclass(frozen=True)
class Extent:
    """How large a deformation is: u about its mean and w, rms over the sites, and the largest u; lengths."""

    spread: float
    stretch: float
    largest: float


class Steps(Protocol):
    """A creeping state that takes time steps; fields relative to the system's datum."""

    time: float
    system: System

    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the time step that was tried."""
        ...

    def state(self) -> tuple[Field, Field]:
        """U and w = u - u0, not to be changed."""
        ...

    def extent(self) -> Extent:
        """How large the deformation is."""
        ...

    def speed(self) -> float:
        """Rate of u0, rms over the sites."""
        ...

    def attempt(
        self, duration: float, tolerances: tuple[float, float], allowed_errors: tuple[float, float]
    ) -> Attempt:
        """Try a time step, to tolerances of both contact problems or errors of u0 allowed in both stages."""
        ...

    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""
        ...

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """Arrays from which another march resumes, to identical results."""
        ...


class FieldSteps:
    """A creeping state of any solid, whose contact problems any solver solves."""

    def __init__(self, system: System, solver: ContactSolver, arrays: Mapping[str, NDArray[Any]]) -> None:
        self.system, self.solver = system, solver
        self.point = Point(float(arrays["time"]), arrays["u"], arrays["stretch"], arrays["rate"])
        self.earlier = None
        if "earlier" in arrays:
            self.earlier = Past(float(arrays["earlier"]), arrays["earlier_u"])
        self.end = self.point

    @classmethod
    def begin(cls, system: System, solver: ContactSolver, point: Point) -> FieldSteps:
        """At the start of a history."""
        arrays = {
            "time": np.asarray(point.time),
            "u": point.u,
            "stretch": point.stretch,
            "rate": point.rate,
        }
        return cls(system, solver, arrays)

    @property
    def time(self) -> float:
        """Time of the state."""
        return self.point.time

    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the time step that was tried."""
        return int(np.count_nonzero(self.end.u <= self.system.heights))

    def state(self) -> tuple[Field, Field]:
        """U and w."""
        return self.point.u, self.point.stretch

    def extent(self) -> Extent:
        """How large the deformation is."""
        u, stretch = self.state()
        return Extent(float(u.std()), rms(stretch), largest(u, np))

    def speed(self) -> float:
        """Rate of u0, rms over the sites."""
        return rms(self.point.rate)

    def attempt(
        self, duration: float, tolerances: tuple[float, float], allowed_errors: tuple[float, float]
    ) -> Attempt:
        """Try a time step; the contact problems are solved to their tolerances, whatever error is allowed."""
        del allowed_errors
        step = take_step(self.system, self.solver, duration, self.point, self.earlier, tolerances=tolerances)
        self.end = step.end
        return Attempt(step.error, step.iterations)

    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""
        self.earlier = Past.of(self.point)
        self.point = replace(self.end, time=time)

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """See `Steps`."""
        point, earlier = self.point, self.earlier
        arrays = {
            "time": np.asarray(point.time),
            "u": point.u,
            "stretch": point.stretch,
            "rate": point.rate,
        }
        if earlier is None:
            return arrays
        return arrays | {"earlier": np.asarray(earlier.time), "earlier_u": earlier.u}
