"""Tamaas: Polonsky, Keer and Rey on its half-space, whose influence coefficients the lattice overwrites.

``tolerance`` is the tolerance of the solver. Tamaas does not tell how many iterations it did; -1 stands for
that.
"""

import numpy as np
import tamaas as tm
from problem import THREADS, Answer, Problem, Watch

VERSION = f"Tamaas {tm.__version__}"
KINDS = ["lattice", "relaxed", "step", "half-space"]
tm.set_log_level(tm.LogLevel.error)
tm.initialize(THREADS)


def solve(problem: Problem, tolerance: float) -> Answer:
    shape = list(problem.heights.shape)
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, problem.sizes, shape)
    model.E, model.nu = problem.law.modulus, 0.0
    solver = tm.PolonskyKeerRey(model, problem.heights, tolerance)
    solver.max_iter = 20000
    influence = model.operators["westergaard_neumann"]["influence"]
    if problem.law.kind != "half-space":
        influence[...] = problem.compliance().reshape(influence.shape)
    if problem.start is not None:
        model.traction[...] = problem.start / problem.cell
    with Watch() as watch:
        error = solver.solve(problem.mean_force / problem.cell)
    force = np.array(model.traction).reshape(problem.heights.shape) * problem.cell
    u = np.fft.irfft2(problem.compliance() * np.fft.rfft2(force), s=force.shape)
    return Answer(u, force > 0, -1, watch, {"error": error}, force)
