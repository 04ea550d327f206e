"""The rate of growth: slope of the area, or of friction, against the logarithm of time over a window.

    B        = d(A/A(0)) / d ln t
    relative = d ln A / d ln t

both by straight lines in ln t. Friction experiments quote d mu / d log10 t = ``slope * ln 10``. A cubic shows
whether the window is straight: `curvature` is the change of its slope over the window, in units of the slope.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.fits.curve import Series
from asperity.fits.line import polynomial
from asperity.fits.result import FitResult, rms, student

STRAIGHT = 0.25
"""Change of the slope over a window, in units of the slope, up to which the window is called straight."""


@dataclass(frozen=True, kw_only=True, repr=False)
class GrowthRate(FitResult):
    """Slopes in ln t over a window.

    Attributes
    ----------
    B, relative, slope
        d(A/A(0))/d ln t, its standard error with that of A(0); d ln A/d ln t, the local exponent of A(t);
        dA/d ln t, in the unit of the areas.
    curvature, curvature_reach
        Largest change of the slope of a cubic (with few times, a parabola) between beginning, middle and end
        of the window, over the slope; below 0 if the growth slows down, NaN for fewer than four points or
        three different times. Half the width of its 95 % interval, by Student's t.
    initial_area
        A(0): the argument `initial`, or the mean of the areas at time 0.
    first, last, middle
        Earliest and latest time in the window, and the area on the line at its geometric middle.

    The fields of `FitResult` are those of the straight line A against ln t.
    """

    B: float
    B_stderr: float
    relative: float
    relative_stderr: float
    slope: float
    slope_stderr: float
    curvature: float
    curvature_stderr: float
    curvature_reach: float
    initial_area: float
    initial_area_stderr: float
    first: float
    last: float
    middle: float

    def predict(self, time: ArrayLike) -> Floats:
        """Area on the straight line at times above 0, of any shape."""
        from_middle = np.log(checks.positive("time", time) / (math.sqrt(self.first) * math.sqrt(self.last)))
        return np.asarray(self.middle + self.slope * from_middle)[()]

    def interval(self, name: str) -> tuple[float, float]:
        """95 % interval of a parameter; see `FitResult`."""
        if name == "curvature":  # of another curve than the rest, with fewer degrees of freedom
            return self.curvature - self.curvature_reach, self.curvature + self.curvature_reach
        return super().interval(name)

    @property
    def straight(self) -> bool | None:
        """Whether the slope changes by a quarter of itself at most; None if the data leave this open."""
        if abs(self.curvature) > max(STRAIGHT, self.curvature_reach):
            return False
        return True if self.curvature_reach <= STRAIGHT else None


def growth_rate(
    time: ArrayLike,
    area: ArrayLike,
    first: float | None = None,
    last: float | None = None,
    *,
    stderr: ArrayLike | None = None,
    initial: float | None = None,
    initial_stderr: float = 0.0,
) -> GrowthRate:
    """Measure the rate of growth by straight lines in ln t.

    Parameters
    ----------
    time, area, stderr
        As for `asperity.fits.saturation`. Areas at time 0 only give A(0).
    first, last
        Window of times, both included; by default all above 0.
    initial, initial_stderr
        A(0) and its standard error, by default from the areas at time 0; needed without any.

    Errors are those of `asperity.fits.saturation`, but areas may fall with time.
    """
    series = Series.checked(time, area, stderr)
    A0, A0_stderr = _initial(series, initial, initial_stderr)
    low = 0.0 if first is None else checks.number("first", first)
    high = math.inf if last is None else checks.number("last", last)
    window = series.where((series.x > 0) & (series.x >= low) & (series.x <= high))
    if window.x.size < 3:
        expected = f"at least 3 points at times above 0 from {low:g} to {high:g}"
        raise InputError("time", expected=expected, got=window.x.size, advice="a wider window")
    x, y, sigma = np.log(window.x), window.y, window.stderr
    mean = float(y.mean())  # taken off, so that an area that stays has a slope of exactly 0
    line = polynomial(x, y - mean, sigma)
    slope, slope_stderr = line.slope
    relative, relative_stderr = polynomial(x, np.log(y / mean), None if sigma is None else sigma / y).slope
    return GrowthRate(
        B=slope / A0,
        B_stderr=math.hypot(slope_stderr, slope * A0_stderr / A0) / A0,
        relative=relative,
        relative_stderr=relative_stderr,
        slope=slope,
        slope_stderr=slope_stderr,
        **_curvature(window, slope),
        initial_area=A0,
        initial_area_stderr=A0_stderr,
        first=float(window.x[0]),
        last=float(window.x[-1]),
        middle=mean + float(line.coefficients[0]),
        rms_residual=rms(line.residual / y),
        **line.quality,
    )


def _initial(series: Series, initial: float | None, initial_stderr: float) -> tuple[float, float]:
    if initial is not None:
        return (
            checks.number("initial", initial, above=0, expected="a finite number above 0"),
            checks.number("initial_stderr", initial_stderr, least=0),
        )
    zeros = series.where(series.x == 0)
    if zeros.y.size == 0:
        expected, advice = "the area at time 0, as no time is 0", "initial=..., or a point at time 0"
        raise InputError("initial", expected=expected, got="none", advice=advice)
    if zeros.stderr is not None:
        weight = zeros.stderr**-2
        return float(np.average(zeros.y, weights=weight)), float(weight.sum() ** -0.5)
    spread = float(zeros.y.std(ddof=1)) / math.sqrt(zeros.y.size) if zeros.y.size > 1 else 0.0
    return float(zeros.y.mean()), spread


def _curvature(window: Series, slope: float) -> dict[str, Any]:
    """Largest change of slope over the window, in units of the slope, its standard error, and its reach."""
    degree = min(3, np.unique(window.x).size - 1, window.x.size - 2)
    if degree < 2 or slope == 0:
        return dict.fromkeys(("curvature", "curvature_stderr", "curvature_reach"), math.nan)
    curve = polynomial(np.log(window.x), window.y, window.stderr, degree=degree)
    # With z from -1 to 1 over the window dy/dz = c1 + 2 c2 z + 3 c3 z^2; an S has equal slopes at its ends.
    changes = np.array([[0, 0, 4, 0], [0, 0, 2, -3], [0, 0, 2, 3]])[:, : degree + 1]
    largest = changes[np.argmax(np.abs(changes @ curve.coefficients))]
    unit = 1 / (slope * curve.scale)
    stderr = float(np.sqrt(largest @ curve.covariance @ largest)) * abs(unit)
    return {
        "curvature": float(largest @ curve.coefficients) * unit,
        "curvature_stderr": stderr,
        "curvature_reach": student(curve.quality["degrees_of_freedom"]) * stderr,
    }
