"""NuMPI: constrained conjugate gradients with restart (Polonsky and Keer) on the contact forces.

Load control through ``mean_val``. The displacement is a convolution by pyFFTW, the fastest transform at hand.
``tolerance`` bounds the gap in contact (gtol), relative to `Problem.small_gap`. The relaxed state is left to
`numpi_stencil`: this formulation takes thousands of iterations there.
"""

import NuMPI
import numpy as np
from NuMPI.Optimization.CCGWithRestart import constrained_conjugate_gradients_with_restart
from problem import Answer, Problem, Watch, convolution

KINDS = ("lattice", "step", "half-space")
VERSION = f"NuMPI {NuMPI.__version__}"


def solve(problem: Problem, tolerance: float) -> Answer:
    heights, shape = problem.heights, problem.heights.shape
    displacement = convolution(problem)
    start = np.full(shape, problem.mean_force) if problem.start is None else problem.start

    def gap(force):
        return 0.0, (displacement(force.reshape(shape)) - heights).ravel()

    def product(direction):
        return displacement(direction.reshape(shape)).ravel()

    with Watch() as watch:
        found = constrained_conjugate_gradients_with_restart(
            gap,
            product,
            x0=start,
            mean_val=float(problem.mean_force),
            gtol=tolerance * problem.small_gap(),
            maxiter=20000,
        )
    force = found.x.reshape(shape)
    return Answer(displacement(force), force > 0, found.nit, watch)
