r"""Laws of the growth of the contact area, fitted with uncertainties.

    saturation   A(t)/A(0) = a - (a - 1) / (1 + t/t0)^q          paper, Eq. (a)
    logarithm    A(t)/A(0) = 1 + C ln(1 + t/t0)                  paper, Eq. (log)

Source: E. A. Jagla, *Towards a modeling of the time dependence of contact area between solid bodies*.
The second is the first for q -> 0 at fixed C = (a - 1) q, and there a and q alone mean nothing any more. So
the first is fitted as

    A(t) = A(0) + K [1 - (1 + t/t0)^(-q)] / q,

in ln K, ln t0, ln q, which is regular there; C = K/A(0) and a = 1 + C/q come after, by the delta method. A(0)
is fitted as it is, not as a logarithm: where no time lies below t0 it can be traded against t0, and along
dA(0) = K d ln t0 that valley is straight. The q of these laws is an exponent of time; the paper has the same
letter for a wave vector and for an exponent of the area.

What to hold C against: the dilute theory of exponential heights has the late slope dA/A(0)/d ln t =
k_eff/(8 pi k0), k_eff/k0 being `asperity.theory.site_stiffness`. The paper's Eq. (ndet2) puts k1 for k_eff.

Least squares of the residuals of the area, all of one weight; covariance (J^T J)^-1 times the variance of the
residuals. The errors of A(t) along one run are correlated: the standard errors tell how well this curve pins
the law, not how the law scatters from surface to surface.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares
from scipy.special import gammainc

from asperity.errors import ConvergenceError, InputError

Floats = NDArray[np.float64]
# A law takes the logarithms of its parameters (K first) and times above 0, and gives A(t) - A(0) and its
# derivatives in those logarithms, one column each.
_Law = Callable[[Floats, Floats], tuple[Floats, Floats]]

# Reach of the search, in units of the data. Data that lead to its edge leave a parameter undetermined.
_TIME_REACH = 1e8
_SLOPE_RANGE = (1e-12, 1e12)
_EXPONENT_RANGE = (1e-8, 1e4)
_INITIAL_RANGE = (1e-3, 10.0)
_POLISHED_STARTS = 3


@dataclass(frozen=True, kw_only=True)
class _GrowthFit:
    """What the two laws share; see `LogarithmFit` for the meaning of each field."""

    C: float
    C_stderr: float
    t0: float
    t0_stderr: float
    initial_area: float
    initial_area_stderr: float
    rms_residual: float
    r_squared: float

    def area_ratio(self, time: ArrayLike) -> Floats:
        """A(t)/A(0) at times not below 0; any shape."""
        raise NotImplementedError

    def predict(self, time: ArrayLike) -> Floats:
        """A(t) at times not below 0, in the unit of the areas given; any shape."""
        return np.asarray(self.initial_area * self.area_ratio(time))[()]

    def __call__(self, time: ArrayLike) -> Floats:
        """Return `predict(time)`."""
        return self.predict(time)


@dataclass(frozen=True, kw_only=True)
class LogarithmFit(_GrowthFit):
    """Eq. (log) with fitted parameters: A(t)/A(0) = 1 + C ln(1 + t/t0).

    Attributes
    ----------
    C, t0
        Slope in ln t, and time scale (unit of the times given).
    C_stderr, t0_stderr
        Standard errors, linear. Where no time lies below t0 and A(0) was not given, only A(0) C and one
        combination of A(0) and t0 are determined: the standard errors are huge then.
    initial_area, initial_area_stderr
        A(0), and its standard error; that is 0 where the times began with 0, for A(0) was given then.
    rms_residual
        Root mean square of the relative residuals 1 - fit/area over the fitted points.
    r_squared
        1 - (sum of squared residuals) / (sum of squares about the mean).
    """

    def area_ratio(self, time: ArrayLike) -> Floats:
        """A(t)/A(0) at times not below 0; any shape."""
        return np.asarray(1 + self.C * np.log1p(_times(time) / self.t0))[()]


@dataclass(frozen=True, kw_only=True)
class SaturationFit(_GrowthFit):
    """Eq. (a) with fitted parameters: A(t)/A(0) = a - (a - 1)/(1 + t/t0)^q.

    Attributes
    ----------
    a, q, t0
        Final area ratio, exponent, and time scale (unit of the times given).
    C
        (a - 1) q, the slope in ln t of the logarithm that the law follows until t is about t0 exp(1/q).
    a_stderr, q_stderr, t0_stderr, C_stderr
        Standard errors, linear. Where q_stderr is not small beside q the data are those of the logarithm:
        trust C, and neither a nor q. At the least q searched, 1e-8, a_stderr is infinite.
    initial_area, initial_area_stderr, rms_residual, r_squared
        As for `LogarithmFit`.
    """

    a: float
    a_stderr: float
    q: float
    q_stderr: float

    def area_ratio(self, time: ArrayLike) -> Floats:
        """A(t)/A(0) at times not below 0; any shape."""
        growth = self.C / self.q * -np.expm1(-self.q * np.log1p(_times(time) / self.t0))
        return np.asarray(1 + growth)[()]


def saturation(time: ArrayLike, area: ArrayLike) -> SaturationFit:
    """Fit Eq. (a), a power law toward a final area, to a curve A(t).

    Parameters
    ----------
    time
        Times since the contact was made, shape (n,), increasing, not below 0. If the first is 0, the first
        area is A(0) and takes no part in the fit; else A(0) is a parameter, between 1e-3 and 10 first areas.
    area
        Areas, shape (n,), above 0, in any unit: fraction, sites or square meters. An xarray DataArray serves
        for both.

    Returns
    -------
    SaturationFit
        Law and parameters.

    Raises
    ------
    InputError
        For data that are not such a curve, do not grow, or are too few: the fitted points must outnumber the
        parameters (C, t0, q, and A(0) where it is one).
    ConvergenceError
        If no starting point led to a minimum.
    """
    curve = _Curve.checked(time, area, parameters=3)
    exponents = (1e-3, 0.03, 0.1, 0.3, 1.0, 3.0)
    starts = [np.log([1.0, t0, q]) for q in exponents for t0 in curve.time_scales()]
    best = _fit(_saturating, curve, starts, [_EXPONENT_RANGE])
    C, (t0, q) = best.C, np.exp(best.theta[1:3])
    at_edge = q < 10 * _EXPONENT_RANGE[0]
    return SaturationFit(
        a=float(1 + C / q),
        a_stderr=float("inf") if at_edge else float(C / q * best.log_stderr(1, 0, -1)),
        q=float(q),
        q_stderr=float(q * best.log_stderr(0, 0, 1)),
        t0=float(t0 * curve.time_unit),
        t0_stderr=float(t0 * curve.time_unit * best.log_stderr(0, 1)),
        C=C,
        C_stderr=C * best.log_stderr(1),
        initial_area=best.initial_area,
        initial_area_stderr=best.initial_area_stderr,
        rms_residual=best.rms_residual,
        r_squared=best.r_squared,
    )


def logarithm(time: ArrayLike, area: ArrayLike) -> LogarithmFit:
    """Fit Eq. (log), a logarithm without end, to a curve A(t).

    Arguments and errors are those of `saturation`; the parameters are C, t0, and A(0) where it is one.

    Returns
    -------
    LogarithmFit
        Law and parameters.
    """
    curve = _Curve.checked(time, area, parameters=2)
    best = _fit(_logarithmic, curve, [np.log([1.0, t0]) for t0 in curve.time_scales()], [])
    C, t0 = best.C, np.exp(best.theta[1])
    return LogarithmFit(
        C=C,
        C_stderr=C * best.log_stderr(1),
        t0=float(t0 * curve.time_unit),
        t0_stderr=float(t0 * curve.time_unit * best.log_stderr(0, 1)),
        initial_area=best.initial_area,
        initial_area_stderr=best.initial_area_stderr,
        rms_residual=best.rms_residual,
        r_squared=best.r_squared,
    )


def _saturating(theta: Floats, time: Floats) -> tuple[Floats, Floats]:
    K, t0, q = np.exp(theta[:3])
    age = np.log1p(time / t0)
    y = q * age
    shape = -np.expm1(-y) / q
    slope_t0 = -K * np.exp(-y) * time / (time + t0)
    # q d(shape)/dq = ((1 + y) exp(-y) - 1)/q, written with the incomplete gamma function: no cancellation.
    slope_q = -K / q * gammainc(2, y)
    return K * shape, np.column_stack([K * shape, slope_t0, slope_q])


def _logarithmic(theta: Floats, time: Floats) -> tuple[Floats, Floats]:
    K, t0 = np.exp(theta[:2])
    shape = np.log1p(time / t0)
    return K * shape, np.column_stack([K * shape, -K * time / (time + t0)])


@dataclass(frozen=True)
class _Curve:
    """The points to fit, in units of the data: times of the first, areas of A(0) or of the first area."""

    time: Floats
    area: Floats
    time_unit: float
    area_unit: float
    initial_known: bool

    @classmethod
    def checked(cls, time: ArrayLike, area: ArrayLike, parameters: int) -> _Curve:
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
class _Optimum:
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


def _fit(
    law: _Law, curve: _Curve, shapes: Iterable[Floats], more_ranges: list[tuple[float, float]]
) -> _Optimum:
    """Polish the best starting points and keep the best minimum."""
    free = not curve.initial_known
    logs = [_SLOPE_RANGE, (1 / _TIME_REACH, curve.time[-1] * _TIME_REACH), *more_ranges]
    bounds = np.concatenate([np.log(logs), [_INITIAL_RANGE] if free else np.empty((0, 2))])
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
    for start in candidates[:_POLISHED_STARTS]:
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


def _with_linear_part(law: _Law, shape: Floats, curve: _Curve) -> Floats | None:
    """Complete a start with the K, and the A(0), that suit it best; None where they are not above 0."""
    growth, _ = law(shape, curve.time)  # shape has K = 1
    if curve.initial_known:
        K = float(growth @ (curve.area - 1)) / float(growth @ growth)
        return np.concatenate([[np.log(K)], shape[1:]]) if K > 0 else None
    columns = np.column_stack([np.ones_like(growth), growth])
    initial, K = np.linalg.lstsq(columns, curve.area)[0]
    return np.concatenate([[np.log(K)], shape[1:], [initial]]) if K > 0 and initial > 0 else None


def _optimum(theta: Floats, residual: Floats, jacobian: Floats, curve: _Curve) -> _Optimum:
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
    return _Optimum(
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


def _times(time: ArrayLike) -> Floats:
    array = np.asarray(time, dtype=np.float64)
    if not (array >= 0).all():
        raise InputError("time", expected="times not below 0", got=_sketch(array.ravel()))
    return array


def _sketch(values: Floats) -> str:
    return f"{values[0]:g} ... {values[-1]:g}" if values.size else "none"
