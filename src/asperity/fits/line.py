"""Least squares with polynomials of low degree: the straight lines behind exponents and growth rates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.fits.result import explained


@dataclass(frozen=True, eq=False)
class Polynomial:
    """A polynomial y = sum_k c_k z^k in z = (x - center)/scale, and how well it fits.

    Attributes
    ----------
    coefficients, covariance
        c_0, c_1, ...; the covariance is (J^T J)^-1, times the variance of the residuals unless standard
        errors of y were given.
    center, scale
        Middle and half width of the range of x.
    degrees_of_freedom, residual, r_squared, reduced_chi_squared
        See `FitResult`; the residuals are those of y.
    """

    coefficients: Floats
    covariance: Floats
    center: float
    scale: float
    degrees_of_freedom: float
    residual: Floats
    r_squared: float
    reduced_chi_squared: float | None

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
    """Fit; the points must outnumber the coefficients, and the different x be as many."""
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
    squares = float(np.sum((weight * residual) ** 2))
    free = x.size - coefficients
    return Polynomial(
        coefficients=c,
        covariance=covariance * (squares / free if stderr is None else 1.0),
        center=float(center),
        scale=float(scale),
        degrees_of_freedom=float(free) if stderr is None else float("inf"),
        residual=residual,
        r_squared=explained(squares, y, weight**2),
        reduced_chi_squared=None if stderr is None else squares / free,
    )
