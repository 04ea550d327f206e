"""ASPHER: nested lattices, preconditioned Polonsky-Keer, in single and then in double precision; its fastest.

Half-spaces, with free edges by exact convolution, on square lattices of 64 times a power of two.
``tolerance`` is the one it certifies. Its hierarchical operator is no faster up to 1024^2, and leaves 1e-4.
"""

from importlib.metadata import version

import aspher
import numpy as np
from problem import Answer, Problem, Watch

VERSION = f"ASPHER {version('aspher')}"
KINDS = ["half-space", "free half-space"]
BACKENDS = {"half-space": "periodic", "free half-space": "fft"}


def solve(problem: Problem, tolerance: float) -> Answer:
    n, _ = problem.heights.shape
    gap = np.ascontiguousarray((problem.heights.max() - problem.heights).ravel())
    with Watch() as watch:
        found = aspher.solve_nested(
            grid_size=n,
            gap=gap,
            p_nominal=problem.mean_force / problem.cell,
            domain_size=problem.sizes[0],
            E_star=problem.law.modulus,
            tol=tolerance,
            backend=BACKENDS[problem.law.kind],
            precision="float_then_double",
            precond_engine="fft",
        )
    force = np.array(found.pressure).reshape(n, n) * problem.cell
    u = force  # of free edges the forces are judged
    if problem.law.kind == "half-space":
        u = np.fft.irfft2(problem.compliance() * np.fft.rfft2(force), s=force.shape)
    note = {"status": str(found.status)}
    return Answer(u, force > 0, found.iterations, watch, note, force)
