r"""Primal-dual active set (semismooth Newton) in Fourier space, for every spectrum.

The sites are split into contacts, where u = xi, and free sites, where S u = b is solved by conjugate
gradients (`asperity.contact.free_sites`). Then contacts in tension (r < 0) are released and free sites that
penetrate (u < xi) become contacts, until neither is left (M. Hintermueller, K. Ito, K. Kunisch, SIAM J.
Optim. 13, 865 (2002), DOI 10.1137/S1052623401383558). The split is revised before the linear problem is
solved: the more sites a revision moved, the less accurate a solution the next is worth.

A stage of creep may stop as soon as u is as accurate as the step needs: what conjugate gradients leave is
estimated by the preconditioned residual and the last correction.

The linear problems are corrections to a surface whose forces are evaluated in double precision at every
revision, and are themselves solved in single precision, until that no longer helps.

Exchanging all wrong sites at once is fast but may cycle. After some exchanges that set no new
record for the number of wrong sites, one site (the last) is exchanged at a time until one does; in exact
arithmetic this ends for every positive definite S (J. J. Judice, F. M. Pires, Comput. Oper. Res. 21, 587
(1994), DOI 10.1016/0305-0548(94)90106-6), and sites whose sign is decided by rounding are left unchanged.

Where the forces have an upper bound, contacts that exceed it yield: they are free under the bound as an
external force, until the surface comes back to the heights: the same method with three kinds of sites.

Where sites attract each other, revisions of the contacts also take the attraction of the present surface,
once few contacts are wrong. It begins with that of the surface before, and no site is pulled before the
surface has come within the range, so that the contact remembers. Between published states contacts need not
settle, and fronts would lag behind: there the attraction is that of a surface ahead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from asperity.base import checks
from asperity.contact.arrays import inner, largest, library, to_numpy
from asperity.contact.cascade import cold_start
from asperity.contact.contact_sites import solved_on_contacts
from asperity.contact.free_sites import FreeSites
from asperity.contact.problem import (
    Accuracy,
    ContactProblem,
    Guess,
    Solution,
    SpectralProblem,
    mean_by_rounding,
)
from asperity.errors import ConvergenceError, PulledOff
from asperity.lattice import Field, Mask


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    sum_tolerance: float = 0.002
    """Largest sum of the forces off contact, over tolerance times load: it shifts the separation."""

    load_error: float = 1e-5
    """Largest sum of the forces off contact, over the load, where an error of u is allowed."""

    digits: float = 1e-5
    """How far single precision can reduce a residual in one correction, with room to spare."""

    reduction: float = 0.3
    """How far, at least, the linear residual falls before the set of contacts is revised."""

    reduction_per_change: float = 16.0
    """After a revision that moved the fraction x of the contacts, the residual falls to this times x."""

    careful_after: int = 60
    """Revisions after which linear solutions become accurate, records are kept, and sites that are wrong by
    no more than rounding are left unchanged."""

    careful: float = 1e-8
    """Residual of these solutions, over that before."""

    patience: int = 5
    """Exchanges of all wrong sites allowed without a new record, before single exchanges begin."""

    steady: float = 0.02
    """Part of the contacts that may be wrong where the attraction is revised with them."""

    ahead: float = 0.5
    """How far ahead the attraction is where contacts may change still, over the surface's last move."""

    most_revisions: int = 10_000
    """Revisions of the set after which the solver gives up."""


TUNING = Tuning()

_SMALLEST_FORCE = math.sqrt(float(np.finfo(float).tiny))
"""Forces below it count as 0: their squares underflow. In units of the problem."""


@dataclass(frozen=True)
class ActiveSet:
    """The contact solver for every solid; see the module for the method.

    Parameters
    ----------
    max_iterations
        Conjugate-gradient iterations after which the solver gives up.
    arrays
        The array library in which to compute: ``"numpy"``, or the name of another one that follows the
        array API standard and has its transforms: ``"cupy"``, or ``"torch"`` once its default device is
        "cuda". Problems and solutions are numpy arrays in any case.
    """

    max_iterations: int = 10_000
    arrays: str = "numpy"

    knows_adhesion: ClassVar[bool] = True

    def __post_init__(self) -> None:
        most = checks.integer("max_iterations", self.max_iterations, least=0)
        object.__setattr__(self, "max_iterations", most)

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # what is not finite does not converge
    def solve(self, problem: ContactProblem, guess: Guess | None, accuracy: Accuracy) -> Solution:
        """Solve the problem from a guess, or without one through coarser lattices.

        Raises
        ------
        ConvergenceError
            The accuracy was not reached within ``max_iterations``.
        MissingExtraError
            The array library is not installed.
        """
        modes = problem.spectral()
        pull, rounds = modes.first_pull(guess), 0
        known = modes.without_adhesion(pull)
        guess = guess or cold_start(known, self)
        # Where an error is allowed few iterations are left: forces from nothing take no less time.
        # Elsewhere the guess halves the time of a press in which 0.3 % of the sites touch, or fewer.
        if self.arrays == "numpy" and accuracy.error == 0 and not modes.interface.yields:
            guess, rounds = solved_on_contacts(known, guess, accuracy.residual)
        run = _Run(self, modes, guess, accuracy, pull)
        run.iterations = rounds
        while True:
            run.reduce_residual()
            wrong = run.wrong_sites()
            if not (bool(run.xp.any(wrong)) or run.attraction_moves()):
                if run.converged():
                    return run.solution()
            elif run.unimportant(wrong):
                return run.solution()
            else:
                run.exchange(wrong)


