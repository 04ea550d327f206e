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

import numpy as np

from asperity.contact import local_creep
from asperity.contact.arrays import inner, largest
from asperity.contact.interface import RIGID, Interface
from asperity.contact.local_creep import ByLaw, LinearLaw, LocalRun, LocalState, Stage
from asperity.contact.mechanics import balanced
from asperity.contact.multigrid import operations
from asperity.contact.multigrid.loops import Measured, Scales, Sites, Surface
from asperity.contact.multigrid.two_fields import TwoFields, working_stiffness
from asperity.contact.stencils import lattice_force, tangents
from asperity.creep import LocalCreep
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice
from asperity.solids import Springs


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    most_cycles: int = 60
    """Cycles on one linear step after which a step is given up."""


TUNING = Tuning()

_LARGEST_LAG = float(np.finfo(np.float32).max) * float(np.finfo(np.float32).eps)
"""Sums of lags up to it stay in the range of single precision."""


class LatticeCreep(ByLaw):
    """Steps on one lattice."""

    def __init__(
        self,
        springs: Springs,
        law: LocalCreep,
        lattice: Lattice,
        heights: Field,
        interface: Interface = RIGID,
    ) -> None:
        self.springs, self.law, self.interface = springs, law, interface
        self.shape, self.mirrored = heights.shape, lattice.reflecting
        self.heights = np.ascontiguousarray(np.atleast_2d(heights))
        rows, columns = self.heights.shape
        self.work = TwoFields(Sites(rows, columns, self.mirrored))

    def stretch(self, force: Field) -> Field:
        """See `ByLaw`."""
        return force / self.springs.k1

    def indented(self, force: Field) -> float:
        """See `ByLaw`."""
        return largest(force, np) / self.springs.k1

    def velocity(self, force: Field) -> Field:
        """See `ByLaw`."""
        w = np.atleast_2d(self.stretch(force))
        beside = self.combined(w, w, self.springs.spread, self.springs.drag)
        return np.asarray(self.law.velocity(force)[0] + beside.reshape(force.shape))

    def balanced(self, state: LocalState, load: float | None) -> Field:
        """See `ByLaw`."""
        u, w = (np.ascontiguousarray(np.atleast_2d(field)) for field in (state.u, self.stretch(state.force)))
        total = None if load is None else load / self.springs.k1
        stretch = balanced(self.springs, u, w, self.heights, total, self.interface, mirrored=self.mirrored)
        return stretch.reshape(state.u.shape)

    def begin(self, stage: Stage, guess: LocalState) -> _Run:
        """See `ByLaw`."""
        return _Run(self, stage, guess)

    def combined(self, x: Field, y: Field, a: float, b: float) -> Field:
        """A L x + b y, L minus the Laplacian."""
        return lattice_force(x, y, a, b, mirrored=self.mirrored)


