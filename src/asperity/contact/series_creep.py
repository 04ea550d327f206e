r"""Implicit steps of local creep in series with an elastic solid, such as a half-space, or a share of it.

The creeping springs have the share g of the stiffness K, C = g K; the rest is permanent, H = (1 - g) K. A
step of tau from the creeping shape v0 is

    H^-1 (p - s) + U = xi   in contact,      p = 0 elsewhere, where u = H^-1 (p - s) + U > xi
    C^-1 s + v0 + tau v(s / a) = H^-1 (p - s)   everywhere, but for a constant

with a the area of a site, p the contact forces, s those of the creeping springs, and U the mean of u, which
follows from the rigid body, or is such that the sum of p is the load. These are the conditions for the
minimum, over s and p >= 0 with that sum, of the convex

    s C^-1 s / 2 + (p - s) H^-1 (p - s) / 2 + sum of tau V(s) + s v0 - p xi,      V' = v.

Where nothing is permanent s = p, which is then the only unknown. The mean of s is g times that of p: a
half-space is soft under long waves, so that none of the mean passes from the creeping springs to the others.
Hence a creep of all sites by the same lowers the surface by g times as much, and the mean of the creeping
shape is counted so. Where the forces have an upper bound, p is that bound where the surface is below xi.

Newton's method linearizes v; the contacts are revised as in `asperity.contact.active_set`, and the forces
follow by conjugate gradients, preconditioned in Fourier modes by the same operator with one drag d, between
weights ((t + d) / (t + D))^(1/2) of s: D is tau v' / a at each site, d its mean in the logarithm, and t the
compliance of the shortest wave. The new s is not that of the tangent, but what has the same T s + tau v(s),
with T the compliance of a site for itself. No law overflows in that, however steep.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.contact.arrays import inner, largest
from asperity.contact.local_creep import LocalState, Stage, stretches_of
from asperity.contact.stencils import bounded
from asperity.creep import LocalCreep
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice, Mask, Spectrum

Fields = NDArray[Any]
"""Forces p and s, or displacements that go with them; where nothing is permanent, one field."""

_MOST_REVISIONS = 100
"""Linear problems after which a step is given up."""

_MOST_ITERATIONS = 200
"""Iterations of conjugate gradients on each, at most."""

_REDUCTION = 0.05
"""How far the residual of a linear problem falls before contacts and law are looked at again."""

_SLOW, _SHARPER, _FINEST = 0.5, 0.3, 1e-8
"""Ratio of successive changes above which it falls by so much more, and how far at most."""

_WILD = 3.0
"""Creep of a site in a step, over all that it could creep, above which its force is found for itself."""

_STRAIGHT = 1e-3
"""Change of a stress, in units of `LocalCreep.bend`, for which the tangent does."""

_KEPT = 0.1
"""Part of what the tangent leaves of the force of a contact that is left at least."""

_USUAL_RATE = 0.3
"""Ratio of successive errors expected before two are known."""

_UNNOTICED = 0.01
"""Change, over what is allowed, at which contacts that still change do not matter."""

_LOST = 1e-3
"""Part of the load that may lack before the last revision."""

_ROUNDING = 64 * float(np.finfo(float).eps)
"""Change of the creeping shape that rounding makes, in units of the largest length."""


class SeriesCreep:
    """Steps above one rough surface.

    Parameters
    ----------
    stiffness
        K; at wave vector 0 the stiffness of an apparatus, or 0.
    law, area
        The law of creep, and the area over which a force is its stress.
    lattice, heights, bound
        The sites, the rough surface, and the largest force of a site.
    share
        g.
    """

    def __init__(
        self,
        stiffness: Spectrum,
        law: LocalCreep,
        area: float,
        lattice: Lattice,
        heights: Field,
        bound: float = math.inf,
        share: float = 1.0,
    ) -> None:
        self.law, self.area, self.lattice, self.heights, self.bound = law, area, lattice, heights, bound
        self.share, self.shared = share, share < 1
        self.compliance = np.divide(1.0, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0)
        self.blocks = self.compliance[np.newaxis, np.newaxis]
        if self.shared:
            self.permanent = (1 - share) * stiffness
            waves = self.compliance / (1 - share)
            waves.flat[0] = 0.0
            self.blocks = np.array([[waves, -waves], [-waves, waves / share]])
            self.blocks[0, 0].flat[0] = self.compliance.flat[0]
        self.site_compliance = lattice.mean_over_modes(self.compliance)

    def stretch(self, force: Field) -> Field:
        """See `LocalCreepSolver`."""
        return self.lattice.apply(self.compliance, force) / self.share

    def indented(self, force: Field) -> float:
        """See `LocalCreepSolver`."""
        return self.site_compliance / self.share * largest(force, np)

    def velocity(self, force: Field) -> Field:
        """See `LocalCreepSolver`."""
        return self.shape_of(self.law.velocity(force / self.area)[0])

    def shape_of(self, creep: Field) -> Field:
        """The creeping shape of a creep of each site: its mean counts by the share."""
        return creep - (1 - self.share) * creep.mean() if self.shared else creep

    def balanced(self, state: LocalState, load: float | None) -> Field:
        """See `LocalCreepSolver`."""
        p = self.pressing(state, state.u <= self.heights, load)
        if self.shared:
            s = p - self.lattice.apply(self.permanent, state.u)
            p = s + (self.share * p.mean() - s.mean())
        return self.stretch(p)

    def pressing(self, state: LocalState, touching: Mask, load: float | None) -> Field:
        """Contact forces of a state, none of them tension, which carry the load."""
        p = state.force
        if self.shared:
            p = p + self.lattice.apply(self.permanent, state.u)
            p += state.force.mean() / self.share - p.mean()
        p = np.where(touching, np.maximum(p, 0.0), 0.0)
        if load is not None and not p.any():
            p = touching * (load / np.count_nonzero(touching))
        return bounded(p, load, self.bound)

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # what is not finite does not converge
    def solve(self, stage: Stage, guess: LocalState, allowed_error: float) -> tuple[LocalState, int]:
        """See `LocalCreepSolver`."""
        lengths = largest(self.heights, np), largest(stage.before, np), self.indented(guess.force)
        rounding = _ROUNDING * max(lengths)
        allowed = max(allowed_error, rounding)
        touching = guess.u <= self.heights + rounding
        if stage.load is not None and not touching.any():
            touching.flat[int(np.argmax(self.heights - guess.u))] = True
        yielding = np.zeros_like(touching)
        p = self.pressing(guess, touching, stage.load)
        x = np.array([p, guess.force]) if self.shared else p[np.newaxis]
        position = guess.position if stage.load is not None else stage.position
        levels, wanted = self.levels(position, guess.u, p, stage.before)
        sums, known = self.sums(stage.load)
        size, spent, goal = math.inf, 0, _REDUCTION
        for _ in range(_MOST_REVISIONS):
            value, slope = self.law.velocity(x[-1] / self.area)
            lacking = wanted - self.displaced(self.blocks, x)
            lacking -= levels.reshape(-1, *[1] * touching.ndim)
            x, lacking, value, slope = self.tamed(x, lacking, stage.tau, value, slope, touching, yielding)
            creep = stage.tau * value
            lacking[-1] -= creep
            entering = np.where(yielding, lacking[0] < -rounding, ~touching & (lacking[0] > rounding))
            touching |= entering
            yielding &= ~entering
            if stage.load is not None and not touching.any() and yielding.any():  # one bears the rest
                least = int(np.argmin(np.where(yielding, lacking[0], np.inf)))
                touching.flat[least], yielding.flat[least] = True, False
            drag = (stage.tau / self.area) * slope
            missing = known - sums @ [field.sum() for field in x]
            dx, rises, more = self.newton(lacking, drag, touching, sums, missing, goal)
            spent += more
            new, leaving, above = self.bent(x, dx, creep, drag, stage.tau, touching)
            new[0][yielding | above] = self.bound
            touching &= ~(leaving | above)
            yielding |= above
            if stage.load is not None and not (touching.any() or yielding.any()):
                raise ConvergenceError("creep: no contact is left to carry the load; try a larger rtol")
            change = self.change(new - x, rises[0], touching)
            x, levels = new, levels + rises
            before, size = size, float(np.sqrt(np.mean(change * change)))
            if not math.isfinite(size):
                break
            if size > _SLOW * before:
                goal = max(_SHARPER * goal, _FINEST)
            rate = min(max(size / before, 0.1), 0.9) if 0 < before < math.inf else _USUAL_RATE
            settled = not (entering.any() or leaving.any() or above.any()) or size <= _UNNOTICED * allowed
            carried = stage.load is None or abs(missing[0]) <= _LOST * stage.load
            if settled and carried and rate * size <= allowed:
                return self.state(stage, x, levels, touching, yielding), spent
        raise ConvergenceError(
            f"creep: a step of {stage.tau:.1e} changes by {size:.1e} after {_MOST_REVISIONS} revisions, "
            f"expected {allowed_error:.1e}; try a larger rtol"
        )

    def levels(self, position: float, u: Field, p: Field, before: Field) -> tuple[Fields, Fields]:
        """What the sides of the module's equations may differ by, evenly; and their right-hand sides.

        That is X, or U less what an apparatus yields, and minus the mean creep of this step.
        """
        if not self.shared:
            return np.array([position]), (self.heights - before)[np.newaxis]
        level, mean = float(u.mean() - self.compliance.flat[0] * p.mean()), float(before.mean())
        levels = np.array([level, (position + mean - level) / self.share])
        return levels, np.array([self.heights, mean - before])

    def displaced(self, blocks: Fields, x: Fields) -> Fields:
        """Fields by a symmetric matrix of spectra."""
        modes = np.einsum("ab...,b...->a...", blocks, self.lattice.forward(x))
        return self.lattice.backward(modes, overwrite=True)

    def sums(self, load: float | None) -> tuple[Fields, Fields]:
        """Sums of p and s that are known: how much each counts in them, by rows, and what they are."""
        if load is not None:
            return np.eye(len(self.blocks)), load * np.array([1.0, self.share])[: len(self.blocks)]
        return np.array([[-self.share, 1.0]])[: self.shared, : len(self.blocks)], np.zeros(int(self.shared))

    def tamed(
        self, x: Fields, lacking: Fields, tau: float, value: Field, slope: Field, touching: Mask, held: Mask
    ) -> tuple[Fields, Fields, Field, Field]:
        """Forces where the law overshoots, each for itself; what then lacks, the rate and its derivative."""
        s, own = x[-1], self.site_compliances(touching)
        wanted = lacking[-1] + own * s
        if not self.shared:
            np.maximum(wanted, 0.0, out=wanted)
        wild = tau * np.abs(value) > _WILD * np.maximum(np.abs(wanted), own * np.abs(s))
        if not self.shared:
            wild &= ~held
        if wild.any():
            calm = x.copy()
            found = stretches_of(self.law, own[wild], tau, 1 / self.area, wanted[wild], s[wild])
            self.replace(calm, wild, found, touching)
            value, slope = self.law.velocity(calm[-1] / self.area)
            lacking, x = lacking - self.displaced(self.blocks, calm - x), calm
        return x, lacking, value, slope

    def bent(
        self, x: Fields, dx: Fields, creep: Field, drag: Field, tau: float, touching: Mask
    ) -> tuple[Fields, Mask, Mask]:
        """Forces by the law rather than by its tangent; contacts that leave, and those that yield."""
        new, s, own = x + dx, x[-1], self.site_compliances(touching)
        leaving = touching & (new[0] < 0)
        if self.shared:  # s for itself takes up as much of what p is not to be
            new[1][leaving] -= self.share * new[0][leaving]
        new[0][leaving | ~touching] = 0.0
        ds = new[-1] - s
        bent = np.abs(ds) > _STRAIGHT * self.area * self.law.bend(s / self.area)
        if not self.shared:
            bent &= touching & ~leaving
        wanted = own[bent] * new[-1][bent] + creep[bent] + drag[bent] * ds[bent]
        if not self.shared:
            np.maximum(wanted, _KEPT * own[bent] * new[0][bent], out=wanted)
        found = stretches_of(self.law, own[bent], tau, 1 / self.area, wanted, s[bent])
        self.replace(new, bent, found, touching & ~leaving)
        return new, leaving, touching & (new[0] > self.bound)

    def site_compliances(self, touching: Mask) -> Field:
        """Compliance of a site for itself: in contact p goes with s, which leaves the surface where it is."""
        whole = self.site_compliance / self.share
        return np.where(touching, whole, whole / (1 - self.share) if self.shared else whole)

    def replace(self, x: Fields, sites: Mask, s: Field, touching: Mask) -> None:
        """Put other forces s at some sites; in contact, the same is added to p, of which a part is left."""
        if self.shared:
            p = x[0][sites]
            x[0][sites] = np.where(touching[sites], np.maximum(p + s - x[1][sites], _KEPT * p), p)
        x[-1][sites] = s

    def change(self, dx: Fields, rise: float, touching: Mask) -> Field:
        """How the creeping shape changes with the forces, the surface staying in contact."""
        if not self.shared:
            return np.where(touching, -self.stretch(dx[0]) - rise, 0.0)
        change = np.where(touching, 0.0, self.displaced(self.blocks[:1], dx)[0] + rise) - self.stretch(dx[1])
        return np.asarray(change - change.mean())

    def state(self, stage: Stage, x: Fields, levels: Fields, touching: Mask, yielding: Mask) -> LocalState:
        """The state of forces that were found."""
        u = self.displaced(self.blocks[:1], x)[0] + levels[0]
        position = float(levels[0])
        if not self.shared:
            u += stage.before
            u[yielding] += stage.tau * self.law.velocity(x[0][yielding] / self.area)[0]
        elif stage.load is None:
            position = stage.position
        else:
            position += float(self.share * levels[1] - stage.before.mean())
        u[touching] = self.heights[touching]
        np.maximum(u, self.heights, out=u, where=~yielding)
        return LocalState(u, x[-1], position)

    def newton(
        self,
        lacking: Fields,
        drag: Field,
        touching: Mask,
        sums: Fields,
        missing: Fields,
        goal: float = _REDUCTION,
    ) -> tuple[Fields, Fields, int]:
        """Changes dx of the forces, of p on the contacts, that make up what is lacking by the law's tangent.

        They make up what the sums are missing too. Next, how the levels rise; iterations.
        """
        if not touching.any() and not self.shared:
            return np.zeros_like(lacking), np.zeros(len(lacking)), 0
        free = np.ones(lacking.shape, dtype=bool)
        free[0] = touching
        rough = self.blocks[-1, -1]
        least = float(rough[rough > 0].min())
        mean = math.exp(float(np.mean(np.log(least + drag[free[-1]])))) - least
        mean = max(mean, 1e-12 * least)
        weight = free.astype(float)
        weight[-1] *= np.sqrt((least + mean) / (least + drag))
        inverse = self.inverse(mean, len(sums) == len(lacking))
        even = [free * one.reshape(-1, *[1] * touching.ndim) for one in sums]
        spread = [weight * self.displaced(inverse, weight * one) for one in even]
        gram = [[inner(one, other, np) for other in spread] for one in even]

        def projected(y: Fields) -> Fields:
            """The preconditioned residual, which changes no sum."""
            z = weight * self.displaced(inverse, weight * y)
            return z - combined([inner(one, z, np) for one in even]) if even else z

        def combined(amounts: Any) -> Fields:
            parts = zip(np.linalg.solve(gram, amounts), spread, strict=True)
            return sum((part * one for part, one in parts), start=np.zeros_like(lacking))

        def rises(y: Fields) -> Fields:
            """What of a residual is even, in the preconditioner's measure."""
            known = [inner(one, y, np) for one in spread]
            return np.asarray(np.linalg.solve(gram, known) if even else np.empty(0))

        def applied(y: Fields) -> Fields:
            out = self.displaced(self.blocks, y)
            out[-1] += drag * y[-1]
            out *= free
            return out

        dx, residual = np.zeros_like(lacking), lacking * free
        if missing.any():
            dx = combined(missing)
            residual -= applied(dx)
        left = rises(residual)
        for rise, one in zip(left, even, strict=True):  # else rounding of what is even may hide the rest
            residual -= rise * one
        z = direction = projected(residual)
        slope = first = inner(residual, z, np)
        iterations = 0
        while iterations < _MOST_ITERATIONS and slope > goal**2 * first:
            iterations += 1
            change = applied(direction)
            curvature = inner(direction, change, np)
            if not curvature > 0:
                break
            length = slope / curvature
            dx += length * direction
            residual -= length * change
            z = projected(residual)
            slope, previous = inner(residual, z, np), slope
            direction = z + (slope / previous) * direction
        return dx, (left + rises(residual)) @ sums, iterations

    def inverse(self, drag: float, free_mean: bool) -> Fields:
        """Inverse of the compliance with one drag, at each wave vector."""
        blocks = self.blocks.copy()
        for n in range(len(blocks)):
            if free_mean or n == 1:  # sums see to the means
                blocks[n, n].flat[0] = blocks[n, n].flat[1:].max()
        blocks[-1, -1] += drag
        if not self.shared:
            return np.asarray(1.0 / blocks)
        (a, b), (_, d) = blocks
        return np.asarray(np.array([[d, -b], [-b, a]]) / (a * d - b * b))

    def damped(self, error: Field, stage: Stage, end: LocalState) -> Field:
        """See `LocalCreepSolver`."""
        _, slope = self.law.velocity(end.force / self.area)
        drag = (stage.tau / self.area) * slope
        lacking = np.zeros((len(self.blocks), *error.shape))
        lacking[-1] = -error
        if self.shared:
            lacking[1] += error.mean()
            lacking[0] -= error.mean()
        sums, known = self.sums(stage.load)
        dx, _, _ = self.newton(lacking, drag, end.u == self.heights, sums, 0.0 * known)
        return error + self.shape_of(drag * dx[-1])
