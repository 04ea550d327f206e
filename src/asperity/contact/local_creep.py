"""What implicit steps of a local law of creep start from and lead to, whichever solid it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from asperity.creep import LocalCreep
from asperity.lattice import Field, Mask

_EXACTLY = 1e-5
"""Last change of a stress, relative to how far the law bends: Newton's method squares it."""

_FEW, _MOST = 6, 100
"""Iterations at a site before intervals are halved too, and at most; 60 halvings give all digits."""


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
    At sites that are ``yielding`` the contact force is given, and the surface is not held up. A stage that
    comes ``again`` follows one of the same duration, for which coarse grids have been prepared.
    """

    tau: float
    before: Field
    load: float | None
    position: float
    yielding: Mask | None = None
    again: bool = False


def stretches_of(
    law: LocalCreep, own: Field | float, tau: float, stiffness: float, wanted: Field, start: Field
) -> Field:
    """Roots w of own w + tau v(stiffness w) = wanted, by Newton's method in intervals that hold them.

    No law overflows in it: w is between 0 and wanted / own.
    """
    low, high = np.minimum(wanted / own, 0.0), np.maximum(wanted / own, 0.0)
    at = np.clip(start, low, high)
    for step in range(_MOST):
        value, slope = law.velocity(stiffness * at)
        left = wanted - own * at - tau * value
        low, high = np.where(left > 0, at, low), np.where(left < 0, at, high)
        closer = at + left / (own + tau * stiffness * slope)
        outside = ~((closer > low) & (closer < high))
        if step > _FEW:  # Newton's method creeps down an exponential
            outside |= np.abs(closer - at) > 0.1 * (high - low)
        closer = np.where(outside & (high > low), 0.5 * (low + high), closer)
        moved, at = stiffness * np.abs(closer - at), closer
        if (moved <= _EXACTLY * law.bend(stiffness * at) + 4 * np.spacing(stiffness * np.abs(at))).all():
            break
    return at


class LocalCreepSolver(Protocol):
    """Solves implicit steps of one solid above one rough surface.

    Attributes
    ----------
    heights
        The rough surface, which may yield between steps.
    """

    heights: Field

    def stretch(self, force: Field) -> Field:
        """Stretch of the creeping springs under their force."""
        ...

    def indented(self, force: Field) -> float:
        """How deep the largest force indents its site: under flat ones no other length tells rounding."""
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
