"""Numbers that several claims ask for: exponents, slopes and crossovers of ensembles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asperity.fits import growth_rate
from asperity.fits.resampling import Estimate, jackknife
from asperity.lattice import Field, Mask


def mean_of(statistic: Callable[..., float | Field], samples: Field) -> Estimate:
    """Estimate a statistic of the ensemble mean; seeds are the first axis of the samples."""
    return jackknife(lambda some: statistic(some.mean(axis=0)), samples)


def exponent(x: Field, y: Field) -> float:
    """Slope of ln y against ln x, by least squares; NaN where y is not above 0."""
    return float("nan") if y.min(initial=1.0) <= 0 else slope(np.log(x), np.log(y))


def slope(x: Field, y: Field) -> float:
    """Slope of y against x, by least squares; NaN for a single point."""
    if x.size < 2:
        return float("nan")
    away = x - x.mean()
    return float(away @ y / (away @ away))


def growth_slope(time: Field, area: Field, first: float, last: float) -> float:
    """d(A/A(0))/d ln t between two times, the B of the paper; NaN without any area at first."""
    return growth_rate(time, area, first, last).B if area.min() > 0 else float("nan")


def between(values: Field, low: float, high: float) -> Mask:
    """Which values lie from low to high, ends included as well as rounding allows."""
    return np.asarray((values >= low * (1 - 1e-9)) & (values <= high * (1 + 1e-9)))


def crossing(x: Field, y: Field, level: float) -> float:
    """Where a rising y(x) crosses a level, by interpolation in ln x; NaN where it does not."""
    if not y[0] < level < y[-1]:
        return float("nan")
    return float(np.exp(np.interp(level, y, np.log(x))))
