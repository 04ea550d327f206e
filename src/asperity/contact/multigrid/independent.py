r"""Implicit steps of creep where no springs join neighbors (k0 = 0), on the stretch w = u - u0 alone.

The springs to the bulk are compressed where there is contact, w > 0, and bear nothing elsewhere, where the
surface is as high as creep takes it:

    w + spread L w + drag w = xi - v + shift + gap,          0 <= w  perpendicular to  gap = u - xi >= 0,

shift = 0 under separation control; under load control the shift is unknown and the sum of k1 w is F. It is a
problem like that of `asperity.contact.multigrid.one_field`: w is a surface of stiffness 1 + drag + spread L
that rests on a flat obstacle off contact, where the gap is the force on it. So is the cycle, but for the
shift: after each correction w moves by the multiple of its response to a shift of 1 that the load lacks. One
cycle finds that response, as long as the contacts stay.

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

_USUAL_RATE = 0.2
"""Ratio of successive errors expected before two are known, and the least that is believed."""

_MOST_RATE = 0.9
"""Largest ratio that is believed."""

_FORCE_ERROR = 1e-3
"""Error of the sum of the forces that is allowed even where an error of u0 is."""

_FEW = 0.02
"""Part of the sites at rest that may change before pins are set anew."""

_CROWDED = 4.0
"""Variance of pins, in units of that at random, from which one cycle estimates an error too poorly."""

_SHARE = 0.1
"""What of an error that is allowed is left there: errors of steps count by a tenth, and these do not."""

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
    yielded
        Sum of the response of f to a shift of 1; 0 before that is known.
    crowding
        Variance of the pins, in units of that of as many sites at random; at least 1.
    opened
        Whether a site that was in contact before the correction no longer is.
    """

    def __init__(self, sites: Sites, backend: Processor) -> None:
        self.sites, self.backend, self.size = sites, backend, sites.rows * sites.columns
        self.hierarchy = Hierarchy(sites, 1, backend)
        self.correction, self.source, self.error = self.pair(), self.pair(), self.pair()
        self.bound, self.creep, self._b, self._nothing = (backend.zeros(sites) for _ in range(4))
        self._response, self._scratch, self._mask, self._held = (backend.zeros(sites) for _ in range(4))
        self.shift, self.known_stretch, self.opened, self.crowding = 0.0, 0.0, False, 1.0
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
        self.response, self.pinned, self.yielded = Response(self.bed), -math.inf, 0.0

    def improve(self, allowed_error: float, max_cycles: int) -> tuple[bool, int]:
        """Improve the correction until the error of e - f, rms over the sites, is small enough."""
        backend, (e, f), (least, c) = self.backend, self.correction, self.source
        places = (self.bound, c, self.spread, self.creep)
        self.error.e.fill(0.0)
        backend.begin_1(self.equation(f, least, self._b), e, *places)
        backend.sweep_1(self.equation(f, least, self._b), 2)
        size, lacking = 0.0, 0.0
        for cycle in range(1, max_cycles + 1):
            touching = self.cycle(f, least, self._b, self.error.e)
            if self.wanted is not None:
                self.carry(f, self.wanted)
            backend.sweep_1(self.equation(f, least, self._b), 2)
            found = backend.surface_1(self.equation(f, least, self._b), e, *places)
            before, size = size, math.sqrt(found.squares / self.size)
            if not math.isfinite(size):
                break
            rate = min(max(size / before, _USUAL_RATE), _MOST_RATE) if before else _USUAL_RATE
            if self.wanted is not None:
                lacking = self.wanted - found.stretch
            left = max(rate * size, abs(lacking) / math.sqrt(self.size * max(touching, 1.0)))
            allowed = allowed_error * (_SHARE if self.crowding > _CROWDED else 1.0)
            carried = rate * abs(lacking) <= _FORCE_ERROR * abs(self.known_stretch + found.stretch)
            if left <= max(allowed, _ROUNDING * math.sqrt(found.moves / self.size)) and carried:
                self.opened = found.opened > 0
                return True, cycle
        return False, max_cycles

    def left_of(self, error: Single, spread: float, drag: float) -> float:
        """What an implicit step leaves of an error of u0, rms over the sites, while the contacts stay.

        The error has its rows in order. The equation is that of a step, with e = 0 in contact and f = 0
        elsewhere; a cycle, or two, solve it well enough for an estimate. The spread is that of the step or a
        larger one, which is then the one that is prepared.
        """
        (c, f), creep, shift = self.error, self.creep, self.shift
        if spread > self.spread:
            self.prepare(math.inf, spread, drag)
        mean, self.shift = 0.0, 0.0
        self.linear(f, error, 0.0, c, creep)
        if self.crowding > _CROWDED:
            self.cycle(f, self._mask, self._held, creep)
            self.backend.sweep_1(self.equation(f, self._mask, self._held), 2)
        if self.wanted is not None:
            self.carry(f, 0.0)
        creep.fill(0.0)
        places = (c, self._nothing, c, self.spread, creep)
        found = self.backend.surface_1(self.equation(f, self._mask, self._held), *places)
        if self.wanted is not None:
            mean = self.backend.total(creep, self.sites) / self.size
        self.shift = shift
        return math.sqrt(max(found.squares / self.size - mean * mean, 0.0))

    def respond(self) -> None:
        """Find how f responds to a shift of 1 while the contacts stay, where that is not known."""
        if self.yielded:
            return
        places = (self._scratch, self._scratch)
        self.linear(self._response, np.zeros(self.sites[:2], np.float32), 1.0, *places)
        alone = 1.0 / (self.mean_lag + 4.0 * self.spread)  # something must carry the load
        self.yielded = max(self.backend.total(self._response, self.sites), alone)

    def linear(self, f: Single, error: Single, shift: float, c: Single, move: Single) -> None:
        """Solve for f, by a cycle, for an error of u0 and a shift, while the contacts stay.

        ``c`` and ``move`` are places for the source and a correction.
        """
        equation = (f, self._mask, self._held)
        before, self.shift = self.shift, shift
        touching = (self.correction.f, self.source.e)
        self.backend.begin_error_1(self.equation(*equation), touching, error, c, self.spread)
        self.backend.sweep_1(self.equation(*equation), 2)
        self.cycle(*equation, move)
        self.backend.sweep_1(self.equation(*equation), 2)
        self.shift = before

    def carry(self, f: Single, wanted: float) -> None:
        """Shift until the sum of f is what it is to be."""
        self.respond()
        more = (wanted - self.backend.total(f, self.sites)) / self.yielded
        f += np.float32(more) * self._response
        self.shift += more

    def equation(self, f: Single, least: Single, b: Single) -> One:
        """The equation of f, in units in which the spread is 1, with the shift as it is."""
        bed, diagonal, uniform = map(np.float32, (self.bed, 4.0 + self.bed, -self.shift / self.spread))
        return One(f, least, b, bed, diagonal, uniform, self.sites)

    def cycle(self, f: Single, least: Single, b: Single, move: Single) -> float:
        """Correct f on the coarse grids; the number of contacts before.

        ``move`` is a place for the correction.
        """
        backend, first = self.backend, self.hierarchy.grids[0]
        found = backend.restrict_1(self.equation(f, least, b), first.source[0])
        if abs(found.contacts - self.pinned) > _FEW * self.pinned:
            self.set_pins(f, least, found.contacts)
        self.correct_on_grid(0)
        backend.correct_1(self.equation(f, least, b), first.joined[0], move, 1.0, 0.0)
        return self.size - found.contacts

    def set_pins(self, f: Single, least: Single, resting: float) -> None:
        """Set pins where f rests on its bound, on the coarse grids, and factorize the coarsest."""
        self.pinned, self.yielded = resting, 0.0
        self.crowding = self.hierarchy.set_pins(
            f, least, resting / self.size, self.response, crowds_give=True
        )
        grid = self.hierarchy.grids[-1]
        # A pull on all sites moves all alike, against pins and bed alone. They may be too soft beside the
        # Laplacian for an inverse: this motion is solved on its own.
        alone = grid.in_order(grid.pins) + self.bed * grid.areas.ravel()
        share = alone / alone.sum()
        balanced = np.eye(alone.size) - share[:, np.newaxis]
        stiffness = grid.laplacian + np.diag(alone) + np.outer(share, share)
        self.coarsest = np.linalg.solve(stiffness, balanced) + 1.0 / alone.sum()

    def correct_on_grid(self, level: int) -> None:
        """One V-cycle from a grid up."""
        grid, backend = self.hierarchy.grids[level], self.backend
        if grid is self.hierarchy.grids[-1]:
            grid.hand_over(self.coarsest @ grid.in_order(grid.source[0]))
            return
        coarser, equation = self.hierarchy.grids[level + 1], grid.one(self.bed)
        backend.descend_1(equation, 0.0, coarser.source[0])
        self.correct_on_grid(level + 1)
        backend.ascend_1(equation, coarser.joined[0], 0.0, grid.joined[0])
