r"""Laws of the growth of the contact area, fitted with uncertainties.

    saturation   A(t)/A(0) = a - (a - 1) / (1 + t/t0)^q          paper, Eq. (a)
    logarithm    A(t)/A(0) = 1 + C ln(1 + t/t0)                  paper, Eq. (log)

Source: E. A. Jagla, *Towards a modeling of the time dependence of contact area between solid bodies*. The
second is the limit q -> 0 of the first at fixed C = (a - 1) q, where the data do not determine a and q. So
the first is fitted as

    A(t) = A(0) + K [1 - (1 + t/t0)^(-q)] / q,

in ln K, ln t0, ln q, which is regular there; C = K/A(0) and a = 1 + C/q follow by the delta method. A(0) is
not fitted as a logarithm: if no time lies below t0, the fit hardly changes along dA(0) = K d ln t0, and this
valley is straight in A(0). If A(0) and the final area are known, K = (a - 1) q A(0), and ln t0 and ln q are
fitted. The exponent q of time is neither the wave vector nor the exponent of the area, which have the same
letter in the paper.

Compare C with the dilute theory of exponential heights, whose late slope is dA/A(0)/d ln t = k_eff/(8 pi k0),
with k_eff/k0 from `asperity.theory.site_stiffness`. The paper's Eq. (ndet2) puts k1 for k_eff.

Least squares of the residuals of the area, all of one weight or weighted by standard errors. The covariance
is the inverse of J^T J times the variance of the residuals. With standard errors this factor is 1, and
`reduced_chi_squared` has the variance. Errors of A(t) along one run of a simulation are correlated; then the
standard errors describe how well this curve determines the law. For the scatter from surface to surface, take
`asperity.fits.ensemble`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import gammainc

from asperity.base.checks import Floats, not_negative
from asperity.errors import InputError
from asperity.fits.curve import Curve
from asperity.fits.result import FitResult
from asperity.fits.search import EXPONENT_RANGE, Optimum, fit_law


@dataclass(frozen=True, kw_only=True, repr=False)
class GrowthFit(FitResult):
    """Base of the two laws; `LogarithmFit` describes the fields."""

    C: float
    C_stderr: float
    t0: float
    t0_stderr: float
    initial_area: float
    initial_area_stderr: float
    slope: float
    slope_stderr: float

    scales: ClassVar[frozenset[str]] = frozenset({"t0"})

    def area_ratio(self, time: ArrayLike) -> Floats:
        """A(t)/A(0) at times not below 0; any shape."""
        age = np.log1p(not_negative("time", time, infinity="welcome") / self.t0)
        return np.asarray(1 + self._growth(age))[()]

    def _growth(self, age: Floats) -> Floats:
        """A(t)/A(0) - 1 at ln(1 + t/t0)."""
        return self.C * age

    def predict(self, time: ArrayLike) -> Floats:
        """A(t) at times not below 0, in the unit of the areas; any shape."""
        return np.asarray(self.initial_area * self.area_ratio(time))[()]

    __call__ = predict


@dataclass(frozen=True, kw_only=True, repr=False)
class LogarithmFit(GrowthFit):
    """Eq. (log) with fitted parameters: A(t)/A(0) = 1 + C ln(1 + t/t0).

    Attributes
    ----------
    C, t0
        Slope in ln t, and time scale (unit of the times). If no time lies below t0 and A(0) is fitted, the
        data determine only A(0) C and one combination of A(0) and t0: standard errors are huge then.
    initial_area
        A(0); its standard error is 0 if it was not fitted (see `saturation`).
    slope
        A(0) C, the slope dA/d ln t for t0 << t, in the unit of the areas; times ln 10, per decade. The data
        determine it even if they do not determine A(0).
    """


@dataclass(frozen=True, kw_only=True, repr=False)
class SaturationFit(GrowthFit):
    """Eq. (a) with fitted parameters: A(t)/A(0) = a - (a - 1)/(1 + t/t0)^q.

    Attributes
    ----------
    a, q, t0
        Final area ratio, exponent, and time scale (unit of the times).
    C
        (a - 1) q, the slope in ln t of the logarithm that the law follows until t is about t0 exp(1/q). If
        q_stderr is not small beside q, the data are those of the logarithm: trust C, and neither a nor q. At
        the least q searched, 1e-8, a_stderr is infinite.
    initial_area, slope
        As for `LogarithmFit`; A(t) follows that slope for t0 << t << t0 exp(1/q).
    """

    a: float
    a_stderr: float
    q: float
    q_stderr: float

    def _growth(self, age: Floats) -> Floats:
        return np.asarray(self.C / self.q * -np.expm1(-self.q * age))


def saturation(
    time: ArrayLike,
    area: ArrayLike | None = None,
    stderr: ArrayLike | None = None,
    *,
    limit: float | None = None,
) -> SaturationFit:
    """Fit Eq. (a), a power law toward a final area, to a curve A(t).

    Parameters
    ----------
    time
        Times since the contact was made, shape (n,), not below 0, in any order, repeated or not.
    area
        Areas, shape (n,), above 0, in any unit: fraction, sites or square meters; or any other measure of
        the contact, such as the coefficient of static friction. An xarray DataArray of areas with a
        coordinate ``time`` needs no other argument: ``saturation(history.area)``.
    stderr
        Standard errors of the areas, shape (n,), above 0, if they are known.
    limit
        A(infinity), in the unit of the areas, if it is known, as from `asperity.relax`. Then a = limit/A(0),
        without an error, and q and t0 are fitted. It requires one area at time 0, below it, and no standard
        errors.

    Returns
    -------
    SaturationFit
        Law and parameters. With one area at time 0, and no standard errors, this area is A(0), and no point
        of the fit. Otherwise A(0) is a parameter, between 1e-3 and 10 first areas, and areas at time 0 are
        points like others.

    Raises
    ------
    InputError, ConvergenceError
        The data do not grow (by their rank correlation with time), or are not more than the parameters (C,
        t0, q, and A(0) if it is fitted); no start led to a minimum.
    """
    curve = Curve.checked(time, area, stderr, parameters=3 if limit is None else 2)
    exponents = (1e-3, 0.03, 0.1, 0.3, 1.0, 3.0)
    starts = [np.log([1.0, t0, q]) for q in exponents for t0 in curve.time_scales()]
    if limit is None:
        best = fit_law(_saturating, curve, starts, [EXPONENT_RANGE])
    else:
        best = _fit_below(limit, curve, [start[1:] for start in starts])
    C, q = best.C, float(np.exp(best.theta[2]))
    at_edge = q < 10 * EXPONENT_RANGE[0]
    return SaturationFit(
        a=1 + C / q,
        a_stderr=float("inf") if at_edge else 0.0 if limit is not None else C / q * best.log_stderr(1, 0, -1),
        q=q,
        q_stderr=q * best.log_stderr(0, 0, 1),
        **_shared(best),
    )


def _fit_below(limit: float, curve: Curve, starts: list[Floats]) -> Optimum:
    """Fit t0 and q toward a known final area, with ln K = ln(a - 1) + ln q."""
    growth = limit / curve.area_unit - 1
    if not (curve.initial_known and 0 < growth < np.inf):
        got = f"{limit:g}" if curve.initial_known else "areas of which A(0) must be fitted too"
        raise InputError("limit", expected="a final area above the one area at time 0", got=got)
    whole = np.array([[0.0, 1.0], [1.0, 0.0], [0.0, 1.0]])  # (ln K, ln t0, ln q) of (ln t0, ln q)
    start = np.array([np.log(growth), 0.0, 0.0])

    def law(theta: Floats, time: Floats) -> tuple[Floats, Floats]:
        value, slopes = _saturating(start + whole @ theta, time)
        return value, slopes @ whole

    best = fit_law(law, curve, starts, [EXPONENT_RANGE], K_known=True)
    return replace(best, theta=start + whole @ best.theta, covariance=whole @ best.covariance @ whole.T)


def logarithm(
    time: ArrayLike, area: ArrayLike | None = None, stderr: ArrayLike | None = None
) -> LogarithmFit:
    """Fit Eq. (log), a logarithm without end, to a curve A(t).

    Arguments and errors are those of `saturation`; the parameters are C, t0, and A(0) if it is fitted.
    """
    curve = Curve.checked(time, area, stderr, parameters=2)
    best = fit_law(_logarithmic, curve, [np.log([1.0, t0]) for t0 in curve.time_scales()], [])
    return LogarithmFit(**_shared(best))


def _shared(best: Optimum) -> dict[str, Any]:
    """Fields of both laws, in the units of the data."""
    time_unit, area_unit = best.curve.time_unit, best.curve.area_unit
    t0, slope = float(np.exp(best.theta[1])) * time_unit, best.C * best.initial * area_unit
    return {
        "C": best.C,
        "C_stderr": best.C * best.log_stderr(1),
        "t0": t0,
        "t0_stderr": t0 * best.log_stderr(0, 1),
        "initial_area": best.initial * area_unit,
        "initial_area_stderr": best.initial_stderr * area_unit,
        "slope": slope,
        "slope_stderr": slope * best.log_stderr(1, per_initial=False),
        **best.quality,
    }


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
