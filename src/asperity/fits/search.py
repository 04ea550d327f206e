"""The least-squares search behind the laws: the data in their own units, many starts, one covariance."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from asperity.errors import ConvergenceError, InputError

Floats = NDArray[np.float64]
# A law takes the logarithms of its parameters (K first) and times above 0, and gives A(t) - A(0) and its
# derivatives in those logarithms, one column each.
Law = Callable[[Floats, Floats], tuple[Floats, Floats]]

# Reach of the search, in units of the data. Data that lead to its edge leave a parameter undetermined.
TIME_REACH = 1e8
SLOPE_RANGE = (1e-12, 1e12)
EXPONENT_RANGE = (1e-8, 1e4)
INITIAL_RANGE = (1e-3, 10.0)
POLISHED_STARTS = 3


@dataclass(frozen=True)
class Curve:
    """The points to fit, in units of the data: times of the first, areas of A(0) or of the first area."""

    time: Floats
    area: Floats
    time_unit: float
    area_unit: float
    initial_known: bool

    @classmethod
    def checked(cls, time: ArrayLike, area: ArrayLike, parameters: int) -> Curve:
        """Check what was given; `parameters` does not count A(0)."""
        t, A = _line_of_numbers("time", time), _line_of_numbers("area", area)
        if t.size != A.size:
            raise InputError("area", expected=f"one for each of the {t.size} times", got=f"{A.size} areas")
        if t.size == 0 or t[0] < 0 or (np.diff(t) <= 0).any():
            raise InputError("time", expected="increasing times, not below 0", got=_sketch(t))
        if (A <= 0).any():
            raise InputError("area", expected="areas above 0", got=float(A.min()))
        known = bool(t[0] == 0)
        fitted, needed = t.size - known, parameters + (not known) + 1
        if fitted < needed:
            raise InputError(
                "time",
                expected=f"at least {needed} times above 0, one more than there are parameters",
                got=fitted,
                advice="a curve that is sampled more densely",
            )
        if A[-1] <= A[0]:
            raise InputError("area", expected="an area that grows with time", got=_sketch(A))
        return cls(t[known:] / t[int(known)], A[known:] / A[0], float(t[int(known)]), float(A[0]), known)

    def time_scales(self) -> Floats:
        """Values of t0 to start from."""
        return np.geomspace(0.1, 10 * self.time[-1], 20)


@dataclass(frozen=True)
class Optimum:
    """Parameters (ln K, ln t0, ..., A(0) where fitted) with their covariance, and how well the law fits."""

    theta: Floats
    covariance: Floats
    C: float
    initial_ratio: float
    initial_area: float
    initial_area_stderr: float
    rms_residual: float
    r_squared: float

    def log_stderr(self, *powers: float) -> float:
        """Relative standard error of the product of powers of C, t0, q."""
        gradient = np.zeros(self.theta.size)
        gradient[: len(powers)] = powers
        if self.initial_area_stderr > 0:  # C = K/A(0)
            gradient[-1] = -powers[0] / self.initial_ratio
        return float(np.sqrt(gradient @ self.covariance @ gradient))


def fit_law(
    law: Law, curve: Curve, shapes: Iterable[Floats], more_ranges: list[tuple[float, float]]
) -> Optimum:
    """Polish the best starting points and keep the best minimum."""
    free = not curve.initial_known
    logs = [SLOPE_RANGE, (1 / TIME_REACH, curve.time[-1] * TIME_REACH), *more_ranges]
    bounds = np.concatenate([np.log(logs), [INITIAL_RANGE] if free else np.empty((0, 2))])
    low, high = bounds.T

    def misfit(theta: Floats) -> Floats:
        return (theta[-1] if free else 1.0) + law(theta, curve.time)[0] - curve.area

    def jacobian(theta: Floats) -> Floats:
        slopes = law(theta, curve.time)[1]
        return np.column_stack([slopes, np.ones_like(curve.time)]) if free else slopes

    candidates = [start for shape in shapes if (start := _with_linear_part(law, shape, curve)) is not None]
    if not candidates:
        raise InputError("area", expected="an area that grows with time", got="no growing law near the data")
    candidates.sort(key=lambda start: float(np.sum(misfit(start) ** 2)))
    best = None
    for start in candidates[:POLISHED_STARTS]:
        margin = 1e-6 * (high - low)  # the search wants to begin inside
        found = least_squares(
            misfit,
            np.clip(start, low + margin, high - margin),
            jac=jacobian,
            bounds=(low, high),
            ftol=1e-15,
            xtol=1e-15,
            gtol=1e-15,
            x_scale="jac",
        )
        if found.success and (best is None or found.cost < best.cost):
            best = found
    if best is None:
        raise ConvergenceError("fit: no starting point led to a minimum; try more points, or the other law")
    return _optimum(np.asarray(best.x), misfit(best.x), jacobian(best.x), curve)


def _with_linear_part(law: Law, shape: Floats, curve: Curve) -> Floats | None:
    """Complete a start with the K, and the A(0), that suit it best; None where they are not above 0."""
    growth, _ = law(shape, curve.time)  # shape has K = 1
    if curve.initial_known:
        K = float(growth @ (curve.area - 1)) / float(growth @ growth)
        return np.concatenate([[np.log(K)], shape[1:]]) if K > 0 else None
    columns = np.column_stack([np.ones_like(growth), growth])
    initial, K = np.linalg.lstsq(columns, curve.area)[0]
    return np.concatenate([[np.log(K)], shape[1:], [initial]]) if K > 0 and initial > 0 else None


def _optimum(theta: Floats, residual: Floats, jacobian: Floats, curve: Curve) -> Optimum:
    squares = float(residual @ residual)
    total = float(np.sum((curve.area - curve.area.mean()) ** 2))
    variance = squares / (residual.size - theta.size)
    # Columns to one length first: a parameter that does little is not one that is undetermined.
    length = np.maximum(np.linalg.norm(jacobian, axis=0), np.finfo(float).tiny ** 0.25)
    _, singular, axes = np.linalg.svd(jacobian / length, full_matrices=False)
    # A combination that the data do not determine gets a huge standard error in place of a division by zero.
    singular = np.maximum(singular, np.finfo(float).eps * singular[0])
    root = axes.T / singular / length[:, None]
    covariance = variance * (root @ root.T)
    initial = 1.0 if curve.initial_known else float(theta[-1])
    spread = 0.0 if curve.initial_known else float(np.sqrt(covariance[-1, -1]))
    return Optimum(
        theta=theta,
        covariance=covariance,
        C=float(np.exp(theta[0])) / initial,
        initial_ratio=initial,
        initial_area=initial * curve.area_unit,
        initial_area_stderr=spread * curve.area_unit,
        rms_residual=float(np.sqrt(np.mean((residual / curve.area) ** 2))),
        # Areas that have grown at once and stay: there is no variation to explain.
        r_squared=1 - squares / total if total > 0 else float("nan"),
    )


def _line_of_numbers(name: str, value: ArrayLike) -> Floats:
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(name, expected="real numbers", got=type(value).__name__) from error
    if array.ndim != 1:
        raise InputError(name, expected="an array of one dimension", got=f"shape {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(
            name, expected="finite numbers", got="NaN or infinity", advice="dropping the relaxed state"
        )
    return array


def checked_times(time: ArrayLike) -> Floats:
    """Times not below 0, of any shape; `InputError` for others."""
    array = np.asarray(time, dtype=np.float64)
    if not (array >= 0).all():
        raise InputError("time", expected="times not below 0", got=_sketch(array.ravel()))
    return array


def _sketch(values: Floats) -> str:
    return f"{values[0]:g} ... {values[-1]:g}" if values.size else "none"
