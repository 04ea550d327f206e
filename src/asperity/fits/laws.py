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

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import gammainc

from asperity.fits.search import EXPONENT_RANGE, Curve, Floats, checked_times, fit_law


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
        return np.asarray(1 + self.C * np.log1p(checked_times(time) / self.t0))[()]


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
        growth = self.C / self.q * -np.expm1(-self.q * np.log1p(checked_times(time) / self.t0))
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
    curve = Curve.checked(time, area, parameters=3)
    exponents = (1e-3, 0.03, 0.1, 0.3, 1.0, 3.0)
    starts = [np.log([1.0, t0, q]) for q in exponents for t0 in curve.time_scales()]
    best = fit_law(_saturating, curve, starts, [EXPONENT_RANGE])
    C, (t0, q) = best.C, np.exp(best.theta[1:3])
    at_edge = q < 10 * EXPONENT_RANGE[0]
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
    curve = Curve.checked(time, area, parameters=2)
    best = fit_law(_logarithmic, curve, [np.log([1.0, t0]) for t0 in curve.time_scales()], [])
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
