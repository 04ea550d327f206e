"""Quality and intervals of fits."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np
from scipy.special import stdtrit

from asperity.base import views
from asperity.base.checks import Floats
from asperity.errors import InputError

SURE = 0.95
"""Probability that a stated interval covers the true value."""


def student(degrees_of_freedom: float) -> float:
    """Half width of the two-sided 95 % interval in standard errors, from Student's t; NaN below 1 degree."""
    if not degrees_of_freedom >= 1:
        return math.nan
    return float(stdtrit(min(degrees_of_freedom, 1e9), (1 + SURE) / 2))


@dataclass(frozen=True, kw_only=True, repr=False)
class FitResult(views.InNotebooks):
    """Base of the fits.

    Attributes
    ----------
    points
        Number of values fitted.
    degrees_of_freedom
        Points less parameters; infinite with standard errors of the values, which determine those of the
        parameters.
    rms_residual
        Root mean square of the relative residuals 1 - fit/value.
    r_squared
        1 - (sum of squared residuals) / (sum of squares about the mean), with the weights of the fit; NaN
        if the values do not vary.
    reduced_chi_squared
        Chi-squared over the points less the parameters; about 1 if law and standard errors are right. None
        without standard errors.
    """

    points: int
    degrees_of_freedom: float
    rms_residual: float
    r_squared: float
    reduced_chi_squared: float | None

    scales: ClassVar[frozenset[str]] = frozenset()
    """Parameters whose intervals are symmetric in the logarithm."""

    def __repr__(self) -> str:
        parts = []
        for name in parameters_of(self):
            value, error = self.known(name)
            parts.append(f"{name} = {value:.4g}" + (f" ± {error:.2g}" if error != 0 else ""))
        parts += [f"{self.points} points", f"misfit {100 * self.rms_residual:.2g} % rms"]
        return f"<{type(self).__name__}: {', '.join(parts)}>"

    def known(self, name: str) -> tuple[float, float]:
        """Value and standard error of a parameter."""
        return float(getattr(self, name)), float(getattr(self, f"{name}_stderr"))

    def interval(self, name: str) -> tuple[float, float]:
        """Ends of the 95 % interval of a parameter, by Student's t, for independent errors of the values.

        A parameter is a field with a standard error beside it, such as ``"C"``. The interval is symmetric;
        for `scales` (t0, prefactor) it is so in the logarithm.
        """
        names = parameters_of(self)
        if name not in names:
            raise InputError("name", expected=f"one of {', '.join(names)}", got=repr(name))
        value, stderr = self.known(name)
        reach = student(self.degrees_of_freedom) * stderr if stderr > 0 else stderr
        if name not in self.scales:
            return value - reach, value + reach
        exponent = reach / value
        if not exponent < math.log(1e300):
            return 0.0, math.inf
        return value * math.exp(-exponent), value * math.exp(exponent)


def quality(residual: Floats, y: Floats, stderr: Floats | None, parameters: int) -> dict[str, Any]:
    """Fields of `FitResult`, without `rms_residual`, from the residuals and standard errors of y."""
    weight = np.ones_like(y) if stderr is None else stderr**-2
    squares, free = float(np.sum(weight * residual**2)), y.size - parameters
    total = float(np.sum(weight * (y - np.average(y, weights=weight)) ** 2))
    return {
        "points": y.size,
        "degrees_of_freedom": float(free) if stderr is None else math.inf,
        "r_squared": 1 - squares / total if total > 0 else math.nan,
        "reduced_chi_squared": None if stderr is None else squares / free,
    }


def rms(relative: Floats) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(relative**2)))


def parameters_of(fit: object) -> tuple[str, ...]:
    """Name the fields of a fit that have a standard error beside them; any dataclass."""
    names = [field.name for field in fields(fit)]  # type: ignore[arg-type]
    return tuple(name for name in names if f"{name}_stderr" in names)
