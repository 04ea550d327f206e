r"""Contact without memory: the instantaneous and the relaxed state of the lattice of springs.

Both have S = k0 lam + bed but for wave vector 0, so the force is

    r = k0 L u + bed u + push,      push = base + pull mean(u),

with one number, the push, to be found along with u:

    instantaneous, load held         bed = k1,  pull = -k1,  base = F / N
    instantaneous, separation held   bed = k1,  pull = 0,    base = -k1 mean(u0)
    relaxed, load held               bed = 0,   pull = 0,    base = F / N

A cycle is two projected Gauss-Seidel sweeps, which find the contacts; one multigrid cycle for the free
sites, contacts held (truncated nonsmooth Newton multigrid: C. Graeser, R. Kornhuber, J. Comput. Math. 27,
1 (2009)); and the lowest energy that combines its correction with the previous one, which is what
conjugate gradients would do if the contacts stood still.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asperity.contact import kernels
from asperity.contact.multigrid.grids import Hierarchy, Rows, Single
from asperity.contact.multigrid.pins import Response
from asperity.contact.problem import SpringStep
from asperity.lattice import Field

ASTRAY = 1e-3
"""Largest sum of the forces off contact, and largest pull, in units of what one force may be off.

The sum, because forces that all have one sign would shift the separation; pulls, because they are cut off.
"""


@dataclass(frozen=True)
class Push:
    """The equation of the module: bed, pull and base."""

    bed: float
    pull: float
    base: float

    @classmethod
    def of(cls, springs: SpringStep, sites: int) -> Push:
        """For a flat shape, or a relaxed state."""
        if springs.load is None:
            return cls(springs.k1, 0.0, -springs.k1 * float(np.mean(springs.shape)))
        bed = 0.0 if springs.relaxed else springs.k1
        return cls(bed, -bed, springs.load / sites)

    def on(self, u: Field) -> float:
        """The push on a surface."""
        return self.base + self.pull * float(u.mean()) if self.pull else self.base


class OneField:
    """Work space for one lattice."""

    def __init__(self, shape: tuple[int, ...], rows: Rows) -> None:
        self.rows = rows
        self.hierarchy = Hierarchy(shape, 1, rows)
        self.step = np.zeros(shape, np.float32)
        self.sums = np.zeros((shape[0], 7))

    def solve(
        self, springs: SpringStep, heights: Field, u: Field, tolerance: float, max_cycles: int
    ) -> tuple[bool, float, int]:
        """Improve u in place; whether the tolerance was reached, the push, and the cycles taken."""
        self.springs, self.heights, self.u = springs, heights, u
        self.law = law = Push.of(springs, u.size)
        self.unit = max(float(u.max()), -float(u.min())) or 1.0
        self.step.fill(0.0)
        pinned, push = -1.0, law.base
        for cycle in range(max_cycles):
            equation = (u, heights, springs.k0, law.bed, law.on(u))
            self.rows.sweeps(kernels.sweeps_1, kernels.close_sweeps_1, u.shape, *equation, halves=4)
            push = law.on(u)
            contacts = self.restrict(push)
            if contacts == 0 and springs.load is not None:
                deepest = int(np.argmax(heights - u))  # something must carry the load
                u.flat[deepest] = heights.flat[deepest]
                continue
            if self.converged(contacts, tolerance):
                return True, push, cycle + 1
            if contacts != pinned:
                self.set_pins(int(contacts))
                pinned = contacts
            self.correct_on_grid(0)
            self.combine(push)
        return False, push, max_cycles

    def restrict(self, push: float) -> float:
        """Bring the forces off contact to the first coarse grid; the number of contacts."""
        grid, k0 = self.hierarchy.grids[0], self.springs.k0
        self.rows(
            kernels.restrict_1,
            *grid.shape,
            self.u,
            self.heights,
            k0,
            self.law.bed,
            push,
            1.0 / (k0 * self.unit),
            grid.sources[0],
            self.sums,
        )
        return float(self.sums[:, 3].sum())

    def converged(self, contacts: float, tolerance: float) -> bool:
        """Whether forces off contact, pulls in contact and the sum of the former are small."""
        worst, pull = self.sums[:, 0].max(), self.sums[:, 1].max()
        load, astray = abs(self.sums[:, 2].sum()), abs(self.sums[:, 4].sum())
        stiffest = 8.0 * self.springs.k0 + self.law.bed
        rounding = 4.0 * float(np.finfo(float).eps) * stiffest * self.unit
        allowed = max(tolerance * load / max(contacts, 1.0), rounding)
        small = astray <= max(ASTRAY * tolerance * load, rounding * math.sqrt(self.u.size))
        return bool(worst <= allowed and pull <= max(ASTRAY * allowed, rounding) and small)

    def set_pins(self, contacts: int) -> None:
        """Tell the coarse grids of the contacts, and factorize the coarsest."""
        k0 = self.springs.k0
        self.hierarchy.set_pins(self.u, self.heights, contacts, Response(self.law.bed / k0))
        grid = self.hierarchy.grids[-1]
        cells = grid.cells
        matrix = grid.laplacian() + np.diag(grid.pins.ravel() + self.law.bed / k0 * cells)
        matrix += self.law.pull / (k0 * self.u.size) * np.outer(cells, cells)
        self.coarsest = np.linalg.pinv(matrix, hermitian=True)

    def correct_on_grid(self, level: int) -> float:
        """One V-cycle from a grid up; the push that its correction adds."""
        grid = self.hierarchy.grids[level]
        (e,), (b,) = grid.corrections, grid.sources
        pull = self.law.pull / (self.springs.k0 * self.u.size)
        if grid is self.hierarchy.grids[-1]:
            e[...] = (self.coarsest @ b.ravel().astype(float)).reshape(e.shape)
            return pull * grid.total(e)
        operator = (grid.pins, np.float32(self.law.bed / self.springs.k0), *grid.geometry)
        coarser = self.hierarchy.grids[level + 1]
        e.fill(0.0)
        self.rows.by_color(kernels.coarse_sweep_1, e.shape, e, b, *operator, first=0)
        push = pull * grid.total(e) if pull else 0.0
        self.rows(
            kernels.coarse_restrict_1, *coarser.shape, e, b, *operator, np.float32(push), coarser.sources[0]
        )
        push += self.correct_on_grid(level + 1)
        shift = np.float32(-push)
        self.rows(kernels.coarse_correct, *e.shape, coarser.corrections[0], e, b, shift, grid.mx, grid.my)
        self.rows.by_color(kernels.coarse_sweep_1, e.shape, e, b, *operator, first=1)
        return pull * grid.total(e) if pull else 0.0

    def combine(self, push: float) -> None:
        """Move by the combination of correction and previous step that has the lowest energy."""
        coarse: Single = self.hierarchy.grids[0].corrections[0]
        fields = (coarse, self.step, self.u, self.heights)
        self.rows(kernels.products_1, *self.u.shape, *fields, self.springs.k0, self.law.bed, push, self.sums)
        alpha, beta = lowest(self.sums.sum(axis=0), self.law.pull / self.u.size, self.unit)
        self.rows(kernels.correct_1, *self.u.shape, *fields, np.float32(alpha), np.float32(beta), self.unit)


def lowest(sums: Field, pull: float, unit: float) -> tuple[float, float]:
    """Combination alpha, beta of two directions that minimizes the energy, or alpha alone."""
    rd, rq, dd, dq, qq, sd, sq = sums.tolist()
    dd, dq, qq = dd + pull * sd * sd, dq + pull * sd * sq, qq + pull * sq * sq
    rd, rq = rd / unit, rq / unit
    determinant = dd * qq - dq * dq
    if dd > 0 and qq > 0 and determinant > 1e-6 * dd * qq:
        return (rq * dq - rd * qq) / determinant, (rd * dq - rq * dd) / determinant
    return (-rd / dd if dd > 0 else 1.0), 0.0
