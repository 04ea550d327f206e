r"""Implicit steps of creep on the lattice of springs whose creep is local and not linear.

    k0 L u + k1 w = r,    0 <= r  perpendicular to  u - xi >= 0
    w + tau k1 R L w + tau v(k1 w) = u - X - v0

v0 is the creeping shape before the step and X the rigid body, which is prescribed, or the sum of k1 w is.
Both sides are monotone, so the step is a convex problem with one solution. Each cycle linearizes the law
at the present stretches, corrects u and w by one multigrid cycle for pairs of unknowns
(`asperity.contact.pair_loops`), and then finds the stretch of each site for its u, which no law overflows:
the local equation has one root, which is bracketed. (Newton's method, with contacts that are found
while relaxing: C. Graeser, R. Kornhuber, J. Comput. Math. 27, 1 (2009).)
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity.contact import pair_loops as loops
from asperity.contact.arrays import largest
from asperity.contact.local_creep import LocalState, Stage, stretches_of
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice
from asperity.solids import SpringConstants
from asperity.solids.creep_laws import LocalCreep

_COARSEST = 24
"""Most cells of the grid on which the problem is solved directly."""

_SOLVED = 1e-2
"""Change of the stretch, relative to how far the law bends in it, below which a site counts as solved."""

_MOST_REVISIONS = 40
"""Revisions of the set of sites that yield after which a step is given up."""

_MOST_CYCLES = 60
"""Cycles after which a step is given up."""

_USUAL_RATE = 0.3
"""Ratio of successive errors expected before two are known."""

_FORCE_ERROR = 1e-3
"""Error of the sum of the forces that is allowed."""

_ROUNDING = 16 * float(np.finfo(float).eps)
"""Change of the creeping shape that rounding makes, in units of the largest length."""

_HEAVY = 1e20
"""Force that keeps contacts closed."""

_FAINT = 1e-9
"""Pins for each site, relative to k1, where there are no contacts."""

_LARGEST_LAG = 1e30
"""Largest coefficient in single precision."""


@dataclass(frozen=True, eq=False)
class _Grid:
    """A coarse grid: its equations (see `pair_loops.restrict`) and both corrections."""

    equations: tuple[Any, ...]
    e: Any
    f: Any

    @classmethod
    def of(cls, shape: tuple[int, int]) -> _Grid:
        """Zeros."""
        fields = [np.zeros(shape, np.float32) for _ in range(12)]
        return cls(tuple(fields[:10]), *fields[10:])


class LatticeCreep:
    """Steps on one lattice."""

    def __init__(
        self,
        springs: SpringConstants,
        law: LocalCreep,
        lattice: Lattice,
        heights: Field,
        bound: float = math.inf,
    ) -> None:
        self.springs, self.law, self.lattice, self.bound = springs, law, lattice, bound
        self.shape = heights.shape
        self.heights = np.atleast_2d(heights)
        ny, nx = self.heights.shape
        below, right = np.ones(ny, np.float32), np.ones(nx, np.float32)
        if lattice.reflecting:
            below[-1] = right[-1] = 0.0
        if ny == 1:
            below[:] = 0.0
        self.bonds = (below, right)
        rows, columns = below + np.roll(below, 1), right + np.roll(right, 1)
        self.bond_count = rows[:, np.newaxis] + columns
        self.kappa = np.float32(springs.k0 / springs.k1)
        self.pair = [np.zeros((ny, nx), np.float32) for _ in range(2)]
        self.grids: list[_Grid] = []
        self.sums = np.zeros(2)
        while not self.grids or (ny * nx > _COARSEST):
            ny, nx = (ny + 1) // 2, (nx + 1) // 2
            self.grids.append(_Grid.of((ny, nx)))

    def laplacian(self, x: Field) -> Field:
        """Minus the Laplacian."""
        out = np.empty_like(x)
        loops.laplacian(x, *self.bonds, out)
        return out

    def stretch(self, force: Field) -> Field:
        """See `LocalCreepSolver`."""
        return force / self.springs.k1

    def velocity(self, force: Field) -> Field:
        """See `LocalCreepSolver`."""
        s = self.springs
        rate = self.law.velocity(force)[0]
        if s.R > 0:
            rate += s.R * self.laplacian(np.atleast_2d(force)).reshape(force.shape)
        if s.R_viscous > 0:
            rate += s.R_viscous * force
        return rate

    def balanced(self, state: LocalState, load: float | None) -> Field:
        """See `LocalCreepSolver`."""
        u, s = np.atleast_2d(state.u), self.springs
        given = u > self.heights
        free = -s.k0 * self.laplacian(u)
        force = np.where(given, free, np.atleast_2d(state.force))
        while True:
            if load is not None and not given.all():
                rest = load - float(force[given].sum())
                force *= np.where(given, 1.0, rest / float(force[~given].sum()))
            above = ~given & (force - free > self.bound)
            if not above.any():
                return (force / s.k1).reshape(state.u.shape)
            force[above] = free[above] + self.bound
            given |= above

    def solve(self, stage: Stage, guess: LocalState, allowed_error: float) -> tuple[LocalState, int]:
        """See `LocalCreepSolver`."""
        end, cycles = self.under(stage, guess, allowed_error)
        if self.bound == math.inf:
            return end, cycles
        yielding = np.zeros(self.heights.shape, dtype=bool)
        for _ in range(_MOST_REVISIONS):
            u = np.atleast_2d(end.u)
            force = self.springs.k0 * self.laplacian(u) + np.atleast_2d(end.force)
            found = np.where(yielding, u < self.heights, (u <= self.heights) & (force > self.bound))
            if (found == yielding).all():
                return end, cycles
            yielding = found
            end, more = self.under(replace(stage, yielding=yielding), end, allowed_error)
            cycles += more
        raise ConvergenceError(
            f"creep: {_MOST_REVISIONS} revisions of the sites that yield did not settle them; "
            "try a larger rtol"
        )

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # what is not finite does not converge
    def under(self, stage: Stage, guess: LocalState, allowed_error: float) -> tuple[LocalState, int]:
        """Solve a step whose yielding sites are known."""
        run = _Run(self, stage, guess)
        size, change = math.inf, math.inf
        for cycle in range(_MOST_CYCLES):
            change, size = run.cycle(), change
            if not math.isfinite(change):
                break
            rate = min(max(change / size, 0.1), 0.9) if cycle else _USUAL_RATE
            if run.missing is not None and run.contacts == 0:
                continue  # something must carry the load
            rounding = _ROUNDING * run.largest
            balanced = run.missing is None or rate * abs(run.missing) <= _FORCE_ERROR * abs(run.total)
            if rate * change <= max(allowed_error, rounding) and balanced:
                u, w = (field.reshape(self.shape) for field in (run.u, run.w))
                return LocalState(u, self.springs.k1 * w, run.position), cycle + 1
        raise ConvergenceError(
            f"creep: a step of {stage.tau:.1e} changes by {change:.1e} after {_MOST_CYCLES} cycles, expected "
            f"{allowed_error:.1e}; try a larger rtol"
        )

    def damped(self, error: Field, stage: Stage, end: LocalState) -> Field:
        """See `LocalCreepSolver`."""
        run = _Run(self, stage, end)
        return run.damped(np.atleast_2d(error)).reshape(error.shape)


class _Run:
    """One step being solved."""

    def __init__(self, solver: LatticeCreep, stage: Stage, guess: LocalState) -> None:
        self.solver, self.stage, self.springs = solver, stage, solver.springs
        self.heights = solver.heights
        self.given: Any = None
        if stage.yielding is not None:
            self.heights = np.where(stage.yielding, -np.inf, solver.heights)
            self.given = stage.yielding * (solver.bound / self.springs.k1)
        self.u = np.maximum(np.atleast_2d(guess.u), self.heights)
        self.w = np.atleast_2d(guess.force) / self.springs.k1
        self.before = np.atleast_2d(stage.before)
        self.position = stage.position if stage.load is None else guess.position
        k1, tau = self.springs.k1, stage.tau
        self.spread, self.drag = tau * k1 * self.springs.R, tau * k1 * self.springs.R_viscous
        self.bonds = self.spread * (4.0 if solver.heights.shape[0] > 1 else 2.0)
        self.total, self.contacts, self.own_answer = float(self.w.sum()), 0, 0.0
        self.missing: float | None = None
        self.largest = max(largest(field, np) for field in (self.u, self.w, self.before))
        self.find_stretch()

    def evaluate(self) -> None:
        """Velocities and their derivatives at the present stretches, times the duration."""
        value, slope = self.solver.law.velocity(self.springs.k1 * self.w)
        self.value, self.slope = self.stage.tau * value, (self.stage.tau * self.springs.k1) * slope

    def flow(self) -> Field:
        """What the equation of creep lacks."""
        lacking = self.u - self.before
        lacking -= self.position + self.value
        lacking -= (1.0 + self.drag) * self.w
        if self.spread > 0:
            lacking -= self.spread * self.solver.laplacian(self.w)
        return lacking

    def cycle(self) -> float:
        """One cycle; how much the creeping shape changed, rms over the sites."""
        solver = self.solver
        b = self.w + float(solver.kappa) * solver.laplacian(self.u)
        np.negative(b, out=b)
        if self.given is not None:
            b += self.given
        if self.stage.load is not None:
            self.total = self.stage.load / self.springs.k1
            self.missing = self.total - float(self.w.sum())
        e, f, shift = self.correction(b, self.flow(), self.heights - self.u, self.missing)
        u = self.u + e
        np.copyto(u, self.heights, where=self.touching)
        np.maximum(u, self.heights, out=u)
        before = self.w
        self.u, self.w, self.position = u, before + f, self.position - shift
        self.find_stretch()
        change = e
        change -= self.w - before
        change += shift
        return float(np.sqrt(np.mean(change * change)))

    def correction(
        self, b: Field, c: Field, least: Field, missing: float | None, *, unit: float = 0.0
    ) -> tuple[Field, Field, float]:
        """Corrections of u and w and the shift: one multigrid cycle on the linearized equations."""
        solver, single = self.solver, np.float32
        unit = unit or max(largest(b, np), largest(c, np)) or 1.0
        lag = np.minimum(self.slope + (1.0 + self.drag), _LARGEST_LAG).astype(single)
        inverse = single(1.0) / (lag + solver.bond_count * single(self.spread))
        yielding = single(1.0) / (solver.bond_count * solver.kappa + inverse)
        weight = single(1.0 + self.drag + self.bonds) * inverse
        bound = (least / unit).astype(single)
        sources = [(field / unit).astype(single) for field in (b, c)]
        e, f = solver.pair
        for field in (e, f):
            field.fill(0.0)
        numbers = (solver.kappa, single(self.spread))
        relaxed: tuple[Any, ...] = (e, f, bound, *sources, inverse, yielding, *solver.bonds, *numbers)
        loops.relax(*(*relaxed, single(0.0), False))
        # A contact that its neighbors' stretches do not reach answers a shift on its own.
        touching = e <= bound
        reached = solver.bond_count * single(self.spread) * inverse
        weight = np.where(touching, weight * reached, weight)
        self.own_answer = float(np.sum((1 - reached) * inverse, where=touching, dtype=float))
        first = solver.grids[0]
        weighted: tuple[Any, ...] = (e, f, bound, *sources, lag, weight, *solver.bonds, *numbers)
        loops.restrict(*(*weighted, single(0.0), first.equations, solver.sums))
        total, contacts = solver.sums.tolist()
        shift = self.on_grid(0, None if missing is None else missing / unit - total)
        loops.correct(e, f, bound, weight, first.e, first.f)
        loops.relax(*(*relaxed, single(shift), True))
        self.contacts = int(contacts)
        self.touching = e <= bound
        return unit * e.astype(float), unit * f.astype(float), unit * shift

    def on_grid(self, level: int, missing: float | None) -> float:
        """One cycle from a coarse grid up; the shift."""
        grid = self.solver.grids[level]
        if level == len(self.solver.grids) - 1:
            return _solved(grid, missing, self.own_answer)
        grid.e.fill(0.0)
        grid.f.fill(0.0)
        coarser = self.solver.grids[level + 1]
        loops.relax_coarse(grid.e, grid.f, grid.equations, np.float32(0.0), False)
        if missing is not None:
            missing -= float((grid.equations[4] * grid.f).sum(dtype=float))
        loops.restrict_coarse(grid.e, grid.f, grid.equations, coarser.equations)
        shift = self.on_grid(level + 1, missing)
        loops.correct_coarse(grid.e, grid.f, grid.equations[3], coarser.e, coarser.f)
        loops.relax_coarse(grid.e, grid.f, grid.equations, np.float32(shift), True)
        return shift

    def find_stretch(self) -> None:
        """The stretch of each site for its surface, the stretches of its neighbors as they are."""
        self.evaluate()
        lacking, own = self.flow(), 1.0 + self.drag + self.bonds
        change = lacking / (own + self.slope)
        k1, tau, law = self.springs.k1, self.stage.tau, self.solver.law
        bent = np.flatnonzero(~(k1 * np.abs(change) <= _SOLVED * law.bend(k1 * self.w)))
        found = self.w + change
        self.value += self.slope * change
        if bent.size:
            wanted = (lacking + own * self.w + self.value - self.slope * change).flat[bent]
            at = stretches_of(law, own, tau, k1, wanted, found.flat[bent])
            found.flat[bent] = at
            value, slope = law.velocity(k1 * at)
            self.value.flat[bent], self.slope.flat[bent] = tau * value, tau * k1 * slope
        self.w = found

    def damped(self, error: Field) -> Field:
        """An error of the creeping shape after an implicit step, the contacts staying what they are."""
        scale = largest(error, np)
        if not 0 < scale < math.inf:
            return error
        free = self.u > self.heights
        missing = None if self.stage.load is None else 0.0
        least, pressed = np.where(free, -np.inf, 0.0), np.where(free, 0.0, -_HEAVY)
        e, f, shift = self.correction(pressed, error / -scale, least, missing, unit=1.0)
        left: Field = e - f
        left += shift
        left *= scale
        return left


def _solved(grid: _Grid, missing: float | None, own_answer: float) -> float:
    """Solve on the coarsest grid; the shift."""
    n = grid.e.size
    matrix, sides = np.zeros((2 * n + 1, 2 * n + 1)), np.zeros(2 * n + 1)
    faint = 0.0 if grid.equations[0].any() else _FAINT  # without contacts the matrix is singular
    loops.assemble(grid.equations, faint, missing is not None, matrix, sides)
    if missing is not None:
        matrix[-1, -1], sides[-1] = own_answer, missing
    try:
        found = np.linalg.solve(matrix, sides)
    except np.linalg.LinAlgError:  # singular by rounding: no cycle converges
        found = np.full(2 * n + 1, np.nan)
    grid.e[...], grid.f[...] = found[:n].reshape(grid.e.shape), found[n:-1].reshape(grid.e.shape)
    return float(found[-1])
