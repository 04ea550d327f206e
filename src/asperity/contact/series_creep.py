r"""Implicit steps of local creep in series with all of an elastic solid, such as a half-space.

All forces pass through the creeping element, so the contact forces p are the unknowns:

    C^-1 p + tau v(p / a) + v0 + X = xi   in contact,      p = 0 elsewhere, where u = C^-1 p + v0 + X > xi

with a the area of a site, v0 the creeping shape before the step, and X the rigid body, prescribed or such
that the sum of p is the load. These are the conditions for the minimum, over p >= 0 with that sum, of

    p C^-1 p / 2 + sum of tau V(p) - p (xi - v0),      V' = v,

which is convex. Where the forces have an upper bound, p is that bound where the surface is below xi.
Newton's method linearizes v; the contacts are revised as in `asperity.contact.active_set`, and the forces on
them follow by conjugate gradients, preconditioned by (C^-1 + d)^-1 in Fourier modes between weights
((t + d) / (t + D))^(1/2), where D is tau v' / a at each site, d its mean in the logarithm, and t the
compliance of the shortest wave.
"""

from __future__ import annotations

import math

import numpy as np

from asperity.contact.arrays import inner, largest
from asperity.contact.local_creep import LocalState, Stage, stretches_of
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice, Mask, Spectrum
from asperity.solids.creep_laws import LocalCreep

_MOST_REVISIONS = 400
"""Linear problems after which a step is given up."""

_MOST_ITERATIONS = 200
"""Iterations of conjugate gradients on each, at most."""

_REDUCTION = 0.05
"""How far the residual of a linear problem falls before contacts and law are looked at again."""

_GREATEST_RISE = 2.0
"""Rise of a stress that a linearized law is believed for, in units of `LocalCreep.bend`."""

_WILD = 3.0
"""Creep of a site in a step, over all that it could creep, above which its force is found for itself."""

_FAINT = 1e-6
"""Drag, relative to the largest, that a bend does not matter to."""

_USUAL_RATE = 0.3
"""Ratio of successive errors expected before two are known."""

_UNNOTICED = 0.01
"""Change, over what is allowed, at which contacts that still change do not matter."""

_ROUNDING = 64 * float(np.finfo(float).eps)
"""Change of the creeping shape that rounding makes, in units of the largest length."""


