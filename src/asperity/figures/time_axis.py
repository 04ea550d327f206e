"""The time axis of a history: a column for each leg that lasts, over the time since its beginning.

The area grows like the logarithm of the time since the last switch. So columns are logarithmic for a hold,
linear for a ramp and for sliding. Many legs, or such that were recorded within a decade of time, share one
linear axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from asperity.analysis.legs import LegRow, numbers_of
from asperity.figures import style
from asperity.lattice import Field, Mask

_MOST_COLUMNS = 6
"""More legs that last share one axis."""

_WIDEST_LINEAR = 10.0
"""Ratio of the last to the first time in a hold from which on a linear axis shows too little."""

_FEWEST_DECADES, _RAMP_DECADES = 1.5, 2.0
"""Widths, in decades of the holds, of the columns of a short hold and of a ramp."""

GAP, _STRIP, _NARROWEST = 0.3, 0.3, 0.95
"""Widths in inches: between columns, from a switch to the first entry after it, of the narrowest column."""

BESIDE = 1.6
"""Width of the labels on both sides, inches."""


@dataclass(frozen=True)
class Column:
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
class TimeAxis:
    """Where the legs of a history and its entries are drawn."""

    table: list[LegRow]
    """All legs."""
    columns: list[Column]
    """One for each leg that lasts; none where one linear axis shows as much."""
    place: Field
    """Coordinates of the entries."""
    after: Mask
    """Whether an entry is the state just after a jump; the entry before it is the state just before."""
    start: Field
    """Where the column of an entry begins, if the entry before it is the state then; NaN otherwise."""

    def at(self, time: Field) -> Field:
        """Coordinates of other times, such as those of measurements."""
        place = np.array(time, dtype=np.float64)
        for column in self.columns:
            inside = (time >= column.row.begin) & (time <= column.row.end)
            place[inside] = column.place(time[inside] - column.row.begin)
        return place


def _columns_of(dataset: xr.Dataset, table: list[LegRow], width: float) -> list[Column]:
    """Lay columns out in a width in inches."""
    time, numbers = dataset["time"].values, numbers_of(dataset)
    lasting = [row for row in table if row.end > row.begin]
    firsts: list[float | None] = []
    decades = []
    for row in lasting:
        since = time[(numbers == row.number) & (time > row.begin)] - row.begin
        first = float(since[0]) if since.size > 1 else row.end - row.begin
        is_ramp = not row.leg.rests
        decades.append(_RAMP_DECADES if is_ramp else math.log10((row.end - row.begin) / first))
        firsts.append(None if is_ramp else min(first, (row.end - row.begin) / _WIDEST_LINEAR))
    recorded = [wide for wide, first in zip(decades, firsts, strict=True) if first is not None]
    if len(lasting) > _MOST_COLUMNS or max(recorded, default=0) < math.log10(_WIDEST_LINEAR):
        return []
    room = width - BESIDE - GAP * (len(lasting) - 1)
    share = np.maximum(decades, _FEWEST_DECADES)
    widths = np.maximum(share / share.sum() * room, _NARROWEST)
    widths *= room / widths.sum()
    right = np.cumsum(widths) + GAP * np.arange(len(lasting))
    return [
        Column(row, float(end - wide), float(end), first)
        for row, end, wide, first in zip(lasting, right, widths, firsts, strict=True)
    ]


def time_axis(dataset: xr.Dataset, table: list[LegRow], width: float) -> TimeAxis:
    """Find the places of legs and entries in a figure of this width in inches."""
    time, numbers = dataset["time"].values.astype(np.float64), numbers_of(dataset)
    columns = _columns_of(dataset, table, width)
    steps = np.array([row.leg.duration == 0 for row in table])
    after = steps[numbers] & (np.arange(time.size) > 0)
    place, start = time.copy(), np.full(time.size, np.nan)
    for row in table if columns else []:
        # The state after a jump is the beginning of the next column.
        column = next((c for c in columns if c.row.number >= row.number), None)
        entries = numbers == row.number
        if column is None:
            place[entries] = columns[-1].right
        elif column.row is row:
            place[entries] = column.place(time[entries] - row.begin)
            first = np.flatnonzero(entries)[:1]
            start[first[time[first - 1] == row.begin]] = column.left
        else:
            place[entries] = column.left
    return TimeAxis(table, columns, place, after, start)


def label_times(grid: Iterable[Axes], columns: list[Column]) -> None:
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
        every = min(math.ceil(0.4 / decade), max(high - low, 1))  # at least both ends
        ticks += [(float(column.place(10.0**n)), f"$10^{{{n}}}$") for n in range(low, high + 1, every)]
        fine = np.outer(10.0 ** np.arange(low - 1, high + 1), np.arange(1, 10)).ravel()
        fine = fine[(fine >= column.first) & (fine <= lasting)]
        minor += column.place(fine).tolist()
        breaks = column.left + _STRIP / 2 + np.array([-0.03, 0.03])
        mark: dict[str, Any] = {"ls": "none", "marker": [(-1, -2), (1, 2)], "ms": 8, "markeredgewidth": 0.8}
        mark |= {"transform": lowest.get_xaxis_transform(), "clip_on": False}
        lowest.plot(breaks, [0, 0], color=style.INK, **mark)
    for axes in grid:
        for before, after in pairwise(columns):
            axes.axvspan(before.right, after.left, color="0.93", linewidth=0, zorder=0)
    lowest.set_xticks(*zip(*ticks, strict=True))
    lowest.set_xticks(minor, minor=True)
    lowest.set_xlim(-0.1, columns[-1].right + 0.1)
