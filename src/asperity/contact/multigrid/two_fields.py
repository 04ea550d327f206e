r"""One implicit step of creep of the lattice of springs, on the pair of u and its stretch w = u - u0.

The stiffness of a finite step is not local, but the pair is:

    k0 L u + k1 w = r,                          0 <= r  perpendicular to  u - xi >= 0
    w + spread L w + drag w = u - v + shift,

shift = 0 under separation control; under load control the shift is unknown and the sum of k1 w is F.
Only u is constrained, and only contacts are invisible to coarse grids: the cycle is that of
`asperity.contact.multigrid.one_field`, both unknowns of a site relaxed together. Where cycles are slow,
the correction is combined with the previous one as there, by the stationary point of the symmetric form
that the pair makes instead of the lowest energy. That form is indefinite, and crowded contacts can make
corrections too large, so that they hardly fall or grow: from then on the part of each that is taken follows
from how the last part changed it (B. M. Irons, R. C. Tuck, Int. J. Numer. Methods Eng. 1, 275 (1969),
DOI 10.1002/nme.1620010306).

All this happens to a correction (e, f) of the pair, in single precision and in units in which k0 = 1.
"""

from __future__ import annotations

import math
from copy import copy
from functools import cached_property
from typing import Any

import numpy as np

from asperity.contact.arrays import inner, largest
from asperity.contact.multigrid.grids import Hierarchy
from asperity.contact.multigrid.loops import (
    ByLaw,
    Measured,
    Moves,
    Pair,
    Single,
    Sites,
    Springs,
    Surface,
    Tangent,
    Two,
)
from asperity.contact.multigrid.one_field import SINGLE_PRECISION, lowest
from asperity.contact.multigrid.pins import Response
from asperity.contact.multigrid.processor import Defects, Processor
from asperity.contact.problem import SpringStep
from asperity.lattice import Field

_SLOW = 0.4
"""Ratio of successive corrections above which they are combined."""

_OVERSHOOTING = 0.8
"""Ratio of successive corrections above which all later ones are taken in part."""

_LEAST, _MOST = 0.1, 2.0
"""Least and most part of a correction that is then taken."""

_USUAL_RATE = 0.3
"""Ratio of successive errors expected before two are known."""

_FORCE_ERROR, _LEAST_FORCE_ERROR = 1e-3, 1e-5
"""Error of the sum of the forces that is allowed even where an error of u0 is, and the least asked for."""

_STIFF = 100.0
"""k1/k0 from which the former falls with its square: errors of all steps have one sign, and add up.

Also the most with which is estimated what a step leaves of an error."""

_LEFT = 0.2, 8
"""How well what a step leaves of an error is known, in units of that error, and the most cycles for it."""

_ROUNDING = 20 * float(np.finfo(np.float32).eps)
"""Change below which cycles no longer converge, in units of the correction: 16 was the most seen."""

SOFTEST = 1e-5
"""Least k0/k1 in corrections, which need not be exact: the forces that they are to remove are."""


