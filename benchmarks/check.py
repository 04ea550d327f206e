"""Judge what a solver hands back by operators that no solver uses.

On the lattice the force is a sum over the four neighbors (`numpy.roll`); on the half-space it is evaluated
by complex transforms of `numpy.fft`, which no solver here calls. In a step of creep, u - u0 solves an
equation that is checked by the same sums over neighbors. With free edges the displacement is evaluated
from the forces, by complex transforms of Love's closed form on twice the sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from peers.problem import Law, Problem

Field = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Verdict:
    """How well the fields obey contact mechanics.

    ``residual`` is the largest force off contact or pull in contact over the mean contact force, after the
    surface is put on the heights where it is said to touch and above them elsewhere. ``penetration`` is by
    how much it lay below the heights before that, over their rms; ``load_error`` is the relative error of the
    sum of the forces in contact.
    """

    residual: float
    penetration: float
    load_error: float
    contact_fraction: float


def minus_laplacian(u: Field) -> Field:
    """Sum over the four neighbors of u minus theirs."""
    neighbors = np.roll(u, 1, 0) + np.roll(u, -1, 0) + np.roll(u, 1, 1) + np.roll(u, -1, 1)
    return 4 * u - neighbors


def half_space_force(u: Field, modulus: float, spacing: Sequence[float] = (1.0, 1.0)) -> Field:
    """Pressure on an elastic half-space with periodic displacement u: modulus |q| / 2 on every mode."""
    axes = (np.fft.fftfreq(n, d) for n, d in zip(u.shape, spacing, strict=True))
    q = 2 * np.pi * np.hypot(*np.meshgrid(*axes, indexing="ij"))
    return np.fft.ifft2(modulus * q / 2 * np.fft.fft2(u)).real


def step_memory(u: Field, law: Law) -> Field:
    """Return w that solves w + tau k1 R (minus the Laplacian of w) = u; raise if it does not."""
    ratio = law.tau * law.k1 * law.R
    waves = [2 - 2 * np.cos(2 * np.pi * np.fft.fftfreq(n)) for n in u.shape]
    w = np.fft.ifft2(np.fft.fft2(u) / (1 + ratio * (waves[0][:, None] + waves[1]))).real
    error = float(np.abs(w + ratio * minus_laplacian(w) - u).max())
    if error > 1e-10 * max(1.0, ratio) * float(np.abs(u).max()):
        raise ArithmeticError(f"the step's equation is off by {error:.1e}")
    return w


def force_of(problem: Problem, u: Field) -> Field:
    """Contact force on every site: the restoring force of u about its mean, plus the load's share."""
    law, shape = problem.law, u - u.mean()
    if law.kind == "half-space":
        pressure = half_space_force(shape, law.modulus, problem.spacing or (1.0, 1.0))
        return pressure * problem.cell + problem.mean_force
    spring = {"lattice": law.k1, "step": law.k1, "relaxed": 0.0}[law.kind]
    pulled = step_memory(shape, law) if law.kind == "step" else shape
    return law.k0 * minus_laplacian(shape) + spring * pulled + problem.mean_force


def free_displacement(force: Field, modulus: float) -> Field:
    """Displacement of a half-space by forces on square pixels of side 1, and none beyond (Love 1929)."""
    n, m = force.shape
    y, x = np.meshgrid(np.arange(-n, n + 1) - 0.5, np.arange(-m, m + 1) - 0.5, indexing="ij")
    corner = x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))
    kernel = np.diff(np.diff(corner, axis=0), axis=1) / (np.pi * modulus)
    padded = np.zeros(kernel.shape)
    padded[:n, :m] = force
    return np.fft.ifft2(np.fft.fft2(np.fft.ifftshift(kernel)) * np.fft.fft2(padded)).real[:n, :m]


def judge_forces(problem: Problem, force: Field, in_contact: Mask) -> Verdict:
    """Judge forces with free edges: errors of the gap count as forces, by the shortest wave's stiffness."""
    gap = free_displacement(force, problem.law.modulus) - problem.heights
    gap -= gap[in_contact].mean()
    stiffest, mean_force = np.pi * problem.law.modulus / np.sqrt(2), problem.load / int(in_contact.sum())
    worst = max(float(np.abs(gap[in_contact]).max()), -float(gap.min())) * stiffest
    return Verdict(
        residual=max(worst, -float(force.min()), float(np.abs(force[~in_contact]).max())) / mean_force,
        penetration=max(0.0, -float(gap.min())) / float(problem.heights.std()),
        load_error=abs(float(force.sum()) / problem.load - 1),
        contact_fraction=float(in_contact.mean()),
    )


def judge(problem: Problem, u: Field, in_contact: Mask, force: Field | None = None) -> Verdict:
    """Judge a surface, known up to a constant, and the sites that it is said to touch."""
    heights = problem.heights
    if not in_contact.any():
        return Verdict(np.inf, np.inf, 1.0, 0.0)
    if problem.law.kind == "free half-space":
        assert force is not None
        return judge_forces(problem, force, in_contact)
    gap = u - heights
    gap = gap - gap[in_contact].mean()
    settled = np.where(in_contact, heights, heights + np.maximum(gap, 0.0))
    force = force_of(problem, settled)
    touching = force[in_contact]
    worst = max(float(np.abs(force[~in_contact]).max(initial=0.0)), -float(touching.min()))
    return Verdict(
        residual=worst / (problem.load / int(in_contact.sum())),
        penetration=max(0.0, -float(gap.min())) / float(heights.std()),
        load_error=abs(float(touching.sum()) / problem.load - 1),
        contact_fraction=float(in_contact.mean()),
    )
