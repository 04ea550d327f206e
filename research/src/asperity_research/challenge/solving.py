"""A reference problem solved by the engine's verbs, at any tolerance, with any solver, on a finer lattice."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

import asperity as asp
from asperity_research.arrays import Field
from asperity_research.challenge.posing import Problem, problem


def solve(
    name: str | Problem,
    *,
    rtol: float | None = None,
    solver: asp.ActiveSet | asp.Multigrid | None = None,
    halvings: int = 0,
    scan: str | Path | None = None,
    exact: bool = True,
) -> Mapping[str, Field]:
    """Solve a reference problem.

    Parameters
    ----------
    name
        Which one.
    rtol
        Relative tolerance of the time steps; by default the usual one. See `asperity.age`, also for the
        others.
    solver
        How to solve the contact problems.
    halvings
        How often to halve the distance between the sites, where the surface is known between them.
    scan
        The file of the measured problem.
    exact
        Whether to use the exact contact of a separable solid.

    Returns
    -------
    mapping of arrays
        The table that is asked, by the headings of its columns.

    Raises
    ------
    InputError
        There is no such problem, or its scan is missing.
    ConvergenceError
        A contact problem was not solved.
    """
    asked = name if isinstance(name, Problem) else problem(name)
    config = asked.config
    contact = asp.press(
        asked.surface(halvings=halvings, scan=scan),
        config.solid.build(),
        **config.contact.table,
        solver=solver,
    )
    times = np.asarray(config.aging.times, dtype=np.float64)
    tolerance = config.aging.rtol if rtol is None else rtol
    dataset = asp.age(
        contact, times, protocol=asked.legs or None, rtol=tolerance, solver=solver, exact=exact
    ).dataset
    recorded = dataset["time"].values
    rows = np.searchsorted(recorded, times, side="right") - 1
    return {
        column.heading: dataset[column.reading or column.name].values[rows].astype(np.float64)
        for column in (asked.abscissa, *asked.asked)
    }
