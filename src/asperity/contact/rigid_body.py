"""The rigid body on which a solid hangs: all that happens at wave vector 0.

At wave vector 0 the surface hangs on the rigid body, whose position is X: H acts on u - X there. Under
separation control X is known, and wave vector 0 is a mode like any other. Under load control it drops out
of S, its right-hand side is minus the load F, and the body moves, with all anchors, by what the load demands:

    H (u - X) + sum_b C_b D_b (u - v_b) = F / N        in the means over the N sites.

A solid with H = C_b = 0 there, such as a half-space, carries the load as a rigid body: the means of u and of
u_b are X.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.lattice import Field

Branches = NDArray[np.float64]
"""A number for each branch."""


@dataclass(frozen=True)
class Prescribed:
    """What is prescribed at a moment: the load, if that is held, and the position X of the rigid body.

    Where the load is prescribed, X is where the body was before. An ``external`` force of each site,
    positive where it pushes the bodies apart, bears its part of the load.
    """

    load: float | None
    position: float
    external: Field | None = None


@dataclass(frozen=True, eq=False)
class RigidBody:
    """What hangs on the rigid body: H and each C_b at wave vector 0, and the rates M_b C_b there.

    Where edges are free the body is known ``from_afar``, by all that displaces its surface.
    """

    permanent: float
    creeping: Branches
    rate: Branches
    sites: int
    from_afar: bool = False

    @property
    def stiffness(self) -> float:
        """H + sum of C_b."""
        return float(self.permanent + self.creeping.sum())

    @property
    def on_one_branch(self) -> bool:
        """Whether the rigid body is where the anchors of the only branch are, on average."""
        alone = len(self.creeping) == 1 and self.permanent == 0
        return alone and self.creeping[0] > 0 and not self.from_afar

    @property
    def mobility(self) -> float:
        """M of the branch that all hangs on, else 0."""
        return float(self.rate[0] / self.creeping[0]) if self.on_one_branch else 0.0

    def pull(self, position: float) -> float:
        """Sum over the sites of what a position adds to forces: H X."""
        return self.permanent * self.sites * position if self.permanent else 0.0

    def stretch(self, load: float | None) -> float | None:
        """Mean of u - u0 of the branch that all hangs on as the load prescribes it, else None."""
        return load / (self.sites * self.stiffness) if load is not None and self.on_one_branch else None

    def position(self, u: Field, anchors: Field, position: float) -> float:
        """Where the body is: at the mean of the only branch's anchors, if all hangs on it."""
        if self.on_one_branch:
            return float(np.mean(anchors[0]))
        return position if self.stiffness > 0 else float(u.mean())

    def displacement(self, u: Field, anchors: Field, held: Prescribed) -> float:
        """How far the load moves the body and the anchors at once, to balance a surface u."""
        whole, stretches = float(u.mean()) - held.position, [float((u - v).mean()) for v in anchors]
        if self.stiffness == 0:
            return stretches[0] if stretches else whole
        parts = zip([self.permanent, *self.creeping.tolist()], [whole, *stretches], strict=True)
        moved = math.fsum(stiffness / self.stiffness * part for stiffness, part in parts if stiffness)
        return moved - (held.load or 0.0) / (self.sites * self.stiffness)

    def carried(self, u: Field, stretch: Field, position: float) -> float | None:
        """Load in terms of what hangs; None where nothing does."""
        if self.stiffness == 0:
            return None
        permanent = self.permanent * (float(u.sum()) - self.sites * position) if self.permanent > 0 else 0.0
        parts = zip(self.creeping.tolist(), stretch, strict=True)
        return permanent + math.fsum(stiffness * float(np.sum(w)) for stiffness, w in parts)

    def after_step(
        self, surface: float, before: Branches, damping: Branches, load: float, position: float
    ) -> tuple[Branches | float, float]:
        """Stretches of the branches, and X, after an implicit step under a load; sums but for X.

        ``surface`` is the sum of u, ``before`` are those of the anchors, and ``damping`` is D_b.
        """
        springs = self.creeping * damping
        hanging = float(self.permanent + springs.sum())
        if hanging == 0:  # nothing hangs, or all that hangs has yielded: the load is shared as it flows
            stretch: Branches | float = 0.0
            if self.stiffness > 0:
                slow = np.divide(1.0, self.rate, out=np.zeros_like(self.rate), where=self.rate > 0)
                stretch = load * slow / np.dot(self.creeping, slow)
            return stretch, surface / self.sites
        level = (load + self.pull(position) + float(np.dot(springs, before))) / hanging
        return damping * (level - before), position + (surface - level) / self.sites
