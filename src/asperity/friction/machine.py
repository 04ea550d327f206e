"""Least squares of a slider on the spring of a machine: residuals and their derivatives.

The data are friction, mu_0 + drift x_lp + a w + b s; with a measured slip x, the load point x + mu/k, which
is straight between kinks; and with a measured load point, its kinks. mu_0, the drift and those lines are
linear, and projected out of the residuals. The search is over ln a, b, ln D_c, ln k, alpha and the kinks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asperity.base.checks import Floats
from asperity.fits.comparison import independent
from asperity.fits.search import inverse_square
from asperity.friction.laws import StateLaw
from asperity.friction.loading import Drive
from asperity.friction.normal_stress import NormalStress
from asperity.friction.slider import Course, RunsAwayError, Shape, follow

_TINY = 1e-30
"""Imaginary part whose effect on the residuals is their derivative."""

_EDGE = 1e-3
"""Distance from the end of its range below which a parameter is not determined."""

LINEAR = ("b", "alpha")
"""Parameters that are searched themselves, and not their logarithm."""

_ALPHA = (-1.0, 2.0)
"""Range of alpha, which is between 0 and the friction coefficient (Linker and Dieterich)."""

_BESIDE = 2
"""Rows on each side of a kink without a fit of measured slip."""


@dataclass(frozen=True, eq=False)
class Machine:
    """Measurements and parameters of a machine.

    `used` are the rows whose friction is fitted, `measured` the kinks of a measured load point, `noise` the
    standard deviations of friction and slip. `a`, `k` and `alpha` are None if they are searched.
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
    normal: NormalStress
    alpha: float | None

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Parameters to search before the kinks: a, D_c and k in the logarithm."""
        fixed = {"a": self.a, "k": self.k, "alpha": self.alpha}
        return tuple(name for name in Shape._fields if fixed.get(name) is None)

    def shape(self, point: Floats) -> Shape:
        """The parameters at a point of the search."""
        searched = zip(self.names, point, strict=False)
        sizes = {name: value if name in LINEAR else np.exp(value) for name, value in searched}
        return Shape(**{"a": self.a, "k": self.k, "alpha": self.alpha} | sizes)

    def moved(self, point: Floats) -> Drive:
        """The drive with the kinks of a point."""
        return replace(self.drive, kinks=point[len(self.names) :])

    def course(self, point: Floats) -> Course:
        """The slider at a point; `RunsAwayError` in stick-slip."""
        return follow(self.law, self.shape(point), self.moved(point), self.time, self.normal)

    @cached_property
    def columns(self) -> Floats:
        """Factors of mu_0, and of the drift times the whole displacement."""
        place = self.drive.place(self.time)
        return np.column_stack([np.ones(place.size), place / place[-1]])[self.used]

    @cached_property
    def _inverse(self) -> Floats:
        return np.asarray(np.linalg.pinv(self.columns), dtype=np.float64)

    @cached_property
    def pieces(self) -> list[tuple[int, NDArray[np.intp], Floats]]:
        """Segments, their rows of slip, and an orthonormal basis of lines; constant at rest."""
        edges = np.concatenate([[0], np.searchsorted(self.time, self.drive.kinks), [self.time.size]])
        pieces = []
        for n, speed in enumerate(self.drive.velocity):
            rows = np.arange(edges[n] + _BESIDE * (n > 0), edges[n + 1] - _BESIDE)
            if self.slip is not None and rows.size > 2 * _BESIDE:
                times = self.time[rows] - self.time[rows].mean()
                line = np.column_stack([np.ones(rows.size), times])[:, : 1 + (speed > 0)]
                pieces.append((n, rows, np.linalg.qr(line)[0]))
        return pieces

    def compared(self, point: Floats, course: Course) -> tuple[Floats, list[Floats]]:
        """mu_0 and the drift; residuals, over the noise, of friction, of segments of slip, and of kinks."""
        shape = self.shape(point)
        friction = (self.friction - course.elastic(shape))[self.used]
        linear = self._inverse @ friction
        parts = [(self.columns @ linear - friction) / self.noise[0]]
        if self.slip is not None:
            place = self.slip + course.stretch(shape)
            places = [(place[rows], basis) for _, rows, basis in self.pieces]
            parts += [(part - basis @ (basis.T @ part)) / self.noise[1] for part, basis in places]
        kinks = (point[len(self.names) :] - self.drive.kinks) / self.drive.spread
        return linear, [*parts, kinks[self.measured]]

    def residual(self, point: Floats) -> Floats:
        """Model less data, over the noise; NaN in stick-slip."""
        try:
            return np.concatenate(self.compared(point, self.course(point))[1])
        except RunsAwayError:
            sizes = [rows.size for _, rows, _ in self.pieces]
            return np.full(int(self.used.sum()) + sum(sizes) + int(self.measured.sum()), np.nan)

    def slopes(self, point: Floats, many: int) -> Floats:
        """Derivatives of mu_0, drift and residuals, in columns for the first `many` searched numbers."""
        every = point + 1j * _TINY * np.eye(many, point.size)
        return np.column_stack([self._slope(ahead, self.moved(ahead), self.normal) for ahead in every])

    def _slope(self, point: Floats, drive: Drive, normal: NormalStress) -> Floats:
        """Derivatives of mu_0, drift and residuals along the tiny imaginary part of one of these."""
        course = follow(self.law, self.shape(point), drive, self.time, normal)
        linear, parts = self.compared(point, course)
        return np.asarray(np.concatenate([linear, *parts]).imag / _TINY)

    def covariance(self, point: Floats) -> Floats:
        """Covariance of mu_0, drift and named parameters; the first two also follow the searched ones.

        All follow the velocities of the load point and the times at which the normal stress turns, which have
        errors, and are not searched.
        """
        slopes, drive, normal = self.slopes(point, point.size), self.moved(point), self.normal
        drags, searched = slopes[:2], inverse_square(slopes[2:])
        cross = drags @ searched
        linear = self.noise[0] ** 2 * self._inverse @ self._inverse.T + cross @ drags.T
        moves = [np.zeros(len(slopes))]
        for one in np.diag(np.broadcast_to(drive.error, drive.velocity.shape)):
            off = replace(drive, velocity=drive.velocity + 1j * _TINY * one)
            moves += [self._slope(point, off, normal)] if one.any() else []
        for one in np.diag(np.broadcast_to(normal.error, normal.time.shape)):
            turned = replace(normal, time=normal.time + 1j * _TINY * one)
            moves += [self._slope(point, drive, turned)] if one.any() else []
        moved = np.column_stack(moves)
        followed = -searched @ slopes[2:].T @ moved[2:]
        whole = np.concatenate([moved[:2] + drags @ followed, followed])
        count = 2 + len(self.names)
        covariance = np.block([[linear, cross], [cross.T, searched]]) + whole @ whole.T
        return np.asarray(covariance[:count, :count])

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Bounds of the search."""
        drive, place = self.drive, self.drive.place(self.time)
        finest, size = float(np.diff(place)[np.diff(place) > 0].min()), float(np.ptp(self.friction))
        ranges = {
            "a": (math.log(1e-4 * size), math.log(50 * size)),
            "b": (-50 * size, 50 * size),
            "D_c": (math.log(finest / 10), math.log(10 * place[-1])),
            "k": (math.log(size / place[-1] / 10), math.log(100 * size / finest)),
            "alpha": _ALPHA,
        }
        rooms = np.diff(drive.edges(self.time))
        ends = np.array([ranges[name] for name in self.names]).reshape(-1, 2)
        low = np.concatenate([ends[:, 0], drive.kinks - 0.45 * rooms[:-1]])
        return low, np.concatenate([ends[:, 1], drive.kinks + 0.45 * rooms[1:]])

    def at_edge(self, point: Floats) -> frozenset[str]:
        """Names of parameters at the end of their range, which are not determined."""
        ends = np.abs(np.array(self.bounds) - point).min(axis=0)
        return frozenset(name for name, end in zip(self.names, ends, strict=False) if end < _EDGE)

    def judged(self, point: Floats) -> tuple[Machine, float, float]:
        """The machine with the noise at a point; correlation and independent share of the rows of friction.

        Correlation of neighbors increases the noise to that of as many independent values.
        """
        friction, *places, _ = self.compared(point, self.course(point))[1]
        statistics, about = list(self.noise), [(0.0, 1.0), (0.0, 1.0)]
        for kind, part in enumerate((friction, np.concatenate([[], *places]))):
            if part.size > point.size + 2:
                about[kind] = independent(part)
                mean = float(part @ part) / (part.size - point.size - 2) / about[kind][1]
                statistics[kind] *= max(math.sqrt(mean), 1e-6)
        return replace(self, noise=(statistics[0], statistics[1])), *about[0]

    def straightened(self, point: Floats) -> Machine:
        """The machine with velocities of the load point from slip and friction, if it was not measured."""
        if self.measured.any() or self.slip is None:
            return self
        shape, speeds = self.shape(point), self.drive.velocity.copy()
        place = self.slip + self.course(point).stretch(shape)
        for n, rows, _ in self.pieces:
            if speeds[n] > 0:
                speeds[n] = np.polyfit(self.time[rows] - self.time[rows[0]], place[rows], 1)[0]
        return replace(self, drive=replace(self.moved(point), velocity=speeds))
