"""A history of load or separation above the contact area, leg by leg."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.analysis.legs import LegRow, leg_table, protocol_of
from asperity.errors import InputError
from asperity.figures import style
from asperity.figures.time_axis import BESIDE, GAP, TimeAxis, label_times, time_axis
from asperity.lattice import Field
from asperity.protocols import Say
from asperity.results.quantities import select

_MANY = 100
"""More entries have smaller markers."""

_ON_SITES = {
    "separation": "\n[height]",
    "load": "\n" r"[stiffness $\times$ height]",
    "area": " [sites]",
}
"""Unit on an axis where that is of sites."""

_EACH_LEG = "time since the beginning of each leg"


def history_figure(dataset: xr.Dataset) -> Figure:
    """Draw the load above the contact area; above both the separation, where a leg prescribes it.

    Parameters
    ----------
    dataset
        The dataset of a `History`, with a protocol or without.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        The history has no protocol and no time above 0.
    """
    table = leg_table(dataset)
    if not table:
        expected, advice = "a history with times above 0", "age(contact, times)"
        raise InputError("dataset", expected=expected, got="none", advice=advice)
    by_load = dataset.attrs["held"] == "load" and not any(row.leg.moves_the_body for row in table)
    names = ["load", "area"] if by_load else ["separation", "load", "area"]
    time = time_axis(dataset, table, _width)
    ratios = [2.0] * (len(names) - 1) + [3.0]
    figure, grid = style.stacked((_width(len(time.columns)), 1.6 + 0.8 * sum(ratios)), *ratios)
    figure.align_ylabels(grid)
    for axes, name in zip(grid, names, strict=True):
        per_site = _draw(axes, time, dataset, name)
    say = partial(style.said, dataset, digits=5)
    what = _EACH_LEG if len(time.columns) > 1 else "hold time $t$" if time.columns else "time $t$"
    grid[-1].set_xlabel(style.over_time(dataset, what))
    if time.columns:
        label_times(grid, time.columns)
        _head(grid[0], time, say, per_site)
        _mark_lowest(grid[-1], time, per_site)
    style.count_nominal_area(grid[-1], 100.0 / (dataset["heights"].size * per_site))
    for axes in grid:
        style.finish(axes, legend=axes is grid[-1], lines_along="y")
    title = ["Contact area in a history of " + (" and ".join(names[-2::-1]))]
    if not time.columns and (protocol := protocol_of(dataset)):
        title.append(style.verbatim(style.fitted(", ".join(leg.words(say) for leg in protocol), figure.room)))
    style.entitle(figure, "\n".join(title), style.conditions(dataset))
    return figure


def draw_legs(axes: Axes, dataset: xr.Dataset, name: str) -> Field:
    """Draw one series of a history with a protocol, leg by leg; return where its entries are on the axis."""
    width = axes.get_window_extent().width / axes.figure.dpi
    time = time_axis(dataset, leg_table(dataset), lambda _: width + BESIDE)
    factor = _draw(axes, time, dataset, name)
    if time.columns:
        label_times([axes], time.columns)
        _head(axes, time, partial(style.said, dataset, digits=5), factor)
    axes.set_xlabel(style.over_time(dataset, _EACH_LEG if time.columns else "time $t$"))
    return time.place


def shown_series(dataset: xr.Dataset, name: str) -> tuple[Field, str, float]:
    """Values as they are drawn, their label, and what one of the series (of the area: a site) is in them."""
    known = select().get(name)
    label = known.label if known else name.replace("_", " ")
    values = dataset[name].values.astype(np.float64)
    if not dataset.attrs.get("si"):
        continuum = "contact_area" in dataset and name != "area"
        return values, label if continuum else label + _ON_SITES.get(name, ""), 1.0
    unit, scale = str(dataset[name].attrs["units"]), 1.0
    if name == "area":
        unit = str(dataset["contact_area"].attrs["units"])
        scale = float(dataset["contact_area"][0]) / max(float(values[0]), 1.0)
    label, factor = style.scaled(label, unit, float(np.abs(values).max()) * scale)
    return values * (factor * scale), label, factor * scale


def _width(columns: int) -> float:
    """Width of the figure, inches."""
    return 6.4 + 0.9 * max(columns - 2, 0)


def _draw(axes: Axes, time: TimeAxis, dataset: xr.Dataset, name: str) -> float:
    """Draw one series: each entry once, and what joins them; what one of the series is in what is drawn."""
    values, label, factor = shown_series(dataset, name)
    axes.set_ylabel(label, multialignment="center")
    path, jumps = [], []
    gap, points = (math.nan, math.nan), list(zip(time.place, values, strict=True))
    for i, point in enumerate(points):
        if time.after[i]:
            jumps += [points[i - 1], point, gap]
            path.append(gap)
        elif math.isfinite(time.start[i]):
            path.append((time.start[i], points[i - 1][1]))
        path.append(point)
    axes.plot(*np.transpose(path), "-", color=style.BLUE, linewidth=1.0, zorder=3)
    wide = "contact_area" if name == "area" else name
    if f"{wide}_low" in dataset:
        low, high = (values * (dataset[f"{wide}_{end}"] / dataset[wide]).values for end in ("low", "high"))
        axes.fill_between(time.place, low, high, color=style.SKY, alpha=0.35, linewidth=0, label="95 % band")
    if jumps:
        axes.plot(*np.transpose(jumps), "--", color=style.GRAY, linewidth=1.2, zorder=3)
    size = 4.0 if values.size <= _MANY else 2.0
    common: dict[str, Any] = {"color": style.INK, "markersize": size, "zorder": 4, "clip_on": False}
    usual = ~time.after
    axes.plot(time.place[usual], values[usual], "o", markerfacecolor="white", **common)
    if time.after.any():
        places = time.place[time.after]
        axes.plot(places, values[time.after], "D", label="just after a jump", **common)
    axes.ticklabel_format(axis="y", useOffset=False)
    if np.ptp(values) <= 1e-6 * np.abs(values).max():
        axes.set_ylim(values[0] - 0.1 * abs(values[0] or 1), values[0] + 0.1 * abs(values[0] or 1))
    if values.min() >= 0:
        axes.set_ylim(bottom=max(axes.get_ylim()[0], 0.0))
    return factor


def _head(axes: Axes, time: TimeAxis, say: Say, per_site: float) -> None:
    """Say above each column what happens before it and in it, and above the last one what happens after."""
    table, columns = time.table, time.columns
    for number, column in enumerate(columns):
        earlier = columns[number - 1].row.number if number else -1
        parts = [jump(row, say) for row in table[earlier + 1 : column.row.number]]
        parts.append(column.row.leg.words(say))
        if _sinks(table, column.row):
            before, lowest = (per_site * area for area in (column.row.area[0], column.row.lowest_area))
            parts.append(
                f"area {before:.5g}\u00a0→\u00a0{lowest:.5g} at "
                f"{say('time', float(f'{column.row.lowest_after:.2g}'))}, then grows"
            )
        if column is columns[-1]:
            parts += [f"then {jump(row, say)}" for row in table[column.row.number + 1 :]]
        room = 72 * (column.right - column.left + GAP) - 6
        head = "\n".join(style.lines(part.split(" "), room, 8, between=" ") for part in parts)
        axes.text(column.left, 1.03, head, transform=axes.get_xaxis_transform(), fontsize=8, va="bottom")


def _sinks(table: list[LegRow], row: LegRow) -> bool:
    """Whether the area first falls in a hold after a jump, and then grows."""
    jumped = row.number > 0 and table[row.number - 1].leg.jumps
    return jumped and row.leg.rests and row.lowest_area < min(row.area)


def _mark_lowest(axes: Axes, time: TimeAxis, per_site: float) -> None:
    """Point at the lowest area after a jump: the fall before it may be a small part of the axis."""
    bottom, top = axes.get_ylim()
    for column in time.columns:
        if _sinks(time.table, column.row):
            lowest = column.row.lowest_area * per_site
            tip = float(column.place(column.row.lowest_after)), lowest
            tail = 0, 22 if lowest < bottom + 0.15 * (top - bottom) else -22
            arrow = {"arrowstyle": "->", "color": style.VERMILION, "shrinkA": 0, "shrinkB": 4}
            axes.annotate("", tip, tail, textcoords="offset points", arrowprops=arrow)


def jump(row: LegRow, say: Say) -> str:
    """Say what changes at once, from what to what."""
    if row.leg.speed:
        return row.leg.words(say)
    by_load = row.leg.jumps and row.leg.target in ("load", "pressure")
    name, ends = ("load", row.load) if by_load else ("separation", row.separation)
    before, after = (say(name, value).replace("-", "\u2212") for value in ends)
    return f"{name} {before}\u00a0→\u00a0{after}"
