r"""Implicit steps of creep where no springs join neighbors (k0 = 0), on the stretch w = u - u0 alone.

The springs to the bulk are compressed where there is contact, w > 0, and bear nothing elsewhere, where the
surface is as high as creep takes it:

    w + spread L w + drag w = xi - v + shift + gap,          0 <= w  perpendicular to  gap = u - xi >= 0,

shift = 0 under separation control; under load control the shift is unknown and the sum of k1 w is F. It is a
problem like that of `asperity.contact.multigrid.one_field`: w is a surface of stiffness 1 + drag + spread L
that rests on a flat obstacle off contact, where the gap is the force on it. So is the cycle, but for the
shift, which the coarsest grid finds along with the correction, from what the load lacks.

All this happens to a correction (e, f) of u and w, in single precision.
"""

from __future__ import annotations

import math

import numpy as np

from asperity.contact.multigrid.grids import Hierarchy
from asperity.contact.multigrid.loops import One, Pair, Single, Sites
from asperity.contact.multigrid.pins import Response
from asperity.contact.multigrid.processor import Processor

_LEAST_SPREAD = 1e-20
"""Least spread, in units of 1 + drag: less makes no difference, and 0 has no inverse."""

_USUAL_RATE = 0.05
"""Ratio of successive errors expected before two are known."""

_LEAST_RATE, _MOST_RATE = 0.02, 0.9
"""Range of that ratio when it is measured."""

_USUAL_ANSWER = 0.9
"""What of a lack of load a cycle makes up for that was asked for all of it, before that is known."""

_FORCE_ERROR = 1e-3
"""Error of the sum of the forces that is allowed even where an error of u0 is."""

_FEW = 0.02
"""Part of the sites at rest that may change before pins are set anew."""

_ROUNDING = 20 * float(np.finfo(np.float32).eps)
"""Change below which cycles no longer converge, in units of the largest correction."""


