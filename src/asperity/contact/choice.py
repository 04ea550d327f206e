"""Which solver a system gets: the one asked for, or the usual one."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from asperity.base import checks
from asperity.contact.active_set import ActiveSet
from asperity.contact.adhesive import solved_with_adhesion
from asperity.contact.lattice_creep import LatticeCreep
from asperity.contact.local_creep import ByLaw
from asperity.contact.multigrid import Multigrid
from asperity.contact.problem import Accuracy, ContactProblem, ContactSolver, Guess, Solution
from asperity.contact.series_creep import SeriesCreep
from asperity.contact.system import System
from asperity.errors import InputError


def local_solver(system: System) -> ByLaw:
    """What solves implicit steps of a local law of creep."""
    mechanics = system.mechanics
    law, springs = mechanics.law, mechanics.solid.springs
    assert law is not None
    if springs is not None:
        return LatticeCreep(springs, law, mechanics.lattice, system.heights, mechanics.interface)
    whole = mechanics.spectra.permanent + mechanics.spectra.creeping[0]
    of_site = mechanics.stressed_area, mechanics.lattice, system.heights, mechanics.interface
    return SeriesCreep(whole, law, *of_site, mechanics.creeping_share)


def chosen_solver(solver: ContactSolver | None, system: System) -> ContactSolver:
    """The solver asked for, or the usual one: `Multigrid` where neighbors say all there is to say."""
    if solver is None:
        return Multigrid() if Multigrid.suits(system.mechanics) else ActiveSet()
    if isinstance(solver, type) or not callable(getattr(solver, "solve", None)):
        got = checks.kind_of(solver)
        raise InputError(
            "solver", expected="an object that solves", got=got, advice="solver=asperity.Multigrid()"
        )
    return solver


def solved(
    solver: ContactSolver, problem: ContactProblem, guess: Guess | None, accuracy: Accuracy
) -> Solution:
    """What a solver finds, with adhesion; `InputError` for what is no surface above the heights."""
    solution, heights = solved_with_adhesion(solver, problem, guess, accuracy), problem.heights
    fields: list[Any] = [getattr(solution, name, None) for name in ("u", "in_contact")]
    facts = [(np.shape(field), str(getattr(field, "dtype", ""))) for field in fields]
    expected, got = "a Solution", ""
    if facts != [(heights.shape, "float64"), (heights.shape, "bool")]:
        expected = f"a Solution with u, float64, and in_contact, bool, of shape {heights.shape}"
        got = f"{checks.kind_of(solution)} with {' and '.join(f'{kind} {shape}' for shape, kind in facts)}"
    elif not math.isfinite(float(solution.u.sum())):
        got = "u that is not finite"
    elif not (problem.interface.yields or (solution.u >= heights).all()):
        got = "u below the heights, which do not yield"
    if got:
        raise InputError("solver", expected=expected, got=got, advice="solver=asperity.ActiveSet()")
    return solution
