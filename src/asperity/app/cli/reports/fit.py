"""A fit of growth: its tables for the terminal, and all its numbers as JSON."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

from asperity.base.files import Standing
from asperity.base.words import finite, uncertain
from asperity.figures.fit import UNDETERMINED, determined
from asperity.fits import Comparison, FitResult, GrowthRate, LogarithmFit, MeasuredGrowth, SaturationFit
from asperity.fits.measured import Law
from asperity.fits.result import parameters_of
from asperity.results.store import whole_file

_PER_DECADE = math.log(10)
_SLOPES = ("slope", "B", "relative")
_FORMULAS: dict[Law, tuple[str, tuple[str, ...]]] = {
    "saturation": ("A0 [a - (a - 1)/(1 + t/t0)^q]", ("a", "q", "t0", "C")),
    "logarithm": ("A0 [1 + C ln(1 + t/t0)]", ("C", "t0")),
}


def growth_report(growth: MeasuredGrowth, *, source: str, unit: str) -> list[list[tuple[str, ...]]]:
    """Tables of words: the data, each law, the straight line, the comparison."""
    zeros = f", {growth.initial_points} of them at time 0" if growth.initial_points else ""
    span = f"{growth.shown.x[0]:g} to {growth.shown.x[-1]:g}{unit}"
    data: list[tuple[str, ...]] = [("data", f"{source}, {growth.points} values{zeros}; times {span}")]
    laws = [_law(law, fit, unit) for law, fit in growth.fits.items()]
    line = [] if growth.rate is None else [_line(growth.rate, growth.initial_from, unit)]
    # Where the laws are not determined, the straight line is all that the data say.
    blocks = [data, *(laws + line if growth.initial_from else line + laws)]
    if growth.comparison is not None:
        blocks.append(_comparison(growth.comparison))
    if growth.notes:
        blocks.append([("note", note) for note in growth.notes])
    return blocks


def _law(law: Law, fit: SaturationFit | LogarithmFit, unit: str) -> list[tuple[str, ...]]:
    formula, names = _FORMULAS[law]
    rows = [(f"{law}: {formula}",), ("", "value ± standard error", "95 % interval")]
    if fit.initial_area_stderr == 0:
        rows.append(("  A0", f"{fit.initial_area:.6g}", "as given, taken as exact"))
    else:
        rows.append(_shape("A0", fit, "initial_area"))
    rows += [_shape(name, fit, name, unit=unit if name == "t0" else "") for name in names]
    rows.append(_row("slope A0 C per decade", fit, "slope", factor=_PER_DECADE))
    return [*rows, _goodness(fit)]


def _line(rate: GrowthRate, initial_from: str, unit: str) -> list[tuple[str, ...]]:
    source = "measured at time 0" if initial_from == "time 0" else f"from the {initial_from}"
    rows: list[tuple[str, ...]] = [
        (f"straight line in ln t: {rate.points} values, {rate.first:g} to {rate.last:g}{unit}",),
        ("", "per e-fold of time", "per decade", "95 % interval per decade"),
    ]
    over_A0 = (("in units of A0", "B"),) if initial_from else ()
    for text, name in (("absolute", "slope"), *over_A0, ("relative", "relative")):
        _, per_efold, _ = _row(text, rate, name)
        rows.append((f"  {text}", per_efold, *_row(text, rate, name, factor=_PER_DECADE)[1:]))
    origin = f"{rate.initial_area:.6g}, {source}" if initial_from else UNDETERMINED
    rows += [(f"  A0: {origin}",), _goodness(rate)]
    if math.isfinite(rate.curvature):
        bend = uncertain(100 * rate.curvature, 100 * rate.curvature_stderr)
        bent = "not straight, so that the rate depends on the window"
        unknown = "the data do not tell whether it is straight"
        verdict = unknown if rate.straight is None else "straight" if rate.straight else bent
        rows.append((f"  change of slope within the window: {bend} %; {verdict}",))
    return rows


def _shape(text: str, fit: FitResult, name: str, *, unit: str = "") -> tuple[str, ...]:
    """Row of a parameter that must not be 0; a slope may be, and that is a result."""
    if determined(*fit.known(name)):
        return _row(text, fit, name, unit=unit)
    return f"  {text}", UNDETERMINED, ""


def _row(text: str, fit: FitResult, name: str, *, factor: float = 1.0, unit: str = "") -> tuple[str, ...]:
    (value, stderr), (low, high) = fit.known(name), fit.interval(name)
    return (
        f"  {text}",
        f"{uncertain(factor * value, factor * stderr)}{unit}",
        f"{factor * low:.5g} to {factor * high:.5g}" if math.isfinite(high) else "",
    )


def _goodness(fit: FitResult) -> tuple[str, ...]:
    chi = "" if fit.reduced_chi_squared is None else f", reduced chi² = {fit.reduced_chi_squared:.3g}"
    return (f"  misfit: {100 * fit.rms_residual:.2g} % rms, R² = {fit.r_squared:.4g}{chi}",)


def _comparison(comparison: Comparison) -> list[tuple[str, ...]]:
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
    return [
        (words[comparison.verdict],),
        ("  AICc", f"logarithm less saturation {comparison.delta_aicc:.3g}, were all values independent"),
        ("  residuals", f"neighbors correlate by {comparison.autocorrelation:.2f}: {worth}"),
    ]


def write_numbers(growth: MeasuredGrowth, path: Path, replaceable: Standing, **origin: str) -> None:
    """Write all numbers and their origin as JSON, with null for infinity."""
    comparison = {} if growth.comparison is None else vars(growth.comparison)
    numbers = {name: value for name, value in comparison.items() if name not in growth.fits}
    facts = {
        **origin,
        "points": growth.points,
        "initial_points": growth.initial_points,
        "fits": {law: _numbers(fit) for law, fit in growth.fits.items()},
        "initial_from": growth.initial_from,
        "straight_line": None if growth.rate is None else _numbers(growth.rate),
        "comparison": numbers or None,
        "notes": list(growth.notes),
    }
    text = json.dumps(finite(facts), indent=2, allow_nan=False)
    with whole_file(path, overwrite=replaceable) as part:
        part.write_text(f"{text}\n", encoding="utf-8")


def _numbers(fit: FitResult) -> dict[str, object]:
    """Every number of a fit under its name on the terminal; slopes also per decade."""
    names = parameters_of(fit)
    numbers: dict[str, object] = {}
    for field in dataclasses.fields(fit):
        if field.name in names:
            shown = "A0" if field.name == "initial_area" else field.name
            facts = (*fit.known(field.name), *fit.interval(field.name))
            scales = {"_per_efold": 1.0, "_per_decade": _PER_DECADE} if field.name in _SLOPES else {"": 1.0}
            for suffix, factor in scales.items():
                value, stderr, *ends = (factor * fact for fact in facts)
                numbers[shown + suffix] = {"value": value, "stderr": stderr, "interval": ends}
        elif field.name.removesuffix("_stderr") not in names:
            numbers[field.name] = getattr(fit, field.name)
    return numbers
