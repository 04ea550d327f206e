"""Tamaas: its march of a generalized Maxwell half-space, by implicit Euler steps of one length.

Its model is what never relaxes: E = E* (1 - sum of shares) at nu = 0. A branch is a shear modulus, of which
Young's modulus is 2 (1 + nu) G, so that G = share E* / 2, and its relaxation time. The first solve is the
state one step after the load came.

Tamaas 2.8.0 to 2.9.0 weigh what the branches remember by one over the shear modulus of the model as a bare
number: in pascals, sites under pressure leave the heights from the second step on. So pressures are given
to it in units of that modulus, which makes it 1, and `gap_in_contact` shows whether contacts stay where
they are.
"""

import numpy as np
import tamaas as tm
from problem import THREADS, Problem, Watch

VERSION = f"Tamaas {tm.__version__}"
KINDS = ["half-space"]
tm.set_log_level(tm.LogLevel.error)
tm.initialize(THREADS)


def age(problem: Problem, times: list[float], *, step: float, tolerance: float, in_pascals: bool = False):
    """Forces at some times, whole numbers of steps; the seconds are those of all solves."""
    law, heights = problem.law, problem.heights
    shares, relaxation = np.array(law.branches).T
    permanent = law.modulus * (1 - shares.sum())
    unit = 1.0 if in_pascals else permanent / 2
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, problem.sizes, list(heights.shape))
    model.E, model.nu = permanent / unit, 0.0
    moduli = (law.modulus * shares / 2 / unit).tolist()
    solver = tm.MaxwellViscoelastic(model, heights, tolerance, step, moduli, relaxation.tolist())
    solver.max_iter = 20000
    forces, gaps, means, done = [], [], [], 0
    with Watch() as watch:
        for time in times:
            while done < round(time / step):
                solver.solve(problem.mean_force / problem.cell / unit)
                done += 1
            forces.append(np.array(model.traction).reshape(heights.shape) * unit * problem.cell)
            gaps.append(_gap_in_contact(model, heights))
            means.append(_mean_gap(model, heights))
    numbers = {"seconds": watch.seconds, "cpu_seconds": watch.cpu_seconds, "steps": done}
    return {"force": np.array(forces)}, {**numbers, "gap_in_contact": gaps, "mean_gap": means}


def _mean_gap(model, heights) -> float:
    """Mean distance of the surfaces, m."""
    pressed = np.array(model.traction).reshape(heights.shape) > 0
    gap = np.array(model.displacement).reshape(heights.shape) - heights
    return float(gap.mean() - gap[pressed].mean())


def _gap_in_contact(model, heights) -> float:
    """Largest distance from the heights of a site under pressure, over the rms height."""
    pressed = np.array(model.traction).reshape(heights.shape) > 0
    gap = (np.array(model.displacement).reshape(heights.shape) - heights)[pressed]
    return float(np.abs(gap - gap.mean()).max() / heights.std())
