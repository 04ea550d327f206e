r"""TR-BDF2: the second-order, L-stable method by which anchors creep; each stage is a contact problem.

One step of length h from anchors u_b with rates f0_b = M_b C_b (u - u_b), for all branches at once:

    stage 1   v = u_b + d h f0                   (trapezoid to t + 2 d h)
    stage 2   v = u_b + w h (f0 + f1)            (backward differences to t + h)
    each:     solve the implicit step of duration d h from v for u and u_b, then f = M_b C_b (u - u_b)

    d = 1 - 1/sqrt 2,   w = sqrt 2 / 4

Stage 2 is the result (stiffly accurate). The difference to the companion of order three,

    e = h [ (1 - 4 w)/3 f0 + 1/3 f1 - 2 d/3 f2 ],

estimates its error, after one more implicit step of duration d h, from e and with the contacts as they are:
that keeps what decays quickly, in contact above all, from being overrated. (Where stages are solved no
better than a step needs, that step is estimated too.) Branches count by their stiffness. A load that
changes in time enters at the stages' own times; a rigid body that moves adds its velocity V to f, and the
contact problem of a stage starts from v + d h V.
(R. E. Bank et al., IEEE Trans. Electron Devices 32, 1992 (1985),
DOI 10.1109/T-ED.1985.22232; M. E. Hosea, L. F. Shampine, Appl. Numer. Math. 20, 21 (1996),
DOI 10.1016/0168-9274(95)00115-8.)

Anchors, stretches and rates are Fourier modes, so that a branch costs no transform.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from asperity.aging.step_errors import damped, filtered, left_of, modes_rms
from asperity.contact.active_set import ActiveSet
from asperity.contact.arrays import largest
from asperity.contact.branches import add_creep
from asperity.contact.mechanics import ImplicitStep, SpectralMechanics
from asperity.contact.problem import ContactSolver, Guess
from asperity.contact.state import AnchorModes, Contact
from asperity.contact.system import System
from asperity.lattice import Field, Modes

DIAGONAL = 1.0 - 1.0 / math.sqrt(2.0)
WEIGHT = math.sqrt(2.0) / 4.0
ERROR_WEIGHTS = ((1 - 4 * WEIGHT) / 3, 1 / 3, -2 * DIAGONAL / 3)


@dataclass(frozen=True, eq=False)
class Point:
    """The state of the creeping system at one time, relative to the system's datum.

    Attributes
    ----------
    time
        The time.
    u
        The surface, a field.
    modes
        Its Fourier modes.
    stretch
        w_b = u - u_b, Fourier modes, branches first.
    position
        That of the rigid body.
    """

    time: float
    u: Field
    modes: Modes
    stretch: Modes
    position: float

    @classmethod
    def of(cls, system: System, time: float, u: Field, stretch: Field, position: float) -> Point:
        """A state whose stretches are fields."""
        lattice = system.mechanics.lattice
        return cls(time, u, lattice.forward(u), lattice.forward(stretch), position)

    def rate(self, system: System) -> Modes:
        """Rates d u_b / dt, Fourier modes."""
        rate = system.mechanics.spectral.spectra.rate * self.stretch
        if system.drift:
            rate[system.mechanics.lattice.mean] += system.drift * system.sites
        return np.asarray(rate)


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
    """The outcome of one time step: its end, the error of the anchors (rms over sites), iterations spent."""

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
    allowed_errors: tuple[float, float] = (0.0, 0.0),
    ahead: float = 0.0,
) -> Step:
    """Take one time step from ``start``.

    ``earlier`` helps to guess where the contacts will be; ``tolerances`` are those of the two contact
    problems. The error of a step whose problems are solved to them is what is left a time ``ahead`` of its
    end, or a tenth of what it is there if that is more; but what contacts that open no longer hold stays.
    """
    tau, weight = DIAGONAL * duration, WEIGHT * duration
    implicit = system.mechanics.implicit_step(tau)
    middle, spent = _stage(
        system,
        implicit,
        solver,
        time=start.time + 2 * tau,
        before=_combined(system, start.modes, (-1.0, tau, start.stretch)),
        position=start.position,
        known=(earlier, start),
        tolerance=tolerances[0],
        allowed_error=allowed_errors[0],
        settled=False,
    )
    end, spent_again = _stage(
        system,
        implicit,
        solver,
        time=start.time + duration,
        before=_combined(system, start.modes, (-1.0, weight, start.stretch), (0.0, weight, middle.stretch)),
        position=start.position,
        known=(Past.of(start), middle),
        tolerance=tolerances[1],
        allowed_error=allowed_errors[1],
    )
    points = zip(ERROR_WEIGHTS, (start, middle, end), strict=True)
    defect = _combined(system, 0.0, *((0.0, weight, point.stretch) for weight, point in points))
    in_contact, more = end.u <= system.heights, 0
    if any(allowed_errors):
        defect = damped(defect, system, implicit.spectral, np.count_nonzero(in_contact) / system.sites)
    else:
        defect, more = filtered(defect, system, implicit.spectral, in_contact)
    error = modes_rms(defect, system)
    opened = bool(((start.u <= system.heights) & ~in_contact).any())
    if ahead > 0 and error > 0 and not opened:
        error, also = left_of(defect, system, ahead, in_contact)
        more += also
    return Step(end, duration * error, spent + spent_again + more)


def _combined(system: System, u: Modes | float, *terms: tuple[float, float, Modes]) -> Modes:
    """Modes u and a number of times w_b, and what u_b creeps at the rate there in a time, of each term."""
    stretch = terms[0][2]
    modes = np.empty(stretch.shape, stretch.dtype)
    modes[...] = u
    for number, duration, stretch in terms:
        add_creep(modes, number, duration, system.mechanics.spectral.spectra.rate, stretch)
    if system.drift:
        drift = system.drift * system.sites
        modes[system.mechanics.lattice.mean] += drift * sum(duration for _, duration, _ in terms)
    return modes


def _stage(
    system: System,
    implicit: ImplicitStep,
    solver: ContactSolver,
    *,
    time: float,
    before: Modes,
    position: float,
    known: tuple[Past | None, Point],
    tolerance: float,
    allowed_error: float,
    settled: bool = True,
) -> tuple[Point, int]:
    """Solve one implicit stage that ends at ``time``; its end and the iterations spent.

    ``before`` are the anchors v while the rigid body is at ``position``.
    """
    if system.drift:
        before[system.mechanics.lattice.mean] += implicit.tau * system.drift * system.sites
    held = system.at(time).held(position)
    problem = implicit.problem_of_modes(system.heights, before, held)
    guess = _extrapolate(time, *known)
    if isinstance(solver, ActiveSet):
        solution = solver.solve(problem, guess, tolerance, allowed_error, settled=settled)
    else:
        solution = solver.solve(problem, guess, tolerance)
    lattice, (_, latest) = system.mechanics.lattice, known
    if settled or not allowed_error:  # steps begin with modes that are exact
        modes = lattice.forward(solution.u)
    else:
        modes = lattice.forward_near(solution.u, latest.u, latest.modes)
    stretch, position = implicit.spectral.stretch_modes(modes, before, held)
    return Point(time, solution.u, modes, stretch, position), solution.iterations


def _extrapolate(time: float, earlier: Past | None, latest: Point) -> Guess:
    """Continue the surface in the logarithm of time, which is how contacts grow."""
    if earlier is None:
        return Guess(latest.u, near=(latest.u, latest.modes))
    factor = ahead(earlier.time, latest.time, time)
    u = latest.u + factor * (latest.u - earlier.u)  # contacts stay where they are, to the last digit
    return Guess(u, disposable=True, near=(latest.u, latest.modes))


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


class Aim(NamedTuple):
    """How accurate a time step is to be.

    Attributes
    ----------
    tolerances
        Those of both contact problems.
    allowed_errors
        Errors of u0 that a solver may leave in both stages instead.
    published
        Time of the next state that is published: creep forgets errors, so those of steps on the lattice of
        springs count by what is left of them then, if it is later than the end of the step.
    """

    tolerances: tuple[float, float]
    allowed_errors: tuple[float, float]
    published: float = 0.0


@dataclass(frozen=True)
class Extent:
    """How large a deformation is: u about its mean and w, rms over the sites, and the largest u; lengths."""

    spread: float
    stretch: float
    largest: float


Creep = TypeVar("Creep", covariant=True, bound=Field | AnchorModes)


class State(NamedTuple, Generic[Creep]):
    """A state to publish: u, w_b or the modes of the anchors, and the position of the rigid body."""

    u: Field
    creep: Creep
    position: float


class Steps(Protocol):
    """A creeping state that takes time steps; fields relative to the system's datum."""

    system: System

    @property
    def time(self) -> float:
        """Time of the state."""
        ...

    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the time step that was tried."""
        ...

    def state(self) -> State[Field | AnchorModes]:
        """What is to be published; not to be changed."""
        ...

    def extent(self) -> Extent:
        """How large the deformation is."""
        ...

    def speed(self) -> float:
        """Rate of the anchors, rms over the sites."""
        ...

    def attempt(self, duration: float, aim: Aim) -> Attempt:
        """Try a time step."""
        ...

    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""
        ...

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """Arrays from which another march resumes, to identical results."""
        ...


class FieldSteps:
    """A creeping state of any solid, whose contact problems any solver solves.

    Attributes
    ----------
    point
        The state.
    """

    def __init__(self, system: System, solver: ContactSolver, arrays: Mapping[str, NDArray[Any]]) -> None:
        self.system, self.solver = system, solver
        u, (time, position) = arrays["u"], arrays["time"].tolist()
        self.point = Point(time, u, system.mechanics.lattice.forward(u), arrays["stretch"], position)
        self.earlier = None
        if "earlier" in arrays:
            self.earlier = Past(float(arrays["earlier"]), arrays["earlier_u"])
        self.end = self.point
        # Whether contact problems are solved no better than a step needs: what that leaves off contact is
        # balanced where a state is published.
        mechanics = system.mechanics
        self.eager = isinstance(mechanics, SpectralMechanics) and mechanics.anchors_can_balance

    @classmethod
    def begin(cls, system: System, solver: ContactSolver, start: Contact) -> FieldSteps:
        """At the start of a history."""
        point = Point.of(
            system, 0.0, start.u - system.datum, start.u - start.anchors, start.separation - system.datum
        )
        return cls(system, solver, _arrays(point))

    @classmethod
    def going_on(cls, system: System, time: float, state: State[Field]) -> FieldSteps:
        """From where other steps have come to."""
        return cls(system, ActiveSet(), _arrays(Point.of(system, time, *state)))

    @property
    def time(self) -> float:
        """Time of the state."""
        return self.point.time

    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the time step that was tried."""
        return int(np.count_nonzero(self.end.u <= self.system.heights))

    def state(self) -> State[Field | AnchorModes]:
        """See `Steps`."""
        point, mechanics = self.point, self.system.mechanics
        if not self.eager:
            return State(point.u, mechanics.lattice.backward(point.stretch), point.position)
        held, touching = self.system.at(point.time).held(point.position), point.u <= self.system.heights
        change = mechanics.spectral.balancing(point.modes, point.stretch, touching, held)
        return State(point.u, AnchorModes((point.modes - change) - point.stretch), point.position)

    def extent(self) -> Extent:
        """How large the deformation is."""
        u, stretch = self.point.u, self.system.mechanics.spectral.rms(self.point.stretch)
        return Extent(float(u.std()), stretch, largest(u, np))

    def speed(self) -> float:
        """Rate of the anchors, rms over the sites."""
        return self.system.mechanics.spectral.rms(self.point.rate(self.system))

    def attempt(self, duration: float, aim: Aim) -> Attempt:
        """Try a time step; `ActiveSet` solves the contact problems to the errors allowed."""
        springs = self.system.mechanics.spectral.solid.springs is not None
        step = take_step(
            self.system,
            self.solver,
            duration,
            self.point,
            self.earlier,
            tolerances=aim.tolerances,
            allowed_errors=aim.allowed_errors if self.eager else (0.0, 0.0),
            ahead=aim.published - self.time - duration if springs else 0.0,
        )
        self.end = step.end
        return Attempt(step.error, step.iterations)

    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""
        self.earlier = Past.of(self.point)
        self.point = replace(self.end, time=time)
        self.system = self.system.lowered(self.end.u)

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """See `Steps`."""
        arrays = _arrays(self.point)
        if self.earlier is None:
            return arrays
        return arrays | {"earlier": np.asarray(self.earlier.time), "earlier_u": self.earlier.u}


def _arrays(point: Point) -> dict[str, NDArray[Any]]:
    return {"time": np.array([point.time, point.position]), "u": point.u, "stretch": point.stretch}
