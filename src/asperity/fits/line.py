"""Least squares with polynomials of low degree, for exponents and growth rates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.fits.result import quality


@dataclass(frozen=True, eq=False)
class Polynomial:
    """A polynomial y = sum_k c_k z^k in z = (x - center)/scale, from -1 to 1, and how well it fits.

    The covariance is (J^T J)^-1, times the variance of the residuals of y without standard errors.
    """

    coefficients: Floats
    covariance: Floats
    center: float
    scale: float
    residual: Floats
    quality: dict[str, Any]

    @property
    def slope(self) -> tuple[float, float]:
        """Slope dy/dx in the center, and its standard error."""
        return float(self.coefficients[1]) / self.scale, float(np.sqrt(self.covariance[1, 1])) / self.scale

    def at(self, x: float) -> tuple[float, float]:
        """Value at x, and its standard error."""
        powers = ((x - self.center) / self.scale) ** np.arange(self.coefficients.size)
        return float(powers @ self.coefficients), float(np.sqrt(powers @ self.covariance @ powers))


def polynomial(
    x: Floats, y: Floats, stderr: Floats | None, *, degree: int = 1, name: str = "time"
) -> Polynomial:
    """Fit; there must be more points than coefficients, and as many different x."""
    coefficients = degree + 1
    if x.size <= coefficients:
        raise InputError(name, expected=f"at least {coefficients + 1} points to fit", got=x.size)
    different = np.unique(x).size
    if different < coefficients:
        raise InputError(name, expected=f"at least {coefficients} different values", got=different)
    center, scale = (x[-1] + x[0]) / 2, (x[-1] - x[0]) / 2
    z = (x - center) / scale
    weight = np.ones_like(y) if stderr is None else 1 / stderr
    fitted, unscaled = np.polyfit(z, y, degree, w=weight, cov="unscaled")
    c, covariance = fitted[::-1], unscaled[::-1, ::-1]
    residual = y - np.polynomial.polynomial.polyval(z, c)
    if stderr is None:
        covariance = covariance * float(residual @ residual) / (x.size - coefficients)
    facts = quality(residual, y, stderr, coefficients)
    return Polynomial(c, covariance, float(center), float(scale), residual, facts)
