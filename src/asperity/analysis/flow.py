"""The flow through the gap of a contact, as the gap of smooth plates with the same flow.

Reynolds' equation, div(g^3 grad p) = 0, on the pixels by finite volumes: conductors between their middles,
each of two halves in series. The pressure is given on two opposite sides of the scan; the other two are
walls. What touches is closed.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, laplacian
from scipy.sparse.linalg import spsolve

from asperity.lattice import Field

_MOST = 2**15
"""Pixels above which four become one, as time grows faster than their number."""


def hydraulic_gap(gap: Field, aspect: float) -> float:
    """Gap of smooth plates with the same flow along the last axis, in the unit of the gap, shape (n, m).

    `aspect` is the length of a pixel along the first axis over that along the last.
    """
    cubes = (gap / gap.max()) ** 3
    along = across = np.where(cubes > 1e-14, cubes, 0.0)  # the flow through narrower gaps is rounding
    while along.size > _MOST:
        along, across = _halved(along), _halved(across.T).T
    # The sides are two more pixels, 0 and 1, that conduct beyond measure: half a pixel remains to each.
    sides, size = ((0, 0), (1, 1)), along.size + 2
    number = np.pad(np.arange(2, size).reshape(along.shape), sides, constant_values=((0, 0), (0, 1)))
    across, along = np.pad(across, sides), np.pad(along, sides, constant_values=1e30)
    next_to = aspect * _series(along[:, :-1], along[:, 1:])
    below = _series(across[:-1], across[1:]) / aspect
    ends = tuple(np.append(number[:, part], number[part]) for part in (slice(-1), slice(1, None)))
    graph = coo_array((np.append(next_to, below), ends), shape=(size, size)).tocsr()
    graph.eliminate_zeros()
    _, piece = connected_components(graph, directed=False)
    if piece[0] != piece[1]:
        return 0.0
    joined = np.flatnonzero(piece == piece[0])[2:]
    balance: Any = laplacian(graph + graph.T)
    balance = balance.tocsr()[joined]
    into, out = -balance[:, [0, 1]].toarray().T
    flow = out @ spsolve(balance[:, joined].tocsc(), into)
    return float(gap.max()) * math.cbrt(flow * (number.shape[1] - 2) / len(number) / aspect)


def _series(one: Field, other: Field) -> Field:
    return np.asarray(2 * one * (other / np.maximum(one + other, np.finfo(float).tiny)))


def _halved(along: Field) -> Field:
    """Conductivity along the last axis of blocks of 2 x 2: mean of its bounds, rows apart and rows joined."""
    k = np.pad(along, [(0, n % 2) for n in along.shape], mode="edge")
    rows = k[::2], k[1::2], (k[::2] + k[1::2]) / 2
    apart, other, joined = (_series(row[:, ::2], row[:, 1::2]) for row in rows)
    return np.asarray((apart + other) / 4 + joined / 2)
