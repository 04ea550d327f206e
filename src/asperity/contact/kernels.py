r"""The loops over neighbors, compiled.

Fine fields are double precision; everything on coarse grids is single, in units in which k0 = 1, for
coarse grids only correct. Each kernel works on rows ``low <= i < high`` so that threads can share a
grid; sums are kept row by row, so that results do not depend on the number of threads. Half sweeps
visit the sites of one color of a checkerboard: new values of a row go through a buffer, which lets the
compiler use vector instructions. On fine grids several half sweeps follow each other at a distance of
one row, so that a row is fetched from memory once.

Parameters are arguments, never globals: compiled code is kept on disk and would go stale.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

_compiled = njit(
    nogil=True, cache=True, error_model="numpy", fastmath={"contract", "reassoc", "nsz", "arcp", "nnan"}
)


# Between grids: bilinear interpolation, and its transpose. Every other site belongs to the coarse grid.


@_compiled
def restrict_row(row: Any, out: Any, whole: Any, half: Any) -> None:
    """Add a fine row to a coarse row: coarse sites weigh ``whole``, sites between them ``half``."""
    n, m = row.shape[0], out.shape[0]
    if n == 1:
        out[0] += whole * row[0]
        return
    for j in range(1, m - 1):
        out[j] += whole * row[2 * j] + half * (row[2 * j - 1] + row[2 * j + 1])
    first = whole * row[0] + half * row[1]
    if n % 2 == 0:
        first += half * row[n - 1]
    out[0] += first
    if m > 1:
        last = whole * row[2 * m - 2] + half * row[2 * m - 3]
        if n % 2 == 0:
            last += half * row[n - 1]
        out[m - 1] += last


@_compiled
def interpolate_row(coarse: Any, i: int, ny: int, half: Any, between: Any, out: Any) -> None:
    """Row i of a fine grid of ny rows, interpolated; ``between`` is a buffer as long as a coarse row."""
    my, m = coarse.shape
    n = out.shape[0]
    above = coarse[i // 2]
    if i % 2 == 0 or ny == 1:
        for j in range(m):
            between[j] = above[j]
    else:
        below = coarse[i // 2 + 1 if i // 2 + 1 < my else 0]
        for j in range(m):
            between[j] = half * (above[j] + below[j])
    for j in range(m - 1):
        out[2 * j] = between[j]
        out[2 * j + 1] = half * (between[j] + between[j + 1])
    out[2 * m - 2] = between[m - 1]
    if 2 * m - 1 < n:
        out[2 * m - 1] = half * (between[m - 1] + between[0])


@_compiled
def fine_row(coarse_row: int, offset: int, ny: int) -> int:
    """Fine row at an offset of -1, 0 or 1 from a coarse row, or -1 if the grid has none there."""
    i = 2 * coarse_row + offset
    if ny == 1:
        return i if offset == 0 else -1
    if i < 0:
        return ny - 1 if ny % 2 == 0 else -1
    return i if i < ny else -1


# Pins: contacts as the coarse grids feel them.


@_compiled
def pins_of_contacts(u: Any, heights: Any, strength: Any, out: Any, low: int, high: int) -> None:
    """Pins on the first coarse grid: each contact counts ``strength``."""
    ny, nx = u.shape
    total = np.empty(nx, np.float32)
    half, zero = np.float32(0.5), np.float32(0.0)
    for k in range(low, high):
        total[:] = zero
        for offset in range(-1, 2):
            i = fine_row(k, offset, ny)
            if i < 0:
                continue
            part = strength if offset == 0 else half * strength
            for j in range(nx):
                total[j] += part if u[i, j] <= heights[i, j] else zero
        out[k] = zero
        restrict_row(total, out[k], np.float32(1.0), half)


@_compiled
def coarser_pins(pins: Any, softening: Any, mean: Any, out: Any) -> None:
    """Pins on the next coarser grid: what stands out from the mean softens."""
    ny, nx = pins.shape
    row = np.empty(nx, np.float32)
    one, half, zero = np.float32(1.0), np.float32(0.5), np.float32(0.0)
    for k in range(out.shape[0]):
        out[k] = zero
        for offset in range(-1, 2):
            i = fine_row(k, offset, ny)
            if i < 0:
                continue
            for j in range(nx):
                row[j] = pins[i, j] / (one + softening * max(pins[i, j] - mean, zero))
            if offset == 0:
                restrict_row(row, out[k], one, half)
            else:
                restrict_row(row, out[k], half, half * half)


# One field: S = k0 lam + bed, force k0 L u + bed u + push.


@_compiled
def relax_row_1(
    u: Any, heights: Any, k0: float, bed: float, push: float, i: int, color: int, new: Any
) -> None:
    """Projected Gauss-Seidel on the sites of one color in row i."""
    ny, nx = u.shape
    inverse = 1.0 / (4.0 * k0 + bed)
    up, down, row = u[i - 1 if i > 0 else ny - 1], u[i + 1 if i < ny - 1 else 0], u[i]
    rough = heights[i]
    for j in range(1, nx - 1):
        new[j] = max(rough[j], (k0 * (up[j] + down[j] + row[j - 1] + row[j + 1]) - push) * inverse)
    for j in (0, nx - 1):
        left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
        new[j] = max(rough[j], (k0 * (up[j] + down[j] + row[left] + row[right]) - push) * inverse)
    for j in range((i + color) & 1, nx, 2):
        row[j] = new[j]


@_compiled
def sweeps_1(
    u: Any, heights: Any, k0: float, bed: float, push: float, halves: int, low: int, high: int
) -> None:
    """Half sweeps, one after the other in a single pass; each stops one row farther from both ends.

    Where the number of rows is odd the last has the color of the first, its neighbor, and waits.
    """
    new = np.empty(u.shape[1])
    last = high - 1 if high == u.shape[0] and high % 2 else high
    for front in range(low, high + halves - 1):
        for half in range(halves):
            i = front - half
            if low + half <= i < last - half:
                relax_row_1(u, heights, k0, bed, push, i, half & 1, new)


@_compiled
def close_sweeps_1(u: Any, heights: Any, k0: float, bed: float, push: float, halves: int, edge: int) -> None:
    """What `sweeps_1` left undone on both sides of an edge between slabs."""
    ny, nx = u.shape
    new = np.empty(nx)
    odd = 1 if edge == 0 and ny % 2 else 0
    for half in range(1 - odd, halves):
        for i in range(edge - half - odd, edge + half):
            relax_row_1(u, heights, k0, bed, push, i % ny, half & 1, new)


@_compiled
def defect_row_1(
    u: Any, heights: Any, k0: float, bed: float, push: float, i: int, defect: Any, sums: Any
) -> None:
    """Minus the force off contact, in row i; ``sums``: largest defect, pulls, load, contacts, sum."""
    ny, nx = u.shape
    up, down, row = u[i - 1 if i > 0 else ny - 1], u[i + 1 if i < ny - 1 else 0], u[i]
    rough = heights[i]
    diagonal = 4.0 * k0 + bed
    for j in range(1, nx - 1):
        defect[j] = k0 * (up[j] + down[j] + row[j - 1] + row[j + 1]) - diagonal * row[j] - push
    for j in (0, nx - 1):
        left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
        defect[j] = k0 * (up[j] + down[j] + row[left] + row[right]) - diagonal * row[j] - push
    worst = pull = load = free_sites = total = 0.0
    for j in range(nx):  # sums and the largest apart, and no branches: the compiler makes vectors of both
        free = 1.0 if row[j] > rough[j] else 0.0
        value = defect[j]
        off_contact = value * free
        held = value - off_contact
        load -= held
        pull += held if held > 0.0 else 0.0
        free_sites += free
        total += off_contact
        defect[j] = off_contact
    for j in range(nx):
        value = abs(defect[j])
        worst = value if value > worst else worst
    sums[0], sums[1], sums[2], sums[3], sums[4] = worst, pull, load, nx - free_sites, total


@_compiled
def restrict_1(
    u: Any,
    heights: Any,
    k0: float,
    bed: float,
    push: float,
    scale: float,
    out: Any,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """Defect, times ``scale``, on coarse rows low to high."""
    ny, nx = u.shape
    defect, total = np.empty(nx), np.empty(nx)
    ignored = np.empty(sums.shape[1])
    for k in range(low, high):
        total[:] = 0.0
        for offset in range(-1, 2):
            i = fine_row(k, offset, ny)
            if i < 0:
                continue
            if not (offset == -1 and k > low):  # else it is still in the buffer
                defect_row_1(u, heights, k0, bed, push, i, defect, ignored if offset == -1 else sums[i])
            part = scale if offset == 0 else 0.5 * scale
            for j in range(nx):
                total[j] += part * defect[j]
        out[k] = np.float32(0.0)
        restrict_row(total, out[k], 1.0, 0.5)


@_compiled
def directions_1(
    coarse: Any, step: Any, u: Any, heights: Any, i: int, between: Any, row: Any, first: Any, second: Any
) -> None:
    """Correction and previous step in row i, zero in contact."""
    ny, nx = u.shape
    interpolate_row(coarse, i, ny, np.float32(0.5), between, row)
    for j in range(nx):
        free = u[i, j] > heights[i, j]
        first[j] = row[j] if free else 0.0
        second[j] = step[i, j] if free else 0.0


@_compiled
def products_1(
    coarse: Any,
    step: Any,
    u: Any,
    heights: Any,
    k0: float,
    bed: float,
    push: float,
    out: Any,
    low: int,
    high: int,
) -> None:
    """Products by rows, for correction d and step q: r.d, r.q, d.Sd, d.Sq, q.Sq, sum d, sum q."""
    ny, nx = u.shape
    between, line = np.empty(coarse.shape[1], np.float32), np.empty(nx, np.float32)
    d, q = np.empty((3, nx)), np.empty((3, nx))
    diagonal = 4.0 * k0 + bed
    for i in (low - 1, low):
        directions_1(coarse, step, u, heights, i % ny, between, line, d[i % 3], q[i % 3])
    for i in range(low, high):
        directions_1(coarse, step, u, heights, (i + 1) % ny, between, line, d[(i + 1) % 3], q[(i + 1) % 3])
        d0, d1, d2 = d[(i - 1) % 3], d[i % 3], d[(i + 1) % 3]
        q0, q1, q2 = q[(i - 1) % 3], q[i % 3], q[(i + 1) % 3]
        up, down, row = u[i - 1 if i > 0 else ny - 1], u[i + 1 if i < ny - 1 else 0], u[i]
        rd = rq = dd = dq = qq = sd = sq = 0.0
        for j in range(1, nx - 1):
            r = diagonal * row[j] - k0 * (up[j] + down[j] + row[j - 1] + row[j + 1]) + push
            stiff_d = diagonal * d1[j] - k0 * (d0[j] + d2[j] + d1[j - 1] + d1[j + 1])
            stiff_q = diagonal * q1[j] - k0 * (q0[j] + q2[j] + q1[j - 1] + q1[j + 1])
            rd += r * d1[j]
            rq += r * q1[j]
            dd += stiff_d * d1[j]
            dq += stiff_d * q1[j]
            qq += stiff_q * q1[j]
            sd += d1[j]
            sq += q1[j]
        for j in (0, nx - 1):
            left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
            r = diagonal * row[j] - k0 * (up[j] + down[j] + row[left] + row[right]) + push
            stiff_d = diagonal * d1[j] - k0 * (d0[j] + d2[j] + d1[left] + d1[right])
            stiff_q = diagonal * q1[j] - k0 * (q0[j] + q2[j] + q1[left] + q1[right])
            rd += r * d1[j]
            rq += r * q1[j]
            dd += stiff_d * d1[j]
            dq += stiff_d * q1[j]
            qq += stiff_q * q1[j]
            sd += d1[j]
            sq += q1[j]
        sums = out[i]
        sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6] = rd, rq, dd, dq, qq, sd, sq


@_compiled
def correct_1(
    coarse: Any, step: Any, u: Any, heights: Any, alpha: Any, beta: Any, unit: float, low: int, high: int
) -> None:
    """Move free sites by alpha times the correction plus beta times the previous step, and project."""
    ny, nx = u.shape
    between, line = np.empty(coarse.shape[1], np.float32), np.empty(nx, np.float32)
    for i in range(low, high):
        interpolate_row(coarse, i, ny, np.float32(0.5), between, line)
        row, rough, last = u[i], heights[i], step[i]
        for j in range(nx):
            free = np.float32(1.0) if row[j] > rough[j] else np.float32(0.0)
            last[j] = (alpha * line[j] + beta * last[j]) * free
        for j in range(nx):
            row[j] = max(rough[j], row[j] + unit * last[j])


# One field on a coarse grid: (lap + bed mass + pins) e = b. gx, gy: couplings; mx, my: cell sizes.


@_compiled
def coarse_sweep_1(
    e: Any, b: Any, pins: Any, bed: Any, gx: Any, gy: Any, mx: Any, my: Any, color: int, low: int, high: int
) -> None:
    """Gauss-Seidel on the sites of one color."""
    ny, nx = e.shape
    new = np.empty(nx, np.float32)
    for i in range(low, high):
        up, down, row = e[i - 1 if i > 0 else ny - 1], e[i + 1 if i < ny - 1 else 0], e[i]
        above, below, size = gy[i - 1 if i > 0 else ny - 1], gy[i], my[i]
        source, pin = b[i], pins[i]
        for j in range(1, nx - 1):
            diagonal = (gx[j - 1] + gx[j] + bed * mx[j]) * size + (above + below) * mx[j] + pin[j]
            pulls = mx[j] * (above * up[j] + below * down[j])
            pulls += size * (gx[j - 1] * row[j - 1] + gx[j] * row[j + 1])
            new[j] = (source[j] + pulls) / diagonal
        for j in (0, nx - 1):
            left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
            diagonal = (gx[left] + gx[j] + bed * mx[j]) * size + (above + below) * mx[j] + pin[j]
            pulls = mx[j] * (above * up[j] + below * down[j])
            pulls += size * (gx[left] * row[left] + gx[j] * row[right])
            new[j] = (source[j] + pulls) / diagonal
        for j in range((i + color) & 1, nx, 2):
            row[j] = new[j]


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
    push: Any,
    out: Any,
    low: int,
    high: int,
) -> None:
    """Defect b - push mass - (...) e on the next coarser grid, rows low to high."""
    ny, nx = e.shape
    defect, total = np.empty(nx, np.float32), np.empty(nx, np.float32)
    one, half = np.float32(1.0), np.float32(0.5)
    for k in range(low, high):
        total[:] = np.float32(0.0)
        for offset in range(-1, 2):
            i = fine_row(k, offset, ny)
            if i < 0:
                continue
            if not (offset == -1 and k > low):  # else it is still in the buffer
                up, down, row = e[i - 1 if i > 0 else ny - 1], e[i + 1 if i < ny - 1 else 0], e[i]
                above, below, size = gy[i - 1 if i > 0 else ny - 1], gy[i], my[i]
                for j in range(nx):
                    left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
                    diagonal = (gx[left] + gx[j] + bed * mx[j]) * size + (above + below) * mx[j]
                    pulls = mx[j] * (above * up[j] + below * down[j])
                    pulls += size * (gx[left] * row[left] + gx[j] * row[right])
                    defect[j] = b[i, j] - push * size * mx[j] + pulls - (diagonal + pins[i, j]) * row[j]
            part = one if offset == 0 else half
            for j in range(nx):
                total[j] += part * defect[j]
        out[k] = np.float32(0.0)
        restrict_row(total, out[k], one, half)


@_compiled
def coarse_correct(coarse: Any, e: Any, b: Any, shift: Any, mx: Any, my: Any, low: int, high: int) -> None:
    """Add the interpolated correction to e, and ``shift`` times the cell size to b."""
    ny, nx = e.shape
    between, line = np.empty(coarse.shape[1], np.float32), np.empty(nx, np.float32)
    for i in range(low, high):
        interpolate_row(coarse, i, ny, np.float32(0.5), between, line)
        row, source, size = e[i], b[i], shift * my[i]
        for j in range(nx):
            row[j] += line[j]
            source[j] += size * mx[j]


# Two fields, u and its stretch w = u - u0, for a step of creep from the shape v:
#     k0 L u + k1 w = r            w + spread L w + drag w = u - v + shift


@_compiled
def relax_row_2(
    u: Any,
    w: Any,
    heights: Any,
    v: Any,
    k0: float,
    k1: float,
    spread: float,
    drag: float,
    shift: float,
    i: int,
    color: int,
    new_u: Any,
    new_w: Any,
) -> None:
    """Projected Gauss-Seidel, both fields of a site at once, on the sites of one color in row i."""
    ny, nx = u.shape
    damping = 1.0 / (1.0 + drag + 4.0 * spread)
    damped = k1 * damping
    inverse = 1.0 / (4.0 * k0 + damped)
    before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
    up, down, row, rough = u[before], u[after], u[i], heights[i]
    w_up, w_down, w_row, shape = w[before], w[after], w[i], v[i]
    for j in range(1, nx - 1):
        new_w[j] = spread * (w_up[j] + w_down[j] + w_row[j - 1] + w_row[j + 1]) - shape[j] + shift
    for j in range(1, nx - 1):
        pulls = k0 * (up[j] + down[j] + row[j - 1] + row[j + 1])
        new_u[j] = max(rough[j], (pulls - damped * new_w[j]) * inverse)
    for j in (0, nx - 1):
        left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
        known = spread * (w_up[j] + w_down[j] + w_row[left] + w_row[right]) - shape[j] + shift
        pulls = k0 * (up[j] + down[j] + row[left] + row[right])
        new_u[j] = max(rough[j], (pulls - damped * known) * inverse)
        new_w[j] = known
    for j in range((i + color) & 1, nx, 2):
        row[j] = new_u[j]
        w_row[j] = (new_u[j] + new_w[j]) * damping


@_compiled
def sweeps_2(
    u: Any,
    w: Any,
    heights: Any,
    v: Any,
    k0: float,
    k1: float,
    spread: float,
    drag: float,
    shift: float,
    halves: int,
    low: int,
    high: int,
) -> None:
    """Half sweeps, one after the other in a single pass; each stops one row farther from both ends.

    Where the number of rows is odd the last has the color of the first, its neighbor, and waits.
    """
    nx = u.shape[1]
    new_u, new_w = np.empty(nx), np.empty(nx)
    last = high - 1 if high == u.shape[0] and high % 2 else high
    for front in range(low, high + halves - 1):
        for half in range(halves):
            i = front - half
            if low + half <= i < last - half:
                relax_row_2(u, w, heights, v, k0, k1, spread, drag, shift, i, half & 1, new_u, new_w)


@_compiled
def close_sweeps_2(
    u: Any,
    w: Any,
    heights: Any,
    v: Any,
    k0: float,
    k1: float,
    spread: float,
    drag: float,
    shift: float,
    halves: int,
    edge: int,
) -> None:
    """What `sweeps_2` left undone on both sides of an edge between slabs."""
    ny, nx = u.shape
    new_u, new_w = np.empty(nx), np.empty(nx)
    odd = 1 if edge == 0 and ny % 2 else 0
    for half in range(1 - odd, halves):
        for i in range(edge - half - odd, edge + half):
            relax_row_2(u, w, heights, v, k0, k1, spread, drag, shift, i % ny, half & 1, new_u, new_w)


@_compiled
def defect_row_2(
    u: Any,
    w: Any,
    heights: Any,
    v: Any,
    k0: float,
    k1: float,
    spread: float,
    drag: float,
    shift: float,
    i: int,
    balance: Any,
    creep: Any,
    sums: Any,
) -> None:
    """Defects of both equations in row i; ``sums``: their squares, sum of w, contacts."""
    ny, nx = u.shape
    before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
    up, down, row, rough = u[before], u[after], u[i], heights[i]
    w_up, w_down, w_row, shape = w[before], w[after], w[i], v[i]
    diagonal = 1.0 + drag + 4.0 * spread
    for j in range(1, nx - 1):
        balance[j] = k0 * (up[j] + down[j] + row[j - 1] + row[j + 1] - 4.0 * row[j]) - k1 * w_row[j]
    for j in range(1, nx - 1):
        spreading = spread * (w_up[j] + w_down[j] + w_row[j - 1] + w_row[j + 1])
        creep[j] = spreading - diagonal * w_row[j] + row[j] - shape[j] + shift
    for j in (0, nx - 1):
        left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
        balance[j] = k0 * (up[j] + down[j] + row[left] + row[right] - 4.0 * row[j]) - k1 * w_row[j]
        spreading = spread * (w_up[j] + w_down[j] + w_row[left] + w_row[right])
        creep[j] = spreading - diagonal * w_row[j] + row[j] - shape[j] + shift
    first = second = stretch = free_sites = 0.0
    for j in range(nx):
        free = 1.0 if row[j] > rough[j] else 0.0
        value = balance[j] * free
        balance[j] = value
        first += value * value
        free_sites += free
    for j in range(nx):
        second += creep[j] * creep[j]
        stretch += w_row[j]
    sums[0], sums[1], sums[2], sums[3] = first, second, stretch, nx - free_sites


@_compiled
def restrict_2(
    u: Any,
    w: Any,
    heights: Any,
    v: Any,
    k0: float,
    k1: float,
    spread: float,
    drag: float,
    shift: float,
    scale: float,
    out_1: Any,
    out_2: Any,
    sums: Any,
    low: int,
    high: int,
) -> None:
    """Both defects on coarse rows low to high: the first times ``scale / k0``, the second times ``scale``."""
    ny, nx = u.shape
    balance, creep = np.empty(nx), np.empty(nx)
    total_1, total_2 = np.empty(nx), np.empty(nx)
    ignored = np.empty(sums.shape[1])
    for k in range(low, high):
        total_1[:] = 0.0
        total_2[:] = 0.0
        for offset in range(-1, 2):
            i = fine_row(k, offset, ny)
            if i < 0:
                continue
            if not (offset == -1 and k > low):  # else it is still in the buffers
                into = ignored if offset == -1 else sums[i]
                defect_row_2(u, w, heights, v, k0, k1, spread, drag, shift, i, balance, creep, into)
            part = scale if offset == 0 else 0.5 * scale
            for j in range(nx):
                total_1[j] += part * balance[j]
                total_2[j] += part * creep[j]
        out_1[k] = np.float32(0.0)
        out_2[k] = np.float32(0.0)
        restrict_row(total_1, out_1[k], 1.0 / k0, 0.5 / k0)
        restrict_row(total_2, out_2[k], 1.0, 0.5)


@_compiled
def directions_2(
    coarse_u: Any,
    coarse_w: Any,
    step_u: Any,
    step_w: Any,
    u: Any,
    heights: Any,
    i: int,
    between: Any,
    row: Any,
    d: Any,
    f: Any,
    q: Any,
    g: Any,
) -> None:
    """Correction (d, f) and previous step (q, g) in row i; u stays in contact."""
    ny, nx = u.shape
    interpolate_row(coarse_u, i, ny, np.float32(0.5), between, row)
    for j in range(nx):
        free = u[i, j] > heights[i, j]
        d[j] = row[j] if free else 0.0
        q[j] = step_u[i, j] if free else 0.0
        g[j] = step_w[i, j]
    interpolate_row(coarse_w, i, ny, np.float32(0.5), between, row)
    for j in range(nx):
        f[j] = row[j]


@_compiled
def products_2(
    coarse_u: Any,
    coarse_w: Any,
    step_u: Any,
    step_w: Any,
    u: Any,
    w: Any,
    heights: Any,
    v: Any,
    k0: float,
    k1: float,
    spread: float,
    drag: float,
    shift: float,
    out: Any,
    low: int,
    high: int,
) -> None:
    """Products of the symmetric form by rows, for the correction (d, f) and the previous step (q, g).

    Gradient with either, then dd, dq, qq, the sum of f and that of g.
    """
    ny, nx = u.shape
    between, line = np.empty(coarse_u.shape[1], np.float32), np.empty(nx, np.float32)
    d, f, q, g = np.empty((3, nx)), np.empty((3, nx)), np.empty((3, nx)), np.empty((3, nx))
    diagonal = 1.0 + drag + 4.0 * spread
    for i in (low - 1, low):
        k = i % 3
        directions_2(
            coarse_u, coarse_w, step_u, step_w, u, heights, i % ny, between, line, d[k], f[k], q[k], g[k]
        )
    for i in range(low, high):
        a, b, c = (i - 1) % 3, i % 3, (i + 1) % 3
        directions_2(
            coarse_u,
            coarse_w,
            step_u,
            step_w,
            u,
            heights,
            (i + 1) % ny,
            between,
            line,
            d[c],
            f[c],
            q[c],
            g[c],
        )
        before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
        rd = rq = dd = dq = qq = sf = sg = 0.0
        for j in range(nx):
            left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
            force = (
                k0 * (4.0 * u[i, j] - u[before, j] - u[after, j] - u[i, left] - u[i, right]) + k1 * w[i, j]
            )
            spreading = spread * (w[before, j] + w[after, j] + w[i, left] + w[i, right])
            creep = k1 * (u[i, j] - v[i, j] + shift - diagonal * w[i, j] + spreading)
            force_d = k0 * (4.0 * d[b, j] - d[a, j] - d[c, j] - d[b, left] - d[b, right]) + k1 * f[b, j]
            spreading = spread * (f[a, j] + f[c, j] + f[b, left] + f[b, right])
            creep_d = k1 * (d[b, j] - diagonal * f[b, j] + spreading)
            force_q = k0 * (4.0 * q[b, j] - q[a, j] - q[c, j] - q[b, left] - q[b, right]) + k1 * g[b, j]
            spreading = spread * (g[a, j] + g[c, j] + g[b, left] + g[b, right])
            creep_q = k1 * (q[b, j] - diagonal * g[b, j] + spreading)
            rd += force * d[b, j] + creep * f[b, j]
            rq += force * q[b, j] + creep * g[b, j]
            dd += force_d * d[b, j] + creep_d * f[b, j]
            dq += force_d * q[b, j] + creep_d * g[b, j]
            qq += force_q * q[b, j] + creep_q * g[b, j]
            sf += f[b, j]
            sg += g[b, j]
        sums = out[i]
        sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6] = rd, rq, dd, dq, qq, sf, sg


@_compiled
def correct_2(
    coarse_u: Any,
    coarse_w: Any,
    step_u: Any,
    step_w: Any,
    u: Any,
    w: Any,
    heights: Any,
    alpha: Any,
    beta: Any,
    unit: float,
    keep: bool,
    low: int,
    high: int,
) -> None:
    """Move free sites, and w everywhere, by alpha times the correction plus beta times the last step.

    Unless ``keep``, there is no last step, and this one is not kept.
    """
    ny, nx = u.shape
    between, line = np.empty(coarse_u.shape[1], np.float32), np.empty(nx, np.float32)
    for i in range(low, high):
        row, rough, last, w_row, w_last = u[i], heights[i], step_u[i], w[i], step_w[i]
        interpolate_row(coarse_u, i, ny, np.float32(0.5), between, line)
        if keep:
            for j in range(nx):
                free = np.float32(1.0) if row[j] > rough[j] else np.float32(0.0)
                last[j] = (alpha * line[j] + beta * last[j]) * free
            for j in range(nx):
                row[j] = max(rough[j], row[j] + unit * last[j])
        else:
            for j in range(nx):
                free = np.float32(1.0) if row[j] > rough[j] else np.float32(0.0)
                line[j] = alpha * line[j] * free
            for j in range(nx):
                row[j] = max(rough[j], row[j] + unit * line[j])
        interpolate_row(coarse_w, i, ny, np.float32(0.5), between, line)
        if keep:
            for j in range(nx):
                move = alpha * line[j] + beta * w_last[j]
                w_last[j] = move
                w_row[j] += unit * move
        else:
            for j in range(nx):
                w_row[j] += unit * (alpha * line[j])


# Two fields on a coarse grid:
#     (lap + pins) e + bed mass f = b          (spread lap + (1 + drag) mass) f - mass e = c


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
    color: int,
    low: int,
    high: int,
) -> None:
    """Gauss-Seidel, both fields of a site at once, on the sites of one color; ``lag`` is 1 + drag."""
    ny, nx = e.shape
    new_e, new_f = np.empty(nx, np.float32), np.empty(nx, np.float32)
    one = np.float32(1.0)
    for i in range(low, high):
        before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
        above, below, size = gy[before], gy[i], my[i]
        e_up, e_down, e_row, f_up, f_down, f_row = e[before], e[after], e[i], f[before], f[after], f[i]
        b_row, c_row, pin = b[i], c[i], pins[i]
        for j in range(1, nx - 1):
            lap = (gx[j - 1] + gx[j]) * size + (above + below) * mx[j]
            mass = size * mx[j]
            first = b_row[j] + mx[j] * (above * e_up[j] + below * e_down[j])
            first += size * (gx[j - 1] * e_row[j - 1] + gx[j] * e_row[j + 1])
            second = mx[j] * (above * f_up[j] + below * f_down[j])
            second += size * (gx[j - 1] * f_row[j - 1] + gx[j] * f_row[j + 1])
            second = c_row[j] + spread * second
            inverse = one / (mass * lag + spread * lap)
            coupling = bed * mass * inverse
            value = (first - coupling * second) / (lap + pin[j] + coupling * mass)
            new_e[j] = value
            new_f[j] = (second + mass * value) * inverse
        for j in (0, nx - 1):
            left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
            lap = (gx[left] + gx[j]) * size + (above + below) * mx[j]
            mass = size * mx[j]
            first = b_row[j] + mx[j] * (above * e_up[j] + below * e_down[j])
            first += size * (gx[left] * e_row[left] + gx[j] * e_row[right])
            second = mx[j] * (above * f_up[j] + below * f_down[j])
            second += size * (gx[left] * f_row[left] + gx[j] * f_row[right])
            second = c_row[j] + spread * second
            inverse = one / (mass * lag + spread * lap)
            coupling = bed * mass * inverse
            value = (first - coupling * second) / (lap + pin[j] + coupling * mass)
            new_e[j] = value
            new_f[j] = (second + mass * value) * inverse
        for j in range((i + color) & 1, nx, 2):
            e_row[j] = new_e[j]
            f_row[j] = new_f[j]


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
    out_b: Any,
    out_c: Any,
    low: int,
    high: int,
) -> None:
    """Defects of both equations on the next coarser grid, rows low to high."""
    ny, nx = e.shape
    first, second = np.empty(nx, np.float32), np.empty(nx, np.float32)
    total_1, total_2 = np.empty(nx, np.float32), np.empty(nx, np.float32)
    one, half, zero = np.float32(1.0), np.float32(0.5), np.float32(0.0)
    for k in range(low, high):
        total_1[:] = zero
        total_2[:] = zero
        for offset in range(-1, 2):
            i = fine_row(k, offset, ny)
            if i < 0:
                continue
            if not (offset == -1 and k > low):  # else it is still in the buffers
                before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
                above, below, size = gy[before], gy[i], my[i]
                e_up, e_down, e_row = e[before], e[after], e[i]
                f_up, f_down, f_row = f[before], f[after], f[i]
                for j in range(nx):
                    left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
                    lap = (gx[left] + gx[j]) * size + (above + below) * mx[j]
                    mass = size * mx[j]
                    pull = mx[j] * (above * e_up[j] + below * e_down[j])
                    pull += size * (gx[left] * e_row[left] + gx[j] * e_row[right])
                    first[j] = b[i, j] + pull - (lap + pins[i, j]) * e_row[j] - bed * mass * f_row[j]
                    flow = mx[j] * (above * f_up[j] + below * f_down[j])
                    flow += size * (gx[left] * f_row[left] + gx[j] * f_row[right])
                    second[j] = (
                        c[i, j] + spread * (flow - lap * f_row[j]) + mass * (e_row[j] - lag * f_row[j])
                    )
            part = one if offset == 0 else half
            for j in range(nx):
                total_1[j] += part * first[j]
                total_2[j] += part * second[j]
        out_b[k] = zero
        out_c[k] = zero
        restrict_row(total_1, out_b[k], one, half)
        restrict_row(total_2, out_c[k], one, half)


# Fields of the spring lattice.


@_compiled
def lattice_force(u: Any, w: Any, k0: float, k1: float, out: Any, low: int, high: int) -> None:
    """Force k0 L u + k1 w in rows low to high."""
    ny, nx = u.shape
    for i in range(low, high):
        up, down, row, stretch = u[i - 1 if i > 0 else ny - 1], u[i + 1 if i < ny - 1 else 0], u[i], w[i]
        force = out[i]
        for j in range(1, nx - 1):
            pulls = up[j] + down[j] + row[j - 1] + row[j + 1]
            force[j] = k0 * (4.0 * row[j] - pulls) + k1 * stretch[j]
        for j in (0, nx - 1):
            left, right = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
            pulls = up[j] + down[j] + row[left] + row[right]
            force[j] = k0 * (4.0 * row[j] - pulls) + k1 * stretch[j]


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


# Fields of a step of creep, each in one pass through memory.


@_compiled
def combine_2(a: float, x: Any, b: float, y: Any, out: Any, low: int, high: int) -> None:
    """Sum a x + b y."""
    for i in range(low, high):
        for j in range(x.shape[1]):
            out[i, j] = a * x[i, j] + b * y[i, j]


@_compiled
def combine_3(a: float, x: Any, b: float, y: Any, c: float, z: Any, out: Any, low: int, high: int) -> None:
    """Sum a x + b y + c z."""
    for i in range(low, high):
        for j in range(x.shape[1]):
            out[i, j] = a * x[i, j] + b * y[i, j] + c * z[i, j]
