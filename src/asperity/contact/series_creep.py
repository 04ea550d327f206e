r"""Implicit steps of local creep in series with an elastic solid, such as a half-space, or a share of it.

The creeping springs have the share g of the stiffness K, C = g K; the rest is permanent, H = (1 - g) K. With
a the area of a site, p the contact forces, s those of the creeping springs, v the creeping shape and U an
even level, u = p / K + g v + U and s = g p - g (1 - g) K v. So with z = -(g (1 - g))^(1/2) K v

    s = g p + (g (1 - g))^(1/2) z = w . (p, z),

and the conditions of a step of tau from the creeping shape v0 are those for the minimum, over z and bounded
p, whose sums are known or follow from the levels, of the convex

    p K^-1 p / 2 + z K^-1 z / 2 + sum of tau V(s) + s v0 - p xi,      V' = a v(s / a).

Where nothing is permanent s = p, and there is no z. The mean of s is g times that of p: a half-space is
soft under long waves, so that none of the mean passes from the creeping springs to the others, and the sum
of z is 0. Hence a creep of all sites by the same lowers the surface by g times as much, and the mean of the
creeping shape is counted so.

The forces of a linear step follow by conjugate gradients, p on the contacts alone, preconditioned in
Fourier modes by the same operator with one drag d, between weights ((t + d) / (t + D))^(1/2) of s: D is tau
v' / a at each site, d its mean in the logarithm, and t the compliance of the shortest wave. What changes s
alone, the others staying as they are, is the way (p, z) of a site: p with s in contact, which leaves the
permanent springs as they are, and off contact z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.contact import local_creep
from asperity.contact.arrays import inner, inverse, largest
from asperity.contact.interface import RIGID, Interface
from asperity.contact.local_creep import ByLaw, LinearLaw, LocalRun, LocalState, Stage
from asperity.creep import LocalCreep
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice, Mask, Spectrum

Fields = NDArray[Any]
"""Forces p and z, or what goes with them, along the first axis; p alone where nothing is permanent."""


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    reduction: float = 0.05
    """How far the residual of a linear problem falls before contacts and law are looked at again."""

    most_iterations: int = 200
    """Iterations on a linear problem, at most."""

    all_at_once: int = 20
    """Revisions after which only the worst of the wrong sites change sides: all at once they may cycle."""

    worst: float = 0.1
    """Part of the wrong sites that are the worst."""


TUNING = Tuning()


class SeriesCreep(ByLaw):
    """Steps above one rough surface.

    ``stiffness`` is K, at wave vector 0 that of an apparatus, or 0; a force over ``area`` is the stress of
    the law, and ``share`` is g.
    """

    def __init__(
        self,
        stiffness: Spectrum,
        law: LocalCreep,
        area: float,
        lattice: Lattice,
        heights: Field,
        interface: Interface = RIGID,
        share: float = 1.0,
    ) -> None:
        self.law, self.area, self.lattice, self.heights = law, area, lattice, heights
        self.interface, self.share = interface, share
        self.compliance = inverse(stiffness)
        self.permanent = (1 - share) * stiffness
        self.softest = float(self.compliance.max()) / share
        self.site_compliance = lattice.mean_over_modes(self.compliance)
        count = 2 if share < 1 else 1
        cosine, sine = math.sqrt(share), math.sqrt(1 - share)
        self.weights = np.array([share, cosine * sine])[:count]
        self.turn = np.array([[cosine, sine], [sine, -cosine]])[:count, :count]
        self.in_contact = np.array([1.0, sine / cosine])[:count]
        self.off_contact = np.array([0.0, *(1 / self.weights[1:])])

    def stretch(self, force: Field) -> Field:
        """See `ByLaw`."""
        return self.lattice.apply(self.compliance, force) / self.share

    def indented(self, force: Field) -> float:
        """See `ByLaw`."""
        return self.site_compliance / self.share * largest(force, np)

    def velocity(self, force: Field) -> Field:
        """See `ByLaw`."""
        return self.shape_of(self.law.velocity(force / self.area)[0])

    def shape_of(self, creep: Field) -> Field:
        """The creeping shape of a creep of each site: its mean counts by the share."""
        return np.asarray(creep - (1 - self.share) * creep.mean())

    def balanced(self, state: LocalState, load: float | None) -> Field:
        """See `ByLaw`."""
        p = self.pressing(state, state.u <= self.heights, load)
        s = p - self.lattice.apply(self.permanent, state.u)
        return self.stretch(s + (self.share * p.mean() - s.mean()))

    def pressing(self, state: LocalState, touching: Mask, load: float | None) -> Field:
        """Contact forces of a state, none of them tension, which carry the load."""
        p = state.force + self.lattice.apply(self.permanent, state.u)
        p += state.force.mean() / self.share - p.mean()
        if load is not None and not (p > 0).any(where=touching):
            p = touching * (load / np.count_nonzero(touching))
        return self.interface.admit(p, touching, load)

    def begin(self, stage: Stage, guess: LocalState) -> _Run:
        """See `ByLaw`."""
        return _Run(self, stage, guess)

    def displaced(self, x: Fields) -> Fields:
        """Displacements K^-1 x."""
        return np.asarray(self.lattice.backward(self.compliance * self.lattice.forward(x), overwrite=True))

    def ways(self, touching: Mask) -> Fields:
        """Change of x at each site that changes its s by 1; none where s cannot change."""
        return np.where(touching, self.by_row(self.in_contact), self.by_row(self.off_contact))

    def compliance_at(self, ways: Fields) -> Field:
        """Compliance of each site for itself; 0 where its force cannot change."""
        return np.asarray(self.site_compliance * (ways * ways).sum(axis=0))

    def linear(self, tau: float, force: Field) -> LinearLaw:
        """The law, linear about forces s."""
        return LinearLaw(self.law, tau, self.area, force)

    def by_row(self, values: Fields) -> Fields:
        """Numbers that go with the rows of fields."""
        return values.reshape(-1, *[1] * self.lattice.dimension)

    def sunk(self, shape: Field) -> Fields:
        """What a creeping shape does to the displacements, negative."""
        mean = shape.mean()
        rows = -self.by_row(self.weights) * (shape - mean)
        rows[0] -= mean
        return np.asarray(rows)

    def creeping(self, x: Fields) -> Field:
        """The forces s."""
        s: Field = self.weights[0] * x[0]
        for weight, row in zip(self.weights[1:], x[1:], strict=True):
            s += weight * row
        return s


class _Run(LocalRun):
    """One step being solved: forces x, levels, and which sites touch or yield."""

    def __init__(self, solver: SeriesCreep, stage: Stage, guess: LocalState) -> None:
        self.solver, self.stage = solver, stage
        self.body = np.isfinite(solver.heights)
        self.heights = heights = np.where(self.body, solver.heights, 0.0)
        load, before = stage.load, stage.before
        lengths = largest(heights, np), largest(before, np), solver.indented(guess.force)
        self.rounding = local_creep.TUNING.rounding * max(lengths)
        self.touching = guess.u <= solver.heights + self.rounding
        if load is not None and not self.touching.any():
            self.touching.flat[int(np.argmax(solver.heights - guess.u))] = True
        self.yielding, self.revisions, self.changed = np.zeros_like(self.touching), 0, False
        share, p = solver.share, solver.pressing(guess, self.touching, load)
        self.x = np.stack([p, *((guess.force - share * p) / b for b in solver.weights[1:])])
        position = float(guess.position if load is not None else stage.position)
        level = position + float(before.mean() + solver.compliance.flat[0] * p.mean() - guess.u.mean())
        self.levels = np.append(position, solver.weights[1:] * (level / share))
        self.wanted = solver.sunk(before)
        self.wanted[0] += heights

    def measure(self) -> float:
        solver, touching = self.solver, self.touching
        lacking = self.wanted - solver.displaced(self.x) - solver.by_row(self.levels)
        lacking = self.tame(lacking)
        law = self.law = solver.linear(self.stage.tau, solver.creeping(self.x))
        creep = law.creep  # where another field follows it, by that: a stiff law tells force from creep
        for weight, row in zip(solver.weights[1:], lacking[1:], strict=True):
            creep = row / weight
        self.below = below = lacking[0] - solver.share * creep
        lacking -= solver.by_row(solver.weights) * law.creep
        rounding = self.rounding
        wrong = np.where(self.yielding, below < -rounding, ~touching & self.body & (below > rounding))
        entering, self.revisions = self.worst(wrong, np.abs(below)), self.revisions + 1
        waiting = below[wrong & ~entering]
        touching |= entering
        self.yielding &= ~entering
        load, yielding = self.stage.load, self.yielding
        if load is not None and not touching.any() and yielding.any():  # one bears the rest
            more = load > solver.interface.high * np.count_nonzero(yielding)
            far, among = (-below, self.body & ~yielding) if more else (below, yielding)
            bears = int(np.argmin(np.where(among, far, np.inf)))
            touching.flat[bears], yielding.flat[bears] = True, False
        self.linear = LinearStep(solver, law.drag, touching, held=self.stage.load is None)
        sums = np.array([self.stage.load or 0.0, 0.0])[self.linear.first : len(self.x)]
        self.missing = sums - self.x[self.linear.first :].sum(axis=tuple(range(1, self.x.ndim)))
        self.lacking = lacking
        ways = solver.ways(touching)
        lack = (ways * lacking).sum(axis=0) * (solver.softest / (solver.softest + law.drag))
        if self.missing.size:  # what the sums lack is up to the contacts
            lost = float(np.abs(self.missing).max())
            lack += solver.compliance_at(ways) * (lost / max(int(np.count_nonzero(touching)), 1))
        return math.sqrt((inner(lack, lack, np) + inner(waiting, waiting, np)) / lack.size)

    def improve(self, allowed: float, noticed: float) -> tuple[int, float]:
        del allowed
        solver, touching, yielding, law = self.solver, self.touching, self.yielding, self.law
        goal = TUNING.reduction
        dx, rises, spent = self.linear.solve(self.lacking, self.missing, goal)
        new = self.x + dx
        self.changed = False
        touching &= ~self.worst(touching & (new[0] < solver.interface.low), -new[0])
        np.maximum(new[0], solver.interface.low, out=new[0])
        new[0][~(touching | yielding)] = 0.0
        ways = solver.ways(touching)
        c, change = solver.compliance_at(ways), solver.creeping(new) - law.force
        self.move(law, new, c, change, law.bent(c, change, noticed), ways)
        above = self.worst(touching & (new[0] > solver.interface.high), new[0])
        yielding |= above
        touching &= ~above
        np.minimum(new[0], solver.interface.high, out=new[0])
        if self.stage.load is not None and not (touching.any() or yielding.any()):
            raise ConvergenceError("creep: no contact is left to carry the load; try a larger rtol")
        self.x, self.levels = new, self.levels + rises
        return spent, math.inf

    def worst(self, wrong: Mask, by: Field) -> Mask:
        """Sites on the wrong side that are to change it: all; after many revisions a tenth, of one kind."""
        if self.revisions <= TUNING.all_at_once or not wrong.any():
            return wrong
        some = wrong & (by >= np.quantile(by[wrong], 1 - TUNING.worst)) & (not self.changed)
        self.changed = True
        return np.asarray(some)

    def tame(self, lacking: Fields) -> Fields:
        """Forces where the law overshoots, each for itself; what then lacks, but for creep."""
        solver, tau = self.solver, self.stage.tau
        law = solver.linear(tau, solver.creeping(self.x))
        ways = solver.ways(self.touching)
        c = solver.compliance_at(ways)
        change = ((ways * lacking).sum(axis=0) - law.creep) / (c + law.drag)
        wanted = (ways * lacking).sum(axis=0) + c * law.force
        wild = (c > 0) & (np.abs(law.creep) > np.maximum(np.abs(wanted), c * np.abs(law.force)))
        if wild.any():
            before = self.x.copy()
            self.move(law, self.x, c, change, wild, ways)
            lacking = lacking - solver.displaced(self.x - before)
        return lacking

    def move(self, law: LinearLaw, x: Fields, c: Field, change: Field, sites: Mask, ways: Fields) -> None:
        """Put forces s by the law at some sites, the others as they are; p is no tension."""
        forces = law.forces(c, change, sites)
        x[:, sites] += ways[:, sites] * (forces - self.solver.creeping(x[:, sites]))
        x[0][sites] = np.maximum(x[0][sites], 0.0)

    def state(self) -> LocalState:
        solver, touching = self.solver, self.touching
        u = self.heights - self.below
        u[touching] = self.heights[touching]
        np.maximum(u, solver.heights, out=u, where=~self.yielding)
        return LocalState(u, self.law.force, float(self.levels[0]))

    def filtered_error(self, error: Field) -> tuple[float, float]:
        solver, linear = self.solver, self.linear
        dx, _, _ = linear.solve(solver.sunk(error), np.zeros(len(linear.even)), TUNING.reduction)
        remainder = error + solver.shape_of(self.law.drag * solver.creeping(dx))
        mean = float(remainder.mean())
        if self.stage.load is not None:
            remainder -= mean
        return mean, math.sqrt(inner(remainder, remainder, np) / remainder.size)


class LinearStep:
    """Steps that are linear about some forces: a drag at each site, and contacts."""

    def __init__(self, solver: SeriesCreep, drag: Field, touching: Mask, *, held: bool) -> None:
        self.solver, self.drag, self.first = solver, drag, int(held)
        count, share = len(solver.weights), solver.share
        self.shape = (count, *touching.shape)
        self.free = np.ones(self.shape, dtype=bool)
        self.free[0] = touching
        self.even: list[Fields] = []
        moving = touching | (count > 1)
        if not moving.any():
            return
        compliance = solver.compliance.copy()
        least = float(compliance[compliance > 0].min())
        parts = least + np.where(touching, share, share * (1 - share)) * drag
        mean = math.exp(float(np.mean(np.log(parts[moving])))) - least
        mean = max(mean, 1e-12 * least)
        compliance.flat[0] = max(compliance.flat[0], least if held else compliance.flat[1:].max())
        self.inverse = np.stack([1 / (compliance + mean), 1 / compliance])[:count]
        weight = np.sqrt((least + mean) / parts)
        self.scale = np.where(
            touching,
            solver.by_row(solver.turn.ravel()).reshape(count, *self.shape[:1], *[1] * touching.ndim),
            0.0,
        )
        self.scale[0, 1:][:, ~touching] = 1.0  # off contact z alone, which follows s
        self.scale[0] *= weight
        for row in range(self.first, count):
            field = np.zeros(self.shape)
            field[row] = self.free[row]
            self.even.append(field)
        self.spread = [self.preconditioned(field) for field in self.even]
        self.gram = [[inner(field, other, np) for other in self.spread] for field in self.even]

    def preconditioned(self, y: Fields) -> Fields:
        """What the preconditioner makes of a residual."""
        lattice = self.solver.lattice
        turned = (self.scale * y).sum(axis=1)
        z = lattice.backward(self.inverse * lattice.forward(turned), overwrite=True)
        return np.asarray((self.scale * z[:, np.newaxis]).sum(axis=0))

    def projected(self, y: Fields) -> Fields:
        """The preconditioned residual, which changes no sum."""
        z = self.preconditioned(y)
        return z - self.combined([inner(field, z, np) for field in self.even]) if self.even else z

    def combined(self, amounts: Any) -> Fields:
        """Changes of the forces that change the sums by given amounts."""
        total = np.zeros(self.shape)
        for part, field in zip(self.shares(amounts), self.spread, strict=True):
            total += part * field
        return total

    def rises(self, y: Fields) -> Fields:
        """What of a residual is even, in the preconditioner's measure."""
        amounts = [inner(field, y, np) for field in self.spread]
        return self.shares(amounts) if self.even else np.empty(0)

    def shares(self, amounts: Any) -> Fields:
        """How much of each even change makes up given amounts."""
        try:
            return np.asarray(np.linalg.solve(self.gram, amounts))
        except np.linalg.LinAlgError:
            raise ConvergenceError(
                "creep: the law is too stiff under these forces to tell what the load moves; "
                "try less load, or a larger stress s0 of the law"
            ) from None

    def applied(self, y: Fields) -> Fields:
        """What a change of the forces displaces."""
        solver = self.solver
        out = solver.displaced(y)
        out += solver.by_row(solver.weights) * (self.drag * solver.creeping(y))
        out *= self.free
        return out

    def solve(self, lacking: Fields, missing: Fields, goal: float) -> tuple[Fields, Fields, int]:
        """Changes dx of the forces that make up what is lacking, and what the sums are missing.

        Next, how the levels rise; iterations.
        """
        dx, count = np.zeros(self.shape), len(self.solver.weights)
        if not self.free.any():
            return dx, np.zeros(count), 0
        residual = lacking * self.free
        if missing.any():
            dx = self.combined(missing)
            residual -= self.applied(dx)
        even = self.rises(residual)
        for rise, row in zip(even, self.even, strict=True):  # its rounding may hide the rest
            residual -= rise * row
        z = direction = self.projected(residual)
        slope = first = inner(residual, z, np)
        iterations = 0
        while iterations < TUNING.most_iterations and slope > goal**2 * first:
            iterations += 1
            change = self.applied(direction)
            curvature = inner(direction, change, np)
            if not curvature > 0:
                break
            length = slope / curvature
            dx += length * direction
            residual -= length * change
            z = self.projected(residual)
            slope, previous = inner(residual, z, np), slope
            direction = z + (slope / previous) * direction
        rises = np.zeros(count)
        rises[self.first :] = even + self.rises(residual)
        return dx, rises, iterations
