r"""The linear problem on one set of contacts of a line of springs, solved directly.

The stiffness of an implicit step on the lattice of springs is S = k0 L + k1 / (lag + spread L), L being minus
the Laplacian and lag = 1 + drag, but at wave vector 0, where the control sets it. A displacement d of the
free sites and the change of the forces are

    k0 L d + z = change,      (lag + spread L) z = k1 d - g,      mean(z) = S(0) mean(d),

with an even g, which is 0 where S(0) = k1 / lag. If the springs have relaxed, z is even: z = S(0) mean(d).

Along a line L couples neighbors alone: a chain of blocks of two unknowns, eliminated from one end to the
other. The last site, which a ring couples to both ends of the rest, is eliminated last. The matrix is
symmetric quasi-definite once the second equation is negated, so no pivots are exchanged (R. J. Vanderbei,
SIAM J. Optim. 5, 100 (1995), DOI 10.1137/0805005). The solution for g = 1 alone serves to find g.
"""

from __future__ import annotations

import numpy as np

from asperity.contact.arrays import largest
from asperity.contact.compiled import compiled
from asperity.contact.free_sites import Accuracy, Correction
from asperity.contact.problem import SpectralProblem
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice, Mask
from asperity.solids import Springs


class LineSites:
    """The free sites of one set of contacts on a line of springs of a given stiffness."""

    def __init__(self, lattice: Lattice, springs: Springs, mean: float, in_contact: Mask) -> None:
        self.in_contact, self.ring, n = in_contact, not lattice.reflecting, lattice.sites
        k1, lag, spread = springs.k1, 1.0 + springs.drag, springs.spread
        if springs.relaxed:
            k1, lag, spread = 0.0, 1.0, 0.0
        scale = max(lag, spread)
        pull = k1 / scale
        self.unit = max(springs.k0, pull) or 1.0
        self.k0, self.pull = springs.k0 / self.unit, pull / self.unit
        self.relaxed, self.mean = springs.relaxed, mean / self.unit
        self.bordered = mean > 0 if self.relaxed else mean * lag != k1
        # z is in units of ``pull``; its equation is divided by what makes the blocks symmetric.
        weight = pull or self.unit
        lag, spread = weight * lag / scale / self.unit, weight * spread / scale / self.unit
        free, closed = ~in_contact, np.ones(n)
        closed[-1] = self.ring and n > 1
        bonds = closed + np.roll(closed, 1)
        self.links = np.stack((-self.k0 * closed * (free & np.roll(free, -1)), spread * closed), axis=1)
        blocks = np.stack(
            (np.where(free, bonds * self.k0, 1.0), free * self.pull, -lag - bonds * spread), axis=1
        )
        self.inverses, self.border = np.empty((n, 3)), np.zeros((2, n, 2))
        factorize(blocks[:-1], self.links, self.inverses[:-1])
        for column, follows in enumerate(self.border):  # how the others follow the last site, d and z
            follows[0, column] += self.links[-1, column]
            follows[n - 2, column] += self.links[n - 2, column]
            substitute(self.inverses[:-1], self.links, follows[:-1])
        (share_a, share_b), (_, share_c) = map(self._coupled, self.border)
        blocks[-1] -= share_a, share_b, share_c
        factorize(blocks[-1:], self.links, self.inverses[-1:])
        if not np.isfinite(self.inverses).all():
            raise ConvergenceError(
                "contact solver: expected springs that hold the free sites, got none; try k0 > 0"
            )
        if self.bordered:
            nothing = np.zeros(n)
            self.even = self._solved(free, nothing) if self.relaxed else self._solved(nothing, nothing + 1.0)

    def correct(self, force: Field, worst: float, accuracy: Accuracy) -> Correction:
        """Displace the free sites until no force is left on them; see `FreeSites.correct`."""
        del accuracy
        scale = worst * self.unit
        d, z = self._solved(np.where(self.in_contact, 0.0, -force / scale), np.zeros(force.size))
        g = 0.0
        if self.bordered:
            left, shift = (self.mean * x.mean() - self.pull * y.mean() for x, y in ((d, z), self.even))
            g = -float(left / (shift + 1.0 if self.relaxed else shift))
            d, z = d + g * self.even[0], z + g * self.even[1]
        change = self.k0 * self._laplacian(d) + (-g if self.relaxed else self.pull * z)
        predicted = force + scale * change
        off_contact = np.where(self.in_contact, 0.0, predicted)
        worst_left, sum_left = largest(off_contact, np), abs(float(off_contact.sum()))
        return Correction(worst * d, predicted, worst_left, sum_left, iterations=1)

    def _solved(self, forces: Field | Mask, sources: Field) -> tuple[Field, Field]:
        """D, and z in units of ``pull``, of forces and of sources of z; all in units of ``unit``."""
        x = np.stack((forces, sources), axis=1, dtype=float)
        substitute(self.inverses[:-1], self.links, x[:-1])
        x[-1] -= self._coupled(x)
        substitute(self.inverses[-1:], self.links, x[-1:])
        x[:-1] -= self.border[0, :-1] * x[-1, 0] + self.border[1, :-1] * x[-1, 1]
        return x[:, 0], x[:, 1]

    def _coupled(self, x: Field) -> Field:
        """What the last site feels of both its neighbors."""
        return np.asarray(self.links[-1] * x[0] + self.links[len(x) - 2] * x[len(x) - 2])

    def _laplacian(self, field: Field) -> Field:
        before, after = np.roll(field, 1), np.roll(field, -1)
        if not self.ring:
            before[0], after[-1] = field[0], field[-1]
        return 2 * field - before - after


def line_sites(problem: SpectralProblem, in_contact: Mask) -> LineSites | None:
    """The linear problem in terms of neighbors, on a line of springs; else None."""
    lattice, springs = problem.lattice, problem.springs
    if springs is None or lattice.dimension > 1:
        return None
    return LineSites(lattice, springs, float(problem.stiffness.flat[0]), in_contact)


@compiled
def factorize(blocks: Field, links: Field, inverses: Field) -> None:
    """Inverses of the pivots of a chain, three entries of each; links are couplings to the next site."""
    for i in range(len(blocks)):
        a, b, c = blocks[i, 0], blocks[i, 1], blocks[i, 2]
        if i > 0:
            before, link = inverses[i - 1], links[i - 1]
            a -= link[0] * link[0] * before[0]
            b -= link[0] * link[1] * before[1]
            c -= link[1] * link[1] * before[2]
        determinant = a * c - b * b
        inverses[i, 0], inverses[i, 1], inverses[i, 2] = c / determinant, -b / determinant, a / determinant


@compiled
def substitute(inverses: Field, links: Field, x: Field) -> None:
    """Solve a chain for displacement and z at every site, in place."""
    n = len(x)
    for i in range(1, n):
        q, link = inverses[i - 1], links[i - 1]
        d = q[0] * x[i - 1, 0] + q[1] * x[i - 1, 1]
        z = q[1] * x[i - 1, 0] + q[2] * x[i - 1, 1]
        x[i, 0] -= link[0] * d
        x[i, 1] -= link[1] * z
    for i in range(n - 1, -1, -1):
        d, z = x[i, 0], x[i, 1]
        if i < n - 1:
            d -= links[i, 0] * x[i + 1, 0]
            z -= links[i, 1] * x[i + 1, 1]
        q = inverses[i]
        x[i, 0] = q[0] * d + q[1] * z
        x[i, 1] = q[1] * d + q[2] * z
