r"""Contacts that stick: a sequence of contacts without adhesion, under external forces.

Sites attract each other with the energy phi(gap), which is concave; all other energies are convex. The
tangent of phi at the last gap is an external force. With it the problem is as without adhesion, and its
solution has less energy than the last one (difference of convex functions; P. D. Tao, L. T. H. An, Acta
Math. Vietnam. 22, 289 (1997)). The force of Dugdale's law depends on the set of sites within the range alone.
There are finitely many sets, so the sequence ends. It begins with the set of the state before, or with none:
so the contact remembers. `asperity.contact.active_set` revises the attraction along with its contacts; the
sequence is for other solvers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from asperity.adhesion import Adhesion
from asperity.contact.bodies import Bodies
from asperity.contact.problem import Accuracy, ContactProblem, ContactSolver, Guess, JointSolver, Solution
from asperity.errors import ConvergenceError, InputError, PulledOff
from asperity.lattice import Field


@dataclass(frozen=True)
class Tuning:
    """Numbers of adhesion."""

    fewest_pixels: int = 6
    """Least number of pixels in the zone of a front; with fewer the lattice pins fronts."""

    fine_pixels: int = 20
    """Number of pixels in the zone below which a remark is made: n pixels act like an error of 1/n of w."""

    rough: float = 1e-3
    """Residual of contacts before the attraction has settled."""

    share: float = 0.1
    """Share of the sites passing the range that change in a round of a gradual step, one site at least."""

    most_rounds: int = 1000
    """Contacts without adhesion after which a sequence is given up."""


TUNING = Tuning()


def solved_with_adhesion(
    solver: ContactSolver, problem: ContactProblem, guess: Guess | None, accuracy: Accuracy
) -> Solution:
    """Solve until the attraction is that of the gap; `PulledOff` if that does not bear the load."""
    interface = problem.interface
    gradual = guess is not None and guess.gradual
    if interface.adhesion is None or (isinstance(solver, JointSolver) and not gradual):
        return solver.solve(problem, guess, accuracy)
    modes = problem.spectral()
    pull = modes.first_pull(guess)
    assert pull is not None
    slack, iterations, revisions = accuracy.residual * interface.adhesion.strength * interface.cell, 0, 0
    rough = replace(accuracy, residual=max(accuracy.residual, TUNING.rough))
    settled = False
    for _ in range(TUNING.most_rounds):
        if interface.parts(modes.load, pull):
            raise PulledOff
        known = modes.without_adhesion(pull)
        solution = solver.solve(known, guess, accuracy if settled else rough)
        iterations, revisions = iterations + solution.iterations, revisions + solution.set_changes
        before, pull = pull, interface.pull(solution.u - modes.heights)
        stays = float(np.abs(pull - before).max()) <= slack
        if gradual and not stays:
            pull = _few(before, pull, solution.u - modes.heights, interface.adhesion)
        if stays and (settled or rough == accuracy):
            return replace(solution, iterations=iterations, set_changes=revisions)
        settled = stays
        guess = Guess(solution.u, solution.in_contact)
    raise ConvergenceError(
        f"adhesion: the attraction still changes after {TUNING.most_rounds} rounds; try another load"
    )


def _few(before: Field, pull: Field, gap: Field, law: Adhesion) -> Field:
    """The new attraction where it jumps farthest beyond the range, and elsewhere the one before.

    Where edges are not free, a site that pulls lifts others: sites that change together are too many. A share
    of 0.001 to 0.1 gives the same path.
    """
    # Of a smooth law every site changes a little: that is no jump.
    jumps = np.abs(pull - before) > np.abs(pull - before).max() / 2
    most = max(1, int(TUNING.share * np.count_nonzero(jumps)))
    if not math.isfinite(law.reach) or np.count_nonzero(jumps) == most:
        return pull
    beyond = np.where(jumps, np.abs(gap - law.reach), -1.0)
    last = np.partition(beyond, -most, axis=None)[-most]
    return np.where(jumps & (beyond < last), before, pull)


def check_zone(bodies: Bodies) -> None:
    """Refuse pixels that do not resolve the zone of a front, by the instantaneous modulus."""
    fewest, pixel = TUNING.fewest_pixels, max(bodies.lattice.spacing)
    if (pixels := _pixels(bodies, 0.0)) < fewest:
        most, got = (f"{size:.3g}{' m' * bodies.si}" for size in (pixel * pixels / fewest, pixel))
        raise InputError(
            "adhesion",
            expected=f"pixels of at most {most}: {fewest} in a zone of pi E* w/(4 s0^2)",
            got=got,
            advice="a longer range; or no adhesion of the solid, but a pull-off force of the contact: "
            "contact.pull_off(work=...)",
        )


def zone_remark(bodies: Bodies, time: float = 0.0) -> str:
    """A remark if pixels disturb the fronts after the modulus has relaxed for a time, or "".

    Fronts that creep slowly feel the relaxed modulus.
    """
    if (pixels := _pixels(bodies, time)) >= TUNING.fine_pixels:
        return ""
    when = " at last, as the modulus relaxes" if bodies.solid.relaxing and time else ""
    return (
        f"the zone of a front has {pixels:.3g} pixels{when}, which act like a work of adhesion that is wrong "
        f"by {100 / pixels:.0f} %; {TUNING.fine_pixels} pixels or more are surer"
    )


def _pixels(bodies: Bodies, time: float) -> float:
    """Pixels in the zone by the modulus after a time."""
    solid = bodies.solid
    if solid.adhesion is None or solid.modulus is None:
        return math.inf
    relaxed = solid.permanent_share + sum(share * math.exp(-time / tau) for share, tau in solid.relaxing)
    return solid.adhesion.zone(solid.modulus * relaxed) / max(bodies.lattice.spacing)
