r"""Active set with unsymmetric linear problems: the contact of steady sliding.

In contact u = h for forces p that vanish elsewhere. With the mean over the contacts projected out, which
frees the load and the distance of the bodies, GMRES solves

    P C P p = P h

(Y. Saad, M. H. Schultz, SIAM J. Sci. Stat. Comput. 7, 856 (1986), DOI 10.1137/0907058). 1 / abs(C)
preconditions it; 1 / C is the solution in full contact, but stalls where the solid is almost a fluid. Then
contacts in tension are released and free sites that penetrate become contacts, all at once, as in
`asperity.contact.active_set`. Where the number of wrong sites sets no new record, the linear problems are
solved more accurately. If that does not help, the loss grows by steps from none: without loss C is symmetric,
and each step starts from the contacts of the one before. There the half of the sites that are most wrong is
exchanged, then a quarter, and so on. The symmetric part of C is positive definite, so there is one solution,
and single exchanges reach it (J. J. Judice, F. M. Pires, Comput. Oper. Res. 21, 587 (1994), DOI
10.1016/0305-0548(94)90106-6).

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

    losses: tuple[float, ...] = (0.0, 0.25, 0.5, 0.75, 1.0)
    """Shares of the loss, where contacts go round in circles at once."""

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
        force, touching = np.where(guess.in_contact, problem.elastic.force(guess.u), 0.0), guess.in_contact
    else:
        force, touching = start.force, start.in_contact
    run = _Run(problem, force, touching, at_once=True)
    state: State | None = run.state()
    for loss in TUNING.losses if state is None else ():
        run = _Run(problem.with_loss(loss), force, touching, run.products)
        if (state := run.state()) is not None:
            force, touching = state.force, state.in_contact
    assert state is not None
    return state


class _Run:
    """One solve."""

    def __init__(
        self, problem: Sliding, force: Field, in_contact: Mask, products: int = 0, *, at_once: bool = False
    ) -> None:
        self.problem, self.force, self.in_contact = problem, force, in_contact
        self.products, self.at_once = products, at_once
        self.most = self.reduction = TUNING.reduction
        self.patience = TUNING.patience
        self.record, self.share = in_contact.size + 1, 1.0
        self.stiffness_of_site = problem.lattice.mean_over_modes(np.abs(problem.stiffness))

    def state(self) -> State | None:
        """Revise the contacts and correct the forces until both are right; None in circles, if at once."""
        while self.share == 1 or not self.at_once:
            self.correct()
            wrong = self.find_wrong()
            if number := int(np.count_nonzero(wrong)):
                self.check_products(number)
                self.exchange(wrong, number)
                continue
            state = self.published()
            if state.residual <= max(TOLERANCE, self.rounding_of(state)):
                return state
            self.check_products(0)
            self.reduction = max(TUNING.digits, 0.1 * TOLERANCE / state.residual)
        return None

    def check_products(self, number: int) -> None:
        """Give up after too many products."""
        if self.products > TUNING.most_products:
            raise ConvergenceError(
                f"steady sliding: {number} sites on the wrong side and residual "
                f"{self.published().residual:.1e} after {self.products} products, expected {TOLERANCE:.0e}; "
                "try more speeds per decade"
            )

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

    def find_wrong(self) -> Field:
        """The surface under the forces; and how wrong sites are, over the mean force, 0 where they are right.

        A contact is wrong by its tension, a free site by the force that would lift the surface off it.
        """
        problem, touching = self.problem, self.in_contact
        self.u = problem.displacement(self.force)
        self.u += float((problem.heights[touching] - self.u[touching]).mean())
        mean = problem.load / np.count_nonzero(touching)
        penetration = problem.heights - self.u
        slack = TUNING.rounding * float(np.ptp(self.u))
        lifted = np.where(penetration > slack, penetration, 0.0) * self.stiffness_of_site
        wrong = np.where(touching, -self.force, lifted) / mean
        return np.where(wrong > TUNING.rounding, wrong, 0.0)

    def exchange(self, wrong: Field, number: int) -> None:
        """Exchange all wrong sites; without new records those that are most wrong."""
        if number < self.record:
            self.record, self.patience = number, TUNING.patience
        elif self.patience:
            self.patience -= 1
        else:
            self.record, self.patience = number, TUNING.patience
            self.share /= 1 if self.most > TUNING.digits else 2
            self.most = max(self.most / 10, TUNING.digits)
        some = max(1, int(self.share * number))
        changed = some / np.count_nonzero(self.in_contact)
        self.reduction = min(max(TUNING.reduction_per_change * changed, TUNING.digits), self.most)
        exchanged = np.argpartition(wrong, -some, axis=None)[-some:]
        self.in_contact = self.in_contact.copy()
        self.in_contact.flat[exchanged] ^= True

    def rounding_of(self, state: State) -> float:
        """Residual below which rounding of the surface hides it."""
        stiffest, scale = float(np.abs(self.problem.stiffness).max()), self.problem.load
        finest = 4 * float(np.finfo(float).eps) * stiffest * float(np.ptp(state.u))
        return finest * np.count_nonzero(state.in_contact) / scale

    def published(self) -> State:
        """The state with u = h in contact, and the forces of that surface."""
        problem, touching = self.problem, self.in_contact
        u = np.where(touching, problem.heights, np.maximum(self.u, problem.heights))
        force = problem.force(u)
        residual = RIGID.violation(force, touching, None, problem.load / touching.size)
        force = RIGID.admit(force, touching, problem.load)
        return State(problem, u, force, touching, residual, self.products)
