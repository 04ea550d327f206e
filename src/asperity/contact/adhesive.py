r"""Contacts that stick: a sequence of contacts without adhesion, under external forces.

Sites attract each other with the energy phi(gap), which is concave; all other energies are convex. The
tangent of phi at the last gap is an external force. With it the problem is as without adhesion, and its
solution has less energy than the last one (difference of convex functions; P. D. Tao, L. T. H. An, Acta
Math. Vietnam. 22, 289 (1997)). The force of Dugdale's law depends on the set of sites within the range alone.
There are finitely many sets, so the sequence ends. It begins with the set of the state before, or with none:
so the contact remembers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from asperity.contact.bodies import Bodies
from asperity.contact.problem import Accuracy, ContactProblem, ContactSolver, Guess, Solution
from asperity.errors import ConvergenceError, InputError, PulledOff


@dataclass(frozen=True)
class Tuning:
    """Numbers of adhesion."""

    fewest_pixels: int = 6
    """Least number of pixels in the zone of a front; with fewer the lattice pins fronts."""

    rough: float = 1e-3
    """Residual of contacts before the attraction has settled."""

    rounding: float = 64 * float(np.finfo(float).eps)
    """Load plus attraction, over the attraction, below which it is rounding."""

    most_rounds: int = 1000
    """Contacts without adhesion after which a sequence is given up."""


TUNING = Tuning()


@dataclass(frozen=True)
class Adhesive:
    """A solver of contacts with adhesion or without, by a solver of those without."""

    solver: ContactSolver

    def solve(self, problem: ContactProblem, guess: Guess | None, accuracy: Accuracy) -> Solution:
        """Solve until the attraction is that of the gap; `PulledOff` if that does not bear the load."""
        interface, heights = problem.interface, problem.heights
        if interface.adhesion is None:
            return self.solver.solve(problem, guess, accuracy)
        last = np.inf if guess is None else guess.u if guess.last is None else guess.last
        pull = interface.pull(np.broadcast_to(last - heights, heights.shape))
        slack, iterations, revisions = accuracy.residual * interface.adhesion.strength * interface.cell, 0, 0
        rough = replace(accuracy, residual=max(accuracy.residual, TUNING.rough))
        settled = False
        for _ in range(TUNING.most_rounds):
            load, attraction = problem.spectral().load, -float(pull.sum())
            if load is not None and load + attraction <= TUNING.rounding * attraction:
                raise PulledOff
            solution = self.solver.solve(problem.beside(pull), guess, accuracy if settled else rough)
            iterations, revisions = iterations + solution.iterations, revisions + solution.set_changes
            before, pull = pull, interface.pull(solution.u - heights)
            stays = float(np.abs(pull - before).max()) <= slack
            if stays and (settled or rough == accuracy):
                return replace(solution, iterations=iterations, set_changes=revisions)
            settled = stays
            guess = Guess(solution.u, solution.in_contact, disposable=True)
        raise ConvergenceError(
            f"adhesion: the attraction still changes after {TUNING.most_rounds} rounds; try another load"
        )


def check_zone(bodies: Bodies) -> None:
    """Refuse pixels that do not resolve the zone of a front, by the instantaneous modulus."""
    if (pixels := _pixels(bodies, 0.0)) is not None:
        most, got = pixels
        raise InputError(
            "adhesion",
            expected=f"pixels of at most {most}: {TUNING.fewest_pixels} in a zone of pi E* w/(4 s0^2)",
            got=got,
            advice="a longer range; or no adhesion of the solid, but a pull-off force of the contact: "
            "contact.pull_off(work=...), --work-of-adhesion",
        )


def zone_remark(bodies: Bodies, time: float) -> str:
    """A remark if the lattice no longer resolves the zone after the modulus has relaxed for a time.

    Fronts that creep slowly feel the relaxed modulus.
    """
    if (pixels := _pixels(bodies, time)) is None:
        return ""
    most, got = pixels
    return (
        f"as the modulus relaxes, the zone of a front shrinks: only pixels of at most {most} resolve it "
        f"in the end; those of {got} may pin the front"
    )


def _pixels(bodies: Bodies, time: float) -> list[str] | None:
    """The largest pixel that resolves the zone by the modulus after a time, and the pixel if it is larger."""
    solid = bodies.solid
    if solid.adhesion is None or solid.modulus is None:
        return None
    relaxed = solid.permanent_share + sum(share * math.exp(-time / tau) for share, tau in solid.relaxing)
    most = solid.adhesion.zone(solid.modulus * relaxed) / TUNING.fewest_pixels
    pixel = max(bodies.lattice.spacing)
    return [f"{size:.3g}{' m' * bodies.si}" for size in (most, pixel)] if most < pixel else None
