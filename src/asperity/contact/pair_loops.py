r"""Compiled loops over pairs of unknowns, u and the stretch w, where the creep differs from site to site.

On the lattice, e and f being corrections of u and w, in single precision and in units in which k1 = 1,

    kappa L e + f = b   off contact, e = 0 or e >= least elsewhere,      lag f + spread L f - e = c + shift

with lag a field. Coarse cells are two by two sites. A cell moves the free sites in it together, and the
stretches of all its sites by weights (1 + 4 spread) / (lag + 4 spread), for what creeps quickly hardly
stretches. Both equations become their weighted sums over the cell (Galerkin's); bonds between cells are
halved, for the distance between cells is twice that between sites.
Bonds to contacts become pins. ``right[j]`` is the strength of the bond from column j to the next, and
``below[i]`` that from a row to the next: 1, or 0 over an edge that reflects.

Parameters are arguments, never globals, and all loops that call each other are here: compiled code is kept
on disk, and a change of what it took from elsewhere would not be noticed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact.compiled import compiled


@compiled
def laplacian(x: Any, below: Any, right: Any, out: Any) -> None:
    """Minus the Laplacian of a field."""
    ny, nx = x.shape
    for i in range(ny):
        up, down = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
        a, b = below[up], below[i]
        for j in range(nx):
            left, next_ = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
            here = x[i, j]
            out[i, j] = (
                a * (here - x[up, j])
                + b * (here - x[down, j])
                + right[left] * (here - x[i, left])
                + right[j] * (here - x[i, next_])
            )


@compiled
def relax(
    e: Any,
    f: Any,
    least: Any,
    b: Any,
    c: Any,
    inverse: Any,
    yielding: Any,
    below: Any,
    right: Any,
    kappa: Any,
    spread: Any,
    shift: Any,
    backward: bool,
) -> None:
    """One sweep on the lattice: both unknowns of a site together, e no less than it may be.

    ``inverse`` is 1 / (lag + spread bonds), and ``yielding`` 1 / (kappa bonds + inverse), with the bonds of a
    site.
    """
    ny, nx = e.shape
    first, step = (nx - 1, -1) if backward else (0, 1)
    for row in range(ny):
        i = ny - 1 - row if backward else row
        up, down = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
        a, d = below[up], below[i]
        e_row, e_up, e_down, f_row, f_up, f_down = e[i], e[up], e[down], f[i], f[up], f[down]
        lowest, push, flows, parts, soft = least[i], b[i], c[i], inverse[i], yielding[i]
        start = 0 if backward else nx - 1
        e_behind, f_behind = e_row[start], f_row[start]
        for column in range(nx):
            j = first + step * column
            ahead = first + step * (column + 1) if column < nx - 1 else first
            bond = right[j - 1 if j > 0 else nx - 1]
            p, q = (right[j], bond) if backward else (bond, right[j])
            flow = flows[j] + shift
            if spread > 0:
                flow += spread * (a * f_up[j] + d * f_down[j] + p * f_behind + q * f_row[ahead])
            pull = kappa * (a * e_up[j] + d * e_down[j] + q * e_row[ahead]) + push[j] - flow * parts[j]
            e_behind = max((pull + kappa * p * e_behind) * soft[j], lowest[j])
            f_behind = (flow + e_behind) * parts[j]
            e_row[j], f_row[j] = e_behind, f_behind


@compiled
def restrict(
    e: Any,
    f: Any,
    least: Any,
    b: Any,
    c: Any,
    lag: Any,
    weight: Any,
    below: Any,
    right: Any,
    kappa: Any,
    spread: Any,
    shift: Any,
    coarse: Any,
    sums: Any,
) -> None:
    """What both equations lack on the lattice, and the equations of the first coarse grid.

    ``coarse`` has the fields pins, bonds of e to the right and below, coupling, sum of the weights, lag,
    bonds of f likewise, and both sources. ``sums``: of f, contacts.
    """
    ny, nx = e.shape
    pins, e_right, e_below, free, sites, lags, f_right, f_below, b_out, c_out = coarse
    half = np.float32(0.5)
    for k in range(10):
        coarse[k][:, :] = np.float32(0.0)
    total, contacts = 0.0, 0
    for i in range(ny):
        up, down = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
        a, d = below[up], below[i]
        y = i // 2
        for j in range(nx):
            left, next_ = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
            p, q = right[left], right[j]
            x = j // 2
            bonds = a + d + p + q
            here, own = e[i, j], f[i, j]
            total += own
            flow = c[i, j] + shift + here - lag[i, j] * own
            part = weight[i, j]
            stiff = lag[i, j] * part
            if spread > 0:
                flow += spread * (
                    a * f[up, j] + d * f[down, j] + p * f[i, left] + q * f[i, next_] - bonds * own
                )
                stiff += spread * (
                    bonds * part
                    - (a * weight[up, j] + d * weight[down, j] + p * weight[i, left] + q * weight[i, next_])
                )
                if j % 2 == 1 or j == nx - 1:
                    f_right[y, x] += spread * half * q * part * weight[i, next_]
                if i % 2 == 1 or i == ny - 1:
                    f_below[y, x] += spread * half * d * part * weight[down, j]
            sites[y, x] += part
            lags[y, x] += stiff * part
            c_out[y, x] += flow * part
            if here <= least[i, j]:
                contacts += 1
                continue
            free[y, x] += part
            b_out[y, x] += (
                b[i, j]
                - own
                + kappa * (a * e[up, j] + d * e[down, j] + p * e[i, left] + q * e[i, next_] - bonds * here)
            )
            if e[up, j] <= least[up, j]:
                pins[y, x] += kappa * a
            if e[i, left] <= least[i, left]:
                pins[y, x] += kappa * p
            if e[i, next_] <= least[i, next_]:
                pins[y, x] += kappa * q
            elif j % 2 == 1 or j == nx - 1:
                e_right[y, x] += kappa * half * q
            if e[down, j] <= least[down, j]:
                pins[y, x] += kappa * d
            elif i % 2 == 1 or i == ny - 1:
                e_below[y, x] += kappa * half * d
    sums[0], sums[1] = total, contacts


@compiled
def relax_coarse(e: Any, f: Any, grid: Any, shift: Any, backward: bool) -> None:
    """One sweep on a coarse grid."""
    pins, e_right, e_below, free, sites, lags, f_right, f_below, b, c = grid
    ny, nx = e.shape
    tiny = np.float32(1e-30)  # of cells of nothing but contacts, whose stretches are not found here
    for row in range(ny):
        i = ny - 1 - row if backward else row
        up, down = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
        for column in range(nx):
            j = nx - 1 - column if backward else column
            left, next_ = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
            wu, wd, wl, wr = f_below[up, j], f_below[i, j], f_right[i, left], f_right[i, j]
            own = max(lags[i, j] + wu + wd + wl + wr, tiny)
            flow = c[i, j] + shift * sites[i, j]
            flow += wu * f[up, j] + wd * f[down, j] + wl * f[i, left] + wr * f[i, next_]
            m = free[i, j]
            moved = np.float32(0.0)
            if m > 0:
                wu, wd, wl, wr = e_below[up, j], e_below[i, j], e_right[i, left], e_right[i, j]
                pull = b[i, j] + wu * e[up, j] + wd * e[down, j] + wl * e[i, left] + wr * e[i, next_]
                moved = (pull - m * flow / own) / (pins[i, j] + wu + wd + wl + wr + m * m / own)
            e[i, j] = moved
            f[i, j] = (flow + m * moved) / own


@compiled
def restrict_coarse(e: Any, f: Any, grid: Any, coarse: Any) -> None:
    """What both equations lack on a coarse grid, and the equations of the next."""
    pins, e_right, e_below, free, sites, lags, f_right, f_below, b, c = grid
    ny, nx = e.shape
    half = np.float32(0.5)
    for k in range(10):
        coarse[k][:, :] = np.float32(0.0)
    for i in range(ny):
        up, down = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
        y = i // 2
        for j in range(nx):
            left, next_ = j - 1 if j > 0 else nx - 1, j + 1 if j < nx - 1 else 0
            x = j // 2
            here, own = e[i, j], f[i, j]
            m = free[i, j]
            flow = c[i, j] - lags[i, j] * own + m * here
            flow -= f_below[up, j] * (own - f[up, j]) + f_below[i, j] * (own - f[down, j])
            flow -= f_right[i, left] * (own - f[i, left]) + f_right[i, j] * (own - f[i, next_])
            coarse[9][y, x] += flow
            if m > 0:
                pull = b[i, j] - pins[i, j] * here - m * own
                pull -= e_below[up, j] * (here - e[up, j]) + e_below[i, j] * (here - e[down, j])
                pull -= e_right[i, left] * (here - e[i, left]) + e_right[i, j] * (here - e[i, next_])
                coarse[8][y, x] += pull
                coarse[0][y, x] += pins[i, j]
                coarse[3][y, x] += m
            coarse[4][y, x] += sites[i, j]
            coarse[5][y, x] += lags[i, j]
            if j % 2 == 1 or j == nx - 1:
                coarse[1][y, x] += half * e_right[i, j]
                coarse[6][y, x] += half * f_right[i, j]
            if i % 2 == 1 or i == ny - 1:
                coarse[2][y, x] += half * e_below[i, j]
                coarse[7][y, x] += half * f_below[i, j]


@compiled
def correct(e: Any, f: Any, least: Any, weight: Any, e_coarse: Any, f_coarse: Any) -> None:
    """Add what the first coarse grid found; contacts stay."""
    ny, nx = e.shape
    for i in range(ny):
        for j in range(nx):
            f[i, j] += weight[i, j] * f_coarse[i // 2, j // 2]
            if e[i, j] > least[i, j]:
                e[i, j] += e_coarse[i // 2, j // 2]
                if e[i, j] < least[i, j]:
                    e[i, j] = least[i, j]


@compiled
def correct_coarse(e: Any, f: Any, free: Any, e_coarse: Any, f_coarse: Any) -> None:
    """Add what the next coarser grid found."""
    ny, nx = e.shape
    for i in range(ny):
        for j in range(nx):
            f[i, j] += f_coarse[i // 2, j // 2]
            if free[i, j] > 0:
                e[i, j] += e_coarse[i // 2, j // 2]


@compiled
def assemble(grid: Any, faint: float, load_held: bool, matrix: Any, sides: Any) -> None:
    """The equations of the coarsest grid as a matrix: corrections e, then f, then the shift."""
    pins, e_right, e_below, free, sites, lags, f_right, f_below, b, c = grid
    ny, nx = pins.shape
    n = ny * nx
    matrix[2 * n, 2 * n] = 1.0
    for i in range(ny):
        for j in range(nx):
            here = i * nx + j
            beside, under = i * nx + (j + 1) % nx, (i + 1) % ny * nx + j
            for there, first, second in (
                (beside, e_right[i, j], f_right[i, j]),
                (under, e_below[i, j], f_below[i, j]),
            ):
                for offset, bond in ((0, first), (n, second)):
                    matrix[offset + here, offset + here] += bond
                    matrix[offset + there, offset + there] += bond
                    matrix[offset + here, offset + there] -= bond
                    matrix[offset + there, offset + here] -= bond
            m = free[i, j]
            matrix[here, here] += pins[i, j] + faint * sites[i, j] if m > 0 else 1.0
            matrix[here, n + here] = m
            matrix[n + here, here] = -m
            matrix[n + here, n + here] += lags[i, j] if lags[i, j] > 0 else 1.0
            sides[here], sides[n + here] = b[i, j], c[i, j]
            if load_held:
                matrix[n + here, 2 * n] = -sites[i, j]
                matrix[2 * n, n + here] = sites[i, j]
