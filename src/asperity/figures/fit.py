"""Measured growth against hold time: the data, the laws fitted to them, and the residuals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from asperity.base import checks
from asperity.base.words import thousands, uncertain
from asperity.figures import style
from asperity.fits import GrowthRate, LogarithmFit, MeasuredGrowth, SaturationFit
from asperity.fits.measured import Law
from asperity.fits.rows import UNDETERMINED, determined

_LINES: dict[Law, tuple[str, str, str]] = {
    "saturation": (style.BLUE, "-", "o"),
    "logarithm": (style.VERMILION, "--", "s"),
}

_BARS: dict[str, Any] = {"ecolor": style.GRAY, "elinewidth": 1.2, "capsize": 2.5}
"""How error bars look: their width, and half that of their ends, in points."""


@style.drawn
def fit_figure(growth: MeasuredGrowth, *, quantity: str, unit_time: str, window: bool) -> style.Drawing:
    """Draw data and laws, with their numbers in the legend, and a strip of residuals.

    Quantity and unit of time, which may be "", are names for the axes. With a window the straight line of
    `growth.rate` is drawn; where the times do not determine the laws it is drawn anyway.
    """
    checks.instance("growth", growth, MeasuredGrowth, "asperity.fits.measured_growth(...)")
    panels = _panels(growth, style.spelled(style.fitted(unit_time, 60)), window=window)
    figure, (upper, _) = style.figure_of(panels.values())
    upper.set_ylabel(style.verbatim(style.fitted(quantity, 140)))
    upper.get_legend().remove()  # type: ignore[union-attr]
    style.legend_below(figure, upper)
    upper.margins(x=0.03)
    return figure


def _panels(growth: MeasuredGrowth, unit: str = "", *, window: bool = False) -> dict[str, style.Panel]:
    along, rate = f"hold time $t$ [{unit or 'unit of the table'}]", growth.rate
    if not window and growth.initial_from:  # there are laws, and no straight line was asked for
        rate = None
    return {
        "growth": style.Panel(lambda axes: _draw_growth(axes, growth, rate, unit), along, 3.2),
        "residuals": style.Panel(lambda axes: _draw_residuals(axes, growth, rate), along),
    }


style.panels_of.register(MeasuredGrowth, _panels)


def _draw_growth(upper: Axes, growth: MeasuredGrowth, rate: GrowthRate | None, unit: str) -> None:
    """Draw data and laws, with their numbers in the legend."""
    upper.set_xscale("log")
    _draw_data(upper, growth)
    times = np.geomspace(growth.shown.x[0], growth.shown.x[-1], 200)
    for law, fit in growth.fits.items():
        color, dashes, _ = _LINES[law]
        label = _legend(law, fit, unit)
        upper.plot(times, fit.predict(times), dashes, color=color, linewidth=1.2, label=label)
    if rate is not None:
        slope, error = (math.log(10) * value for value in (rate.slope, rate.slope_stderr))
        label = f"straight line, {uncertain(slope, error)} per decade"
        ends = np.array([rate.first, rate.last])
        upper.plot(ends, rate.predict(ends), ":", color=style.INK, linewidth=1.2, label=label)


def _draw_data(axes: Axes, growth: MeasuredGrowth) -> None:
    label = f"means over bins of {thousands(growth.points)} values" if growth.shown_are_means else "data"
    shown, many = growth.shown, growth.shown.x.size >= 100
    look: dict[str, Any] = {"markersize": 3 if many else 4.5, "markerfacecolor": "white", **_BARS}
    look |= {"fmt": "o", "color": style.INK, "zorder": 1 if many else 4}
    axes.errorbar(shown.x, shown.y, shown.stderr, label=label, **look)
    if growth.initial_points and growth.rate is not None:
        initial = growth.rate.initial_area
        count = f", mean of {growth.initial_points}" if growth.initial_points > 1 else ""
        label = f"at time 0: {initial:.4g}{count}"
        axes.axhline(initial, color=style.GRAY, linestyle="-.", linewidth=1.2, label=label, zorder=0)


def _draw_residuals(axes: Axes, growth: MeasuredGrowth, rate: GrowthRate | None) -> None:
    axes.set_xscale("log")
    axes.axhline(0, color=style.INK, linewidth=0.8)
    shown = growth.shown
    strips = [(_LINES[law], fit.predict, shown) for law, fit in growth.fits.items()]
    if rate is not None:
        window = shown.where((shown.x >= rate.first) & (shown.x <= rate.last))
        strips.append(((style.INK, ":", "x"), rate.predict, window))
    reach = 1e-3  # an exact fit leaves rounding errors, which are no news
    for (color, _, marker), law, part in strips:
        residual = 100 * (part.y / law(part.x) - 1)
        error = np.zeros_like(part.y) if part.stderr is None else 100 * part.stderr / part.y
        bars = None if part.stderr is None else error
        look: dict[str, Any] = {"markerfacecolor": color if marker == "o" else "none", "markersize": 3.5}
        axes.errorbar(part.x, residual, bars, fmt=marker, color=color, **look, **_BARS)
        reach = max(reach, 1.15 * float(np.max(np.abs(residual) + error, initial=0)))
    axes.set(ylim=(-reach, reach), ylabel="data / fit − 1 [%]")


def _number(name: str, value: float, stderr: float, unit: str = "") -> str:
    if not determined(value, stderr):
        return f"{name} {UNDETERMINED}"
    return f"{name} = {uncertain(value, stderr)}{f' {unit}' if unit else ''}"


def _legend(law: Law, fit: SaturationFit | LogarithmFit, unit: str) -> str:
    numbers = [_number("$t_0$", fit.t0, fit.t0_stderr, unit)]
    if isinstance(fit, SaturationFit):
        formula = r"$A_0\,[a - (a-1)\,/\,(1+t/t_0)^q]$"
        shape = [rf"$a$ = {uncertain(fit.a, fit.a_stderr)}", rf"$q$ = {uncertain(fit.q, fit.q_stderr)}"]
        if not fit.q_stderr < fit.q / 2:
            shape = [_number(r"$(a-1)\,q$", fit.C, fit.C_stderr), r"($a$ and $q$ are not determined)"]
        numbers = shape + numbers
    else:
        formula = r"$A_0\,[1 + C\,\ln(1+t/t_0)]$"
        numbers = [_number("$C$", fit.C, fit.C_stderr), *numbers]
    return "\n   ".join([f"{law} {formula}", *numbers])
