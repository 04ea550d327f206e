"""What a contact carries through time: stiffness, resistances, the part that sticks, the pull-off force."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from asperity.analysis.legs import leg_table
from asperity.analysis.maps import end_of_loading
from asperity.errors import InputError
from asperity.figures import style
from asperity.figures.history import head, join, series_table, shade
from asperity.figures.time_axis import time_axis
from asperity.results.history import check_dataset
from asperity.results.quantities import select

_LOOKS = ((style.BLUE, "o"), (style.VERMILION, "s"), (style.ORANGE, "v"), (style.SKY, "^"))

_WIDE = 5.0
"""Ratio of resistances from which their axis is logarithmic."""

_STICKS = "part of the contact\nthat sticks"
_PANELS = {
    "stiffness": (
        "normal_stiffness",
        "tangential_stiffness",
        "tangential_stiffness_soft",
        "tangential_stiffness_stiff",
    ),
    "resistance": ("resistance",),
    "thermal resistance": ("thermal_resistance",),
    _STICKS: ("stick_fraction",),
    "pull-off force": ("pull_off",),
}
"""What each panel shows: quantities of one unit."""


@style.drawn
def carried_figure(dataset: xr.Dataset) -> style.Drawing:
    """Draw what `asperity.Carried` asked a history to record, leg by leg as `history_figure` draws the area.

    A dotted line has the value of the first contact, or where the load began with 0, of the first contact
    under all of it.

    Parameters
    ----------
    dataset
        The dataset of such a `History`, with two times or more.

    Raises
    ------
    InputError
        Nothing was recorded, or at one time only.
    """
    check_dataset(dataset)
    labels = {name: row.label for name, row in select("series", of=["carried"]).items() if name in dataset}
    if not labels or dataset.sizes["time"] < 2:
        expected, advice = "what a contact carries, at several times", "age(..., carried=asperity.Carried())"
        raise InputError("dataset", expected=expected, got="none", advice=advice)
    panels = {label: [name for name in names if name in labels] for label, names in _PANELS.items()}
    panels = {label: names for label, names in panels.items() if names}
    time = time_axis(dataset, leg_table(dataset), style.PAGE)
    figure, grid = style.stacked((style.PAGE, 1.2 + 1.1 * len(panels)), *[1] * len(panels))
    load = dataset["load"].values
    first = end_of_loading(load)
    begins, whole = (style.said(dataset, name, float(dataset[name][first])) for name in ("time", "load"))
    drawn = [f"{name}{end}" for name in labels for end in ("", "_low", "_high") if f"{name}{end}" in dataset]
    there = {name: (load > 0) & np.isfinite(dataset[name]) for name in drawn}
    dataset = dataset.assign({name: dataset[name].where(there[name]) for name in drawn})
    figure.table = series_table(dataset, labels)
    for axes, (label, names) in zip(grid, panels.items(), strict=True):
        unit, values = str(dataset[names[0]].attrs["units"]), dataset[names].to_array().values
        most, least = float(np.nanmax(values, initial=0.0)), float(np.nanmin(values, initial=math.inf))
        axis_label, factor = (label, 1.0) if unit == "1" else style.scaled(label, unit, most)
        axes.set_ylabel(axis_label, multialignment="center")
        for name, (color, look) in zip(names, _LOOKS, strict=False):
            values = factor * dataset[name].values
            axes.axhline(values[first], color=color, linewidth=0.7, linestyle=":")
            shade(axes, time, dataset, name, values, color)
            join(axes, time, values, color, look, labels[name] if names[1:] else "")
        axes.axhline(math.nan, color=style.GRAY, linewidth=0.7, linestyle=":", label=f"at {begins}")
        axes.autoscale(axis="y")  # over all curves of the panel
        axes.margins(y=0.15)
        if label.endswith("resistance") and most > _WIDE * least > 0:  # the first touch presses all else down
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter("{x:g}")
        else:
            axes.set_ylim(bottom=0, top=1 if label == _STICKS else None)
    head(grid, time, dataset)
    for axes, names in zip(grid, panels.values(), strict=True):
        many = len(names) > len(_LOOKS) / 2
        style.finish(axes, legend=not many, lines_along="y")
        if many:  # a legend within the panel would hide curves
            style.legend_below(figure, axes, columns=2)
    conditions = style.conditions(dataset, f"load {whole} at {begins}")
    style.entitle(figure, "Stiffness, resistance and slip", conditions)
    return figure
