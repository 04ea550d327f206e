r"""One implicit step of creep of the lattice of springs, on the pair of u and its stretch w = u - u0.

The stiffness of a finite step is not local, but the pair is:

    k0 L u + k1 w = r,                          0 <= r  perpendicular to  u - xi >= 0
    w + spread L w + drag w = u - v + shift,

shift = 0 under separation control; under load control the shift is unknown and the sum of k1 w is F.
Only u is constrained, and only contacts are invisible to coarse grids: the cycle is that of
`asperity.contact.multigrid.one_field`, both unknowns of a site relaxed together. Crowded contacts can make
corrections too large, so that they hardly fall or grow: the part of each that is taken follows from how the
last part changed it (B. M. Irons, R. C. Tuck, Int. J. Numer. Methods Eng. 1, 275 (1969), DOI
10.1002/nme.1620010306).

All this happens to a correction (e, f) of the pair, in single precision and in units in which k0 = 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asperity.contact.arrays import inner, largest
from asperity.contact.multigrid import one_field, operations
from asperity.contact.multigrid.grids import Corrections, Grid
from asperity.contact.multigrid.loops import CoarseTwo, Single, Sites, Two
from asperity.contact.multigrid.operations import Defects
from asperity.lattice import Field
from asperity.solids import Springs


@dataclass(frozen=True)
class Tuning:
    """Numbers that decide how many cycles a step takes."""

    least_part: float = 0.1
    """Least part of a correction that is taken; the largest is the whole."""
    moved: float = 0.02
    """Part of the contacts that opens or closes before pins are set anew."""
    usual_rate: float = 0.3
    """Ratio of successive errors expected before two are known."""
    best_rate: float = 0.1
    """Least ratio of successive errors that is believed."""
    force_error: float = 1e-3
    """Error of the sum of the forces that is allowed even where an error of u0 is."""
    stiff: float = 100.0
    """k1/k0 beyond which less error is allowed, of u0 in proportion to k0/k1 and of the sum to its square:
    errors of all steps have one sign and add up."""
    rounding: float = 20 * float(np.finfo(np.float32).eps)
    """Change below which cycles no longer converge, in units of the correction: 16 eps was the most seen."""
    softest: float = 1e-5
    """Least k0/k1 in corrections, which need not be exact: the forces that they are to remove are."""


TUNING = Tuning()


def working_stiffness(k0: float, k1: float) -> float:
    """The k0 of corrections, which is above 0."""
    return max(k0, TUNING.softest * k1)


class TwoFields(Corrections):
    """Work space for one lattice, and the correction (e, f) on it.

    ``source`` is b and c of the equations in `asperity.contact.multigrid.loops`, and ``latest`` what the
    coarse grids found last for e - f, on the first of them.
    """

    def __init__(self, sites: Sites) -> None:
        super().__init__(sites, 2)
        self.bound.fill(-np.inf)
        self.latest: Single = np.zeros(0, np.float32)
        widths = [sites.columns, *(grid.sites.columns for grid in self.grids)]
        self.rows = [operations.packed(np.zeros((1, width))) for width in widths]

    def prepare(self, bed: float, spread: float, drag: float) -> None:
        """Set the coefficients: bed = k1/k0, and those of the equations."""
        self.bed, self.spread, self.mean_lag, self.even = bed, spread, 1.0 + drag, True
        for row in self.rows:
            row.fill(np.float32(self.mean_lag))
        self.lag, *self.coarse_lags = self.rows
        self.damp()
        self.moved = TUNING.moved
        self.forget()
        self.springs = Springs(1.0, bed, spread, drag)
        self.part = min(1.0, TUNING.stiff / bed)
        self.force_error = max(TUNING.force_error * self.part**2, one_field.TUNING.single_precision)

    def begin(self, wanted: float | None, stretch: float, shift: float, yielding: int = 0) -> None:
        """Begin with a correction and a shift to be improved.

        ``wanted`` is the sum of f with which the load is carried, or None where the separation is prescribed,
        and ``stretch`` the sum of w before the correction. So many sites as are ``yielding`` carry a force
        that is given, off the obstacle.
        """
        self.wanted, self.known_stretch, self.shift, self.yielding = wanted, stretch, shift, yielding

    def damp(self) -> None:
        """Set the coefficients of the sweeps by the lag."""
        self.diagonal = self.lag + np.float32(4.0 * self.spread)
        self.damping = np.float32(1.0) / self.diagonal
        self.inverse = np.float32(1.0) / (np.float32(4.0) + np.float32(self.bed) * self.damping)

    def improve(self, allowed_error: float, max_cycles: int) -> tuple[bool, int]:
        """Improve the correction until the error of e - f, rms over the sites, is small enough, or rounding.

        A time step starts near its end, and a cycle usually divides the error by four or more; the size of
        a change estimates the error before it, and so the one that is left. A surface that moves as a whole
        leaves e - f alone: where it counts, what the sum of f lacks is to be a small part of the whole, too.
        """
        size, correcting, self.taken = math.inf, False, 1.0
        for cycle in range(max_cycles):
            sums = self.descend(correcting=correcting)
            correcting = self.wanted is None or not self.yielding or sums.contacts > 0
            if not correcting:
                self.sink()
                continue
            missing = 0.0 if self.wanted is None else self.wanted - sums.stretch
            far = math.sqrt(sums.moves / self.size)
            size, rate = self.find_correction(sums.contacts, missing, size)
            if not math.isfinite(size):
                break
            if self.wanted is not None and sums.contacts + self.yielding == 0:
                continue  # something must carry the load
            if self.wanted is None and sums.contacts > 0:
                missing = self.taken * self.size * float(np.mean(self.proposed.f, dtype=float))
            good = rate * size <= max(self.part * allowed_error, TUNING.rounding * far)
            total = abs(self.known_stretch + sums.stretch)
            if good and rate * abs(missing) <= self.force_error * total:
                self.descend(correcting=True, restricting=False)
                return True, cycle + 1
        return False, max_cycles

    def sink(self) -> None:
        """Move the body until one site touches, which is to bear what the yielding sites do not."""
        e, bound = (operations.unpacked(field, self.sites) for field in (self.correction.e, self.bound))
        gap = float(np.min(e - bound)) + TUNING.rounding * largest(e, np)
        self.correction.e[...] -= np.float32(gap)
        self.shift += gap

    def filtered_error(self, error: Single) -> tuple[float, float]:
        """Mean and rms of an error of u0 after an implicit step like the last one, with the same contacts.

        Under a load the rms is about the mean. One cycle of the coarse grids treats the part of the error
        that they resolve. The rest decays at each site as in contact alone, for errors are rough beside
        contacts; of an error that is rough everywhere up to twice as much remains at k1/k0 = 60. The error is
        overwritten.
        """
        grid = self.grids[0]
        source = grid.source
        operations.restrict(error, self.sites, source.f)
        error *= self.damping
        operations.restrict(error, self.sites, source.e)
        unseen = self.square(error, self.sites) - self.square(source.e / grid.sharing, grid.sites)
        source.e.fill(0.0)
        shift = self.cycle_from(0, 0.0)
        remainder = self.proposed.f - self.proposed.e
        mean = float(np.mean(remainder, dtype=float))
        if self.wanted is not None:
            remainder -= np.float32(mean)
        return mean - shift, math.sqrt(float(np.mean(remainder * remainder, dtype=float)) + max(unseen, 0.0))

    def square(self, field: Single, sites: Sites) -> float:
        """Mean square over sites."""
        return operations.total(field * field, sites) / (sites.rows * sites.columns)

    def relag(self, lag: Single) -> None:
        """Set the lag by site, on the coarse grids too."""
        self.lag, self.even = lag, False
        self.damp()
        self.coarse_lags = self.coarser_lags(lag, self.spread)
        self.factorized = False
        if math.isnan(self.pinned):
            self.mean_lag = float(np.mean(self.grids[-1].in_order(self.coarse_lags[-1])))
            self.springs = Springs(1.0, self.bed, self.spread, self.mean_lag - 1.0)

    def equation(self) -> Two:
        """Fields and coefficients."""
        bed, spread, shift = map(np.float32, (self.bed, self.spread, self.shift))
        (e, f), (b, c) = self.correction, self.source
        creeping = self.diagonal, self.damping, self.inverse
        return Two(e, f, self.bound, b, c, bed, spread, *creeping, shift, self.sites)

    def descend(self, *, correcting: bool, restricting: bool = True) -> Defects:
        """Add the corrections of the coarse grids, sweep, and restrict the defects to them."""
        return operations.cycle_2(
            self.equation(),
            self.proposed,
            self.taken,
            self.grids[0].source,
            correcting=correcting,
            restricting=restricting,
        )

    def find_correction(self, contacts: float, missing: float, before: float) -> tuple[float, float]:
        """Let the coarse grids find a correction; return its rms in u0, and the rate of the cycles."""
        shift = self.improve_on_grids(contacts, missing)
        e, f = self.proposed
        latest, self.latest = self.latest, e - f
        squares = np.vecdot(self.latest, self.latest)
        size = math.sqrt(float(np.mean(squares, dtype=float)) / self.latest.shape[1])
        if not math.isfinite(size):
            return size, 1.0
        if before < math.inf:  # taken whole, cycles of k1/k0 = 100 on crowded contacts are five times as many
            self.taken = _relaxed(self.taken, latest, self.latest)
        self.shift += self.taken * shift
        # Where nothing creeps e = f, and there are no two errors to compare.
        return size, max(size / before, TUNING.best_rate) if 0 < before < math.inf else TUNING.usual_rate

    def equations(self, level: int) -> CoarseTwo:
        """See `Corrections`."""
        grid, bed, spread = self.grids[level], np.float32(self.bed), np.float32(self.spread)
        (e, f), (b, c) = grid.correction, grid.source
        return CoarseTwo(e, f, b, c, bed, spread, self.coarse_lags[level], *grid.mesh)

    def inverse_on(self, grid: Grid) -> Field:
        """See `Corrections`."""
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
            inverse = np.asarray(np.linalg.inv(matrix), dtype=float)
        except np.linalg.LinAlgError:  # singular by rounding: no cycle converges
            inverse = np.full_like(matrix, np.nan)
        if self.wanted is None:  # there is no shift, whatever is missing
            inverse[:, -1] = 0.0
        return inverse


def _relaxed(part: float, before: Single, now: Single) -> float:
    """Part of a correction to take, from the one before and the part of it that was taken.

    Taken whole, an error that changed sign and grew m times would do so again: 1 / (1 + m) of it removes it.
    """
    change = before - now
    square = inner(change, change, np)
    part *= inner(before, change, np) / square if square > 0 else 1.0
    return min(max(part, TUNING.least_part), 1.0)