class _Run:
    """The state of one solve. Fields are arrays of the library; so are S, b and the heights."""

    def __init__(
        self,
        method: ActiveSet,
        problem: SpectralProblem,
        guess: Guess,
        accuracy: Accuracy,
        pull: Field | None,
    ) -> None:
        self.method, self.problem, self.interface = method, problem, problem.interface
        self.tolerance, self.allowed_error = accuracy.residual, accuracy.error
        self.settled = accuracy.settled
        self.allowed_imbalance = math.inf
        self.xp = xp = library(method.arrays)
        self.stiffness, self.rhs, self.heights = map(
            xp.asarray, (problem.stiffness, problem.rhs, problem.heights)
        )
        self.working_stiffness = xp.zeros(0, dtype=xp.int8)
        # Without wave vector 0: springs of the rigid body may be stiffer than any wave.
        waves = problem.stiffness.flat[min(1, problem.stiffness.size - 1) :]
        self.stiffest = float(waves.max())
        named = guess.in_contact
        touching = guess.u <= problem.heights if named is None else named
        below = named is not None and self.interface.yields and touching & (guess.u < problem.heights)
        self.yielding = xp.asarray(np.broadcast_to(below, touching.shape), copy=True)
        self.in_contact = xp.asarray(touching, copy=True) & ~self.yielding
        law = self.interface.adhesion
        self.strength = law.strength * self.interface.cell if law else 0.0
        self.pull = None if pull is None else xp.asarray(pull)
        self.attracted: Field | None = None
        self.iterations = self.set_changes = self.revisions = 0
        self.record = problem.lattice.sites + 1
        self.patience, self.reduction = TUNING.patience, TUNING.reduction
        self.single = True
        self.start(xp.asarray(guess.u))

    def start(self, u: Field) -> None:
        """Begin on the present set of contacts."""
        xp = self.xp
        load = self.problem.load
        if self.pull is not None and self.interface.parts(load, self.pull):
            raise PulledOff
        if load is not None and not xp.any(self.in_contact):
            # The surface sinks as it is, until the sites that it then yields on carry the load, but for one.
            gap = u - self.heights
            level = xp.sort(xp.reshape(gap, (-1,)))[min(int(load / self.interface.high), u.size - 1)]
            u = u - level
            self.yielding, self.in_contact = gap < level, gap == level
        self.contacts, yielding = (int(xp.count_nonzero(of)) for of in (self.in_contact, self.yielding))
        self.touching = self.contacts + yielding
        self.borne = self.interface.high * yielding if yielding else 0.0
        if yielding:  # accurate forces decide which sites yield, and they do so for good
            self.allowed_error = 0.0
        if self.contacts == 0:
            u = xp.asarray(self.free_surface())
        self.u = xp.where(self.in_contact, self.heights, u)
        self.free_sites: FreeSites | None = None
        self.left_over = math.inf
        self.evaluate_force()

    def free_surface(self) -> Field:
        """Surface without contact, u = b / S; exactly constant where b is nothing but wave vector 0."""
        lattice, rhs = self.problem.lattice, self.problem.rhs
        if self.borne:
            rhs = rhs + lattice.forward(self.interface.high * to_numpy(self.yielding))
        if self.pull is not None:
            rhs = rhs + lattice.forward(to_numpy(self.pull))
        modes = rhs / self.problem.stiffness
        if not modes.flat[1:].any():
            return np.full(lattice.shape, modes.flat[0].real / lattice.sites)
        return lattice.backward(modes)

    def evaluate_force(self) -> None:
        """Evaluate the force afresh, in double precision, and measure it off contact."""
        xp, lattice = self.xp, self.problem.lattice
        modes = lattice.forward(self.u)
        modes *= self.stiffness
        modes -= self.rhs
        self.force: Field = lattice.backward(modes, overwrite=True)
        self.fresh = True
        if self.borne:
            self.force -= self.interface.high * xp.astype(self.yielding, self.force.dtype)
        if self.pull is not None:
            self.force -= self.pull
        indentation = largest(self.u, xp)
        rounding = indentation * float(self.problem.stiffness.flat[0])
        self.force -= mean_by_rounding(self.force, self.in_contact, rounding, xp)
        off_contact = xp.where(self.in_contact, xp.asarray(0.0), self.force)
        self.worst = largest(off_contact, xp)
        if not math.isfinite(self.worst):
            raise ConvergenceError(
                "contact solver: the forces are not finite numbers; try stiffnesses, heights and times of "
                "less different sizes"
            )
        imbalance = float(xp.sum(off_contact))
        self.imbalance = abs(imbalance)
        self.load = abs(float(xp.sum(self.force)) - imbalance) + self.borne
        if self.problem.load is None:  # it is what comes out
            self.allowed_imbalance = TUNING.load_error * self.load
        self.rounding = max(4 * float(np.finfo(float).eps) * self.stiffest * indentation, _SMALLEST_FORCE)

    def reduce_residual(self) -> None:
        """Correct the free sites, until the largest force on them has fallen enough."""
        if not self.fresh:
            self.evaluate_force()
        target = self.worst * (TUNING.careful if self.is_careful() else self.reduction)
        while self.worst > target and not self.within_tolerance():
            before = self.worst
            self.correct(target)
            if self.left_over <= self.allowed_error:
                return
            if self.worst > target and not self.within_tolerance():
                self.evaluate_force()
                # Forces evaluated anew are no less than half: single precision has given all it can.
                self.single = self.single and self.worst <= 0.5 * before

    def correct(self, target: float) -> None:
        """Correct the free sites once; the forces are then a prediction."""
        remaining = self.method.max_iterations - self.iterations
        if remaining <= 0:
            scale = self.load / max(self.touching, 1)
            force, touching = to_numpy(self.force), to_numpy(self.in_contact)
            left_over = self.interface.violation(force, touching, None, scale)
            raise ConvergenceError(
                f"contact solver: residual {left_over:.1e} after "
                f"{self.iterations} iterations, expected {self.tolerance:.1e}; "
                "try ActiveSet(max_iterations=...) with more, or heights with less dynamic range"
            )
        acceptable = max(self.tolerance * self.load / self.touching, self.rounding)
        # What is small already may have to be smaller still, as the sum of many forces moves the load; half
        # of what is acceptable, as forces evaluated anew are not quite those predicted.
        goal = min(TUNING.reduction, max(target, 0.5 * acceptable) / self.worst)
        if self.single:
            goal = max(goal, TUNING.digits)
        allowed = self.allowed_error, self.allowed_imbalance
        correction = self.linear_problem().correct(self.force, self.worst, goal, remaining, allowed)
        self.left_over = correction.left_over
        self.u += correction.displacement
        self.fresh = False
        self.force, self.worst, self.imbalance = correction.force, correction.worst, correction.imbalance
        self.iterations += max(1, correction.iterations)  # so that what rounding stops at once ends as well

    def linear_problem(self) -> FreeSites:
        """The linear problem on the present set of contacts, in the present precision."""
        xp = self.xp
        self.single = self.single and not self.is_careful()
        real = xp.float32 if self.single else xp.float64  # transforms take two thirds of the time in single
        if self.free_sites is None or self.free_sites.stiffness.dtype != real:
            if self.working_stiffness.dtype != real:
                self.working_stiffness = xp.astype(self.stiffness / self.stiffest, real)
            spectra = self.problem.stiffness, self.stiffest, self.working_stiffness
            self.free_sites = FreeSites(self.problem.lattice, *spectra, self.in_contact, xp)
        return self.free_sites

    def within_tolerance(self) -> bool:
        """Whether the linear problem on the present set of contacts is solved."""
        if self.contacts in (0, self.problem.lattice.sites):  # solved exactly by `start`
            return True
        if self.worst > max(self.tolerance * self.load / self.touching, self.rounding):
            return False
        # Forces off contact are small one by one and, zeroed together, leave the load unchanged.
        return self.imbalance <= max(
            TUNING.sum_tolerance * self.tolerance * self.load, self.rounding * self.problem.lattice.sites
        )

    def wrong_sites(self) -> Mask:
        """See `Interface.wrong`."""
        tension = penetration = 0.0
        if self.is_careful():  # rounding decides their sign: exchanged, they might come back for ever
            tension, penetration = self.rounding, self.rounding / self.stiffest
            if self.borne:  # under the load of a whole number of yielding sites one bears what is left
                tension += self.tolerance * self.load * (1 / self.touching + 2 * TUNING.sum_tolerance)
        gap, slack = self.u - self.heights, (tension, penetration)
        return self.interface.wrong(self.force, gap, self.in_contact, self.yielding, slack)

    def is_careful(self) -> bool:
        """Whether so many revisions have been made that something may be going round in circles."""
        return self.revisions > TUNING.careful_after

    def unimportant(self, wrong: Mask) -> bool:
        """Whether u is as accurate as it is to be, although some sites are on the wrong side."""
        behind = self.pull is not None and self.attracted is None
        if self.settled or behind or self.left_over > self.allowed_error:
            return False
        xp, lattice = self.xp, self.problem.lattice
        lifted = self.force / lattice.mean_over_modes(self.problem.stiffness)
        wrong_by = xp.where(self.in_contact, lifted, self.u - self.heights)
        wrong_by = xp.where(wrong, wrong_by, xp.asarray(0.0))
        return math.sqrt(inner(wrong_by, wrong_by, xp) / lattice.sites) <= self.allowed_error

    def exchange(self, wrong: Mask) -> None:
        """Move wrong sites to the other side, all at once or, to break a cycle, only the last."""
        xp = self.xp
        self.set_changes += 1
        if self.set_changes > TUNING.most_revisions:
            advice = "a greater hardness" if self.interface.yields else "a slightly different load"
            raise ConvergenceError(
                f"contact solver: {self.set_changes - 1} revisions of the set of contacts did not settle it; "
                f"try {advice}"
            )
        self.revisions += 1
        count = int(xp.count_nonzero(wrong))
        moved = (count + self.attract(count)) / max(self.contacts, 1)
        self.reduction = min(TUNING.reduction, TUNING.reduction_per_change * moved)
        if self.is_careful():
            self.allowed_error = 0.0
            if count < self.record:
                self.record, self.patience = count, TUNING.patience
            elif self.patience > 0:
                self.patience -= 1
            else:
                last = int(xp.max(xp.nonzero(xp.reshape(wrong, (-1,)))[0]))
                wrong = xp.reshape(xp.arange(wrong.size) == last, wrong.shape)
        above = self.in_contact & (self.force > self.interface.high)
        self.yielding = xp.where(wrong, above, self.yielding)
        self.in_contact ^= wrong
        self.start(self.u)

    def attract(self, wrong: int) -> int:
        """Take the attraction of the surface as it is, if that is near; how many sites this moves."""
        if self.pull is None or wrong > TUNING.steady * self.contacts:
            return 0  # else it is revised with the contacts, in half the time of one after the other
        last, self.attracted = self.attracted, self.xp.asarray(self.u, copy=True)
        ahead = 0.0 if self.settled or last is None else TUNING.ahead * (self.u - last)
        before, self.pull = self.pull, self.attraction(ahead)
        # Another problem: what went round in circles before says nothing about it.
        self.revisions, self.record, self.patience = 0, self.problem.lattice.sites + 1, TUNING.patience
        return int(self.xp.count_nonzero(self.pull != before))

    def attraction(self, ahead: Field | float = 0.0) -> Field:
        """The adhesive force of the present surface, or of one ahead of it."""
        attraction: Field = self.xp.asarray(self.interface.pull(to_numpy(self.u + ahead - self.heights)))
        return attraction

    def attraction_moves(self) -> bool:
        """Whether the adhesive force is not that of the present surface."""
        if self.pull is None:
            return False
        return largest(self.attraction() - self.pull, self.xp) > self.tolerance * self.strength

    def converged(self) -> bool:
        """Whether the force, evaluated afresh, is within tolerance and right, or u accurate enough."""
        self.reduction = TUNING.digits  # the contacts have settled: go all the way
        if self.left_over <= self.allowed_error:
            return True
        if self.fresh or not self.within_tolerance():
            return self.within_tolerance()
        self.evaluate_force()
        return self.within_tolerance() and not bool(self.xp.any(self.wrong_sites()))

    def solution(self) -> Solution:
        # Where an error is allowed, a few free sites may still penetrate.
        u = self.xp.maximum(self.u, self.heights) if self.allowed_error else self.u
        touching = to_numpy(self.in_contact | self.yielding)
        return Solution(to_numpy(u), touching, self.iterations, self.set_changes)
