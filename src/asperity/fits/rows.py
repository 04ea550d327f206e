"""Rows of a fit of growth: the data, each law, the straight line, the comparison."""

from __future__ import annotations

import math
from collections.abc import Iterator

from asperity.base.rows import Row
from asperity.base.words import counted, uncertain
from asperity.fits.comparison import Comparison
from asperity.fits.laws import LogarithmFit, SaturationFit
from asperity.fits.rate import GrowthRate
from asperity.fits.result import FitResult, parameters_of

UNDETERMINED = "not determined by these times"
_PER_DECADE = math.log(10)
_FORMULAS = {
    "saturation": ("A0 [a - (a - 1)/(1 + t/t0)^q]", ("a", "q", "t0", "C")),
    "logarithm": ("A0 [1 + C ln(1 + t/t0)]", ("C", "t0")),
}


def determined(value: float, stderr: float) -> bool:
    """Whether a parameter is known better than to a factor of about two; an exact one is."""
    return stderr < abs(value)


def of_law(law: str, fit: SaturationFit | LogarithmFit, unit: str) -> Iterator[Row]:
    """Rows of a law fitted to times in this unit."""
    formula, names = _FORMULAS[law]
    yield Row(law, formula)
    if fit.initial_area_stderr == 0:
        yield Row("  A0", fit.initial_area, note=", as given, taken as exact", digits=6)
    else:
        yield _shape("A0", fit, "initial_area")
    for name in names:
        yield _shape(name, fit, name, unit=unit if name == "t0" else "1")
    yield _row("slope A0 C per decade", fit, "slope", factor=_PER_DECADE)
    yield _goodness(fit)


def of_line(rate: GrowthRate, initial_from: str, unit: str) -> Iterator[Row]:
    """Rows of the straight line in ln t, and where its A(0) is from."""
    source = "measured at time 0" if initial_from == "time 0" else f"from the {initial_from}"
    span = f"{rate.first:g} to {rate.last:g} {unit}".rstrip()
    yield Row("straight line", f"in ln t: {counted(rate.points, 'value')}, {span}")
    for text, name in (("", "slope"), (" in units of A0", "B"), (", relative", "relative")):
        if name != "B" or initial_from:
            yield _row(f"per decade{text}", rate, name, factor=_PER_DECADE)
            yield _row(f"per e-fold{text}", rate, name)
    yield Row("  A0", f"{rate.initial_area:.6g}, {source}" if initial_from else UNDETERMINED)
    yield _goodness(rate)
    if math.isfinite(rate.curvature):
        bend = uncertain(100 * rate.curvature, 100 * rate.curvature_stderr)
        bent = "not straight, so that the rate depends on the window"
        unknown = "the data do not tell whether it is straight"
        verdict = unknown if rate.straight is None else "straight" if rate.straight else bent
        yield Row("  bend", f"the slope changes within the window by {bend} %; {verdict}")


def _shape(text: str, fit: FitResult, name: str, *, unit: str = "1") -> Row:
    """Row of a parameter that must not be 0; a slope may be, and that is a result."""
    if determined(*fit.known(name)):
        return _row(text, fit, name, unit=unit)
    return Row(f"  {text}", UNDETERMINED)


def _row(text: str, fit: FitResult, name: str, *, factor: float = 1.0, unit: str = "1") -> Row:
    (value, stderr), (low, high) = fit.known(name), fit.interval(name)
    interval = (factor * low, factor * high) if math.isfinite(high) else None
    return Row(f"  {text}", factor * value, unit, interval, error=factor * stderr)


def of_parameters(fit: FitResult) -> list[Row]:
    """Rows of the parameters of one law and its misfit."""
    return [*(_row(name, fit, name) for name in parameters_of(fit)), _goodness(fit)]


def _goodness(fit: FitResult) -> Row:
    chi = "" if fit.reduced_chi_squared is None else f", reduced chi² = {fit.reduced_chi_squared:.3g}"
    return Row("  misfit", f"{100 * fit.rms_residual:.2g} % rms, R² = {fit.r_squared:.4g}{chi}")


def of_comparison(comparison: Comparison) -> list[Row]:
    """Rows of which law the data prefer, and of what this rests on."""
    likelihood = comparison.relative_likelihood
    odds = f"{likelihood:.1g}" if likelihood > 1e-6 else "less than 1e-6"
    words = {
        "saturation": f"the data prefer saturation: a logarithm without end is {odds} times as likely",
        "logarithm": "the data prefer the logarithm: no sign of saturation, and none that halves the slope "
        "within these times",
        "undecided": "these data do not tell a logarithm from a saturation",
    }
    worth = f"the values count as {comparison.effective_points:.0f} independent ones, "
    worth += f"the difference {comparison.delta_effective:.3g}"
    aicc = f"logarithm less saturation {comparison.delta_aicc:.3g}, were all values independent"
    return [
        Row("verdict", words[comparison.verdict]),
        Row("  AICc", aicc),
        Row("  residuals", f"neighbors correlate by {comparison.autocorrelation:.2f}: {worth}"),
    ]
