r"""One implicit step of creep of the lattice of springs, on the pair of u and its stretch w = u - u0.

The stiffness of a finite step is not local, but the pair is:

    k0 L u + k1 w = r,                          0 <= r  perpendicular to  u - xi >= 0
    w + spread L w + drag w = u - v + shift,

shift = 0 where the separation is held; where the load is, the shift is unknown and the sum of k1 w is F.
Only u is constrained, and only contacts are invisible to coarse grids: the cycle is that of
`asperity.contact.multigrid.one_field`, both unknowns of a site relaxed together.

A step starts near its end, and a cycle usually divides the error by four or more; the size of the
correction tells the error that was, and so the one that is left. Where cycles are slower,
the correction is combined with the previous one as there, by the stationary point of the symmetric form
that the pair makes instead of the lowest energy.
"""

from __future__ import annotations

import math

import numpy as np

from asperity.contact import kernels
from asperity.contact.multigrid.grids import Hierarchy, Rows
from asperity.contact.multigrid.one_field import lowest
from asperity.contact.multigrid.pins import Response
from asperity.contact.problem import SpringStep
from asperity.lattice import Field

_SLOW = 0.4
"""Ratio of successive corrections above which they are combined."""

_USUAL_RATE = 0.3
"""Ratio of successive errors expected before two are known."""

_FORCE_ERROR = 1e-3
"""Error of the sum of the forces that is allowed even where an error of u0 is."""


