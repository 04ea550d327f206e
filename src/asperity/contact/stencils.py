"""Sums of fields, and forces and energies of the lattice of springs.

A lattice is periodic, or its edges are mirrors: the site beyond an edge is the image of the site at the edge.
"""

from __future__ import annotations

import numpy as np

from asperity.contact.arrays import inner
from asperity.contact.compiled import compiled, inlined
from asperity.lattice import Field


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
    changes = [np.diff(u, axis=n) for n in range(u.ndim)]
    if not mirrored:  # beside the others, as a rolled copy would take longer
        changes += [np.diff(u.take([-1, 0], n), axis=n) for n in range(u.ndim)]
    return sum(inner(change, change, np) for change in changes)


def combined(first: Field, *terms: tuple[float, Field]) -> Field:
    """A field plus others times their weights."""
    out = first.copy()
    for weight, field in terms:
        out += weight * field
    return out


def extrapolated(latest: Field, *terms: tuple[float, Field]) -> Field:
    """A field plus its differences from others times weights; exact where all are the same."""
    return combined(latest, *((weight, field - latest) for weight, field in terms))


@compiled
def tangents(
    surface: tuple[Field, Field, Field],
    before: Field,
    tangent: tuple[Field, Field, Field],
    numbers: tuple[float, ...],
    mirrored: bool,
    lacking: Field,
    lag: Field,
    sums: Field,
) -> None:
    """What stretches lack in an implicit step by a local law that is linear about them, and their lags.

    ``tangent``: velocity, slope, and over how much of a stretch the law bends. The last becomes the error of
    the tangent over the square of a change. ``sums``: of what is lacking; of the changes of sites alone, of
    their squares, and of those of their errors; and of what a rise of 1 changes.
    """
    u, w, _ = surface
    velocity, slope, curve = tangent
    k1, spread, lagging, position, tau, most = numbers
    for i in range(u.shape[0]):
        row = lacking[i]
        force_row(spread, w, lagging, w, i, mirrored, row)
        total = changes = squares = errors = rises = 0.0
        for j in range(u.shape[1]):
            row[j] = u[i, j] - before[i, j] - tau * velocity[i, j] - position - row[j]
            rising = tau * k1 * slope[i, j]
            lag[i, j] = min(lagging + rising, most)
            diagonal = lagging + rising + 4.0 * spread
            change = row[j] / diagonal
            curve[i, j] = rising / (diagonal * curve[i, j] + 1e-300)
            error = min(curve[i, j] * change * change, abs(change))
            total += row[j]
            changes += change
            squares += change * change
            errors += error * error
            rises += 1.0 / diagonal
        sums[i, 0], sums[i, 1], sums[i, 2], sums[i, 3], sums[i, 4] = total, changes, squares, errors, rises
