r"""The loops over neighbors, compiled.

States are double precision. Multigrid works on corrections to them, in single precision and in units in
which k0 = 1 and no length is large; what one correction lacks the next one makes up for.

Rows of corrections are parted: the m even columns first, then the odd ones. All neighbors of one color of
a checkerboard then lie side by side, as do the sites that two grids share, so that every loop reads and
writes in order and the compiler can use vector instructions. A field has the shape (rows, 2, m + 1):

    row[0]   columns 0, 2, 4, ...   and column 0 again
    row[1]   column -1   and columns 1, 3, 5, ...

The sites of ``row[side]`` are ``side <= k < side + count``, with ``other[k - side]`` and
``other[k - side + 1]`` of the other side next to them. `wrap` sets the two images.

Each kernel works on rows ``low <= i < high`` so that threads can share a grid; sums are kept row by row,
so that results do not depend on the number of threads. On the lattice several half sweeps follow each
other at a distance of one row, so that a row is fetched from memory once.

Parameters are arguments, never globals, and all loops are in this module: compiled code is kept on disk,
and a change of what it took from elsewhere would not be noticed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact.compiled import compiler

_OPTIONS = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract", "reassoc", "nsz", "arcp", "nnan"},
}
_compiled = compiler(**_OPTIONS)
_inlined = compiler(forceinline=True, **_OPTIONS)
"""For what other loops call. Else each of them would hold a version of it, alike but for the order of its
sums, and whichever was loaded first would serve all: last digits would depend on what ran before."""


# Parted rows.


@_inlined
def wrap(row: Any, nx: int) -> None:
    """Set the images beyond both ends of a parted row of nx columns."""
    m = (nx + 1) // 2
    if nx % 2 == 0:
        row[0, m] = row[0, 0]
        row[1, 0] = row[1, m]
    else:
        row[1, m] = row[0, 0]
        row[1, 0] = row[0, m - 1]


@_inlined
def part(line: Any, row: Any) -> None:
    """A row in order, parted."""
    nx = line.shape[0]
    even, odd = row[0], row[1]
    for k in range(nx // 2):
        even[k] = line[2 * k]
        odd[k + 1] = line[2 * k + 1]
    if nx % 2:
        even[nx // 2] = line[nx - 1]


@_inlined
def join(row: Any, line: Any) -> None:
    """A parted row, in order."""
    nx = line.shape[0]
    for k in range(nx // 2):
        line[2 * k] = row[0, k]
        line[2 * k + 1] = row[1, k + 1]
    if nx % 2:
        line[nx - 1] = row[0, nx // 2]


@_compiled
def join_rows(field: Any, out: Any, low: int, high: int) -> None:
    """Parted rows, in order."""
    for i in range(low, high):
        join(field[i], out[i])


@_compiled
def total(field: Any, nx: int, out: Any, low: int, high: int) -> None:
    """Sums of parted rows."""
    m = field.shape[2] - 1
    for i in range(low, high):
        value = np.float32(0.0)
        for side in range(2):
            row = field[i, side]
            for k in range(side, m if side == 0 else 1 + nx - m):
                value += row[k]
        out[i, 0] = value


@_compiled
def weighted_total(field: Any, mx: Any, my: Any) -> float:
    """Sum of a field over the sites that the cells of a coarse grid stand for."""
    ny, _, width = field.shape
    value = 0.0
    for i in range(ny):
        row = np.float32(0.0)
        for side in range(2):
            for k in range(width):
                row += field[i, side, k] * mx[side, k]
        value += my[i] * row
    return value


# Between grids: bilinear interpolation, and its transpose. Every other site belongs to the coarse grid.


@_inlined
def restrict_rows(above: Any, here: Any, below: Any, nx: int, line: Any, out: Any) -> None:
    """Three parted fine rows on a parted coarse row: coarse sites count whole, those between them half."""
    half = np.float32(0.5)
    m = line.shape[0]
    for row in (above, here, below):
        if nx % 2 == 0:
            row[1, 0] = row[1, m]
        else:  # the last column and the first are neighbors with nothing between
            row[1, 0] = row[1, m] = np.float32(0.0)
    for k in range(m):
        sides = above[0, k] + below[0, k] + here[1, k] + here[1, k + 1]
        corners = above[1, k] + above[1, k + 1] + below[1, k] + below[1, k + 1]
        line[k] = here[0, k] + half * (sides + half * corners)
    part(line, out)


@_inlined
def interpolate_row(coarse: Any, i: int, ny: int, nx: int, out: Any) -> None:
    """Parted row i of a fine grid of ny rows, from a coarse grid whose rows are in order."""
    half = np.float32(0.5)
    my, m = coarse.shape
    even, odd = out[0], out[1]
    above = coarse[i // 2]
    if i % 2 == 0 or ny == 1:
        for k in range(m):
            even[k] = above[k]
    else:
        below = coarse[i // 2 + 1 if i // 2 + 1 < my else 0]
        for k in range(m):
            even[k] = half * (above[k] + below[k])
    even[m] = even[0]
    for k in range(1, 1 + nx - m):
        odd[k] = half * (even[k - 1] + even[k])
    wrap(out, nx)


@_inlined
def fine_row(coarse_row: int, offset: int, ny: int) -> int:
    """Fine row at an offset of -1, 0 or 1 from a coarse row, or -1 if the grid has none there."""
    i = 2 * coarse_row + offset
    if ny == 1:
        return i if offset == 0 else -1
    if i < 0:
        return ny - 1 if ny % 2 == 0 else -1
    return i if i < ny else -1


# Pins: contacts on coarse grids.


@_compiled
def pins_of_contacts(e: Any, bound: Any, nx: int, strength: Any, out: Any, low: int, high: int) -> None:
    """Pins on the first coarse grid: each contact counts ``strength``."""
    ny, _, width = e.shape
    m = width - 1
    rows, line = np.zeros((3, 2, width), np.float32), np.empty(m, np.float32)
    zero = np.float32(0.0)
    for k in range(low, high):
        for offset in range(-1, 2):
            i, row = fine_row(k, offset, ny), rows[offset + 1]
            if i < 0:
                row[:] = zero
                continue
            for side in range(2):
                for j in range(side, m if side == 0 else 1 + nx - m):
                    row[side, j] = strength if e[i, side, j] <= bound[i, side, j] else zero
        restrict_rows(rows[0], rows[1], rows[2], nx, line, out[k])


@_compiled
def coarser_pins(pins: Any, nx: int, softening: Any, mean: Any, out: Any) -> None:
    """Pins on the next coarser grid: what stands out from the mean softens."""
    ny, _, width = pins.shape
    rows, line = np.empty((3, 2, width), np.float32), np.empty(width - 1, np.float32)
    one, zero = np.float32(1.0), np.float32(0.0)
    for k in range(out.shape[0]):
        for offset in range(-1, 2):
            i, row = fine_row(k, offset, ny), rows[offset + 1]
            if i < 0:
                row[:] = zero
                continue
            for side in range(2):
                for j in range(width):
                    pin = pins[i, side, j]
                    row[side, j] = pin / (one + softening * max(pin - mean, zero))
        restrict_rows(rows[0], rows[1], rows[2], nx, line, out[k])


# Between states and corrections. ``bound`` is the least correction of u that does not penetrate: minus
# the gap u - heights, in the unit of the correction.


@_compiled
def measure_1(
    u: Any,
    heights: Any,
    k0: float,
    bed: float,
    uniform: float,
    unit: float,
    bound: Any,
    b: Any,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """Bound and source for a state with the force k0 L u + bed u + uniform.

    ``sums``: largest force off contact, sum of the tension, load, contacts, sum of the forces off contact.
    """
    nx = u.shape[1]
    force, line = np.empty(nx), np.empty(nx)
    scale, inverse = -1.0 / (k0 * unit), 1.0 / unit
    for i in range(low, high):
        row, rough = u[i], heights[i]
        stencil_row(k0, u, bed, u, i, force)
        worst = tension = load = free_sites = imbalance = 0.0
        for j in range(nx):  # sums and the largest apart, and no branches: the compiler makes vectors of both
            free = 1.0 if row[j] > rough[j] else 0.0
            force[j] += uniform
            off_contact = force[j] * free
            carried = force[j] - off_contact
            load += carried
            tension += -carried if carried < 0.0 else 0.0
            free_sites += free
            imbalance += off_contact
            line[j] = off_contact
        for j in range(nx):
            value = abs(line[j])
            worst = value if value > worst else worst
        found = sums[i]
        found[0], found[1], found[2], found[3], found[4] = worst, tension, load, nx - free_sites, imbalance
        for j in range(nx):
            line[j] = (rough[j] - row[j]) * inverse
            force[j] *= scale
        part(line, bound[i])
        part(force, b[i])


@_inlined
def stencil_row(a: float, x: Any, b: float, y: Any, i: int, out: Any) -> None:
    """Row i of a L x + b y, L minus the Laplacian."""
    ny, nx = x.shape
    up, down, row, other = x[i - 1 if i > 0 else ny - 1], x[i + 1 if i < ny - 1 else 0], x[i], y[i]
    for j in range(1, nx - 1):
        out[j] = a * (4.0 * row[j] - (up[j] + down[j] + row[j - 1] + row[j + 1])) + b * other[j]
    for j in (0, nx - 1):
        left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
        out[j] = a * (4.0 * row[j] - (up[j] + down[j] + row[left] + row[right])) + b * other[j]


@_compiled
def measure_2(
    u: Any,
    w: Any,
    heights: Any,
    v: Any,
    k0: float,
    k1: float,
    spread: float,
    drag: float,
    shift: float,
    unit: float,
    bound: Any,
    b: Any,
    c: Any,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """Bound and both sources for a state of two fields and the anchors v; ``sums``: sum of w."""
    nx = u.shape[1]
    line = np.empty(nx)
    inverse = 1.0 / unit
    for i in range(low, high):
        row, stretch, rough, anchors = u[i], w[i], heights[i], v[i]
        stencil_row(-inverse, u, -inverse * k1 / k0, w, i, line)
        part(line, b[i])
        stencil_row(spread, w, drag, w, i, line)
        total_stretch = 0.0
        for j in range(nx):
            line[j] = (row[j] - stretch[j] - anchors[j] + shift - line[j]) * inverse
            total_stretch += stretch[j]
        part(line, c[i])
        for j in range(nx):
            line[j] = (rough[j] - row[j]) * inverse
        part(line, bound[i])
        sums[i, 0] = total_stretch


@_inlined
def settle_row(row: Any, rough: Any, move: Any, least: Any, unit: float) -> None:
    """Add a correction to a row of a surface; where it closes the gap there is contact."""
    for j in range(row.shape[0]):
        moved = max(rough[j], row[j] + unit * move[j])
        row[j] = moved if move[j] > least[j] else rough[j]


@_compiled
def settle(u: Any, heights: Any, e: Any, bound: Any, unit: float, low: int, high: int) -> None:
    """Add a correction to a surface."""
    nx = u.shape[1]
    move, least = np.empty(nx, np.float32), np.empty(nx, np.float32)
    for i in range(low, high):
        join(e[i], move)
        join(bound[i], least)
        settle_row(u[i], heights[i], move, least, unit)


@_inlined
def add_row(row: Any, move: Any, unit: float, offset: float) -> None:
    """Add a correction and a constant to a row."""
    for j in range(row.shape[0]):
        row[j] += unit * move[j] + offset


@_compiled
def add(w: Any, f: Any, unit: float, low: int, high: int) -> None:
    """Add a correction to a field."""
    move = np.empty(w.shape[1], np.float32)
    for i in range(low, high):
        join(f[i], move)
        add_row(w[i], move, unit, 0.0)


# A time step of creep, from one state to the next.


@_inlined
def advance_row(
    u: Any,
    w: Any,
    heights: Any,
    k0: float,
    k1: float,
    spreading: float,
    dragging: float,
    unit: float,
    level: float,
    i: int,
    bound: Any,
    b: Any,
    flow: Any,
    line: Any,
    sums: Any,
) -> None:
    """Bound, source and flow of row i; see `advance`."""
    nx = u.shape[1]
    row, stretch, rough = u[i], w[i], heights[i]
    inverse = 1.0 / unit
    stencil_row(-inverse, u, -inverse * k1 / k0, w, i, line)
    part(line, b[i])
    stencil_row(inverse * spreading, w, inverse * dragging, w, i, line)
    part(line, flow[i])
    sum_w = sum_u = squares_w = squares_u = largest = free_sites = 0.0
    for j in range(nx):
        line[j] = (rough[j] - row[j]) * inverse
        free_sites += 1.0 if row[j] > rough[j] else 0.0
        rise = row[j] - level
        sum_w += stretch[j]
        sum_u += rise
        squares_w += stretch[j] * stretch[j]
        squares_u += rise * rise
    part(line, bound[i])
    for j in range(nx):
        size = abs(row[j])
        largest = size if size > largest else largest
    sums[0], sums[1], sums[2], sums[3] = sum_w, sum_u, squares_w, squares_u
    sums[4], sums[5] = largest, nx - free_sites


@_compiled
def advance(
    e: Any,
    f: Any,
    offset: float,
    u: Any,
    w: Any,
    heights: Any,
    k0: float,
    k1: float,
    spreading: float,
    dragging: float,
    unit: float,
    level: float,
    bound: Any,
    b: Any,
    flow: Any,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """Add corrections to a state, and an offset to w; then the bound, source and flow of the new one.

    The flow is spreading L w + dragging w. ``sums``: w, u - level, their squares, the largest u, contacts.
    The first row and the last are left to `advance_edges`.
    """
    nx = u.shape[1]
    move, least, line = np.empty(nx, np.float32), np.empty(nx, np.float32), np.empty(nx)
    for i in range(low, high):
        join(e[i], move)
        join(bound[i], least)
        settle_row(u[i], heights[i], move, least, unit)
        join(f[i], move)
        add_row(w[i], move, unit, offset)
        if i - 1 > low:
            advance_row(
                u,
                w,
                heights,
                k0,
                k1,
                spreading,
                dragging,
                unit,
                level,
                i - 1,
                bound,
                b,
                flow,
                line,
                sums[i - 1],
            )


@_compiled
def advance_edges(
    u: Any,
    w: Any,
    heights: Any,
    k0: float,
    k1: float,
    spreading: float,
    dragging: float,
    unit: float,
    level: float,
    bound: Any,
    b: Any,
    flow: Any,
    sums: Any,
    edge: int,
) -> None:
    """What `advance` left undone on both sides of an edge between slabs."""
    ny, nx = u.shape
    line = np.empty(nx)
    for i in ((edge - 1) % ny, edge):
        advance_row(u, w, heights, k0, k1, spreading, dragging, unit, level, i, bound, b, flow, line, sums[i])


@_compiled
def begin_stage_1(
    last_e: Any,
    last_f: Any,
    before_e: Any,
    before_f: Any,
    ahead: Any,
    back: Any,
    rate: Any,
    flow: Any,
    tau: Any,
    bound: Any,
    nx: int,
    e: Any,
    f: Any,
    c: Any,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """First guess from the last time steps, and the source -tau (rate + flow); ``sums`` of e, f and c."""
    m = e.shape[2] - 1
    for i in range(low, high):
        sum_e = sum_f = sum_c = np.float32(0.0)
        for side in range(2):
            for k in range(side, m if side == 0 else 1 + nx - m):
                move = max(bound[i, side, k], ahead * last_e[i, side, k] + back * before_e[i, side, k])
                stretch = ahead * last_f[i, side, k] + back * before_f[i, side, k]
                source = -tau * (rate[i, side, k] + flow[i, side, k])
                e[i, side, k], f[i, side, k], c[i, side, k] = move, stretch, source
                sum_e += move
                sum_f += stretch
                sum_c += source
        wrap(e[i], nx)
        wrap(f[i], nx)
        sums[i, 0], sums[i, 1], sums[i, 2] = sum_e, sum_f, sum_c


@_compiled
def begin_stage_2(
    last_e: Any,
    last_f: Any,
    before_e: Any,
    before_f: Any,
    ahead: Any,
    back: Any,
    growth: Any,
    offset: Any,
    rate: Any,
    flow: Any,
    tau: Any,
    weight: Any,
    bound: Any,
    nx: int,
    e: Any,
    f: Any,
    middle: Any,
    c: Any,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """Rate at the end of the first stage, f plus an offset; then the second, as in `begin_stage_1`."""
    m = e.shape[2] - 1
    pace = np.float32(1.0) / tau
    for i in range(low, high):
        sum_e = sum_f = sum_c = np.float32(0.0)
        for side in range(2):
            for k in range(side, m if side == 0 else 1 + nx - m):
                move, stretch = e[i, side, k], f[i, side, k] + offset
                found = (move - stretch) * pace - rate[i, side, k]
                source = -weight * (rate[i, side, k] + found) - tau * flow[i, side, k]
                guess = growth * move + ahead * last_e[i, side, k] + back * before_e[i, side, k]
                move = max(bound[i, side, k], guess)
                stretch = growth * stretch + ahead * last_f[i, side, k] + back * before_f[i, side, k]
                e[i, side, k], f[i, side, k], c[i, side, k] = move, stretch, source
                middle[i, side, k] = found
                sum_e += move
                sum_f += stretch
                sum_c += source
        wrap(e[i], nx)
        wrap(f[i], nx)
        sums[i, 0], sums[i, 1], sums[i, 2] = sum_e, sum_f, sum_c


@_compiled
def finish_step(
    e: Any,
    f: Any,
    offset: Any,
    rate: Any,
    middle: Any,
    tau: Any,
    weight: Any,
    first: Any,
    second: Any,
    third: Any,
    nx: int,
    end: Any,
    error: Any,
    low: int,
    high: int,
) -> None:
    """Rate at the end, f plus an offset, and the sum of the three rates with weights, rows in order."""
    m = e.shape[2] - 1
    pace = np.float32(1.0) / tau
    line = np.zeros((2, m + 1), np.float32)
    for i in range(low, high):
        for side in range(2):
            for k in range(side, m if side == 0 else 1 + nx - m):
                before, between = rate[i, side, k], middle[i, side, k]
                found = (e[i, side, k] - f[i, side, k] - offset - weight * (before + between)) * pace
                end[i, side, k] = found
                line[side, k] = first * before + second * between + third * found
        join(line, error[i])


@_compiled
def damped_power(
    modes: Any,
    y: Any,
    x: Any,
    bed: float,
    touching: float,
    spreading: float,
    dragging: float,
    out: Any,
    low: int,
    high: int,
) -> None:
    """Sums by rows of squared modes, each times a / (1 + z) + (1 - a) / (1 + z lam / (lam + bed)).

    z = spreading lam + dragging, a = ``touching``, lam = y + x, the eigenvalue of L. Modes that stand for
    their conjugates too count twice; ``out[i, 1]`` is the part of the first column, ``out[i, 2]`` that of the
    last.
    """
    for i in range(low, high):
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


# One field: (lap + bed) e = b - uniform, e >= bound; ``diagonal`` is 4 + bed.


@_inlined
def relax_row_1(e: Any, bound: Any, b: Any, diagonal: Any, uniform: Any, nx: int, i: int, color: int) -> None:
    """Projected Gauss-Seidel on the sites of one color in row i."""
    ny, _, width = e.shape
    m = width - 1
    side = (i + color) & 1
    inverse = np.float32(1.0) / diagonal
    row, other = e[i, side], e[i, 1 - side]
    up, down = e[i - 1 if i > 0 else ny - 1, side], e[i + 1 if i < ny - 1 else 0, side]
    least, source = bound[i, side], b[i, side]
    for k in range(side, m if side == 0 else 1 + nx - m):
        neighbors = up[k] + down[k] + other[k - side] + other[k - side + 1]
        row[k] = max(least[k], (neighbors + source[k] - uniform) * inverse)
    wrap(e[i], nx)


@_compiled
def sweeps_1(
    e: Any, bound: Any, b: Any, diagonal: Any, uniform: Any, nx: int, halves: int, low: int, high: int
) -> None:
    """Half sweeps, one after the other in a single pass; each stops one row farther from both ends.

    Where the number of rows is odd the last has the color of the first, its neighbor, and is left to
    `close_sweeps_1`.
    """
    last = high - 1 if high == e.shape[0] and high % 2 else high
    for front in range(low, high):
        for half in range(halves):
            i = front - half
            if low + half <= i < last - half:
                relax_row_1(e, bound, b, diagonal, uniform, nx, i, half & 1)


@_compiled
def close_sweeps_1(
    e: Any, bound: Any, b: Any, diagonal: Any, uniform: Any, nx: int, halves: int, edge: int
) -> None:
    """What `sweeps_1` left undone on both sides of an edge between slabs."""
    ny = e.shape[0]
    odd = 1 if edge == 0 and ny % 2 else 0
    for half in range(1 - odd, halves):
        for i in range(edge - half - odd, edge + half):
            relax_row_1(e, bound, b, diagonal, uniform, nx, i % ny, half & 1)


@_inlined
def defect_row_1(
    e: Any, bound: Any, b: Any, diagonal: Any, uniform: Any, nx: int, i: int, defect: Any, sums: Any
) -> None:
    """Minus the force off contact, in row i; ``sums``: the largest, the largest correction, contacts."""
    ny, _, width = e.shape
    m = width - 1
    zero, one = np.float32(0.0), np.float32(1.0)
    worst = far = free_sites = zero
    for side in range(2):
        end = m if side == 0 else 1 + nx - m
        row, other, least, source, out = e[i, side], e[i, 1 - side], bound[i, side], b[i, side], defect[side]
        up, down = e[i - 1 if i > 0 else ny - 1, side], e[i + 1 if i < ny - 1 else 0, side]
        for k in range(side, end):
            neighbors = up[k] + down[k] + other[k - side] + other[k - side + 1]
            free = one if row[k] > least[k] else zero
            free_sites += free
            out[k] = (neighbors + source[k] - uniform - diagonal * row[k]) * free
        for k in range(side, end):
            value, move = abs(out[k]), abs(row[k])
            worst = value if value > worst else worst
            far = move if move > far else far
    sums[0], sums[1], sums[2] = worst, far, nx - free_sites


@_compiled
def restrict_1(
    e: Any,
    bound: Any,
    b: Any,
    diagonal: Any,
    uniform: Any,
    nx: int,
    out: Any,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """Defect on coarse rows low to high."""
    ny, _, width = e.shape
    defect, line = np.zeros((3, 2, width), np.float32), np.empty(width - 1, np.float32)
    ignored = np.empty(sums.shape[1])
    for k in range(low, high):
        for offset in range(-1, 2):
            i, row = fine_row(k, offset, ny), defect[(2 * k + offset) % 3]
            if i < 0:
                row[:] = np.float32(0.0)
            elif not (offset == -1 and k > low):  # else it is still in the buffer
                into = ignored if offset == -1 else sums[i]
                defect_row_1(e, bound, b, diagonal, uniform, nx, i, row, into)
        above, here, below = (2 * k - 1) % 3, 2 * k % 3, (2 * k + 1) % 3
        restrict_rows(defect[above], defect[here], defect[below], nx, line, out[k])


@_inlined
def product(x: Any, y: Any, nx: int) -> Any:
    """Sum of x y over a parted row."""
    m = x.shape[1] - 1
    value = np.float32(0.0)
    for k in range(m):
        value += x[0, k] * y[0, k]
    for k in range(1, 1 + nx - m):
        value += x[1, k] * y[1, k]
    return value


@_inlined
def along_bonds(x: Any, x_next: Any, y: Any, y_next: Any, nx: int) -> Any:
    """Sum of (difference of x) (difference of y) over the bonds to the right of a row and below it."""
    m = x.shape[1] - 1
    value = np.float32(0.0)
    for side in range(2):
        a, a_right, a_below = x[side], x[1 - side], x_next[side]
        b, b_right, b_below = y[side], y[1 - side], y_next[side]
        for k in range(side, m if side == 0 else 1 + nx - m):
            value += (a[k] - a_below[k]) * (b[k] - b_below[k])
            value += (a[k] - a_right[k - side + 1]) * (b[k] - b_right[k - side + 1])
    return value


@_inlined
def off_contact(line: Any, e: Any, bound: Any, nx: int, out: Any) -> None:
    """A parted row where it is free, zero in contact."""
    m = e.shape[1] - 1
    for side in range(2):
        for k in range(side, m if side == 0 else 1 + nx - m):
            out[side, k] = line[side, k] if e[side, k] > bound[side, k] else np.float32(0.0)
    wrap(out, nx)


@_compiled
def products_1(
    coarse: Any,
    previous: Any,
    e: Any,
    bound: Any,
    b: Any,
    bed: Any,
    uniform: Any,
    nx: int,
    out: Any,
    low: int,
    high: int,
) -> None:
    """Products by rows, for correction d and previous move q: r.d, r.q, d.Sd, d.Sq, q.Sq, sum d, sum q."""
    ny, _, width = e.shape
    m = width - 1
    d, q = np.zeros((2, 2, width), np.float32), np.zeros((2, 2, width), np.float32)
    line = np.zeros((2, width), np.float32)
    for i in range(low, high + 1):
        here, now = i % ny, i % 2
        interpolate_row(coarse, here, ny, nx, line)
        off_contact(line, e[here], bound[here], nx, d[now])
        off_contact(previous[here], e[here], bound[here], nx, q[now])
        if i == low:
            continue
        x, y, d0, d1, q0, q1 = e[i - 1], e[here], d[1 - now], d[now], q[1 - now], q[now]
        zero = np.float32(0.0)
        rd = rq = dd = dq = qq = sd = sq = zero
        for side in range(2):
            a, a_right, a_below = x[side], x[1 - side], y[side]
            f, f_right, f_below = d0[side], d0[1 - side], d1[side]
            g, g_right, g_below = q0[side], q0[1 - side], q1[side]
            source = b[i - 1, side]
            for k in range(side, m if side == 0 else 1 + nx - m):
                known = bed * a[k] - source[k] + uniform
                a1, f1, g1 = a[k] - a_below[k], f[k] - f_below[k], g[k] - g_below[k]
                a2, f2, g2 = (
                    a[k] - a_right[k - side + 1],
                    f[k] - f_right[k - side + 1],
                    g[k] - g_right[k - side + 1],
                )
                rd += a1 * f1 + a2 * f2 + known * f[k]
                rq += a1 * g1 + a2 * g2 + known * g[k]
                dd += f1 * f1 + f2 * f2 + bed * f[k] * f[k]
                dq += f1 * g1 + f2 * g2 + bed * f[k] * g[k]
                qq += g1 * g1 + g2 * g2 + bed * g[k] * g[k]
                sd += f[k]
                sq += g[k]
        sums = out[i - 1]
        sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6] = rd, rq, dd, dq, qq, sd, sq


@_inlined
def move_row(line: Any, last: Any, e: Any, bound: Any, nx: int, alpha: Any, beta: Any) -> None:
    """Move the free sites of a row by ``alpha line + beta last``, which becomes the last; and project."""
    m = e.shape[1] - 1
    zero = np.float32(0.0)
    for side in range(2):
        for k in range(side, m if side == 0 else 1 + nx - m):
            here, least = e[side, k], bound[side, k]
            move = alpha * line[side, k] + beta * last[side, k] if here > least else zero
            last[side, k] = move
            e[side, k] = max(least, here + move)
    wrap(e, nx)


@_compiled
def correct_1(
    coarse: Any, previous: Any, e: Any, bound: Any, nx: int, alpha: Any, beta: Any, low: int, high: int
) -> None:
    """Move free sites by alpha times the correction plus beta times the previous move, and project."""
    ny, _, width = e.shape
    line = np.zeros((2, width), np.float32)
    for i in range(low, high):
        interpolate_row(coarse, i, ny, nx, line)
        move_row(line, previous[i], e[i], bound[i], nx, alpha, beta)


# One field on a coarse grid: (lap + bed mass + pins) e = b. gx, gy: couplings; mx, my: cell sizes.


@_compiled
def coarse_sweep_1(
    e: Any,
    b: Any,
    pins: Any,
    bed: Any,
    gx: Any,
    gy: Any,
    mx: Any,
    my: Any,
    nx: int,
    start: int,
    colors: int,
    low: int,
    high: int,
) -> None:
    """Gauss-Seidel on the sites of one color, or of one after the other."""
    ny, _, width = e.shape
    m = width - 1
    for n in range(colors * (high - low)):
        i, color = low + n % (high - low), start + n // (high - low)
        side = (i + color) & 1
        before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
        row, other, up, down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
        above, below, size = gy[before], gy[i], my[i]
        right, left, cell, source, pin = gx[side], gx[1 - side], mx[side], b[i, side], pins[i, side]
        for k in range(side, m if side == 0 else 1 + nx - m):
            g = left[k - side]
            diagonal = (g + right[k] + bed * cell[k]) * size + (above + below) * cell[k] + pin[k]
            neighbors = cell[k] * (above * up[k] + below * down[k])
            neighbors += size * (g * other[k - side] + right[k] * other[k - side + 1])
            row[k] = (source[k] + neighbors) / diagonal
        wrap(e[i], nx)


@_compiled
def coarse_restrict_1(
    e: Any,
    b: Any,
    pins: Any,
    bed: Any,
    gx: Any,
    gy: Any,
    mx: Any,
    my: Any,
    nx: int,
    uniform: Any,
    out: Any,
    low: int,
    high: int,
) -> None:
    """Defect b - uniform mass - (...) e on the next coarser grid, rows low to high."""
    ny, _, width = e.shape
    m = width - 1
    defect, line = np.zeros((3, 2, width), np.float32), np.empty(m, np.float32)
    for k in range(low, high):
        for offset in range(-1, 2):
            i, into = fine_row(k, offset, ny), defect[(2 * k + offset) % 3]
            if i < 0:
                into[:] = np.float32(0.0)
            elif not (offset == -1 and k > low):  # else it is still in the buffer
                before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
                above, below, size = gy[before], gy[i], my[i]
                for side in range(2):
                    row, other, up, down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
                    right, left, cell, source = gx[side], gx[1 - side], mx[side], b[i, side]
                    pin, to = pins[i, side], into[side]
                    for j in range(side, m if side == 0 else 1 + nx - m):
                        g = left[j - side]
                        diagonal = (g + right[j] + bed * cell[j]) * size + (above + below) * cell[j] + pin[j]
                        neighbors = cell[j] * (above * up[j] + below * down[j] - uniform * size)
                        neighbors += size * (g * other[j - side] + right[j] * other[j - side + 1])
                        to[j] = source[j] + neighbors - diagonal * row[j]
        above, here, below = (2 * k - 1) % 3, 2 * k % 3, (2 * k + 1) % 3
        restrict_rows(defect[above], defect[here], defect[below], nx, line, out[k])


@_compiled
def coarse_correct(
    coarse: Any, e: Any, b: Any, shift: Any, mx: Any, my: Any, nx: int, low: int, high: int
) -> None:
    """Add the interpolated correction to e, and ``shift`` times the cell size to b."""
    ny, _, width = e.shape
    m = width - 1
    line = np.zeros((2, width), np.float32)
    for i in range(low, high):
        interpolate_row(coarse, i, ny, nx, line)
        size = shift * my[i]
        for side in range(2):
            for k in range(side, m if side == 0 else 1 + nx - m):
                e[i, side, k] += line[side, k]
                b[i, side, k] += size * mx[side, k]
        wrap(e[i], nx)


# Two fields, u and its stretch w = u - u0, for an implicit step of creep from the anchors v:
#     k0 L u + k1 w = r            w + spread L w + drag w = u - v + shift
# and the corrections e and f of both, with ``lag`` = 1 + drag:
#     lap e + bed f = b            spread lap f + lag f - e = c + shift


@_inlined
def relax_row_2(
    e: Any,
    f: Any,
    bound: Any,
    b: Any,
    c: Any,
    bed: Any,
    spread: Any,
    lag: Any,
    shift: Any,
    nx: int,
    i: int,
    color: int,
) -> None:
    """Projected Gauss-Seidel, both fields of a site at once, on the sites of one color in row i."""
    ny, _, width = e.shape
    m = width - 1
    side = (i + color) & 1
    four = np.float32(4.0)
    damping = np.float32(1.0) / (lag + four * spread)
    damped = bed * damping
    inverse = np.float32(1.0) / (four + damped)
    before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
    e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
    f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
    least, first, second = bound[i, side], b[i, side], c[i, side]
    for k in range(side, m if side == 0 else 1 + nx - m):
        neighbors = e_up[k] + e_down[k] + e_other[k - side] + e_other[k - side + 1] + first[k]
        known = spread * (f_up[k] + f_down[k] + f_other[k - side] + f_other[k - side + 1]) + second[k] + shift
        value = max(least[k], (neighbors - damped * known) * inverse)
        e_row[k] = value
        f_row[k] = (value + known) * damping
    wrap(e[i], nx)
    wrap(f[i], nx)


@_inlined
def defect_row_2(
    e: Any,
    f: Any,
    bound: Any,
    b: Any,
    c: Any,
    bed: Any,
    spread: Any,
    lag: Any,
    shift: Any,
    nx: int,
    i: int,
    balance: Any,
    creep: Any,
    sums: Any,
) -> None:
    """Defects of both equations in row i; ``sums``: their squares, sum of f, contacts, squares of e."""
    ny, _, width = e.shape
    m = width - 1
    zero, one, four = np.float32(0.0), np.float32(1.0), np.float32(4.0)
    before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
    squares_1 = squares_2 = stretch = free_sites = moves = zero
    diagonal = lag + four * spread
    for side in range(2):
        e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
        f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
        least, first, second = bound[i, side], b[i, side], c[i, side]
        out_1, out_2 = balance[side], creep[side]
        for k in range(side, m if side == 0 else 1 + nx - m):
            neighbors = e_up[k] + e_down[k] + e_other[k - side] + e_other[k - side + 1] - four * e_row[k]
            free = one if e_row[k] > least[k] else zero
            value = (neighbors + first[k] - bed * f_row[k]) * free
            flow = spread * (f_up[k] + f_down[k] + f_other[k - side] + f_other[k - side + 1])
            flow += second[k] + shift + e_row[k] - diagonal * f_row[k]
            out_1[k], out_2[k] = value, flow
            squares_1 += value * value
            squares_2 += flow * flow
            free_sites += free
            stretch += f_row[k]
            moves += e_row[k] * e_row[k]
    sums[0], sums[1], sums[2], sums[3], sums[4] = squares_1, squares_2, stretch, nx - free_sites, moves


@_inlined
def restrict_pair(balance: Any, creep: Any, k: int, nx: int, line: Any, out_1: Any, out_2: Any) -> None:
    """Row k of two coarse fields, from buffers in which fine row i has the index i modulo 3."""
    above, here, below = (2 * k - 1) % 3, 2 * k % 3, (2 * k + 1) % 3
    restrict_rows(balance[above], balance[here], balance[below], nx, line, out_1[k])
    restrict_rows(creep[above], creep[here], creep[below], nx, line, out_2[k])


@_compiled
def restrict_2(
    e: Any,
    f: Any,
    bound: Any,
    b: Any,
    c: Any,
    bed: Any,
    spread: Any,
    lag: Any,
    shift: Any,
    nx: int,
    out_1: Any,
    out_2: Any,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """Both defects on coarse rows low to high."""
    ny, _, width = e.shape
    balance, creep = np.zeros((3, 2, width), np.float32), np.zeros((3, 2, width), np.float32)
    line, ignored = np.empty(width - 1, np.float32), np.empty(sums.shape[1])
    for k in range(low, high):
        for offset in range(-1, 2):
            i, n = fine_row(k, offset, ny), (2 * k + offset) % 3
            if i < 0:
                balance[n] = np.float32(0.0)
                creep[n] = np.float32(0.0)
            elif not (offset == -1 and k > low):  # else it is still in the buffers
                into = ignored if offset == -1 else sums[i]
                defect_row_2(e, f, bound, b, c, bed, spread, lag, shift, nx, i, balance[n], creep[n], into)
        restrict_pair(balance, creep, k, nx, line, out_1, out_2)


@_inlined
def correct_row_2(
    coarse_e: Any,
    coarse_f: Any,
    previous_e: Any,
    previous_f: Any,
    e: Any,
    f: Any,
    bound: Any,
    nx: int,
    alpha: Any,
    beta: Any,
    keeping: bool,
    i: int,
    line: Any,
) -> None:
    """Move free sites, and f everywhere, by alpha times the correction plus beta times the previous move.

    Unless moves are kept (``keeping``) there is no previous one, and alpha is 1.
    """
    ny, _, width = e.shape
    m = width - 1
    interpolate_row(coarse_e, i, ny, nx, line)
    if keeping:
        move_row(line, previous_e[i], e[i], bound[i], nx, alpha, beta)
    else:
        for side in range(2):
            for k in range(side, m if side == 0 else 1 + nx - m):
                here, least = e[i, side, k], bound[i, side, k]
                e[i, side, k] = max(least, here + line[side, k]) if here > least else least
        wrap(e[i], nx)
    interpolate_row(coarse_f, i, ny, nx, line)
    if keeping:
        for side in range(2):
            for k in range(side, m if side == 0 else 1 + nx - m):
                line[side, k] = alpha * line[side, k] + beta * previous_f[i, side, k]
                previous_f[i, side, k] = line[side, k]
        wrap(previous_f[i], nx)
    for side in range(2):
        for k in range(side, m if side == 0 else 1 + nx - m):
            f[i, side, k] += line[side, k]
    wrap(f[i], nx)


@_compiled
def cycle_2(
    coarse_e: Any,
    coarse_f: Any,
    previous_e: Any,
    previous_f: Any,
    alpha: Any,
    beta: Any,
    keeping: bool,
    correcting: bool,
    out_1: Any,
    out_2: Any,
    restricting: bool,
    e: Any,
    f: Any,
    bound: Any,
    b: Any,
    c: Any,
    bed: Any,
    spread: Any,
    lag: Any,
    shift: Any,
    nx: int,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """What a cycle does on the lattice, in a single pass: correction, a sweep, restriction of the defects.

    Row ``front`` moves from low to high. Behind it, at each moment:

        row         front          front - 1            front - 2           front - 3
        operation   correction     first half sweep     second half sweep   defect, restriction

    (one row less behind without a correction). Each operation stops one row farther from both ends of the
    slab than the one before; `close_cycle_2` and `restrict_2` do the rest. Where the number of rows is odd,
    the last row has the color of the first, its neighbor: `close_cycle_2` does it.
    """
    ny, _, width = e.shape
    line, order = np.zeros((2, width), np.float32), np.empty(width - 1, np.float32)
    balance, creep = np.zeros((3, 2, width), np.float32), np.zeros((3, 2, width), np.float32)
    last = high - 1 if high == ny and high % 2 else high
    lead = 1 if correcting else 0
    for front in range(low, high):
        if correcting:
            correct_row_2(
                coarse_e, coarse_f, previous_e, previous_f, e, f, bound, nx, alpha, beta, keeping, front, line
            )
        for half in range(2):
            i, margin = front - lead - half, lead + half
            if low + margin <= i < last - margin:
                relax_row_2(e, f, bound, b, c, bed, spread, lag, shift, nx, i, half)
        i, margin = front - lead - 2, lead + 2
        if restricting and low + margin <= i < last - margin:
            n = i % 3
            defect_row_2(e, f, bound, b, c, bed, spread, lag, shift, nx, i, balance[n], creep[n], sums[i])
            if i % 2 == 1 and i - 2 >= low + margin:
                restrict_pair(balance, creep, i // 2, nx, order, out_1, out_2)


@_compiled
def close_cycle_2(
    e: Any,
    f: Any,
    bound: Any,
    b: Any,
    c: Any,
    bed: Any,
    spread: Any,
    lag: Any,
    shift: Any,
    nx: int,
    lead: int,
    edge: int,
) -> None:
    """The sweep that `cycle_2` left undone on both sides of an edge between slabs."""
    ny = e.shape[0]
    odd = 1 if edge == 0 and ny % 2 else 0
    for half in range(2):
        for i in range(edge - half - lead - odd, edge + half + lead):
            relax_row_2(e, f, bound, b, c, bed, spread, lag, shift, nx, i % ny, half)


@_inlined
def form_2(
    x: Any,
    x1: Any,
    f: Any,
    f1: Any,
    y: Any,
    y1: Any,
    g: Any,
    g1: Any,
    bed: Any,
    spread: Any,
    lag: Any,
    nx: int,
) -> Any:
    """Symmetric form of (x, f) and (y, g) on a row and its bonds to the next, x1, f1, y1 and g1."""
    creep = spread * along_bonds(f, f1, g, g1, nx) + lag * product(f, g, nx)
    return along_bonds(x, x1, y, y1, nx) + bed * (product(x, g, nx) + product(f, y, nx) - creep)


@_compiled
def products_2(
    coarse_e: Any,
    coarse_f: Any,
    previous_e: Any,
    previous_f: Any,
    e: Any,
    f: Any,
    bound: Any,
    b: Any,
    c: Any,
    bed: Any,
    spread: Any,
    lag: Any,
    shift: Any,
    nx: int,
    out: Any,
    low: int,
    high: int,
) -> None:
    """Products of the symmetric form by rows, for the correction (d, p) and the previous move (q, g).

    Gradient with either, then dd, dq, qq, the sum of p and that of g.
    """
    ny, _, width = e.shape
    d, p = np.zeros((2, 2, width), np.float32), np.zeros((2, 2, width), np.float32)
    q, ones = np.zeros((2, 2, width), np.float32), np.ones((2, width), np.float32)
    line = np.zeros((2, width), np.float32)
    for i in range(low, high + 1):
        y, now = i % ny, i % 2
        interpolate_row(coarse_e, y, ny, nx, line)
        off_contact(line, e[y], bound[y], nx, d[now])
        off_contact(previous_e[y], e[y], bound[y], nx, q[now])
        interpolate_row(coarse_f, y, ny, nx, p[now])
        if i == low:
            continue
        x = i - 1
        d0, d1, p0, p1, q0, q1 = d[1 - now], d[now], p[1 - now], p[now], q[1 - now], q[now]
        g0, g1, e0, e1, f0, f1 = previous_f[x], previous_f[y], e[x], e[y], f[x], f[y]
        sum_p, sum_g = product(p0, ones, nx), product(g0, ones, nx)
        sums = out[x]
        sums[0] = form_2(e0, e1, f0, f1, d0, d1, p0, p1, bed, spread, lag, nx) - product(b[x], d0, nx)
        sums[0] += bed * (product(c[x], p0, nx) + shift * sum_p)
        sums[1] = form_2(e0, e1, f0, f1, q0, q1, g0, g1, bed, spread, lag, nx) - product(b[x], q0, nx)
        sums[1] += bed * (product(c[x], g0, nx) + shift * sum_g)
        sums[2] = form_2(d0, d1, p0, p1, d0, d1, p0, p1, bed, spread, lag, nx)
        sums[3] = form_2(d0, d1, p0, p1, q0, q1, g0, g1, bed, spread, lag, nx)
        sums[4] = form_2(q0, q1, g0, g1, q0, q1, g0, g1, bed, spread, lag, nx)
        sums[5], sums[6] = sum_p, sum_g


# Two fields on a coarse grid:
#     (lap + pins) e + bed mass f = b          (spread lap + lag mass) f - mass e = c


@_compiled
def coarse_sweep_2(
    e: Any,
    f: Any,
    b: Any,
    c: Any,
    pins: Any,
    bed: Any,
    spread: Any,
    lag: Any,
    gx: Any,
    gy: Any,
    mx: Any,
    my: Any,
    nx: int,
    start: int,
    colors: int,
    low: int,
    high: int,
) -> None:
    """Gauss-Seidel, both fields of a site at once, on the sites of one color, or of one after the other."""
    ny, _, width = e.shape
    m = width - 1
    one = np.float32(1.0)
    for n in range(colors * (high - low)):
        i, color = low + n % (high - low), start + n // (high - low)
        side = (i + color) & 1
        before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
        above, below, size = gy[before], gy[i], my[i]
        e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
        f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
        right, left, cell = gx[side], gx[1 - side], mx[side]
        pin, first, second = pins[i, side], b[i, side], c[i, side]
        for k in range(side, m if side == 0 else 1 + nx - m):
            g = left[k - side]
            lap = (g + right[k]) * size + (above + below) * cell[k]
            mass = size * cell[k]
            neighbors = cell[k] * (above * e_up[k] + below * e_down[k])
            neighbors += size * (g * e_other[k - side] + right[k] * e_other[k - side + 1]) + first[k]
            flow = cell[k] * (above * f_up[k] + below * f_down[k])
            flow += size * (g * f_other[k - side] + right[k] * f_other[k - side + 1])
            known = second[k] + spread * flow
            inverse = one / (mass * lag + spread * lap)
            coupling = bed * mass * inverse
            value = (neighbors - coupling * known) / (lap + pin[k] + coupling * mass)
            e_row[k] = value
            f_row[k] = (known + mass * value) * inverse
        wrap(e[i], nx)
        wrap(f[i], nx)


@_compiled
def coarse_restrict_2(
    e: Any,
    f: Any,
    b: Any,
    c: Any,
    pins: Any,
    bed: Any,
    spread: Any,
    lag: Any,
    gx: Any,
    gy: Any,
    mx: Any,
    my: Any,
    nx: int,
    out_b: Any,
    out_c: Any,
    low: int,
    high: int,
) -> None:
    """Defects of both equations on the next coarser grid, rows low to high."""
    ny, _, width = e.shape
    m = width - 1
    balance, creep = np.zeros((3, 2, width), np.float32), np.zeros((3, 2, width), np.float32)
    line = np.empty(width - 1, np.float32)
    for k in range(low, high):
        for offset in range(-1, 2):
            i, n = fine_row(k, offset, ny), (2 * k + offset) % 3
            if i < 0:
                balance[n] = np.float32(0.0)
                creep[n] = np.float32(0.0)
            elif not (offset == -1 and k > low):  # else it is still in the buffers
                before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
                above, below, size = gy[before], gy[i], my[i]
                for side in range(2):
                    e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
                    f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
                    right, left, cell = gx[side], gx[1 - side], mx[side]
                    pin, first, second = pins[i, side], b[i, side], c[i, side]
                    out_1, out_2 = balance[n, side], creep[n, side]
                    for j in range(side, m if side == 0 else 1 + nx - m):
                        g = left[j - side]
                        lap = (g + right[j]) * size + (above + below) * cell[j]
                        mass = size * cell[j]
                        neighbors = cell[j] * (above * e_up[j] + below * e_down[j])
                        neighbors += size * (g * e_other[j - side] + right[j] * e_other[j - side + 1])
                        flow = cell[j] * (above * f_up[j] + below * f_down[j])
                        flow += size * (g * f_other[j - side] + right[j] * f_other[j - side + 1])
                        out_1[j] = first[j] + neighbors - (lap + pin[j]) * e_row[j] - bed * mass * f_row[j]
                        out_2[j] = second[j] + spread * (flow - lap * f_row[j])
                        out_2[j] += mass * (e_row[j] - lag * f_row[j])
        restrict_pair(balance, creep, k, nx, line, out_b, out_c)


# Fields of the spring lattice.


@_compiled
def lattice_force(u: Any, w: Any, k0: float, k1: float, out: Any, low: int, high: int) -> None:
    """Force k0 L u + k1 w in rows low to high."""
    for i in range(low, high):
        stencil_row(k0, u, k1, w, i, out[i])


@_compiled
def bond_energy(u: Any, out: Any, low: int, high: int) -> None:
    """Sum of the squared differences between neighbors, by rows."""
    ny, nx = u.shape
    for i in range(low, high):
        row, down = u[i], u[i + 1 if i < ny - 1 else 0]
        total = (row[0] - row[nx - 1]) ** 2
        for j in range(nx - 1):
            total += (row[j + 1] - row[j]) ** 2
        for j in range(nx):
            total += (down[j] - row[j]) ** 2
        out[i] = total


@_compiled
def extremes(force: Any, in_contact: Any, out: Any, low: int, high: int) -> None:
    """By rows: the largest size off contact, the least in contact (at most 0), the sum there, contacts."""
    for i in range(low, high):
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


@_compiled
def balance(
    u: Any, w: Any, heights: Any, k0: float, k1: float, out: Any, carried: Any, low: int, high: int
) -> None:
    """Stretch -k0 L u / k1 off contact; ``carried``: row sums of force / k1 in contact, without tension."""
    nx = u.shape[1]
    for i in range(low, high):
        row = out[i]
        stencil_row(-k0 / k1, u, 0.0, u, i, row)
        total = 0.0
        for j in range(nx):
            force = max(w[i, j] - row[j], 0.0) if u[i, j] <= heights[i, j] else 0.0
            total += force
        carried[i] = total


@_compiled
def carry(u: Any, w: Any, heights: Any, scale: float, out: Any, low: int, high: int) -> None:
    """Add ``scale`` times the forces that `balance` summed to the stretch."""
    for i in range(low, high):
        row = out[i]
        for j in range(u.shape[1]):
            force = max(w[i, j] - row[j], 0.0) if u[i, j] <= heights[i, j] else 0.0
            row[j] += scale * force


@_compiled
def overlap(heights: Any, level: float, out: Any, low: int, high: int) -> None:
    """Sum of what rises above a level, and the number of sites that do, by rows."""
    for i in range(low, high):
        row = heights[i]
        total = count = 0.0
        for j in range(row.shape[0]):
            rise = row[j] - level
            total += rise if rise > 0.0 else 0.0
            count += 1.0 if rise > 0.0 else 0.0
        out[i, 0], out[i, 1] = total, count


# Fields of a time step, each in one pass through memory.


@_compiled
def combine(a: float, x: Any, b: float, y: Any, out: Any, low: int, high: int) -> None:
    """Sum a x + b y."""
    for i in range(low, high):
        for j in range(x.shape[1]):
            out[i, j] = a * x[i, j] + b * y[i, j]
