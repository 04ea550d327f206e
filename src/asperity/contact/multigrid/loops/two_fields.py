r"""Two fields on the lattice and on coarse grids: of an implicit step of creep.

A pass over the lattice is a wave of row operations, each a row behind the one before, so that a row is
fetched from memory once. When row n has been corrected:

    row       n - 3          n - 2         n - 1        n
    done      restriction    second half   first half   correction from the coarse grid
              of defects     sweep         sweep
              ^ reads n - 4 to n - 2, final by then     ^ the wave moves on to n + 1

An operation reads the rows beside its own and so stops a row earlier at both ends of the lattice than the
one before it; what is left undone there comes after the wave.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from asperity.contact.compiled import compiled, inlined
from asperity.contact.multigrid.loops.rows import (
    Pair,
    Scalar,
    Single,
    Sites,
    add_constant,
    coarse_correct_row,
    end_of,
    fine_row,
    interpolate_row,
    join,
    neighbors,
    restrict_rows,
    row_in,
    weighted_total,
    wrap,
)
from asperity.lattice import Field


class Two(NamedTuple):
    """Two fields on the lattice: lap e + bed f = b, e >= bound; spread lap f + lag f - e = c + shift.

    They are the corrections of u and of its stretch w = u - u0 in an implicit step of creep from anchors v:

        k0 L u + k1 w = r            w + spread L w + drag w = u - v + shift

    with lag = 1 + drag. ``diagonal`` is lag + 4 spread, ``damping`` its inverse and ``inverse`` that of
    4 + bed damping: fields, or one row that stands for all.
    """

    e: Single
    f: Single
    bound: Single
    b: Single
    c: Single
    bed: Scalar
    spread: Scalar
    diagonal: Single
    damping: Single
    inverse: Single
    shift: Scalar
    sites: Sites


class CoarseTwo(NamedTuple):
    """Two fields on a coarse grid.

    (lap + pins) e + bed mass f = b          (spread lap + lag mass) f - mass e = c

    The lag is a field, or one row that stands for all.
    """

    e: Single
    f: Single
    b: Single
    c: Single
    bed: Scalar
    spread: Scalar
    lag: Single
    pins: Single
    gx: Single
    gy: Single
    mx: Single
    my: Single
    sites: Sites


@inlined
def relax_row_2(eq: Two, i: int, color: int) -> None:
    """Projected Gauss-Seidel, both fields of a site at once, on the sites of one color in row i."""
    e, f, sites, bed, spread, shift = eq.e, eq.f, eq.sites, eq.bed, eq.spread, eq.shift
    side = (i + color) & 1
    before, after = neighbors(i, sites)
    e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
    f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
    least, first, second = eq.bound[i, side], eq.b[i, side], eq.c[i, side]
    damping, inverse = eq.damping[row_in(eq.damping, i), side], eq.inverse[row_in(eq.inverse, i), side]
    for k in range(side, end_of(side, sites.columns)):
        beside = e_up[k] + e_down[k] + e_other[k - side] + e_other[k - side + 1] + first[k]
        fixed = spread * (f_up[k] + f_down[k] + f_other[k - side] + f_other[k - side + 1]) + second[k] + shift
        value = max(least[k], (beside - bed * damping[k] * fixed) * inverse[k])
        e_row[k] = value
        f_row[k] = (value + fixed) * damping[k]
    wrap(e[i], sites)
    wrap(f[i], sites)


@inlined
def defect_row_2(eq: Two, i: int, balance: Single, creep: Single, sums: Field) -> None:
    """Defects of both equations in row i; ``sums``: sum of f, contacts, squares of e."""
    e, f, bound, b, c, bed, spread, shift = eq.e, eq.f, eq.bound, eq.b, eq.c, eq.bed, eq.spread, eq.shift
    sites = eq.sites
    zero, unit, four = np.float32(0.0), np.float32(1.0), np.float32(4.0)
    before, after = neighbors(i, sites)
    stretch = free_sites = moves = zero
    for side in range(2):
        e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
        f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
        least, first, second = bound[i, side], b[i, side], c[i, side]
        out_1, out_2, diagonal = balance[side], creep[side], eq.diagonal[row_in(eq.diagonal, i), side]
        for k in range(side, end_of(side, sites.columns)):
            beside = e_up[k] + e_down[k] + e_other[k - side] + e_other[k - side + 1] - four * e_row[k]
            free = unit if e_row[k] > least[k] else zero
            value = (beside + first[k] - bed * f_row[k]) * free
            flow = spread * (f_up[k] + f_down[k] + f_other[k - side] + f_other[k - side + 1])
            flow += second[k] + shift + e_row[k] - diagonal[k] * f_row[k]
            out_1[k], out_2[k] = value, flow
            free_sites += free
            stretch += f_row[k]
            moves += e_row[k] * e_row[k]
    sums[0], sums[1], sums[2] = stretch, sites.columns - free_sites, moves


@inlined
def restrict_pair(balance: Single, creep: Single, k: int, sites: Sites, line: Single, out: Pair) -> None:
    """Row k of two coarse fields, from buffers in which fine row i has the index i modulo 3."""
    above, center, below = (2 * k - 1) % 3, 2 * k % 3, (2 * k + 1) % 3
    restrict_rows(balance[above], balance[center], balance[below], k, sites, line, out.e[k])
    restrict_rows(creep[above], creep[center], creep[below], k, sites, line, out.f[k])


@inlined
def correct_row_2(eq: Two, coarse: Pair, part: Scalar, i: int, line: Single) -> None:
    """Move free sites, and f everywhere, by a part of the correction."""
    e, f, bound, sites = eq.e, eq.f, eq.bound, eq.sites
    interpolate_row(coarse.e, i, sites, line)
    for side in range(2):
        for k in range(side, end_of(side, sites.columns)):
            value, least = e[i, side, k], bound[i, side, k]
            e[i, side, k] = max(least, value + part * line[side, k]) if value > least else least
    wrap(e[i], sites)
    interpolate_row(coarse.f, i, sites, line)
    for side in range(2):
        for k in range(side, end_of(side, sites.columns)):
            f[i, side, k] += part * line[side, k]
    wrap(f[i], sites)


@compiled
def cycle_2(
    eq: Two, moves: Pair, part: Scalar, correcting: bool, restricting: bool, out: Pair, sums: Field
) -> None:
    """A cycle on the lattice: a part of moves, if wanted; a sweep; restriction of the defects, if wanted.

    A wave of all three, drawn at the head of the module. Its last front takes what it leaves at both ends:
    the sweep there, the last of an odd number of rows waiting as in `sweeps_1`; then the restriction of the
    rows that remain. Without a correction the wave is a row shorter.
    """
    ny, _, width = eq.e.shape
    sites = eq.sites
    line, order = np.zeros((2, width), np.float32), np.empty(width - 1, np.float32)
    balance, creep = np.zeros((3, 2, width), np.float32), np.zeros((3, 2, width), np.float32)
    odd = ny % 2
    last, lead = ny - odd, 1 if correcting else 0
    margin = lead + 2
    done, resumed, rows = (margin + 2) // 2, (last - margin) // 2, (ny + 1) // 2
    if done >= resumed:  # so few rows that the wave never runs full: all are restricted after it
        done = resumed = rows
    latest = -2
    for front in range(ny + 1):
        if correcting and front < ny:
            correct_row_2(eq, moves, part, front, line)
        for half in range(2):
            i, apart = front - lead - half, lead + half
            start, stop = i, i + 1 if apart <= i < last - apart else i
            if front == ny:
                start, stop = -half - lead - odd, half + lead
            for row in range(start, stop):
                relax_row_2(eq, row % ny, half)
        i = front - margin
        start, stop = i // 2, i // 2 + 1 if i % 2 == 1 and done <= i // 2 < resumed else i // 2
        if front == ny:
            start, stop = resumed - rows, done
        for coarse in range(start, stop if restricting else start):
            k = coarse % rows
            for offset in range(0 if k == latest + 1 else -1, 2):  # else it is still in the buffers
                i, n = fine_row(k, offset, sites), (2 * k + offset) % 3
                if i < 0:
                    balance[n] = np.float32(0.0)
                    creep[n] = np.float32(0.0)
                else:
                    defect_row_2(eq, i, balance[n], creep[n], sums[i])
            restrict_pair(balance, creep, k, sites, order, out)
            latest = k


@inlined
def coarse_relax_2(grid: CoarseTwo, i: int, color: int) -> None:
    """Gauss-Seidel, both fields of a site at once, on the sites of one color in row i."""
    e, f, b, c, bed, spread, lag, pins, gx, gy, mx, my, sites = grid
    ny = sites.rows
    unit = np.float32(1.0)
    side = (i + color) & 1
    before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
    above, below, size = gy[before], gy[i], my[i]
    e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
    f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
    right, left, cell = gx[side], gx[1 - side], mx[side]
    pin, first, second = pins[i, side], b[i, side], c[i, side]
    lagging = lag[row_in(lag, i), side]
    for k in range(side, end_of(side, sites.columns)):
        g = left[k - side]
        lap = (g + right[k]) * size + (above + below) * cell[k]
        mass = size * cell[k]
        beside = cell[k] * (above * e_up[k] + below * e_down[k])
        beside += size * (g * e_other[k - side] + right[k] * e_other[k - side + 1]) + first[k]
        flow = cell[k] * (above * f_up[k] + below * f_down[k])
        flow += size * (g * f_other[k - side] + right[k] * f_other[k - side + 1])
        fixed = second[k] + spread * flow
        inverse = unit / (mass * lagging[k] + spread * lap)
        coupling = bed * mass * inverse
        value = (beside - coupling * fixed) / (lap + pin[k] + coupling * mass)
        e_row[k] = value
        f_row[k] = (fixed + mass * value) * inverse
    wrap(e[i], sites)
    wrap(f[i], sites)


@inlined
def coarse_defect_2(grid: CoarseTwo, i: int, balance: Single, creep: Single) -> None:
    """Defects of both equations in row i."""
    e, f, b, c, bed, spread, lag, pins, gx, gy, mx, my, sites = grid
    ny = sites.rows
    before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
    above, below, size = gy[before], gy[i], my[i]
    for side in range(2):
        e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
        f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
        right, left, cell = gx[side], gx[1 - side], mx[side]
        pin, first, second = pins[i, side], b[i, side], c[i, side]
        out_1, out_2, lagging = balance[side], creep[side], lag[row_in(lag, i), side]
        for j in range(side, end_of(side, sites.columns)):
            g = left[j - side]
            lap = (g + right[j]) * size + (above + below) * cell[j]
            mass = size * cell[j]
            beside = cell[j] * (above * e_up[j] + below * e_down[j])
            beside += size * (g * e_other[j - side] + right[j] * e_other[j - side + 1])
            flow = cell[j] * (above * f_up[j] + below * f_down[j])
            flow += size * (g * f_other[j - side] + right[j] * f_other[j - side + 1])
            out_1[j] = first[j] + beside - (lap + pin[j]) * e_row[j] - bed * mass * f_row[j]
            out_2[j] = second[j] + spread * (flow - lap * f_row[j])
            out_2[j] += mass * (e_row[j] - lagging[j] * f_row[j])


@compiled
def descend_2(grid: CoarseTwo, out: Pair) -> float:
    """As `descend_1`, for both fields; the total is that of f."""
    sites, width = grid.sites, grid.e.shape[2]
    grid.e[:] = np.float32(0.0)
    grid.f[:] = np.float32(0.0)
    for color in range(2):
        for i in range(sites.rows):
            coarse_relax_2(grid, i, color)
    balance, creep = np.zeros((3, 2, width), np.float32), np.zeros((3, 2, width), np.float32)
    line = np.empty(width - 1, np.float32)
    for k in range((sites.rows + 1) // 2):
        for offset in range(-1, 2):
            i, n = fine_row(k, offset, sites), (2 * k + offset) % 3
            if i < 0:
                balance[n] = np.float32(0.0)
                creep[n] = np.float32(0.0)
            elif offset > -1 or k == 0:  # else it is still in the buffers
                coarse_defect_2(grid, i, balance[n], creep[n])
        restrict_pair(balance, creep, k, sites, line, out)
    return weighted_total(grid.f, grid.mx, grid.my, sites.columns)


@compiled
def ascend_2(grid: CoarseTwo, coarse: Pair, shift: Scalar, joined: Pair) -> float:
    """As `ascend_1`, for both fields; the shift is that of the second equation, the total that of f."""
    sites = grid.sites
    line = np.zeros((2, grid.e.shape[2]), np.float32)
    for i in range(sites.rows):
        coarse_correct_row(coarse.e, grid.e, sites, i, line)
        coarse_correct_row(coarse.f, grid.f, sites, i, line)
        add_constant(grid.c, shift, grid.mx, grid.my, sites.columns, i)
    for color in (1, 0):
        for i in range(sites.rows):
            coarse_relax_2(grid, i, color)
    for i in range(sites.rows):
        join(grid.e[i], joined.e[i])
        join(grid.f[i], joined.f[i])
    return weighted_total(grid.f, grid.mx, grid.my, sites.columns)
