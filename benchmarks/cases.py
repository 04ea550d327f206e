"""The cases of the side-by-side table: surface, law, load and state, each repeatable from this file alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import synthetic
from numpy.typing import NDArray
from peers.problem import Law

SURFACES: dict[str, Callable[[int], NDArray[np.float64]]] = {
    "white": synthetic.white,
    "self-affine": synthetic.self_affine,
}


@dataclass(frozen=True)
class Case:
    """One row of the table.

    ``state`` is "instantaneous", "relaxed" (reached from the instantaneous contact) or "step" (a warm
    implicit step of creep). ``mean_force`` is the load per site and ``rms`` the width of the heights.
    Cases that are not ``quick`` run with ``--all`` only.
    """

    name: str
    surface: str
    n: int
    law: Law
    mean_force: float
    rms: float = 1.0
    state: str = "instantaneous"
    quick: bool = True

    def heights(self) -> NDArray[np.float64]:
        """Make the surface."""
        return self.rms * SURFACES[self.surface](self.n)

    @property
    def load(self) -> float:
        """Normal load, the sum of the contact forces."""
        return self.mean_force * self.n * self.n


def _lattice(n: int, surface: str, k1: float, mean_force: float) -> Case:
    return Case(f"lattice-{n}-{surface}-{k1:g}", surface, n, Law("lattice", k1=k1), mean_force)


# Loads (in units of k0 times the rms height, per site) were found once by a secant search with
# asperity.press until the contact fraction was within 1 % of the round numbers on the right.
LATTICE = [
    _lattice(512, "white", 0.1, 0.0498),  # 4.9 %
    _lattice(512, "self-affine", 0.1, 0.0123),  # 4.8 %
    _lattice(512, "self-affine", 0.01, 0.00802),  # 4.1 %
    _lattice(1024, "white", 0.1, 0.0498),  # 4.9 %
    _lattice(1024, "self-affine", 0.1, 0.00364),  # 2.3 %
]

# The relaxed state does not depend on k1: the two self-affine rows of 512 differ in their load alone.
RELAXED = [
    Case(
        case.name.replace("lattice", "relaxed"),
        case.surface,
        case.n,
        Law("relaxed", k1=case.law.k1),
        case.mean_force,
        state="relaxed",
        quick=case.n == 512 and case.surface == "white",
    )
    for case in LATTICE
]

# Pressed with 0.0021 of the contact modulus per site; the rms height, in spacings, was found likewise.
MEAN_PRESSURE = 0.0021
HALF_SPACE_RMS = {
    256: 0.217,  # 5.9 %
    512: 0.386,  # 5.0 %
    1024: 0.682,  # 4.6 %
    2048: 1.173,  # 4.4 %
    4096: 2.02,  # 4.4 %
    8192: 3.48,  # 4.3 %
}
HALF_SPACE = [
    Case(
        f"half-space-{n}{name}",
        "self-affine",
        n,
        Law("half-space"),
        MEAN_PRESSURE,
        rms=higher * HALF_SPACE_RMS[n],
        quick=n == 512,
    )
    for name, higher in (("", 1), ("-light", 20))  # light: 0.29, 0.25 and 0.22 %
    for n in (512, 1024, 2048)
]

FREE = [
    replace(case, name=f"free-{case.name}", law=Law("free half-space"), quick=False) for case in HALF_SPACE
]

STEP = [Case("step-1024", "white", 1024, Law("lattice", k1=3.0), 0.05, state="step")]
STEP_FROM, STEP_TO, STEP_TAU = 10.0, 100.0, 0.5
"""Asperity ages from the first time to the second (unit 1 / (k0 R); contact grows from 4.5 to 5.2 %), and
every contact problem on the way is a warm step. Peers do one of them: an implicit Euler step of the duration
that a stage has at the first time (measured: 14 steps a decade, stages of 0.29 of a step), from the forces
there."""

CASES: tuple[Case, ...] = (*LATTICE, *RELAXED, *HALF_SPACE, *FREE, *STEP)
CURVES = {
    "curve-200": ("springs", 200),
    "curve-1024": ("springs", 1024),
    "curve-line-256": ("line", 256),
    "curve-k0-zero-256": ("k0_zero", 256),
    "curve-spike-256": ("spike", 256),
    "curve-half-space-512": ("half_space", 512),
    "curve-half-space-march-512": ("half_space_march", 512),
}
