r"""Implicit steps of creep on the lattice of springs whose creep is local and not linear.

    k0 L u + k1 w = r,    0 <= r  perpendicular to  u - xi >= 0
    w + tau k1 R L w + tau v(k1 w) = u - X - v0

v0 is the creeping shape before the step and X the rigid body, which is prescribed, or the sum of k1 w is.
Both sides are monotone, so the step is a convex problem with one solution. A stage linearizes the law at its
guess and solves the linear step by the cycles of `asperity.contact.multigrid.two_fields`, with the slope of
the law as a drag by site. Where the tangent errs too much, the stretch of a site is found for its u, which no
law overflows: the local equation has one root, which is bracketed. (Newton's method, with contacts that are
found while relaxing: C. Graeser, R. Kornhuber, J. Comput. Math. 27, 1 (2009).)
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from asperity.contact.arrays import inner, largest
from asperity.contact.local_creep import LocalState, Stage, stretches_of
from asperity.contact.multigrid.loops import Sites, Springs, Surface
from asperity.contact.multigrid.processor import Processor
from asperity.contact.multigrid.two_fields import ByLaw, Tangent, TwoFields
from asperity.contact.stencils import balanced, lattice_force
from asperity.creep import LocalCreep
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice
from asperity.solids import SpringConstants

_UNNOTICED = 0.3
"""Error of the tangent of the law, in units of the error allowed, which need not be made up for."""

_MOST_REVISIONS = 40
"""Revisions of the set of sites that yield after which a step is given up."""

_MOST_CYCLES = 60
"""Cycles after which a step is given up."""

_DAMPED = 0.3
"""Error allowed where an error is damped, in units of it."""

_ROUNDING = 16 * float(np.finfo(float).eps)
"""Change of the creeping shape that rounding makes, in units of the largest length."""

_HEAVY = 1e20
"""Force that keeps contacts closed."""

_LARGEST_LAG = 1e30
"""Largest coefficient in single precision."""

_SOFTEST = 1e-6
"""Least k0/k1 in the correction, which need not be exact."""

_KEPT_BYTES = 31 * 2**20
"""Size of a block that is freed at once: from then on glibc keeps freed blocks up to this size (32 MB are the
most), where it gave them back to the system and got them anew, page by page, in every step."""


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
        np.empty(_KEPT_BYTES, np.uint8)

    def stretch(self, force: Field) -> Field:
        """See `LocalCreepSolver`."""
        return force / self.springs.k1

    def indented(self, force: Field) -> float:
        """See `LocalCreepSolver`."""
        return largest(force, np) / self.springs.k1

    def velocity(self, force: Field) -> Field:
        """See `LocalCreepSolver`."""
        s = self.springs
        rate = self.law.velocity(force)[0]
        if s.R > 0:
            rate += s.R * _laplacian(np.atleast_2d(force), self.mirrored).reshape(force.shape)
        if s.R_viscous > 0:
            rate += s.R_viscous * force
        return rate

    def balanced(self, state: LocalState, load: float | None) -> Field:
        """See `LocalCreepSolver`."""
        u, w = (np.ascontiguousarray(np.atleast_2d(field)) for field in (state.u, self.stretch(state.force)))
        k0, k1 = self.springs.k0, self.springs.k1
        total, largest = None if load is None else load / k1, self.bound / k1
        found = balanced(u, w, self.heights, k0, k1, total, mirrored=self.mirrored, largest=largest)
        return found.reshape(state.u.shape)

    def solve(self, stage: Stage, guess: LocalState, allowed_error: float) -> tuple[LocalState, int]:
        """See `LocalCreepSolver`."""
        end, cycles = self.under(stage, guess, allowed_error)
        if self.bound == math.inf:
            return end, cycles
        yielding = np.zeros(self.heights.shape, dtype=bool)
        for _ in range(_MOST_REVISIONS):
            u = np.ascontiguousarray(np.atleast_2d(end.u))
            force = self.springs.k0 * _laplacian(u, self.mirrored) + np.atleast_2d(end.force)
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
        run = self.run = _Run(self, stage, guess, allowed_error)
        cycles, done, left = 0, True, math.inf
        while done and cycles < _MOST_CYCLES:
            done, more, left = run.improve(_MOST_CYCLES - cycles)
            cycles += more
            if done and left <= run.allowed:
                u, w = (field.reshape(self.shape) for field in (run.u, run.w))
                return LocalState(u, self.springs.k1 * w, run.position), cycles
        raise ConvergenceError(
            f"creep: a step of {stage.tau:.1e} changes by {left:.1e} after {cycles} cycles, expected "
            f"{allowed_error:.1e}; try a larger rtol"
        )

    def damped(self, error: Field, stage: Stage, end: LocalState) -> Field:
        """See `LocalCreepSolver`; the step must be the last that was solved."""
        del end
        assert stage.tau == self.run.stage.tau
        return self.run.damped(np.atleast_2d(error)).reshape(error.shape)


def _laplacian(x: Field, mirrored: bool) -> Field:
    """Minus the Laplacian."""
    return lattice_force(x, x, 1.0, 0.0, mirrored=mirrored)


class _Run:
    """One step being solved."""

    def __init__(self, solver: LatticeCreep, stage: Stage, guess: LocalState, allowed_error: float) -> None:
        self.law, self.work, self.mirrored = solver.law, solver.work, solver.mirrored
        self.stage, springs = stage, solver.springs
        self.heights = solver.heights
        self.given: Any = None
        if stage.yielding is not None:
            self.heights = np.where(stage.yielding, -np.inf, solver.heights)
            self.given = stage.yielding * solver.bound
        self.u = np.maximum(np.atleast_2d(guess.u), self.heights)
        self.w = np.atleast_2d(guess.force) / springs.k1
        self.before = np.atleast_2d(stage.before)
        self.position = float(stage.position if stage.load is None else guess.position)
        k1, tau = springs.k1, stage.tau
        self.springs = Springs(springs.k0, k1, tau * k1 * springs.R, tau * k1 * springs.R_viscous)
        self.largest = max(largest(field, np) for field in (self.u, self.w, self.before))
        self.unit = self.largest or 1.0
        self.stiffness = max(springs.k0, _SOFTEST * k1)
        self.allowed = max(allowed_error, _ROUNDING * self.largest)
        solver.work.yielding = 0 if self.given is None else int(np.count_nonzero(self.given))
        if not stage.again:
            solver.work.prepare(k1 / self.stiffness, self.springs.spread, self.springs.drag)
        self.measure()

    def measure(self) -> float:
        """Linearize the law at the stretches as they are; rms change that sites would make alone."""
        work, stage, springs, unit = self.work, self.stage, self.springs, self.unit
        force = springs.k1 * self.w
        self.velocity, self.derivative = self.law.velocity(force)
        law = ByLaw(self.before, self.velocity, self.derivative, self.position, stage.tau, _LARGEST_LAG)
        bend: Any = self.law.bend(force) / springs.k1
        self.tangent = Tangent(1.0 + springs.drag, 4.0 * springs.spread, bend)
        scales, surface = (self.stiffness * unit, unit), Surface(self.u, self.w, self.heights)
        total = None if stage.load is None else stage.load / springs.k1
        change, left = work.measure_law(surface, law, springs, self.tangent, scales, total)
        self.straight = left <= _UNNOTICED * self.allowed
        if self.given is not None:
            work.source.e[...] += work.backend.packed(self.given / scales[0])
        return change

    def follow_law(self) -> None:
        """Where the tangent does not do, find the stretch of a site alone by the law; and linearize anew."""
        (lagging, beside, bend), springs, tau = self.tangent, self.springs, self.stage.tau
        own, rise = lagging + beside, tau * springs.k1 * self.derivative
        wanted = self.u - self.before - self.position
        if beside:
            wanted += beside * self.w - springs.spread * _laplacian(self.w, self.mirrored)
        change = (wanted - own * self.w - tau * self.velocity) / (own + rise)
        bent = ~(rise * change * change <= _UNNOTICED * self.allowed * bend * (own + rise))
        start = np.nan_to_num(self.w[bent] + change[bent])
        self.w[bent] = stretches_of(self.law, own, tau, springs.k1, wanted[bent], start)
        self.measure()

    def improve(self, most: int) -> tuple[bool, int, float]:
        """Solve the linear step; whether that was possible, the cycles taken, and the error left."""
        work = self.work
        if not self.straight:
            self.follow_law()
        work.relag()
        done, cycles = work.improve(self.allowed / self.unit, most)
        left = work.settle_law(Surface(self.u, self.w, self.heights), self.tangent, self.unit)
        self.position -= work.shift * self.unit
        if not (self.law.smooth and left <= _UNNOTICED * self.allowed):
            left = self.measure()
        return done, cycles, left

    def damped(self, error: Field) -> Field:
        """An error of the creeping shape after an implicit step, the contacts staying what they are."""
        scale = float(np.sqrt(inner(error, error, np) / error.size))
        if not 0 < scale < math.inf:
            return error
        work = self.work  # with the law as it was linearized last
        touching = work.correction.e <= work.bound
        work.bound[...] = np.where(touching, np.float32(0.0), np.float32(-np.inf))
        work.source.e.fill(0.0)
        work.source.e[touching] = -_HEAVY
        work.source.f[...] = work.backend.packed(error / -scale)
        if work.wanted is not None:
            work.wanted = 0.0
        work.shift = 0.0
        for field in work.correction:
            field.fill(0.0)
        if not work.improve(_DAMPED, _MOST_CYCLES, total_counts=False)[0]:
            return error
        e, f = work.correction
        left = work.backend.unpacked(e - f, work.sites)
        left += work.shift
        left *= scale
        return left
