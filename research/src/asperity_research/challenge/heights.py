"""Heights of the reference problems, made by a rule that any language repeats bit for bit.

Random numbers are those of SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014, DOI
10.1145/2660193.2660195): output number k = 1, 2, ... of a seed is mix(seed + k g) in 64 bits, with
g = 0x9E3779B97F4A7C15 and

    mix(z):  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9,  z = (z ^ z >> 27) * 0x94D049BB133111EB,  z ^ z >> 31.

The normal number of a site is the sum of the twelve 16-bit parts of three outputs, less 393210, over 65536:
mean 0, variance 1. Sites are counted row by row.

A surface of waves begins with ``grid`` x ``grid`` such numbers. An octave halves the spacing, by the
subdivision of a uniform cubic B-spline along the rows, then along the columns,

    c'[2i] = (c[i-1] + 6 c[i] + c[i+1]) / 8,        c'[2i+1] = (c[i] + c[i+1]) / 2,

and adds ratio^octave times new numbers. After the last octave the spline is fixed: further halvings add
nothing, and the heights are its values at the sites, (c[i-1] + 4 c[i] + c[i+1]) / 6 along each axis. So the
surface is known between the sites, and a finer lattice holds the sites of a coarser one. (D. Saupe's
successive random additions, in *The Science of Fractal Images*, Springer 1988, with a spline.)
"""

import numpy as np
from numpy.typing import NDArray

from asperity_research.arrays import Field

_GOLDEN = 0x9E3779B97F4A7C15
_MIX = ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB))


def outputs(seed: int, first: int, count: int) -> NDArray[np.uint64]:
    """Outputs number ``first``, ``first + 1``, ... of SplitMix64, counted from 1, shape ``(count,)``."""
    with np.errstate(over="ignore"):
        z = np.uint64(seed) + np.arange(first, first + count, dtype=np.uint64) * np.uint64(_GOLDEN)
        for shift, factor in _MIX:
            z = (z ^ (z >> np.uint64(shift))) * np.uint64(factor)
        return z ^ (z >> np.uint64(31))


def normal(seed: int, first: int, sites: int) -> Field:
    """Normal numbers of sites, from output ``first`` on, shape ``(sites, sites)``."""
    parts = outputs(seed, first, 3 * sites * sites).view(np.uint16).reshape(sites, sites, 12)
    sums: Field = parts.sum(axis=-1, dtype=np.float64)
    return (sums - 393210) / 65536


def independent(sites: int, *, seed: int) -> Field:
    """Heights that are independent on all sites, shape ``(sites, sites)``, of mean 0 and variance 1."""
    return normal(seed, 1, sites)


def waves(grid: int, *, octaves: int, ratio: float, halvings: int, seed: int) -> Field:
    """Heights of a spline of several octaves, shape ``(n, n)`` with n = grid 2^(octaves - 1 + halvings).

    Parameters
    ----------
    grid
        Numbers along each axis in the first octave.
    octaves
        How many there are.
    ratio
        Factor from the amplitude of one to that of the next: 2^-H for a Hurst exponent H.
    halvings
        Sites along each axis between two numbers of the last octave, as a power of two.
    seed
        Seed of the numbers.
    """
    coefficients, amplitude, used = normal(seed, 1, grid), 1.0, 3 * grid * grid
    for _ in range(1, octaves):
        coefficients = _halved(coefficients)
        amplitude *= ratio
        sites = len(coefficients)
        coefficients = coefficients + amplitude * normal(seed, used + 1, sites)
        used += 3 * sites * sites
    for _ in range(halvings):
        coefficients = _halved(coefficients)
    for axis in (0, 1):
        before, after = (np.roll(coefficients, by, axis) for by in (1, -1))
        coefficients = (before + 4 * coefficients + after) / 6
    return coefficients


def _halved(coefficients: Field) -> Field:
    """Coefficients of the same spline with half the spacing, along both axes."""
    for axis in (0, 1):
        before, after = (np.roll(coefficients, by, axis) for by in (1, -1))
        finer = np.empty([n * (1 + (a == axis)) for a, n in enumerate(coefficients.shape)])
        even, odd = (slice(None),) * axis + (slice(0, None, 2),), (slice(None),) * axis + (slice(1, None, 2),)
        finer[even] = (before + 6 * coefficients + after) / 8
        finer[odd] = (coefficients + after) / 2
        coefficients = finer
    return coefficients
