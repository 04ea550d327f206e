"""NuMPI: constrained conjugate gradients without restart (Bugnicourt et al.) on the surface itself.

On the lattice the operator is a sum over neighbors (numpy slices), and the load enters the gradient: no
transforms. Of NuMPI's two algorithms and two formulations this pair is the fastest on the relaxed state,
where the convolution of `numpi_ccgr` needs thousands of iterations. ``tolerance`` bounds the forces off
contact (gtol), relative to the mean contact force at a contact fraction of 0.05.
"""

import NuMPI
import numpy as np
from NuMPI.Optimization.CCGWithoutRestart import constrained_conjugate_gradients
from problem import Answer, Problem, Watch

VERSION = f"NuMPI {NuMPI.__version__}"
KINDS = ("lattice", "relaxed")


def solve(problem: Problem, tolerance: float) -> Answer:
    heights, law = problem.heights, problem.law
    spring = law.k1 if law.kind == "lattice" else 0.0

    def stiffness(flat):
        u = flat.reshape(heights.shape)
        out = 4 * law.k0 * u
        for axis in (0, 1):
            ahead, behind = np.moveaxis(u, axis, 0), np.moveaxis(out, axis, 0)
            behind[1:] -= law.k0 * ahead[:-1]
            behind[0] -= law.k0 * ahead[-1]
            behind[:-1] -= law.k0 * ahead[1:]
            behind[-1] -= law.k0 * ahead[0]
        if spring:
            out += spring * (u - u.mean())
        return out.ravel()

    level = np.sort(heights, axis=None)[-heights.size // 20]
    with Watch() as watch:
        found = constrained_conjugate_gradients(
            lambda flat: (0.0, stiffness(flat) + problem.mean_force),
            stiffness,
            x0=np.maximum(heights, level).ravel(),
            bounds=heights.ravel(),
            gtol=tolerance * problem.mean_force / 0.05,
            maxiter=20000,
        )
    u = found.x.reshape(heights.shape)
    return Answer(u, u <= heights, found.nit, watch)
