"""The least-squares search of the laws, from many starts, with one covariance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from asperity.base.checks import Floats
from asperity.errors import ConvergenceError, InputError
from asperity.fits.curve import MANY, Curve, Series
from asperity.fits.result import quality, rms

# A law takes the logarithms of its parameters (K first) and times, and returns A(t) - A(0) and its
# derivatives in those logarithms, one column each. If the final area determines K, it is not among them.
Law = Callable[[Floats, Floats], tuple[Floats, Floats]]

# Bounds of the search, in units of the data. If data lead to them, they do not determine a parameter.
TIME_REACH = 1e8
SLOPE_RANGE = (1e-12, 1e12)
EXPONENT_RANGE = (1e-8, 1e4)
INITIAL_RANGE = (1e-3, 10.0)
POLISHED_STARTS = 3

# Relative change of the sum of squares at which a search ends, and its most steps. In the valley of an
# undetermined parameter it would take thousands.
STOP = (1e-15, 100), (1e-8, 1000)


@dataclass(frozen=True, eq=False)
class Misfit:
    """Residuals of a law, over standard errors if these are known, and their derivatives."""

    law: Law
    series: Series
    initial_known: bool

    @property
    def weight(self) -> Floats:
        """Inverse standard errors; 1 if these are not known."""
        return np.ones_like(self.series.y) if self.series.stderr is None else 1 / self.series.stderr

    def residual(self, theta: Floats) -> Floats:
        """Law less data."""
        initial = 1.0 if self.initial_known else theta[-1]
        return np.asarray((initial + self.law(theta, self.series.x)[0] - self.series.y) * self.weight)

    def jacobian(self, theta: Floats) -> Floats:
        """Derivatives of the residuals, one column for each parameter."""
        columns = self.law(theta, self.series.x)[1]
        if not self.initial_known:
            columns = np.column_stack([columns, np.ones_like(self.series.x)])
        return np.asarray(columns * self.weight[:, None])

    def cost(self, theta: Floats) -> float:
        """Sum of squares."""
        return float(np.sum(self.residual(theta) ** 2))

    def completed(self, shape: Floats) -> Floats | None:
        """Complete a start, with K = 1, by the best K and A(0); None unless these are above 0."""
        growth = self.law(shape, self.series.x)[0] * self.weight
        ones, y = self.weight, self.series.y * self.weight
        if self.initial_known:
            K = float(growth @ (y - ones)) / float(growth @ growth)
            return np.concatenate([[np.log(K)], shape[1:]]) if K > 0 else None
        initial, K = np.linalg.lstsq(np.column_stack([ones, growth]), y)[0]
        return np.concatenate([[np.log(K)], shape[1:], [initial]]) if K > 0 and initial > 0 else None

    def polished(self, start: Floats, bounds: Floats) -> Any:
        """The minimum from a start; None if the search fails."""
        low, high = bounds
        margin = 1e-6 * (high - low)  # the search must begin inside
        for change, steps in STOP:
            minimum = least_squares(
                self.residual,
                np.clip(start, low + margin, high - margin),
                jac=self.jacobian,
                bounds=(low, high),
                ftol=change,
                xtol=1e-15,
                gtol=1e-15,
                x_scale="jac",
                max_nfev=steps,
            )
            if minimum.success:
                return minimum
            start = minimum.x
        return None


@dataclass(frozen=True, eq=False)
class Optimum:
    """Parameters (ln K, ln t0, ..., A(0) if fitted) with their covariance, and the quality of the fit."""

    theta: Floats
    covariance: Floats
    curve: Curve
    initial: float
    quality: dict[str, Any]

    @property
    def C(self) -> float:
        """K over A(0)."""
        return float(np.exp(self.theta[0])) / self.initial

    @property
    def initial_stderr(self) -> float:
        """Standard error of A(0), in its unit."""
        return 0.0 if self.curve.initial_known else float(np.sqrt(self.covariance[-1, -1]))

    def log_stderr(self, *powers: float, per_initial: bool = True) -> float:
        """Relative standard error of a product of powers of C (K unless `per_initial`), t0, q."""
        gradient = np.zeros(self.theta.size)
        gradient[: len(powers)] = powers
        if per_initial and not self.curve.initial_known:  # C = K/A(0)
            gradient[-1] = -powers[0] / self.initial
        return math.sqrt(max(0.0, float(gradient @ self.covariance @ gradient)))


def fit_law(
    law: Law,
    curve: Curve,
    shapes: Iterable[Floats],
    more_ranges: list[tuple[float, float]],
    *,
    K_known: bool = False,
) -> Optimum:
    """Polish the best starting points and keep the best minimum."""
    logs = [(1 / TIME_REACH, curve.points.x[-1] * TIME_REACH), *more_ranges]
    if not K_known:
        logs = [SLOPE_RANGE, *logs]
    bounds = np.concatenate([np.log(logs), [INITIAL_RANGE] if not curve.initial_known else np.empty((0, 2))])
    whole = Misfit(law, curve.points, curve.initial_known)
    # A law is smooth: means over bins of many points have the same minimum but for the last digits.
    many = curve.points.x.size > MANY
    rough = Misfit(law, curve.points.binned(), curve.initial_known) if many else whole
    completed = shapes if K_known else map(rough.completed, shapes)
    starts = [start for start in completed if start is not None]
    if not starts:
        raise InputError("area", expected="an area that grows with time", got="no growing law near the data")
    starts.sort(key=rough.cost)
    best = least_of(starts[:POLISHED_STARTS], lambda start: rough.polished(start, bounds.T))
    if best is not None and many:
        best = whole.polished(best.x, bounds.T)
    if best is None:
        raise ConvergenceError("fit: no starting point led to a minimum; try more points, or the other law")
    theta, y, stderr = best.x, curve.points.y, curve.points.stderr
    weighted = whole.residual(theta)
    residual = weighted / whole.weight
    variance = float(weighted @ weighted) / (y.size - theta.size) if stderr is None else 1.0
    return Optimum(
        theta=theta,
        covariance=variance * inverse_square(whole.jacobian(theta)),
        curve=curve,
        initial=1.0 if curve.initial_known else float(theta[-1]),
        quality={"rms_residual": rms(residual / y)} | quality(residual, y, stderr, theta.size),
    )


def least_of(starts: Iterable[Floats], polished: Callable[[Floats], Any]) -> Any:
    """The least of the minima, as scipy gives them, from several starts; None if every search gives None."""
    minima = [minimum for start in starts if (minimum := polished(start)) is not None]
    return min(minima, key=lambda minimum: float(minimum.cost), default=None)


def inverse_square(jacobian: Floats) -> Floats:
    """(J^T J)^-1 of the derivatives of residuals, one column for each parameter."""
    # Columns of one length: a parameter with a small effect is not an undetermined one.
    length = np.maximum(np.linalg.norm(jacobian, axis=0), np.finfo(float).tiny ** 0.25)
    _, singular, axes = np.linalg.svd(jacobian / length, full_matrices=False)
    # An undetermined combination gets a huge standard error in place of a division by zero.
    singular = np.maximum(singular, np.finfo(float).eps * singular[0])
    root = axes.T / singular / length[:, None]
    return np.asarray(root @ root.T)
