r"""The contact problem that every solver solves.

Given a stiffness S >= 0, a right-hand side b and an obstacle xi, find the surface u with

    r = S u - b,      0 <= r   perpendicular to   u - xi >= 0        (Signorini conditions),

which minimizes 1/2 u.S u - b.u over u >= xi. r is the contact force, site by site. Where
S vanishes at wave vector 0 the sum of r is fixed by the right-hand side: load control without feedback.

Where the forces have an upper bound p, sites that reach it yield: r = p and u <= xi there. That minimizes the
energy plus p times the sum of (xi - u) over the sites where it is positive, which is convex too. How far
forces break these conditions `asperity.contact.interface` judges.

A problem comes in one of two forms: `SpectralProblem`, in Fourier modes, for any solid; `SpringProblem`,
in terms of neighbors, for the lattice of springs. The second can be turned into the first.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from asperity.contact.interface import RIGID, Interface
from asperity.lattice import Field, Lattice, Mask, Modes, Spectrum
from asperity.solids import Springs


@dataclass(frozen=True, eq=False)
class SpectralProblem:
    """A contact problem in Fourier modes.

    The maximum of the heights, the obstacle xi, is 0, which keeps rounding errors relative to the indentation
    rather than to the datum of the heights. The stiffness S is positive but, where the sum of the forces is
    prescribed, 0 at wave vector 0; the right-hand side b, modes, is there minus the load.
    """

    lattice: Lattice
    heights: Field
    stiffness: Spectrum
    rhs: Modes
    interface: Interface = RIGID

    @property
    def load(self) -> float | None:
        """The sum of the contact forces, where it is prescribed; else None."""
        return None if self.stiffness.flat[0] > 0 else -float(self.rhs.flat[0].real)

    def spectral(self) -> SpectralProblem:
        """Return the problem itself."""
        return self

    def in_neighbors(self) -> None:
        """Return the problem in terms of neighbors: there is none."""

    def without_adhesion(self, pull: Field | None) -> SpectralProblem:
        """Return the problem whose adhesion is a known force; the load is the sum of this and contact."""
        rhs = self.rhs if pull is None else self.rhs + self.lattice.forward(pull)
        return replace(self, rhs=rhs, interface=replace(self.interface, adhesion=None))

    def first_pull(self, guess: Guess | None) -> Field | None:
        """The adhesive force of the surface before, with which a solver starts; None where nothing sticks."""
        if self.interface.adhesion is None:
            return None
        last = math.inf if guess is None else guess.u if guess.last is None else guess.last
        return self.interface.pull(np.broadcast_to(last - self.heights, self.heights.shape))

    def force(self, u: Field) -> Field:
        """Contact force r = S u - b at every site."""
        return self.lattice.backward(self.stiffness * self.lattice.forward(u) - self.rhs)


@dataclass(frozen=True, eq=False)
class SpringProblem:
    """An implicit step of creep on the two-dimensional lattice of springs, in terms of neighbors alone.

    k0 L u + k1 w is the force and w + spread L w + drag w = u - v the stretch of the springs to the
    bulk after a step of creep from the anchors v; L is minus the Laplacian. Under load control an
    unknown constant joins the right-hand side, and the sum of k1 w is the load, else None. The anchors are a
    field or the level of a flat one, ``mirrored`` edges of the lattice not periodic.
    """

    heights: Field
    springs: Springs
    anchors: Field | float
    load: float | None
    mirrored: bool
    spectral: Callable[[], SpectralProblem]
    interface: ClassVar[Interface] = RIGID

    def in_neighbors(self) -> SpringProblem:
        """Return the problem itself."""
        return self


ContactProblem = SpectralProblem | SpringProblem


@dataclass(frozen=True, eq=False)
class Guess:
    """Where a solver starts: a surface and the sites assumed in contact.

    By default those at which u is at most the height; with ``in_contact``, sites at which u is below the
    height yield, where the interface does. Adhesion is at first that of the surface ``last``, by default u;
    ``gradual`` adhesion changes at few sites a round.
    """

    u: Field
    in_contact: Mask | None = None
    last: Field | None = None
    gradual: bool = False


@dataclass(frozen=True, eq=False)
class Solution:
    """A solved contact problem.

    ``u`` equals the heights on ``in_contact``, or is below where they yield, and exceeds them elsewhere;
    ``iterations`` counts conjugate-gradient iterations, multigrid cycles or rounds on few contacts, and
    ``set_changes`` the times the set of contacts was revised. ``stretch`` is u - u0 after the step, from
    solvers that find it on the way; ``solver`` names who solved, where several may have.
    """

    u: Field
    in_contact: Mask
    iterations: int
    set_changes: int
    stretch: Field | None = None
    solver: str = ""


TOLERANCE = 1e-9
"""The tolerance to which published states are solved; the residual they carry shows it."""


@dataclass(frozen=True)
class Accuracy:
    """How accurate a solution is to be.

    No force off contact exceeds ``residual`` times the mean contact force, unless rounding forbids more. A
    solver may stop earlier where u is off by no more than ``error``, rms over the sites.
    """

    residual: float = TOLERANCE
    error: float = 0.0

    @property
    def settled(self) -> bool:
        """Whether contacts must not change any more: those of published states, and where u may not err."""
        return self.error == 0 or self.residual <= TOLERANCE


PUBLISHED = Accuracy()
"""That of published states."""


@runtime_checkable
class ContactSolver(Protocol):
    """What a solver offers."""

    def solve(self, problem: ContactProblem, guess: Guess | None, accuracy: Accuracy) -> Solution:
        """Solve from a guess or from nothing; return a solution as accurate, or raise `ConvergenceError`."""
        ...


@runtime_checkable
class JointSolver(ContactSolver, Protocol):
    """A solver that finds adhesion along with the contacts, unless the guess is gradual."""

    knows_adhesion: ClassVar[bool]


def mean_by_rounding(force: Field, in_contact: Mask, size: float, xp: Any = np) -> float:
    """Mean of the force off contact, if the rounding of the mean of u explains it, else 0.

    ``size`` is the largest u times the stiffness at wave vector 0. Where the mean is held stiffly, its force
    is known better by the equilibrium off contact than by a difference that has lost its digits.
    """
    if size == 0:
        return 0.0
    free = force.size - int(xp.count_nonzero(in_contact))
    mean = float(xp.sum(xp.where(in_contact, xp.asarray(0.0), force))) / max(free, 1)
    return mean if abs(mean) <= 4 * float(np.finfo(float).eps) * size else 0.0
