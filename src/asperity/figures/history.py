"""A history of load or separation above the contact area, leg by leg.

The area grows like the logarithm of the time since the last switch. So every leg that lasts has a column of
its own, over the time since its beginning: logarithmic for a hold, linear for a ramp and for sliding. Many
legs, or such that were recorded within a decade of time, share one linear axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from asperity.analysis.legs import LegRow, leg_table, numbers_of, protocol_of
from asperity.analysis.scan import readable
from asperity.errors import InputError
from asperity.figures import style
from asperity.lattice import Field, Mask
from asperity.protocols import Hold, Leg, Ramp, Repeat, Slide, Step

_MOST_COLUMNS = 6
"""More legs that last share one axis."""

_WIDEST_LINEAR = 10.0
"""Ratio of the last to the first time in a hold from which on a linear axis shows too little."""

_FEWEST_DECADES, _RAMP_DECADES = 1.5, 2.0
"""Widths, in decades of the holds, of the columns of a short hold and of a ramp."""

_GAP, _STRIP, _NARROWEST = 0.3, 0.3, 0.95
"""Widths in inches: between columns, from a switch to the first entry after it, of the narrowest column."""

_BESIDE = 1.6
"""Width of the labels on both sides, inches."""

_MANY = 100
"""More entries have smaller markers."""

_LABELS = {
    "separation": ("separation", "\n[height]"),
    "load": ("load", "\n" r"[stiffness $\times$ height]"),
    "area": ("contact area", " [sites]"),
}
"""What an axis shows, and its unit where that is of sites."""

_Say = Callable[[str, float], str]
"""Writes a value of a series."""


@dataclass(frozen=True)
class _Column:
    """Place of one leg on the time axis: its ends, in inches, and the first time on a logarithmic axis."""

    row: LegRow
    left: float
    right: float
    first: float | None

    def place(self, since: float | Field) -> Field:
        """Coordinates of times since the beginning of the leg."""
        since, lasting = np.asarray(since, dtype=np.float64), self.row.end - self.row.begin
        if self.first is None:
            return self.left + (self.right - self.left) * since / lasting
        share = np.log(np.maximum(since, self.first) / self.first) / math.log(lasting / self.first)
        inside = self.left + _STRIP + (self.right - self.left - _STRIP) * share
        return np.where(since > 0, inside, self.left)


@dataclass(frozen=True, eq=False)
class _Entries:
    """Where the entries of a history are drawn.

    Attributes
    ----------
    place
        Their coordinates on the time axis.
    after
        Whether an entry is the state just after a jump; the entry before it is the state just before.
    start
        Where the column of an entry begins, if the entry before it, which ends the column before, is the
        state at that moment; NaN otherwise.
    """

    place: Field
    after: Mask
    start: Field


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
        raise InputError(
            "dataset", expected="a history with times above 0", got="none", advice="age(contact, times)"
        )
    names = ["load", "area"] if _only_load(dataset, table) else ["separation", "load", "area"]
    columns = _columns(dataset, table, _width)
    ratios = [2.0] * (len(names) - 1) + [3.0]
    size = (_width(len(columns)), 1.6 + 0.8 * sum(ratios))
    figure = style.Drawing(figsize=size, layout="constrained")
    grid = figure.subplots(len(names), 1, sharex=True, height_ratios=ratios)
    entries = _entries(dataset, table, columns)
    figure.align_ylabels(grid)
    per_site = 1.0
    for axes, name in zip(grid, names, strict=True):
        values, label, factor = shown_series(dataset, name)
        _draw(axes, entries, values)
        axes.set_ylabel(label, multialignment="center")
        per_site = factor
    say = partial(style.said, dataset, digits=5)
    if columns:
        _divide(grid, columns)
        what = "hold time $t$" if len(columns) == 1 else "time since the beginning of each leg"
        grid[-1].set_xlabel(style.over_time(dataset, what))
        _head(grid[0], table, columns, say, per_site)
        _mark_lowest(grid[-1], table, columns, per_site)
    else:
        grid[-1].set_xlabel(style.over_time(dataset, "time $t$"))
    style.count_nominal_area(grid[-1], 100.0 / (dataset["heights"].size * per_site))
    if entries.after.any():
        grid[-1].legend(loc="best", fontsize=8, framealpha=0.95)
    title = ["Contact area in a history of " + (" and ".join(names[-2::-1]))]
    if not columns and (protocol := protocol_of(dataset)):
        title.append(style.verbatim(style.fitted(_listed(protocol, say), figure.room)))
    first = f"load {style.said(dataset, 'load', float(dataset['load'].values[0]))} at first"
    title.append(style.lines(style.conditions(dataset, first), figure.room))
    figure.suptitle("\n".join(title), fontsize=10)
    return figure


def draw_legs(axes: Axes, dataset: xr.Dataset, name: str) -> Field:
    """Draw one series of a history with a protocol, leg by leg; return where its entries are on the axis."""
    table = leg_table(dataset)
    width = axes.get_window_extent().width / axes.get_figure(root=True).dpi  # type: ignore[union-attr]
    columns = _columns(dataset, table, lambda _: width + _BESIDE)
    entries = _entries(dataset, table, columns)
    values, label, factor = shown_series(dataset, name)
    _draw(axes, entries, values)
    axes.set_ylabel(label, multialignment="center")
    if columns:
        _divide([axes], columns)
        _head(axes, table, columns, partial(style.said, dataset, digits=5), factor)
    axes.set_xlabel(
        style.over_time(dataset, "time since the beginning of each leg" if columns else "time $t$")
    )
    return entries.place


def shown_series(dataset: xr.Dataset, name: str) -> tuple[Field, str, float]:
    """Values as they are drawn, their label, and what one of the series (of the area: a site) is in them."""
    label, own = _LABELS.get(name, (name.replace("_", " "), ""))
    values = dataset[name].values.astype(np.float64)
    if not dataset.attrs.get("si"):
        continuum = "contact_area" in dataset and name != "area"
        return values, label if continuum else label + own, 1.0
    unit, scale = str(dataset[name].attrs["units"]), 1.0
    if name == "area":
        unit = str(dataset["contact_area"].attrs["units"])
        scale = float(dataset["contact_area"][0]) / max(float(values[0]), 1.0)
    shown, factor = readable(unit, float(np.abs(values).max()) * scale)
    factor *= scale
    return values * factor, style.with_unit(label, shown), factor


def _only_load(dataset: xr.Dataset, table: list[LegRow]) -> bool:
    """Whether no leg prescribes a separation."""
    holds = [row.leg.hold for row in table if isinstance(row.leg, Hold)]
    others = [row.leg for row in table if isinstance(row.leg, Ramp | Step)]
    return dataset.attrs["held"] == "load" and not (
        "separation" in holds or any(leg.target in ("separation", "approach") for leg in others)
    )


def _width(columns: int) -> float:
    """Width of the figure, inches."""
    return 6.4 + 0.9 * max(columns - 2, 0)


def _columns(dataset: xr.Dataset, table: list[LegRow], width: Callable[[int], float]) -> list[_Column]:
    """Lay columns out in the width that so many of them have; none where one linear axis shows as much."""
    time, numbers = dataset["time"].values, numbers_of(dataset)
    lasting = [row for row in table if row.end > row.begin]
    firsts: list[float | None] = []
    decades = []
    for row in lasting:
        since = time[(numbers == row.number) & (time > row.begin)] - row.begin
        first = float(since[0]) if since.size > 1 else row.end - row.begin
        is_ramp = isinstance(row.leg, Ramp | Slide)
        decades.append(_RAMP_DECADES if is_ramp else math.log10((row.end - row.begin) / first))
        firsts.append(None if is_ramp else min(first, (row.end - row.begin) / _WIDEST_LINEAR))
    recorded = [wide for wide, first in zip(decades, firsts, strict=True) if first is not None]
    if len(lasting) > _MOST_COLUMNS or max(recorded, default=0) < math.log10(_WIDEST_LINEAR):
        return []
    room = width(len(lasting)) - _BESIDE - _GAP * (len(lasting) - 1)
    share = np.maximum(decades, _FEWEST_DECADES)
    widths = np.maximum(share / share.sum() * room, _NARROWEST)
    widths *= room / widths.sum()
    right = np.cumsum(widths) + _GAP * np.arange(len(lasting))
    return [
        _Column(row, float(end - wide), float(end), first)
        for row, end, wide, first in zip(lasting, right, widths, firsts, strict=True)
    ]


def _entries(dataset: xr.Dataset, table: list[LegRow], columns: list[_Column]) -> _Entries:
    """Find the places of all entries."""
    time, numbers = dataset["time"].values.astype(np.float64), numbers_of(dataset)
    steps = np.array([row.leg.duration == 0 for row in table])
    after = steps[numbers] & (np.arange(time.size) > 0)
    place, start = time.copy(), np.full(time.size, np.nan)
    for row in table if columns else []:
        # The state after a jump is the beginning of the next column.
        column = next((c for c in columns if c.row.number >= row.number), None)
        here = numbers == row.number
        if column is None:
            place[here] = columns[-1].right
        elif column.row is row:
            place[here] = column.place(time[here] - row.begin)
            first = np.flatnonzero(here)[:1]
            start[first[time[first - 1] == row.begin]] = column.left
        else:
            place[here] = column.left
    return _Entries(place, after, start)


def _draw(axes: Axes, entries: _Entries, values: Field) -> None:
    """Draw one series: each entry once, and what joins them."""
    path: list[tuple[float, float]] = []
    jumps: list[tuple[float, float]] = []
    points = list(zip(entries.place.tolist(), values.tolist(), strict=True))
    for i, point in enumerate(points):
        if entries.after[i]:
            jumps += [points[i - 1], point, (math.nan, math.nan)]
            path.append((math.nan, math.nan))
        elif math.isfinite(entries.start[i]):
            path.append((float(entries.start[i]), points[i - 1][1]))
        path.append(point)
    axes.plot(*np.transpose(path), "-", color=style.BLUE, linewidth=1.0, zorder=3)
    if jumps:
        axes.plot(*np.transpose(jumps), "--", color=style.GRAY, linewidth=1.2, zorder=3)
    size = 4.0 if values.size <= _MANY else 2.0
    common: dict[str, Any] = {"color": style.INK, "markersize": size, "zorder": 4, "clip_on": False}
    usual = ~entries.after
    axes.plot(entries.place[usual], values[usual], "o", markerfacecolor="white", **common)
    if entries.after.any():
        places = entries.place[entries.after]
        axes.plot(places, values[entries.after], "D", label="just after a jump", **common)
    axes.grid(visible=True, axis="y", color="0.9", linewidth=0.6)
    axes.ticklabel_format(axis="y", useOffset=False)
    if np.ptp(values) <= 1e-6 * np.abs(values).max():
        axes.set_ylim(values[0] - 0.1 * abs(values[0] or 1), values[0] + 0.1 * abs(values[0] or 1))
    if values.min() >= 0:
        axes.set_ylim(bottom=max(axes.get_ylim()[0], 0.0))


def _divide(grid: Iterable[Axes], columns: list[_Column]) -> None:
    """Label the times of each column, and shade what lies between them."""
    lowest = list(grid)[-1]
    ticks: list[tuple[float, str]] = []
    minor: list[float] = []
    for column in columns:
        lasting = column.row.end - column.row.begin
        ticks.append((column.left, "0"))
        if column.first is None:
            times = MaxNLocator(nbins=2, steps=[1, 2, 5, 10]).tick_values(0, lasting)
            ticks += [(float(column.place(t)), f"{t:g}") for t in times if 0 < t <= lasting]
            continue
        low, high = math.ceil(math.log10(column.first) - 1e-9), math.floor(math.log10(lasting) + 1e-9)
        decade = (column.right - column.left - _STRIP) / math.log10(lasting / column.first)
        every = math.ceil(0.4 / decade)
        ticks += [(float(column.place(10.0**n)), f"$10^{{{n}}}$") for n in range(low, high + 1, every)]
        fine = np.outer(10.0 ** np.arange(low - 1, high + 1), np.arange(1, 10)).ravel()
        fine = fine[(fine >= column.first) & (fine <= lasting)]
        minor += column.place(fine).tolist()
        breaks = column.left + _STRIP / 2 + np.array([-0.03, 0.03])
        lowest.plot(
            breaks,
            [0, 0],
            linestyle="none",
            marker=[(-1, -2), (1, 2)],
            markersize=8,
            color=style.INK,
            markeredgewidth=0.8,
            transform=lowest.get_xaxis_transform(),
            clip_on=False,
        )
    for axes in grid:
        for left, right in pairwise(columns):
            axes.axvspan(left.right, right.left, color="0.93", linewidth=0, zorder=0)
    lowest.set_xticks(*zip(*ticks, strict=True))
    lowest.set_xticks(minor, minor=True)
    lowest.set_xlim(-0.1, columns[-1].right + 0.1)


def _head(axes: Axes, table: list[LegRow], columns: list[_Column], say: _Say, per_site: float) -> None:
    """Say above each column what happens before it and in it, and above the last one what happens after."""
    said: list[str] = []
    for number, column in enumerate(columns):
        earlier = columns[number - 1].row.number if number else -1
        said = [_jump(row, say) for row in table[earlier + 1 : column.row.number]]
        said.append(_said(column.row.leg, say))
        if _sinks(table, column.row):
            before, lowest = (per_site * area for area in (column.row.area[0], column.row.lowest_area))
            said.append(
                f"area {before:.5g}\u00a0→\u00a0{lowest:.5g} at "
                f"{say('time', float(f'{column.row.lowest_after:.2g}'))}, then grows"
            )
        if column is columns[-1]:
            said += [f"then {_jump(row, say)}" for row in table[column.row.number + 1 :]]
        room = 72 * (column.right - column.left + _GAP) - 6
        axes.text(
            column.left,
            1.03,
            "\n".join(style.lines(part.split(" "), room, 8, between=" ") for part in said),
            transform=axes.get_xaxis_transform(),
            fontsize=8,
            verticalalignment="bottom",
        )


def _sinks(table: list[LegRow], row: LegRow) -> bool:
    """Whether the area first falls in a hold after a jump, and then grows."""
    jumped = row.number > 0 and isinstance(table[row.number - 1].leg, Step)
    return jumped and isinstance(row.leg, Hold) and row.lowest_area < min(row.area)


def _mark_lowest(axes: Axes, table: list[LegRow], columns: list[_Column], per_site: float) -> None:
    """Point at the lowest area after a jump: the fall before it may be a small part of the axis."""
    bottom, top = axes.get_ylim()
    for column in columns:
        if _sinks(table, column.row):
            lowest = column.row.lowest_area * per_site
            axes.annotate(
                "",
                xy=(float(column.place(column.row.lowest_after)), lowest),
                xytext=(0, 22 if lowest < bottom + 0.15 * (top - bottom) else -22),
                textcoords="offset points",
                arrowprops={"arrowstyle": "->", "color": style.VERMILION, "shrinkA": 0, "shrinkB": 4},
            )


def _listed(protocol: Iterable[Leg], say: _Say) -> str:
    return ", ".join(_said(leg, say) for leg in protocol)


def _said(leg: Leg, say: _Say) -> str:
    """Say what a leg does."""
    if isinstance(leg, Repeat):
        return f"{leg.count} × ({_listed(leg.legs, say)})"
    if isinstance(leg, Step):
        return f"step to {_target(leg, say)}"
    if isinstance(leg, Slide):
        far = say("displacement", leg.distance)
        return f"slide {far} at " + (say("velocity", leg.velocity) if leg.duration else "once")
    assert isinstance(leg, Hold | Ramp)
    what = f"ramp to {_target(leg, say)} in" if isinstance(leg, Ramp) else "hold for"
    if isinstance(leg, Hold) and leg.hold:
        what = f"hold {leg.hold} for"
    faster = f", mobility\u00a0×\u00a0{leg.mobility:.5g}" if leg.mobility != 1 else ""
    return f"{what} {say('time', leg.duration)}{faster}"


def _target(leg: Ramp | Step, say: _Say) -> str:
    quantity = "mean_contact_pressure" if leg.target == "pressure" else leg.target
    return f"{leg.target} {_signed(getattr(leg, leg.target), quantity, say)}"


def _jump(row: LegRow, say: _Say) -> str:
    """Say what changes at once, from what to what."""
    if isinstance(row.leg, Slide):
        return _said(row.leg, say)
    by_load = isinstance(row.leg, Step) and row.leg.target in ("load", "pressure")
    name, (before, after) = ("load", row.load) if by_load else ("separation", row.separation)
    return f"{name} {_signed(before, name, say)}\u00a0→\u00a0{_signed(after, name, say)}"


def _signed(value: float, name: str, say: _Say) -> str:
    return say(name, value).replace("-", "\u2212")
