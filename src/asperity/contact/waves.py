"""Waves along a direction, and the slope of a field there."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache

import numpy as np

from asperity.lattice import Field, Lattice, Spectrum

Vector = tuple[float, ...]
"""Components along the axes of a lattice."""

_ACROSS = 1e-12  # part of the largest component below which rounding hides that a wave stands still


def unit_vector(lattice: Lattice, sites: Sequence[Fraction | int]) -> Vector:
    """Direction of a vector of sites."""
    vector = [float(n) * length for n, length in zip(sites, lattice.spacing, strict=True)]
    return tuple((np.array(vector) / np.linalg.norm(vector)).tolist())


def waves_along(lattice: Lattice, direction: Vector) -> list[Spectrum]:
    """Wave vectors times a unit vector, radians per length.

    A shortest wave stands for both directions, in which it travels at both frequencies: two cases, or four.
    """
    axes = zip(direction, lattice.shape, strict=True)
    cases = itertools.product(*((1, -1) if part and n % 2 == 0 else (1,) for part, n in axes))
    return [_along(lattice, direction, signs) for signs in cases]


def _along(lattice: Lattice, direction: Vector, signs: Sequence[int]) -> Spectrum:
    """The same, with these signs of the shortest waves of each axis."""
    parts = []
    for angle, side, part, sign in zip(lattice.angles, lattice.spacing, direction, signs, strict=True):
        shortest = np.isclose(np.abs(angle), np.pi)
        parts.append(np.where(shortest, sign * np.abs(angle), angle) * part / side)
    along = np.array(np.broadcast_to(sum(parts), lattice.spectral_shape))
    along[np.abs(along) < _ACROSS * np.abs(along).max()] = 0.0
    return along


def slope_of(along: Sequence[Spectrum]) -> Spectrum:
    """Wave vectors along a direction, 0 for the shortest waves, which have no slope."""
    return np.where(np.ptp(along, axis=0) > 0, 0.0, along[0])


@lru_cache(maxsize=8)
def slope_along(lattice: Lattice, sites: Sequence[Fraction | int]) -> Spectrum:
    """Wave vectors along a vector of sites; see `slope_of`."""
    return slope_of(waves_along(lattice, unit_vector(lattice, sites)))


def friction_of_slopes(lattice: Lattice, slope: Spectrum, heights: Field, u: Field, force: Field) -> float:
    """Force of a profile against its motion: -sum p dh/dx, spectral; the surface u where there is no body."""
    profile = np.where(np.isfinite(heights), heights, u)
    return -float(np.vdot(force, lattice.apply(np.asarray(1j * slope, dtype=complex), profile)))
