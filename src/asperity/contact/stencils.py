"""Sums of fields, and forces and energies of the lattice of springs, by compiled loops.

A lattice is periodic, or its edges are mirrors: the site beyond an edge is the image of the site at the edge.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from asperity.contact.compiled import compiled, inlined
from asperity.lattice import Field, Mask, Modes
from asperity.solids import SpringConstants


def lattice_force(u: Field, stretch: Field, k0: float, k1: float, *, mirrored: bool = False) -> Field:
    """Force k0 L u + k1 w at every site, L minus the Laplacian."""
    force = np.empty_like(u)
    forces(u, stretch, k0, k1, mirrored, force)
    return force


@inlined
def force_row(a: float, x: Field, b: float, y: Field, i: int, mirrored: bool, out: Field) -> None:
    """Row i of a L x + b y."""
    ny, nx = x.shape
    first, last = (0, ny - 1) if mirrored else (ny - 1, 0)
    up, down, row, other = x[i - 1 if i > 0 else first], x[i + 1 if i < ny - 1 else last], x[i], y[i]
    for j in range(1, nx - 1):
        out[j] = a * (4.0 * row[j] - (up[j] + down[j] + row[j - 1] + row[j + 1])) + b * other[j]
    first, last = (0, nx - 1) if mirrored else (nx - 1, 0)
    for j in (0, nx - 1):
        left, right = j - 1 if j > 0 else first, j + 1 if j < nx - 1 else last
        out[j] = a * (4.0 * row[j] - (up[j] + down[j] + row[left] + row[right])) + b * other[j]


@compiled
def forces(u: Field, w: Field, k0: float, k1: float, mirrored: bool, out: Field) -> None:
    """Force k0 L u + k1 w."""
    for i in range(u.shape[0]):
        force_row(k0, u, k1, w, i, mirrored, out[i])


def bond_energy(u: Field, *, mirrored: bool = False) -> float:
    """Sum over the bonds of the squared difference between neighbors."""
    rows = np.empty(len(u))
    bond_energies(u, mirrored, rows)
    return float(rows.sum())


@compiled
def bond_energies(u: Field, mirrored: bool, out: Field) -> None:
    """Sum of the squared differences between neighbors, by rows."""
    ny, nx = u.shape
    for i in range(ny):
        row, down = u[i], u[i + 1 if i < ny - 1 else (i if mirrored else 0)]
        total = 0.0 if mirrored else (row[0] - row[nx - 1]) ** 2
        for j in range(nx - 1):
            total += (row[j + 1] - row[j]) ** 2
        for j in range(nx):
            total += (down[j] - row[j]) ** 2
        out[i] = total


def damped_power(
    modes: Modes,
    shape: tuple[int, ...],
    springs: SpringConstants,
    tau: float,
    touching: float,
    *,
    mirrored: bool = False,
) -> float:
    """Mean over all modes of a field of |a mode / (1 + tau z_c) + (1 - a) mode / (1 + tau z)|^2.

    ``touching`` is the fraction a of the sites in contact, where a mode decays at the rate z_c = M C; off
    contact z = M C H / (H + C). The rate of a mode is neither: the mean of both dampings errs on the safe
    side, where the damping by the mean rate doubled errors at clustered contacts.
    """
    period = 2 if mirrored else 1
    y, x = (4.0 * np.sin(np.pi * np.arange(n) / (period * n)).astype(np.float32) ** 2 for n in shape)
    x = x[: modes.shape[1]]
    k1 = springs.k1
    numbers = (k1 / springs.k0, touching, tau * k1 * springs.R, tau * k1 * springs.R_viscous)
    bed, share, spreading, dragging = map(np.float32, numbers)
    rows = np.empty((len(modes), 3))
    damped_powers(modes.astype(np.complex64, copy=False), y, x, bed, share, spreading, dragging, rows)
    whole, first, last = map(float, rows.sum(axis=0))
    sites = shape[0] * shape[1]
    if mirrored:
        return whole / sites
    return (2.0 * whole - first - (last if shape[1] % 2 == 0 else 0.0)) / sites


@compiled
def damped_powers(
    modes: Any, y: Any, x: Any, bed: Any, touching: Any, spreading: Any, dragging: Any, out: Field
) -> None:
    """Sums by rows of squared modes, each times a / (1 + z) + (1 - a) / (1 + z lam / (lam + bed)).

    z = spreading lam + dragging, a = ``touching``, lam = y + x, the eigenvalue of L. Modes that stand for
    their conjugates too count twice; ``out[i, 1]`` is the part of the first column, ``out[i, 2]`` that of the
    last.
    """
    for i in range(modes.shape[0]):
        value = np.float32(0.0)
        for j in range(x.shape[0]):
            lam = y[i] + x[j]
            rate = spreading * lam + dragging
            free = (lam + bed) / (lam + bed + rate * lam)
            damping = touching / (np.float32(1.0) + rate) + (np.float32(1.0) - touching) * free
            power = (modes[i, j].real ** 2 + modes[i, j].imag ** 2) * damping * damping
            value += power
            if j == 0:
                out[i, 1] = power
            out[i, 2] = power
        out[i, 0] = value


def extremes(force: Field, in_contact: Mask) -> tuple[float, float, float, float]:
    """Largest force off contact, largest tension in contact, the sum of the forces there, and contacts."""
    rows, touching = np.atleast_2d(force), np.atleast_2d(in_contact)
    found = np.empty((len(rows), 4))
    extremes_of_rows(rows, touching, found)
    worst, tension = found[:, 0].max(), -found[:, 1].min()
    load, contacts = found[:, 2:].sum(axis=0)
    return float(worst), float(tension), float(load), float(contacts)


@compiled
def extremes_of_rows(force: Field, in_contact: Mask, out: Field) -> None:
    """By rows: the largest size off contact, the least in contact (at most 0), the sum there, contacts."""
    for i in range(force.shape[0]):
        worst = least = total = count = 0.0
        row, touching = force[i], in_contact[i]
        for j in range(row.shape[0]):
            carried = row[j] if touching[j] else 0.0
            total += carried
            count += 1.0 if touching[j] else 0.0
            least = carried if carried < least else least
            free = abs(row[j] - carried)
            worst = free if free > worst else worst
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = worst, least, total, count


def balanced(
    u: Field,
    w: Field,
    heights: Field,
    k0: float,
    k1: float,
    total: float | None,
    *,
    mirrored: bool = False,
    largest: float = math.inf,
) -> Field:
    """Stretch with which u is in equilibrium: w in contact, where it is no tension, or scaled to a total.

    Forces over k1 above the ``largest`` are it, and the others bear what is left of the total.
    """
    heights = np.ascontiguousarray(heights)
    out, rows = np.empty_like(u), np.empty(len(u))
    balance(u, w, heights, k0, k1, mirrored, out, rows)
    carried, scale = float(rows.sum()), 1.0
    if math.isfinite(largest):
        w = out + bounded(np.where(u <= heights, np.maximum(w - out, 0.0), 0.0), total, largest)
    elif total is not None and carried > 0 and total > 0:
        scale = total / carried
    carry(u, w, heights, scale, out)
    return out


def bounded(forces: Field, total: float | None, largest: float) -> Field:
    """Forces that are at most the largest; the smaller ones are scaled so that all add up to a total."""
    forces = np.minimum(forces, largest)
    below = forces < largest
    while total is not None and (carried := float(forces[below].sum())) > 0:
        rest = total - largest * (forces.size - below.sum()) if math.isfinite(largest) else total
        forces[below] *= max(rest, 0.0) / carried
        above = below & (forces > largest)
        if not above.any():
            break
        forces[above] = largest
        below &= ~above
    return forces


def combined(first: Field, *terms: tuple[float, Field]) -> Field:
    """A field plus up to three others times their weights."""
    (a, y), (b, z), (c, t) = (*terms, *(3 - len(terms)) * ((0.0, first),))
    out = np.empty(first.shape)
    combine(first.ravel(), y.ravel(), z.ravel(), t.ravel(), a, b, c, out.reshape(-1))
    return out


def extrapolated(latest: Field, *terms: tuple[float, Field]) -> Field:
    """A field plus its differences from up to three others times weights; exact where all are the same."""
    (a, y), (b, z), (c, t) = (*terms, *(3 - len(terms)) * ((0.0, latest),))
    out = np.empty(latest.shape)
    extrapolate(latest.ravel(), y.ravel(), z.ravel(), t.ravel(), a, b, c, out.reshape(-1))
    return out


@compiled
def combine(x: Field, y: Field, z: Field, t: Field, a: float, b: float, c: float, out: Field) -> None:
    """X + a y + b z + c t."""
    for i in range(x.shape[0]):
        out[i] = x[i] + a * y[i] + b * z[i] + c * t[i]


@compiled
def extrapolate(x: Field, y: Field, z: Field, t: Field, a: float, b: float, c: float, out: Field) -> None:
    """X + a (y - x) + b (z - x) + c (t - x)."""
    for i in range(x.shape[0]):
        out[i] = x[i] + (a * (y[i] - x[i]) + b * (z[i] - x[i]) + c * (t[i] - x[i]))


@compiled
def balance(
    u: Field, w: Field, heights: Field, k0: float, k1: float, mirrored: bool, out: Field, carried: Field
) -> None:
    """Stretch -k0 L u / k1 off contact; ``carried``: row sums of force / k1 in contact, without tension."""
    ny, nx = u.shape
    for i in range(ny):
        row = out[i]
        force_row(-k0 / k1, u, 0.0, u, i, mirrored, row)
        total = 0.0
        for j in range(nx):
            force = max(w[i, j] - row[j], 0.0) if u[i, j] <= heights[i, j] else 0.0
            total += force
        carried[i] = total


@compiled
def carry(u: Field, w: Field, heights: Field, scale: float, out: Field) -> None:
    """Add ``scale`` times the forces that `balance` summed to the stretch."""
    for i in range(u.shape[0]):
        row = out[i]
        for j in range(u.shape[1]):
            force = max(w[i, j] - row[j], 0.0) if u[i, j] <= heights[i, j] else 0.0
            row[j] += scale * force


@compiled
def linearize(
    u: Field,
    w: Field,
    anchors: Field,
    velocity: Field,
    own: Field,
    bend: Field,
    spread: float,
    lagging: float,
    beside: float,
    position: float,
    tau: float,
    mirrored: bool,
    lacking: Field,
    out: Field,
) -> None:
    """What an implicit step by a law lacks at stretches w, and what sites do about it one by one.

    It lacks u - v - position - lagging w - spread L w - tau velocity; a site makes up for it, its neighbors
    as they are, by that over ``own``, which is lagging + beside + the slope of the law. ``bend`` is how far
    a stretch moves until that slope is another; one row may stand for all. ``out`` by rows: these changes,
    their squares, those of what the tangent leaves of them, and what a shift of 1 would change.
    """
    for i in range(u.shape[0]):
        row = lacking[i]
        force_row(spread, w, lagging, w, i, mirrored, row)
        bends = bend[i if bend.shape[0] > 1 else 0]
        alone = squares = left = response = 0.0
        for j in range(u.shape[1]):
            row[j] = u[i, j] - anchors[i, j] - position - row[j] - tau * velocity[i, j]
            yielding = 1.0 / own[i, j]
            change = row[j] * yielding
            error = (own[i, j] - lagging - beside) * change * change / (own[i, j] * bends[j] + 1e-300)
            error = min(error, abs(change))
            alone += change
            squares += change * change
            left += error * error
            response += yielding
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = alone, squares, left, response
