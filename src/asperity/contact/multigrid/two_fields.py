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
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.contact.arrays import inner, largest
from asperity.contact.multigrid.grids import Hierarchy, empty
from asperity.contact.multigrid.loops import CoarseTwo, Moves, Pair, Single, Sites, Two
from asperity.contact.multigrid.one_field import SINGLE_PRECISION, lowest
from asperity.contact.multigrid.processor import Defects, Processor
from asperity.lattice import Field
from asperity.solids import Springs


@dataclass(frozen=True)
class Tuning:
    """Numbers that decide how many cycles a step takes."""

    slow: float = 0.4
    """Ratio of successive corrections above which they are combined."""
    overshooting: float = 0.8
    """Ratio of successive corrections above which all later ones are taken in part."""
    usual_rate: float = 0.3
    """Ratio of successive errors expected before two are known."""
    moved: float = 0.02
    """Part of the contacts that opens or closes before pins are set anew."""
    force_error: float = 1e-3
    """Error of the sum of the forces that is allowed even where an error of u0 is."""
    stiff: float = 100.0
    """k1/k0 beyond which less error is allowed, of u0 in proportion to k0/k1 and of the sum to its square:
    errors of all steps have one sign and add up."""
    softest: float = 1e-5
    """Least k0/k1 in corrections, which need not be exact: the forces that they are to remove are."""


TUNING = Tuning()

_ROUNDING = 20 * float(np.finfo(np.float32).eps)
"""Change below which cycles no longer converge, in units of the correction: 16 was the most seen."""


def working_stiffness(k0: float, k1: float) -> float:
    """The k0 of corrections, which is above 0."""
    return max(k0, TUNING.softest * k1)


