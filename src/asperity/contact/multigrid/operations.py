"""The operations on grids that multigrid is made of, by compiled loops.

They know how a field is laid out. Fields are in the layout and precision of `loops`, but for states and
heights (double, rows in order) and for ``coarse`` and ``joined``, corrections that a coarse grid hands to the
next finer one (rows in order). Numbers come back summed over the rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.contact.multigrid.loops import (
    CoarseOne,
    CoarseTwo,
    Fields,
    Measured,
    One,
    Pair,
    Past,
    Scales,
    Single,
    Sites,
    Surface,
    Two,
    one_field,
    rows,
    states,
    two_fields,
)
from asperity.lattice import Field
from asperity.solids import Springs


class Defects(NamedTuple):
    """Of two fields: sum of f, contacts, squares of e."""

    stretch: float
    contacts: float
    moves: float


class Extremes(NamedTuple):
    """Of one field: the largest force off contact, the largest correction, contacts."""

    worst: float
    far: float
    contacts: float


class Found(NamedTuple):
    """Of a state: largest force off contact, tension in a row and u; sums. Rises are above a level."""

    worst: float
    tension: float
    largest: float
    load: float
    imbalance: float
    contacts: float
    stretch: float
    rise: float
    squares_w: float
    squares_u: float


# Fields.


def packed(field: NDArray[np.floating]) -> Single:
    """A field, rows in order, in this layout; images are those of the other ends of rows."""
    ny, nx = field.shape
    out = np.zeros((ny, 2, (nx + 1) // 2 + 1), np.float32)
    rows.part_rows(field, Sites(ny, nx, False), out)
    return out


def unpacked(field: Single, sites: Sites) -> Field:
    """A field, rows in order, in double precision."""
    out = np.empty((sites.rows, sites.columns))
    rows.join_rows(field, out)
    return out


def total(field: Single, sites: Sites) -> float:
    """Sum of a field."""
    sums = _sums(sites)
    rows.total(field, sites.columns, sums)
    return float(sums[:, 0].sum())


def restrict(field: Single, sites: Sites, out: Single, softening: float = 0.0, mean: float = 0.0) -> None:
    """A field on the next coarser grid, by the transpose of interpolation.

    Above the mean a value x becomes x / (1 + softening (x - mean)) before.
    """
    rows.restrict(field, sites, np.float32(softening), np.float32(mean), out)


# From states to corrections, and back.


def measure(
    surface: Surface,
    springs: Springs,
    uniform: float,
    scales: Scales,
    into: Measured,
    sites: Sites,
    *,
    flowing: bool,
) -> Found:
    """Bound, source and flow of a state with the force k0 L u + k1 w + uniform."""
    sums = _sums(sites)
    numbers = springs.k0, springs.k1, springs.spread, springs.drag
    states.measure(surface, numbers, uniform, flowing, scales, into, sites, sums)
    return Found(*sums[:, :3].max(axis=0).tolist(), *sums[:, 3:].sum(axis=0).tolist())


def settle(surface: Surface, correction: Pair, bound: Single, unit: float, offset: float) -> None:
    """Add corrections, and an offset to w, unless it has no rows."""
    states.settle(surface, correction, bound, unit, offset)


def guess(
    past: Past,
    numbers: Sequence[float],
    middle: Single,
    bound: Single,
    guess: Pair,
    c: Single,
    sites: Sites,
) -> tuple[float, float, float]:
    """The rate ``middle`` where the stage before ends; guess and source of a stage, and their sums.

    The numbers: weight of the stage before, the constant its f lacks, weights of both rates.
    """
    growth, offset, first, second = map(np.float32, numbers)
    sums = _sums(sites)
    states.guess(past, growth, offset, (first, second), middle, bound, guess, c, sites, sums)
    e, f, source = sums[:, :3].sum(axis=0).tolist()
    return e, f, source


def finish(
    correction: Pair,
    rates: tuple[Single, Single, Single],
    numbers: Sequence[float],
    error: Single,
    sites: Sites,
) -> None:
    """The rate where a time step ends, the last of the rates, and its error.

    The numbers: the constant that f lacks, tau, the weight of the rates, those of the error.
    """
    offset, tau, weight, first, second, third = map(np.float32, numbers)
    rate, middle, end = rates
    shares = first, second, third
    states.finish_step(correction, offset, rate, middle, tau, weight, shares, end, error, sites)


# Problems of one field, and of two.


def sweep_1(eq: One, halves: int) -> None:
    """Half sweeps of one field, one after the other."""
    one_field.sweeps_1(eq, halves)


def restrict_1(eq: One, out: Single) -> Extremes:
    """The defect of one field, on the first coarse grid."""
    sums = _sums(eq.sites)
    one_field.restrict_1(eq, out, sums)
    worst, far = sums[:, :2].max(axis=0).tolist()
    return Extremes(worst, far, float(sums[:, 2].sum()))


def correct_1(eq: One, coarse: Single, previous: Single, alpha: float, beta: float) -> None:
    """Move free sites by alpha times the correction plus beta times the previous move, and project."""
    one_field.correct_1(eq, coarse, previous, np.float32(alpha), np.float32(beta))


def products_1(eq: One, coarse: Single, previous: Single) -> Field:
    """Products of gradient r, correction d, previous move q: rd, rq, dSd, dSq, qSq, sums of d and q."""
    sums = _sums(eq.sites)
    one_field.products_1(eq, coarse, previous, sums)
    return np.asarray(sums[:, :7].sum(axis=0))


def cycle_2(eq: Two, coarse: Pair, part: float, out: Pair, *, correcting: bool, restricting: bool) -> Defects:
    """Of two fields a part of a coarse grid's correction, a sweep, and the defects on that grid.

    The correction and the defects are on demand.
    """
    sums = _sums(eq.sites)
    two_fields.cycle_2(eq, coarse, np.float32(part), correcting, restricting, out, sums)
    return Defects(*sums[:, :3].sum(axis=0).tolist())


def descend(grid: CoarseOne | CoarseTwo, out: Fields) -> float:
    """A sweep from nothing and the defects on the next coarser grid; the sum of the last correction."""
    return float(_DESCEND[len(out)](grid, out))


def ascend(grid: CoarseOne | CoarseTwo, coarse: Fields, shift: float, joined: Fields) -> float:
    """Add the next coarser grid's corrections, and a constant to the last source; a sweep.

    Returns the sum of the last correction.
    """
    return float(_ASCEND[len(coarse)](grid, coarse, np.float32(shift), joined))


def _sums(sites: Sites) -> Field:
    """A place for numbers by rows."""
    return np.zeros((sites.rows, len(Found._fields)))


_DESCEND: dict[int, Any] = {1: one_field.descend_1, 2: two_fields.descend_2}
_ASCEND: dict[int, Any] = {1: one_field.ascend_1, 2: two_fields.ascend_2}
"""Loops by the number of fields."""
