r"""TR-BDF2 on the lattice of springs, in corrections to the state at the start of each step.

With e and f the changes of u and of w = u - u0 since then, and m = M C w the flow at the start, the stages
of `asperity.aging.tr_bdf2` are two implicit steps of one duration tau = d h from one state:

    (spread L + 1 + drag) f - e = c + shift,      c = -tau (f0 + m)         to t + 2 d h
                                                  c = -w h (f0 + f1) - tau m    to t + h
    f1 = (e - f) / tau - f0,                      f2 = (e - f - w h (f0 + f1)) / tau

The changes, the rates and the flow take single precision, for what they are added to is twice as precise,
and lengths are in units of the largest; only u and w at the ends of steps are double precision.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
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
    ahead,
    rms,
    take_step,
)
from asperity.contact import kernels
from asperity.contact.active_set import ActiveSet
from asperity.contact.controls import Load
from asperity.contact.multigrid import Multigrid
from asperity.contact.multigrid.grids import join_all, parted
from asperity.contact.system import System
from asperity.lattice import Field


class SpringSteps:
    """A creeping state on the lattice of springs, solved by multigrid."""

    def __init__(self, system: System, solver: Multigrid, place: Mapping[str, NDArray[Any]]) -> None:
        assert system.springs is not None
        self.system, self.solver, self.springs = system, solver, system.springs
        self.heights = np.ascontiguousarray(system.heights)
        self.work = solver.two_fields(system.heights.shape)
        self.held = isinstance(system.control, Load)
        self.time, self.earlier = float(place["time"]), float(place["earlier"])
        self.unit, self.level = float(place["unit"]), float(place["level"])
        self.mean_shape = float(place["mean_shape"])
        self.u, self.w = place["u"], place["stretch"]
        self.rate, self.last = place["rate"], (place["last_u"], place["last_stretch"])
        (self.flow, self.middle), self.error = self.work.pair(), np.empty(self.u.shape, np.float32)
        self.by_fields: Step | None = None
        self.measure()

    @classmethod
    def begin(cls, system: System, solver: Multigrid, point: Point) -> SpringSteps:
        """At the start of a history."""
        u, w = np.maximum(point.u, system.heights), point.stretch
        unit = max(float(np.abs(u).max()), float(np.abs(w).max())) or 1.0
        last = solver.two_fields(u.shape).pair()
        place = {
            "time": point.time,
            "earlier": math.nan,
            "unit": unit,
            "level": float(u.mean()),
            "mean_shape": float(u.mean()) - float(w.mean()),
            "u": u,
            "stretch": w,
            "rate": parted(point.rate / unit),
            "last_u": last[0],
            "last_stretch": last[1],
        }
        return cls(system, solver, {name: np.asarray(value) for name, value in place.items()})

    def place(self) -> dict[str, NDArray[Any]]:
        """All that is needed to go on."""
        names = ("time", "earlier", "unit", "level", "mean_shape", "u", "rate")
        place = {name: np.asarray(getattr(self, name)) for name in names}
        return place | {"stretch": self.w, "last_u": self.last[0], "last_stretch": self.last[1]}

    def state(self) -> tuple[Field, Field]:
        """U and w, the mean of w exact: what creep conserves must not drift."""
        mean = self.system.mean_stretch if self.held else float(self.u.mean()) - self.mean_shape
        return self.u, self.w + (mean - float(self.w.mean()))

    def extent(self) -> Extent:
        """How large the deformation is."""
        return self._extent

    def speed(self) -> float:
        """Rate of u0, rms over the sites."""
        return self.unit * rms(join_all(self.rate, self.u.shape))

    def attempt(
        self, duration: float, tolerances: tuple[float, float], allowed_errors: tuple[float, float]
    ) -> Attempt:
        """Try a step of a duration."""
        cycles = 0
        self.by_fields = None
        if self.held or self.contacts > 0:
            done, cycles, error = self._attempt(duration, allowed_errors)
            if done:
                return Attempt(error, cycles)
        point = Point(self.time, *self.state(), self.unit * join_all(self.rate, self.u.shape))
        step = take_step(self.system, ActiveSet(), duration, point, None, tolerances=tolerances)
        self.by_fields = step
        return Attempt(step.error, cycles + step.iterations)

    def _attempt(self, duration: float, allowed_errors: tuple[float, float]) -> tuple[bool, int, float]:
        """Whether both stages were solved, the cycles taken and the error of the step."""
        work, k1 = self.work, self.springs.k1
        tau, weight = DIAGONAL * duration, WEIGHT * duration
        work.prepare(k1 / self.springs.k0, tau * k1 * self.springs.R, tau * k1 * self.springs.R_viscous)
        work.wanted = None if not self.held else self.missing
        columns, source = self.u.shape[1], work.source[1]
        middle = self.time + 2 * DIAGONAL * duration
        factor = 0.0 if math.isnan(self.earlier) else ahead(self.earlier, self.time, middle)

        numbers = (np.float32(factor), self.rate, self.flow, np.float32(tau))
        fields: tuple[Any, ...] = (*numbers, work.gap, columns, *work.correction, source, work.sums)
        work.rows(kernels.begin_stage_1, *self.u.shape, *self.last, *fields)
        mean_source = self._balance_means()
        done, cycles = work.improve(allowed_errors[0] / self.unit, self.solver.max_cycles)
        if not done:
            return False, cycles, math.nan

        self._keep_mean(mean_source)
        growth = 1.0 + ahead(self.time, middle, self.time + duration)
        rates = (self.rate, self.flow, np.float32(tau), np.float32(weight))
        fields = (
            np.float32(self.offset),
            np.float32(growth),
            *rates,
            work.gap,
            columns,
            *work.correction,
            self.middle,
            source,
            work.sums,
        )
        work.rows(kernels.begin_stage_2, *self.u.shape, *fields)
        mean_source = self._balance_means()
        done, more = work.improve(allowed_errors[1] / self.unit, self.solver.max_cycles)
        if not done:
            return False, cycles + more, math.nan

        self._keep_mean(mean_source)
        weights = (np.float32(duration * factor) for factor in ERROR_WEIGHTS)
        numbers = (
            np.float32(self.offset),
            self.rate,
            self.middle,
            np.float32(tau),
            np.float32(weight),
            *weights,
            columns,
        )
        work.rows(kernels.finish_step, *self.u.shape, *work.correction, *numbers, source, self.error)
        return True, cycles + more, self.unit * self.system.damped_rms(self.error, tau)

    def _balance_means(self) -> float:
        """Set the shift under which the means of the first guess are right; the mean of the source."""
        work = self.work
        e, f, c = (work.sums[:, :3].sum(axis=0) / self.u.size).tolist()
        work.shift = work.lag * f - e - c if self.held else 0.0
        return float(c)

    def _keep_mean(self, mean_source: float) -> None:
        """Find what makes the mean of w exact: what creep conserves must not drift."""
        e, f = (self._mean(field) for field in self.work.correction)
        wanted = self.missing / self.u.size if self.held else (e + mean_source) / self.work.lag
        self.offset = wanted - f

    def accept(self, time: float) -> None:
        """Make the end of the step that was tried the state at a time."""
        self.earlier, self.time = self.time, time
        if self.by_fields is not None:
            end, unit = self.by_fields.end, self.unit
            for last, now, then in zip(self.last, (end.u, end.stretch), (self.u, self.w), strict=True):
                last[...] = parted((now - then) / unit)
                for row in last:
                    kernels.wrap(row, self.u.shape[1])
            self.u, self.w, self.rate = end.u, end.stretch, parted(end.rate / unit)
            self.mean_shape = float(end.u.mean()) - float(end.stretch.mean())
            self.by_fields = None
            self.measure()
            return
        work = self.work
        if self.springs.R_viscous > 0 and not self.held:
            change_u, change_w = (self._mean(field) for field in work.correction)
            self.mean_shape += self.unit * (change_u - change_w - self.offset)
        self._advance(self.unit * self.offset)
        self.last, work.correction = work.correction, self.last
        self.rate, work.source = work.source[1], (work.source[0], self.rate)

    def _mean(self, field: NDArray[np.float32]) -> float:
        """Mean of a parted field."""
        self.work.rows(kernels.total, *self.u.shape, field, self.u.shape[1], self.work.sums)
        return float(self.work.sums[:, 0].sum()) / self.u.size

    def measure(self) -> None:
        """Prepare for steps from the state as it is."""
        for field in self.work.correction:
            field.fill(0.0)
        self.work.gap.fill(-np.inf)
        self._advance(0.0)

    def _advance(self, offset: float) -> None:
        """Add the corrections, and an offset to w, and prepare for steps from there."""
        s, work = self.springs, self.work
        numbers = (s.k0, s.k1, s.k1 * s.R, s.k1 * s.R_viscous, self.unit, self.level)
        fields = (work.gap, work.source[0], self.flow, work.sums)
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
        work.known_stretch = stretch / self.unit
        self.missing = (self.system.mean_stretch * sites - stretch) / self.unit
