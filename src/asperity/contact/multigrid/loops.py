r"""The loops of multigrid, compiled; `asperity.contact.multigrid.processor` calls them.

States are double precision. Multigrid works on corrections to them, in single precision and in units in
which k0 = 1 and no length is large; what one correction lacks the next one makes up for.

Rows of corrections are parted: the m even columns first, then the odd ones. All neighbors of one color of
a checkerboard then lie side by side, as do the sites that two grids share, so that every loop reads and
writes in order and the compiler can use vector instructions. A field has the shape (rows, 2, m + 1):

    row[0]   columns 0, 2, 4, ...   and the image of the column beyond the last, or none
    row[1]   the image of column -1   and columns 1, 3, 5, ...   and that image, or none

The sites of ``row[side]`` are ``side <= k < end_of(side, columns)``, with ``other[k - side]`` and
``other[k - side + 1]`` of the other side next to them. `wrap` sets the two images: of the other end where
the lattice is periodic, of the same end where its edges are mirrors (column -1 is the image of column 0).
Rows have no images: `neighbors` names the rows above and below.

Sums are kept row by row, in double precision, and added up in their order.

A pass over the lattice is a wave of row operations, each a row behind the one before, so that a row is
fetched from memory once. A cycle of two fields, when row n has been corrected:

    row       n - 3          n - 2         n - 1        n
    done      restriction    second half   first half   correction from the coarse grid
              of defects     sweep         sweep
              ^ reads n - 4 to n - 2, final by then     ^ the wave moves on to n + 1

An operation reads the rows beside its own and so stops a row earlier at both ends of the lattice than the
one before it; what is left undone there comes after the wave.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numba.core import types
from numba.extending import overload
from numpy.typing import NDArray

from asperity.contact.compiled import compiled, inlined, intrinsic
from asperity.lattice import Field

Single: TypeAlias = NDArray[np.float32]
Scalar: TypeAlias = Any
"""A number in single precision."""


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


class One(NamedTuple):
    """One field on the lattice: (lap + bed) e = b - uniform, e >= bound; ``diagonal`` is 4 + bed."""

    e: Single
    bound: Single
    b: Single
    bed: Scalar
    diagonal: Scalar
    uniform: Scalar
    sites: Sites


class Two(NamedTuple):
    """Two fields on the lattice: lap e + bed f = b, e >= bound; spread lap f + lag f - e = c + shift.

    They are the corrections of u and of its stretch w = u - u0 in an implicit step of creep from anchors v:

        k0 L u + k1 w = r            w + spread L w + drag w = u - v + shift

    with lag = 1 + drag, a number or a parted field.
    """

    e: Single
    f: Single
    bound: Single
    b: Single
    c: Single
    bed: Scalar
    spread: Scalar
    lag: Scalar
    shift: Scalar
    sites: Sites


class CoarseOne(NamedTuple):
    """One field on a coarse grid: (lap + bed mass + pins) e = b; couplings gx, gy and cell sizes mx, my."""

    e: Single
    b: Single
    bed: Scalar
    pins: Single
    gx: Single
    gy: Single
    mx: Single
    my: Single
    sites: Sites


class CoarseTwo(NamedTuple):
    """Two fields on a coarse grid.

    (lap + pins) e + bed mass f = b          (spread lap + lag mass) f - mass e = c
    """

    e: Single
    f: Single
    b: Single
    c: Single
    bed: Scalar
    spread: Scalar
    lag: Scalar
    pins: Single
    gx: Single
    gy: Single
    mx: Single
    my: Single
    sites: Sites


class Moves(NamedTuple):
    """A step of multigrid: alpha times the coarse correction plus beta times the previous move, if kept."""

    coarse: Pair
    previous: Pair
    alpha: Scalar
    beta: Scalar
    keeping: bool


class Springs(NamedTuple):
    """Stiffness k0 and k1; and ``spread L w + drag w``, what creeps in a unit of time or in a step."""

    k0: float
    k1: float
    spread: float
    drag: float


class Surface(NamedTuple):
    """A state and its obstacle: u, w = u - u0 and the heights; lengths, double precision, rows in order."""

    u: Field
    w: Field
    heights: Field


class Measured(NamedTuple):
    """What a state asks of its correction: the bound and the sources b and c (of a step), or the flow."""

    bound: Single
    b: Single
    c: Single


class ByLaw(NamedTuple):
    """A step of tau by a law from anchors v: its velocity and derivative by site, where they are taken.

    The body is at the position, and no lag exceeds the largest.
    """

    anchors: Field
    velocity: Field
    derivative: Field
    position: float
    tau: float
    largest: float


class Tangent(NamedTuple):
    """Of a law: 1 + drag without it, 4 spread, and how far a stretch moves until the slope is another."""

    lagging: float
    beside: float
    bend: Any


class Past(NamedTuple):
    """What a stage is guessed from: weights of the last two changes; rate and flow at the step's start."""

    last: Pair
    before: Pair
    ahead: Scalar
    back: Scalar
    rate: Single
    flow: Single
    tau: Scalar


