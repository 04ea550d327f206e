"""The aging curve: contact area against the logarithm of the hold time, and the load where it changes."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

import xarray as xr
from matplotlib.axes import Axes

from asperity.analysis import AgingSummary
from asperity.analysis.field_values import cell_of, comparable_area
from asperity.base import checks
from asperity.base.words import power
from asperity.errors import InputError
from asperity.figures import style
from asperity.figures.measured import draw_measured
from asperity.fits import Measurements
from asperity.fits.measurements import measured_area
from asperity.lattice import Field
from asperity.results.history import check_dataset

_IN_SIGHT = 3.0
"""How far off the curve, in its own heights, the relaxed limit is still drawn."""


@style.drawn
def aging_curve(
    dataset: xr.Dataset, summary: AgingSummary, measured: Measurements | Path | str | None = None
) -> style.Drawing:
    """Draw A(t)/A(0), the saturation law, the dilute theory where it holds, and the relaxed limit.

    Where the separation is held, a second panel shows the load.

    Parameters
    ----------
    dataset
        The dataset of a `History`, for the conditions in the title.
    summary
        From `asperity.analysis.aging_summary` of it.
    measured
        A measured area against time, a table: drawn too, and below it the ratio to the computed one.

    Raises
    ------
    InputError
        The history holds no time above 0; or the measured quantity is not an area.
    """
    checks.instance("summary", summary, AgingSummary, "asperity.analysis.aging_summary(history.dataset)")
    check_dataset(dataset)
    if summary.time.size == 0:
        expected, advice = "a history with times above 0", "age(contact, times)"
        raise InputError("summary", expected=expected, got="none", advice=advice)
    falls = summary.load is not None and summary.initial_load > 0
    ratios = [3.0, *[1.0] * (measured is not None), *[1.5] * falls]
    figure, grid = style.stacked((style.COLUMN, 1.0 + 0.7 * sum(ratios)), *ratios)
    axes = grid[0]
    axes.set_xscale("log")
    _draw_computed(axes, summary.time, summary.area_ratio)
    _draw_law(axes, summary)
    _draw_theory(axes, summary)
    _draw_limit(axes, summary.area_ratio, summary.relaxed_ratio)
    axes.set_ylabel(r"contact area $A(t)\,/\,A(0)$")
    axes.margins(x=0.03)
    style.count_nominal_area(axes, 100.0 * summary.initial_area / summary.sites)
    if measured is not None:
        (computed, called), site = comparable_area(dataset), cell_of(dataset)
        measurements = measured_area(measured, site * summary.sites, si=dataset.attrs["si"])
        time, first = dataset["time"].values, site * summary.initial_area
        draw_measured(grid[:2], measurements, time, computed / first, 1 / first, called=called)
    if summary.load is not None and falls:
        ratio = summary.load / summary.initial_load
        _draw_computed(grid[-1], summary.time, ratio)
        _draw_limit(grid[-1], ratio, summary.relaxed_load and summary.relaxed_load / summary.initial_load)
        grid[-1].set_ylabel(r"load $F(t)\,/\,F(0)$")
    for panel in grid:
        style.finish(panel, legend=panel is not axes)
    style.legend_below(figure, axes)
    grid[-1].set_xlabel(style.over_time(dataset, "hold time $t$"))
    held = str(dataset.attrs["held"])
    held = f"{held} {style.said(dataset, held, float(dataset.attrs[f'held_{held}']))} held"
    style.entitle(figure, "Real contact area against hold time", style.conditions(dataset, held))
    return figure


def _draw_computed(axes: Axes, time: Field, ratio: Field) -> None:
    # Not clipped: the axis ends at full contact.
    style.curve(axes, time, ratio, "o", style.INK, "computed", markersize=4.5, zorder=4, clip_on=False)


def _draw_law(axes: Axes, summary: AgingSummary) -> None:
    fit = summary.fit
    if fit is None or summary.fit_curve is None:
        if summary.fit_note:
            axes.plot([], [], " ", label=_wrapped(summary.fit_note))
        return
    has_limit = summary.relaxed_ratio is not None
    numbers = [
        r"fit $a - (a-1)\,/\,(1+t/t_0)^q$",
        f"$a$ = {fit.a:.5g}, the relaxed limit" if has_limit else f"$a$ = {fit.a:.3g}, extrapolated",
        f"$q$ = {fit.q:.3g}, $t_0$ = {fit.t0:.3g}",
        f"misfit {100 * fit.rms_residual:.2g} % rms, {100 * summary.fit_worst:.2g} % at worst",
        *([_wrapped(summary.fit_note)] if summary.fit_note else []),
    ]
    look: dict[str, Any] = {"color": style.BLUE, "linewidth": 1.2, "label": "\n   ".join(numbers)}
    axes.plot(summary.curve_time, summary.fit_curve, "-", **look)


def _draw_limit(axes: Axes, ratio: Field, limit: float | None) -> None:
    """Draw the relaxed limit, unless it is so far off that the curve would be flat beside it."""
    if limit is None:
        return
    label = rf"relaxed limit $t \to \infty$: {limit:.5g}"
    low, high = float(ratio.min()), float(ratio.max())
    if min(abs(limit - low), abs(limit - high)) <= _IN_SIGHT * max(high - low, 0.05):
        axes.axhline(limit, color=style.GRAY, linestyle=":", linewidth=1.2, label=label, zorder=1)
    else:
        axes.plot([], [], " ", label=f"{label} (off the axis)")


def _draw_theory(axes: Axes, summary: AgingSummary) -> None:
    if summary.dilute_time.size == 0:
        return
    label = "dilute theory (no fit)"
    if summary.dilute_time[-1] < summary.curve_time[-1]:
        ends = power(float(f"{summary.dilute_time[-1]:.0e}"))
        label += f", while\ncontacts are far apart: $t$ < ${ends}$"
    look: dict[str, Any] = {"color": style.VERMILION, "linewidth": 1.2, "zorder": 3}
    axes.plot(summary.dilute_time, summary.dilute_ratio, "--", label=label, **look)


def _wrapped(text: str) -> str:
    """Break a long note for the legend."""
    return "\n   ".join(textwrap.wrap(text, 43, break_long_words=False, break_on_hyphens=False))
