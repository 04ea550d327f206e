r"""Contact without memory: the instantaneous and the relaxed state of the lattice of springs.

Both have S = k0 lam + bed but for wave vector 0, so the force is

    r = k0 L u + bed u + uniform,      uniform = base + coupling mean(u),

with one number, the uniform force, to be found along with u:

    instantaneous, load control         bed = k1,  coupling = -k1,  base = F / N
    instantaneous, separation control   bed = k1,  coupling = 0,    base = -k1 mean(u0)
    relaxed, load control               bed = 0,   coupling = 0,    base = F / N

A cycle is two projected Gauss-Seidel sweeps, which find the contacts; one multigrid cycle for the free
sites, contacts fixed (truncated nonsmooth Newton multigrid: C. Graeser, R. Kornhuber, J. Comput. Math. 27,
1 (2009)); and the lowest energy that combines its correction with the previous move, which is what
conjugate gradients would do if the contacts stood still.

Cycles work on a correction in single precision. When that is as good as rounding allows, it is added to
the surface, and what is left of the forces, measured in double precision, is the source of the next one:
only such a measurement decides that the state is found.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asperity.contact import kernels
from asperity.contact.arrays import largest
from asperity.contact.multigrid.grids import Hierarchy, Rows, parted_shape
from asperity.contact.multigrid.pins import Response
from asperity.contact.problem import SpringStep
from asperity.lattice import Field

_SUM_TOLERANCE = 1e-3
"""Largest sum of the forces off contact, and of the tension in a row, relative to what one force may be off.

