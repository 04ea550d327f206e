"""Asperity, through its public interface; everything that a call does is timed.

Its tolerance is fixed: every state that it returns was solved to 1e-9 and shows its residual.
"""

from functools import lru_cache

import numpy as np
from problem import Answer, Problem, Watch

import asperity as asp

VERSION = f"Asperity {asp.__version__}"


def solve(problem: Problem, tolerance: float) -> Answer:
    del tolerance
    solid = _solid(problem)
    if problem.law.kind == "relaxed":
        before = _pressed(problem)
        with Watch() as watch:
            contact = asp.relax(before)
    else:
        with Watch() as watch:
            contact = asp.press(_surface(problem), solid, load=problem.load)
    note = {"residual": contact.residual, "separation": contact.separation}
    return Answer(contact.u, contact.in_contact, contact.iterations, watch, note, contact.force)


def age(problem: Problem, times: list[float]) -> tuple[dict[str, np.ndarray], dict[str, object]]:
    """Age from the first time to the last, timed; the state at the first is prepared before."""
    before = _aged(problem, times[0]) if times[0] > 0 else _pressed(problem)
    with Watch() as watch:
        data = asp.age(before, [time - times[0] for time in times[1:]]).dataset
    fields = {"u": before.u, "u0": before.u0, "force": before.force, "area": data["area"].values}
    numbers = {
        "seconds": watch.seconds,
        "cpu_seconds": watch.cpu_seconds,
        "steps": int(data["steps"].sum()),
        "rejected": int(data["rejected"].sum()),
        "iterations": int(data["iterations"].sum()),
        "residual": float(data["residual"].max()),
        "contact_fraction": float(data["contact_fraction"][-1]),
    }
    return fields, numbers


@lru_cache(maxsize=1)
def _pressed(problem: Problem) -> asp.Contact:
    return asp.press(_surface(problem), _solid(problem), load=problem.load)


@lru_cache(maxsize=1)
def _aged(problem: Problem, until: float) -> asp.Contact:
    return asp.age(_pressed(problem), [until]).final


def _surface(problem: Problem) -> np.ndarray | asp.surfaces.Surface:
    if problem.law.kind == "free half-space":
        return asp.surfaces.Surface(problem.heights, edges="free")
    if not problem.spacing:
        return problem.heights
    return asp.surfaces.Surface(problem.heights, unit="m", pixel_size=problem.spacing, length_unit="m")


def _solid(problem: Problem) -> asp.solids.Solid:
    law = problem.law
    if "half-space" not in law.kind:
        return asp.solids.spring_lattice(k0=law.k0, k1=law.k1, R=law.R)
    return asp.solids.half_space(modulus=law.modulus, branches=[tuple(branch) for branch in law.branches])
