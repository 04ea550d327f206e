"""Measured growth against hold time: the data, the laws fitted to them, and what the laws miss."""

from __future__ import annotations

import math

import numpy as np
from matplotlib import font_manager
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.analysis.measured_growth import Law, MeasuredGrowth
from asperity.figures import style
from asperity.fits import LogarithmFit, SaturationFit

_LINES: dict[Law, tuple[str, str, str]] = {
    "saturation": (style.BLUE, "-", "o"),
    "logarithm": (style.VERMILION, "--", "s"),
}


UNDETERMINED = "not determined by these times"


def determined(value: float, stderr: float) -> bool:
    """Whether a parameter is known better than to a factor of about two; an exact one is."""
    return stderr < abs(value)


def fit_figure(growth: MeasuredGrowth, *, title: str, quantity: str, unit_time: str, window: bool) -> Figure:
    """Draw data and laws, with their numbers in the legend, and a strip of residuals.

    Parameters
    ----------
    growth
        From `asperity.analysis.measured_growth`.
    title
        What the data are.
    quantity, unit_time
        Names for the axes; the unit may be "".
    window
        Whether to draw the straight line of `growth.rate`; where the times do not determine the laws
        it is drawn anyway.

    Returns
    -------
    Figure
    """
    figure = Figure(figsize=(6.8, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[3.2, 1])
    upper.set_xscale("log")
    _draw_data(upper, growth)
    unit = style.spelled(_drawable(unit_time, width=150))
    first = not growth.initial_from
    if first:
        _draw_line(upper, growth)
    for law, fit in growth.fits.items():
        color, dashes, _ = _LINES[law]
        label = _legend(law, fit, unit)
        upper.plot(growth.curve_time, growth.curves[law], dashes, color=color, linewidth=1.8, label=label)
    if window and not first:
        _draw_line(upper, growth)
    _draw_residuals(lower, growth)
    upper.set_ylabel(style.verbatim(_drawable(quantity, width=280)))
    lower.set_xlabel(f"hold time $t$ [{unit}]" if unit else "hold time $t$")
    for axes in (upper, lower):
        axes.grid(visible=True, which="major", color="0.9", linewidth=0.6)
    upper.margins(x=0.03)
    upper.set_title(style.verbatim(_drawable(title, width=400)), fontsize=10)
    upper.legend(loc="best", fontsize=8, framealpha=0.95)
    return figure


def _drawable(text: str, *, width: float) -> str:
    """Reduce a text from outside to what can be drawn: glyphs that the font has, and as many as fit.

    The width is in points (1/72 inch), at the font size of labels.
    """
    size = font_manager.FontProperties(size=10)
    font = font_manager.get_font(font_manager.findfont(size))
    known = "".join(c if font.get_char_index(ord(c)) else "?" for c in " ".join(text.split()))
    font.set_size(size.get_size_in_points(), 72)

    def wide(piece: str) -> bool:
        font.set_text(piece)
        return font.get_width_height()[0] / 64 > width

    if wide(known):
        while wide(f"{known}…"):
            known = known[:-1]
        known = f"{known.rstrip()}…"
    return known


def _draw_line(axes: Axes, growth: MeasuredGrowth) -> None:
    """Straight line; boldest where it is all that the data determine."""
    rate, per_decade = growth.rate, math.log(10)
    if rate is None:
        return
    slope = style.uncertain(rate.slope * per_decade, rate.slope_stderr * per_decade)
    axes.plot(
        growth.line_time,
        growth.line_value,
        ":" if growth.initial_from else "-",
        color=style.INK,
        linewidth=2.2 if growth.initial_from else 3,
        label=f"straight line, {slope} per decade",
    )


def _draw_data(axes: Axes, growth: MeasuredGrowth) -> None:
    label = f"means over bins of {style.count(growth.points)} values" if growth.shown_are_means else "data"
    axes.errorbar(
        growth.shown_time,
        growth.shown_value,
        yerr=growth.shown_stderr,
        fmt="o",
        color=style.INK,
        ecolor=style.GRAY,
        elinewidth=1,
        markersize=4.5 if growth.shown_time.size < 100 else 3,
        markerfacecolor="white",
        label=label,
        zorder=1 if growth.shown_time.size > 100 else 4,
    )
    if growth.initial_points and growth.rate is not None:
        initial = growth.rate.initial_area
        count = f", mean of {growth.initial_points}" if growth.initial_points > 1 else ""
        label = f"at time 0: {initial:.4g}{count}"
        axes.axhline(initial, color=style.GRAY, linestyle="-.", linewidth=1.2, label=label, zorder=0)


def _draw_residuals(axes: Axes, growth: MeasuredGrowth) -> None:
    axes.axhline(0, color=style.INK, linewidth=0.8)
    for law, residual in growth.residuals.items():
        color, _, marker = _LINES[law]
        axes.plot(
            growth.shown_time,
            100 * residual,
            marker,
            color=color,
            markersize=3.5,
            markerfacecolor=color if law == "saturation" else "none",
        )
    largest = max((float(np.abs(100 * residual).max()) for residual in growth.residuals.values()), default=0)
    # An exact fit leaves rounding errors, which are no news.
    reach = max(1.15 * largest, 1e-3)
    axes.set_ylim(-reach, reach)
    axes.set_ylabel("data / law − 1 [%]")


def _number(name: str, value: float, stderr: float, unit: str = "") -> str:
    if not determined(value, stderr):
        return f"{name} {UNDETERMINED}"
    return f"{name} = {style.uncertain(value, stderr)}{f' {unit}' if unit else ''}"


def _legend(law: Law, fit: SaturationFit | LogarithmFit, unit: str) -> str:
    numbers = [_number("$t_0$", fit.t0, fit.t0_stderr, unit)]
    if isinstance(fit, SaturationFit):
        formula = r"$A_0\,[a - (a-1)\,/\,(1+t/t_0)^q]$"
        shape = [
            rf"$a$ = {style.uncertain(fit.a, fit.a_stderr)}",
            rf"$q$ = {style.uncertain(fit.q, fit.q_stderr)}",
        ]
        if not fit.q_stderr < fit.q / 2:
            shape = [
                _number(r"$(a-1)\,q$", fit.C, fit.C_stderr),
                r"($a$ and $q$ are not determined)",
            ]
        numbers = shape + numbers
    else:
        formula = r"$A_0\,[1 + C\,\ln(1+t/t_0)]$"
        numbers = [_number("$C$", fit.C, fit.C_stderr), *numbers]
    return "\n   ".join([f"{law} {formula}", *numbers])
