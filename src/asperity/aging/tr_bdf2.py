r"""TR-BDF2: the second-order, L-stable method by which u0 creeps; each stage is a contact problem.

One step of length h from (u0, f0), with f = M C (u - u0) the rate:

    stage 1   v = u0 + d h f0                    (trapezoid to t + 2 d h)
    stage 2   v = u0 + w h (f0 + f1)             (backward differences to t + h)
    each:     solve the implicit step of duration d h from v for u and u0, then f = M C (u - u0)

    d = 1 - 1/sqrt 2,   w = sqrt 2 / 4

Stage 2 is the result (stiffly accurate). The difference to the companion of order three,

    e = h [ (1 - 4 w)/3 f0 + 1/3 f1 - 2 d/3 f2 ] / (1 + d h z),     z = M C H / (H + C),

estimates its error; the denominator, with the free surface's decay rates z, keeps stiff modes from
being overrated. (R. E. Bank et al., IEEE Trans. Electron Devices 32, 1992 (1985),
DOI 10.1109/T-ED.1985.22232; M. E. Hosea, L. F. Shampine, Appl. Numer. Math. 20, 21 (1996),
DOI 10.1016/0168-9274(95)00115-8.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asperity.contact.problem import ContactSolver, Guess, Solution
from asperity.contact.state import Contact
from asperity.contact.system import ImplicitStep, System
from asperity.lattice import Field, Lattice, Modes

DIAGONAL = 1.0 - 1.0 / math.sqrt(2.0)
WEIGHT = math.sqrt(2.0) / 4.0


@dataclass(frozen=True, eq=False)
class Point:
    """The state of the creeping system at one time; fields relative to the system's datum."""

    time: float
    surface: Modes
    shape: Modes
    rate: Modes
    solution: Solution

    @classmethod
    def of(cls, system: System, contact: Contact) -> Point:
        """Take a published contact as the state at time 0."""
        u = contact.u - system.datum
        solution = Solution(u, contact.in_contact, contact.force, contact.residual, 0, 0)
        surface = system.lattice.forward(u)
        shape = system.lattice.forward(contact.u0 - system.datum)
        return cls(0.0, surface, shape, system.creep_rate(surface, shape), solution)


@dataclass(frozen=True, eq=False)
class Past:
    """A surface that was, from which to extrapolate."""

    time: float
    u: Field

    @classmethod
    def of(cls, point: Point) -> Past:
        """Remember a point."""
        return cls(point.time, point.solution.u)


@dataclass(frozen=True, eq=False)
class Step:
    """The outcome of one step: its end, the error of u0 (rms over sites) and the iterations spent."""

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
    """Step from ``start``.

    ``earlier`` helps to guess where the contacts will be; ``tolerances`` are those of the two contact
    problems, of which only the second may be published.
    """
    implicit = system.implicit_step(DIAGONAL * duration)
    u0, f0 = start.shape, start.rate

    middle = _stage(
        implicit,
        solver,
        time=start.time + 2 * DIAGONAL * duration,
        before=u0 + (DIAGONAL * duration) * f0,
        known=(earlier, start),
        tolerance=tolerances[0],
    )
    end = _stage(
        implicit,
        solver,
        time=start.time + duration,
        before=u0 + (WEIGHT * duration) * (f0 + middle.rate),
        known=(Past.of(start), middle),
        tolerance=tolerances[1],
    )
    defect = (1 - 4 * WEIGHT) / 3 * f0 + middle.rate / 3 - 2 * DIAGONAL / 3 * end.rate
    error = duration * defect / (1 + DIAGONAL * duration * free_decay_rate(system))
    return Step(end, rms(system.lattice, error), middle.solution.iterations + end.solution.iterations)


def free_decay_rate(system: System) -> Field:
    """Rate z(q) at which a mode of u0 decays off contact (the paper's z_q)."""
    H, C, M = system.spectra.permanent, system.spectra.creeping, system.spectra.mobility
    return M * C * H / (H + C)


def rms(lattice: Lattice, modes: Modes) -> float:
    """Root mean square over the sites of the field that has these modes."""
    return math.sqrt(lattice.mean_over_modes(np.abs(modes) ** 2) / lattice.sites)


def _stage(
    implicit: ImplicitStep,
    solver: ContactSolver,
    *,
    time: float,
    before: Modes,
    known: tuple[Past | None, Point],
    tolerance: float,
) -> Point:
    """Solve one implicit stage that ends at ``time``."""
    guess = _extrapolate(implicit.system, time, *known)
    solution = solver.solve(implicit.problem(before), guess, tolerance)
    surface = implicit.system.lattice.forward(solution.u)
    shape = implicit.crept_shape(surface, before)
    rate = implicit.system.creep_rate(surface, shape)
    return Point(time, surface, shape, rate, solution)


def _extrapolate(system: System, time: float, earlier: Past | None, latest: Point) -> Guess:
    """Continue the surface in the logarithm of time, which is how contacts grow."""
    u = latest.solution.u
    if earlier is None:
        return Guess(u, latest.solution.in_contact)
    if earlier.time > 0:
        ahead = math.log(time / latest.time) / math.log(latest.time / earlier.time)
    else:
        ahead = (time - latest.time) / (latest.time - earlier.time)
    predicted = u + min(ahead, 2.0) * (u - earlier.u)
    return Guess(predicted, predicted <= system.heights)
