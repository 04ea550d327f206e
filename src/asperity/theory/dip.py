r"""The dip that a point load makes around it, and how it spreads.

The Fourier modes of the paper's Eq. (uq), brought back to the lattice at r = (n, m):

    k0 u(r, t) / f0 = < cos(n qx) cos(m qy) [1 + (x1/lam) (1 - exp(-x2 z))] / (x1 + lam) >

in the notation of `modes`, the brackets being the mean over the Brillouin zone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.base.checks import Floats, broadcast, floats, line_or_plane
from asperity.errors import InputError
from asperity.theory.modes import creep_numbers, depth, log_scale
from asperity.theory.panels import graded_panels, lattice

Integers = NDArray[np.int64]

# A plane of cosines up to it takes 1e7 nodes.
_FARTHEST = 2000


def displacement(
    offset: ArrayLike, x1: ArrayLike, x2: ArrayLike, viscous: ArrayLike = 0.0, dimension: int = 2
) -> Floats:
    """Depth of the surface beside a point load that is constant since x2 = 0, k0 u(r, t)/f0.

    Parameters
    ----------
    offset
        Integers: sites from the load, shape (..., dimension), each at most 2000; on the line also one
        integer.

    Returns
    -------
    ndarray
        Shape of `offset` without its last axis, broadcast against the other arguments. `compliance` at offset
        0. Accurate to 1e-13 of the depth under the load. The cost grows with the square of the largest offset
        (in the plane), and with the number of different (x1, x2, viscous).
    """
    dimension = line_or_plane(dimension)
    sites = _sites(offset, dimension)
    first, time, r = creep_numbers(x1, x2, viscous)
    index = np.arange(sites[..., 0].size, dtype=np.float64).reshape(sites.shape[:-1])
    first, time, r, index = broadcast(x1=first, x2=time, viscous=r, offset=index)
    if first.size == 0:
        return np.zeros(first.shape)
    panels = graded_panels(lattice, dimension, log_scale(first, time, r), int(sites.max()))
    # Points with the same numbers share the depths of modes, sites with the same component the cosines.
    numbers, where = np.unique(np.stack([a.ravel() for a in (first, time, r)]), axis=1, return_inverse=True)
    components, which = np.unique(sites, return_inverse=True)
    table = np.zeros((numbers.shape[1], *(components.size,) * dimension))
    for panel in panels:
        cosines = [
            w * np.cos(np.multiply.outer(components, q)) for q, w in zip(panel.q, panel.weight, strict=True)
        ]
        for row, point in zip(table, numbers.T, strict=True):
            total = depth(panel.lam, *point)
            for factor in cosines:  # each contracts the first axis and appends its own
                total = np.tensordot(total, factor, axes=(0, 1))
            row += total
    entries = which.reshape(-1, dimension)[index.ravel().astype(np.int64)]
    return np.asarray(table[(where, *entries.T)].reshape(first.shape))[()]


def _sites(offset: ArrayLike, dimension: int) -> Integers:
    """Absolute values, shape (..., dimension): depths are even in each component."""
    floats("offset", offset, expected="integers")  # what cannot be an array of numbers is refused there
    array = np.asarray(offset)
    if dimension == 1 and array.ndim == 0:
        array = array[None]
    if array.ndim == 0 or array.shape[-1] != dimension or array.dtype.kind not in "iu":
        raise InputError(
            "offset",
            expected=f"integers of shape (..., {dimension})",
            got=f"{array.dtype} of shape {array.shape}",
            advice="(1, 0) in the plane, 1 or np.arange(9)[:, None] on the line",
        )
    sites = np.abs(array.astype(np.int64))
    if sites.size and sites.max() > _FARTHEST:
        raise InputError("offset", expected=f"at most {_FARTHEST} sites along an axis", got=int(sites.max()))
    return sites
