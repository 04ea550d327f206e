r"""Steps of two implicit stages on the lattice of springs, in corrections to the state where the step starts.

With e and f the changes of u and of w = u - u0 since then, and m = M C w the flow at the start, the stages
of `asperity.aging.tr_bdf2` are two implicit steps of one duration tau = d h from one state:

    (spread L + 1 + drag) f - e = c + shift,      c = -tau (f0 + m)             to t + 2 d h
                                                  c = -w h (f0 + f1) - tau m    to t + h
    f1 = (e - f) / tau - f0,                      f2 = (e - f - w h (f0 + f1)) / tau

The changes, the rates and the flow take single precision, for what they are added to is twice as precise,
and lengths are in units of the largest; only u and w at the ends of steps are double precision.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.contact.arrays import largest
from asperity.contact.multigrid.loops import Measured, Pair, Past, Scales, Single, Springs, Surface
from asperity.contact.multigrid.processor import Found
from asperity.contact.multigrid.two_fields import TUNING, TwoFields
from asperity.lattice import Field
from asperity.solids import SpringConstants


class StageSolver:
    """A state, and the two stages of a step from it.

    A step is `begin`, `improve`, `begin_second`, `improve`, `finish`; then `advance`, or another try.

    Attributes
    ----------
    u, w
        The state, lengths.
    changes
        The changes of u and w in the last step and in the one before, in units of ``unit``.
    rate, flow
        Rate of u0 at the end of the last step, and M C w, in units of ``unit`` by time.
    moments
        Sums over the state; rises are above ``level``.
    """

    def __init__(
        self,
        work: TwoFields,
        springs: SpringConstants,
        heights: Field,
        arrays: Mapping[str, NDArray[Any]],
    ) -> None:
        self.work, self.backend, self.sites = work, work.backend, work.sites
        self.springs, self.heights = springs, np.ascontiguousarray(heights)
        self.k0 = max(springs.k0, TUNING.softest * springs.k1)
        self.u, self.w, self.rate = arrays["u"], arrays["stretch"], arrays["rate"]
        self.unit, self.level = map(float, arrays["scales"][:2])
        self.changes = [Pair(arrays[f"change_{n}_u"], arrays[f"change_{n}_stretch"]) for n in range(2)]
        (self.flow, self.middle), self.error = work.pair(), np.empty(self.u.shape, np.float32)
        self.measure()

    @staticmethod
    def arrays(work: TwoFields, u: Field, w: Field, rate: Field) -> dict[str, NDArray[Any]]:
        """What a solver is made of, at the start of a history."""
        unit = max(largest(u, np), largest(w, np)) or 1.0
        arrays: dict[str, NDArray[Any]] = {"u": u, "stretch": w, "rate": work.backend.packed(rate / unit)}
        for n in range(2):
            arrays[f"change_{n}_u"], arrays[f"change_{n}_stretch"] = work.pair()
        return {**arrays, "scales": np.array([unit, u.mean()])}

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """What the solver is made of again."""
        arrays: dict[str, NDArray[Any]] = {"u": self.u, "stretch": self.w, "rate": self.rate}
        for n, change in enumerate(self.changes):
            arrays[f"change_{n}_u"], arrays[f"change_{n}_stretch"] = change
        return {**arrays, "scales": np.array([self.unit, self.level])}

    @property
    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the step that was tried."""
        return int(np.count_nonzero(self.work.correction.e <= self.work.bound))

    @property
    def rate_of_u0(self) -> Field:
        """Rate at the end of the last step, length by time, rows in order."""
        return self.unit * self.backend.unpacked(self.rate, self.sites)

    def begin(self, tau: float, weight: float, weights: Sequence[float]) -> None:
        """Set the duration of both stages and the weight of rates; guess the first by those of changes."""
        s = self.springs
        self.tau, self.weight = tau, weight
        self.work.prepare(s.k1 / self.k0, tau * s.k1 * s.R, tau * s.k1 * s.R_viscous)
        self._guess((0.0, 0.0, tau, 0.0), weights)

    def begin_second(self, growth: float, weights: Sequence[float]) -> None:
        """Guess the second stage, also by the growth of the first."""
        self._guess((growth, self.offset, self.weight, self.weight), weights)

    def _guess(self, numbers: Sequence[float], weights: Sequence[float]) -> None:
        places = (self.middle, self.work.bound, self.work.correction, self.work.source.f, self.sites)
        self.sums = self.backend.guess(self._past(weights), numbers, *places)

    def improve(
        self, mean_stretch: float | None, drift: float, allowed_error: float, max_cycles: int
    ) -> tuple[bool, int]:
        """Solve a stage; whether that was possible, and the cycles taken.

        The mean of w at its end is given, or None where the separation is prescribed, and how fast u0 is
        carried along.
        """
        work, count = self.work, self.u.size
        work.wanted = None
        if mean_stretch is not None:
            work.wanted = (mean_stretch * count - self.moments.stretch) / self.unit
        lag = work.mean_lag
        e, f, source = (value / count for value in self.sums)
        moved = -self.tau * drift / self.unit
        work.shift = moved if work.wanted is None else lag * f - e - source
        done, cycles = work.improve(allowed_error / self.unit, max_cycles)
        if not done:  # it may be no number, and the next guess takes nothing of it times 0
            for field in work.correction:
                field.fill(0.0)
        # What makes the mean of w exact.
        e, f = (self._mean(field) for field in work.correction)
        self.offset = ((e + source + moved) / lag if work.wanted is None else work.wanted / count) - f
        return done, cycles

    def finish(self, shares: Sequence[float]) -> Single:
        """The error of the step in units of ``unit``, the sum of its three rates with weights."""
        rates = (self.rate, self.middle, self.work.source.f)
        numbers = (self.offset, self.tau, self.weight, *shares)
        self.backend.finish(self.work.correction, rates, numbers, self.error)
        return self.error

    def left_of(self, error: Single, tau: float) -> float:
        """What an implicit step leaves of an error of a step, a length, rms over the sites.

        The contacts stay as they are.
        """
        s = self.springs
        return self.unit * self.work.left_of(error, tau * s.k1 * s.R, tau * s.k1 * s.R_viscous)

    def advance(self) -> None:
        """Make the end of the step the state."""
        self._advance(self.unit * self.offset)
        work, (last, before) = self.work, self.changes
        self.changes, work.correction = [work.correction, last], before
        self.rate, work.source = work.source.f, Pair(work.source.e, self.rate)

    def mean_change_of_u0(self) -> float:
        """How far the step that was tried moved the mean of u0."""
        e, f = (self._mean(field) for field in self.work.correction)
        return self.unit * (e - f - self.offset)

    def measure(self) -> None:
        """Prepare for steps from the state as it is."""
        for field in self.work.correction:
            field.fill(0.0)
        self.work.bound.fill(-np.inf)
        self._advance(0.0)

    def spread(self) -> tuple[float, float, float]:
        """Standard deviation of u, rms of w and the largest u."""
        m, count = self.moments, self.u.size
        spread = math.sqrt(max(m.squares_u / count - (m.rise / count) ** 2, 0.0))
        return spread, math.sqrt(m.squares_w / count), m.largest

    def _past(self, weights: Sequence[float]) -> Past:
        """Weights of the last two changes from those of where they led from, relative to where they led."""
        (last, before), (a, b) = self.changes, (*weights, 0.0, 0.0)[:2]
        ahead, back, tau = map(np.float32, (-a - b, -b, self.tau))
        return Past(last, before, ahead, back, self.rate, self.flow, tau)

    def _mean(self, field: Single) -> float:
        return self.backend.total(field, self.sites) / self.u.size

    def _advance(self, offset: float) -> None:
        """Add the corrections, and an offset to w, and prepare for steps from there."""
        s, work = self.springs, self.work
        springs = Springs(s.k0, s.k1, s.k1 * s.R, s.k1 * s.R_viscous)
        surface, into = Surface(self.u, self.w, self.heights), Measured(work.bound, work.source.e, self.flow)
        scales = Scales(self.k0 * self.unit, self.unit, self.level)
        self.backend.settle(surface, work.correction, work.bound, self.unit, offset)
        self.moments: Found = self.backend.measure(
            surface, springs, 0.0, scales, into, self.sites, flowing=True
        )
        work.known_stretch = self.moments.stretch / self.unit
