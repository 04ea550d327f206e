"""PETSc: SNESVI, reduced-space semismooth Newton, on the assembled five-point operator.

It knows no load control: on the lattice it is told the separation (``Problem.separation``); the relaxed
state needs none. ``tolerance`` bounds the norm of the forces off contact, relative to the mean contact force.
"""

import os
import sys
from pathlib import Path

import numpy as np

# Debian links its petsc4py through an alternative that minimal systems leave out.
sys.path += sorted(map(str, Path("/usr/lib/petscdir").glob("*/*/lib/python3/dist-packages")))
import petsc4py

petsc4py.init([sys.argv[0], *os.environ.get("PETSC_BENCH_OPTIONS", "").split()])

from petsc4py import PETSc  # noqa: E402
from problem import Answer, Problem, Watch  # noqa: E402

VERSION = "PETSc " + ".".join(map(str, PETSc.Sys.getVersion()))
KINDS = ("lattice", "relaxed")


def solve(problem: Problem, tolerance: float) -> Answer:
    heights, shape = problem.heights, problem.heights.shape
    spring = problem.law.k1 if problem.law.kind == "lattice" else 0.0
    matrix = _operator(shape, problem.law.k0, spring)
    pull = -problem.mean_force if spring == 0 else spring * float(problem.separation)
    lower, upper, u = (matrix.createVecRight() for _ in range(3))
    lower.setArray(heights.ravel())
    upper.set(PETSc.INFINITY)
    level = np.sort(heights, axis=None)[-heights.size // 20]
    u.setArray(np.maximum(heights, level).ravel())

    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.setType("vinewtonrsls")

    def force(_snes, x, out):
        matrix.mult(x, out)
        out.shift(-pull)

    snes.setFunction(force, matrix.createVecLeft())
    snes.setJacobian(lambda *_: None, matrix)
    snes.setVariableBounds(lower, upper)
    mean_contact_force = problem.mean_force / 0.05
    snes.setTolerances(rtol=0.0, atol=tolerance * mean_contact_force, stol=0.0, max_it=500)
    ksp = snes.getKSP()
    ksp.setType("cg")
    ksp.setTolerances(rtol=1e-2 if problem.law.kind == "lattice" else 1e-1, max_it=1000)
    ksp.getPC().setType("icc")
    snes.setFromOptions()
    snes.setSolution(u)
    snes.setUp()
    with Watch() as watch:
        snes.solve(None, u)
    result = u.getArray().reshape(shape).copy()
    note = {"newton": float(snes.getIterationNumber()), "converged": str(snes.getConvergedReason())}
    return Answer(result, result <= heights, snes.getLinearSolveIterations(), watch, note)


def _operator(shape, k0, k1):
    """k0 times minus the periodic Laplacian, plus k1, in rows of five."""
    index = np.arange(shape[0] * shape[1], dtype=np.int32).reshape(shape)
    neighbors = [np.roll(index, step, axis) for axis in (0, 1) for step in (1, -1)]
    columns = np.stack([index, *neighbors], axis=-1).reshape(-1, 5)
    values = np.broadcast_to(np.array([4 * k0 + k1, -k0, -k0, -k0, -k0]), columns.shape)
    order = np.argsort(columns, axis=1)
    columns = np.take_along_axis(columns, order, axis=1)
    values = np.take_along_axis(values, order, axis=1)
    starts = np.arange(0, columns.size + 1, 5, dtype=np.int32)
    matrix = PETSc.Mat().createAIJ(
        (index.size, index.size), csr=(starts, columns.ravel(), values.ravel()), comm=PETSc.COMM_SELF
    )
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    return matrix