class TwoFields:
    """Work space for one lattice."""

    def __init__(self, shape: tuple[int, ...], rows: Rows) -> None:
        self.rows = rows
        self.hierarchy = Hierarchy(shape, 2, rows)
        self.steps = (np.zeros(shape, np.float32), np.zeros(shape, np.float32))
        self.sums = np.zeros((shape[0], 7))
        self.pinned = -math.inf

    def solve(
        self,
        springs: SpringStep,
        heights: Field,
        u: Field,
        w: Field,
        allowed_error: float,
        tolerance: float,
        max_cycles: int,
    ) -> tuple[bool, int]:
        """Improve u and w in place; whether the error became small enough, and the cycles taken."""
        self.springs, self.heights, self.u, self.w = springs, heights, u, w
        shape = springs.shape
        self.v = shape if isinstance(shape, np.ndarray) else np.full(u.shape, shape)
        self.unit = max(float(u.max()), -float(u.min())) or 1.0
        self.shift = 0.0
        if springs.load is not None:
            self.shift = (1.0 + springs.drag) * float(w.mean()) - float(u.mean()) + float(self.v.mean())
        self.last_shift, self.pinned = 0.0, -math.inf
        size = math.inf
        for cycle in range(max_cycles):
            self.sweep()
            contacts = self.restrict()
            missing, left = self.judge()
            if allowed_error == 0 and left <= self.strict(tolerance, contacts):
                return True, cycle + 1
            self.set_pins(contacts)
            self.shift_step = self.correct_on_grid(0, missing)
            before, size = size, self.size_of_correction()
            if not math.isfinite(size):
                break
            if cycle == 1:
                self.forget()
            rate = min(max(size / before, 0.1), 0.9) if cycle else _USUAL_RATE
            self.move(keep=cycle > 0, combine=cycle > 0 and size > _SLOW * before)
            missed = rate * abs(missing) * springs.k1
            if rate * size <= allowed_error and missed <= _FORCE_ERROR * abs(self.force_of_contacts()):
                self.sweep()
                self.keep_mean()
                return True, cycle + 1
        return False, max_cycles

    def keep_mean(self) -> None:
        """Make the mean of w exact: what creep conserves must not drift."""
        s = self.springs
        if s.load is None:
            mean = (float(self.u.mean()) - float(self.v.mean())) / (1.0 + s.drag)
        else:
            mean = s.load / (s.k1 * self.u.size)
        self.w += mean - float(self.w.mean())

    def forget(self) -> None:
        """Begin with no previous step."""
        for step in self.steps:
            step.fill(0.0)

    def sweep(self) -> None:
        """Find the contacts and smooth the error."""
        self.rows.sweeps(kernels.sweeps_2, kernels.close_sweeps_2, self.u.shape, *self.equation(), halves=2)

    def equation(self) -> tuple[object, ...]:
        """Fields and coefficients, as the kernels take them."""
        s = self.springs
        return (self.u, self.w, self.heights, self.v, s.k0, s.k1, s.spread, s.drag, self.shift)

    def restrict(self) -> float:
        """Bring both defects to the first coarse grid; the number of contacts."""
        grid = self.hierarchy.grids[0]
        self.rows(
            kernels.restrict_2, *grid.shape, *self.equation(), 1.0 / self.unit, *grid.sources, self.sums
        )
        return float(self.sums[:, 3].sum())

    def force_of_contacts(self) -> float:
        """Sum of the forces, which is that of k1 w."""
        return self.springs.k1 * float(self.sums[:, 2].sum())

    def judge(self) -> tuple[float, float]:
        """What is missing in the sum of w, and the larger rms of what the equations leave, as a length."""
        balance, creep, stretch = self.sums[:, :3].sum(axis=0).tolist()
        sites, springs = self.u.size, self.springs
        missing = 0.0 if springs.load is None else springs.load / springs.k1 - stretch
        left = max(math.sqrt(balance / sites) / springs.k1, math.sqrt(creep / sites), abs(missing) / sites)
        return missing, left

    def strict(self, tolerance: float, contacts: float) -> float:
        """What the equations may leave where no error is allowed."""
        s = self.springs
        rounding = 4.0 * float(np.finfo(float).eps) * (8.0 * s.k0 / s.k1 + 1.0) * self.unit
        return max(tolerance * abs(self.force_of_contacts()) / (s.k1 * max(contacts, 1.0)), rounding)

    def size_of_correction(self) -> float:
        """Correction of u0, rms over the sites: the error before it."""
        e, f = self.hierarchy.grids[0].corrections
        return self.unit * math.sqrt(float(np.mean((e - f) ** 2, dtype=float)))

    def set_pins(self, contacts: float) -> None:
        """Tell the coarse grids of the contacts, where many have changed, and factorize the coarsest."""
        if abs(contacts - self.pinned) <= 0.02 * self.pinned:
            return
        self.pinned = contacts
        s = self.springs
        response = Response(s.k1 / s.k0, s.spread, s.drag)
        self.hierarchy.set_pins(self.u, self.heights, int(contacts), response)
        grid = self.hierarchy.grids[-1]
        lap, cells = grid.laplacian(), grid.cells
        n = cells.size
        matrix = np.zeros((2 * n + 1, 2 * n + 1))
        # No pins leave a mean that nothing holds, which is none of this grid's business.
        matrix[:n, :n] = lap + np.diag(np.maximum(grid.pins.ravel(), 1e-9 * cells))
        matrix[:n, n:-1] = np.diag(response.bed * cells)
        matrix[n:-1, :n] = -np.diag(cells)
        matrix[n:-1, n:-1] = s.spread * lap + np.diag((1.0 + s.drag) * cells)
        if s.load is None:
            matrix[-1, -1] = 1.0
        else:
            matrix[n:-1, -1] = -cells
            matrix[-1, n:-1] = cells
        self.coarsest = np.linalg.inv(matrix)

    def correct_on_grid(self, level: int, missing: float) -> float:
        """One V-cycle from a grid up; the shift that its correction adds."""
        return self._correct_on_grid(level, missing / self.unit) * self.unit

    def _correct_on_grid(self, level: int, missing: float) -> float:
        grid = self.hierarchy.grids[level]
        (e, f), (b, c) = grid.corrections, grid.sources
        if grid is self.hierarchy.grids[-1]:
            if self.springs.load is None:
                missing = 0.0
            known = np.concatenate([b.ravel(), c.ravel(), [missing]])
            found = self.coarsest @ known
            e[...], f[...] = found[: e.size].reshape(e.shape), found[e.size : -1].reshape(f.shape)
            return float(found[-1])
        s = self.springs
        coefficients = (s.k1 / s.k0, s.spread, 1.0 + s.drag)
        operator = (grid.pins, *map(np.float32, coefficients), *grid.geometry)
        coarser = self.hierarchy.grids[level + 1]
        e.fill(0.0)
        f.fill(0.0)
        self.rows.by_color(kernels.coarse_sweep_2, e.shape, e, f, b, c, *operator, first=0)
        missing -= grid.total(f)
        self.rows(kernels.coarse_restrict_2, *coarser.shape, e, f, b, c, *operator, *coarser.sources)
        shift = self._correct_on_grid(level + 1, missing)
        sizes = (grid.mx, grid.my)
        correction_u, correction_w = coarser.corrections
        self.rows(kernels.coarse_correct, *e.shape, correction_u, e, b, np.float32(0.0), *sizes)
        self.rows(kernels.coarse_correct, *e.shape, correction_w, f, c, np.float32(shift), *sizes)
        self.rows.by_color(kernels.coarse_sweep_2, e.shape, e, f, b, c, *operator, first=1)
        return shift

    def move(self, *, keep: bool, combine: bool) -> None:
        """Move by the correction, or by what it and the previous step make together."""
        alpha, beta = 1.0, 0.0
        coarse = self.hierarchy.grids[0].corrections
        if combine:
            self.rows(kernels.products_2, *self.u.shape, *coarse, *self.steps, *self.equation(), self.sums)
            alpha, beta = self.stationary()
        fields = (*coarse, *self.steps, self.u, self.w, self.heights)
        self.rows(
            kernels.correct_2,
            *self.u.shape,
            *fields,
            np.float32(alpha),
            np.float32(beta),
            self.unit,
            keep,
        )
        self.last_shift = (alpha * self.shift_step + beta * self.last_shift) if keep else 0.0
        self.shift += self.last_shift if keep else alpha * self.shift_step

    def stationary(self) -> tuple[float, float]:
        """Combination of the correction and the previous step; the plain correction if in doubt."""
        rd, rq, dd, dq, qq, sf, sg = self.sums.sum(axis=0).tolist()
        k1, unit = self.springs.k1, self.unit
        if self.springs.load is not None:
            short = k1 * float(self.w.sum()) - self.springs.load
            shift, last = self.shift_step / unit, self.last_shift / unit
            rd, rq = rd + short * shift, rq + short * last
            dd, qq = dd + 2.0 * k1 * shift * sf, qq + 2.0 * k1 * last * sg
            dq += k1 * (shift * sg + last * sf)
        if qq < 0 or dd <= 0:
            return 1.0, 0.0
        alpha, beta = lowest(np.array([rd, rq, dd, dq, qq, 0.0, 0.0]), 0.0, unit)
        return (alpha, beta) if 0.1 < alpha < 5.0 else (1.0, 0.0)
