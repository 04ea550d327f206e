"""The multigrid solver: for the lattice of springs in two dimensions."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from asperity.base import checks
from asperity.contact.active_set import ActiveSet
from asperity.contact.asperities import level_of_overlap
from asperity.contact.mechanics import Mechanics
from asperity.contact.multigrid.loops import Sites
from asperity.contact.multigrid.one_field import OneField
from asperity.contact.multigrid.pins import compliance
from asperity.contact.multigrid.two_fields import TwoFields
from asperity.contact.problem import Accuracy, ContactProblem, Guess, Solution, SpringProblem
from asperity.errors import InputError
from asperity.solids import Springs


@dataclass(frozen=True)
class Tuning:
    """Numbers that decide which solids are solved so."""

    most_ratio: float = 1e6
    """Largest k1/k0 and k0/k1, beyond which one kind of spring hardly matters."""

    max_cycles: int = 40
    """Cycles after which another solver takes over."""


TUNING = Tuning()


@dataclass(frozen=True, kw_only=True)
class Multigrid:
    """Multigrid on neighbor differences, the default for the lattice of springs in two dimensions.

    The work per site does not depend on the size of the lattice; see
    `asperity.contact.multigrid.one_field` for the method. Where cycles do not converge, which dense
    and clustered contacts under long steps can cause, `ActiveSet` finishes from where they got.

    Parameters
    ----------
    max_cycles
        Cycles after which `ActiveSet` takes over.
    """

    max_cycles: int = field(default_factory=lambda: TUNING.max_cycles)

    def __post_init__(self) -> None:
        object.__setattr__(self, "max_cycles", checks.integer("max_cycles", self.max_cycles, least=0))

    @staticmethod
    def suits(mechanics: Mechanics) -> bool:
        """Whether this solid on this lattice can be solved so."""
        springs = mechanics.springs
        if springs is None or min(mechanics.lattice.shape) < 4:
            return False
        return springs.k0 == 0 or 1 / TUNING.most_ratio <= springs.k1 / springs.k0 <= TUNING.most_ratio

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # what is not finite does not converge
    def solve(self, problem: ContactProblem, guess: Guess | None, accuracy: Accuracy) -> Solution:
        """Solve the problem from a guess, or from a flat surface; the solution says who solved it.

        Raises
        ------
        InputError
            The solid is not the lattice of springs in two dimensions.
        ConvergenceError
            Neither cycles nor `ActiveSet` reached the tolerance.
        """
        outcome = self._by_cycles(problem, guess, accuracy)
        if isinstance(outcome, Solution):
            return replace(outcome, solver="Cycles")
        guess, spent = outcome
        solution = ActiveSet().solve(problem, guess, accuracy)
        return replace(solution, iterations=spent + solution.iterations, solver="ActiveSet")

    def work_on(self, mechanics: Mechanics) -> TwoFields:
        """Work space for steps of creep on a lattice."""
        rows, columns = mechanics.lattice.shape
        return TwoFields(Sites(rows, columns, mechanics.lattice.reflecting))

    def _by_cycles(
        self, problem: ContactProblem, guess: Guess | None, accuracy: Accuracy
    ) -> Solution | tuple[Guess | None, int]:
        """Solve by cycles; else a guess for another solver, and the cycles spent."""
        stated = problem.in_neighbors()
        if stated is None:
            raise InputError(
                "solver",
                expected="springs in two dimensions, k1 > 0 and no hardness, for Multigrid",
                got="another solid or lattice",
                advice="solver=ActiveSet()",
            )
        springs, heights = stated.springs, stated.heights
        if springs.creep and not springs.relaxed:
            return guess, 0  # steps of creep are `asperity.aging.spring_steps`
        if springs.k0 == 0:
            return _independent(stated)
        if guess is None or not guess.u.any():  # a surface that nothing has pressed yet tells no length
            guess = Guess(np.broadcast_to(_level(stated), heights.shape))
        if stated.load is None and (springs.relaxed or (guess.u > heights).all()):
            # A stiff mean, which truncated corrections move; a free surface, which is one division.
            return guess, 0
        u = np.maximum(guess.u, heights)
        rows, columns = heights.shape
        work = OneField(Sites(rows, columns, stated.mirrored))
        done, uniform, cycles = work.solve(stated, u, accuracy.residual, self.max_cycles)
        if done:
            stretch = np.broadcast_to(uniform / springs.k1, u.shape) if springs.relaxed else None
            return Solution(u, u <= heights, cycles, 0, stretch)
        return Guess(u) if np.isfinite(u).all() else None, cycles


def _independent(problem: SpringProblem) -> Solution:
    """The contact of springs that no others join, in a step in which nothing spreads: each for itself."""
    heights, anchors = problem.heights, problem.anchors
    overlap, level = heights - anchors, 0.0
    if problem.load is not None:
        highest = float(overlap.max())
        wanted = problem.load / problem.springs.k1
        level = highest + level_of_overlap(overlap - highest, wanted)
        for _ in range(2):  # to the last digit
            touching = overlap > level
            level = (float(overlap[touching].sum()) - wanted) / max(int(np.count_nonzero(touching)), 1)
    u = np.where(overlap > level, heights, anchors + level)
    return Solution(u, u <= heights, 1, 0)


def _level(problem: SpringProblem) -> float:
    """Level at which independent asperities carry the load; the mean anchor under separation control."""
    if problem.load is None:
        return float(np.mean(problem.anchors))
    k0 = problem.springs.k0
    softness = compliance(Springs(1.0, problem.springs.k1 / k0), 0, 0.0) / k0
    return level_of_overlap(problem.heights, problem.load * softness)
