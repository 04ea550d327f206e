r"""Primal-dual active set (semismooth Newton) with preconditioned conjugate gradients.

The sites are split into contacts, where u = xi, and free sites, where S u = b is solved by conjugate
gradients. Then contacts that pull (r < 0) are released and free sites that penetrate (u < xi) become
contacts, until neither is left (M. Hintermueller, K. Ito, K. Kunisch, SIAM J. Optim. 13, 865 (2002),
DOI 10.1137/S1052623401383558). The split is revised long before the linear problem is solved: early
splits are not worth an accurate solution.

The preconditioner on the free sites is the inverse of S + sigma between two masks, with sigma from
`asperity.contact.pinning`: iteration counts then depend neither on the lattice nor on the load.

Exchanging all wrong sites at once is fast but may cycle. After `patience` exchanges that set no new
record for the number of wrong sites, one site (the last) is exchanged at a time until one does; in exact
arithmetic this ends for every positive definite S (J. J. Judice, F. M. Pires, Comput. Oper. Res. 21, 587
(1994), DOI 10.1016/0305-0548(94)90106-6), and sites whose sign is decided by rounding are let be.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.contact.pinning import effective_pinning
from asperity.contact.problem import ContactProblem, Guess, Solution, residual
from asperity.errors import ConvergenceError, InputError
from asperity.lattice import Field, Mask

_ASTRAY = 0.02
"""Largest sum of the forces off contact, relative to tolerance times load: it too must be small."""

_NOTHING = 1e-120
"""Forces below it are none: their squares would vanish."""


@dataclass(frozen=True)
class ActiveSet:
    """The default contact solver; see the module for the method.

    Parameters
    ----------
    reduction
        How far the linear residual falls before the set of contacts is revised.
    max_iterations
        Conjugate-gradient iterations after which the solver gives up.
    patience
        Exchanges of all wrong sites allowed without a new record, before single exchanges begin.
    careful_after
        Revisions of the set after which linear solutions become accurate, records are kept, and sites
        that are wrong by no more than rounding are let be.
    max_revisions
        Revisions of the set after which the solver gives up.
    """

    reduction: float = 0.3
    max_iterations: int = 10_000
    patience: int = 5
    careful_after: int = 60
    max_revisions: int = 10_000

    def __post_init__(self) -> None:
        if not 0 < self.reduction < 1:
            raise InputError("reduction", expected="a number between 0 and 1", got=self.reduction)
        for name in ("max_iterations", "patience", "careful_after", "max_revisions"):
            if not getattr(self, name) >= 0:
                raise InputError(name, expected="a whole number >= 0", got=getattr(self, name))

    def solve(self, problem: ContactProblem, guess: Guess, tolerance: float) -> Solution:
        """Solve the problem from a guess.

        Raises
        ------
        ConvergenceError
            The tolerance was not reached within ``max_iterations``.
        """
        run = _Run(self, problem, guess, tolerance)
        while True:
            run.reduce_residual()
            wrong = run.wrong_sites()
            if wrong.any():
                run.exchange(wrong)
            elif run.converged():
                return run.solution()


class _Run:
    """The state of one solve."""

    def __init__(self, method: ActiveSet, problem: ContactProblem, guess: Guess, tolerance: float) -> None:
        self.method = method
        self.problem = problem
        self.tolerance = tolerance
        self.in_contact = guess.in_contact.copy()
        self.iterations = 0
        self.set_changes = 0
        self.record = problem.lattice.sites + 1
        self.patience = method.patience
        self.pinning = (0.0, 0.0)
        self.start(guess.u)

    def start(self, u: Field) -> None:
        """Begin a linear solve on the present set of contacts."""
        problem, heights = self.problem, self.problem.heights
        self.contacts = int(np.count_nonzero(self.in_contact))
        if self.contacts == 0:
            if problem.load_controlled:  # something must carry the load: the deepest site
                self.in_contact.flat[np.argmax(heights - u)] = True
                self.contacts = 1
            else:
                u = _free_surface(problem)
        self.u = np.where(self.in_contact, heights, u)
        self.free = np.where(self.in_contact, 0.0, 1.0)
        self.evaluate_force()
        self.set_preconditioner()

    def evaluate_force(self) -> None:
        """Evaluate the force afresh and forget the search direction."""
        self.force = self.problem.force(self.u)
        self.set_defect()
        stiffest = float(self.problem.stiffness.max())
        deepest = float(np.abs(self.u).max())
        self.rounding = max(4 * float(np.finfo(float).eps) * stiffest * deepest, _NOTHING)
        self.direction: Field | None = None
        self.slope = 0.0

    def set_preconditioner(self) -> None:
        fraction = max(self.contacts, 1) / self.problem.lattice.sites
        sigma, valid_for = self.pinning
        if not 0.8 < fraction / (valid_for or np.inf) < 1.25:
            sigma = effective_pinning(self.problem.lattice, self.problem.stiffness, fraction)
            self.pinning = (sigma, fraction)
            self.inverse = 1.0 / (self.problem.stiffness + sigma)

    def reduce_residual(self) -> None:
        """Conjugate gradients on the free sites, until the residual has fallen enough."""
        target = self.worst * (1e-8 if self.is_careful() else self.method.reduction)
        while self.worst > target and not self.within_tolerance():
            self.iterate()

    def iterate(self) -> None:
        """One conjugate-gradient iteration."""
        lattice = self.problem.lattice
        if self.iterations >= self.method.max_iterations:
            raise ConvergenceError(
                f"contact solver: residual {residual(self.force, self.in_contact):.1e} after "
                f"{self.iterations} iterations, expected {self.tolerance:.1e}; "
                "try ActiveSet(max_iterations=...) with more, or heights with less dynamic range"
            )
        step = lattice.apply(self.inverse, self.defect)
        step *= self.free
        slope = inner(self.defect, step)
        if self.direction is not None:
            self.direction *= slope / self.slope
            step += self.direction
        stiff_step = lattice.apply(self.problem.stiffness, step)
        length = slope / inner(step, stiff_step)
        self.u += length * step
        stiff_step *= length
        self.force += stiff_step
        self.set_defect()
        self.direction, self.slope = step, slope
        self.iterations += 1

    def set_defect(self) -> None:
        """Forces off contact, which are what is left to do, and the largest of them."""
        self.defect = self.force * self.free
        np.negative(self.defect, out=self.defect)
        self.worst = max(float(self.defect.max()), -float(self.defect.min()))

    def within_tolerance(self) -> bool:
        """Whether the linear problem on the present set of contacts is solved."""
        if self.contacts in (0, self.in_contact.size):  # solved exactly by `start`
            return True
        astray = -float(self.defect.sum())
        load = abs(float(self.force.sum()) - astray)
        if self.worst > max(self.tolerance * load / self.contacts, self.rounding):
            return False
        # Forces off contact are small one by one and, zeroed together, leave the load unchanged.
        return abs(astray) <= max(_ASTRAY * self.tolerance * load, self.rounding * self.defect.size)

    def wrong_sites(self) -> Mask:
        """Contacts that pull and free sites that penetrate."""
        pull = penetration = 0.0
        if self.is_careful():  # rounding decides their sign: exchanged, they might come back for ever
            pull = self.rounding
            penetration = self.rounding / float(self.problem.stiffness.max())
        return np.where(self.in_contact, self.force < -pull, self.u < self.problem.heights - penetration)

    def is_careful(self) -> bool:
        """Whether so many revisions have been made that something may be going round in circles."""
        return self.set_changes > self.method.careful_after

    def exchange(self, wrong: Mask) -> None:
        """Move wrong sites to the other side, all at once or, to break a cycle, only the last."""
        self.set_changes += 1
        if self.set_changes > self.method.max_revisions:
            raise ConvergenceError(
                f"contact solver: {self.set_changes - 1} revisions of the set of contacts did not settle it; "
                "try a slightly different load"
            )
        if self.is_careful():
            count = int(np.count_nonzero(wrong))
            if count < self.record:
                self.record, self.patience = count, self.method.patience
            elif self.patience > 0:
                self.patience -= 1
            else:
                last = int(np.flatnonzero(wrong)[-1])
                wrong = np.zeros_like(wrong)
                wrong.flat[last] = True
        self.in_contact ^= wrong
        self.start(self.u)

    def converged(self) -> bool:
        """Whether the force, evaluated afresh, is within tolerance and has the right sign."""
        if not self.within_tolerance():
            return False
        self.evaluate_force()
        return self.within_tolerance() and not self.wrong_sites().any()

    def solution(self) -> Solution:
        return Solution(
            u=self.u,
            in_contact=self.in_contact,
            force=self.force,
            residual=residual(self.force, self.in_contact),
            iterations=self.iterations,
            set_changes=self.set_changes,
        )


def _free_surface(problem: ContactProblem) -> Field:
    """Surface that touches nothing: one division; flat where the pull is, to the last digit."""
    modes = problem.pull / problem.stiffness
    if not modes.flat[1:].any():
        return np.full(problem.lattice.shape, modes.flat[0].real / problem.lattice.sites)
    return problem.lattice.backward(modes)


def inner(a: Field, b: Field) -> float:
    """Inner product of two fields.

    Not `numpy.vdot`: threads of the linear-algebra library gain nothing on so little work, wait for
    each other on a busy machine, and make the last digits depend on their number.
    """
    return float(np.einsum("i,i->", a.ravel(), b.ravel()))
