"""The interface of two bodies: bounds of the force of a site, and how far forces violate them.

A site is off contact, where its force is 0; in contact, where its force is within the bounds; or yielding,
where its force is the upper bound and the elastic surface is below the rough one. The judge of a published
contact and every solver ask here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from asperity.adhesion import Adhesion
from asperity.lattice import Field, Lattice, Mask
from asperity.solids import Solid

_ROUNDING = 64 * float(np.finfo(float).eps)
"""Load plus attraction, over the attraction, below which it is rounding."""


@dataclass(frozen=True, eq=False)
class Interface:
    """Bounds of the contact force of a site.

    The force is at least ``low``, at most 0, and at most ``high``, above which the rough surface yields. An
    ``external`` force of each site, such as adhesion from afar, may act beside it: forces that are judged and
    admitted are the sum of both. A law of ``adhesion`` gives that force by the gap; ``cell`` is the area of a
    site.
    """

    low: float = 0.0
    high: float = math.inf
    external: Field | None = None
    adhesion: Adhesion | None = None
    cell: float = 1.0

    @property
    def yields(self) -> bool:
        """Whether the rough surface yields under forces that are large enough."""
        return self.high < math.inf

    def beside(self, external: Field | None) -> Interface:
        """The interface where an external force acts beside that of contact."""
        return self if external is None else replace(self, external=external)

    def pull(self, gap: Field) -> Field:
        """The force by which sites attract each other, at most 0, where there is adhesion."""
        assert self.adhesion is not None
        return -self.cell * self.adhesion.traction(gap)

    def parts(self, load: float | None, pull: Field) -> bool:
        """Whether an attraction does not bear a load that pulls, but for rounding."""
        attraction = -float(pull.sum())
        return load is not None and load + attraction <= _ROUNDING * attraction

    def bond(self, gap: Field) -> float:
        """Energy of adhesion, at most 0."""
        return 0.0 if self.adhesion is None else self.cell * float(self.adhesion.energy(gap).sum())

    def borne(self, total: float) -> float:
        """Sum of the contact forces, from the sum of all forces."""
        return total if self.external is None else total - float(self.external.sum())

    def of_contact(self, force: Field) -> Field:
        """The contact force, without the external one."""
        return force if self.external is None else force - self.external

    def admit(self, force: Field, contacts: Mask, total: float | None = None) -> Field:
        """Forces that the interface allows, near some: within the bounds in contact, none elsewhere.

        Where a ``total`` is given, those below the upper bound are scaled so that all add up to it.
        """
        admitted = np.where(contacts, np.clip(self.of_contact(force), self.low, self.high), 0.0)
        if total is not None:
            self._scale(admitted, self.borne(total))
        return admitted if self.external is None else admitted + self.external

    def _scale(self, forces: Field, total: float) -> None:
        if not self.yields:
            forces *= max(total, 0.0) / (float(forces.sum()) or 1.0)
            return
        below = forces < self.high
        while (carried := float(forces.sum(where=below))) > 0:
            borne = forces.size - np.count_nonzero(below)
            rest = total - self.high * borne if borne else total
            np.multiply(forces, max(rest, 0.0) / carried, out=forces, where=below)
            above = forces > self.high
            if not above.any():
                return
            forces[above] = self.high
            below &= ~above

    def lowered(self, heights: Field, u: Field) -> Field:
        """The rough surface after it has yielded to an elastic surface u below it."""
        return np.minimum(heights, u) if self.yields else heights

    def yielding(self, force: Field) -> int:
        """Number of sites whose force is the upper bound, to the digits of published contacts."""
        return int(np.count_nonzero(self.of_contact(force) >= (1 - 1e-6) * self.high))

    def wrong(
        self,
        force: Field,
        gap: Field,
        in_contact: Mask,
        yielding: Mask,
        slack: tuple[float, float] = (0.0, 0.0),
    ) -> Mask:
        """Contacts whose force is beyond a bound, free sites that penetrate, and yielding sites that do not.

        The bounds are wider by ``slack``, of force and of gap.
        """
        by_force, by_gap = slack
        beyond = (force < self.low - by_force) | (force > self.high + by_force)
        free = ~(in_contact | yielding)
        return (in_contact & beyond) | (free & (gap < -by_gap)) | (yielding & (gap > by_gap))

    def violation(
        self, force: Field, in_contact: Mask, yielding: Mask | None = None, smallest_scale: float = 0.0
    ) -> float:
        """Largest violation of equilibrium, relative to the mean contact force.

        Off contact any force is a violation; in contact one beyond a bound; where the surface is
        ``yielding``, which is in contact, any other than the upper bound. Penetration needs no term: solvers
        hold u at the heights exactly. Where the mean contact force is below ``smallest_scale``, or there is
        no contact, violations are measured against that instead.
        """
        if not math.isfinite(float(force.sum())):
            return math.inf
        force = self.of_contact(force)
        pressing, free = force[in_contact], force[~in_contact]
        worst = max(float(free.max(initial=0.0)), -float(free.min(initial=0.0)))
        worst = max(worst, self.low - float(pressing.min(initial=0.0)))
        if self.yields:
            excess = force - self.high
            worst = max(worst, float(excess.max()))
            if yielding is not None and yielding.any():
                worst = max(worst, -float(excess[yielding].min()))
        scale = max(float(pressing.mean()) if pressing.size else 0.0, smallest_scale)
        return worst / scale if scale > 0 else (0.0 if worst == 0 else math.inf)


RIGID = Interface()
"""Bodies that neither stick nor yield."""


def interface_of(solid: Solid, lattice: Lattice) -> Interface:
    """The interface between a solid and a rough surface, whose hardness and adhesion it knows."""
    cell = lattice.cell if solid.in_lengths else 1.0
    return Interface(high=solid.hardness * cell, adhesion=solid.adhesion, cell=cell)
