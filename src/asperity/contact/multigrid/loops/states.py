"""Between states and corrections, and from one state of creep to the next.

States are double precision, rows in order. Sums are kept row by row, in double precision, and added up in
their order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from asperity.contact.compiled import compiled
from asperity.contact.multigrid.loops.rows import (
    Pair,
    Scalar,
    Single,
    Sites,
    end_of,
    join,
    larger,
    part,
    wrap,
)
from asperity.contact.stencils import force_row
from asperity.lattice import Field


class Surface(NamedTuple):
    """A state and its obstacle: u, w = u - u0 and the heights; lengths, double precision, rows in order."""

    u: Field
    w: Field
    heights: Field


class Measured(NamedTuple):
    """What a state asks of its correction: the bound and the source b; and the flow.

    ``bound`` is the least correction of u that does not penetrate: minus the gap u - heights.
    """

    bound: Single
    b: Single
    flow: Single


class Scales(NamedTuple):
    """Units of force and length, and the level that rises are counted from, a length."""

    force: float
    length: float
    level: float


class Past(NamedTuple):
    """What a stage is guessed from: weights of the last two changes; rate and flow at the step's start."""

    last: Pair
    before: Pair
    ahead: Scalar
    back: Scalar
    rate: Single
    flow: Single
    tau: Scalar


@compiled
def measure(
    surface: Surface,
    springs: tuple[float, float, float, float],
    uniform: float,
    flowing: bool,
    scales: Scales,
    into: Measured,
    sites: Sites,
    sums: Field,
) -> None:
    """Bound and source of a state with the force k0 L u + k1 w + uniform; and where it is flowing the flow.

    The source is minus the force and the flow spread L w + drag w, both in their units. ``sums``: largest
    force off contact, tension, largest u; sums of the force in contact and off it, contacts, w, u - level,
    and of the squares of the last two.
    """
    u, w, heights = surface
    bound, b, flow = into
    k0, k1, spread, drag = springs
    nx = u.shape[1]
    force, line = np.empty(nx), np.empty(nx)
    scale, inverse = -1.0 / scales.force, 1.0 / scales.length
    for i in range(sites.rows):
        row, stretch, rough = u[i], w[i], heights[i]
        force_row(k0, u, k1, w, i, sites.mirrored, force)
        worst = tension = highest = load = imbalance = free_sites = 0.0
        sum_w = sum_u = squares_w = squares_u = 0.0
        for j in range(nx):  # no branches: the compiler makes vectors of it
            free = 1.0 if row[j] > rough[j] else 0.0
            total = force[j] + uniform
            loose = total * free
            carried = total - loose
            load += carried
            tension += -carried if carried < 0.0 else 0.0
            free_sites += free
            imbalance += loose
            worst = larger(worst, abs(loose))
            highest = larger(highest, abs(row[j]))
            rise = row[j] - scales.level
            sum_w += stretch[j]
            sum_u += rise
            squares_w += stretch[j] * stretch[j]
            squares_u += rise * rise
            force[j] = total * scale
            line[j] = (rough[j] - row[j]) * inverse
        out = sums[i]
        out[0], out[1], out[2], out[3], out[4] = worst, tension, highest, load, imbalance
        out[5], out[6], out[7], out[8], out[9] = nx - free_sites, sum_w, sum_u, squares_w, squares_u
        part(line, bound[i])
        part(force, b[i])
        if flowing:
            force_row(inverse * spread, w, inverse * drag, w, i, sites.mirrored, line)
            part(line, flow[i])


@compiled
def settle(surface: Surface, correction: Pair, bound: Single, unit: float, offset: float) -> None:
    """Add corrections to u and w, and an offset to w, where w has rows; contact where a gap closes."""
    u, w, heights = surface
    nx = u.shape[1]
    move, least = np.empty(nx, np.float32), np.empty(nx, np.float32)
    for i in range(u.shape[0]):
        join(correction.e[i], move)
        join(bound[i], least)
        row, rough = u[i], heights[i]
        for j in range(nx):
            moved = max(rough[j], row[j] + unit * move[j])
            row[j] = moved if move[j] > least[j] else rough[j]
        if i < w.shape[0]:
            join(correction.f[i], move)
            row = w[i]
            for j in range(nx):
                row[j] += unit * move[j] + offset


@compiled
def guess(
    past: Past,
    growth: Scalar,
    offset: Scalar,
    weights: tuple[Scalar, Scalar],
    middle: Single,
    bound: Single,
    correction: Pair,
    c: Single,
    sites: Sites,
    sums: Field,
) -> None:
    """Guess of a stage, from the stage before it (times ``growth``) and the last time steps, and its source.

    The rate where the stage before ends, ``middle``, follows from its e, and its f plus an offset; the
    source is minus the rates at the start and there with their weights, and minus tau flow. ``sums`` of e, f
    and c.
    """
    last, before, ahead, back, rate, flow, tau = past
    e, f = correction
    first, second = weights
    pace = np.float32(1.0) / tau
    for i in range(sites.rows):
        sum_e = sum_f = sum_c = np.float32(0.0)
        for side in range(2):
            for k in range(side, end_of(side, sites.columns)):
                move, stretch = e[i, side, k], f[i, side, k] + offset
                rate_left = (move - stretch) * pace - rate[i, side, k]
                source = -first * rate[i, side, k] - second * rate_left - tau * flow[i, side, k]
                path = growth * move + ahead * last.e[i, side, k] + back * before.e[i, side, k]
                move = max(bound[i, side, k], path)
                stretch = growth * stretch + ahead * last.f[i, side, k] + back * before.f[i, side, k]
                e[i, side, k], f[i, side, k], c[i, side, k] = move, stretch, source
                middle[i, side, k] = rate_left
                sum_e += move
                sum_f += stretch
                sum_c += source
        wrap(e[i], sites)
        wrap(f[i], sites)
        sums[i, 0], sums[i, 1], sums[i, 2] = sum_e, sum_f, sum_c


@compiled
def finish_step(
    correction: Pair,
    offset: Scalar,
    rate: Single,
    middle: Single,
    tau: Scalar,
    weight: Scalar,
    shares: tuple[Scalar, Scalar, Scalar],
    rate_at_end: Single,
    error: Single,
    sites: Sites,
) -> None:
    """Rate at the end, f plus an offset, and the sum of the three rates with weights."""
    e, f = correction
    first, second, third = shares
    pace = np.float32(1.0) / tau
    for i in range(sites.rows):
        for side in range(2):
            for k in range(side, end_of(side, sites.columns)):
                before, between = rate[i, side, k], middle[i, side, k]
                defect = (e[i, side, k] - f[i, side, k] - offset - weight * (before + between)) * pace
                rate_at_end[i, side, k] = defect
                error[i, side, k] = first * before + second * between + third * defect
