"""One solver after another: the only way in which one takes over from another; the solution says which."""

from __future__ import annotations

from dataclasses import dataclass, replace

from asperity.contact.problem import Accuracy, ContactProblem, ContactSolver, Guess, Solution
from asperity.errors import ConvergenceError


class UnsolvedError(ConvergenceError):
    """A solver has not solved a problem; another may go on from where it got."""

    def __init__(self, guess: Guess | None, iterations: int = 0) -> None:
        super().__init__("contact solver: cycles did not converge; try solver=ActiveSet()")
        self.guess, self.iterations = guess, iterations


@dataclass(frozen=True)
class First:
    """Solvers in the order in which they are tried."""

    solvers: tuple[ContactSolver, ...]

    def solve(self, problem: ContactProblem, guess: Guess | None, accuracy: Accuracy) -> Solution:
        """Solve by the first solver that can; each goes on from where the one before got."""
        *others, last = self.solvers
        spent = 0
        for solver in others:
            try:
                solution = solver.solve(problem, guess, accuracy)
            except UnsolvedError as left:
                guess, spent = left.guess, spent + left.iterations
            else:
                return replace(solution, iterations=spent + solution.iterations, solver=type(solver).__name__)
        solution = last.solve(problem, guess, accuracy)
        return replace(solution, iterations=spent + solution.iterations, solver=type(last).__name__)
