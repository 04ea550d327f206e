"""A history of load or separation above the contact area, leg by leg."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from asperity.analysis.field_values import cell_of, comparable_area
from asperity.analysis.legs import LegRow, leg_table, protocol_of
from asperity.errors import InputError
from asperity.figures import style
from asperity.figures.measured import draw_measured
from asperity.figures.time_axis import BESIDE, GAP, TimeAxis, label_times, time_axis
from asperity.fits import Measurements
from asperity.fits.measurements import measured_area
from asperity.lattice import Field
from asperity.protocols.legs import Say
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


@style.drawn
def history_figure(dataset: xr.Dataset, measured: Measurements | Path | str | None = None) -> style.Drawing:
    """Draw the load above the contact area; above both the separation, where a leg prescribes it.

    Parameters
    ----------
    dataset
        The dataset of a `History`, with a protocol or without.
    measured
        A measured area against time, a table: drawn too, and below it the ratio to the computed one.

    Raises
    ------
    InputError
        The history has no protocol and no time above 0; or the measured quantity is not an area.
    """
    table = leg_table(dataset)
    if not table:
        expected, advice = "a history with times above 0", "age(contact, times)"
        raise InputError("dataset", expected=expected, got="none", advice=advice)
    by_load = dataset.attrs["held"] == "load" and not any(row.leg.moves_the_body for row in table)
    names = ["load", "area"] if by_load else ["separation", "load", "area"]
    time = time_axis(dataset, table, style.PAGE)
    last = len(names) - 1
    ratios = [2.0] * last + [3.0] + [1.5] * (measured is not None)
    figure, grid = style.stacked((style.PAGE, 1.4 + 0.55 * sum(ratios)), *ratios)
    for axes, name in zip(grid, names, strict=False):
        per_site = _draw(axes, time, dataset, name)
    head(grid, time, dataset, per_site)
    if time.columns:
        _mark_lowest(grid[last], time, per_site)
    figure.table = series_table(dataset, names)
    if measured is not None:
        times, site = dataset["time"].values, cell_of(dataset)
        measurements = measured_area(measured, site * dataset.attrs["sites"], si=dataset.attrs["si"])
        (computed, called), factor = comparable_area(dataset), per_site / site
        figure.table |= draw_measured(
            grid[last:], measurements, times, factor * computed, factor, time.at, called=called
        )
    style.count_nominal_area(grid[last], 100.0 / (dataset.attrs["sites"] * per_site))
    for axes in grid:
        style.finish(axes, legend=axes is grid[last], lines_along="y")
    title = ["Contact area in a history of " + (" and ".join(names[-2::-1]))]
    if not time.columns and (protocol := protocol_of(dataset)):
        say = partial(style.said, dataset, digits=5)
        title.append(style.verbatim(style.fitted(", ".join(leg.words(say) for leg in protocol), figure.room)))
    style.entitle(figure, "\n".join(title), style.conditions(dataset))
    return figure


def draw_legs(axes: Axes, dataset: xr.Dataset, name: str) -> Field:
    """Draw one series of a history with a protocol, leg by leg; return where its entries are on the axis."""
    width = axes.get_window_extent().width / axes.figure.dpi
    time = time_axis(dataset, leg_table(dataset), width + BESIDE)
    factor = _draw(axes, time, dataset, name)
    head([axes], time, dataset, factor)
    return time.place


def head(grid: list[Axes], time: TimeAxis, dataset: xr.Dataset, per_site: float | None = None) -> None:
    """Label the times below panels, and the legs above; with the area of a site also the lowest area."""
    along = _EACH_LEG if len(time.columns) > 1 else "hold time $t$" if time.columns else "time $t$"
    grid[-1].set_xlabel(style.over_time(dataset, along))
    if time.columns:
        label_times(grid, time.columns)
        _head(grid[0], time, partial(style.said, dataset, digits=5), per_site)


def series_table(dataset: xr.Dataset, names: Iterable[str]) -> dict[str, object]:
    """Series over time, and the number of the leg, as columns with their units."""
    unit = str(dataset["time"].attrs.get("units", ""))
    columns: dict[str, object] = {"time [s]" if unit == "s" else "time": dataset["time"].values}
    if "leg" in dataset.coords:
        columns["leg"] = dataset["leg"].values
    for name in names:
        values, label, _ = shown_series(dataset, name)
        columns[label] = values
        for end, ratio in _ends(dataset, name).items():
            columns[re.sub(r"( \[|$)", rf" {end}\1", label, count=1)] = values * ratio
    return columns


def _ends(dataset: xr.Dataset, name: str) -> dict[str, Field]:
    """Ends of the 95 % band over the series, by name; empty without a band. Sites have that of the area."""
    band = "contact_area" if name == "area" else name
    parts = {end: f"{band}_{end}" for end in ("low", "high")}
    return {end: (dataset[part] / dataset[band]).values for end, part in parts.items() if part in dataset}


def shown_series(dataset: xr.Dataset, name: str) -> tuple[Field, str, float]:
    """Values as they are drawn, NaN where there are none, their label, and the factor from the series.

    The factor of the area is from sites.
    """
    quantity = select().get(name)
    label = quantity.label if quantity else name.replace("_", " ")
    values = dataset[name].values.astype(np.float64)
    values[~np.isfinite(values)] = math.nan
    if not dataset.attrs.get("si"):
        continuum = "contact_area" in dataset and name != "area"
        return values, label if continuum else label + _ON_SITES.get(name, ""), 1.0
    unit, scale = str(dataset[name].attrs["units"]), 1.0
    if name == "area":
        unit, scale = str(dataset["contact_area"].attrs["units"]), cell_of(dataset)
    label, factor = style.scaled(label, unit, float(np.nanmax(np.abs(values), initial=0.0)) * scale)
    return values * (factor * scale), label, factor * scale


def _draw(axes: Axes, time: TimeAxis, dataset: xr.Dataset, name: str) -> float:
    """Draw one series with its band; return the factor from its values to the drawn ones."""
    values, label, factor = shown_series(dataset, name)
    axes.set_ylabel(label, multialignment="center")
    shade(axes, time, dataset, name, values)
    join(axes, time, values)
    return factor


def shade(
    axes: Axes, time: TimeAxis, dataset: xr.Dataset, name: str, values: Field, color: str = style.SKY
) -> None:
    """Shade the 95 % band of a series as it is drawn, leg by leg; nothing where it has none."""
    ends = [values * ratio for ratio in _ends(dataset, name).values()]
    if not ends or np.isnan(ends[0]).all():
        return
    low, high = ends
    for part in np.split(np.arange(values.size), np.flatnonzero(time.after)):
        label = "" if part[0] else "95 % band"  # each name once
        style.band(axes, time.place[part], low[part], high[part], color, label)


def join(
    axes: Axes, time: TimeAxis, values: Field, color: str = style.BLUE, look: str = "o", label: str = ""
) -> None:
    """Draw each entry of a series once, and lines between them; a jump is dashed."""
    points, after = np.stack([time.place, values]), time.after
    begins = np.flatnonzero(after | np.isfinite(time.start))  # of lines: after a gap, or at a switch
    starts = time.start[begins], np.where(after[begins], math.nan, values[begins - 1])
    axes.plot(*np.insert(points, begins, starts, axis=1), "-", color=color, linewidth=1.0, zorder=3)
    sides = points[:, np.flatnonzero(after)[:, np.newaxis] + [-1, 0]]
    jumps = np.pad(sides, ((0, 0), (0, 0), (0, 1)), constant_values=math.nan).reshape(2, -1)
    axes.plot(*jumps, "--", color=style.GRAY, linewidth=1.2, zorder=3)
    mark = style.INK if color == style.BLUE else color
    common: dict[str, Any] = {"color": mark, "markersize": 4.0 if values.size <= _MANY else 2.0}
    common |= {"zorder": 4, "clip_on": False}
    axes.plot(*points[:, ~after], look, markerfacecolor="white", label=label or None, **common)
    if after.any():
        axes.plot(*points[:, after], "D", label=None if label else "just after a jump", **common)
    values = values[np.isfinite(values)]
    axes.ticklabel_format(axis="y", useOffset=False)
    if not values.size:
        return
    if np.ptp(values) <= 1e-6 * np.abs(values).max():
        axes.set_ylim(values[0] - 0.1 * abs(values[0] or 1), values[0] + 0.1 * abs(values[0] or 1))
    if values.min() >= 0:
        axes.set_ylim(bottom=max(axes.get_ylim()[0], 0.0))


def _head(axes: Axes, time: TimeAxis, say: Say, per_site: float | None) -> None:
    """Write above each column the legs before and in it, and above the last one those after it."""
    table, columns = time.table, time.columns
    for number, column in enumerate(columns):
        earlier = columns[number - 1].row.number if number else -1
        parts = [jump(row, say) for row in table[earlier + 1 : column.row.number]]
        parts.append(column.row.leg.words(say))
        if per_site is not None and _sinks(table, column.row):
            before, lowest = (per_site * area for area in (column.row.area[0], column.row.lowest_area))
            after = say("time", float(f"{column.row.lowest_after:.2g}"))
            parts.append(f"area {before:.5g} →\u00a0{lowest:.5g} at {after}, then grows")
        if column is columns[-1]:
            parts += [f"then {jump(row, say)}" for row in table[column.row.number + 1 :]]
        room = 72 * (column.right - column.left + GAP) - 6
        head = "\n".join(style.lines(part.split(" "), room, style.SMALL, between=" ") for part in parts)
        axes.text(
            column.left, 1.03, head, transform=axes.get_xaxis_transform(), fontsize=style.SMALL, va="bottom"
        )


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
    """Say which quantity jumps, from which value to which."""
    if row.leg.speed:
        return row.leg.words(say)
    by_load = row.leg.jumps and row.leg.target in ("load", "pressure")
    name, ends = ("load", row.load) if by_load else ("separation", row.separation)
    before, after = (say(name, value).replace("-", "\u2212") for value in ends)
    return f"{name} {before} →\u00a0{after}"
