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

All this happens to a correction (e, f) of the pair, in single precision, which is added at the end, or
where no error is allowed as often as it has become as good as rounding allows.
"""

from __future__ import annotations

import math

import numpy as np

from asperity.contact import kernels
from asperity.contact.multigrid.grids import Hierarchy, Rows, parted_shape
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

_AS_GOOD_AS_IT_GETS = 100 * float(np.finfo(np.float32).eps)
"""What the equations leave when a correction is added, in units of the correction."""


class TwoFields:
    """Work space for one lattice."""

    def __init__(self, shape: tuple[int, ...], rows: Rows) -> None:
        self.rows, self.shape = rows, shape
        self.hierarchy = Hierarchy(shape, 2, rows)
        parts = parted_shape(*shape)
        self.gap = np.full(parts, -np.inf, np.float32)
        self.corrections, self.sources, self.steps = (
            (np.zeros(parts, np.float32), np.zeros(parts, np.float32)) for _ in range(3)
        )
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
        self.bed, self.lag = springs.k1 / springs.k0, 1.0 + springs.drag
        self.unit = max(float(u.max()), -float(u.min())) or 1.0
        self.last_shift, self.pinned = 0.0, -math.inf
        self.total_stretch = 0.0
        self.forget()
        self.measure()
        size = math.inf
        for cycle in range(max_cycles):
            self.sweep()
            contacts = self.restrict()
            missing, left, far = self.judge()
            as_good_as_it_gets = _AS_GOOD_AS_IT_GETS * (8.0 / self.bed + 1.0) * far
            if allowed_error == 0 and left <= max(self.strict(tolerance, contacts), as_good_as_it_gets):
                self.settle()
                self.measure()
                contacts = self.restrict()
                missing, left, _ = self.judge()
                if left <= self.strict(tolerance, contacts):
                    return True, cycle + 1
            self.set_pins(contacts)
            self.shift_step = self.correct_on_grid(0, missing / self.unit)
            before, size = size, self.size_of_correction()
            if not math.isfinite(size):
                return False, max_cycles
            if cycle == 1:
                self.forget()
            rate = min(max(size / before, 0.1), 0.9) if cycle else _USUAL_RATE
            self.move(keep=cycle > 0, combine=cycle > 0 and size > _SLOW * before)
            missed = rate * abs(missing) * springs.k1
            if rate * size <= allowed_error and missed <= _FORCE_ERROR * abs(self.force_of_contacts()):
                self.sweep()
                self.settle()
                self.keep_mean()
                return True, cycle + 1
        self.settle()
        return False, max_cycles

    def measure(self) -> None:
        """Begin a correction to the fields as they are."""
        s = self.springs
        shift = 0.0
        if s.load is not None:
            shift = self.lag * float(self.w.mean()) - float(self.u.mean()) + float(self.v.mean())
        self.rows(
            kernels.measure_2,
            *self.shape,
            self.u,
            self.w,
            self.heights,
            self.v,
            s.k0,
            s.k1,
            s.spread,
            s.drag,
            shift,
            self.unit,
            self.gap,
            *self.sources,
            self.sums,
        )
        self.stretch = float(self.sums[:, 0].sum())
        for field in self.corrections:
            field.fill(0.0)
        self.shift = 0.0

    def settle(self) -> None:
        """Add the corrections."""
        e, f = self.corrections
        self.rows(kernels.settle, *self.shape, self.u, self.heights, e, self.gap, self.unit)
        self.rows(kernels.add, *self.shape, self.w, f, self.unit)

    def keep_mean(self) -> None:
        """Make the mean of w exact: what creep conserves must not drift."""
        s = self.springs
        if s.load is None:
            mean = (float(self.u.mean()) - float(self.v.mean())) / self.lag
        else:
            mean = s.load / (s.k1 * self.u.size)
        self.w += mean - float(self.w.mean())

    def forget(self) -> None:
        """Begin with no previous step."""
        for step in self.steps:
            step.fill(0.0)

    def sweep(self) -> None:
        """Find the contacts and smooth the error."""
        self.rows.sweeps(kernels.sweeps_2, kernels.close_sweeps_2, self.shape, *self.equation(), halves=2)

    def equation(self) -> tuple[object, ...]:
        """Fields and coefficients, as the kernels take them."""
        coefficients = map(np.float32, (self.bed, self.springs.spread, self.lag, self.shift))
        return (*self.corrections, self.gap, *self.sources, *coefficients, self.shape[1])

    def restrict(self) -> float:
        """Bring both defects to the first coarse grid; the number of contacts."""
        grid = self.hierarchy.grids[0]
        self.rows(kernels.restrict_2, *grid.shape, *self.equation(), *grid.sources, self.sums)
        return float(self.sums[:, 3].sum())

    def force_of_contacts(self) -> float:
        """Sum of the forces, which is that of k1 w."""
        return self.springs.k1 * self.total_stretch

    def judge(self) -> tuple[float, float, float]:
        """What is missing in the sum of w; what the equations leave; the correction; rms, as lengths."""
        balance, creep, stretch, _, far = self.sums[:, :5].sum(axis=0).tolist()
        sites, springs = self.u.size, self.springs
        self.total_stretch = self.stretch + self.unit * stretch
        missing = 0.0 if springs.load is None else springs.load / springs.k1 - self.total_stretch
        left = self.unit * max(math.sqrt(balance / sites) / self.bed, math.sqrt(creep / sites))
        return missing, max(left, abs(missing) / sites), self.unit * math.sqrt(far / sites)

    def strict(self, tolerance: float, contacts: float) -> float:
        """What the equations may leave where no error is allowed."""
        rounding = 4.0 * float(np.finfo(float).eps) * (8.0 / self.bed + 1.0) * self.unit
        force = abs(self.force_of_contacts())
        return max(tolerance * force / (self.springs.k1 * max(contacts, 1.0)), rounding)

    def size_of_correction(self) -> float:
        """Correction of u0, rms over the sites: the error before it."""
        e, f = self.hierarchy.grids[0].joined
        return self.unit * math.sqrt(float(np.mean((e - f) ** 2, dtype=float)))

    def set_pins(self, contacts: float) -> None:
        """Tell the coarse grids of the contacts, where many have changed, and factorize the coarsest."""
        if abs(contacts - self.pinned) <= 0.02 * self.pinned:
            return
        self.pinned = contacts
        s = self.springs
        response = Response(self.bed, s.spread, s.drag)
        e, fraction = self.corrections[0], contacts / self.u.size
        self.hierarchy.set_pins(e, self.gap, self.shape[1], fraction, response)
        grid = self.hierarchy.grids[-1]
        lap, cells = grid.laplacian(), grid.cells
        n = cells.size
        matrix = np.zeros((2 * n + 1, 2 * n + 1))
        # No pins leave a mean that nothing holds, which is none of this grid's business.
        matrix[:n, :n] = lap + np.diag(np.maximum(grid.in_order(grid.pins), 1e-9 * cells))
        matrix[:n, n:-1] = np.diag(self.bed * cells)
        matrix[n:-1, :n] = -np.diag(cells)
        matrix[n:-1, n:-1] = s.spread * lap + np.diag(self.lag * cells)
        if s.load is None:
            matrix[-1, -1] = 1.0
        else:
            matrix[n:-1, -1] = -cells
            matrix[-1, n:-1] = cells
        self.coarsest = np.linalg.inv(matrix)

    def correct_on_grid(self, level: int, missing: float) -> float:
        """One V-cycle from a grid up; the shift that its correction adds."""
        grid = self.hierarchy.grids[level]
        (e, f), (b, c), joined = grid.corrections, grid.sources, grid.joined
        if grid is self.hierarchy.grids[-1]:
            if self.springs.load is None:
                missing = 0.0
            found = self.coarsest @ np.concatenate([grid.in_order(b), grid.in_order(c), [missing]])
            for field, values in zip(joined, np.split(found[:-1], 2), strict=True):
                field[...] = values.reshape(field.shape)
            return float(found[-1])
        coefficients = map(np.float32, (self.bed, self.springs.spread, self.lag))
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

    def move(self, *, keep: bool, combine: bool) -> None:
        """Move by the correction, or by what it and the previous step make together."""
        alpha, beta = 1.0, 0.0
        coarse = self.hierarchy.grids[0].joined
        if combine:
            self.rows(kernels.products_2, *self.shape, *coarse, *self.steps, *self.equation(), self.sums)
            alpha, beta = self.stationary()
        fields = (*coarse, *self.steps, *self.corrections, self.gap, self.shape[1])
        self.rows(kernels.correct_2, *self.shape, *fields, np.float32(alpha), np.float32(beta))
        step = alpha * self.shift_step + beta * self.last_shift
        self.shift += step
        self.last_shift = step if keep else 0.0

    def stationary(self) -> tuple[float, float]:
        """Combination of the correction and the previous step; the plain correction if in doubt."""
        rd, rq, dd, dq, qq, sf, sg = self.sums.sum(axis=0).tolist()
        if self.springs.load is not None:
            short = (self.force_of_contacts() - self.springs.load) / (self.springs.k0 * self.unit)
            shift, last = self.shift_step, self.last_shift
            rd, rq = rd + short * shift, rq + short * last
            dd, qq = dd + 2.0 * self.bed * shift * sf, qq + 2.0 * self.bed * last * sg
            dq += self.bed * (shift * sg + last * sf)
        if qq < 0 or dd <= 0:
            return 1.0, 0.0
        alpha, beta = lowest(np.array([rd, rq, dd, dq, qq, 0.0, 0.0]), 0.0)
        return (alpha, beta) if 0.1 < alpha < 5.0 else (1.0, 0.0)
