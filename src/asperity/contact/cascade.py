"""A start from nothing: the same contact on coarser and coarser lattices, solved from the coarsest up.

A coarser lattice has every second site along each axis, with the height there, and the long waves of the
spectrum and of the right-hand side. Its surface, interpolated, is good at all waves but the shortest. These
yield like single sites under the interpolated forces, which decides what touches. On the next lattice some
five revisions of the set of contacts remain, at any load and size.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from asperity.contact.arrays import inverse
from asperity.contact.asperities import level_of_overlap
from asperity.contact.problem import Accuracy, ContactSolver, Guess, SpectralProblem
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Lattice


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    coarsest: int = 64
    """Lattices of so many sites along each axis are not made coarser."""

    residual: float = 0.1
    """Residual on coarser lattices."""


TUNING = Tuning()


def cold_start(problem: SpectralProblem, solver: ContactSolver) -> Guess:
    """Guess the solution of a problem by solving it on a coarser lattice, where there is one."""
    shape = problem.lattice.shape
    if any(n % 2 for n in shape) or problem.lattice.sites <= TUNING.coarsest ** len(shape):
        return independent_asperities(problem)
    coarser = _coarsen(problem)
    try:
        start = solver.solve(coarser, cold_start(coarser, solver), Accuracy(TUNING.residual))
    except ConvergenceError:  # a bad start costs time, not accuracy
        return independent_asperities(problem)
    u = interpolated(start.u)
    lowered = interpolated(np.where(start.in_contact, coarser.force(start.u), 0.0))
    lowered /= problem.lattice.mean_over_modes(problem.stiffness)
    touching = u - problem.heights <= lowered
    return Guess(u, touching)


def independent_asperities(problem: SpectralProblem) -> Guess:
    """Guess the contacts as if the asperities were independent."""
    lattice, stiffness = problem.lattice, problem.stiffness
    if problem.load is None:
        level = float(problem.rhs.flat[0].real / stiffness.flat[0]) / lattice.sites
    else:
        level = level_of_overlap(problem.heights, problem.load * lattice.mean_over_modes(inverse(stiffness)))
    return Guess(np.maximum(problem.heights, level), problem.heights >= level)


def _coarsen(problem: SpectralProblem) -> SpectralProblem:
    """The problem on every second site."""
    fine = problem.lattice
    heights = problem.heights[(slice(None, None, 2),) * fine.dimension]
    coarse = Lattice(heights.shape, tuple(2 * length for length in fine.spacing), fine.edges)
    rhs = fine.long_waves(problem.rhs, coarse) * (coarse.sites / fine.sites)
    stiffness = fine.long_waves(problem.stiffness, coarse)
    return replace(problem, lattice=coarse, heights=heights, stiffness=stiffness, rhs=rhs)


def interpolated(field: Field) -> Field:
    """The field on twice the sites along each axis, midway between neighbors where they are new."""
    for axis in range(field.ndim):
        between = (field + np.roll(field, -1, axis)) / 2
        shape = list(field.shape)
        shape[axis] *= 2
        field = np.stack((field, between), axis=axis + 1).reshape(shape)
    return field
