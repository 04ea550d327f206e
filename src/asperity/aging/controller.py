"""How long time steps are, by the errors of those before: numbers alone, whatever creeps."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Tuning:
    """Numbers chosen by measurement."""

    step_error: float = 3.0
    """One time step may err by ``(step_error * rtol) ** 1.5`` deformations.

    The errors of a second-order method whose steps err by e each add up to a multiple of e^(2/3). That
    multiple was measured to lie between 0.03 and 0.29 over 20 cases (k1/k0 from 0.01 to 100, contact
    fractions from 0.002 to 0.5, two kinds of surface, both controls, with viscous creep and without), so
    that the sum stays below ``rtol``. (With contact problems solved exactly; what solvers leave is in the
    tests of ``rtol``, which hold with it.)
    """

    first: float = 0.1
    """Part of the deformation by which the anchors move in the first step, at a tolerance of 1; goes like its
    cube root."""

    margin: float = 0.9
    """Length of the next step over that with which it would err by what is allowed."""

    growth: float = 4.0
    """Largest growth of the length from step to step."""

    shrinkage: float = 0.2
    """Smallest part to which the length falls when a step is repeated, and where it was not solved."""

    most_unsolved: int = 20
    """Steps that are not solved, while time doubles, after which others are not going to succeed."""

    most_steps: float = 30.0
    """Time steps as long as errors let them be in which time must at least double, over tolerance^(-1/3).

    Steps of a method whose error grows like their cube are as many as these units.
    """


TUNING = Tuning()


def step_tolerance(rtol: float) -> float:
    """Error that one time step may have, in deformations, so that all err by ``rtol``."""
    return float((TUNING.step_error * rtol) ** 1.5)


@dataclass
class Controller:
    """Chooses the length of the next time step, which may err by the tolerance, in deformations.

    Steps ``tried`` that errors shorten, and those ``unsolved``, are counted ``since`` a time that is set anew
    whenever time has doubled; ``wished`` is the length of the first of those not solved.
    """

    tolerance: float
    length: float = math.inf
    tried: int = 0
    unsolved: int = 0
    since: float = 0.0
    wished: float = math.inf

    def begin(self, deformation: float, speed: float) -> None:
        """Set the length of the first step: u0 changes by a small part of the deformation."""
        if speed > 0 and deformation > 0:
            self.length = TUNING.first * self.tolerance ** (1 / 3) * deformation / speed

    def step(self, time: float, stop: float, longest: float = math.inf) -> float:
        """Length of the step from a time toward a stop, exactly all that is left where it ends there."""
        if time > 2 * self.since:
            self.tried, self.unsolved, self.since = 0, 0, time
        remaining, usual = stop - time, min(self.length, longest)
        if usual >= remaining * (1 - 1e-9):  # else rounding would leave a step of nothing
            return remaining
        # Two equal steps rather than a long one and a very short one.
        return remaining / 2 if 2 * usual > remaining else usual

    def is_stuck(self, time: float, length: float) -> bool:
        """Whether further steps of a length from a time are useless."""
        many = self.tried * self.tolerance ** (1 / 3) > TUNING.most_steps
        # The last: so short a step that time, in double precision, does not pass.
        return many or self.unsolved > TUNING.most_unsolved or not time + length > time

    def accepts(self, length: float, error: float) -> bool:
        """Whether a step that was tried was accurate, by its error in units of what is allowed.

        That of a step that was not solved is infinite. The length of the next one follows, as errors grow
        like its cube.
        """
        self.tried += error > 1 or length >= self.length  # else a stop or a leg made it short
        growth = TUNING.growth
        change = max(TUNING.shrinkage, TUNING.margin * error ** (-1 / 3)) if error > 0 else growth
        change = min(change, growth)
        if not math.isfinite(error):
            self.wished = self.wished if self.unsolved else length
            self.unsolved += 1
        if error > 1:
            self.length = length * change
            return False
        # A step that a stop made short says nothing against the length before it.
        self.length = max(length * change, min(self.length, growth * length))
        return True

    def start_over(self, time: float) -> None:
        """Forget failures, as another kind of steps takes over at a time."""
        self.length = self.wished if self.unsolved else self.length
        self.tried, self.unsolved, self.since = 0, 0, time