class IndependentSprings:
    """Work space for one lattice, and the correction on it; what `TwoFields` is where k0 > 0.

    Attributes
    ----------
    correction
        e and f.
    source
        Least f, minus w; and c of the equation (1 + drag + spread L) f - e = c + shift.
    bound
        Least e that does not penetrate, a length <= 0: minus the gap u - heights.
    shift
        The unknown shift, a length.
    wanted
        Sum of f with which the load is carried, a length, or None where the separation is prescribed.
    known_stretch
        Sum of w before the correction, a length.
    creep
        e - f of the latest cycle.
    opened
        Whether a site that was in contact before the correction no longer is.
    """

    def __init__(self, sites: Sites, backend: Processor) -> None:
        self.sites, self.backend, self.size = sites, backend, sites.rows * sites.columns
        self.hierarchy = Hierarchy(sites, 1, backend)
        self.correction, self.source, self.error = self.pair(), self.pair(), self.pair()
        self.bound, self.creep, self._b, self._mask, self._nothing = (backend.zeros(sites) for _ in range(5))
        self.shift, self.known_stretch, self.opened = 0.0, 0.0, False
        self.wanted: float | None = None

    def pair(self) -> Pair:
        """Two fields of zeros."""
        return Pair(self.backend.zeros(self.sites), self.backend.zeros(self.sites))

    def prepare(self, bed: float, spread: float, drag: float) -> None:
        """Set the coefficients of the equation; the bed, k1/k0, is infinite."""
        del bed
        self.mean_lag = 1.0 + drag
        self.spread = max(spread, _LEAST_SPREAD * self.mean_lag)
        self.bed = self.mean_lag / self.spread
        self.response, self.pinned, self.answer = Response(self.bed), -math.inf, _USUAL_ANSWER

    def improve(self, allowed_error: float, max_cycles: int) -> tuple[bool, int]:
        """Improve the correction until the error of e - f, rms over the sites, is small enough."""
        backend, (e, f), (least, c) = self.backend, self.correction, self.source
        places = (self.bound, c, self.spread, self.creep)
        backend.begin_1(self.equation(f, least), e, *places)
        backend.sweep_1(self.equation(f, least), 2)
        self.error.e.fill(0.0)
        size, lacking = math.inf, self.lacking(f)
        for cycle in range(1, max_cycles + 1):
            touching, asked = self.cycle(f, least, lacking, self.error.e), lacking
            found = backend.surface_1(self.equation(f, least), e, *places)
            before, size = size, math.sqrt(found.squares / self.size)
            if not math.isfinite(size):
                break
            rate = min(max(size / before, _LEAST_RATE), _MOST_RATE) if 0 < before < math.inf else _USUAL_RATE
            if self.wanted is not None:
                lacking = self.wanted - found.stretch
                if cycle > 1 and asked:  # the first cycle changes the sum by more than was asked for
                    self.answer *= min(max((asked - lacking) / asked, 0.1), 10.0)
            left = max(rate * size, abs(lacking) / math.sqrt(self.size * max(touching, 1.0)))
            carried = rate * abs(lacking) <= _FORCE_ERROR * abs(self.known_stretch + found.stretch)
            if left <= max(allowed_error, _ROUNDING * math.sqrt(found.moves / self.size)) and carried:
                self.opened = found.opened > 0
                return True, cycle
        return False, max_cycles

    def left_of(self, error: Single, spread: float, drag: float) -> float:
        """What an implicit step leaves of an error of u0, rms over the sites, while the contacts stay.

        The error has its rows in order. The equation is that of a step, with e = 0 in contact and f = 0
        elsewhere; one cycle solves it well enough for an estimate.
        """
        backend, (c, f), mask = self.backend, self.error, self._mask
        shift, wanted, self.shift = self.shift, self.wanted, 0.0
        self.wanted = None if wanted is None else 0.0
        self.prepare(math.inf, spread, drag)
        touching = (self.correction.f, self.source.e)
        backend.begin_error(self.equation(f, mask), touching, error, c, self.spread)
        backend.sweep_1(self.equation(f, mask), 2)
        self.creep.fill(0.0)
        self.cycle(f, mask, self.lacking(f), self.creep)
        self.creep.fill(0.0)
        found = backend.surface_1(self.equation(f, mask), c, self._nothing, c, self.spread, self.creep)
        mean = 0.0 if wanted is None else backend.total(self.creep, self.sites) / self.size
        self.shift, self.wanted = shift, wanted
        return math.sqrt(max(found.squares / self.size - mean * mean, 0.0))

    def equation(self, f: Single, least: Single) -> One:
        """The equation of f, in units in which the spread is 1, with the shift as it is."""
        bed, diagonal, uniform = map(np.float32, (self.bed, 4.0 + self.bed, -self.shift / self.spread))
        return One(f, least, self._b, bed, diagonal, uniform, self.sites)

    def lacking(self, f: Single) -> float:
        """What the sum of f lacks."""
        return 0.0 if self.wanted is None else self.wanted - self.backend.total(f, self.sites)

    def cycle(self, f: Single, least: Single, lacking: float, move: Single) -> float:
        """Correct f and the shift on the coarse grids, and smooth; the number of contacts before.

        ``move`` is a place for the correction.
        """
        backend, first = self.backend, self.hierarchy.grids[0]
        found = backend.restrict_1(self.equation(f, least), first.source[0], first.sites)
        if abs(found.contacts - self.pinned) > _FEW * self.pinned:
            self.set_pins(f, least, found.contacts)
        shift = self.correct_on_grid(0, lacking / self.answer)
        backend.correct_1(self.equation(f, least), first.joined[0], move, 1.0, 0.0)
        self.shift += shift * self.spread
        backend.sweep_1(self.equation(f, least), 2)
        return self.size - found.contacts

    def set_pins(self, f: Single, least: Single, resting: float) -> None:
        """Set pins where f rests on its bound, on the coarse grids, and factorize the coarsest."""
        self.pinned = resting
        self.hierarchy.set_pins(f, least, resting / self.size, self.response)
        grid = self.hierarchy.grids[-1]
        cells = grid.areas.ravel()
        n = cells.size
        matrix = np.zeros((n + 1, n + 1))
        matrix[:n, :n] = grid.laplacian + np.diag(grid.in_order(grid.pins) + self.bed * cells)
        if self.wanted is None:
            matrix[-1, -1] = 1.0
        else:
            matrix[:n, -1] = -cells
            matrix[-1, :n] = cells
        self.coarsest = np.linalg.inv(matrix)

    def correct_on_grid(self, level: int, lacking: float) -> float:
        """One V-cycle from a grid up; the shift that its correction adds, in units of the spread."""
        grid, backend = self.hierarchy.grids[level], self.backend
        if grid is self.hierarchy.grids[-1]:
            found = self.coarsest @ np.append(grid.in_order(grid.source[0]), lacking)
            grid.hand_over(found[:-1])
            return float(found[-1])
        coarser, equation = self.hierarchy.grids[level + 1], grid.one(self.bed)
        total = backend.descend_1(equation, 0.0, coarser.source[0])
        lacking -= 0.0 if self.wanted is None else total
        shift = self.correct_on_grid(level + 1, lacking)
        backend.ascend_1(equation, coarser.joined[0], shift, grid.joined[0])
        return shift
