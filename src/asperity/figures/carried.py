"""What a contact carries through time: stiffness and resistances over the first, and the part that sticks."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from asperity.analysis.scan import written
from asperity.errors import InputError
from asperity.figures import style
from asperity.results.history import check_dataset
from asperity.results.quantities import select

_ALIKE = {
    style.BLUE: ("normal_stiffness", "tangential_stiffness"),
    style.VERMILION: ("resistance", "thermal_resistance"),
}
"""What is proportional to each other, and so one curve over its first value."""


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
    sticks = "stick_fraction" in dataset
    figure, grid = style.stacked((6.4, 4.0 + 2.2 * sticks), *(3, 2)[: 1 + sticks])
    loaded = dataset.isel(time=dataset["load"].values > 0)
    time = loaded["time"].values
    for color, names in _ALIKE.items():
        here = {name: loaded[name] for name in names if name in known}
        if here:
            firsts = (written(float(one[0]), str(one.attrs["units"]), 3) for one in here.values())
            said = ", ".join(f"{known[name]} {first}" for name, first in zip(here, firsts, strict=True))
            values = next(iter(here.values())).values
            style.curve(grid[0], time, values / values[0], "o-", color, f"{said} at first", markersize=4)
    grid[0].set_ylabel("over the first")
    if sticks:
        style.curve(grid[1], time, loaded["stick_fraction"].values, "o-", style.INK, "")
        grid[1].set_ylabel("share of the contact\nthat sticks")
        grid[1].set_ylim(0, 1)
    positive = time[time > 0]
    if "protocol" not in dataset.attrs and positive[-1] >= 10 * positive[0]:
        if time[0] > 0:
            grid[0].set_xscale("log")
        else:
            grid[0].set_xscale("symlog", linthresh=positive[0], linscale=0.3)
            grid[0].set_xlim(left=0.0)
    for axes in grid:
        style.finish(axes, legend=False)
    grid[0].legend(fontsize=8, loc="lower left")  # stiffness rises, and resistance falls
    grid[-1].set_xlabel(style.over_time(dataset, "time $t$"))
    style.entitle(figure, "What the contact carries", style.conditions(dataset))
    return figure
