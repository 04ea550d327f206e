"""Implicit steps of a local law of creep: Newton's method, whichever solver finds the steps that are linear.

A step of duration tau leads the forces s of the creeping springs to where, at every site that can move,

    c s + tau v(s / a) = wanted,

with a the area of a site and c its compliance; ``wanted`` follows from the rest of the solid, the rigid body
and the rough surface. Newton's method linearizes v. Where the tangent errs too much, the equation of the site
alone is solved: it has one root, which is bracketed, so that no law overflows. Contacts are found on the way.
(Newton's method for such problems: C. Graeser, R. Kornhuber, J. Comput. Math. 27, 1 (2009).) A step is done
when the tangent errs too little over a linear step, or when the error of the state is small enough.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.contact.interface import Interface
from asperity.creep import LocalCreep
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Mask


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    most_revisions: int = 60
    """Linear problems after which a step is given up."""

    unnoticed: float = 0.3
    """Error of the tangent that is neglected, in units of the allowed error."""

    free_steps: int = 7
    """Newton steps for the force of a site after which the interval that holds it is to shrink fast."""

    shrinking: float = 0.1
    """Step over the length of the interval from which on it is halved instead."""

    rounding: float = 16 * float(np.finfo(float).eps)
    """Change of the creeping shape that rounding makes, in units of the largest length."""


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class LocalState:
    """A state of a solid that creeps by a local law, relative to the system's datum.

    ``force`` is that of the creeping springs; u - position - creeping shape is their stretch.
    """

    u: Field
    force: Field
    position: float
    """How far the rigid body has moved since the beginning."""


@dataclass(frozen=True, eq=False)
class Stage:
    """An implicit step of duration ``tau`` from the creeping shape ``before``.

    Under load control ``load`` is the normal load; else it is None and ``position`` that of the rigid body.
    A stage that comes ``again`` follows one of the same duration, for which coarse grids have been prepared.
    """

    tau: float
    before: Field
    load: float | None
    position: float
    again: bool = False


class LinearLaw:
    """A law, linear about the forces s at which a step of duration tau has arrived: v(s / a), v'(s / a)."""

    def __init__(self, law: LocalCreep, tau: float, area: float, force: Field) -> None:
        self.law, self.tau, self.area, self.force = law, tau, area, force
        self.velocity, self.slope = law.velocity(force / area)

    @cached_property
    def creep(self) -> Field:
        """How far the forces creep in the step, tau v(s / a)."""
        return self.tau * self.velocity

    @cached_property
    def drag(self) -> Field:
        """Derivative of the creep by s."""
        return (self.tau / self.area) * self.slope

    def bent(self, c: Field | float, change: Field, noticed: float) -> Mask:
        """Sites at which the tangent errs by more than ``noticed`` over a change of their forces."""
        bend = self.area * self.law.bend(self.force / self.area)
        error = c * self.drag * change * change  # over a bend the slope changes by its own size
        return np.asarray((c > 0) & ~(error <= noticed * bend * (c + self.drag)))

    def forces(self, c: Field | float, change: Field, sites: Mask) -> Field:
        """Forces at some sites by the law, in place of those by its tangent after a change."""
        c, force, change = np.broadcast_to(c, sites.shape)[sites], self.force[sites], change[sites]
        wanted = c * (force + change) + self.creep[sites] + self.drag[sites] * change
        return forces_of(self.law, c, self.tau, self.area, wanted, force + change)


def forces_of(law: LocalCreep, c: Field, tau: float, area: float, wanted: Field, start: Field) -> Field:
    """Roots s of c s + tau v(s / area) = wanted, by Newton's method in intervals that hold them.

    No law overflows in it: s is between 0 and wanted / c. An interval that Newton's method would leave, or
    shortens by little as along an exponential, is halved. Ends where the last change, of which the next is
    the square, is far below what bends the law.
    """
    low, high = np.minimum(wanted / c, 0.0), np.maximum(wanted / c, 0.0)
    at = np.clip(np.nan_to_num(start), low, high)
    for step in range(100):  # 60 halvings give all digits
        value, slope = law.velocity(at / area)
        residual = wanted - c * at - tau * value
        low, high = np.where(residual > 0, at, low), np.where(residual < 0, at, high)
        closer = at + residual / (c + tau / area * slope)
        outside = ~((closer > low) & (closer < high))
        if step >= TUNING.free_steps:
            outside |= np.abs(closer - at) > TUNING.shrinking * (high - low)
        closer = np.where(outside & (high > low), 0.5 * (low + high), closer)
        moved, at = np.abs(closer - at) / area, closer
        if (moved <= 1e-5 * law.bend(at / area) + 4 * np.spacing(np.abs(at) / area)).all():
            break
    return at


class LocalRun(ABC):
    """One step being solved."""

    rounding: float
    """Error of the creeping shape that rounding makes, a length."""
    iterations: int = 0
    """Spent so far."""

    @abstractmethod
    def measure(self) -> float:
        """Linearize the law and revise the contacts; return the rms error of the state, a length."""

    @abstractmethod
    def improve(self, allowed: float, noticed: float) -> tuple[int, float]:
        """Solve the linear step to the allowed error, or to a small part of its residual.

        Returns the iterations, and the rms error of the tangent over the last change; infinity if the linear
        step is not solved or the contacts still change. Sites whose tangent errs by more than ``noticed`` get
        their forces from the law.
        """

    @abstractmethod
    def state(self) -> LocalState:
        """The state that has been reached."""

    @abstractmethod
    def filtered_error(self, error: Field) -> tuple[float, float]:
        """Mean and rms of an error of the shape after one more such step, with the same contacts.

        Under a load the rms is about the mean.
        """


class ByLaw(ABC):
    """Solves implicit steps of one solid above one rough surface, which may yield between steps."""

    law: LocalCreep
    heights: Field
    interface: Interface

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # what is not finite does not converge
    def solve(self, stage: Stage, guess: LocalState, allowed_error: float) -> LocalRun:
        """Solve a step until the error of the creeping shape, rms, is allowed.

        An error that rounding makes is as good, once it hardly falls any more.

        Raises
        ------
        ConvergenceError
            The error did not fall that far.
        """
        run, lacking = self.begin(stage, guess), math.inf
        allowed = max(allowed_error, run.rounding)
        for revision in range(TUNING.most_revisions):
            before, lacking = lacking, run.measure()
            enough = lacking <= allowed_error or before / 2 < lacking <= run.rounding
            if enough and (revision or not lacking):
                return run
            if not math.isfinite(lacking):
                break
            noticed = TUNING.unnoticed * allowed
            spent, bent = run.improve(allowed, noticed)
            run.iterations += spent
            if bent <= noticed:
                return run
        raise ConvergenceError(
            f"creep: a step of {stage.tau:.1e} lacks {lacking:.1e} after {run.iterations} iterations, "
            f"expected {allowed_error:.1e}; try a larger rtol"
        )

    @abstractmethod
    def begin(self, stage: Stage, guess: LocalState) -> LocalRun:
        """Begin to solve a step from a guess."""

    @abstractmethod
    def stretch(self, force: Field) -> Field:
        """Stretch of the creeping springs under their force."""

    @abstractmethod
    def indented(self, force: Field) -> float:
        """Indentation by the largest force: the only length that sets rounding where surfaces are flat."""

    @abstractmethod
    def balanced(self, state: LocalState, load: float | None) -> Field:
        """Stretch with which the surface is in exact equilibrium, near that of the state."""

    @abstractmethod
    def velocity(self, force: Field) -> Field:
        """Velocity of the creeping shape."""
