"""slippy: the Polonsky-Keer function of its core on its planned pyFFTW convolution; the kernel is a callable.

The convolution is slippy's own and takes any spectrum. ``tolerance`` is eps_0, the relative change of the
forces in an iteration.
"""

import numpy as np
import slippy
from problem import THREADS, Answer, Problem, Watch
from slippy.core import plan_convolve, polonsky_and_keer

VERSION = f"slippy {slippy.__version__}"
KINDS = ["lattice", "relaxed", "step", "half-space"]
slippy.CORES = THREADS


def solve(problem: Problem, tolerance: float) -> Answer:
    heights = problem.heights
    n, m = heights.shape
    half = problem.compliance()
    kernel = np.concatenate([half, half[:, -2:0:-1]], axis=1)  # slippy wants the redundant half as well
    convolve = plan_convolve(heights, kernel, domain=None, circular=True, fft_im=True)
    count = 0

    def displacement(force):
        nonlocal count
        count += 1
        return convolve(force)

    start = np.ones((n, m)) if problem.start is None else problem.start
    with Watch() as watch:
        # With elements of area 1 / sites its load is a mean, as its starting forces assume.
        failed, force, _ = polonsky_and_keer(
            displacement, start, -heights, problem.mean_force, (1 / n, 1 / m), eps_0=tolerance, max_it=20000
        )
    iterations = count // 2
    return Answer(convolve(force), force > 0, iterations, watch, {"converged": str(not failed)})
