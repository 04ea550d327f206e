"""The operations on grids that multigrid is made of, by compiled loops.

Another backend is another class with these methods: whatever knows how a field is laid out is here and in
`asperity.contact.multigrid.loops`. Fields that a method returns or takes are in the backend's own layout
and precision, but for states and heights (double, rows in order) and for ``coarse`` and ``joined``,
corrections that a coarse grid hands to the next finer one. Numbers come back summed over the rows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.contact.multigrid import loops
from asperity.contact.multigrid.loops import (
    ByLaw,
    CoarseOne,
    CoarseTwo,
    Measured,
    Moves,
    One,
    Pair,
    Past,
    Single,
    Sites,
    Springs,
    Surface,
    Tangent,
    Two,
)
from asperity.lattice import Field


class Defects(NamedTuple):
    """Of two fields: squares of both defects, sum of f, contacts, squares of e."""

    balance: float
    creep: float
    stretch: float
    contacts: float
    moves: float


class Extremes(NamedTuple):
    """Of one field: the largest force off contact, the largest correction, contacts."""

    worst: float
    far: float
    contacts: float


class Forces(NamedTuple):
    """Of a state: largest force off contact, largest tension in a row, load, contacts, imbalance."""

    worst: float
    tension: float
    load: float
    contacts: float
    imbalance: float


class Moments(NamedTuple):
    """Of a state: sums of w and u - level, of their squares, the largest u, contacts."""

    stretch: float
    rise: float
    squares_w: float
    squares_u: float
    largest: float
    contacts: float


class Processor:
    """The backend that computes on the processor."""

    def __init__(self) -> None:
        self._kept: dict[int, Field] = {}

    def _sums(self, sites: Sites) -> Field:
        """A place for numbers by rows."""
        if sites.rows not in self._kept:
            self._kept[sites.rows] = np.zeros((sites.rows, 7))
        return self._kept[sites.rows]

    # Fields.

    def zeros(self, sites: Sites) -> Single:
        """A field of zeros."""
        return np.zeros((sites.rows, 2, (sites.columns + 1) // 2 + 1), np.float32)

    def joined(self, sites: Sites) -> Single:
        """A place for a correction that the next finer grid takes."""
        return np.zeros((sites.rows, sites.columns), np.float32)

    def packed(self, field: NDArray[np.floating]) -> Single:
        """A field, rows in order, in this layout; no images, and 0 where there is no site."""
        rows, columns = field.shape
        out = self.zeros(Sites(rows, columns, False))
        loops.part_rows(field, out)
        return out

    def unpacked(self, field: Single, sites: Sites) -> Field:
        """A field, rows in order, in double precision."""
        out = np.empty((sites.rows, sites.columns))
        loops.join_rows(field, out)
        return out

    def along_rows(self, values: Field, *, images: bool) -> Single:
        """Numbers that all rows of a grid have in common, one a column; images are those of the other end."""
        row: Single = self.packed(values[np.newaxis])[0]
        if images:
            loops.wrap(row, Sites(1, values.size, False))
        return row

    def total(self, field: Single, sites: Sites) -> float:
        """Sum of a field."""
        sums = self._sums(sites)
        loops.total(field, sites.columns, sums)
        return float(sums[:, 0].sum())

    def touching(self, e: Single, bound: Single) -> int:
        """Number of sites in contact."""
        return int(np.count_nonzero(e <= bound))

    def touch(self, e: Single, bound: Single) -> None:
        """Bring the site that comes nearest into contact."""
        deepest = int(np.argmax(bound - e))
        e.flat[deepest] = bound.flat[deepest]

    # From states to corrections, and back.

    def measure_1(
        self,
        u: Field,
        heights: Field,
        force: tuple[float, float, float],
        unit: float,
        bound: Single,
        b: Single,
        sites: Sites,
    ) -> Forces:
        """Bound and source of a state with the force (k0, bed, uniform): k0 L u + bed u + uniform."""
        sums = self._sums(sites)
        loops.measure_1(u, heights, *force, unit, bound, b, sites, sums)
        worst, tension = sums[:, :2].max(axis=0)
        return Forces(worst, tension, *sums[:, 2:5].sum(axis=0).tolist())

    def measure_2(
        self,
        surface: Surface,
        anchors: Field,
        springs: Springs,
        shift: float,
        unit: float,
        into: Measured,
        sites: Sites,
    ) -> float:
        """Bound and both sources of a step from anchors; the sum of w."""
        sums = self._sums(sites)
        loops.measure_2(surface, anchors, springs, shift, unit, into, sites, sums)
        return float(sums[:, 0].sum())

    def settle(self, u: Field, heights: Field, e: Single, bound: Single, unit: float) -> None:
        """Add a correction to a surface."""
        loops.settle(u, heights, e, bound, unit)

    def add(self, w: Field, f: Single, unit: float) -> None:
        """Add a correction to a field."""
        loops.add(w, f, unit)

    def settle_law(
        self,
        surface: Surface,
        correction: Pair,
        bound: Single,
        lag: Single,
        tangent: Tangent,
        unit: float,
        sites: Sites,
    ) -> float:
        """Add corrections to u and w; squares of what the tangent of a law leaves of w."""
        sums = self._sums(sites)
        loops.settle_law(surface, correction, bound, lag, tangent, unit, sums)
        return float(sums[:, 0].sum())

    def measure_law(
        self,
        surface: Surface,
        law: ByLaw,
        springs: Springs,
        tangent: Tangent,
        scales: tuple[float, float],
        into: Measured,
        lag: Single,
        sites: Sites,
    ) -> list[float]:
        """Bound, sources and lag of a step by a law; the sums of `loops.measure_law`."""
        sums = self._sums(sites)
        loops.measure_law(surface, law, springs, tangent, scales, into, lag, sites, sums)
        found: list[float] = sums[:, :5].sum(axis=0).tolist()
        return found

    # Coefficients of coarse grids.

    def pin(self, e: Single, bound: Single, sites: Sites, strength: float, out: Single) -> None:
        """Pins on the first coarse grid: each contact counts ``strength``."""
        loops.pins_of_contacts(e, bound, sites, np.float32(strength), out)

    def coarser_pins(self, pins: Single, sites: Sites, softening: float, mean: float, out: Single) -> None:
        """Pins on the next coarser grid, less what stands out from a mean softens; 0 only restricts."""
        loops.coarser_pins(pins, sites, np.float32(softening), np.float32(mean), out)

    def coarser_lag(self, lag: Single, cells: Single, beside: float, sites: Sites, out: Single) -> None:
        """A lag by site on the next coarser grid, weighted by the sizes of cells over lag + beside."""
        loops.coarser_lag(lag, cells, np.float32(beside), sites, out)

    # One field.

    def sweep_1(self, eq: One, halves: int) -> None:
        """Half sweeps, one after the other."""
        loops.sweeps_1(eq, halves)

    def restrict_1(self, eq: One, out: Single) -> Extremes:
        """The defect, on the first coarse grid."""
        sums = self._sums(eq.sites)
        loops.restrict_1(eq, out, sums)
        worst, far = sums[:, :2].max(axis=0).tolist()
        return Extremes(worst, far, float(sums[:, 2].sum()))

    def products_1(self, eq: One, coarse: Single, previous: Single) -> Field:
        """Products of gradient r, correction d, previous move q: rd, rq, dSd, dSq, qSq, sums of d and q."""
        sums = self._sums(eq.sites)
        loops.products_1(eq, coarse, previous, sums)
        return np.asarray(sums.sum(axis=0))

    def correct_1(self, eq: One, coarse: Single, previous: Single, alpha: float, beta: float) -> None:
        """Move free sites by alpha times the correction plus beta times the previous move, and project."""
        loops.correct_1(eq, coarse, previous, np.float32(alpha), np.float32(beta))

    def descend_1(self, grid: CoarseOne, coupling: float, out: Single) -> float:
        """A sweep from nothing and the defect on the next coarser grid; the sum of the correction."""
        return float(loops.descend_1(grid, coupling, out))

    def ascend_1(self, grid: CoarseOne, coarse: Single, shift: float, joined: Single) -> float:
        """Add the next coarser grid's correction, and a constant to the source; a sweep; the sum."""
        return float(loops.ascend_1(grid, coarse, np.float32(shift), joined))

    # Two fields.

    def cycle_2(
        self, eq: Two, moves: Moves, out: Pair, *, correcting: bool, sweeping: bool, restricting: bool
    ) -> Defects:
        """The coarse grids' correction, a sweep, and the defects on the first of them; each on demand."""
        sums = self._sums(eq.sites)
        loops.cycle_2(eq, moves, correcting, sweeping, restricting, out, sums)
        return Defects(*sums[:, :5].sum(axis=0).tolist())

    def begin_error_2(self, e: Single, least: Single, error: Single, eq: Two) -> tuple[float, float]:
        """The equations of an error of u0, rows in order, for contacts where e is least.

        Returns the squares of the error, and the number of contacts that opened.
        """
        sums = self._sums(eq.sites)
        loops.begin_error_2(e, least, error, eq, sums)
        squares, opened = sums[:, :2].sum(axis=0).tolist()
        return squares, opened

    def differences(self, correction: Pair, sites: Sites) -> tuple[float, float]:
        """Sum of e - f, and of its squares."""
        sums = self._sums(sites)
        loops.differences(*correction, sites.columns, sums)
        value, squares = sums[:, :2].sum(axis=0).tolist()
        return value, squares

    def products_2(self, eq: Two, moves: Moves) -> Field:
        """Products of the symmetric form, as `products_1` has them; the sums are those of f."""
        sums = self._sums(eq.sites)
        loops.products_2(eq, moves, sums)
        return np.asarray(sums.sum(axis=0))

    def descend_2(self, grid: CoarseTwo, out: Pair) -> float:
        """As `descend_1`, for both fields; the sum of f."""
        return float(loops.descend_2(grid, out))

    def ascend_2(self, grid: CoarseTwo, coarse: Pair, shift: float, joined: Pair) -> None:
        """As `ascend_1`, for both fields; the constant is the second equation's."""
        loops.ascend_2(grid, coarse, np.float32(shift), joined)

    # A time step of two stages.

    def guess_1(
        self, past: Past, bound: Single, guess: Pair, c: Single, sites: Sites
    ) -> tuple[float, float, float]:
        """Guess and source of the first stage; sums of e, f and c."""
        sums = self._sums(sites)
        loops.begin_stage_1(past, bound, guess, c, sites, sums)
        e, f, source = sums[:, :3].sum(axis=0).tolist()
        return e, f, source

    def guess_2(
        self,
        past: Past,
        numbers: tuple[float, float, float],
        middle: Single,
        bound: Single,
        guess: Pair,
        c: Single,
        sites: Sites,
    ) -> tuple[float, float, float]:
        """The rate ``middle`` where the first stage ends; guess, source and sums of the second.

        The numbers: weight of the first stage, the constant its f lacks, weight of the rates.
        """
        sums, (growth, offset, weight) = self._sums(sites), map(np.float32, numbers)
        loops.begin_stage_2(past, growth, offset, weight, middle, bound, guess, c, sites, sums)
        e, f, source = sums[:, :3].sum(axis=0).tolist()
        return e, f, source

    def finish(
        self,
        correction: Pair,
        rates: tuple[Single, Single, Single],
        numbers: tuple[float, ...],
        error: Single,
    ) -> None:
        """The rate where the step ends, the last of the rates, and its error, rows in order.

        The numbers: the constant that f lacks, tau, the weight of the rates, those of the error.
        """
        offset, tau, weight, *shares = map(np.float32, numbers)
        first, second, third = shares
        rate, middle, end = rates
        loops.finish_step(correction, offset, rate, middle, tau, weight, (first, second, third), end, error)

    def advance(
        self,
        correction: Pair,
        offset: float,
        surface: Surface,
        springs: Springs,
        unit: float,
        level: float,
        into: Measured,
        sites: Sites,
    ) -> Moments:
        """Add corrections, and an offset to w; bound, source b and flow (as c) of the new state."""
        sums = self._sums(sites)
        loops.advance(correction, offset, surface, springs, unit, level, into, sites, sums)
        stretch, rise, squares_w, squares_u, _, contacts = sums[:, :6].sum(axis=0).tolist()
        return Moments(stretch, rise, squares_w, squares_u, float(sums[:, 4].max()), contacts)
