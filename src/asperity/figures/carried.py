"""What a contact carries through time: stiffness, resistances, the part that sticks, the pull-off force."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from asperity.errors import InputError
from asperity.figures import style
from asperity.results.history import check_dataset
from asperity.results.quantities import select

_STILL = 1e-6  # part of a load by which one that stays may fall by rounding

_STICKS = "share of the contact\nthat sticks"
_PANELS = {
    "stiffness": ("normal_stiffness", "tangential_stiffness"),
    "resistance": ("resistance",),
    "thermal resistance": ("thermal_resistance",),
    _STICKS: ("stick_fraction",),
    "pull-off force": ("pull_off",),
}
"""What each panel shows: quantities of one unit."""


def carried_figure(dataset: xr.Dataset) -> Figure:
    """Draw what `asperity.Carried` asked a history to record.

    Parameters
    ----------
    dataset
        The dataset of such a `History`, with two times or more.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        Nothing was recorded, or at one time only.
    """
    check_dataset(dataset)
    known = {name: one.label for name, one in select("series", of=["carried"]).items() if name in dataset}
    if not known or dataset.sizes["time"] < 2:
        expected, advice = "what a contact carries, at several times", "age(..., carried=asperity.Carried())"
        raise InputError("dataset", expected=expected, got="none", advice=advice)
    panels = {label: [name for name in names if name in known] for label, names in _PANELS.items()}
    panels = {label: names for label, names in panels.items() if names}
    figure, grid = style.stacked((6.4, 1.4 + 1.7 * len(panels)), *[1] * len(panels))
    loaded = dataset.isel(time=dataset["load"].values > 0)
    time = loaded["time"].values
    for axes, (label, names) in zip(grid, panels.items(), strict=True):
        unit, most = str(loaded[names[0]].attrs["units"]), max(float(loaded[name].max()) for name in names)
        said, factor = (label, 1.0) if unit == "1" else style.scaled(label, unit, most)
        axes.set_ylabel(said)
        for name, color in zip(names, (style.BLUE, style.VERMILION), strict=False):
            curve = known[name] if names[1:] else None
            style.curve(axes, time, loaded[name].values * factor, "o-", color, curve)
        axes.set_ylim(bottom=0, top=1 if label == _STICKS else None)
    positive, load = time[time > 0], loaded["load"].values
    if (np.diff(load) >= -_STILL * load.max()).all() and positive[-1] >= 10 * positive[0]:
        if time[0] > 0:
            grid[0].set_xscale("log")
        else:
            grid[0].set_xscale("symlog", linthresh=positive[0], linscale=0.3)
            grid[0].set_xlim(left=0.0)
    for axes in grid:
        style.finish(axes)
    grid[-1].set_xlabel(style.over_time(dataset, "time $t$"))
    style.entitle(figure, "What the contact carries", style.conditions(dataset))
    return figure