class TwoFields:
    """Work space for one lattice, and the correction on it.

    Attributes
    ----------
    correction, source, previous
        e and f; b and c of the equations in `asperity.contact.multigrid.loops`; the previous move of e and f.
    bound
        Least e that does not penetrate, a length <= 0: minus the gap u - heights.
    shift
        The unknown shift, a length.
    latest
        Correction of e - f that the coarse grids found last, on the first coarse grid.
    overshooting
        Whether a correction of this problem was hardly smaller than the one before.
    wanted
        Sum of f with which the load is carried, a length, or None where the separation is prescribed.
    yielding
        Number of sites that carry a force that is given, off the obstacle.
    known_stretch
        Sum of w before the correction, a length.
    """

    def __init__(self, sites: Sites, backend: Processor) -> None:
        self.sites, self.backend, self.size = sites, backend, sites.rows * sites.columns
        self.hierarchy = Hierarchy(sites, 2, backend)
        self.bound = backend.zeros(sites)
        self.bound.fill(-np.inf)
        self.correction, self.source, self.previous = (self.pair() for _ in range(3))
        self.shift, self.known_stretch, self.total_stretch = 0.0, 0.0, 0.0
        self.weights, self.last_shift, self.keeping, self.overshooting = (1.0, 0.0), 0.0, False, False
        self.wanted: float | None = None
        self.yielding = 0
        self.latest: Single = np.zeros(0, np.float32)

    def pair(self) -> Pair:
        """Two fields of zeros."""
        return Pair(self.backend.zeros(self.sites), self.backend.zeros(self.sites))

    def prepare(self, bed: float, spread: float, drag: float) -> None:
        """Set the coefficients: bed = k1/k0, and those of the equations."""
        self.bed, self.spread, self.pinned, self.factorized = bed, spread, -math.inf, False
        self.mean_lag = 1.0 + drag
        self.lag: Any = np.float32(self.mean_lag)
        self.coarse_lags: list[Any] = [self.lag] * len(self.hierarchy.grids)
        self.response = Response(bed, spread, drag)
        self.force_error = max(_FORCE_ERROR * min(1.0, _STIFF / bed) ** 2, _LEAST_FORCE_ERROR)

    def solve(
        self, springs: SpringStep, heights: Field, u: Field, w: Field, tolerance: float, max_cycles: int
    ) -> tuple[bool, int]:
        """Improve u and w in place; whether the tolerance was reached, and the cycles taken."""
        self.prepare(springs.k1 / springs.k0, springs.spread, springs.drag)
        unit = largest(u, np) or 1.0
        surface = Surface(u, w, heights)
        self.measure(springs, surface, unit)
        stiffest = 8.0 / self.bed + 1.0 + springs.drag + 8.0 * self.spread
        size = math.inf
        for cycle in range(max_cycles):
            found = self.descend(correcting=cycle > 0)
            missing, left = self.judge(found)
            reachable = SINGLE_PRECISION * stiffest * math.sqrt(found.moves / self.size)
            if left <= max(self.strict(tolerance, found.contacts), reachable):
                self.settle(surface, unit)
                self.measure(springs, surface, unit)
                found = self.descend(correcting=False, sweeping=False)
                missing, left = self.judge(found)
                if left <= self.strict(tolerance, found.contacts):
                    return True, cycle + 1
            size, _ = self.find_correction(found.contacts, missing, cycle, size)
            if not math.isfinite(size):
                return False, max_cycles
        self.settle(surface, unit)
        return False, max_cycles

    def improve(
        self, allowed_error: float, max_cycles: int, *, total_counts: bool = True
    ) -> tuple[bool, int]:
        """Improve the correction until the error of e - f, rms over the sites, is small enough, or rounding.

        A time step starts near its end, and a cycle usually divides the error by four or more; the size of
        a change estimates the error before it, and so the one that is left. A surface that moves as a whole
        leaves e - f alone: where it counts, what the sum of f lacks is to be a small part of the whole, too.
        """
        size = math.inf
        for cycle in range(max_cycles):
            found = self.descend(correcting=cycle > 0)
            missing, _ = self.judge(found)
            far = math.sqrt(found.moves / self.size)
            size, rate = self.find_correction(found.contacts, missing, cycle, size)
            if not math.isfinite(size):
                break
            if self.wanted is not None and found.contacts + self.yielding == 0:
                continue  # something must carry the load
            if self.wanted is None and found.contacts > 0:
                missing = self.weights[0] * self.size * float(np.mean(self.hierarchy.joined.f, dtype=float))
            good = rate * size <= max(allowed_error, _ROUNDING * far)
            carried = rate * abs(missing) <= self.force_error * abs(self.total_stretch) or not total_counts
            if good and carried:
                self.descend(correcting=True, restricting=False)
                return True, cycle + 1
        return False, max_cycles

    @cached_property
    def spare(self) -> tuple[Pair, Pair, Pair, Single]:
        """Places for an error of the correction."""
        return self.pair(), self.pair(), self.pair(), self.backend.zeros(self.sites)

    def left_of(self, error: Single, spread: float, drag: float) -> float:
        """What an implicit step leaves of an error of u0, rms over the sites, while the contacts stay.

        The error has its rows in order. The equations are those of a step, with e = 0 in contact, and the
        pins are those of the correction, where the coefficients are. Where cycles do not solve them, all of
        the error is left.
        """
        work, backend = copy(self), self.backend
        work.correction, work.source, work.previous, work.bound = self.spare
        if self.bed > _STIFF or (spread, 1.0 + drag) != (self.spread, self.mean_lag):
            work.prepare(min(self.bed, _STIFF), spread, drag)
            self.pinned, self.factorized = -math.inf, False
        work.shift, work.wanted = 0.0, None if self.wanted is None else 0.0
        squares, _ = backend.begin_error_2(self.correction.e, self.bound, error, work.equation())
        scale, (goal, most) = math.sqrt(squares / self.size), _LEFT
        done, _ = work.improve(goal * scale, most, total_counts=False)
        if not done:
            return scale
        total, squares = backend.differences(work.correction, self.sites)
        mean = 0.0 if self.wanted is None else total / self.size  # a load decides it
        return math.sqrt(max(squares / self.size - mean * mean, 0.0))

    def measure(self, springs: SpringStep, surface: Surface, unit: float) -> None:
        """Begin a correction to the fields as they are."""
        s, v, shift = springs, springs.anchors, 0.0
        u, w, _ = surface
        if not isinstance(v, np.ndarray):
            v = np.full(u.shape, v)
        if s.load is not None:
            shift = (1.0 + s.drag) * float(w.mean()) - float(u.mean()) + float(v.mean())
        creep = Springs(s.k0, s.k1, s.spread, s.drag)
        into = Measured(self.bound, *self.source)
        stretch = self.backend.measure_2(surface, v, creep, shift, unit, into, self.sites)
        for field in self.correction:
            field.fill(0.0)
        self.shift, self.known_stretch = 0.0, stretch / unit
        self.wanted = None if s.load is None else s.load / (s.k1 * unit) - self.known_stretch

    def measure_law(
        self,
        surface: Surface,
        law: ByLaw,
        springs: Springs,
        tangent: Tangent,
        scales: tuple[float, float],
        total: float | None,
    ) -> tuple[float, float]:
        """Begin a correction to the fields as they are, the sum of w being given or None.

        The shift is at first what sites alone would need for that sum. Returns the rms of their changes
        alone, and of what the tangent would leave of those.
        """
        if not isinstance(self.lag, np.ndarray):
            self.lag = self.backend.zeros(self.sites)
            self.lag.fill(1.0)
        places, unit = (Measured(self.bound, *self.source), self.lag, self.sites), scales[1]
        found = self.backend.measure_law(surface, law, springs, tangent, scales, *places)
        stretch, alone, squares, left, response = found
        for field in self.correction:
            field.fill(0.0)
        self.shift, self.known_stretch, self.wanted = 0.0, stretch / unit, None
        if total is not None:
            self.wanted = (total - stretch) / unit
            self.shift = (self.wanted - alone / unit) / (response or math.nan)
            squares -= alone * alone / self.size
        return math.sqrt(max(squares, 0.0) / self.size), math.sqrt(left / self.size)

    def relag(self) -> None:
        """Bring the lag by site to the coarse grids."""
        self.coarse_lags = self.hierarchy.coarser_lags(self.lag, self.spread)
        self.factorized = False
        if self.pinned < 0:
            self.mean_lag = float(np.mean(self.hierarchy.grids[-1].in_order(self.coarse_lags[-1])))
            self.response = Response(self.bed, self.spread, self.mean_lag - 1.0)

    def settle_law(self, surface: Surface, tangent: Tangent, unit: float) -> float:
        """As `settle`; what the tangent of the law leaves of w, rms."""
        places = (surface, self.correction, self.bound, self.lag, tangent, unit, self.sites)
        return math.sqrt(self.backend.settle_law(*places) / self.size)

    def settle(self, surface: Surface, unit: float) -> None:
        """Add the correction."""
        (u, w, heights), (e, f) = surface, self.correction
        self.backend.settle(u, heights, e, self.bound, unit)
        self.backend.add(w, f, unit)

    def equation(self) -> Two:
        """Fields and coefficients."""
        bed, spread, shift = map(np.float32, (self.bed, self.spread, self.shift))
        return Two(*self.correction, self.bound, *self.source, bed, spread, self.lag, shift, self.sites)

    def moves(self) -> Moves:
        """What the coarse grids found, and the previous move, with their weights."""
        alpha, beta = map(np.float32, self.weights)
        return Moves(self.hierarchy.joined, self.previous, alpha, beta, self.keeping)

    def descend(self, *, correcting: bool, sweeping: bool = True, restricting: bool = True) -> Defects:
        """Add what the coarse grids found, find the contacts and smooth, and bring the defects to them."""
        places = (self.equation(), self.moves(), Pair(*self.hierarchy.grids[0].source))
        return self.backend.cycle_2(
            *places, correcting=correcting, sweeping=sweeping, restricting=restricting
        )

    def judge(self, found: Defects) -> tuple[float, float]:
        """What the sum of f lacks; what the equations leave, rms."""
        self.total_stretch = self.known_stretch + found.stretch
        missing = 0.0 if self.wanted is None else self.wanted - found.stretch
        left = max(math.sqrt(found.balance / self.size) / self.bed, math.sqrt(found.creep / self.size))
        return missing, max(left, abs(missing) / self.size)

    def strict(self, tolerance: float, contacts: float) -> float:
        """What the equations may leave in the end."""
        rounding = 4.0 * float(np.finfo(float).eps) * (8.0 / self.bed + 1.0)
        return max(tolerance * abs(self.total_stretch) / max(contacts, 1.0), rounding)

    def find_correction(
        self, contacts: float, missing: float, cycle: int, before: float
    ) -> tuple[float, float]:
        """Ask the coarse grids; the size of their correction of u0, rms, and the rate of the cycles."""
        self.set_pins(contacts)
        shift = self.correct_on_grid(0, missing)
        e, f = self.hierarchy.joined
        latest, self.latest = self.latest, e - f
        squares = np.vecdot(self.latest, self.latest)
        size = math.sqrt(float(np.mean(squares, dtype=float)) / self.latest.shape[1])
        if not math.isfinite(size):
            return size, 1.0
        last, self.weights = self.weights[0], (1.0, 0.0)
        if cycle == 0:
            self.keeping, self.last_shift, self.overshooting = False, 0.0, False
        elif size > _SLOW * before or self.overshooting:
            self.overshooting = self.overshooting or size > _OVERSHOOTING * before
            if not self.keeping:
                self.keeping, self.last_shift = True, 0.0
                for field in self.previous:
                    field.fill(0.0)
            if self.overshooting:
                self.weights = (_relaxed(last, latest, self.latest), 0.0)
            else:
                products = self.backend.products_2(self.equation(), self.moves())
                self.weights = self.stationary(products, shift, missing)
        alpha, beta = self.weights
        self.last_shift = alpha * shift + beta * self.last_shift
        self.shift += self.last_shift
        # Where nothing creeps e = f, and there are no two errors to compare.
        return size, min(max(size / before, 0.1), 0.9) if cycle and before > 0 else _USUAL_RATE

    def set_pins(self, contacts: float) -> None:
        """Set pins on the coarse grids, where many have changed, and factorize the coarsest."""
        moved = abs(contacts - self.pinned) > 0.02 * self.pinned
        if self.factorized and not moved:
            return
        if moved:
            self.pinned = contacts
            self.hierarchy.set_pins(self.correction.e, self.bound, contacts / self.size, self.response)
        self.factorized = True
        grid = self.hierarchy.grids[-1]
        lap, cells, lag = grid.laplacian, grid.areas.ravel(), self.coarse_lags[-1]
        lags = grid.in_order(lag) if lag.ndim else self.mean_lag
        n = cells.size
        matrix = np.zeros((2 * n + 1, 2 * n + 1))
        # Without pins the matrix is singular: regularize by 1e-9.
        matrix[:n, :n] = lap + np.diag(np.maximum(grid.in_order(grid.pins), 1e-9 * cells))
        matrix[:n, n:-1] = np.diag(self.bed * cells)
        matrix[n:-1, :n] = -np.diag(cells)
        matrix[n:-1, n:-1] = self.spread * lap + np.diag(lags * cells)
        if self.wanted is None:
            matrix[-1, -1] = 1.0
        else:
            matrix[n:-1, -1] = -cells
            matrix[-1, n:-1] = cells
        try:
            self.coarsest = np.linalg.inv(matrix)
        except np.linalg.LinAlgError:  # singular by rounding: no cycle converges
            self.coarsest = np.full_like(matrix, np.nan)

    def correct_on_grid(self, level: int, missing: float) -> float:
        """One V-cycle from a grid up; the shift that its correction adds."""
        grid = self.hierarchy.grids[level]
        if grid is self.hierarchy.grids[-1]:
            if self.wanted is None:
                missing = 0.0
            found = self.coarsest @ np.concatenate([*map(grid.in_order, grid.source), [missing]])
            grid.hand_over(found[:-1])
            return float(found[-1])
        coarser = self.hierarchy.grids[level + 1]
        equations = grid.two(self.bed, self.spread, self.coarse_lags[level])
        missing -= self.backend.descend_2(equations, Pair(*coarser.source))
        shift = self.correct_on_grid(level + 1, missing)
        self.backend.ascend_2(equations, Pair(*coarser.joined), shift, Pair(*grid.joined))
        return shift

    def stationary(self, products: Field, shift: float, missing: float) -> tuple[float, float]:
        """Combination of the correction and the previous move; the plain correction if in doubt."""
        rd, rq, dd, dq, qq, sf, sg = products.tolist()
        if self.wanted is not None:
            last = self.last_shift
            rd, rq = rd - self.bed * missing * shift, rq - self.bed * missing * last
            dd, qq = dd + 2.0 * self.bed * shift * sf, qq + 2.0 * self.bed * last * sg
            dq += self.bed * (shift * sg + last * sf)
        if qq < 0 or dd <= 0:
            return 1.0, 0.0
        alpha, beta = lowest(np.array([rd, rq, dd, dq, qq, 0.0, 0.0]), 0.0)
        return (alpha, beta) if 0.1 < alpha < 5.0 else (1.0, 0.0)


def _relaxed(part: float, before: Single, now: Single) -> float:
    """Part of a correction to take, from the one before and the part of it that was taken.

    Taken whole, an error that changed sign and grew m times would do so again: 1 / (1 + m) of it removes it.
    """
    change = before - now
    square = inner(change, change, np)
    part *= inner(before, change, np) / square if square > 0 else 1.0
    return min(max(part, _LEAST), _MOST)