The former, because forces that all have one sign would shift the separation; tension, because it is set to 0.
"""

_MARGIN = 0.1
"""What of the tolerance is used: many small forces off contact together move the separation."""

SINGLE_PRECISION = 100 * float(np.finfo(np.float32).eps)
"""Defect that cycles in single precision reach, in units of the stiffness times the largest correction."""


@dataclass(frozen=True)
class UniformForce:
    """The uniform part of the force: bed, coupling and base of the module."""

    bed: float
    coupling: float
    base: float

    @classmethod
    def of(cls, springs: SpringStep, sites: int) -> UniformForce:
        """For flat anchors, or a relaxed state."""
        if springs.load is None:
            return cls(springs.k1, 0.0, -springs.k1 * float(np.mean(springs.anchors)))
        bed = 0.0 if springs.relaxed else springs.k1
        return cls(bed, -bed, springs.load / sites)

    def on(self, u: Field) -> float:
        """The uniform force on a surface."""
        return self.base + self.coupling * float(u.mean()) if self.coupling else self.base


class OneField:
    """Work space for one lattice."""

    def __init__(self, shape: tuple[int, ...], rows: Rows) -> None:
        self.rows, self.shape = rows, shape
        self.hierarchy = Hierarchy(shape, 1, rows)
        parts = parted_shape(*shape)
        self.bound = np.full(parts, -np.inf, np.float32)
        self.source, self.correction, self.previous = (np.zeros(parts, np.float32) for _ in range(3))
        self.sums = np.zeros((shape[0], 7))

    def solve(
        self, springs: SpringStep, heights: Field, u: Field, tolerance: float, max_cycles: int
    ) -> tuple[bool, float, int]:
        """Improve u in place; whether the tolerance was reached, the uniform force, and the cycles taken."""
        self.springs, self.heights, self.u = springs, heights, u
        self.law = UniformForce.of(springs, u.size)
        self.bed, self.coupling = self.law.bed / springs.k0, self.law.coupling / (springs.k0 * u.size)
        self.unit = largest(u, np) or 1.0
        self.previous.fill(0.0)
        uniform, pinned = self.measure(), -1.0
        self.has_converged(tolerance)
        for cycle in range(1, max_cycles + 1):
            self.sweep()
            contacts = self.restrict()
            if contacts == 0 and springs.load is not None:
                deepest = int(np.argmax(self.bound - self.correction))  # something must carry the load
                self.correction.flat[deepest] = self.bound.flat[deepest]
                continue
            if self.is_done():
                self.settle()
                uniform = self.measure()
                if self.has_converged(tolerance):
                    return True, uniform, cycle
                self.restrict()
            if contacts != pinned:
                self.set_pins(contacts)
                pinned = contacts
            self.correct_on_grid(0)
            self.combine()
        self.settle()
        return False, uniform, max_cycles

    def measure(self) -> float:
        """Begin a correction to the surface as it is; the uniform force on it."""
        uniform = self.law.on(self.u)
        self.rows(
            kernels.measure_1,
            *self.shape,
            self.u,
            self.heights,
            self.springs.k0,
            self.law.bed,
            uniform,
            self.unit,
            self.bound,
            self.source,
            self.sums,
        )
        self.correction.fill(0.0)
        return uniform

    def settle(self) -> None:
        """Add the correction."""
        fields = (self.u, self.heights, self.correction, self.bound)
        self.rows(kernels.settle, *self.shape, *fields, self.unit)

    def uniform(self) -> np.float32:
        """What the correction adds to the uniform force."""
        if not self.coupling:
            return np.float32(0.0)
        self.rows(kernels.total, *self.shape, self.correction, self.shape[1], self.sums)
        return np.float32(self.coupling * self.sums[:, 0].sum())

    def equation(self) -> tuple[object, ...]:
        """Fields and coefficients, as the kernels take them."""
        fields = (self.correction, self.bound, self.source)
        return (*fields, np.float32(4.0 + self.bed), self.uniform(), self.shape[1])

    def sweep(self) -> None:
        """Find the contacts and smooth the error."""
        sweeps = (kernels.sweeps_1, kernels.close_sweeps_1, self.shape)
        self.rows.and_edges(*sweeps, *self.equation(), 4)

    def restrict(self) -> float:
        """Bring the forces off contact to the first coarse grid; the number of contacts."""
        grid = self.hierarchy.grids[0]
        self.rows(kernels.restrict_1, *grid.shape, *self.equation(), grid.sources[0], self.sums)
        return float(self.sums[:, 2].sum())

    def is_done(self) -> bool:
        """Whether the correction is good enough, or as good as single precision allows."""
        worst, far = self.sums[:, :2].max(axis=0)
        reachable = SINGLE_PRECISION * (8.0 + self.bed) * far
        return bool(worst <= max(self.allowed / (self.springs.k0 * self.unit), reachable))

    def has_converged(self, tolerance: float) -> bool:
        """Whether forces off contact, tension in contact and the sum of the former are small, as measured."""
        worst, tension = self.sums[:, :2].max(axis=0)
        load, contacts, imbalance = self.sums[:, 2:5].sum(axis=0).tolist()
        stiffest = 8.0 * self.springs.k0 + self.law.bed
        rounding = 4.0 * float(np.finfo(float).eps) * stiffest * self.unit
        self.allowed = max(_MARGIN * tolerance * abs(load) / max(contacts, 1.0), rounding)
        small = abs(imbalance) <= max(
            _SUM_TOLERANCE * tolerance * abs(load), rounding * math.sqrt(self.u.size)
        )
        return bool(
            worst <= self.allowed and tension <= max(_SUM_TOLERANCE * self.allowed, rounding) and small
        )

    def set_pins(self, contacts: float) -> None:
        """Set pins on the coarse grids, and factorize the coarsest."""
        fraction = contacts / self.u.size
        self.hierarchy.set_pins(self.correction, self.bound, self.shape[1], fraction, Response(self.bed))
        grid = self.hierarchy.grids[-1]
        cells = grid.cells
        matrix = grid.laplacian() + np.diag(grid.in_order(grid.pins) + self.bed * cells)
        matrix += self.coupling * np.outer(cells, cells)
        self.coarsest = np.linalg.pinv(matrix, hermitian=True)

    def correct_on_grid(self, level: int) -> float:
        """One V-cycle from a grid up; the uniform force that its correction adds."""
        grid = self.hierarchy.grids[level]
        (e,), (b,), (joined,) = grid.corrections, grid.sources, grid.joined
        if grid is self.hierarchy.grids[-1]:
            found = self.coarsest @ grid.in_order(b)
            joined[...] = found.reshape(joined.shape)
            return self.coupling * float(grid.cells @ found)
        operator = (grid.pins, np.float32(self.bed), *grid.geometry)
        coarser = self.hierarchy.grids[level + 1]
        e.fill(0.0)
        self.rows.by_color(kernels.coarse_sweep_1, grid.shape, e, b, *operator, first=0)
        uniform = self.coupling * grid.total(e) if self.coupling else 0.0
        self.rows(
            kernels.coarse_restrict_1,
            *coarser.shape,
            e,
            b,
            *operator,
            np.float32(uniform),
            coarser.sources[0],
        )
        uniform += self.correct_on_grid(level + 1)
        fields = (coarser.joined[0], e, b, np.float32(-uniform), grid.mx, grid.my, grid.shape[1])
        self.rows(kernels.coarse_correct, *grid.shape, *fields)
        self.rows.by_color(kernels.coarse_sweep_1, grid.shape, e, b, *operator, first=1)
        self.rows(kernels.join_rows, *grid.shape, e, joined)
        return self.coupling * grid.total(e) if self.coupling else 0.0

    def combine(self) -> None:
        """Move by the combination of correction and previous move that has the lowest energy."""
        e, bound, source, _, uniform, columns = self.equation()
        coarse, previous = self.hierarchy.grids[0].joined[0], self.previous
        bed = np.float32(self.bed)
        self.rows(
            kernels.products_1,
            *self.shape,
            coarse,
            previous,
            e,
            bound,
            source,
            bed,
            uniform,
            columns,
            self.sums,
        )
        weights = map(np.float32, lowest(self.sums.sum(axis=0), self.coupling))
        self.rows(kernels.correct_1, *self.shape, coarse, previous, e, bound, columns, *weights)


def lowest(sums: Field, coupling: float) -> tuple[float, float]:
    """Combination alpha, beta of two directions that minimizes the energy, or alpha alone."""
    rd, rq, dd, dq, qq, sd, sq = sums.tolist()
    dd, dq, qq = dd + coupling * sd * sd, dq + coupling * sd * sq, qq + coupling * sq * sq
    determinant = dd * qq - dq * dq
    if dd > 0 and qq > 0 and determinant > 1e-6 * dd * qq:
        return (rq * dq - rd * qq) / determinant, (rd * dq - rq * dd) / determinant
    return (-rd / dd if dd > 0 else 1.0), 0.0
