r"""One implicit step of creep of the lattice of springs, on the pair of u and its stretch w = u - u0.

The stiffness of a finite step is not local, but the pair is:

    k0 L u + k1 w = r,                          0 <= r  perpendicular to  u - xi >= 0
    w + spread L w + drag w = u - v + shift,

shift = 0 under separation control; under load control the shift is unknown and the sum of k1 w is F.
Only u is constrained, and only contacts are invisible to coarse grids: the cycle is that of
`asperity.contact.multigrid.one_field`, both unknowns of a site relaxed together. Where cycles are slow,
the correction is combined with the previous one as there, by the stationary point of the symmetric form
that the pair makes instead of the lowest energy.

All this happens to a correction (e, f) of the pair, in single precision and in units in which k0 = 1.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np

from asperity.contact import kernels
from asperity.contact.arrays import largest
from asperity.contact.multigrid.grids import Hierarchy, Rows, Single, parted_shape
from asperity.contact.multigrid.one_field import SINGLE_PRECISION, lowest
from asperity.contact.multigrid.pins import Response
from asperity.contact.problem import SpringStep
from asperity.lattice import Field

_SLOW = 0.4
"""Ratio of successive corrections above which they are combined."""

_USUAL_RATE = 0.3
"""Ratio of successive errors expected before two are known."""

_FORCE_ERROR = 1e-3
"""Error of the sum of the forces that is allowed even where an error of u0 is."""

_ROUNDING = 20 * float(np.finfo(np.float32).eps)
"""Change below which cycles no longer converge, in units of the correction: 16 was the most seen."""


class TwoFields:
    """Work space for one lattice, and the correction on it.

    Attributes
    ----------
    correction, source, previous
        e and f; b and c of the equations in `asperity.contact.kernels`; the previous move of e and f.
    bound
        Least e that does not penetrate, a length <= 0: minus the gap u - heights.
    shift
        The unknown shift, a length.
    wanted
        Sum of f with which the load is carried, a length, or None where the separation is prescribed.
    known_stretch
        Sum of w before the correction, a length.
    """

    def __init__(self, shape: tuple[int, ...], rows: Rows) -> None:
        self.rows, self.shape, self.sites = rows, shape, math.prod(shape)
        self.hierarchy = Hierarchy(shape, 2, rows)
        self.bound = np.full(parted_shape(*shape), -np.inf, np.float32)
        self.correction, self.source, self.previous = (self.pair() for _ in range(3))
        self.sums = np.zeros((shape[0], 7))
        self.shift, self.known_stretch, self.total_stretch = 0.0, 0.0, 0.0
        self.weights, self.last_shift, self.keeping = (1.0, 0.0), 0.0, False
        self.wanted: float | None = None

    def pair(self) -> tuple[Single, Single]:
        """Two fields of zeros."""
        parts = parted_shape(*self.shape)
        return np.zeros(parts, np.float32), np.zeros(parts, np.float32)

    def prepare(self, bed: float, spread: float, drag: float) -> None:
        """Set the coefficients: bed = k1/k0, and those of the equations."""
        self.bed, self.spread, self.lag = bed, spread, 1.0 + drag
        self.response = Response(bed, spread, drag)
        self.pinned = -math.inf

    def solve(
        self, springs: SpringStep, heights: Field, u: Field, w: Field, tolerance: float, max_cycles: int
    ) -> tuple[bool, int]:
        """Improve u and w in place; whether the tolerance was reached, and the cycles taken."""
        self.prepare(springs.k1 / springs.k0, springs.spread, springs.drag)
        unit = largest(u, np) or 1.0
        self.measure(springs, heights, u, w, unit)
        size = math.inf
        for cycle in range(max_cycles):
            self.descend(correcting=cycle > 0)
            contacts, missing, left, far = self.judge()
            stiffest = 8.0 / self.bed + self.lag + 8.0 * self.spread
            reachable = SINGLE_PRECISION * stiffest * far
            if left <= max(self.strict(tolerance, contacts), reachable):
                self.settle(heights, u, w, unit)
                self.measure(springs, heights, u, w, unit)
                self.restrict(0, self.hierarchy.grids[0].shape[0])
                contacts, missing, left, _ = self.judge()
                if left <= self.strict(tolerance, contacts):
                    return True, cycle + 1
            size, _ = self.find_correction(contacts, missing, cycle, size)
            if not math.isfinite(size):
                return False, max_cycles
        self.settle(heights, u, w, unit)
        return False, max_cycles

    def improve(self, allowed_error: float, max_cycles: int) -> tuple[bool, int]:
        """Improve the correction until the error of e - f, rms over the sites, is small enough, or rounding.

        A time step starts near its end, and a cycle usually divides the error by four or more; the size of
        a change estimates the error before it, and so the one that is left.
        """
        size = math.inf
        for cycle in range(max_cycles):
            self.descend(correcting=cycle > 0)
            contacts, missing, _, far = self.judge()
            size, rate = self.find_correction(contacts, missing, cycle, size)
            if not math.isfinite(size):
                break
            if self.wanted is not None and contacts == 0:
                continue  # something must carry the load
            good = rate * size <= max(allowed_error, _ROUNDING * far)
            if good and rate * abs(missing) <= _FORCE_ERROR * abs(self.total_stretch):
                self.descend(correcting=True, restricting=False)
                return True, cycle + 1
        return False, max_cycles

    def measure(self, springs: SpringStep, heights: Field, u: Field, w: Field, unit: float) -> None:
        """Begin a correction to the fields as they are."""
        s, v, shift = springs, springs.anchors, 0.0
        if not isinstance(v, np.ndarray):
            v = np.full(u.shape, v)
        if s.load is not None:
            shift = self.lag * float(w.mean()) - float(u.mean()) + float(v.mean())
        coefficients = (s.k0, s.k1, s.spread, s.drag, shift, unit)
        into = (self.bound, *self.source, self.sums)
        self.rows(kernels.measure_2, *self.shape, u, w, heights, v, *coefficients, *into)
        for field in self.correction:
            field.fill(0.0)
        self.shift, self.known_stretch = 0.0, float(self.sums[:, 0].sum()) / unit
        self.wanted = None if s.load is None else s.load / (s.k1 * unit) - self.known_stretch

    def settle(self, heights: Field, u: Field, w: Field, unit: float) -> None:
        """Add the correction."""
        e, f = self.correction
        self.rows(kernels.settle, *self.shape, u, heights, e, self.bound, unit)
        self.rows(kernels.add, *self.shape, w, f, unit)

    def equation(self) -> tuple[Any, ...]:
        """Fields and coefficients, as the kernels take them."""
        coefficients = map(np.float32, (self.bed, self.spread, self.lag, self.shift))
        return (*self.correction, self.bound, *self.source, *coefficients, self.shape[1])

    def descend(self, *, correcting: bool, restricting: bool = True) -> None:
        """Add what the coarse grids found, find the contacts and smooth, and bring the defects to them."""
        grid = self.hierarchy.grids[0]
        moves = (*grid.joined, *self.previous, *map(np.float32, self.weights), self.keeping, correcting)
        lead = int(correcting)
        edges = self.rows.and_edges(
            kernels.cycle_2,
            kernels.close_cycle_2,
            self.shape,
            *self.equation(),
            before=(*moves, *grid.sources, restricting),
            after=(self.sums,),
            closing=(lead,),
        )
        if not restricting:
            return
        margin, done = lead + 2, 0
        for low, high in pairwise(edges):
            last = high - 1 if high == self.shape[0] and high % 2 else high
            first, end = (low + margin + 2) // 2, (last - margin) // 2
            if first < end:
                self.restrict(done, first)
                done = end
        self.restrict(done, grid.shape[0])

    def restrict(self, low: int, high: int) -> None:
        """Bring both defects to rows of the first coarse grid."""
        arguments = (*self.equation(), *self.hierarchy.grids[0].sources, self.sums, low, high)
        kernels.restrict_2(*arguments)

    def judge(self) -> tuple[float, float, float, float]:
        """Contacts; what the sum of f lacks; what the equations leave and the correction, both rms."""
        balance, creep, stretch, contacts, far = self.sums[:, :5].sum(axis=0).tolist()
        self.total_stretch = self.known_stretch + stretch
        missing = 0.0 if self.wanted is None else self.wanted - stretch
        left = max(math.sqrt(balance / self.sites) / self.bed, math.sqrt(creep / self.sites))
        left = max(left, abs(missing) / self.sites)
        return contacts, missing, left, math.sqrt(far / self.sites)

    def strict(self, tolerance: float, contacts: float) -> float:
        """What the equations may leave in the end."""
        rounding = 4.0 * float(np.finfo(float).eps) * (8.0 / self.bed + 1.0)
        return max(tolerance * abs(self.total_stretch) / max(contacts, 1.0), rounding)

    def find_correction(
        self, contacts: float, missing: float, cycle: int, before: float
    ) -> tuple[float, float]:
        """Ask the coarse grids; the size of their correction of u0, rms, and the rate of the cycles."""
        self.set_pins(contacts)
        shift = self.correct_on_grid(0, missing)
        e, f = self.hierarchy.grids[0].joined
        size = math.sqrt(float(np.mean((e - f) ** 2, dtype=float)))
        if not math.isfinite(size):
            return size, 1.0
        self.weights = (1.0, 0.0)
        if cycle == 0:
            self.keeping, self.last_shift = False, 0.0
        elif size > _SLOW * before:
            if not self.keeping:
                self.keeping, self.last_shift = True, 0.0
                for field in self.previous:
                    field.fill(0.0)
            fields = (*self.hierarchy.grids[0].joined, *self.previous, *self.equation())
            self.rows(kernels.products_2, *self.shape, *fields, self.sums)
            self.weights = self.stationary(shift, missing)
        alpha, beta = self.weights
        self.last_shift = alpha * shift + beta * self.last_shift
        self.shift += self.last_shift
        # Where nothing creeps e = f, and there are no two errors to compare.
        return size, min(max(size / before, 0.1), 0.9) if cycle and before > 0 else _USUAL_RATE

    def set_pins(self, contacts: float) -> None:
        """Set pins on the coarse grids, where many have changed, and factorize the coarsest."""
        if abs(contacts - self.pinned) <= 0.02 * self.pinned:
            return
        self.pinned = contacts
        e, fraction = self.correction[0], contacts / self.sites
        self.hierarchy.set_pins(e, self.bound, self.shape[1], fraction, self.response)
        grid = self.hierarchy.grids[-1]
        lap, cells = grid.laplacian(), grid.cells
        n = cells.size
        matrix = np.zeros((2 * n + 1, 2 * n + 1))
        # Without pins the matrix is singular: regularize by 1e-9.
        matrix[:n, :n] = lap + np.diag(np.maximum(grid.in_order(grid.pins), 1e-9 * cells))
        matrix[:n, n:-1] = np.diag(self.bed * cells)
        matrix[n:-1, :n] = -np.diag(cells)
        matrix[n:-1, n:-1] = self.spread * lap + np.diag(self.lag * cells)
        if self.wanted is None:
            matrix[-1, -1] = 1.0
        else:
            matrix[n:-1, -1] = -cells
            matrix[-1, n:-1] = cells
        try:
            self.coarsest = np.linalg.inv(matrix)
        except np.linalg.LinAlgError:  # singular by rounding: no cycle converges
            self.coarsest = np.full_like(matrix, np.nan)

    def correct_on_grid(self, level: int, missing: float) -> float:
        """One V-cycle from a grid up; the shift that its correction adds."""
        grid = self.hierarchy.grids[level]
        (e, f), (b, c), joined = grid.corrections, grid.sources, grid.joined
        if grid is self.hierarchy.grids[-1]:
            if self.wanted is None:
                missing = 0.0
            found = self.coarsest @ np.concatenate([grid.in_order(b), grid.in_order(c), [missing]])
            for field, values in zip(joined, np.split(found[:-1], 2), strict=True):
                field[...] = values.reshape(field.shape)
            return float(found[-1])
        coefficients = map(np.float32, (self.bed, self.spread, self.lag))
        operator = (grid.pins, *coefficients, *grid.geometry)
        coarser = self.hierarchy.grids[level + 1]
        e.fill(0.0)
        f.fill(0.0)
        self.rows.by_color(kernels.coarse_sweep_2, grid.shape, e, f, b, c, *operator, first=0)
        missing -= grid.total(f)
        self.rows(kernels.coarse_restrict_2, *coarser.shape, e, f, b, c, *operator, *coarser.sources)
        shift = self.correct_on_grid(level + 1, missing)
        where = (grid.mx, grid.my, grid.shape[1])
        changes = (np.float32(0.0), np.float32(shift))
        for fields in zip(coarser.joined, (e, f), (b, c), changes, strict=True):
            self.rows(kernels.coarse_correct, *grid.shape, *fields, *where)
        self.rows.by_color(kernels.coarse_sweep_2, grid.shape, e, f, b, c, *operator, first=1)
        for parts, out in zip((e, f), joined, strict=True):
            self.rows(kernels.join_rows, *grid.shape, parts, out)
        return shift

    def stationary(self, shift: float, missing: float) -> tuple[float, float]:
        """Combination of the correction and the previous move; the plain correction if in doubt."""
        rd, rq, dd, dq, qq, sf, sg = self.sums.sum(axis=0).tolist()
        if self.wanted is not None:
            last = self.last_shift
            rd, rq = rd - self.bed * missing * shift, rq - self.bed * missing * last
            dd, qq = dd + 2.0 * self.bed * shift * sf, qq + 2.0 * self.bed * last * sg
            dq += self.bed * (shift * sg + last * sf)
        if qq < 0 or dd <= 0:
            return 1.0, 0.0
        alpha, beta = lowest(np.array([rd, rq, dd, dq, qq, 0.0, 0.0]), 0.0)
        return (alpha, beta) if 0.1 < alpha < 5.0 else (1.0, 0.0)
