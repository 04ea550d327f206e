"""ContactMechanics: its own Polonsky-Keer solver on its own half-space, whose kernel the lattice overwrites.

``tolerance`` bounds the penetration (pentol), relative to `Problem.small_gap`, and the change of the offset
(thermotol).
"""

import ContactMechanics
import numpy as np
from ContactMechanics import PeriodicFFTElasticHalfSpace
from ContactMechanics.Optimization.ConstrainedConjugateGradients import constrained_conjugate_gradients
from problem import Answer, Problem, Watch
from SurfaceTopography import Topography

VERSION = f"ContactMechanics {ContactMechanics.__version__}"
KINDS = ["lattice", "relaxed", "step", "half-space"]


def solve(problem: Problem, tolerance: float) -> Answer:
    heights, shape = problem.heights, problem.heights.shape
    substrate = PeriodicFFTElasticHalfSpace(shape, problem.law.modulus, problem.sizes, stiffness_q0=0.0)
    if problem.law.kind != "half-space":
        # Its half spectrum runs along the first axis, that of numpy along the last.
        compliance = np.zeros(substrate.greens_function.shape)
        rows, columns = compliance.shape
        full = np.concatenate([problem.compliance(), problem.compliance()[:, -2:0:-1]], axis=1)
        compliance[...] = full[:rows, :columns]
        substrate.greens_function = compliance
    topography = Topography(heights, physical_sizes=tuple(problem.sizes))
    start = np.full(shape, problem.mean_force) if problem.start is None else problem.start
    with Watch() as watch:
        found = constrained_conjugate_gradients(
            substrate,
            topography,
            external_force=problem.load,
            initial_forces=-start,
            pentol=tolerance * problem.small_gap(),
            forcetol=tolerance * problem.mean_force,
            thermotol=min(1e-6, tolerance),
            maxiter=20000,
        )
    u, force = np.array(found.x), np.array(found.jac)
    return Answer(u, force > 0, found.nit, watch, {"converged": str(found.success)}, force)
