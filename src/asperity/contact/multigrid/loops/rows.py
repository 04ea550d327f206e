r"""Rows of corrections: how they lie in memory, and how they go from one grid to the next.

Multigrid works on corrections to states, in single precision and in units in which k0 = 1 and no length is
large; what one correction lacks the next one makes up for.

Rows of corrections are parted: the m even columns first, then the odd ones. All neighbors of one color of
a checkerboard then lie side by side, as do the sites that two grids share, so that every loop reads and
writes in order and the compiler can use vector instructions. A field has the shape (rows, 2, m + 1):

    row[0]   columns 0, 2, 4, ...   and the image of the column beyond the last, or none
    row[1]   the image of column -1   and columns 1, 3, 5, ...   and that image, or none

The sites of ``row[side]`` are ``side <= k < end_of(side, columns)``, with ``other[k - side]`` and
``other[k - side + 1]`` of the other side next to them. `wrap` sets the two images: of the other end where
the lattice is periodic, of the same end where its edges are mirrors (column -1 is the image of column 0).
Rows have no images: `neighbors` names the rows above and below.

Between grids there is bilinear interpolation, and its transpose. Every other site belongs to the coarse grid.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity.contact.compiled import compiled, inlined, intrinsic
from asperity.lattice import Field

Single: TypeAlias = NDArray[np.float32]
Scalar: TypeAlias = Any
"""A number in single precision."""

Fields: TypeAlias = Any
"""A `Pair` of fields, or one field in a tuple."""

_MOST = 2**31 - 1
"""Most columns."""


class Sites(NamedTuple):
    """Rows and columns of a grid, and whether its edges are mirrors."""

    rows: int
    columns: int
    mirrored: bool


class Pair(NamedTuple):
    """Corrections e and f of both fields, or whatever belongs to the one and to the other."""

    e: Single
    f: Single


@intrinsic
def larger(_: Any, x: Any, y: Any) -> Any:
    """The larger of two numbers. The largest of many takes vector instructions so, and none by `max`."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        del context, signature
        a, b = arguments
        flags = ("nnan", "nsz")
        return builder.select(builder.fcmp_ordered(">", a, b, flags=flags), a, b, flags=flags)

    return x(x, y), generate


@inlined
def end_of(side: int, columns: int) -> int:
    """One past the last site of a side of a parted row.

    Written so that no sum can overflow. Else the compiler takes indices for possibly negative, which count
    from the end, and loads sites one by one.
    """
    return side + (((columns & _MOST) + 1 - side) >> 1)


@inlined
def neighbors(i: int, sites: Sites) -> tuple[int, int]:
    """The rows above and below a row of the lattice."""
    ny = sites.rows
    first, last = (0, ny - 1) if sites.mirrored else (ny - 1, 0)
    return i - 1 if i > 0 else first, i + 1 if i < ny - 1 else last


@inlined
def row_in(field: Single, i: int) -> int:
    """Where a field has its row i: one row may stand for all."""
    return i if field.shape[0] > 1 else 0


@inlined
def wrap(row: Single, sites: Sites) -> None:
    """Set the images beyond both ends of a parted row."""
    nx = sites.columns
    m = (nx + 1) // 2
    if sites.mirrored:
        row[1, 0] = row[0, 0]
        if nx % 2 == 0:
            row[0, m] = row[1, m]
        else:
            row[1, m] = row[0, m - 1]
    elif nx % 2 == 0:
        row[0, m] = row[0, 0]
        row[1, 0] = row[1, m]
    else:
        row[1, m] = row[0, 0]
        row[1, 0] = row[0, m - 1]


