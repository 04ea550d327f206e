"""Friction, or the contact area, against the length that the rough surface has slid."""

from __future__ import annotations

import numpy as np
import xarray as xr

from asperity.analysis.legs import leg_table, numbers_of
from asperity.errors import InputError
from asperity.figures import style
from asperity.figures.history import shown_series
from asperity.results.history import check_dataset

_COLORS = (style.BLUE, style.VERMILION, style.GRAY)

_SHADE = "from just after a shift (shade) to\njust before the next (line)"
_NARROWEST = 1e-3
"""Least height of the axis, of the largest value."""


@style.drawn
def sliding_figure(dataset: xr.Dataset) -> style.Drawing:
    """Draw friction (`asperity.friction.add_friction`) against displacement; without it, the contact area.

    The surface moves by whole shifts, and between two of them the contact grows. A line joins the states just
    before each shift, a shade reaches down to those just after it. What happens at rest is a vertical line.
    `InputError` for a history that does not slide.
    """
    check_dataset(dataset)
    if "displacement" not in dataset:
        expected, got = "a history that slides", "one that does not"
        raise InputError("dataset", expected=expected, got=got, advice="a protocol with a Slide")
    name = "friction" if "friction" in dataset else "area"
    values, quantity, per_site = shown_series(dataset, name)
    way = dataset["displacement"].values
    unit = str(dataset["displacement"].attrs["units"])
    label, factor = style.scaled("displacement", unit, float(way.max()))
    way = factor * way
    figure, (axes,) = style.stacked((style.COLUMN, 2.6), 1)
    numbers = numbers_of(dataset)
    shaded = False
    speeds: dict[float, str] = {}
    for row in leg_table(dataset):
        entries = np.flatnonzero(numbers == row.number)
        entries = np.insert(entries, 0, entries[:1] - 1) if entries.size and entries[0] > 0 else entries
        speed, words = row.leg.speed, "slides at once" if row.leg.speed else "at rest"
        if speed and row.leg.duration:
            words = f"slides at {style.said(dataset, 'velocity', speed)}"
        named = None if words in axes.get_legend_handles_labels()[1] else words
        if not speed:
            axes.plot(way[entries], values[entries], "o-", color=style.INK, markersize=3, label=named)
            continue
        color = speeds.setdefault(speed, _COLORS[len(speeds) % len(_COLORS)])
        place, first = np.unique(way[entries], return_index=True)
        after, before = values[entries[first]], values[entries[np.append(first[1:], entries.size) - 1]]
        style.curve(axes, place, before, "o-", color, named, linewidth=1.5, markersize=3)
        axes.fill_between(place, after, before, color=color, alpha=0.2, linewidth=0)
        shaded |= bool((after != before).any())
    if shaded:
        axes.fill_between([], [], [], color=style.GRAY, alpha=0.3, linewidth=0, label=_SHADE)
    low, high = axes.get_ylim()
    if high - low < _NARROWEST * high:
        axes.set_ylim(0.0, 1.2 * high)
    axes.set(xlabel=label, ylabel="friction coefficient" if name == "friction" else quantity)
    if name == "area":
        style.count_nominal_area(axes, 100.0 / (dataset.attrs["sites"] * per_site))
    style.finish(axes, legend=False)
    style.legend_below(figure, axes, 2)
    subject = "Friction" if name == "friction" else "Contact area"
    style.entitle(figure, f"{subject} against displacement", style.conditions(dataset))
    return figure
