"""What implicit steps of a local law of creep start from and lead to, whichever solid it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from asperity.lattice import Field


@dataclass(frozen=True, eq=False)
class LocalState:
    """A state of a solid that creeps by a local law, relative to the system's datum.

    Attributes
    ----------
    u
        The surface.
    force
        Force of the creeping springs at each site.
    position
        How far the rigid body has moved since the beginning: u - position - creeping shape is their stretch.
    """

    u: Field
    force: Field
    position: float


@dataclass(frozen=True, eq=False)
class Stage:
    """An implicit step of duration ``tau`` from the creeping shape ``before``.

    Under load control ``load`` is the normal load; else it is None and ``position`` that of the rigid body.
    """

    tau: float
    before: Field
    load: float | None
    position: float


class LocalCreepSolver(Protocol):
    """Solves implicit steps of one solid above one rough surface."""

    def stretch(self, force: Field) -> Field:
        """Stretch of the creeping springs under their force."""
        ...

    def balanced(self, state: LocalState, load: float | None) -> Field:
        """Stretch with which the surface is in exact equilibrium, near that of the state."""
        ...

    def velocity(self, force: Field) -> Field:
        """Velocity of the creeping shape."""
        ...

    def solve(self, stage: Stage, guess: LocalState, allowed_error: float) -> tuple[LocalState, int]:
        """Solve a step until the error of the creeping shape, rms, is allowed; and the iterations spent.

        Raises
        ------
        ConvergenceError
            The error did not fall that far.
        """
        ...

    def damped(self, error: Field, stage: Stage, end: LocalState) -> Field:
        """What an implicit step leaves of an error of the creeping shape, the contacts staying."""
        ...
