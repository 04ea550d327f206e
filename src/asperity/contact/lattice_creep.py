r"""Implicit steps of creep on the lattice of springs whose creep is local and not linear.

    k0 L u + k1 w = r,    0 <= r  perpendicular to  u - xi >= 0
    w + tau k1 R L w + tau v(k1 w) = u - X - v0

v0 is the creeping shape before the step and X the rigid body, which is prescribed, or the sum of k1 w is.
Both sides are monotone, so the step is a convex problem with one solution. Steps that are linear about a
state are those of the cycles of `asperity.contact.multigrid.two_fields`, with the slope of the law as a
drag by site; the cycles find the contacts too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.contact.arrays import inner, largest
from asperity.contact.interface import RIGID, Interface
from asperity.contact.local_creep import ROUNDING, ByLaw, LinearLaw, LocalRun, LocalState, Stage
from asperity.contact.multigrid import two_fields
from asperity.contact.multigrid.loops import Sites, Springs, Surface
from asperity.contact.multigrid.processor import Processor
from asperity.contact.multigrid.two_fields import ByLaw as LawByRows
from asperity.contact.multigrid.two_fields import Tangent, TwoFields
from asperity.contact.stencils import balanced, lattice_force
from asperity.creep import LocalCreep
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice
from asperity.solids import SpringConstants


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    most_cycles: int = 60
    """Cycles on one linear step after which a step is given up."""

    damped: float = 0.3
    """How well what a step leaves of an error is known, in units of that error."""


TUNING = Tuning()

_LARGEST_LAG = float(np.finfo(np.float32).max) * float(np.finfo(np.float32).eps)
"""Sums of lags up to it stay in the range of single precision."""


class LatticeCreep(ByLaw):
    """Steps on one lattice."""

    def __init__(
        self,
        springs: SpringConstants,
        law: LocalCreep,
        lattice: Lattice,
        heights: Field,
        interface: Interface = RIGID,
    ) -> None:
        self.springs, self.law, self.interface = springs, law, interface
        self.shape, self.mirrored = heights.shape, lattice.reflecting
        self.heights = np.ascontiguousarray(np.atleast_2d(heights))
        rows, columns = self.heights.shape
        self.work = TwoFields(Sites(rows, columns, self.mirrored), Processor())

    def stretch(self, force: Field) -> Field:
        """See `ByLaw`."""
        return force / self.springs.k1

    def indented(self, force: Field) -> float:
        """See `ByLaw`."""
        return largest(force, np) / self.springs.k1

    def velocity(self, force: Field) -> Field:
        """See `ByLaw`."""
        s = self.springs
        rate = self.law.velocity(force)[0]
        if s.R > 0:
            rate += s.R * self.laplacian(np.atleast_2d(force)).reshape(force.shape)
        if s.R_viscous > 0:
            rate += s.R_viscous * force
        return rate

    def balanced(self, state: LocalState, load: float | None) -> Field:
        """See `ByLaw`."""
        u, w = (np.ascontiguousarray(np.atleast_2d(field)) for field in (state.u, self.stretch(state.force)))
        k0, k1 = self.springs.k0, self.springs.k1
        total, largest = None if load is None else load / k1, self.interface.high / k1
        found = balanced(u, w, self.heights, k0, k1, total, mirrored=self.mirrored, largest=largest)
        return found.reshape(state.u.shape)

    def begin(self, stage: Stage, guess: LocalState) -> _Run:
        """See `ByLaw`."""
        self.run = _Run(self, stage, guess)
        return self.run

    def damped(self, error: Field, stage: Stage, end: LocalState) -> Field:
        """See `ByLaw`."""
        del end
        assert stage.tau == self.run.stage.tau
        return self.run.damped(np.atleast_2d(error)).reshape(error.shape)

    def laplacian(self, x: Field) -> Field:
        """Minus the Laplacian."""
        return lattice_force(x, x, 1.0, 0.0, mirrored=self.mirrored)


class _Run(LocalRun):
    """One step being solved."""

    def __init__(self, solver: LatticeCreep, stage: Stage, guess: LocalState) -> None:
        self.solver, self.stage, self.work, springs = solver, stage, solver.work, solver.springs
        self.before = np.atleast_2d(stage.before)
        self.u, self.w = np.array(np.atleast_2d(guess.u)), np.atleast_2d(guess.force) / springs.k1
        np.maximum(self.u, solver.heights, out=self.u)
        self.heights, self.yielding = solver.heights, np.zeros(self.u.shape, dtype=bool)
        self.position = float(stage.position if stage.load is None else guess.position)
        k1, tau = springs.k1, stage.tau
        self.springs = Springs(springs.k0, k1, tau * k1 * springs.R, tau * k1 * springs.R_viscous)
        size = max(largest(field, np) for field in (self.u, self.w, self.before))
        self.unit, self.rounding = size or 1.0, ROUNDING * size
        self.stiffness = max(springs.k0, two_fields.TUNING.softest * k1)
        self.lagging, self.beside = 1.0 + self.springs.drag, 4.0 * self.springs.spread
        if not stage.again:
            self.work.prepare(k1 / self.stiffness, self.springs.spread, self.springs.drag)

    def measure(self) -> float:
        """See `LocalRun`."""
        wrong = self.revise() if self.solver.interface.yields else 0.0
        left, self.curved = self.linearize()
        return math.hypot(left, wrong, 0.0 if self.stage.load is None else self.even())

    def even(self) -> float:
        """What all sites lack by the same under a load, which the changes of sites alone do not tell."""
        work, unit = self.work, self.unit
        assert work.wanted is not None
        force = abs(work.wanted) / self.u.size
        if force <= work.force_error * work.known_stretch / self.u.size:
            force = 0.0
        taken = self.springs.drag * self.w + self.law.creep
        return math.hypot(unit * force, float(np.mean(self.u - self.w - self.before - taken)) - self.position)

    def linearize(self) -> tuple[float, float]:
        """Begin a correction to the stretches; rms changes that sites would make alone; what tangents err."""
        work, stage, springs, unit = self.work, self.stage, self.springs, self.unit
        self.law = LinearLaw(self.solver.law, stage.tau, 1.0, springs.k1 * self.w)
        at_sites = self.before, self.law.velocity, self.law.slope
        law = LawByRows(*at_sites, self.position, stage.tau, _LARGEST_LAG)
        bend: Any = self.solver.law.bend(self.law.force) / springs.k1
        tangent = Tangent(self.lagging, self.beside, bend)
        scales, surface = (self.stiffness * unit, unit), Surface(self.u, self.w, self.heights)
        total = None if stage.load is None else stage.load / springs.k1
        found = work.measure_law(surface, law, springs, tangent, scales, total)
        work.yielding = int(np.count_nonzero(self.yielding))
        if work.yielding:
            given = self.yielding * (self.solver.interface.high / scales[0])
            work.source.e[...] += work.backend.packed(given)
        return found

    def follow_law(self, noticed: float) -> None:
        """Where the tangent does not do, find the stretch of a site alone by the law."""
        springs, law = self.springs, self.law
        own = (self.lagging + self.beside) / springs.k1
        wanted = self.u - self.before - self.position
        if self.beside:
            wanted += self.beside * self.w - springs.spread * self.solver.laplacian(self.w)
        change = (wanted - own * law.force - law.creep) / (own + law.drag)
        bent = law.bent(own, change, noticed)
        self.w[bent] = law.found(own, change, bent) / springs.k1
        self.linearize()

    def revise(self) -> float:
        """Revise which sites yield; how far those that change are from where they are to be, rms."""
        solver, high, springs = self.solver, self.solver.interface.high, self.springs
        excess = springs.k0 * solver.laplacian(self.u) + springs.k1 * self.w - high
        gap = self.u - solver.heights
        beyond, back = ~self.yielding & (gap <= 0) & (excess > 0), self.yielding & (gap > 0)
        far = np.where(beyond, excess / (4 * springs.k0 + springs.k1), np.where(back, gap, 0.0))
        self.yielding ^= beyond | back
        self.heights = np.where(self.yielding, -np.inf, solver.heights)
        self.u[back] = solver.heights[back]  # the surface has come back to it
        np.maximum(self.u, self.heights, out=self.u)
        return math.sqrt(inner(far, far, np) / far.size)

    def improve(self, allowed: float, noticed: float) -> int:
        """See `LocalRun`."""
        if self.curved > noticed:
            self.follow_law(noticed)
        work = self.work
        work.relag()
        done, cycles = work.improve(allowed / self.unit, TUNING.most_cycles)
        if not done:
            raise ConvergenceError(f"creep: {cycles} cycles did not solve a linear step; try a larger rtol")
        surface = Surface(self.u, self.w, self.heights)
        work.backend.settle(surface, work.correction, work.bound, self.unit, 0.0)
        self.position -= work.shift * self.unit
        return cycles

    def state(self) -> LocalState:
        """See `LocalRun`."""
        shape = self.solver.shape
        return LocalState(self.u.reshape(shape), (self.springs.k1 * self.w).reshape(shape), self.position)

    def damped(self, error: Field) -> Field:
        """An error of the creeping shape after an implicit step, the contacts staying what they are."""
        scale = float(np.sqrt(inner(error, error, np) / error.size))
        if not 0 < scale < math.inf:
            return error
        work = self.work  # with the law as it was linearized last
        work.hold(work.correction.e <= work.bound, error / scale)
        if work.wanted is not None:
            work.wanted = 0.0
        work.shift = 0.0
        if not work.improve(TUNING.damped, TUNING.most_cycles, total_counts=False)[0]:
            return error
        e, f = work.correction
        left = work.backend.unpacked(e - f, work.sites)
        left += work.shift
        left *= scale
        return left
