"""Friction against slip, with both laws of the state, and static friction against hold time."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from asperity.base import checks
from asperity.base.readable import readable
from asperity.base.words import uncertain
from asperity.errors import InputError
from asperity.figures import style
from asperity.friction.comparing import StateLaws
from asperity.friction.laws import StateLaw
from asperity.friction.parameters import MachineFit

_LINES: dict[StateLaw, tuple[str, str]] = {"aging": (style.BLUE, "-"), "slip": (style.VERMILION, "--")}
_RINGS = {"markersize": 3.5, "markeredgewidth": 1, "markerfacecolor": "white"}
_FITTED = {
    "a": ("$a$", 0, style.BLUE, "o"),
    "b": ("$b$", 0, style.VERMILION, "s"),
    "a_minus_b": ("$a - b$", 1, style.INK, "o"),
    "D_c": ("$D_c$", 2, style.INK, "o"),
}
"""Parameters of events: sign, panel and look."""

_MANY = 400
"""Entries above which the record is drawn as dots without edges."""


@style.drawn
def rate_and_state_figure(found: StateLaws) -> style.Drawing:
    """Draw record, both laws, their residuals, and where there are holds, static friction after them."""
    checks.instance("found", found, StateLaws, "asperity.friction.compare_state_laws(records)")
    panels = style.panels_of(found)
    rows = [kind for kind in panels if kind != "healing"]
    figure = style.Drawing(figsize=(style.PAGE, 2.2 + 0.8 * len(rows)))
    heights, widths = [3.0, 1.0, 1.2][: len(rows)], [1.7, 1.0][: 1 + (len(panels) > len(rows))]
    grid = figure.add_gridspec(len(rows), len(widths), height_ratios=heights, width_ratios=widths)
    for row, (kind, panel) in enumerate(panels.items()):
        place = grid[:, 1] if kind == "healing" else grid[row, 0]
        axes = figure.add_subplot(place, sharex=figure.axes[0] if kind in rows[1:] else None)
        panel.draw(axes)
        style.finish(axes, legend=False)
        if kind in rows[:-1]:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel(panel.along)
    figure.axes[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.01), frameon=False)
    return figure


@style.drawn
def events_figure(table: pd.DataFrame) -> style.Drawing:
    """Draw a, b, a - b and D_c of each event against displacement, with their 95 % intervals.

    D_c is left out where it is not determined. `InputError` for a table without these columns.

    Parameters
    ----------
    table
        What `events_table` returned, or published fits with such columns: displacement, a, a_low, a_high ...
    """
    ends, unit = ("_m", "m") if "displacement_m" in table else ("", "length")
    names = [f"{n}{end}{ends * (n == 'D_c')}" for n in _FITTED for end in ("", "_low", "_high")]
    if missing := {f"displacement{ends}", *names} - set(table):
        expected, advice = "a table of events", "asperity.friction.events_table(fits, record)"
        raise InputError("table", expected=expected, got=f"none of {min(missing)}", advice=advice)
    if "determined" in table:
        known = table["determined"] == True  # noqa: E712, missing is no truth
        table = table.assign(**{name: table[name].where(known) for name in names if name.startswith("D_c")})
    figure, panels = style.stacked((style.COLUMN, 4.4), 1, 1, 1)
    places, lengths = table[f"displacement{ends}"], table[f"D_c{ends}"]
    along, scale = style.scaled("displacement of the load point", unit, float(places.max()))
    of_length, longer = style.scaled("$D_c$", unit, float(lengths.max()))
    for name, (sign, at, color, mark) in _FITTED.items():
        end, factor = (ends, longer) if name == "D_c" else ("", 1.0)
        middle, low, high = (factor * table[f"{name}{side}{end}"] for side in ("", "_low", "_high"))
        look: dict[str, Any] = {"color": color, "markersize": 3, "linewidth": 0.9, "label": sign}
        errors = np.array([middle - low, high - middle])
        panels[at].errorbar(scale * places, middle, errors, fmt=mark, **look)
        panels[at].set_ylabel(of_length if name == "D_c" else sign)
    panels[0].set_ylabel("$a$, $b$")
    panels[1].axhline(0, color=style.INK, linewidth=0.8)
    panels[2].set_ylim(bottom=0)
    panels[2].set_xlabel(along)
    panels[2].locator_params(axis="x", nbins=5)
    for axes in panels:
        style.finish(axes, legend=axes is panels[0])
    figure.align_ylabels(panels)
    return figure


@style.panels_of.register
def _(found: StateLaws) -> dict[str, style.Panel]:
    fit = found.fits[found.preferred]
    slip, quantity = found.record.displacement, "slip"
    draws = {"record": _draw_record, "residuals": _draw_residuals}
    if isinstance(fit, MachineFit):
        slip, quantity = fit.slip, "slip of the fit"
        draws["state"] = _draw_state
    unit = "m" if found.record.si else "length of the record"
    label, factor = style.scaled(quantity, unit, float(np.nanmax(slip)))
    drawn = {kind: partial(draw, laws=found, slip=factor * slip) for kind, draw in draws.items()}
    panels = {kind: style.Panel(draw, label) for kind, draw in drawn.items()}
    if found.peaks().duration.size > 1:
        held = f"hold time [{'s' if found.record.si else 'time of the record'}]"
        panels["healing"] = style.Panel(partial(_draw_peaks, laws=found), held)
    return panels


def _draw_state(axes: Axes, laws: StateLaws, slip: np.ndarray) -> None:
    for law, (color, dashes) in _LINES.items():
        fit = laws.fits[law]
        if isinstance(fit, MachineFit):
            axes.semilogy(slip, fit.state, dashes, color=color, linewidth=1.5)
    style.few_ticks(axes.yaxis)
    axes.set_ylabel(rf"state $\theta$ [{'s' if laws.record.si else 'time'}]")


def _draw_record(axes: Axes, laws: StateLaws, slip: np.ndarray) -> None:
    record, surfaces = laws.record, f", mean of {laws.runs} surfaces" if laws.runs > 1 else ""
    shown = laws.fits["aging"].used
    small = record.time.size > _MANY
    dots: dict[str, Any] = {"markersize": 2, "markeredgewidth": 0} if small else _RINGS
    axes.plot(slip[shown], record.friction[shown], "o", color=style.GRAY, label=f"record{surfaces}", **dots)
    for law, (color, dashes) in _LINES.items():
        friction = np.where(shown, laws.fits[law].predict(record), np.nan)
        axes.plot(slip, friction, dashes, color=color, linewidth=1.2, label=_legend(laws, law))
    axes.set_ylabel(r"friction coefficient $\mu$")


def _legend(laws: StateLaws, law: StateLaw) -> str:
    estimates = laws.estimates[law]
    unit, scale = readable("m", float(estimates["D_c"].value)) if laws.record.si else ("", 1.0)
    numbers = []
    length = f" {style.spelled(unit)}".rstrip()
    for name, factor, end in (("a", 1.0, ""), ("b", 1.0, ""), ("D_c", scale, length)):
        value, stderr = float(estimates[name].value), float(estimates[name].stderr)
        known = f"= {uncertain(factor * value, factor * stderr)}{end}"
        numbers.append(f"${name}$ {'not determined' if laws.is_open(law, name) else known}")
    mark = "  (preferred)" if laws.verdict == law else ""
    return f"{law} law{mark}\n   {', '.join(numbers)}"


def _draw_residuals(axes: Axes, laws: StateLaws, slip: np.ndarray) -> None:
    axes.axhline(0, color=style.INK, linewidth=0.8)
    look: dict[str, Any] = {"markersize": 2.5, "markerfacecolor": "none"}
    if laws.record.time.size > _MANY:
        look = {"markersize": 1.5, "markeredgewidth": 0, "alpha": 0.5}
    for (law, (color, _)), marker in zip(_LINES.items(), "os", strict=True):
        fit = laws.fits[law]
        axes.plot(slip[fit.used], fit.residual, marker, color=color, **look)
    axes.set_ylabel(r"$\mu$ − law")


def _draw_peaks(axes: Axes, laws: StateLaws) -> None:
    peaks = laws.peaks()
    look: dict[str, Any] = {"color": style.GRAY, "markerfacecolor": "white", "label": "record"}
    axes.semilogx(peaks.duration, peaks.peak - peaks.before, "o", **look)
    for law, (color, dashes) in _LINES.items():
        of_law = laws.peaks(law)
        order = np.argsort(of_law.duration)
        healed = (of_law.peak - of_law.before)[order]
        axes.plot(of_law.duration[order], healed, dashes, color=color, linewidth=1.5, label=f"{law} law")
    style.few_ticks(axes.xaxis)
    axes.set_ylabel("static friction − friction before the hold")
    axes.legend(loc="best")
