"""The law of a contact: pressure, stiffness and what else it tabulates, at each age."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps

from asperity.analysis.contact_law import check_law
from asperity.analysis.scan import readable, written
from asperity.figures import style

_PANELS = {
    "approach": "approach",
    "stiffness": "stiffness\nper area",
    "thermal_conductance": "thermal\nconductance\nper area",
    "conductance": "conductance\nper area",
    "contact_fraction": "contact",
}


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
    figure, grid = style.stacked((6.4, 1.6 + 1.7 * len(names)), *[1.4, *[1] * (len(names) - 1)])
    across, factor = readable("Pa", float(dataset["pressure"][-1]))
    pressure, ages = dataset["pressure"].values * factor, dataset["time"].values.tolist()
    colors = colormaps["viridis"](np.linspace(0, 0.85, len(ages)))
    for axes, name in zip(grid, names, strict=True):
        unit, scale = readable(str(dataset[name].attrs["units"]), float(dataset[name].max()))
        if name == "contact_fraction":
            unit, scale = "%", 100.0
        for direction in dataset["direction"].values.tolist():
            rises = direction == "loading"
            for color, age in zip(colors, ages, strict=True):
                table = dataset.sel(direction=direction, time=age)
                said = f"age {written(age, 's')}" if rises else None
                look: dict[str, Any] = {"color": color, "linewidth": 1.4, "label": said}
                axes.plot(pressure, table[name].values * scale, "-" if rises else "--", **look)
                if rises and age == ages[-1]:
                    low, high = (table[f"{name}_{end}"].values * scale for end in ("low", "high"))
                    axes.fill_between(pressure, low, high, color=color, alpha=0.2, linewidth=0)
        axes.set_ylabel(f"{_PANELS[name]}\n[{style.spelled(unit)}]")
        axes.set_xscale("log")
        if name != "approach":
            axes.set_yscale("log")
        style.finish(axes, legend=axes is grid[0])
    figure.align_ylabels(grid)
    grid[-1].set_xlabel(style.with_unit("pressure, load over nominal area", across))
    last = "" if len(ages) == 1 else ", last age"
    parts = [f"shaded: 95 % band for another scan of this size{last}"]
    if dataset.sizes["direction"] > 1:
        parts.append("dashed: unloading from the largest pressure, at once")
    style.entitle(figure, "Law of the rough layer", parts)
    return figure
