r"""TR-BDF2 on the lattice of springs, in corrections to the state at the start of each time step.

With e and f the changes of u and of w = u - u0 since then, and m = M C w the flow at the start, the stages
of `asperity.aging.tr_bdf2` are two implicit steps of one duration tau = d h from one state:

    (spread L + 1 + drag) f - e = c + shift,      c = -tau (f0 + m)             to t + 2 d h
                                                  c = -w h (f0 + f1) - tau m    to t + h
    f1 = (e - f) / tau - f0,                      f2 = (e - f - w h (f0 + f1)) / tau

The changes, the rates and the flow take single precision, for what they are added to is twice as precise,
and lengths are in units of the largest; only u and w at the ends of steps are double precision.

Each stage starts from the polynomial in the logarithm of time, in which contacts grow evenly, that passes
through the ends of the last two steps and the stage before; so good a guess that one cycle often does.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.tr_bdf2 import (
    DIAGONAL,
    ERROR_WEIGHTS,
    WEIGHT,
    Attempt,
    Extent,
    Point,
    Step,
    rms,
    take_step,
)
from asperity.contact import kernels
from asperity.contact.active_set import ActiveSet
from asperity.contact.arrays import largest
from asperity.contact.mechanics import SpringMechanics
from asperity.contact.multigrid import Multigrid
from asperity.contact.multigrid.grids import Single, join_all, parted
from asperity.contact.state import Contact
from asperity.contact.system import System
from asperity.lattice import Field

_LARGEST_WEIGHTS = 12.0
"""Largest sum of the magnitudes of the weights of an extrapolation: the factor on errors of the values."""


class SpringSteps:
    """A creeping state on the lattice of springs, solved by multigrid.

    Attributes
    ----------
    u, w
        The state, lengths.
    times
        Those of the state, of the one before and of the one before that, where there were any.
    changes
        The changes of u and w in the last step and in the one before, in units of ``unit``.
    rate, flow
        Rate of u0 at the end of the last step, and M C w, in units of ``unit`` by time.
    mean_u0
        Mean of u0 where the separation is prescribed, a length.
    total_stretch
        Sum of w, a length.
    origin
        Time of the end of the first step.
    """

    def __init__(self, system: System, solver: Multigrid, arrays: Mapping[str, NDArray[Any]]) -> None:
        assert isinstance(system.mechanics, SpringMechanics)
        self.system, self.solver, self.springs = system, solver, system.mechanics.springs
        self.heights = np.ascontiguousarray(system.heights)
        self.work = solver.two_fields(system.heights.shape)
        self.u, self.w, self.rate = arrays["u"], arrays["stretch"], arrays["rate"]
        self.times: list[float] = arrays["times"].tolist()
        self.unit, self.level, self.mean_u0, self.origin = map(float, arrays["scales"])
        self.changes = [(arrays[f"change_{n}_u"], arrays[f"change_{n}_stretch"]) for n in range(2)]
        (self.flow, self.middle), self.error = self.work.pair(), np.empty(self.u.shape, np.float32)
        self.by_fields: Step | None = None
        self.measure()

    @classmethod
    def begin(cls, system: System, solver: Multigrid, start: Contact) -> SpringSteps:
        """At the start of a history."""
        u, stretch = np.maximum(start.u - system.datum, system.heights), start.u - start.anchors
        (rate,), w = system.creep_rate(stretch), stretch[0]
        unit = max(largest(u, np), largest(w, np)) or 1.0
        arrays = {
            "times": np.array([0.0]),
            "scales": np.array([unit, u.mean(), u.mean() - w.mean(), 0.0]),
            "u": u,
            "stretch": w,
            "rate": parted(rate / unit),
        }
        for n in range(2):
            arrays[f"change_{n}_u"], arrays[f"change_{n}_stretch"] = solver.two_fields(u.shape).pair()
        return cls(system, solver, arrays)

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """See `Steps`."""
        arrays = {
            "times": np.array(self.times),
            "scales": np.array([self.unit, self.level, self.mean_u0, self.origin]),
            "u": self.u,
            "stretch": self.w,
            "rate": self.rate,
        }
        for n, change in enumerate(self.changes):
            arrays[f"change_{n}_u"], arrays[f"change_{n}_stretch"] = change
        return arrays

    @property
    def time(self) -> float:
        """Time of the state."""
        return self.times[0]

    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the time step that was tried."""
        if self.by_fields is not None:
            return int(np.count_nonzero(self.by_fields.end.u <= self.heights))
        return int(np.count_nonzero(self.work.correction[0] <= self.work.bound))

    def state(self) -> tuple[Field, Field, float]:
        """See `Steps`; the mean of w is exact: what creep conserves must not drift."""
        mean = self.system.at(self.time).mean_stretch
        if mean is None:
            mean = float(self.u.mean()) - self.mean_u0
        stretch = self.w + (mean - float(self.w.mean()))
        return self.u, stretch[np.newaxis], self.mean_u0

    def extent(self) -> Extent:
        """How large the deformation is."""
        return self._extent

    def speed(self) -> float:
        """Rate of u0, rms over the sites."""
        return self.unit * rms(join_all(self.rate, self.u.shape))

    def attempt(
        self, duration: float, tolerances: tuple[float, float], allowed_errors: tuple[float, float]
    ) -> Attempt:
        """Try a time step; the tolerances are for the Fourier solver, where cycles do not converge."""
        cycles = 0
        self.by_fields = None
        if self.system.control.load_controlled or self.contacts > 0:
            done, cycles, error = self._attempt(duration, allowed_errors)
            if done:
                return Attempt(error, cycles)
        point = Point.of(self.system, self.time, *self.state())
        step = take_step(self.system, ActiveSet(), duration, point, None, tolerances=tolerances)
        self.by_fields = step
        return Attempt(step.error, cycles + step.iterations)

    def _attempt(self, duration: float, allowed_errors: tuple[float, float]) -> tuple[bool, int, float]:
        """Whether both stages were solved, the cycles taken and the error of the step."""
        work, k1 = self.work, self.springs.k1
        tau, weight = DIAGONAL * duration, WEIGHT * duration
        work.prepare(k1 / self.springs.k0, tau * k1 * self.springs.R, tau * k1 * self.springs.R_viscous)
        columns, (_, source) = self.u.shape[1], work.source
        # Logarithms of time, but for times that are short against the first step.
        origin = self.origin or duration
        points = [math.log(time + origin) for time in self.times]
        middle, end = (math.log(self.time + h + origin) for h in (2 * DIAGONAL * duration, duration))

        _, *weights = extrapolation(points, middle)
        guess = (*self.changes[0], *self.changes[1], *_of_changes(weights))
        rates: tuple[Any, ...] = (self.rate, self.flow, np.float32(tau))
        fields: tuple[Any, ...] = (*guess, *rates, work.bound, columns, *work.correction, source, work.sums)
        work.rows(kernels.begin_stage_1, *self.u.shape, *fields)
        done, cycles = self._improve(2 * tau, tau, allowed_errors[0])
        if not done:
            return False, cycles, math.nan

        growth, _, *weights = extrapolation([middle, *points], end)
        guess = (*self.changes[0], *self.changes[1], *_of_changes(weights))
        numbers = (np.float32(growth), np.float32(self.offset), *rates, np.float32(weight))
        fields = (*guess, *numbers, work.bound, columns, *work.correction)
        work.rows(kernels.begin_stage_2, *self.u.shape, *fields, self.middle, source, work.sums)
        done, more = self._improve(duration, tau, allowed_errors[1])
        if not done:
            return False, cycles + more, math.nan

        parts = (np.float32(duration * part) for part in ERROR_WEIGHTS)
        rates = (np.float32(self.offset), self.rate, self.middle, np.float32(tau), np.float32(weight))
        fields = (*work.correction, *rates, *parts, columns, source, self.error)
        work.rows(kernels.finish_step, *self.u.shape, *fields)
        error = self.system.damped_rms(self.error, tau, self.contacts / self.u.size)
        return True, cycles + more, self.unit * error

    def _improve(self, ahead: float, tau: float, allowed_error: float) -> tuple[bool, int]:
        """Solve the stage that ends a time ahead, given the sums of the guess and of its source.

        Returns whether it was solved, and the cycles taken.
        """
        work, sites = self.work, self.u.size
        mean = self.system.at(self.time + ahead).mean_stretch
        work.wanted = None if mean is None else (mean * sites - self.total_stretch) / self.unit
        e, f, source = (work.sums[:, :3].sum(axis=0) / sites).tolist()
        moved = -tau * self.system.drift / self.unit
        work.shift = moved if work.wanted is None else work.lag * f - e - source
        done, cycles = work.improve(allowed_error / self.unit, self.solver.max_cycles)
        # What makes the mean of w exact.
        e, f = (self._mean(field) for field in work.correction)
        wanted = (e + source + moved) / work.lag if work.wanted is None else work.wanted / sites
        self.offset = wanted - f
        return done, cycles

    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""
        self.times = [time, *self.times][:3]
        self.origin = self.origin or time
        (last_u, last_w), before = self.changes
        work, unit = self.work, self.unit
        if self.by_fields is not None:
            end, lattice = self.by_fields.end, self.system.mechanics.lattice
            u, (w,), (rate,) = end.u, lattice.backward(end.stretch), lattice.backward(end.rate(self.system))
            if self.system.control.load_controlled:
                rate -= rate.mean()
            for change, now, then in zip(before, (u, w), (self.u, self.w), strict=True):
                change[...] = parted((now - then) / unit)
            self.changes.reverse()
            self.u, self.w, self.rate = u, w, parted(rate / unit)
            self.mean_u0 = float(u.mean()) - float(w.mean())
            self.measure()
            return
        if self.system.free_mean or self.system.drift:
            e, f = (self._mean(field) for field in work.correction)
            self.mean_u0 += unit * (e - f - self.offset)
        self._advance(unit * self.offset)
        self.changes, work.correction = [work.correction, (last_u, last_w)], before
        self.rate, work.source = work.source[1], (work.source[0], self.rate)

    def _mean(self, field: Single) -> float:
        """Mean of a parted field."""
        self.work.rows(kernels.total, *self.u.shape, field, self.u.shape[1], self.work.sums)
        return float(self.work.sums[:, 0].sum()) / self.u.size

    def measure(self) -> None:
        """Prepare for steps from the state as it is."""
        for field in self.work.correction:
            field.fill(0.0)
        self.work.bound.fill(-np.inf)
        self._advance(0.0)

    def _advance(self, offset: float) -> None:
        """Add the corrections, and an offset to w, and prepare for steps from there."""
        s, work = self.springs, self.work
        numbers = (s.k0, s.k1, s.k1 * s.R, s.k1 * s.R_viscous, self.unit, self.level)
        fields = (work.bound, work.source[0], self.flow, work.sums)
        work.rows.and_edges(
            kernels.advance,
            kernels.advance_edges,
            self.u.shape,
            self.u,
            self.w,
            self.heights,
            *numbers,
            *fields,
            before=(*work.correction, offset),
        )
        sums, sites = work.sums, self.u.size
        stretch, rise, squares_w, squares_u, _, self.contacts = sums[:, :6].sum(axis=0).tolist()
        spread = math.sqrt(max(squares_u / sites - (rise / sites) ** 2, 0.0))
        self._extent = Extent(spread, math.sqrt(squares_w / sites), float(sums[:, 4].max()))
        self.total_stretch, work.known_stretch = stretch, stretch / self.unit


def extrapolation(known: Sequence[float], x: float) -> list[float]:
    """Weights of the values at known points, the latest first, that give the value at x.

    Lagrange's polynomial through the latest points: as many as make no weight too large, at least two.
    """
    for count in range(len(known), 1, -1):
        points = known[:count]
        weights = [math.prod((x - b) / (a - b) for b in points if b != a) for a in points]
        if count == 2 or sum(map(abs, weights)) <= _LARGEST_WEIGHTS:
            return weights + [0.0] * (len(known) - count)
    return [1.0]


def _of_changes(weights: Sequence[float]) -> tuple[np.float32, np.float32]:
    """Weights of the last two changes, from those of where they led from, relative to where they led."""
    last, before = (*weights, 0.0, 0.0)[:2]
    return np.float32(-last - before), np.float32(-before)
