"""Sums of fields, and forces and energies of the lattice of springs, by compiled loops."""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact import kernels
from asperity.lattice import Field, Mask, Modes
from asperity.solids import SpringConstants


def combined(a: float, x: Field, b: float, y: Field) -> Field:
    """Sum a x + b y, in one pass through memory."""
    known = [np.atleast_2d(np.ascontiguousarray(field)) for field in (x, y)]
    total = np.empty_like(known[0])
    kernels.combine(a, known[0], b, known[1], total, 0, len(total))
    return total.reshape(x.shape)


def lattice_force(u: Field, stretch: Field, k0: float, k1: float) -> Field:
    """Force k0 L u + k1 w at every site, L minus the Laplacian."""
    force = np.empty_like(u)
    kernels.lattice_force(u, stretch, k0, k1, force, 0, len(u))
    return force


def bond_energy(u: Field) -> float:
    """Sum over the bonds of the squared difference between neighbors."""
    rows = np.empty(len(u))
    kernels.bond_energy(u, rows, 0, len(u))
    return float(rows.sum())


def damped_power(
    modes: Modes, shape: tuple[int, ...], springs: SpringConstants, tau: float, touching: float
) -> float:
    """Mean over all modes of a field of |a mode / (1 + tau z_c) + (1 - a) mode / (1 + tau z)|^2.

    ``touching`` is the fraction a of the sites in contact, where a mode decays at the rate z_c = M C; off
    contact z = M C H / (H + C). The rate of a mode is neither: the mean of both dampings errs on the safe
    side, where the damping by the mean rate doubled errors at clustered contacts.
    """
    y, x = (4.0 * np.sin(np.pi * np.arange(n) / n).astype(np.float32) ** 2 for n in shape)
    x = x[: modes.shape[1]]
    k1 = springs.k1
    numbers = (k1 / springs.k0, touching, tau * k1 * springs.R, tau * k1 * springs.R_viscous)
    rows = np.empty((len(modes), 3))
    kernel: Any = kernels.damped_power
    kernel(modes, y, x, *map(np.float32, numbers), rows, 0, len(modes))
    whole, first, last = map(float, rows.sum(axis=0))
    return (2.0 * whole - first - (last if shape[1] % 2 == 0 else 0.0)) / (shape[0] * shape[1])


def extremes(force: Field, in_contact: Mask) -> tuple[float, float, float, float]:
    """Largest force off contact, largest tension in contact, the sum of the forces there, and contacts."""
    rows, touching = np.atleast_2d(force), np.atleast_2d(in_contact)
    found = np.empty((len(rows), 4))
    kernels.extremes(rows, touching, found, 0, len(rows))
    worst, tension = found[:, 0].max(), -found[:, 1].min()
    load, contacts = found[:, 2:].sum(axis=0)
    return float(worst), float(tension), float(load), float(contacts)


def balanced(u: Field, w: Field, heights: Field, k0: float, k1: float, total: float | None) -> Field:
    """Stretch with which u is in equilibrium: w in contact, where it is no tension, or scaled to a total."""
    heights = np.ascontiguousarray(heights)
    out, rows = np.empty_like(u), np.empty(len(u))
    kernels.balance(u, w, heights, k0, k1, out, rows, 0, len(u))
    carried = float(rows.sum())
    scale = total / carried if total is not None and carried > 0 and total > 0 else 1.0
    kernels.carry(u, w, heights, scale, out, 0, len(u))
    return out
