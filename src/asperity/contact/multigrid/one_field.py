r"""Contact in an instant, above anchors v, and the relaxed state of the lattice of springs.

Both have S = k0 lam + bed but for wave vector 0, so the force is

    r = k0 L u + bed (u - v + mean(v)) + uniform,      uniform = base + coupling mean(u),

with one number, the uniform force, to be found along with u:

    instantaneous, load control         bed = k1,  coupling = -k1,  base = F / N
    instantaneous, separation control   bed = k1,  coupling = 0,    base = -k1 mean(v)
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

from asperity.contact.arrays import largest
from asperity.contact.multigrid import operations
from asperity.contact.multigrid.grids import Corrections, Grid, empty
from asperity.contact.multigrid.loops import CoarseOne, Measured, One, Pair, Scales, Sites, Surface
from asperity.contact.multigrid.operations import Extremes
from asperity.contact.problem import SpringProblem
from asperity.lattice import Field
from asperity.solids import Springs


@dataclass(frozen=True)
class Tuning:
    """Numbers that decide how accurate a state is beyond its tolerance."""

    margin: float = 0.1
    """Part of the tolerance that cycles aim at: many small forces off contact shift the separation."""
    sum_tolerance: float = 1e-3
    """Largest sum of the forces off contact, and of the tension in a row, relative to what one force may be
    off. The former, because forces that all have one sign would shift the separation; tension, because it is
    set to 0."""

    half_sweeps: int = 4
    """Half sweeps before each correction."""
    single_precision: float = 100 * float(np.finfo(np.float32).eps)
    """Defect that cycles in single precision reach, over the stiffness times the largest correction."""


TUNING = Tuning()


class OneField(Corrections):
    """Work space for one lattice."""

    def __init__(self, sites: Sites) -> None:
        super().__init__(sites, 1)
        self.previous = empty(sites)

    def solve(
        self, problem: SpringProblem, u: Field, tolerance: float, max_cycles: int
    ) -> tuple[bool, float, int]:
        """Improve u in place; whether the tolerance was reached, the uniform force, and the cycles taken."""
        springs, anchors, load = problem.springs, problem.anchors, problem.load
        self.heights, self.u, self.k0 = np.ascontiguousarray(problem.heights), u, springs.k0
        self.stiffness = 0.0 if springs.relaxed else springs.k1
        self.bed, self.coupling = self.stiffness / springs.k0, 0.0
        self.springs = Springs(1.0, self.bed)
        self.forget()
        if load is None:
            self.base = -springs.k1 * float(np.mean(anchors))
        else:
            self.base, self.coupling = load / u.size, -self.bed / u.size
        self.unit = largest(u, np) or abs(self.base) / springs.k1 or 1.0
        self.shape: Field | None = None
        if isinstance(anchors, np.ndarray) and not springs.relaxed:
            self.shape = anchors - float(np.mean(anchors))
            self.unit = max(self.unit, largest(self.shape, np))
        self.previous.fill(0.0)
        first, (e,) = self.grids[0], self.correction
        uniform, _ = self.measure(tolerance)
        for cycle in range(1, max_cycles + 1):
            operations.sweep_1(self.equation(), TUNING.half_sweeps)
            eq = self.equation()
            sums = operations.restrict_1(eq, first.source[0])
            if sums.contacts == 0 and load is not None:
                deepest = int(np.argmax(self.bound - e))  # something must carry the load
                e.flat[deepest] = self.bound.flat[deepest]
                continue
            if self.is_done(sums):
                self.settle()
                uniform, converged = self.measure(tolerance)
                if converged:
                    return True, uniform, cycle
                eq = self.equation()
                operations.restrict_1(eq, first.source[0])
            self.improve_on_grids(sums.contacts)
            # Move by the combination of correction and previous move that has the lowest energy. Corrections
            # taken as they are need up to three times the cycles.
            weights = lowest(operations.products_1(eq, first.joined[0], self.previous), self.coupling)
            operations.correct_1(eq, first.joined[0], self.previous, *weights)
        self.settle()
        return False, uniform, max_cycles

    def settle(self) -> None:
        """Add the correction to the surface."""
        surface, both = Surface(self.u, self.u[:0], self.heights), Pair(*2 * self.correction)
        operations.settle(surface, both, self.bound, self.unit, 0.0)

    def measure(self, tolerance: float) -> tuple[float, bool]:
        """Begin a correction to the surface as it is; the uniform force on it, and whether it is solved.

        It is if forces off contact, tension in contact and the sum of the former are small.
        """
        k0, bed = self.k0, self.stiffness
        uniform = self.base - bed * float(self.u.mean()) if self.coupling else self.base
        surface = Surface(self.u, self.u if self.shape is None else self.u - self.shape, self.heights)
        scales, into = Scales(k0 * self.unit, self.unit, 0.0), Measured(self.bound, *2 * self.source)
        law = Springs(k0, bed)
        sums = operations.measure(surface, law, uniform, scales, into, self.sites, flowing=False)
        self.clear()
        rounding = 4.0 * float(np.finfo(float).eps) * (8.0 * k0 + bed) * self.unit
        self.allowed = max(TUNING.margin * tolerance * abs(sums.load) / max(sums.contacts, 1.0), rounding)
        most = max(TUNING.sum_tolerance * tolerance * abs(sums.load), rounding * math.sqrt(self.u.size))
        tensile = sums.tension > max(TUNING.sum_tolerance * self.allowed, rounding)
        return uniform, sums.worst <= self.allowed and not tensile and abs(sums.imbalance) <= most

    def equation(self) -> One:
        """The equation with what the correction adds to the uniform force."""
        uniform = 0.0
        if self.coupling:
            uniform = self.coupling * operations.total(self.correction[0], self.sites)
        bed, diagonal, force = map(np.float32, (self.bed, 4.0 + self.bed, uniform))
        return One(self.correction[0], self.bound, self.source[0], bed, diagonal, force, self.sites)

    def is_done(self, extremes: Extremes) -> bool:
        """Whether the correction is good enough, or as good as single precision allows."""
        reachable = TUNING.single_precision * (8.0 + self.bed) * extremes.far
        return extremes.worst <= max(self.allowed / (self.k0 * self.unit), reachable)

    def equations(self, level: int) -> CoarseOne:
        """See `Corrections`."""
        grid = self.grids[level]
        return CoarseOne(
            *(grid.correction[0], grid.source[0], np.float32(self.bed), self.coupling, *grid.mesh)
        )

    def inverse_on(self, grid: Grid) -> Field:
        """See `Corrections`; nothing is missing that the coupling does not make up for at once."""
        cells = grid.areas.ravel()
        matrix = grid.laplacian + np.diag(grid.in_order(grid.pins) + self.bed * cells)
        matrix += self.coupling * np.outer(cells, cells)
        inverse = np.linalg.pinv(matrix, hermitian=True)
        return np.pad(np.vstack((inverse, -self.coupling * cells @ inverse)), ((0, 0), (0, 1)))


def lowest(sums: Field, coupling: float) -> tuple[float, float]:
    """Combination alpha, beta of two directions that minimizes the energy, or alpha alone."""
    rd, rq, dd, dq, qq, sd, sq = sums.tolist()
    dd, dq, qq = dd + coupling * sd * sd, dq + coupling * sd * sq, qq + coupling * sq * sq
    determinant = dd * qq - dq * dq
    if dd > 0 and qq > 0 and determinant > 1e-6 * dd * qq:
        return (rq * dq - rd * qq) / determinant, (rd * dq - rq * dd) / determinant
    return (-rd / dd if dd > 0 else 1.0), 0.0
