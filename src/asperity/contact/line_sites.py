r"""The linear problem on one set of contacts of a line of springs, solved directly.

The stiffness of an implicit step on the lattice of springs is S = k0 L + k1 / (lag + spread L), L being minus
the Laplacian, but at wave vector 0, where the control sets it. A displacement d of the free sites and the
change of the forces are

    k0 L d + z = change,      (lag + spread L) z = k1 d - g,      mean(z) = S(0) mean(d),

with an even g, which is 0 where S(0) = k1 / lag. If the springs have relaxed, z is even: z = S(0) mean(d).

Along a line L couples neighbors alone: a chain of blocks of two unknowns, eliminated from one end to the
other. The last site, which a ring couples to both ends of the rest, is eliminated last. The matrix is
symmetric quasi-definite once the second equation is negated, so no pivots are exchanged (R. J. Vanderbei,
SIAM J. Optim. 5, 100 (1995), DOI 10.1137/0805005). The solution for g = 1 alone serves to find g.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact.arrays import largest
from asperity.contact.compiled import compiled, inlined
from asperity.contact.free_sites import Accuracy, Correction
from asperity.contact.problem import SpringLaw
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice, Mask


class LineSites:
    """The free sites of one set of contacts on a line of springs.

    Parameters
    ----------
    lattice
        The line.
    law
        Its stiffness.
    in_contact
        The contacts.
    """

    def __init__(self, lattice: Lattice, law: SpringLaw, in_contact: Mask) -> None:
        self.in_contact, self.ring = in_contact, not lattice.reflecting
        scale = max(law.lag, law.spread)
        pull = law.k1 / scale
        self.unit = max(law.k0, pull) or 1.0
        self.k0, self.pull = law.k0 / self.unit, pull / self.unit
        # z is in units of ``pull``; its equation is divided by what makes the blocks symmetric.
        weight = pull or self.unit
        lag, spread = weight * law.lag / scale / self.unit, weight * law.spread / scale / self.unit
        n = lattice.sites
        self.inverses, self.links, self.border = np.empty((n, 3)), np.empty((n, 2)), np.empty((n, 2, 2))
        matrix = (self.inverses, self.links, self.border)
        factorize(self.k0, self.pull, lag, spread, in_contact, self.ring, *matrix)
        if not np.isfinite(self.inverses).all():
            raise ConvergenceError(
                "contact solver: expected springs that hold the free sites, got none; try k0 > 0"
            )
        self.relaxed, self.mean = law.k1 == 0, law.mean / self.unit
        self.bordered = law.mean > 0 if self.relaxed else law.mean * law.lag != law.k1
        if self.bordered:
            free, nothing = (~in_contact).astype(float), np.zeros(n)
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

    def _solved(self, forces: Field, sources: Field) -> tuple[Field, Field]:
        """D, and z in units of ``pull``, of forces and of sources of z; all in units of ``unit``."""
        solution = np.stack((forces, sources), axis=1)
        substitute(self.inverses, self.links, self.border, solution)
        return solution[:, 0], solution[:, 1]

    def _laplacian(self, field: Field) -> Field:
        before, after = np.roll(field, 1), np.roll(field, -1)
        if not self.ring:
            before[0], after[-1] = field[0], field[-1]
        return 2 * field - before - after


def line_sites(lattice: Lattice, law: SpringLaw | None, in_contact: Mask) -> LineSites | None:
    """The linear problem in terms of neighbors, on a line of springs; else None."""
    return None if law is None or lattice.dimension > 1 else LineSites(lattice, law, in_contact)


@compiled
def factorize(
    k0: float,
    pull: float,
    lag: float,
    spread: float,
    in_contact: Any,
    ring: bool,
    inverses: Any,
    links: Any,
    border: Any,
) -> None:
    """Inverses of the pivots (three entries of each), couplings to the next site, columns of the last site.

    The last pivot is what the last site has left when all others are eliminated.
    """
    n = in_contact.size
    for i in range(n):
        closed = ring or i < n - 1
        both = not (in_contact[i] or in_contact[(i + 1) % n])
        links[i, 0] = -k0 if closed and both else 0.0
        links[i, 1] = spread if closed else 0.0
    for i in range(n):
        bonds = 0.0 if n == 1 else 2.0 if ring or 0 < i < n - 1 else 1.0
        a = 1.0 if in_contact[i] else bonds * k0
        b = 0.0 if in_contact[i] else pull
        c = -lag - bonds * spread
        if i == n - 1:
            break
        if i > 0:
            before, link = inverses[i - 1], links[i - 1]
            a -= link[0] * link[0] * before[0]
            b -= link[0] * link[1] * before[1]
            c -= link[1] * link[1] * before[2]
        determinant = a * c - b * b
        inverses[i, 0], inverses[i, 1], inverses[i, 2] = c / determinant, -b / determinant, a / determinant
    # How the chain of all others follows the last site, d and z.
    for column in range(2):
        for i in range(n - 1):
            for row in range(2):
                border[i, row, column] = 0.0
        if n > 1:
            border[0, column, column] += links[n - 1, column]
            border[n - 2, column, column] += links[n - 2, column]
        through_chain(border[:, :, column], inverses, links)
    for row in range(2):
        for column in range(2):
            share = 0.0
            if n > 1:
                share = links[n - 1, row] * border[0, row, column]
                share += links[n - 2, row] * border[n - 2, row, column]
            if row == column == 0:
                a -= share
            elif row == column == 1:
                c -= share
            elif row == 0:
                b -= share
    determinant = a * c - b * b
    last = inverses[n - 1]
    last[0], last[1], last[2] = c / determinant, -b / determinant, a / determinant


@inlined
def through_chain(x: Any, inverses: Any, links: Any) -> None:
    """Solve the chain of all sites but the last, in place."""
    n = len(x)
    for i in range(1, n - 1):
        q, link = inverses[i - 1], links[i - 1]
        d = q[0] * x[i - 1, 0] + q[1] * x[i - 1, 1]
        z = q[1] * x[i - 1, 0] + q[2] * x[i - 1, 1]
        x[i, 0] -= link[0] * d
        x[i, 1] -= link[1] * z
    for i in range(n - 2, -1, -1):
        d, z = x[i, 0], x[i, 1]
        if i < n - 2:
            d -= links[i, 0] * x[i + 1, 0]
            z -= links[i, 1] * x[i + 1, 1]
        q = inverses[i]
        x[i, 0] = q[0] * d + q[1] * z
        x[i, 1] = q[1] * d + q[2] * z


@compiled
def substitute(inverses: Any, links: Any, border: Any, x: Any) -> None:
    """Solve for displacement and z at every site, in place."""
    n = len(x)
    d, z = x[n - 1, 0], x[n - 1, 1]
    if n > 1:
        through_chain(x, inverses, links)
        d -= links[n - 1, 0] * x[0, 0] + links[n - 2, 0] * x[n - 2, 0]
        z -= links[n - 1, 1] * x[0, 1] + links[n - 2, 1] * x[n - 2, 1]
    q = inverses[n - 1]
    last_d, last_z = q[0] * d + q[1] * z, q[1] * d + q[2] * z
    for i in range(n - 1):
        x[i, 0] -= border[i, 0, 0] * last_d + border[i, 0, 1] * last_z
        x[i, 1] -= border[i, 1, 0] * last_d + border[i, 1, 1] * last_z
    x[n - 1, 0], x[n - 1, 1] = last_d, last_z
