r"""The linear problem on one set of contacts of independent springs (k0 = 0), solved for the contact forces.

The stiffness of an implicit step is S = k1 / A but at wave vector 0, where the control sets it, with

    A = lag + spread L,      L minus the Laplacian.

A change y of the forces, that removes those off contact and is unknown in contact, displaces the surface by

    d = A y / k1 + s,        d = 0 in contact,

with s = 0 where the separation is prescribed, and s such that sum(y) = 0 where the load is. A couples
neighbors alone, so the unknowns are the contacts, few where the load is small: conjugate gradients on these,
of a matrix whose condition is at most 1 + 8 spread / lag, and without spread the identity. The sum of the
unknowns is kept by a projection.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact.compiled import compiled, inlined
from asperity.contact.free_sites import Accuracy, Correction
from asperity.contact.line_sites import LineSites
from asperity.contact.problem import SpringLaw
from asperity.contact.stencils import lattice_force
from asperity.lattice import Field, Lattice, Mask

_MARGIN = 0.1
"""What of the force that may be left off contact the iterations leave."""

_ROUNDING = 4.0 * float(np.finfo(float).eps)


class LoadedSites:
    """The contacts of independent springs on a map, which carry the load.

    Parameters
    ----------
    lattice
        The lattice, of two dimensions.
    law
        The stiffness, of k0 = 0.
    in_contact
        The contacts, at least one.
    """

    def __init__(self, lattice: Lattice, law: SpringLaw, in_contact: Mask) -> None:
        self.law, self.in_contact, self.mirrored = law, in_contact, lattice.reflecting
        self.spread = law.spread / law.lag
        self.neighbors = neighbors_in_contact(in_contact, mirrored=self.mirrored)

    def correct(self, force: Field, worst: float, accuracy: Accuracy) -> Correction:
        """Displace the free sites until no force is left on them; see `FreeSites.correct`."""
        change = np.where(self.in_contact, 0.0, force * (-1.0 / worst))
        # In units of k1 / lag: -A y of the known forces, wanted of the unknown ones.
        wanted = -lattice_force(change, change, self.spread, 1.0, mirrored=self.mirrored)[self.in_contact]
        prescribed = self.law.mean == 0
        found = np.zeros(wanted.size + 1)
        if prescribed:
            found[:-1] = -change.sum() / wanted.size
        solve(self.neighbors, self.spread, wanted, found, prescribed, _MARGIN * accuracy.goal, _ROUNDING)
        change[self.in_contact] = found[:-1]
        d = lattice_force(change, change, self.spread, 1.0, mirrored=self.mirrored)
        left = d[self.in_contact]
        if prescribed:
            s = float(left.mean())
            d, left = d - s, left - s
        d[self.in_contact] = 0.0
        d *= worst * self.law.lag / self.law.k1
        off = worst * float(np.abs(left).max())
        return Correction(d, force + worst * change, off, 0.0, iterations=1)


SpringSites = LineSites | LoadedSites


def spring_sites(lattice: Lattice, law: SpringLaw | None, in_contact: Mask) -> SpringSites | None:
    """The linear problem in terms of neighbors, where springs allow it; else None."""
    if law is None:
        return None
    if lattice.dimension == 1:
        return LineSites(lattice, law, in_contact)
    return LoadedSites(lattice, law, in_contact) if law.k0 == 0 and law.k1 > 0 else None


def neighbors_in_contact(in_contact: Mask, *, mirrored: bool) -> Any:
    """Numbers of the four neighbors of each contact, counted row by row; off contact, the number of contacts.

    Beyond a mirror a site is its own neighbor.
    """
    count = int(np.count_nonzero(in_contact))
    numbers = np.full(in_contact.shape, count, dtype=np.int32)
    numbers[in_contact] = np.arange(count, dtype=np.int32)
    padded = np.pad(numbers, 1, mode="symmetric" if mirrored else "wrap")
    around = (padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:])
    return np.stack([side[in_contact] for side in around], axis=1)


@inlined
def apply(neighbors: Any, spread: float, x: Field, out: Field) -> float:
    """Multiply by 1 + spread L on the contacts, x being 0 elsewhere; the product of both."""
    total = 0.0
    for i in range(len(neighbors)):
        near = x[neighbors[i, 0]] + x[neighbors[i, 1]] + x[neighbors[i, 2]] + x[neighbors[i, 3]]
        out[i] = x[i] + spread * (4.0 * x[i] - near)
        total += x[i] * out[i]
    return total


@compiled
def solve(
    neighbors: Any, spread: float, wanted: Field, x: Field, prescribed: bool, goal: float, rounding: float
) -> int:
    """Conjugate gradients from x, of any sum or of that of x, until no residual exceeds ``goal``; iterations.

    The last entry of x is 0 and stands for all sites off contact. Where the sum is prescribed the residual
    counts from its mean. Ends also at what rounding leaves.
    """
    n = len(wanted)
    change, direction = np.empty(n), np.zeros(n + 1)
    apply(neighbors, spread, x, change)
    residual = wanted - change
    previous = 0.0
    for iteration in range(10 * n + 100):
        mean = 0.0
        if prescribed:
            for i in range(n):
                mean += residual[i]
            mean /= n
        power = largest = far = 0.0
        for i in range(n):
            residual[i] -= mean
            power += residual[i] * residual[i]
            largest = max(largest, abs(residual[i]))
            far = max(far, abs(x[i]))
        if largest <= max(goal, rounding * (1.0 + 8.0 * spread) * far):
            return iteration
        ratio = power / previous if previous > 0.0 else 0.0
        for i in range(n):
            direction[i] = residual[i] + ratio * direction[i]
        curvature = apply(neighbors, spread, direction, change)
        if not curvature > 0.0:
            return iteration
        length = power / curvature
        for i in range(n):
            x[i] += length * direction[i]
            residual[i] -= length * change[i]
        previous = power
    return 10 * n + 100
