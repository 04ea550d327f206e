"""Power laws y = prefactor x^exponent by least squares of the logarithms; the exponent from point to point.

The paper has one for the area against the load. It calls the exponent q, like that of the law of saturation
(see docs/notation.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from asperity.base.checks import Floats, positive
from asperity.errors import InputError
from asperity.fits.curve import Series, sketch
from asperity.fits.line import polynomial
from asperity.fits.result import FitResult, rms


@dataclass(frozen=True, kw_only=True, repr=False)
class PowerLawFit(FitResult):
    """A power law y = prefactor x^exponent with fitted parameters.

    Attributes
    ----------
    exponent, exponent_stderr
        Slope d ln y/d ln x.
    prefactor, prefactor_stderr
        y at x = 1, in the unit of y.
    r_squared
        Of the logarithms.

    The residuals of `FitResult` are relative.
    """

    exponent: float
    exponent_stderr: float
    prefactor: float
    prefactor_stderr: float

    scales: ClassVar[frozenset[str]] = frozenset({"prefactor"})

    def predict(self, x: ArrayLike) -> Floats:
        """Y at x above 0, of any shape."""
        return np.asarray(self.prefactor * positive("x", x) ** self.exponent)[()]

    __call__ = predict


def power_law(x: ArrayLike, y: ArrayLike, stderr: ArrayLike | None = None) -> PowerLawFit:
    """Fit a power law by least squares of ln y against ln x.

    Parameters
    ----------
    x, y
        Values above 0, shape (n,), n at least 3, in any order and unit.
    stderr
        Standard errors of y, shape (n,), if they are known, and small beside y: those of ln y are stderr/y.
        Without them all relative errors of y are equal.
    """
    series = _positive(x, y, stderr)
    sigma = None if series.stderr is None else series.stderr / series.y
    line = polynomial(np.log(series.x), np.log(series.y), sigma, name="x")
    exponent, exponent_stderr = line.slope
    logarithm, log_stderr = line.at(0.0)
    prefactor = float(np.exp(logarithm))
    return PowerLawFit(
        exponent=exponent,
        exponent_stderr=exponent_stderr,
        prefactor=prefactor,
        prefactor_stderr=prefactor * log_stderr,
        rms_residual=rms(np.expm1(-line.residual)),
        **line.quality,
    )


def local_exponent(x: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
    """Running exponent d ln y/d ln x between neighbors.

    Values are above 0, shape (n,), in any order; y of equal x are replaced by their geometric mean. Returns
    the geometric middles of neighboring x, increasing, and the exponents there: shape (m - 1,) for m
    different x.
    """
    series = _positive(x, y, None)
    different, which, counts = np.unique(series.x, return_inverse=True, return_counts=True)
    if different.size < 2:
        raise InputError("x", expected="at least 2 different values", got=different.size)
    log_x, log_y = np.log(different), np.bincount(which, np.log(series.y)) / counts
    return np.exp((log_x[1:] + log_x[:-1]) / 2), np.diff(log_y) / np.diff(log_x)


def _positive(x: ArrayLike, y: ArrayLike, stderr: ArrayLike | None) -> Series:
    series = Series.checked(x, y, stderr, names=("x", "y", "stderr"))
    if series.x[0] <= 0:
        raise InputError("x", expected="values of x above 0", got=sketch(series.x))
    return series
