"""The law of a contact: approach, stiffness, conductances and area against pressure, at each age."""

from __future__ import annotations

import itertools

import numpy as np
import xarray as xr
from matplotlib import colormaps

from asperity.base.readable import readable
from asperity.base.words import duration
from asperity.contact_law.laws import check_law
from asperity.figures import style

_PANELS = {
    "approach": "approach",
    "stiffness": "stiffness\nper area",
    "thermal_conductance": "thermal\nconductance\nper area",
    "conductance": "conductance\nper area",
    "contact_fraction": "contact",
}


@style.drawn
def law_figure(dataset: xr.Dataset) -> style.Drawing:
    """Draw a law: a color for each age, with its band; dashed the law of a pressure that falls.

    Parameters
    ----------
    dataset
        What `asperity.law` returned.

    Raises
    ------
    InputError
        It is something else.
    """
    check_law(dataset)
    names = [name for name in _PANELS if name in dataset]
    figure, grid = style.stacked((style.COLUMN, 0.9 + 1.0 * len(names)), *[1.4, *[1] * (len(names) - 1)])
    across, factor = readable("Pa", float(dataset["pressure"][-1]))
    pressure, ages = dataset["pressure"].values * factor, dataset["time"].values.tolist()
    colors = dict(zip(ages, colormaps["viridis"](np.linspace(0, 0.85, len(ages))), strict=True))
    dashes = {"loading": "-", "unloading": "--"}
    for axes, name in zip(grid, names, strict=True):
        unit, scale = readable(str(dataset[name].attrs["units"]), float(dataset[name].max()))
        if name == "contact_fraction":
            unit, scale = "%", 100.0
        for direction, age in itertools.product(dataset["direction"].values.tolist(), ages):
            values = dataset[name].sel(direction=direction, time=age).values * scale
            legend = f"age {duration(age)}" if direction == "loading" else None
            axes.plot(pressure, values, dashes[direction], color=colors[age], linewidth=1.4, label=legend)
        last = dataset.sel(direction="loading", time=ages[-1])
        low, high = (last[f"{name}_{end}"].values * scale for end in ("low", "high"))
        style.band(axes, pressure, low, high, colors[ages[-1]], "")
        axes.set(xscale="log", ylabel=f"{_PANELS[name]}\n[{style.spelled(unit)}]")
        if name != "approach":
            axes.set_yscale("log")
            style.few_ticks(axes.yaxis)
        style.finish(axes, legend=axes is grid[0])
    grid[-1].xaxis.set_major_formatter("{x:g}")
    grid[-1].set_xlabel(style.with_unit("pressure, load over nominal area", across))
    title = "Law of the rough layer\nshaded: 95 % band of the mean over such scans, last age"
    title += "\ndashed: unloading, without creep" * (dataset.sizes["direction"] > 1)
    figure.suptitle(title)
    return figure
