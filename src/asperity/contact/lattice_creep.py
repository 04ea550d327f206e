r"""Implicit steps of creep on the lattice of springs whose creep is local and not linear.

    k0 L u + k1 w = r,    0 <= r  perpendicular to  u - xi >= 0
    w + tau k1 R L w + tau v(k1 w) = u - X - v0

v0 is the creeping shape before the step and X the rigid body, which is prescribed, or the sum of k1 w is.
Both sides are monotone, so the step is a convex problem with one solution. Each cycle linearizes the law
at the present stretches, corrects u and w by one cycle of `asperity.contact.multigrid.two_fields` with the
slope of the law as a drag by site, and then finds the stretch of each site for its u, which no law
overflows: the local equation has one root, which is bracketed. (Newton's method, with contacts that are
found while relaxing: C. Graeser, R. Kornhuber, J. Comput. Math. 27, 1 (2009).)
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from asperity.contact.arrays import largest
from asperity.contact.local_creep import LocalState, Stage, stretches_of
from asperity.contact.multigrid.loops import Sites, Surface
from asperity.contact.multigrid.processor import Processor
from asperity.contact.multigrid.two_fields import TwoFields
from asperity.contact.problem import SpringStep
from asperity.contact.stencils import balanced, lattice_force, newton_steps
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice
from asperity.solids import SpringConstants
from asperity.solids.creep_laws import LocalCreep

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

_LARGEST_LAG = 1e30
"""Largest coefficient in single precision."""

_SOFTEST = 1e-6
"""Least k0/k1 in the correction, which need not be exact."""


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
        self.springs, self.law, self.bound = springs, law, bound
        self.shape, self.mirrored = heights.shape, lattice.reflecting
        self.heights = np.ascontiguousarray(np.atleast_2d(heights))
        rows, columns = self.heights.shape
        self.work = TwoFields(Sites(rows, columns, self.mirrored), Processor())

    def laplacian(self, x: Field) -> Field:
        """Minus the Laplacian."""
        return lattice_force(x, x, 1.0, 0.0, mirrored=self.mirrored)

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
        u, w = (np.ascontiguousarray(np.atleast_2d(field)) for field in (state.u, self.stretch(state.force)))
        total = None if load is None else load / self.springs.k1
        k0, k1 = self.springs.k0, self.springs.k1
        if self.bound == math.inf:
            return balanced(u, w, self.heights, k0, k1, total, mirrored=self.mirrored).reshape(state.u.shape)
        given = u > self.heights
        free = -k0 / k1 * self.laplacian(u)
        w = np.where(given, free, w)
        while True:
            if total is not None and not given.all():
                rest = total - float(w[given].sum())
                w *= np.where(given, 1.0, rest / float(w[~given].sum()))
            above = ~given & (w - free > self.bound / k1)
            if not above.any():
                return w.reshape(state.u.shape)
            w[above] = free[above] + self.bound / k1
            given |= above

    def solve(self, stage: Stage, guess: LocalState, allowed_error: float) -> tuple[LocalState, int]:
        """See `LocalCreepSolver`."""
        end, cycles = self.under(stage, guess, allowed_error)
        if self.bound == math.inf:
            return end, cycles
        yielding = np.zeros(self.heights.shape, dtype=bool)
        for _ in range(_MOST_REVISIONS):
            u = np.ascontiguousarray(np.atleast_2d(end.u))
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
        run = self.run = _Run(self, stage, guess)
        size, change = math.inf, math.inf
        for cycle in range(_MOST_CYCLES):
            change, size = run.cycle(), change
            if not math.isfinite(change):
                break
            rate = min(max(change / size, 0.1), 0.9) if cycle and size > 0 else _USUAL_RATE
            if run.missing is not None and run.contacts == 0:
                continue  # something must carry the load
            rounding = _ROUNDING * run.largest
            carried = run.missing is None or rate * abs(run.missing) <= _FORCE_ERROR * abs(run.total)
            if rate * change <= max(allowed_error, rounding) and carried:
                u, w = (field.reshape(self.shape) for field in (run.u, run.w))
                return LocalState(u, self.springs.k1 * w, run.position), cycle + 1
        raise ConvergenceError(
            f"creep: a step of {stage.tau:.1e} changes by {change:.1e} after {_MOST_CYCLES} cycles, expected "
            f"{allowed_error:.1e}; try a larger rtol"
        )

    def damped(self, error: Field, stage: Stage, end: LocalState) -> Field:
        """See `LocalCreepSolver`; the step must be the last that was solved."""
        del end
        assert stage.tau == self.run.stage.tau
        return self.run.damped(np.atleast_2d(error)).reshape(error.shape)


class _Run:
    """One step being solved."""

    def __init__(self, solver: LatticeCreep, stage: Stage, guess: LocalState) -> None:
        self.solver, self.stage, self.springs = solver, stage, solver.springs
        self.heights = solver.heights
        self.given: Any = None
        if stage.yielding is not None:
            self.heights = np.where(stage.yielding, -np.inf, solver.heights)
            self.given = stage.yielding * solver.bound
        self.u = np.maximum(np.atleast_2d(guess.u), self.heights)
        self.w = np.atleast_2d(guess.force) / self.springs.k1
        self.before = np.atleast_2d(stage.before)
        self.position = float(stage.position if stage.load is None else guess.position)
        k1, tau = self.springs.k1, stage.tau
        self.spread, self.drag = tau * k1 * self.springs.R, tau * k1 * self.springs.R_viscous
        self.total, self.contacts = float(self.w.sum()), 0
        self.missing: float | None = None
        self.largest = max(largest(field, np) for field in (self.u, self.w, self.before))
        self.unit, self.asked, self.answer, self.prepared = self.largest or 1.0, 0.0, 1.0, False
        self.find_stretch()

    def linearize(self) -> None:
        """Give multigrid the equations, linear in the law, for corrections to the fields as they are."""
        solver, springs, work = self.solver, self.springs, self.solver.work
        k0 = max(springs.k0, _SOFTEST * springs.k1)
        drag = np.minimum(self.slope + self.drag, _LARGEST_LAG)
        if self.prepared:
            work.set_drag(drag)
        else:
            work.prepare(springs.k1 / k0, self.spread, drag)
        self.prepared = True
        anchors = self.before + self.value
        anchors += self.position
        step = SpringStep(k0, springs.k1, self.spread, self.drag, False, anchors, None, solver.mirrored)
        work.measure(step, Surface(self.u, self.w, self.heights), self.unit)
        if springs.k0 == 0:
            work.source.e[...] = work.backend.packed(self.w * (-springs.k1 / k0 / self.unit))
        if self.given is not None:
            work.source.e[...] += work.backend.packed(self.given / (k0 * self.unit))
        if self.stage.load is not None:
            self.total = self.stage.load / springs.k1
            self.missing = self.total - work.known_stretch * self.unit
            work.wanted = self.missing / self.unit

    def cycle(self) -> float:
        """One cycle; how much the creeping shape changed, rms over the sites."""
        work, before = self.solver.work, self.u - self.w
        self.linearize()
        found = work.descend(correcting=False)
        missing, _ = work.judge(found)
        if self.asked:
            self.answer *= min(max((self.asked - missing) / self.asked, 0.5), 2.0)
        self.asked = missing
        work.find_correction(found.contacts, missing / self.answer, 0, math.inf)
        work.descend(correcting=True, restricting=False)
        work.settle(Surface(self.u, self.w, self.heights), self.unit)
        shift = work.shift * self.unit
        self.position -= shift
        self.contacts = work.backend.touching(work.correction.e, work.bound)
        self.contacts += 0 if self.given is None else int(np.count_nonzero(self.given))
        self.find_stretch()
        before -= self.u
        before += self.w
        before -= shift
        return float(np.sqrt(np.mean(before * before)))

    def find_stretch(self) -> None:
        """The stretch of each site for its surface, the stretches of its neighbors as they are."""
        k1, tau, law, w = self.springs.k1, self.stage.tau, self.solver.law, self.w
        value, slope = law.velocity(k1 * w)
        value *= tau
        slope *= tau * k1
        own, solved = 1.0 + self.drag + 4.0 * self.spread, np.empty_like(w)
        solved[...] = _SOLVED / k1 * law.bend(k1 * w)
        found, wanted, bent = np.empty_like(w), np.empty_like(w), np.empty(w.shape, bool)
        fields, numbers = (self.u, self.before, w, value, slope), (self.position, own, self.spread)
        newton_steps(*fields, *numbers, solved, found, wanted, bent, self.solver.mirrored)
        if bent.any():
            exact = stretches_of(law, own, tau, k1, wanted[bent], found[bent])
            found[bent] = exact
            velocity, rise = law.velocity(k1 * exact)
            value[bent], slope[bent] = tau * velocity, tau * k1 * rise
        self.w, self.value, self.slope = found, value, slope

    def damped(self, error: Field) -> Field:
        """An error of the creeping shape after an implicit step, the contacts staying what they are."""
        scale = largest(error, np)
        if not 0 < scale < math.inf:
            return error
        work = self.solver.work  # with the law as it was linearized in the last cycle
        work.shift = 0.0
        for field in work.correction:
            field.fill(0.0)
        free = self.u > self.heights
        packed = work.backend.packed
        work.bound[...] = packed(np.where(free, -np.inf, 0.0))
        work.source.e[...] = packed(np.where(free, 0.0, -_HEAVY))
        work.source.f[...] = packed(error / -scale)
        if work.wanted is not None:
            work.wanted = 0.0
        found = work.descend(correcting=False)
        missing, _ = work.judge(found)
        work.find_correction(found.contacts, missing / self.answer, 0, math.inf)
        work.descend(correcting=True, restricting=False)
        e, f = (work.backend.unpacked(field, work.sites) for field in work.correction)
        left: Field = e - f
        left += work.shift
        left *= scale
        return left
