"""Least squares of a slider on the spring of a machine: residuals and their derivatives.

Measured are friction, mu_0 + drift x_lp + a w + b s; where there is slip x, the load point x + mu/k, which
is straight between kinks; and where there is a load point, its kinks. mu_0, the drift and those lines are
linear, and projected out of the residuals: what is searched is ln a, b, ln D_c, ln k and the kinks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asperity.base.checks import Floats
from asperity.fits.comparison import neighbors
from asperity.friction.laws import StateLaw
from asperity.friction.loading import Drive
from asperity.friction.slider import Course, RunsAwayError, Shape, follow

_DIFFERENCE = 1e-4
"""Step of differences, in the logarithms; that of a kink is short of a sample by far."""

_BESIDE = 2
"""Rows on each side of a kink at which measured slip is not fitted."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Something for each row of friction, for each of the load point behind the slip, and for each kink."""

    friction: Floats
    place: Floats | None
    kinks: Floats


@dataclass(frozen=True, eq=False)
class Machine:
    """What is measured and searched.

    `used` are the rows whose friction counts, `measured` the kinks that a load point was measured at, `noise`
    the standard deviations of friction and slip. `a` and `k` are None where they are searched.
    """

    law: StateLaw
    time: Floats
    friction: Floats
    slip: Floats | None
    drive: Drive
    used: NDArray[np.bool_]
    measured: NDArray[np.bool_]
    a: float | None
    k: float | None
    noise: tuple[float, float]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """What is searched before the kinks: a, D_c and k in the logarithm."""
        fixed = {"a": self.a, "k": self.k}
        return tuple(name for name in Shape._fields if fixed.get(name) is None)

    def shape(self, point: Floats) -> Shape:
        """The numbers at a point of the search."""
        found = {
            name: float(value) if name == "b" else math.exp(value)
            for name, value in zip(self.names, point, strict=False)
        }
        return Shape(**{"a": self.a, "k": self.k} | found)  # type: ignore[arg-type]

    def moved(self, point: Floats) -> Drive:
        """The drive with the kinks of a point."""
        return replace(self.drive, kinks=point[len(self.names) :])

    def course(self, point: Floats) -> Course:
        """The slider at a point; `RunsAwayError` in stick-slip."""
        return follow(self.law, self.shape(point), self.moved(point), self.time)

    @cached_property
    def columns(self) -> Floats:
        """Factors of mu_0 and of the drift over the whole displacement."""
        place = self.drive.place(self.time)
        return np.column_stack([np.ones(place.size), place / place[-1]])[self.used]

    @cached_property
    def _basis(self) -> Floats:
        return np.linalg.qr(self.columns)[0]

    @cached_property
    def pieces(self) -> list[tuple[int, NDArray[np.intp], Floats]]:
        """Segments, their rows of slip, and an orthonormal basis of lines; constant at rest."""
        edges = np.concatenate([[0], np.searchsorted(self.time, self.drive.kinks), [self.time.size]])
        found = []
        for n, speed in enumerate(self.drive.velocity):
            rows = np.arange(edges[n] + _BESIDE * (n > 0), edges[n + 1] - _BESIDE)
            if self.slip is not None and rows.size > 2 * _BESIDE:
                times = self.time[rows] - self.time[rows].mean()
                line = np.column_stack([np.ones(rows.size), times])[:, : 1 + (speed > 0)]
                found.append((n, rows, np.linalg.qr(line)[0]))
        return found

    def weighted(self, rows: Rows) -> list[Floats]:
        """Rows over their noises, without what is linear: of friction, of each segment of slip, of kinks."""
        parts = [(rows.friction[self.used] / self.noise[0], self._basis)]
        if rows.place is not None:
            parts += [(rows.place[at] / self.noise[1], basis) for _, at, basis in self.pieces]
        left = [values - basis @ (basis.T @ values) for values, basis in parts]
        return [*left, (rows.kinks / self.drive.spread)[self.measured]]

    def residual(self, point: Floats) -> Floats:
        """Model less what was measured; NaN in stick-slip."""
        try:
            return np.concatenate(self.parts(point))
        except RunsAwayError:
            sizes = [at.size for _, at, _ in self.pieces]
            return np.full(int(self.used.sum()) + sum(sizes) + int(self.measured.sum()), np.nan)

    def parts(self, point: Floats) -> list[Floats]:
        """The residuals of each kind."""
        model = self.course(point).elastic(self.shape(point))
        place = None if self.slip is None else self.slip + model / self.shape(point).k
        kinks = point[len(self.names) :] - self.drive.kinks
        return self.weighted(Rows(model - self.friction, place, kinks))

    def jacobian(self, point: Floats, many: int) -> Floats:
        """Derivatives of the residuals, one column for each of the first numbers searched."""
        return np.column_stack([np.concatenate(self.weighted(rows)) for rows in self.slopes(point, many)])

    def slopes(self, point: Floats, many: int) -> list[Rows]:
        """Derivatives of all rows, one for each of the first numbers searched."""
        shape, base, count = self.shape(point), self.course(point), len(self.names)
        model, found = base.elastic(shape), []
        for n in range(many):
            step = self._step(n, shape)
            try:
                ahead, course = self._beside(point, n, step, base)
            except RunsAwayError:  # on one side of what is stable
                ahead, course = self._beside(point, n, -step, base)
            slope = (course.elastic(self.shape(ahead)) - model) / (ahead[n] - point[n])
            place = None
            if self.slip is not None:
                place = (slope - (model if (*self.names, "")[min(n, count)] == "k" else 0.0)) / shape.k
            found.append(Rows(slope, place, (np.arange(point.size) == n)[count:] * 1.0))
        return found

    def _beside(self, point: Floats, n: int, step: float, base: Course) -> tuple[Floats, Course]:
        """A point that differs in one number, and its course."""
        ahead, kink = point.copy(), n - len(self.names)
        ahead[n] += step
        if kink < 0:
            return ahead, self.course(ahead)
        return ahead, follow(self.law, self.shape(point), self.moved(ahead), self.time, base, kink)

    def _step(self, n: int, shape: Shape) -> float:
        if n < len(self.names):
            return _DIFFERENCE * (max(shape.a, abs(shape.b)) if self.names[n] == "b" else 1.0)
        at = n - len(self.names)
        change = abs(float(self.drive.velocity[at + 1] - self.drive.velocity[at]))
        return min(10 * _DIFFERENCE * shape.D_c / change, 0.05 * float(self.drive.spread[at]))

    # -- Noise -----------------------------------------------------------------------------------------------

    def judged(self, point: Floats) -> tuple[Machine, float, float]:
        """The machine with the noise that a point leaves; correlation and worth of the rows of friction.

        Where neighbors correlate, the noise is that of independent values that say as little.
        """
        friction, *places, _ = self.parts(point)
        found, about = list(self.noise), [(0.0, 1.0), (0.0, 1.0)]
        for kind, part in enumerate((friction, np.concatenate([[], *places]))):
            if part.size > point.size + 2:
                rho, worth = neighbors(part)
                about[kind] = rho, worth if rho > 2 / math.sqrt(part.size) else 1.0
                mean = float(part @ part) / (part.size - point.size - 2) / about[kind][1]
                found[kind] *= max(math.sqrt(mean), 1e-6)
        return replace(self, noise=(found[0], found[1])), *about[0]

    def straightened(self, point: Floats) -> Machine:
        """The machine with the velocities of a load point that is known by slip and friction alone."""
        if self.measured.any() or self.slip is None:
            return self
        shape, speeds = self.shape(point), self.drive.velocity.copy()
        place = self.slip + self.course(point).elastic(shape) / shape.k
        for n, rows, _ in self.pieces:
            if speeds[n] > 0:
                speeds[n] = np.polyfit(self.time[rows] - self.time[rows[0]], place[rows], 1)[0]
        return replace(self, drive=replace(self.moved(point), velocity=speeds))