@inlined
def part(line: Any, row: Any) -> None:
    """A row in order, parted."""
    nx = line.shape[0]
    even, odd = row[0], row[1]
    for k in range(nx // 2):
        even[k] = line[2 * k]
        odd[k + 1] = line[2 * k + 1]
    if nx % 2:
        even[nx // 2] = line[nx - 1]


@inlined
def join(row: Any, line: Any) -> None:
    """A parted row, in order."""
    nx = line.shape[0]
    for k in range(nx // 2):
        line[2 * k] = row[0, k]
        line[2 * k + 1] = row[1, k + 1]
    if nx % 2:
        line[nx - 1] = row[0, nx // 2]


@compiled
def part_rows(field: Any, sites: Sites, out: Single) -> None:
    """Rows in order, parted, with images."""
    for i in range(sites.rows):
        part(field[i], out[i])
        wrap(out[i], sites)


@compiled
def join_rows(field: Single, out: Any) -> None:
    """Parted rows, in order."""
    for i in range(field.shape[0]):
        join(field[i], out[i])


@compiled
def total(field: Single, columns: int, out: Field) -> None:
    """Sums of parted rows."""
    for i in range(field.shape[0]):
        value = np.float32(0.0)
        for side in range(2):
            row = field[i, side]
            for k in range(side, end_of(side, columns)):
                value += row[k]
        out[i, 0] = value


@inlined
def weighted_total(field: Single, mx: Single, my: Single, columns: int) -> float:
    """Sum of a field over the sites that the cells of a coarse grid stand for."""
    value = 0.0
    for i in range(field.shape[0]):
        row = np.float32(0.0)
        for side in range(2):
            for k in range(side, end_of(side, columns)):
                row += field[i, side, k] * mx[side, k]
        value += my[i] * row
    return value


@inlined
def restrict_rows(
    above: Single, center: Single, below: Single, k: int, sites: Sites, line: Single, out: Single
) -> None:
    """Three parted fine rows on parted coarse row k: coarse sites count whole, those between them half.

    What lies between a coarse site and a mirror counts whole there. The fine rows may be changed.
    """
    half, two = np.float32(0.5), np.float32(2.0)
    nx, m = sites.columns, line.shape[0]
    if sites.mirrored and 2 * k + 2 == sites.rows:
        for side in range(2):
            for j in range(m + 1):
                below[side, j] *= two
    for row in (above, center, below):
        if nx % 2 == 0 and not sites.mirrored:
            row[1, 0] = row[1, m]
        elif nx % 2 == 0:
            row[1, 0] = np.float32(0.0)
        else:  # the last column and the first are neighbors with nothing between, or at mirrors
            row[1, 0] = row[1, m] = np.float32(0.0)
    for j in range(m):
        sides = above[0, j] + below[0, j] + center[1, j] + center[1, j + 1]
        corners = above[1, j] + above[1, j + 1] + below[1, j] + below[1, j + 1]
        line[j] = center[0, j] + half * (sides + half * corners)
    if sites.mirrored and nx % 2 == 0:
        line[m - 1] += half * (center[1, m] + half * (above[1, m] + below[1, m]))
    part(line, out)


@inlined
def interpolate_row(coarse: Single, i: int, sites: Sites, out: Single) -> None:
    """Parted row i of a fine grid, from a coarse grid whose rows are in order."""
    half = np.float32(0.5)
    my, m = coarse.shape
    even, odd = out[0], out[1]
    above = coarse[i // 2]
    if i % 2 == 0 or sites.rows == 1:
        for k in range(m):
            even[k] = above[k]
    else:
        below = coarse[i // 2 + 1 if i // 2 + 1 < my else (my - 1 if sites.mirrored else 0)]
        for k in range(m):
            even[k] = half * (above[k] + below[k])
    even[m] = even[m - 1] if sites.mirrored else even[0]
    for k in range(1, 1 + sites.columns - m):
        odd[k] = half * (even[k - 1] + even[k])
    wrap(out, sites)


@inlined
def fine_row(coarse_row: int, offset: int, sites: Sites) -> int:
    """Fine row at an offset of -1, 0 or 1 from a coarse row, or -1 if the grid has none there."""
    ny, i = sites.rows, 2 * coarse_row + offset
    if ny == 1:
        return i if offset == 0 else -1
    if i < 0:
        return ny - 1 if ny % 2 == 0 and not sites.mirrored else -1
    return i if i < ny else -1


@compiled
def restrict(field: Single, sites: Sites, softening: Scalar, mean: Scalar, out: Single) -> None:
    """A field on the next coarser grid, where what stands out from a mean softens."""
    width = field.shape[2]
    rows, line = np.zeros((3, 2, width), np.float32), np.empty(width - 1, np.float32)
    unit, zero = np.float32(1.0), np.float32(0.0)
    for k in range(out.shape[0]):
        for offset in range(-1, 2):
            i, row = fine_row(k, offset, sites), rows[offset + 1]
            if i < 0:
                row[:] = np.float32(0.0)
                continue
            for side in range(2):
                for j in range(side, end_of(side, sites.columns)):
                    value = field[i, side, j]
                    row[side, j] = value / (unit + softening * max(value - mean, zero))
        restrict_rows(rows[0], rows[1], rows[2], k, sites, line, out[k])


@inlined
def off_contact(line: Single, e: Single, bound: Single, sites: Sites, out: Single) -> None:
    """A parted row where it is free, zero in contact."""
    for side in range(2):
        for k in range(side, end_of(side, sites.columns)):
            out[side, k] = line[side, k] if e[side, k] > bound[side, k] else np.float32(0.0)
    wrap(out, sites)


@inlined
def move_row(
    line: Single, last: Single, e: Single, bound: Single, sites: Sites, alpha: Scalar, beta: Scalar
) -> None:
    """Move the free sites of a row by ``alpha line + beta last``, which becomes the last; and project."""
    zero = np.float32(0.0)
    for side in range(2):
        for k in range(side, end_of(side, sites.columns)):
            value, least = e[side, k], bound[side, k]
            move = alpha * line[side, k] + beta * last[side, k] if value > least else zero
            last[side, k] = move
            e[side, k] = max(least, value + move)
    wrap(e, sites)


@inlined
def coarse_correct_row(coarse: Single, e: Single, sites: Sites, i: int, line: Single) -> None:
    """Add the interpolated correction to row i of e."""
    interpolate_row(coarse, i, sites, line)
    for side in range(2):
        for k in range(side, end_of(side, sites.columns)):
            e[i, side, k] += line[side, k]
    wrap(e[i], sites)


@inlined
def add_constant(b: Single, shift: Scalar, mx: Single, my: Single, columns: int, i: int) -> None:
    """Add ``shift`` times the cell size to row i of b."""
    size = shift * my[i]
    for side in range(2):
        for k in range(side, end_of(side, columns)):
            b[i, side, k] += size * mx[side, k]
