r"""The contact problem that every solver solves, and the one residual by which each is judged.

Given a stiffness spectrum S >= 0, a pull b and an obstacle xi, find the surface u with

    r = S u - b,      0 <= r   perpendicular to   u - xi >= 0        (Signorini conditions),

which minimizes 1/2 u.S u - b.u over u >= xi. r is the contact force, site by site. Where
S vanishes at wave vector 0 the sum of r is fixed by the pull: load control without feedback.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from asperity.lattice import Field, Lattice, Mask, Modes, Spectrum


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """One contact problem; see the module for the equations.

    Parameters
    ----------
    lattice
        The periodic lattice.
    stiffness
        S, a spectrum; positive but, under load control, zero at wave vector 0.
    pull
        b, as Fourier modes; under load control minus the normal load at wave vector 0.
    heights
        The obstacle xi, a field whose maximum is 0, which keeps rounding errors relative to the
        indentation rather than to the datum of the heights.
    """

    lattice: Lattice
    stiffness: Spectrum
    pull: Modes
    heights: Field

    @property
    def load_controlled(self) -> bool:
        """Whether the sum of the forces is prescribed."""
        return bool(self.stiffness.flat[0] == 0)

    def force(self, u: Field) -> Field:
        """Contact force r = S u - b at every site."""
        return self.lattice.backward(self.stiffness * self.lattice.forward(u) - self.pull)


@dataclass(frozen=True, eq=False)
class Guess:
    """Where a solver starts: a surface and the sites believed to be in contact."""

    u: Field
    in_contact: Mask


@dataclass(frozen=True, eq=False)
class Solution:
    """A solved contact problem.

    ``u`` equals the heights on ``in_contact`` and exceeds them elsewhere; ``force`` is S u - b as
    evaluated, so that it shows the residual off contact; ``iterations`` counts conjugate-gradient
    iterations and ``set_changes`` the times the set of contacts was revised.
    """

    u: Field
    in_contact: Mask
    force: Field
    residual: float
    iterations: int
    set_changes: int


class ContactSolver(Protocol):
    """What a solver offers."""

    def solve(self, problem: ContactProblem, guess: Guess, tolerance: float) -> Solution:
        """Solve until no force off contact exceeds ``tolerance`` times the mean contact force.

        Or until rounding errors forbid more, which the solution's residual then shows. Otherwise
        raise `ConvergenceError`; never return unconverged.
        """
        ...


TOLERANCE = 1e-9
"""The tolerance to which published states are solved; the residual they carry shows it."""


def residual(force: Field, in_contact: Mask, smallest_scale: float = 0.0) -> float:
    """Largest violation of equilibrium, relative to the mean contact force.

    Off contact any force is a violation; in contact a pulling (negative) one is. Penetration needs
    no term: solvers hold u at the heights exactly. Where the mean contact force is below
    ``smallest_scale``, or there is no contact, violations are measured against that instead.
    """
    touching = force[in_contact]
    worst = float(np.max(np.abs(force), where=~in_contact, initial=0.0))
    mean = 0.0
    if touching.size:
        mean = float(touching.mean())
        worst = max(worst, -float(touching.min()))
    scale = max(mean, smallest_scale)
    return worst / scale if scale > 0 else (0.0 if worst == 0 else np.inf)
