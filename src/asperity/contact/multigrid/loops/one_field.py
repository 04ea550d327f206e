"""One field on the lattice and on coarse grids."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from asperity.contact.compiled import compiled, inlined
from asperity.contact.multigrid.loops.rows import (
    Fields,
    Scalar,
    Single,
    Sites,
    add_constant,
    coarse_correct_row,
    end_of,
    fine_row,
    interpolate_row,
    join,
    larger,
    move_row,
    neighbors,
    off_contact,
    restrict_rows,
    weighted_total,
    wrap,
)
from asperity.lattice import Field


class One(NamedTuple):
    """One field on the lattice: (lap + bed) e = b - uniform, e >= bound; ``diagonal`` is 4 + bed."""

    e: Single
    bound: Single
    b: Single
    bed: Scalar
    diagonal: Scalar
    uniform: Scalar
    sites: Sites


class CoarseOne(NamedTuple):
    """One field on a coarse grid: (lap + bed mass + pins) e = b - coupling sum(mass e) mass.

    ``gx`` and ``gy`` are couplings, ``mx`` and ``my`` sizes of cells.
    """

    e: Single
    b: Single
    bed: Scalar
    coupling: float
    pins: Single
    gx: Single
    gy: Single
    mx: Single
    my: Single
    sites: Sites


@inlined
def relax_row_1(eq: One, i: int, color: int) -> None:
    """Projected Gauss-Seidel on the sites of one color in row i."""
    e, bound, b, _, diagonal, uniform, sites = eq
    side = (i + color) & 1
    inverse = np.float32(1.0) / diagonal
    above, below = neighbors(i, sites)
    row, other, up, down = e[i, side], e[i, 1 - side], e[above, side], e[below, side]
    least, source = bound[i, side], b[i, side]
    for k in range(side, end_of(side, sites.columns)):
        beside = up[k] + down[k] + other[k - side] + other[k - side + 1]
        row[k] = max(least[k], (beside + source[k] - uniform) * inverse)
    wrap(e[i], sites)


@compiled
def sweeps_1(eq: One, halves: int) -> None:
    """Half sweeps: a wave of them, each a row behind the one before; then what it leaves at both ends.

    A row is fetched from memory once so. Where the number of rows is odd and the lattice periodic, the last
    row has the color of the first, its neighbor, and waits for it.
    """
    ny = eq.sites.rows
    odd = ny % 2
    for front in range(ny + 1):
        for half in range(halves):
            i = front - half
            start, stop = i, i + 1 if half <= i < ny - odd - half else i
            if front == ny:
                start, stop = -half - odd, half
            for row in range(start, stop):
                relax_row_1(eq, row % ny, half & 1)


@inlined
def defect_row_1(eq: One, i: int, defect: Single, sums: Field) -> None:
    """Minus the force off contact, in row i; ``sums``: the largest, the largest correction, contacts."""
    e, bound, b, _, diagonal, uniform, sites = eq
    zero, unit = np.float32(0.0), np.float32(1.0)
    worst = far = free_sites = zero
    above, below = neighbors(i, sites)
    for side in range(2):
        row, other, least, source, out = e[i, side], e[i, 1 - side], bound[i, side], b[i, side], defect[side]
        up, down = e[above, side], e[below, side]
        for k in range(side, end_of(side, sites.columns)):
            beside = up[k] + down[k] + other[k - side] + other[k - side + 1]
            free = unit if row[k] > least[k] else zero
            free_sites += free
            value = (beside + source[k] - uniform - diagonal * row[k]) * free
            worst, far = larger(worst, abs(value)), larger(far, abs(row[k]))
            out[k] = value
    sums[0], sums[1], sums[2] = worst, far, sites.columns - free_sites


@compiled
def restrict_1(eq: One, out: Single, sums: Field) -> None:
    """Defect on the first coarse grid; ``sums`` as `defect_row_1` has them."""
    width = eq.e.shape[2]
    defect, line = np.zeros((3, 2, width), np.float32), np.empty(width - 1, np.float32)
    for k in range(out.shape[0]):
        for offset in range(-1, 2):
            i, row = fine_row(k, offset, eq.sites), defect[(2 * k + offset) % 3]
            if i < 0:
                row[:] = np.float32(0.0)
            elif offset > -1 or k == 0:  # else it is still in the buffer
                defect_row_1(eq, i, row, sums[i])
        above, center, below = (2 * k - 1) % 3, 2 * k % 3, (2 * k + 1) % 3
        restrict_rows(defect[above], defect[center], defect[below], k, eq.sites, line, out[k])


@compiled
def products_1(eq: One, coarse: Single, previous: Single, sums: Field) -> None:
    """Products by rows, for correction d and previous move q: r.d, r.q, d.Sd, d.Sq, q.Sq, sum d, sum q."""
    e, bound, b, bed, _, uniform, sites = eq
    ny, _, width = e.shape
    d, q = np.zeros((2, 2, width), np.float32), np.zeros((2, 2, width), np.float32)
    line = np.zeros((2, width), np.float32)
    for i in range(ny + 1):
        row = i if i < ny else neighbors(ny - 1, sites)[1]  # products of a row need the row below it
        now = i % 2
        interpolate_row(coarse, row, sites, line)
        off_contact(line, e[row], bound[row], sites, d[now])
        off_contact(previous[row], e[row], bound[row], sites, q[now])
        if i == 0:
            continue
        x, y, d0, d1, q0, q1 = e[i - 1], e[row], d[1 - now], d[now], q[1 - now], q[now]
        zero = np.float32(0.0)
        rd = rq = dd = dq = qq = sd = sq = zero
        for side in range(2):
            a, a_right, a_below = x[side], x[1 - side], y[side]
            f, f_right, f_below = d0[side], d0[1 - side], d1[side]
            g, g_right, g_below = q0[side], q0[1 - side], q1[side]
            source = b[i - 1, side]
            for k in range(side, end_of(side, sites.columns)):
                r = k - side + 1
                fixed = bed * a[k] - source[k] + uniform
                a1, f1, g1 = a[k] - a_below[k], f[k] - f_below[k], g[k] - g_below[k]
                a2, f2, g2 = a[k] - a_right[r], f[k] - f_right[r], g[k] - g_right[r]
                rd += a1 * f1 + a2 * f2 + fixed * f[k]
                rq += a1 * g1 + a2 * g2 + fixed * g[k]
                dd += f1 * f1 + f2 * f2 + bed * f[k] * f[k]
                dq += f1 * g1 + f2 * g2 + bed * f[k] * g[k]
                qq += g1 * g1 + g2 * g2 + bed * g[k] * g[k]
                sd += f[k]
                sq += g[k]
        total = sums[i - 1]
        total[0], total[1], total[2], total[3], total[4], total[5], total[6] = rd, rq, dd, dq, qq, sd, sq


@compiled
def correct_1(eq: One, coarse: Single, previous: Single, alpha: Scalar, beta: Scalar) -> None:
    """Move free sites by alpha times the correction plus beta times the previous move, and project."""
    line = np.zeros((2, eq.e.shape[2]), np.float32)
    for i in range(eq.sites.rows):
        interpolate_row(coarse, i, eq.sites, line)
        move_row(line, previous[i], eq.e[i], eq.bound[i], eq.sites, alpha, beta)


@inlined
def coarse_relax_1(grid: CoarseOne, i: int, color: int) -> None:
    """Gauss-Seidel on the sites of one color in row i."""
    e, b, bed, _, pins, gx, gy, mx, my, sites = grid
    ny = sites.rows
    side = (i + color) & 1
    before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
    row, other, up, down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
    above, below, size = gy[before], gy[i], my[i]
    right, left, cell, source, pin = gx[side], gx[1 - side], mx[side], b[i, side], pins[i, side]
    for k in range(side, end_of(side, sites.columns)):
        g = left[k - side]
        diagonal = (g + right[k] + bed * cell[k]) * size + (above + below) * cell[k] + pin[k]
        beside = cell[k] * (above * up[k] + below * down[k])
        beside += size * (g * other[k - side] + right[k] * other[k - side + 1])
        row[k] = (source[k] + beside) / diagonal
    wrap(e[i], sites)


@inlined
def coarse_defect_1(grid: CoarseOne, uniform: Scalar, i: int, defect: Single) -> None:
    """Defect b - uniform mass - (...) e in row i."""
    e, b, bed, _, pins, gx, gy, mx, my, sites = grid
    ny = sites.rows
    before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
    above, below, size = gy[before], gy[i], my[i]
    for side in range(2):
        row, other, up, down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
        right, left, cell, source = gx[side], gx[1 - side], mx[side], b[i, side]
        pin, to = pins[i, side], defect[side]
        for j in range(side, end_of(side, sites.columns)):
            g = left[j - side]
            diagonal = (g + right[j] + bed * cell[j]) * size + (above + below) * cell[j] + pin[j]
            beside = cell[j] * (above * up[j] + below * down[j] - uniform * size)
            beside += size * (g * other[j - side] + right[j] * other[j - side + 1])
            to[j] = source[j] + beside - diagonal * row[j]


@compiled
def descend_1(grid: CoarseOne, out: Fields) -> float:
    """From no correction: a sweep, the defect on the next coarser grid; the total of the correction.

    The total times the coupling is the uniform force on the grid.
    """
    e, coupling, sites = grid.e, grid.coupling, grid.sites
    width = e.shape[2]
    e[:] = np.float32(0.0)
    for color in range(2):
        for i in range(sites.rows):
            coarse_relax_1(grid, i, color)
    value = weighted_total(e, grid.mx, grid.my, sites.columns)
    uniform = np.float32(coupling * value) if coupling else np.float32(0.0)
    defect, line = np.zeros((3, 2, width), np.float32), np.empty(width - 1, np.float32)
    for k in range((sites.rows + 1) // 2):
        for offset in range(-1, 2):
            i, into = fine_row(k, offset, sites), defect[(2 * k + offset) % 3]
            if i < 0:
                into[:] = np.float32(0.0)
            elif offset > -1 or k == 0:  # else it is still in the buffer
                coarse_defect_1(grid, uniform, i, into)
        upper, center, lower = (2 * k - 1) % 3, 2 * k % 3, (2 * k + 1) % 3
        restrict_rows(defect[upper], defect[center], defect[lower], k, sites, line, out[0][k])
    return value


@compiled
def ascend_1(grid: CoarseOne, coarse: Fields, shift: Scalar, joined: Fields) -> float:
    """Add the next coarser grid's correction, and ``shift`` to the source; sweep, the other color first.

    Returns the total.
    """
    e, sites = grid.e, grid.sites
    line = np.zeros((2, e.shape[2]), np.float32)
    for i in range(sites.rows):
        coarse_correct_row(coarse[0], e, sites, i, line)
        add_constant(grid.b, shift, grid.mx, grid.my, sites.columns, i)
    for color in (1, 0):
        for i in range(sites.rows):
            coarse_relax_1(grid, i, color)
    for i in range(sites.rows):
        join(e[i], joined[0][i])
    return weighted_total(e, grid.mx, grid.my, sites.columns)
