r"""Active set with unsymmetric linear problems: the contact of steady sliding.

In contact u = h for forces p that vanish elsewhere. With the mean over the contacts projected out, which
frees the load and the distance of the bodies, GMRES solves

    P C P p = P h

(Y. Saad, M. H. Schultz, SIAM J. Sci. Stat. Comput. 7, 856 (1986), DOI 10.1137/0907058). 1 / abs(C)
preconditions it; 1 / C is the solution in full contact, but stalls where the solid is almost a fluid. Then
contacts in tension are released and free sites that penetrate become contacts, all at once, as in
`asperity.contact.active_set`. Where the number of wrong sites sets no new record, the linear problems are
solved more accurately, and then a random half of the wrong sites is exchanged, a quarter, and so on. The
symmetric part of C is positive definite, so there is one solution, and exchanges of the last wrong site reach
it (J. J. Judice, F. M. Pires, Comput. Oper. Res. 21, 587 (1994), DOI 10.1016/0305-0548(94)90106-6).

A start from nothing takes the contacts of an elastic solid with the storage compliance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, gmres

from asperity.contact.active_set import ActiveSet
from asperity.contact.interface import RIGID
from asperity.contact.problem import TOLERANCE, Accuracy
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Mask, Modes, Spectrum
from asperity.sliding.problem import Sliding, State


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    start: float = 0.1
    """Residual of the elastic contact from which a start from nothing begins."""

    reduction: float = 0.1
    """How far the linear residual falls before the set of contacts is revised."""

    reduction_per_change: float = 3.0
    """After a revision of the fraction x of the contacts the residual falls to this times x."""

    digits: float = 1e-4
    """How far it falls in one correction, whose residual is then evaluated anew."""

    directions: tuple[int, int] = (20, 300)
    """Fewest and most directions that GMRES keeps."""

    memory: float = 3e7
    """Numbers in these directions, unless they would be fewer than the fewest."""

    most_restarts: int = 20
    """Restarts of GMRES after which the contacts are revised all the same."""

    patience: int = 3
    """Revisions without a new record, before linear solutions become ten times as accurate, or half as many
    sites are exchanged."""

    rounding: float = 1e-13
    """Tension and penetration that count as none, over the mean force and the range of u."""

    most_products: int = 20_000
    """Products with C after which the solver gives up."""


TUNING = Tuning()


def solved(problem: Sliding, start: State | None = None) -> State:
    """Solve a problem, from nothing or from the state at a speed nearby.

    Raises
    ------
    ConvergenceError
        The tolerance was not reached.
    """
    if start is None:
        guess = ActiveSet().solve(problem.elastic, None, Accuracy(TUNING.start))
        force = np.where(guess.in_contact, problem.elastic.force(guess.u), 0.0)
        return _Run(problem, force, guess.in_contact).state()
    return _Run(problem, start.force, start.in_contact).state()


class _Run:
    """One solve."""

    def __init__(self, problem: Sliding, force: Field, in_contact: Mask) -> None:
        self.problem, self.force, self.in_contact = problem, force, in_contact
        self.products = self.revisions = 0
        self.most = self.reduction = TUNING.reduction
        self.patience = TUNING.patience
        self.record, self.share = in_contact.size + 1, 1.0
        self.random = np.random.default_rng(0)

    def state(self) -> State:
        """Revise the contacts and correct the forces until both are right."""
        while True:
            self.correct()
            self.u, wrong = self.surface_and_wrong()
            number = int(np.count_nonzero(wrong))
            if number == 0 and (state := self.published()).residual <= TOLERANCE:
                return state
            if self.products > TUNING.most_products:
                raise ConvergenceError(
                    f"steady sliding: {number} sites on the wrong side and residual "
                    f"{self.published().residual:.1e} after {self.products} products, expected "
                    f"{TOLERANCE:.0e}; try a start at a speed nearby, by more speeds per decade"
                )
            if number:
                self.exchange(wrong, number)
            else:
                self.reduction = max(TUNING.digits, 0.1 * TOLERANCE / state.residual)

    def correct(self) -> None:
        """Bring the surface in contact nearer to the heights."""
        problem, sites = self.problem, np.flatnonzero(self.in_contact)
        alone = sites.size == self.in_contact.size
        nearly = problem.stiffness if alone else np.abs(problem.stiffness)

        def displaced(forces: Field) -> Field:
            self.products += 1
            return self.at_contacts(problem.compliance, sites, forces)

        def near(displacements: Field) -> Field:
            return self.at_contacts(nearly, sites, displacements)

        force = self.force.flat[sites]
        force += (problem.load - force.sum()) / sites.size
        wanted = problem.heights.flat[sites]
        lacking = wanted - wanted.mean() - displaced(force)
        operator: Any = LinearOperator((sites.size,) * 2, lambda values: displaced(near(values)), dtype=float)
        fewest, most = TUNING.directions
        kept = min(max(fewest, min(most, int(TUNING.memory / sites.size))), sites.size)
        correction, _ = gmres(
            operator, lacking, rtol=self.reduction, restart=kept, maxiter=TUNING.most_restarts
        )
        self.force = np.zeros(self.in_contact.shape)
        self.force.flat[sites] = force + near(correction)

    def at_contacts(self, spectrum: Spectrum | Modes, sites: NDArray[np.intp], values: Field) -> Field:
        """An operator between values at the contacts, without the mean of its result."""
        whole = np.zeros(self.in_contact.shape)
        whole.flat[sites] = values
        there = self.problem.lattice.apply(spectrum, whole).flat[sites]
        return np.asarray(there - there.mean())

    def surface_and_wrong(self) -> tuple[Field, Mask]:
        """The surface under the forces, contacts in tension and free sites that penetrate."""
        problem, touching = self.problem, self.in_contact
        u = problem.displacement(self.force)
        u += float((problem.heights[touching] - u[touching]).mean())
        tension = TUNING.rounding * problem.load / np.count_nonzero(touching)
        penetration = TUNING.rounding * float(np.ptp(u))
        wrong = np.where(touching, self.force < -tension, u < problem.heights - penetration)
        return u, wrong

    def exchange(self, wrong: Mask, number: int) -> None:
        """Exchange all wrong sites; without new records ever fewer of them, in the end only the last."""
        self.revisions += 1
        if number < self.record:
            self.record, self.patience = number, TUNING.patience
        elif self.patience:
            self.patience -= 1
        else:
            self.record, self.patience = number, TUNING.patience
            self.share /= 1 if self.most > TUNING.digits else 2
            self.most = max(self.most / 10, TUNING.digits)
        changed = self.share * number / np.count_nonzero(self.in_contact)
        self.reduction = min(max(TUNING.reduction_per_change * changed, TUNING.digits), self.most)
        if self.share < 1:
            wrong = self.some(np.flatnonzero(wrong), self.share)
        self.in_contact = self.in_contact ^ wrong

    def some(self, wrong: NDArray[np.intp], share: float) -> Mask:
        """A random share of the wrong sites, or the last."""
        some = self.random.random(wrong.size) < share if share * wrong.size > 1 else wrong == wrong[-1]
        exchanged = np.zeros(self.in_contact.shape, dtype=bool)
        exchanged.flat[wrong[some]] = True
        return exchanged

    def published(self) -> State:
        """The state with u = h in contact, and the forces of that surface."""
        problem, touching = self.problem, self.in_contact
        u = np.where(touching, problem.heights, np.maximum(self.u, problem.heights))
        force = problem.force(u)
        residual = RIGID.violation(force, touching, None, problem.load / touching.size)
        force = RIGID.admit(force, touching, problem.load)
        return State(problem, u, force, touching, residual, self.products, self.revisions)