class TwoFields:
    """Work space for one lattice, and the correction (e, f) on it.

    ``source`` is b and c of the equations in `asperity.contact.multigrid.loops`, and ``bound`` the least e
    that does not penetrate: minus the gap u - heights. ``found`` and ``latest`` are corrections of e and f,
    and of e - f, that the coarse grids found last, on the first of them. ``wanted`` is the sum of f with
    which the load is carried, or None where the separation is prescribed, and ``known_stretch`` that of w
    before the correction. So many sites as are ``yielding`` carry a force that is given, off the obstacle.
    """

    def __init__(self, sites: Sites, backend: Processor) -> None:
        self.sites, self.backend, self.size = sites, backend, sites.rows * sites.columns
        self.hierarchy = Hierarchy(sites, 2, backend)
        self.found: Any = self.hierarchy.grids[0].joined
        self.bound = empty(sites, backend)
        self.bound.fill(-np.inf)
        self.correction, self.source, self.previous = (self.pair() for _ in range(3))
        self.shift, self.known_stretch, self.weights = 0.0, 0.0, (1.0, 0.0)
        self.keeping, self.overshooting, self.yielding = False, False, 0
        self.wanted: float | None = None
        self.latest: Single = np.zeros(0, np.float32)
        widths = [sites.columns, *(grid.sites.columns for grid in self.hierarchy.grids)]
        self.rows = [backend.packed(np.zeros((1, width))) for width in widths]

    def pair(self) -> Pair:
        """Two fields of zeros."""
        return Pair(empty(self.sites, self.backend), empty(self.sites, self.backend))

    def prepare(self, bed: float, spread: float, drag: float) -> None:
        """Set the coefficients: bed = k1/k0, and those of the equations."""
        self.bed, self.spread, self.pinned, self.factorized = bed, spread, -math.inf, False
        self.mean_lag, self.even = 1.0 + drag, True
        for row in self.rows:
            row.fill(np.float32(self.mean_lag))
        self.lag, *self.coarse_lags = self.rows
        self.damp()
        self.springs = Springs(1.0, bed, spread, drag)
        self.part = min(1.0, TUNING.stiff / bed)
        self.force_error = max(TUNING.force_error * self.part**2, SINGLE_PRECISION)

    def damp(self) -> None:
        """Find what the sweeps take of the lag."""
        one, four = np.float32(1.0), np.float32(4.0)
        self.diagonal = self.lag + four * np.float32(self.spread)
        self.damping = one / self.diagonal
        self.inverse = one / (four + np.float32(self.bed) * self.damping)

    def improve(self, allowed_error: float, max_cycles: int) -> tuple[bool, int]:
        """Improve the correction until the error of e - f, rms over the sites, is small enough, or rounding.

        A time step starts near its end, and a cycle usually divides the error by four or more; the size of
        a change estimates the error before it, and so the one that is left. A surface that moves as a whole
        leaves e - f alone: where it counts, what the sum of f lacks is to be a small part of the whole, too.
        """
        size, correcting = math.inf, False
        self.keeping, self.last_shift, self.overshooting = False, 0.0, False
        for cycle in range(max_cycles):
            found = self.descend(correcting=correcting)
            correcting = self.wanted is None or not self.yielding or found.contacts > 0
            if not correcting:
                self.sink()
                continue
            missing = 0.0 if self.wanted is None else self.wanted - found.stretch
            far = math.sqrt(found.moves / self.size)
            size, rate = self.find_correction(found.contacts, missing, size)
            if not math.isfinite(size):
                break
            if self.wanted is not None and found.contacts + self.yielding == 0:
                continue  # something must carry the load
            if self.wanted is None and found.contacts > 0:
                missing = self.weights[0] * self.size * float(np.mean(self.found.f, dtype=float))
            good = rate * size <= max(self.part * allowed_error, _ROUNDING * far)
            total = abs(self.known_stretch + found.stretch)
            if good and rate * abs(missing) <= self.force_error * total:
                self.descend(correcting=True, restricting=False)
                return True, cycle + 1
        return False, max_cycles

    def sink(self) -> None:
        """Move the body until one site touches, which is to bear what the yielding sites do not."""
        e, bound = (self.backend.unpacked(field, self.sites) for field in (self.correction.e, self.bound))
        gap = float(np.min(e - bound)) + _ROUNDING * largest(e, np)
        self.correction.e[...] -= np.float32(gap)
        self.shift += gap

    def left_of(self, error: Single) -> tuple[float, float]:
        """Mean and rms of what an implicit step leaves of an error of u0, while the contacts stay.

        The rms is about the mean where the load decides that. The equations are those of the step that was
        solved last. One cycle of the coarse grids finds what is left of what they see of the error; of the
        rest every site leaves what it would alone in contact, for errors are rough beside contacts. Springs
        of k1/k0 = 60 leave up to twice that of an error that is rough everywhere. The error is overwritten.
        """
        grid, backend = self.hierarchy.grids[0], self.backend
        source = grid.source
        backend.restrict(error, self.sites, source.f)
        error *= self.damping
        backend.restrict(error, self.sites, source.e)
        unseen = self.square(error, self.sites) - self.square(source.e / grid.sharing, grid.sites)
        source.e.fill(0.0)
        shift = self.correct_on_grid(0, 0.0)
        left = self.found.f - self.found.e
        mean = float(np.mean(left, dtype=float))
        if self.wanted is not None:
            left -= np.float32(mean)
        return mean - shift, math.sqrt(float(np.mean(left * left, dtype=float)) + max(unseen, 0.0))

    def square(self, field: Single, sites: Sites) -> float:
        """Mean square over sites."""
        return self.backend.total(field * field, sites) / (sites.rows * sites.columns)

    def relag(self) -> None:
        """Bring the lag by site to the coarse grids."""
        self.damp()
        self.coarse_lags = self.hierarchy.coarser_lags(self.lag, self.spread)
        self.factorized = False
        if self.pinned < 0:
            self.mean_lag = float(np.mean(self.hierarchy.grids[-1].in_order(self.coarse_lags[-1])))
            self.springs = Springs(1.0, self.bed, self.spread, self.mean_lag - 1.0)

    def equation(self) -> Two:
        """Fields and coefficients."""
        bed, spread, shift = map(np.float32, (self.bed, self.spread, self.shift))
        creeping = self.diagonal, self.damping, self.inverse
        return Two(*self.correction, self.bound, *self.source, bed, spread, *creeping, shift, self.sites)

    def descend(self, *, correcting: bool, restricting: bool = True) -> Defects:
        """Add what the coarse grids found, find the contacts and smooth, and bring the defects to them."""
        alpha, beta = map(np.float32, self.weights)
        moves = Moves(self.found, self.previous, alpha, beta, self.keeping)
        places = (self.equation(), moves, self.hierarchy.grids[0].source)
        return self.backend.cycle_2(*places, correcting=correcting, restricting=restricting)

    def find_correction(self, contacts: float, missing: float, before: float) -> tuple[float, float]:
        """Ask the coarse grids; the size of their correction of u0, rms, and the rate of the cycles."""
        self.set_pins(contacts)
        shift = self.correct_on_grid(0, missing)
        e, f = self.found
        latest, self.latest = self.latest, e - f
        squares = np.vecdot(self.latest, self.latest)
        size = math.sqrt(float(np.mean(squares, dtype=float)) / self.latest.shape[1])
        if not math.isfinite(size):
            return size, 1.0
        last, self.weights = self.weights[0], (1.0, 0.0)
        if size > TUNING.slow * before or self.overshooting:
            self.overshooting = self.overshooting or size > TUNING.overshooting * before
            if not self.keeping:
                self.keeping, self.last_shift = True, 0.0
                for field in self.previous:
                    field.fill(0.0)
            if self.overshooting:
                self.weights = (_relaxed(last, latest, self.latest), 0.0)
            else:
                products = self.backend.products(self.equation(), self.found, self.previous)
                self.weights = self.stationary(products, shift, missing)
        alpha, beta = self.weights
        self.last_shift = alpha * shift + beta * self.last_shift
        self.shift += self.last_shift
        # Where nothing creeps e = f, and there are no two errors to compare.
        return size, min(max(size / before, 0.1), 0.9) if 0 < before < math.inf else TUNING.usual_rate

    def set_pins(self, contacts: float) -> None:
        """Set pins on the coarse grids, where many have changed, and factorize the coarsest."""
        moved = abs(contacts - self.pinned) > TUNING.moved * self.pinned
        if self.factorized and not moved:
            return
        if moved:
            self.pinned = contacts
            self.hierarchy.set_pins(self.correction.e, self.bound, contacts / self.size, self.springs)
        self.factorized = True
        grid = self.hierarchy.grids[-1]
        lap, cells, lag = grid.laplacian, grid.areas.ravel(), self.coarse_lags[-1]
        lags = self.mean_lag if self.even else grid.in_order(lag)
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
        (e, f), (b, c), lag = grid.correction, grid.source, self.coarse_lags[level]
        equations = CoarseTwo(e, f, b, c, np.float32(self.bed), np.float32(self.spread), lag, *grid.mesh)
        missing -= self.backend.descend(equations, coarser.source)
        shift = self.correct_on_grid(level + 1, missing)
        self.backend.ascend(equations, coarser.joined, shift, grid.joined)
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
    return min(max(part, 0.1), 2.0)
