r"""Which law the data prefer, and how far to trust this.

Akaike's information criterion with the correction for few points (N. Sugiura, Commun. Stat. A 7, 13 (1978),
doi:10.1080/03610927808827599) for n values and k parameters, the variance among them:

    AICc = n ln(squares/n) + 2 k + 2 k (k + 1)/(n - k - 1),

or, with standard errors, chi-squared in place of the first term. AICc assumes independent errors, but errors
along a run of a simulation are correlated, and count the same evidence many times. So the verdict rests on a
second difference, with the likelihood of

    n_eff = n (1 - rho)/(1 + rho)

values, where rho is the correlation of neighboring residuals of the saturating law. This is the number of
independent values for the mean of an autoregressive series of first order: a rough, cautious measure.

The logarithm is the limit q -> 0 of the saturating law. So it never fits better, and AICc favors it by the
price of one parameter at most. The verdict ``"logarithm"`` also requires that the data exclude a saturation
that halves the slope within them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import views
from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.fits.curve import Curve
from asperity.fits.laws import GrowthFit, LogarithmFit, SaturationFit, logarithm, saturation
from asperity.fits.result import student

Verdict = Literal["logarithm", "saturation", "undecided"]

UNLIKELY = 0.05
"""Relative likelihood below which a law is excluded."""

ROUNDING = 8 * np.finfo(np.float64).eps
"""Relative residual below which a fit is exact."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Comparison(views.Brief):
    """Comparison of the two laws.

    Attributes
    ----------
    verdict
        ``"saturation"`` if the relative likelihood of the logarithm is below 0.05; ``"logarithm"`` if AICc
        prefers it, and the 95 % interval of q excludes a slope that halves within the data; else
        ``"undecided"``. All with `effective_points`.
    logarithm, saturation
        The fits.
    delta_aicc
        AICc of the logarithm less that of the saturating law, as if all values were independent.
    autocorrelation, effective_points
        Correlation rho of neighboring residuals; number of independent values, n (1 - rho)/(1 + rho) or n.
    delta_effective, relative_likelihood
        `delta_aicc` with the likelihoods of so many values; exp(-abs(delta_effective)/2).
    """

    verdict: Verdict
    logarithm: LogarithmFit
    saturation: SaturationFit
    delta_aicc: float
    autocorrelation: float
    effective_points: float
    delta_effective: float
    relative_likelihood: float


def compare(time: ArrayLike, area: ArrayLike | None = None, stderr: ArrayLike | None = None) -> Comparison:
    """Fit both laws as `saturation` does, and say which the data prefer; two values more are needed."""
    curve = Curve.checked(time, area, stderr, parameters=3)
    return compared(curve, logarithm(time, area, stderr), saturation(time, area, stderr))


def compared(curve: Curve, log: LogarithmFit, power: SaturationFit) -> Comparison:
    """Say which of two fits of this curve the data prefer."""
    weighted = curve.points.stderr is not None
    # Further parameters of both laws: A(0) if it is fitted, and the variance without standard errors.
    n, extra = curve.points.x.size, (not curve.initial_known) + (not weighted)
    if n < extra + 5:
        raise InputError("time", expected=f"at least {extra + 5} values to compare the laws by", got=n)
    of_log, of_power = _residual(curve, log), _residual(curve, power)
    rho, worth = neighbors(of_power)
    effective = n * worth
    penalty = price_of(n, 2 + extra) - price_of(n, 3 + extra)
    # One law contains the other: less than 0 is an error of the search.
    evidence = max(0.0, lack_of(of_log, weighted=weighted) - lack_of(of_power, weighted=weighted))
    delta = effective * evidence + penalty
    return Comparison(
        verdict=_verdict(delta, power, float(curve.points.x[-1]) * curve.time_unit, 1 / worth),
        logarithm=log,
        saturation=power,
        delta_aicc=n * evidence + penalty,
        autocorrelation=rho,
        effective_points=effective,
        delta_effective=delta,
        relative_likelihood=math.exp(-abs(delta) / 2),
    )


def _residual(curve: Curve, fit: GrowthFit) -> Floats:
    points = curve.points
    residual = points.y - fit.predict(points.x * curve.time_unit) / curve.area_unit
    return np.asarray(residual if points.stderr is None else residual / points.stderr)


def lack_of(misfit: Floats, *, weighted: bool, rounding: float = ROUNDING) -> float:
    """-2 ln(likelihood) per value, of misfits in standard errors, or with a fitted variance."""
    square = float(np.mean(misfit**2))
    return square if weighted else math.log(max(square, rounding**2))


def price_of(n: int, k: int) -> float:
    """Penalty of AICc for k parameters of n values."""
    return 2 * k + 2 * k * (k + 1) / (n - k - 1)


def neighbors(residual: Floats) -> tuple[float, float]:
    """Correlation of neighboring residuals, below 1, and the share of independent values."""
    squares = float(residual @ residual)
    # Smooth residuals of many points would have 1, and no independent value.
    most = 1 - 2 / (residual.size + 1)
    rho = min(float(residual[1:] @ residual[:-1]) / squares, most) if squares > 0 else 0.0
    return rho, min(1.0, (1 - rho) / (1 + rho))


def independent(residual: Floats) -> tuple[float, float]:
    """The same; all values are independent if neighbors correlate no more than those of white noise may."""
    rho, worth = neighbors(residual)
    return rho, worth if rho > 2 / math.sqrt(residual.size) else 1.0


def _verdict(delta: float, fit: SaturationFit, last: float, excess: float) -> Verdict:
    if delta > -2 * math.log(UNLIKELY):
        return "saturation"
    largest_q = fit.q + student(fit.degrees_of_freedom) * math.sqrt(excess) * fit.q_stderr
    slope_kept = math.exp(-largest_q * math.log1p(last / fit.t0))
    return "logarithm" if delta <= 0 and slope_kept > 0.5 else "undecided"