class _Run(LocalRun):
    """One step being solved."""

    def __init__(self, solver: LatticeCreep, stage: Stage, guess: LocalState) -> None:
        self.solver, self.stage, self.work, springs = solver, stage, solver.work, solver.springs
        self.before = np.atleast_2d(stage.before)
        self.u, self.w = np.array(np.atleast_2d(guess.u)), np.atleast_2d(guess.force) / springs.k1
        np.maximum(self.u, solver.heights, out=self.u)
        self.heights, self.yielding = solver.heights, np.zeros(self.u.shape, dtype=bool)
        self.position = float(stage.position if stage.load is None else guess.position)
        self.springs = springs.step(stage.tau)
        size = max(largest(field, np) for field in (self.u, self.w, self.before))
        self.unit, self.rounding = size or 1.0, local_creep.TUNING.rounding * size
        self.stiffness = working_stiffness(springs.k0, springs.k1)
        self.lagging, self.beside = 1.0 + self.springs.drag, 4.0 * self.springs.spread
        if not stage.again:
            self.work.prepare(springs.k1 / self.stiffness, self.springs.spread, self.springs.drag)

    def measure(self) -> float:
        wrong = self.revise() if self.solver.interface.yields else 0.0
        change, self.curved = self.linearize()
        return math.hypot(change, wrong, 0.0 if self.stage.load is None else self.even())

    def even(self) -> float:
        """What all sites lack by the same under a load, which the changes of sites alone do not tell."""
        work = self.work
        assert work.wanted is not None
        force = abs(work.wanted)
        if force <= work.force_error * work.known_stretch:
            force = 0.0
        return math.hypot(self.unit * force, self.lacking) / self.u.size

    def linearize(self) -> tuple[float, float]:
        """Begin a correction to the stretches; rms changes that sites would make alone; what tangents err."""
        work, springs, unit, load = self.work, self.springs, self.unit, self.stage.load
        law = self.law = LinearLaw(self.solver.law, self.stage.tau, 1.0, springs.k1 * self.w)
        surface, into = Surface(self.u, self.w, self.heights), Measured(work.bound, *work.source)
        scales = Scales(self.stiffness * unit, unit, 0.0)
        measured = operations.measure(surface, springs, 0.0, scales, into, work.sites, flowing=False)
        yielding = int(np.count_nonzero(self.yielding))
        if yielding:
            work.source.e[...] += operations.packed(
                self.yielding * (self.solver.interface.high / scales.force)
            )
        velocity, slope = (np.ascontiguousarray(field, dtype=float) for field in (law.velocity, law.slope))
        curve = self.curve = np.array(np.broadcast_to(law.law.bend(law.force) / springs.k1, self.w.shape))
        lacking, lag, sums = np.empty_like(self.w), np.empty_like(self.w), np.empty((len(self.w), 5))
        numbers = springs.k1, springs.spread, self.lagging, self.position, self.stage.tau, _LARGEST_LAG
        tangent = velocity, slope, curve
        tangents(surface, self.before, tangent, numbers, self.solver.mirrored, lacking, lag, sums)
        self.lacking, change, squares, bent, response = sums.sum(axis=0).tolist()
        work.source.f[...] = operations.packed(lacking / unit)
        self.lag, shift, wanted = operations.packed(lag), 0.0, None
        work.clear()
        if load is not None:  # the shift is at first what sites alone would need
            wanted = (load / springs.k1 - measured.stretch) / unit
            shift = (wanted - change / unit) / (response or math.nan)
            squares -= change * change / lag.size
        work.begin(wanted, measured.stretch / unit, shift, yielding)
        return math.sqrt(max(squares, 0.0) / lag.size), math.sqrt(bent / lag.size)

    def follow_law(self, noticed: float) -> None:
        """Where the tangent does not do, find the stretch of a site alone by the law."""
        springs, law, beside = self.springs, self.law, self.beside
        c = (self.lagging + beside) / springs.k1
        wanted = self.u - self.before - self.position
        wanted -= self.solver.combined(self.w, self.w, springs.spread, -beside)
        change = (wanted - c * law.force - law.creep) / (c + law.drag)
        bent = law.bent(c, change, noticed)
        self.w[bent] = law.forces(c, change, bent) / springs.k1
        self.linearize()

    def revise(self) -> float:
        """Revise which sites yield; how far those that change are from where they are to be, rms."""
        solver, springs = self.solver, self.springs
        excess = solver.combined(self.u, self.w, springs.k0, springs.k1) - solver.interface.high
        gap = self.u - solver.heights
        beyond, back = ~self.yielding & (gap <= 0) & (excess > 0), self.yielding & (gap > 0)
        far = np.where(beyond, excess / (4 * springs.k0 + springs.k1), np.where(back, gap, 0.0))
        self.yielding ^= beyond | back
        if self.stage.load is not None and self.yielding.any():
            count = int(self.stage.load / solver.interface.high)  # the load makes no more sites yield
            depth = np.where(self.yielding, np.where(beyond, far, -gap), np.inf)
            back.flat[np.argsort(depth, axis=None)[: max(np.count_nonzero(self.yielding) - count, 0)]] = True
            self.yielding &= ~back
            if not (~self.yielding & (back | (gap <= 0))).any():  # the body sinks until one bears the rest
                bears = np.argmin(np.where(self.yielding, np.inf, gap))
                self.u -= gap.flat[bears]
                self.position -= float(gap.flat[bears])
                back.flat[bears] = True
        self.heights = np.where(self.yielding, -np.inf, solver.heights)
        self.u[back] = solver.heights[back]  # the surface has come back to it
        np.maximum(self.u, self.heights, out=self.u)
        return math.sqrt(inner(far, far, np) / far.size)

    def improve(self, allowed: float, noticed: float) -> tuple[int, float]:
        if self.curved > noticed:
            self.follow_law(noticed)
        work = self.work
        work.relag(self.lag)
        done, cycles = work.improve(allowed / self.unit, TUNING.most_cycles)
        if not done:
            raise ConvergenceError(f"creep: {cycles} cycles did not solve a linear step; try a larger rtol")
        surface = Surface(self.u, self.w, self.heights)
        operations.settle(surface, work.correction, work.bound, self.unit, 0.0)
        self.position -= work.shift * self.unit
        if self.solver.interface.yields:
            return cycles, math.inf
        change = self.unit * operations.unpacked(work.correction.f, work.sites)
        error = np.minimum(self.curve * change * change, np.abs(change))
        return cycles, math.sqrt(inner(error, error, np) / error.size)

    def state(self) -> LocalState:
        shape = self.solver.shape
        return LocalState(self.u.reshape(shape), (self.springs.k1 * self.w).reshape(shape), self.position)

    def filtered_error(self, error: Field) -> tuple[float, float]:
        mean, size = self.work.filtered_error(operations.packed(np.atleast_2d(error) / self.unit))
        return self.unit * mean, self.unit * size