@intrinsic
def larger(_: Any, x: Any, y: Any) -> Any:
    """The larger of two numbers. The largest of many takes vector instructions so, and none by `max`."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        del context, signature
        a, b = arguments
        flags = ("nnan", "nsz")
        return builder.select(builder.fcmp_ordered(">", a, b, flags=flags), a, b, flags=flags)

    return x(x, y), generate


# Parted rows.


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
def part_rows(field: Any, out: Single) -> None:
    """Rows in order, parted."""
    for i in range(field.shape[0]):
        part(field[i], out[i])


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
def weighted_total(field: Single, mx: Single, my: Single) -> float:
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


def at(coefficient: Any, site: Any) -> Any:
    """A coefficient at a site: it is a number or a field."""
    return coefficient[site] if isinstance(coefficient, np.ndarray) else coefficient


@overload(at, jit_options={"forceinline": True}, strict=False)
def _at(coefficient: Any, site: Any) -> Any:
    del site
    if isinstance(coefficient, types.Array):
        return lambda coefficient, site: coefficient[site]
    return lambda coefficient, site: coefficient  # noqa: ARG005


# Between grids: bilinear interpolation, and its transpose. Every other site belongs to the coarse grid.


@inlined
def restrict_rows(
    above: Single, here: Single, below: Single, k: int, sites: Sites, line: Single, out: Single
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
    for row in (above, here, below):
        if nx % 2 == 0 and not sites.mirrored:
            row[1, 0] = row[1, m]
        elif nx % 2 == 0:
            row[1, 0] = np.float32(0.0)
        else:  # the last column and the first are neighbors with nothing between, or at mirrors
            row[1, 0] = row[1, m] = np.float32(0.0)
    for j in range(m):
        sides = above[0, j] + below[0, j] + here[1, j] + here[1, j + 1]
        corners = above[1, j] + above[1, j + 1] + below[1, j] + below[1, j + 1]
        line[j] = here[0, j] + half * (sides + half * corners)
    if sites.mirrored and nx % 2 == 0:
        line[m - 1] += half * (here[1, m] + half * (above[1, m] + below[1, m]))
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


# Coefficients of coarse grids.


@compiled
def pins_of_contacts(e: Single, bound: Single, sites: Sites, strength: Scalar, out: Single) -> None:
    """Pins on the first coarse grid: each contact counts ``strength``."""
    width = e.shape[2]
    rows, line = np.zeros((3, 2, width), np.float32), np.empty(width - 1, np.float32)
    zero = np.float32(0.0)
    for k in range(out.shape[0]):
        for offset in range(-1, 2):
            i, row = fine_row(k, offset, sites), rows[offset + 1]
            if i < 0:
                row[:] = zero
                continue
            for side in range(2):
                for j in range(side, end_of(side, sites.columns)):
                    row[side, j] = strength if e[i, side, j] <= bound[i, side, j] else zero
        restrict_rows(rows[0], rows[1], rows[2], k, sites, line, out[k])


@compiled
def coarser_pins(pins: Single, sites: Sites, softening: Scalar, mean: Scalar, out: Single) -> None:
    """Pins on the next coarser grid: what stands out from the mean softens."""
    width = pins.shape[2]
    rows, line = np.empty((3, 2, width), np.float32), np.empty(width - 1, np.float32)
    one, zero = np.float32(1.0), np.float32(0.0)
    for k in range(out.shape[0]):
        for offset in range(-1, 2):
            i, row = fine_row(k, offset, sites), rows[offset + 1]
            if i < 0:
                row[:] = zero
                continue
            for side in range(2):
                for j in range(width):
                    pin = pins[i, side, j]
                    row[side, j] = pin / (one + softening * max(pin - mean, zero))
        restrict_rows(rows[0], rows[1], rows[2], k, sites, line, out[k])


@compiled
def coarser_lag(lag: Single, cells: Single, beside: Scalar, sites: Sites, out: Single) -> None:
    """A lag by site on the next coarser grid: its mean, weighted by the size of a cell over lag + beside."""
    width = lag.shape[2]
    weights, lagging = np.zeros((3, 2, width), np.float32), np.zeros((3, 2, width), np.float32)
    line, response = np.empty(width - 1, np.float32), np.zeros(out.shape[1:], np.float32)
    for k in range(out.shape[0]):
        for offset in range(-1, 2):
            i, n = fine_row(k, offset, sites), offset + 1
            if i < 0:
                weights[n] = np.float32(0.0)
                lagging[n] = np.float32(0.0)
                continue
            for side in range(2):
                for j in range(side, end_of(side, sites.columns)):
                    weight = cells[i, side, j] / (lag[i, side, j] + beside)
                    weights[n, side, j] = weight
                    lagging[n, side, j] = weight * lag[i, side, j]
        restrict_rows(weights[0], weights[1], weights[2], k, sites, line, response)
        restrict_rows(lagging[0], lagging[1], lagging[2], k, sites, line, out[k])
        for side in range(2):
            for j in range(side, end_of(side, (sites.columns + 1) // 2)):
                out[k, side, j] /= response[side, j]


# Between states and corrections. ``bound`` is the least correction of u that does not penetrate: minus
# the gap u - heights, in the unit of the correction.


@inlined
def stencil_row(a: float, x: Field, b: float, y: Field, i: int, sites: Sites, out: Field) -> None:
    """Row i of a L x + b y, L minus the Laplacian."""
    nx = x.shape[1]
    above, below = neighbors(i, sites)
    up, down, row, other = x[above], x[below], x[i], y[i]
    for j in range(1, nx - 1):
        out[j] = a * (4.0 * row[j] - (up[j] + down[j] + row[j - 1] + row[j + 1])) + b * other[j]
    first, last = (0, nx - 1) if sites.mirrored else (nx - 1, 0)
    for j in (0, nx - 1):
        left, right = j - 1 if j > 0 else first, j + 1 if j < nx - 1 else last
        out[j] = a * (4.0 * row[j] - (up[j] + down[j] + row[left] + row[right])) + b * other[j]


@compiled
def measure_1(
    u: Field,
    heights: Field,
    k0: float,
    bed: float,
    uniform: float,
    unit: float,
    bound: Single,
    b: Single,
    sites: Sites,
    sums: Field,
) -> None:
    """Bound and source for a state with the force k0 L u + bed u + uniform.

    ``sums``: largest force off contact, sum of the tension, load, contacts, sum of the forces off contact.
    """
    nx = u.shape[1]
    force, line = np.empty(nx), np.empty(nx)
    scale, inverse = -1.0 / (k0 * unit), 1.0 / unit
    for i in range(sites.rows):
        row, rough = u[i], heights[i]
        stencil_row(k0, u, bed, u, i, sites, force)
        worst = tension = load = free_sites = imbalance = 0.0
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
            force[j] = total * scale
            line[j] = (rough[j] - row[j]) * inverse
        found = sums[i]
        found[0], found[1], found[2], found[3], found[4] = worst, tension, load, nx - free_sites, imbalance
        part(line, bound[i])
        part(force, b[i])


@inlined
def settle_row(row: Field, rough: Field, move: Single, least: Single, unit: float) -> None:
    """Add a correction to a row of a surface; where it closes the gap there is contact."""
    for j in range(row.shape[0]):
        moved = max(rough[j], row[j] + unit * move[j])
        row[j] = moved if move[j] > least[j] else rough[j]


@compiled
def settle(u: Field, heights: Field, e: Single, bound: Single, unit: float) -> None:
    """Add a correction to a surface."""
    nx = u.shape[1]
    move, least = np.empty(nx, np.float32), np.empty(nx, np.float32)
    for i in range(u.shape[0]):
        join(e[i], move)
        join(bound[i], least)
        settle_row(u[i], heights[i], move, least, unit)


@inlined
def error_of_tangent(rise: float, change: float, bend: float, own: float) -> float:
    """What a tangent leaves of a stretch that changes; over a bend the slope changes by its own size."""
    return min(rise * change * change / (own * bend + 1e-300), abs(change))


@inlined
def add_row(row: Field, move: Single, unit: float, offset: float) -> None:
    """Add a correction and a constant to a row."""
    for j in range(row.shape[0]):
        row[j] += unit * move[j] + offset


@compiled
def add(w: Field, f: Single, unit: float) -> None:
    """Add a correction to a field."""
    move = np.empty(w.shape[1], np.float32)
    for i in range(w.shape[0]):
        join(f[i], move)
        add_row(w[i], move, unit, 0.0)


@compiled
def settle_law(
    surface: Surface, correction: Pair, bound: Single, lag: Single, tangent: Tangent, unit: float, sums: Field
) -> None:
    """Add corrections to u and w; ``sums``: squares of what the tangent of the law leaves of w."""
    u, w, heights = surface
    e, f = correction
    lagging, beside, bend = tangent
    nx = u.shape[1]
    move, stretch, least = np.empty(nx, np.float32), np.empty(nx, np.float32), np.empty(nx, np.float32)
    lags = np.empty(nx, np.float32)
    for i in range(u.shape[0]):
        join(e[i], move)
        join(f[i], stretch)
        join(bound[i], least)
        join(lag[i], lags)
        settle_row(u[i], heights[i], move, least, unit)
        squares = 0.0
        for j in range(nx):
            change = unit * stretch[j]
            w[i, j] += change
            left = error_of_tangent(lags[j] - lagging, change, at(bend, (i, j)), lags[j] + beside)
            squares += left * left
        sums[i, 0] = squares


@compiled
def measure_2(
    surface: Surface,
    v: Field,
    springs: Springs,
    shift: float,
    unit: float,
    into: Measured,
    sites: Sites,
    sums: Field,
) -> None:
    """Bound and both sources for a state of two fields and the anchors v; ``sums``: sum of w."""
    u, w, heights = surface
    bound, b, c = into
    k0, k1, spread, drag = springs
    nx = u.shape[1]
    line = np.empty(nx)
    inverse = 1.0 / unit
    for i in range(sites.rows):
        row, stretch, rough, anchors = u[i], w[i], heights[i], v[i]
        stencil_row(-inverse, u, -inverse * k1 / k0, w, i, sites, line)
        part(line, b[i])
        stencil_row(spread, w, drag, w, i, sites, line)
        total_stretch = 0.0
        for j in range(nx):
            line[j] = (row[j] - stretch[j] - anchors[j] + shift - line[j]) * inverse
            total_stretch += stretch[j]
        part(line, c[i])
        for j in range(nx):
            line[j] = (rough[j] - row[j]) * inverse
        part(line, bound[i])
        sums[i, 0] = total_stretch


@compiled
def measure_law(
    surface: Surface,
    law: ByLaw,
    springs: Springs,
    tangent: Tangent,
    scales: tuple[float, float],
    into: Measured,
    lag: Single,
    sites: Sites,
    sums: Field,
) -> None:
    """As `measure_2`, for a step by a law, linear about the stretches as they are; ``lag`` has its slope too.

    The scales: units of force and length. ``sums``: of w; of the changes by which each site would make up for
    what it lacks, its neighbors as they are; of their squares; of the squares of what the tangent would leave
    of them; of what a shift of 1 would change.
    """
    u, w, heights = surface
    v, velocity, derivative, position, tau, largest = law
    bound, b, c = into
    k0, k1, spread, _ = springs
    lagging, beside, bend = tangent
    nx = u.shape[1]
    line, lags = np.empty(nx), np.empty(nx)
    force, inverse, rising = -1.0 / scales[0], 1.0 / scales[1], tau * k1
    for i in range(sites.rows):
        row, stretch, rough, anchors = u[i], w[i], heights[i], v[i]
        stencil_row(force * k0, u, force * k1, w, i, sites, line)
        part(line, b[i])
        stencil_row(spread, w, lagging, w, i, sites, line)
        total = alone = squares = bends = response = 0.0
        for j in range(nx):
            lacking = row[j] - anchors[j] - position - line[j] - tau * velocity[i, j]
            rise = rising * derivative[i, j]
            own = lagging + beside + rise
            change = lacking / own
            left = error_of_tangent(rise, change, at(bend, (i, j)), own)
            total += stretch[j]
            alone += change
            squares += change * change
            bends += left * left
            response += 1.0 / own
            line[j] = lacking * inverse
            lags[j] = min(lagging + rise, largest)
        part(line, c[i])
        part(lags, lag[i])
        for j in range(nx):
            line[j] = (rough[j] - row[j]) * inverse
        part(line, bound[i])
        sums[i, 0], sums[i, 1], sums[i, 2] = total, alone, squares
        sums[i, 3], sums[i, 4] = bends, response


# A time step of creep, from one state to the next.


@inlined
def advance_row(
    surface: Surface,
    springs: Springs,
    unit: float,
    level: float,
    i: int,
    into: Measured,
    sites: Sites,
    line: Field,
    sums: Field,
) -> None:
    """Bound, source and flow of row i; see `advance`."""
    u, w, heights = surface
    bound, b, flow = into
    k0, k1, spreading, dragging = springs
    nx = u.shape[1]
    row, stretch, rough = u[i], w[i], heights[i]
    inverse = 1.0 / unit
    stencil_row(-inverse * k0, u, -inverse * k1, w, i, sites, line)
    part(line, b[i])
    stencil_row(inverse * spreading, w, inverse * dragging, w, i, sites, line)
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
        largest = larger(largest, abs(row[j]))
    part(line, bound[i])
    sums[0], sums[1], sums[2], sums[3] = sum_w, sum_u, squares_w, squares_u
    sums[4], sums[5] = largest, nx - free_sites


@compiled
def advance(
    correction: Pair,
    offset: float,
    surface: Surface,
    springs: Springs,
    unit: float,
    level: float,
    into: Measured,
    sites: Sites,
    sums: Field,
) -> None:
    """Add corrections to a state, and an offset to w; then the bound, source and flow of the new one.

    The source is minus the force k0 L u + k1 w. The flow is spread L w + drag w.
    ``sums``: w, u - level, their squares, the largest u, contacts. Rows are measured one behind, and the
    first and the last at the end.
    """
    e, f = correction
    u, w, heights = surface
    nx = u.shape[1]
    move, least, line = np.empty(nx, np.float32), np.empty(nx, np.float32), np.empty(nx)
    for i in range(sites.rows):
        join(e[i], move)
        join(into.bound[i], least)
        settle_row(u[i], heights[i], move, least, unit)
        join(f[i], move)
        add_row(w[i], move, unit, offset)
        if i > 1:
            advance_row(surface, springs, unit, level, i - 1, into, sites, line, sums[i - 1])
    for i in (0, sites.rows - 1):
        advance_row(surface, springs, unit, level, i, into, sites, line, sums[i])


@compiled
def begin_stage_1(past: Past, bound: Single, guess: Pair, c: Single, sites: Sites, sums: Field) -> None:
    """First guess from the last time steps, and the source -tau (rate + flow); ``sums`` of e, f and c."""
    last, before, ahead, back, rate, flow, tau = past
    e, f = guess
    for i in range(sites.rows):
        sum_e = sum_f = sum_c = np.float32(0.0)
        for side in range(2):
            for k in range(side, end_of(side, sites.columns)):
                move = max(bound[i, side, k], ahead * last.e[i, side, k] + back * before.e[i, side, k])
                stretch = ahead * last.f[i, side, k] + back * before.f[i, side, k]
                source = -tau * (rate[i, side, k] + flow[i, side, k])
                e[i, side, k], f[i, side, k], c[i, side, k] = move, stretch, source
                sum_e += move
                sum_f += stretch
                sum_c += source
        wrap(e[i], sites)
        wrap(f[i], sites)
        sums[i, 0], sums[i, 1], sums[i, 2] = sum_e, sum_f, sum_c


@compiled
def begin_stage_2(
    past: Past,
    growth: Scalar,
    offset: Scalar,
    weight: Scalar,
    middle: Single,
    bound: Single,
    guess: Pair,
    c: Single,
    sites: Sites,
    sums: Field,
) -> None:
    """Rate at the end of the first stage, f plus an offset; then the second, as in `begin_stage_1`."""
    last, before, ahead, back, rate, flow, tau = past
    e, f = guess
    pace = np.float32(1.0) / tau
    for i in range(sites.rows):
        sum_e = sum_f = sum_c = np.float32(0.0)
        for side in range(2):
            for k in range(side, end_of(side, sites.columns)):
                move, stretch = e[i, side, k], f[i, side, k] + offset
                found = (move - stretch) * pace - rate[i, side, k]
                source = -weight * (rate[i, side, k] + found) - tau * flow[i, side, k]
                path = growth * move + ahead * last.e[i, side, k] + back * before.e[i, side, k]
                move = max(bound[i, side, k], path)
                stretch = growth * stretch + ahead * last.f[i, side, k] + back * before.f[i, side, k]
                e[i, side, k], f[i, side, k], c[i, side, k] = move, stretch, source
                middle[i, side, k] = found
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
) -> None:
    """Rate at the end, f plus an offset, and the sum of the three rates with weights, rows in order."""
    e, f = correction
    first, second, third = shares
    pace = np.float32(1.0) / tau
    line = np.zeros((2, e.shape[2]), np.float32)
    for i in range(error.shape[0]):
        for side in range(2):
            for k in range(side, end_of(side, error.shape[1])):
                before, between = rate[i, side, k], middle[i, side, k]
                found = (e[i, side, k] - f[i, side, k] - offset - weight * (before + between)) * pace
                rate_at_end[i, side, k] = found
                line[side, k] = first * before + second * between + third * found
        join(line, error[i])


# One field.


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
    """Half sweeps: a wave of them, then the rows at both ends that it leaves undone.

    Where the number of rows is odd and the lattice periodic, the last row has the color of the first, its
    neighbor, and waits for it.
    """
    ny = eq.sites.rows
    odd = ny % 2
    for front in range(ny):
        for half in range(halves):
            i = front - half
            if half <= i < ny - odd - half:
                relax_row_1(eq, i, half & 1)
    for half in range(1 - odd, halves):
        for i in range(-half - odd, half):
            relax_row_1(eq, i % ny, half & 1)


@inlined
def defect_row_1(eq: One, i: int, defect: Single, sums: Field) -> None:
    """Minus the force off contact, in row i; ``sums``: the largest, the largest correction, contacts."""
    e, bound, b, _, diagonal, uniform, sites = eq
    zero, one = np.float32(0.0), np.float32(1.0)
    worst = far = free_sites = zero
    above, below = neighbors(i, sites)
    for side in range(2):
        row, other, least, source, out = e[i, side], e[i, 1 - side], bound[i, side], b[i, side], defect[side]
        up, down = e[above, side], e[below, side]
        for k in range(side, end_of(side, sites.columns)):
            beside = up[k] + down[k] + other[k - side] + other[k - side + 1]
            free = one if row[k] > least[k] else zero
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
        above, here, below = (2 * k - 1) % 3, 2 * k % 3, (2 * k + 1) % 3
        restrict_rows(defect[above], defect[here], defect[below], k, eq.sites, line, out[k])


@inlined
def product(x: Single, y: Single, columns: int) -> Any:
    """Sum of x y over a parted row."""
    m = x.shape[1] - 1
    value = np.float32(0.0)
    for k in range(m):
        value += x[0, k] * y[0, k]
    for k in range(1, 1 + columns - m):
        value += x[1, k] * y[1, k]
    return value


@inlined
def along_bonds(x: Single, x_next: Single, y: Single, y_next: Single, columns: int) -> Any:
    """Sum of (difference of x) (difference of y) over the bonds to the right of a row and below it."""
    value = np.float32(0.0)
    for side in range(2):
        a, a_right, a_below = x[side], x[1 - side], x_next[side]
        b, b_right, b_below = y[side], y[1 - side], y_next[side]
        for k in range(side, end_of(side, columns)):
            value += (a[k] - a_below[k]) * (b[k] - b_below[k])
            value += (a[k] - a_right[k - side + 1]) * (b[k] - b_right[k - side + 1])
    return value


@inlined
def off_contact(line: Single, e: Single, bound: Single, sites: Sites, out: Single) -> None:
    """A parted row where it is free, zero in contact."""
    for side in range(2):
        for k in range(side, end_of(side, sites.columns)):
            out[side, k] = line[side, k] if e[side, k] > bound[side, k] else np.float32(0.0)
    wrap(out, sites)


@compiled
def products_1(eq: One, coarse: Single, previous: Single, sums: Field) -> None:
    """Products by rows, for correction d and previous move q: r.d, r.q, d.Sd, d.Sq, q.Sq, sum d, sum q."""
    e, bound, b, bed, _, uniform, sites = eq
    ny, _, width = e.shape
    d, q = np.zeros((2, 2, width), np.float32), np.zeros((2, 2, width), np.float32)
    line = np.zeros((2, width), np.float32)
    for i in range(ny + 1):
        here = i if i < ny else neighbors(ny - 1, sites)[1]
        now = i % 2
        interpolate_row(coarse, here, sites, line)
        off_contact(line, e[here], bound[here], sites, d[now])
        off_contact(previous[here], e[here], bound[here], sites, q[now])
        if i == 0:
            continue
        x, y, d0, d1, q0, q1 = e[i - 1], e[here], d[1 - now], d[now], q[1 - now], q[now]
        zero = np.float32(0.0)
        rd = rq = dd = dq = qq = sd = sq = zero
        for side in range(2):
            a, a_right, a_below = x[side], x[1 - side], y[side]
            f, f_right, f_below = d0[side], d0[1 - side], d1[side]
            g, g_right, g_below = q0[side], q0[1 - side], q1[side]
            source = b[i - 1, side]
            for k in range(side, end_of(side, sites.columns)):
                r = k - side + 1
                known = bed * a[k] - source[k] + uniform
                a1, f1, g1 = a[k] - a_below[k], f[k] - f_below[k], g[k] - g_below[k]
                a2, f2, g2 = a[k] - a_right[r], f[k] - f_right[r], g[k] - g_right[r]
                rd += a1 * f1 + a2 * f2 + known * f[k]
                rq += a1 * g1 + a2 * g2 + known * g[k]
                dd += f1 * f1 + f2 * f2 + bed * f[k] * f[k]
                dq += f1 * g1 + f2 * g2 + bed * f[k] * g[k]
                qq += g1 * g1 + g2 * g2 + bed * g[k] * g[k]
                sd += f[k]
                sq += g[k]
        found = sums[i - 1]
        found[0], found[1], found[2], found[3], found[4], found[5], found[6] = rd, rq, dd, dq, qq, sd, sq


@inlined
def move_row(
    line: Single, last: Single, e: Single, bound: Single, sites: Sites, alpha: Scalar, beta: Scalar
) -> None:
    """Move the free sites of a row by ``alpha line + beta last``, which becomes the last; and project."""
    zero = np.float32(0.0)
    for side in range(2):
        for k in range(side, end_of(side, sites.columns)):
            here, least = e[side, k], bound[side, k]
            move = alpha * line[side, k] + beta * last[side, k] if here > least else zero
            last[side, k] = move
            e[side, k] = max(least, here + move)
    wrap(e, sites)


@compiled
def correct_1(eq: One, coarse: Single, previous: Single, alpha: Scalar, beta: Scalar) -> None:
    """Move free sites by alpha times the correction plus beta times the previous move, and project."""
    line = np.zeros((2, eq.e.shape[2]), np.float32)
    for i in range(eq.sites.rows):
        interpolate_row(coarse, i, eq.sites, line)
        move_row(line, previous[i], eq.e[i], eq.bound[i], eq.sites, alpha, beta)


# One field on a coarse grid.


@inlined
def coarse_relax_1(grid: CoarseOne, i: int, color: int) -> None:
    """Gauss-Seidel on the sites of one color in row i."""
    e, b, bed, pins, gx, gy, mx, my, sites = grid
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
    e, b, bed, pins, gx, gy, mx, my, sites = grid
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
def descend_1(grid: CoarseOne, coupling: float, out: Single) -> float:
    """From no correction: a sweep, the defect on the next coarser grid; the total of the correction.

    The total times the coupling is the uniform force on the grid.
    """
    e, sites = grid.e, grid.sites
    width = e.shape[2]
    e[:] = np.float32(0.0)
    for color in range(2):
        for i in range(sites.rows):
            coarse_relax_1(grid, i, color)
    value = weighted_total(e, grid.mx, grid.my)
    uniform = np.float32(coupling * value) if coupling else np.float32(0.0)
    defect, line = np.zeros((3, 2, width), np.float32), np.empty(width - 1, np.float32)
    for k in range((sites.rows + 1) // 2):
        for offset in range(-1, 2):
            i, into = fine_row(k, offset, sites), defect[(2 * k + offset) % 3]
            if i < 0:
                into[:] = np.float32(0.0)
            elif offset > -1 or k == 0:  # else it is still in the buffer
                coarse_defect_1(grid, uniform, i, into)
        upper, here, lower = (2 * k - 1) % 3, 2 * k % 3, (2 * k + 1) % 3
        restrict_rows(defect[upper], defect[here], defect[lower], k, sites, line, out[k])
    return value


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


@compiled
def ascend_1(grid: CoarseOne, coarse: Single, shift: Scalar, joined: Single) -> float:
    """Add the next coarser grid's correction, and ``shift`` to the source; sweep, the other color first.

    Returns the total.
    """
    e, sites = grid.e, grid.sites
    line = np.zeros((2, e.shape[2]), np.float32)
    for i in range(sites.rows):
        coarse_correct_row(coarse, e, sites, i, line)
        add_constant(grid.b, shift, grid.mx, grid.my, sites.columns, i)
    for color in (1, 0):
        for i in range(sites.rows):
            coarse_relax_1(grid, i, color)
    for i in range(sites.rows):
        join(e[i], joined[i])
    return weighted_total(e, grid.mx, grid.my)


# Two fields, of an implicit step of creep.


@compiled
def begin_error_2(e: Single, least: Single, error: Single, eq: Two, sums: Field) -> None:
    """The equations of an error of u0, rows in order, from nothing; those of u hold where e is ``least``.

    ``sums``: squares of the error, contacts that opened.
    """
    change, stretch, bound, b, c, _, _, _, _, sites = eq
    zero, unbounded, heavy = np.float32(0.0), np.float32(-np.inf), np.float32(-1e30)
    for i in range(sites.rows):
        part(error[i], c[i])
        change[i] = stretch[i] = zero
        squares, opened = zero, 0.0
        for side in range(2):
            for k in range(side, end_of(side, sites.columns)):
                free, before = e[i, side, k] > least[i, side, k], c[i, side, k]
                c[i, side, k] = -before
                bound[i, side, k] = unbounded if free else zero
                b[i, side, k] = zero if free else heavy
                squares += before * before
                opened += 1.0 if free and least[i, side, k] == zero else 0.0
        sums[i, 0], sums[i, 1] = squares, opened


@compiled
def differences(e: Single, f: Single, columns: int, sums: Field) -> None:
    """Sums of e - f and of its squares."""
    for i in range(e.shape[0]):
        value = squares = np.float32(0.0)
        for side in range(2):
            for k in range(side, end_of(side, columns)):
                change = e[i, side, k] - f[i, side, k]
                value += change
                squares += change * change
        sums[i, 0], sums[i, 1] = value, squares


@inlined
def relax_row_2(eq: Two, i: int, color: int) -> None:
    """Projected Gauss-Seidel, both fields of a site at once, on the sites of one color in row i."""
    e, f, bound, b, c, bed, spread, lag, shift, sites = eq
    side = (i + color) & 1
    one, four = np.float32(1.0), np.float32(4.0)
    before, after = neighbors(i, sites)
    e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
    f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
    least, first, second = bound[i, side], b[i, side], c[i, side]
    for k in range(side, end_of(side, sites.columns)):
        damping = one / (at(lag, (i, side, k)) + four * spread)
        damped = bed * damping
        inverse = one / (four + damped)
        beside = e_up[k] + e_down[k] + e_other[k - side] + e_other[k - side + 1] + first[k]
        known = spread * (f_up[k] + f_down[k] + f_other[k - side] + f_other[k - side + 1]) + second[k] + shift
        value = max(least[k], (beside - damped * known) * inverse)
        e_row[k] = value
        f_row[k] = (value + known) * damping
    wrap(e[i], sites)
    wrap(f[i], sites)


@inlined
def defect_row_2(eq: Two, i: int, balance: Single, creep: Single, sums: Field) -> None:
    """Defects of both equations in row i; ``sums``: their squares, sum of f, contacts, squares of e."""
    e, f, bound, b, c, bed, spread, lag, shift, sites = eq
    zero, one, four = np.float32(0.0), np.float32(1.0), np.float32(4.0)
    before, after = neighbors(i, sites)
    squares_1 = squares_2 = stretch = free_sites = moves = zero
    for side in range(2):
        e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
        f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
        least, first, second = bound[i, side], b[i, side], c[i, side]
        out_1, out_2 = balance[side], creep[side]
        for k in range(side, end_of(side, sites.columns)):
            diagonal = at(lag, (i, side, k)) + four * spread
            beside = e_up[k] + e_down[k] + e_other[k - side] + e_other[k - side + 1] - four * e_row[k]
            free = one if e_row[k] > least[k] else zero
            value = (beside + first[k] - bed * f_row[k]) * free
            flow = spread * (f_up[k] + f_down[k] + f_other[k - side] + f_other[k - side + 1])
            flow += second[k] + shift + e_row[k] - diagonal * f_row[k]
            out_1[k], out_2[k] = value, flow
            squares_1 += value * value
            squares_2 += flow * flow
            free_sites += free
            stretch += f_row[k]
            moves += e_row[k] * e_row[k]
    contacts = sites.columns - free_sites
    sums[0], sums[1], sums[2], sums[3], sums[4] = squares_1, squares_2, stretch, contacts, moves


@inlined
def restrict_pair(balance: Single, creep: Single, k: int, sites: Sites, line: Single, out: Pair) -> None:
    """Row k of two coarse fields, from buffers in which fine row i has the index i modulo 3."""
    above, here, below = (2 * k - 1) % 3, 2 * k % 3, (2 * k + 1) % 3
    restrict_rows(balance[above], balance[here], balance[below], k, sites, line, out.e[k])
    restrict_rows(creep[above], creep[here], creep[below], k, sites, line, out.f[k])


@inlined
def correct_row_2(eq: Two, moves: Moves, i: int, line: Single) -> None:
    """Move free sites, and f everywhere, by alpha times the correction plus beta times the previous move.

    Unless moves are kept there is no previous one, and alpha is 1.
    """
    coarse, previous, alpha, beta, keeping = moves
    e, f, bound, sites = eq.e, eq.f, eq.bound, eq.sites
    interpolate_row(coarse.e, i, sites, line)
    if keeping:
        move_row(line, previous.e[i], e[i], bound[i], sites, alpha, beta)
    else:
        for side in range(2):
            for k in range(side, end_of(side, sites.columns)):
                here, least = e[i, side, k], bound[i, side, k]
                e[i, side, k] = max(least, here + line[side, k]) if here > least else least
        wrap(e[i], sites)
    interpolate_row(coarse.f, i, sites, line)
    if keeping:
        for side in range(2):
            for k in range(side, end_of(side, sites.columns)):
                line[side, k] = alpha * line[side, k] + beta * previous.f[i, side, k]
                previous.f[i, side, k] = line[side, k]
        wrap(previous.f[i], sites)
    for side in range(2):
        for k in range(side, end_of(side, sites.columns)):
            f[i, side, k] += line[side, k]
    wrap(f[i], sites)


@compiled
def cycle_2(
    eq: Two, moves: Moves, correcting: bool, sweeping: bool, restricting: bool, out: Pair, sums: Field
) -> None:
    """A cycle on the lattice: a sweep, after the correction if wanted; restriction of the defects; on demand.

    A wave of all three, drawn at the head of the module; the sweep of the rows at both ends, the last of an
    odd number waiting as in `sweeps_1`; the restriction of the rows that remain. Without a correction the
    wave is a row shorter.
    """
    ny, _, width = eq.e.shape
    sites = eq.sites
    line, order = np.zeros((2, width), np.float32), np.empty(width - 1, np.float32)
    balance, creep = np.zeros((3, 2, width), np.float32), np.zeros((3, 2, width), np.float32)
    odd = ny % 2
    last, lead = ny - odd, 1 if correcting else 0
    margin = lead + 2
    if sweeping:
        for front in range(ny):
            if correcting:
                correct_row_2(eq, moves, front, line)
            for half in range(2):
                i, apart = front - lead - half, lead + half
                if apart <= i < last - apart:
                    relax_row_2(eq, i, half)
            i = front - margin
            if restricting and margin <= i < last - margin:
                n = i % 3
                defect_row_2(eq, i, balance[n], creep[n], sums[i])
                if i % 2 == 1 and i - 2 >= margin:
                    restrict_pair(balance, creep, i // 2, sites, order, out)
        for half in range(2):
            for i in range(-half - lead - odd, half + lead):
                relax_row_2(eq, i % ny, half)
    if restricting:
        done, resumed, stop = (margin + 2) // 2, (last - margin) // 2, (ny + 1) // 2
        if done >= resumed or not sweeping:
            done = resumed = stop
        for k in range(stop):
            if done <= k < resumed:
                continue
            for offset in range(-1, 2):
                i, n = fine_row(k, offset, sites), (2 * k + offset) % 3
                if i < 0:
                    balance[n] = np.float32(0.0)
                    creep[n] = np.float32(0.0)
                elif offset > -1 or k in (0, resumed):  # else it is still in the buffers
                    defect_row_2(eq, i, balance[n], creep[n], sums[i])
            restrict_pair(balance, creep, k, sites, order, out)


@inlined
def with_lag(lag: Single, i: int, x: Single, y: Single, columns: int) -> Any:
    """Sum of lag x y over parted row i."""
    value = np.float32(0.0)
    for side in range(2):
        for k in range(side, end_of(side, columns)):
            value += lag[i, side, k] * x[side, k] * y[side, k]
    return value


def lagged(lag: Any, i: int, x: Single, y: Single, columns: int) -> Any:
    """Sum of lag x y over parted row i; the lag is a number or a parted field."""
    return with_lag(lag, i, x, y, columns) if isinstance(lag, np.ndarray) else lag * product(x, y, columns)


@overload(lagged, jit_options={"forceinline": True}, strict=False)
def _lagged(lag: Any, i: int, x: Any, y: Any, columns: int) -> Any:
    del i, x, y, columns
    if isinstance(lag, types.Array):
        return lambda lag, i, x, y, columns: with_lag(lag, i, x, y, columns)
    return lambda lag, i, x, y, columns: lag * product(x, y, columns)  # noqa: ARG005


@inlined
def form_2(x: Pair, x_next: Pair, y: Pair, y_next: Pair, eq: Two, i: int) -> Any:
    """Symmetric form of two pairs of fields on row i and its bonds to the next."""
    nx = eq.sites.columns
    creep = eq.spread * along_bonds(x.f, x_next.f, y.f, y_next.f, nx) + lagged(eq.lag, i, x.f, y.f, nx)
    mixed = product(x.e, y.f, nx) + product(x.f, y.e, nx)
    return along_bonds(x.e, x_next.e, y.e, y_next.e, nx) + eq.bed * (mixed - creep)


@compiled
def products_2(eq: Two, moves: Moves, sums: Field) -> None:
    """Products of the symmetric form by rows, for the correction (d, p) and the previous move (q, g).

    Gradient with either, then dd, dq, qq, the sum of p and that of g.
    """
    e, f, bound, b, c, bed, _, _, shift, sites = eq
    coarse, previous, _, _, _ = moves
    ny, _, width = e.shape
    nx = sites.columns
    d, p = np.zeros((2, 2, width), np.float32), np.zeros((2, 2, width), np.float32)
    q, ones = np.zeros((2, 2, width), np.float32), np.ones((2, width), np.float32)
    line = np.zeros((2, width), np.float32)
    for i in range(ny + 1):
        y = i if i < ny else neighbors(ny - 1, sites)[1]
        now = i % 2
        interpolate_row(coarse.e, y, sites, line)
        off_contact(line, e[y], bound[y], sites, d[now])
        off_contact(previous.e[y], e[y], bound[y], sites, q[now])
        interpolate_row(coarse.f, y, sites, p[now])
        if i == 0:
            continue
        x = i - 1
        here, below = Pair(e[x], f[x]), Pair(e[y], f[y])
        move, move_next = Pair(d[1 - now], p[1 - now]), Pair(d[now], p[now])
        kept, kept_next = Pair(q[1 - now], previous.f[x]), Pair(q[now], previous.f[y])
        sum_p, sum_g = product(move.f, ones, nx), product(kept.f, ones, nx)
        found = sums[x]
        found[0] = form_2(here, below, move, move_next, eq, x) - product(b[x], move.e, nx)
        found[0] += bed * (product(c[x], move.f, nx) + shift * sum_p)
        found[1] = form_2(here, below, kept, kept_next, eq, x) - product(b[x], kept.e, nx)
        found[1] += bed * (product(c[x], kept.f, nx) + shift * sum_g)
        found[2] = form_2(move, move_next, move, move_next, eq, x)
        found[3] = form_2(move, move_next, kept, kept_next, eq, x)
        found[4] = form_2(kept, kept_next, kept, kept_next, eq, x)
        found[5], found[6] = sum_p, sum_g


# Two fields on a coarse grid.


@inlined
def coarse_relax_2(grid: CoarseTwo, i: int, color: int) -> None:
    """Gauss-Seidel, both fields of a site at once, on the sites of one color in row i."""
    e, f, b, c, bed, spread, lag, pins, gx, gy, mx, my, sites = grid
    ny = sites.rows
    one = np.float32(1.0)
    side = (i + color) & 1
    before, after = i - 1 if i > 0 else ny - 1, i + 1 if i < ny - 1 else 0
    above, below, size = gy[before], gy[i], my[i]
    e_row, e_other, e_up, e_down = e[i, side], e[i, 1 - side], e[before, side], e[after, side]
    f_row, f_other, f_up, f_down = f[i, side], f[i, 1 - side], f[before, side], f[after, side]
    right, left, cell = gx[side], gx[1 - side], mx[side]
    pin, first, second = pins[i, side], b[i, side], c[i, side]
    for k in range(side, end_of(side, sites.columns)):
        g = left[k - side]
        lap = (g + right[k]) * size + (above + below) * cell[k]
        mass = size * cell[k]
        beside = cell[k] * (above * e_up[k] + below * e_down[k])
        beside += size * (g * e_other[k - side] + right[k] * e_other[k - side + 1]) + first[k]
        flow = cell[k] * (above * f_up[k] + below * f_down[k])
        flow += size * (g * f_other[k - side] + right[k] * f_other[k - side + 1])
        known = second[k] + spread * flow
        inverse = one / (mass * at(lag, (i, side, k)) + spread * lap)
        coupling = bed * mass * inverse
        value = (beside - coupling * known) / (lap + pin[k] + coupling * mass)
        e_row[k] = value
        f_row[k] = (known + mass * value) * inverse
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
        out_1, out_2 = balance[side], creep[side]
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
            out_2[j] += mass * (e_row[j] - at(lag, (i, side, j)) * f_row[j])


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
    return weighted_total(grid.f, grid.mx, grid.my)


@compiled
def ascend_2(grid: CoarseTwo, coarse: Pair, shift: Scalar, joined: Pair) -> None:
    """As `ascend_1`, for both fields; the shift is that of the second equation, and there is no total."""
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