class SeriesCreep:
    """Steps above one rough surface."""

    def __init__(
        self,
        stiffness: Spectrum,
        law: LocalCreep,
        area: float,
        lattice: Lattice,
        heights: Field,
        bound: float = math.inf,
    ) -> None:
        self.law, self.area, self.lattice, self.heights, self.bound = law, area, lattice, heights, bound
        self.compliance = np.divide(1.0, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0)
        self.site_compliance = lattice.mean_over_modes(self.compliance)

    def stretch(self, force: Field) -> Field:
        """See `LocalCreepSolver`."""
        return self.lattice.apply(self.compliance, force)

    def velocity(self, force: Field) -> Field:
        """See `LocalCreepSolver`."""
        return self.law.velocity(force / self.area)[0]

    def balanced(self, state: LocalState, load: float | None) -> Field:
        """See `LocalCreepSolver`."""
        scale = 1.0 if load is None else load / float(state.force.sum())
        return self.stretch(state.force * scale)

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # what is not finite does not converge
    def solve(self, stage: Stage, guess: LocalState, allowed_error: float) -> tuple[LocalState, int]:
        """See `LocalCreepSolver`."""
        p, touching = self.begun(stage, guess)
        yielding = np.zeros_like(touching)
        position = guess.position if stage.load is not None else stage.position
        wanted = self.heights - stage.before
        size, spent = math.inf, 0
        rounding = _ROUNDING * max(largest(self.heights, np), largest(stage.before, np))
        for _ in range(_MOST_REVISIONS):
            value, slope = self.law.velocity(p / self.area)
            stretch = self.stretch(p)
            lacking = wanted - position - stretch
            p, lacking, slope = self.tamed(p, lacking, stage.tau, value, slope, yielding)
            entering = np.where(yielding, lacking < -rounding, ~touching & (lacking > rounding))
            touching |= entering
            yielding &= ~entering
            if stage.load is not None and not touching.any() and yielding.any():  # one bears the rest
                least = int(np.argmin(np.where(yielding, lacking, np.inf)))
                touching.flat[least], yielding.flat[least] = True, False
            drag = (stage.tau / self.area) * slope
            missing = None if stage.load is None else stage.load - float(p.sum())
            dp, moved, more = self.newton(lacking, drag, touching, missing)
            spent += more
            # What a linear law says of a stress that rises by far is not to be believed.
            believed = _GREATEST_RISE * np.maximum(
                self.law.bend(p / self.area), 0.1 * largest(p, np) / self.area
            )
            rise = np.where(drag > _FAINT * drag.max(), self.area * believed, math.inf)
            new = np.where(touching, p + np.minimum(dp, rise), np.where(yielding, p, 0.0))
            leaving, above = new < 0, touching & (new > self.bound)
            new[leaving], new[above] = 0.0, self.bound
            touching &= ~(leaving | above)
            yielding |= above
            if stage.load is not None and not (touching.any() or yielding.any()):
                raise ConvergenceError("creep: no contact is left to carry the load; try a larger rtol")
            change = -self.stretch(new - p) - moved
            change[~touching] = 0.0
            p, position = new, position + moved
            before, size = size, float(np.sqrt(np.mean(change * change)))
            if not math.isfinite(size):
                break
            rate = min(max(size / before, 0.1), 0.9) if 0 < before < math.inf else _USUAL_RATE
            allowed = max(allowed_error, rounding)
            settled = not (entering.any() or leaving.any() or above.any()) or size <= _UNNOTICED * allowed
            if settled and rate * size <= allowed:
                u = np.where(touching, self.heights, stage.before + position + self.stretch(p))
                np.maximum(u, self.heights, out=u, where=~yielding)
                if yielding.any():
                    u[yielding] += stage.tau * self.law.velocity(p[yielding] / self.area)[0]
                return LocalState(u, p, position), spent
        raise ConvergenceError(
            f"creep: a step of {stage.tau:.1e} changes by {size:.1e} after {_MOST_REVISIONS} revisions, "
            f"expected {allowed_error:.1e}; try a larger rtol"
        )

    def begun(self, stage: Stage, guess: LocalState) -> tuple[Field, Mask]:
        """Forces that carry the load, near those of a guess, and their contacts."""
        touching = guess.u <= self.heights
        p = np.where(touching, np.maximum(guess.force, 0.0), 0.0)
        if stage.load is not None:
            if not touching.any():
                touching.flat[int(np.argmax(self.heights - guess.u))] = True
            total, contacts = float(p.sum()), np.count_nonzero(touching)
            p = p * (stage.load / total) if total > 0 else touching * (stage.load / contacts)
        return np.minimum(p, self.bound), touching

    def tamed(
        self, p: Field, lacking: Field, tau: float, value: Field, slope: Field, yielding: Mask
    ) -> tuple[Field, Field, Field]:
        """Forces where the law overshoots, each for itself; what then lacks, and the derivatives."""
        own = self.site_compliance
        wanted = np.maximum(lacking + own * p, 0.0)
        wild = (tau * value > _WILD * wanted) & ~yielding
        if wild.any():
            calm = p.copy()
            calm[wild] = stretches_of(self.law, own, tau, 1 / self.area, wanted[wild], p[wild])
            value, slope = self.law.velocity(calm / self.area)
            lacking, p = lacking - self.stretch(calm - p), calm
        return p, lacking - tau * value, slope

    def newton(
        self, lacking: Field, drag: Field, touching: Mask, missing: float | None, goal: float = _REDUCTION
    ) -> tuple[Field, float, int]:
        """Forces dp on the contacts and a rise of the body with C^-1 dp + drag dp + rise = lacking.

        Where the load is prescribed, dp adds up to ``missing``; else the body stays.
        """
        if not touching.any():
            return np.zeros_like(lacking), 0.0, 0
        contacts = np.count_nonzero(touching)
        rough = float(self.compliance[self.compliance > 0].min())
        inside = drag[touching]
        mean = math.exp(float(np.mean(np.log(rough + inside)))) - rough
        weight = np.where(touching, np.sqrt((rough + mean) / (rough + drag)), 0.0)
        spectrum = self.compliance + max(mean, 1e-12 * rough)
        if missing is not None:
            spectrum.flat[0] = spectrum.flat[1:].max()
        spectrum = 1.0 / spectrum

        def conditioned(x: Field) -> Field:
            return weight * self.lattice.apply(spectrum, weight * x)

        dp = np.zeros_like(lacking)
        if missing is not None:
            dp[touching] = missing / contacts
        residual = np.where(touching, lacking - self.stretch(dp) - drag * dp, 0.0)
        spread = conditioned(touching.astype(float))
        norm = None

        def projected(x: Field) -> Field:
            """The preconditioned residual that adds up to nothing."""
            z = conditioned(x)
            if missing is not None:
                z -= (float(z.sum()) / float(spread.sum())) * spread
            return z

        z = projected(residual)
        slope = inner(residual, z, np)
        direction, iterations = z, 0
        while iterations < _MOST_ITERATIONS:
            iterations += 1
            if not slope > 0:
                break
            norm = norm or slope
            change = np.where(touching, self.stretch(direction) + drag * direction, 0.0)
            curvature = inner(direction, change, np)
            if not curvature > 0:
                break
            length = slope / curvature
            dp += length * direction
            residual -= length * change
            z = projected(residual)
            slope, previous = inner(residual, z, np), slope
            if not slope > goal**2 * norm:
                break
            direction = z + (slope / previous) * direction
        moved = 0.0
        if missing is not None:
            # What the constraint leaves is even: the rise of the body, by the weights of the preconditioner.
            moved = float(np.sum(residual * spread)) / float(np.sum(spread))
        return dp, moved, iterations

    def damped(self, error: Field, stage: Stage, end: LocalState) -> Field:
        """See `LocalCreepSolver`."""
        touching = (end.force > 0) & (end.force < self.bound)
        _, slope = self.law.velocity(end.force / self.area)
        drag = (stage.tau / self.area) * slope
        missing = None if stage.load is None else 0.0
        dp, _, _ = self.newton(np.where(touching, -error, 0.0), drag, touching, missing)
        return error + np.where(touching, drag * dp, 0.0)
