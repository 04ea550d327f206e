"""Steady sliding: friction and contact area against speed."""

from __future__ import annotations

import json
from typing import Any

import xarray as xr

from asperity.base.readable import written
from asperity.figures import style
from asperity.sliding.answer import check_sliding


@style.drawn
def steady_sliding_figure(dataset: xr.Dataset) -> style.Drawing:
    """Draw friction and contact area against speed, on a logarithmic axis.

    Parameters
    ----------
    dataset
        What `asperity.steady_sliding` returned.

    Raises
    ------
    InputError
        It is something else.
    """
    check_sliding(dataset)
    speed, unit = dataset["speed"].values, str(dataset["speed"].attrs["units"])
    figure, (above, below) = style.stacked((style.COLUMN, 3.6), 1, 1)
    look: dict[str, Any] = {"markersize": 2.5, "linewidth": 1.4}
    curves = {
        "friction_coefficient": (above, style.INK, "with shear strength"),
        "hysteresis_friction_coefficient": (above, style.VERMILION, "hysteresis"),
        "contact_fraction": (below, style.BLUE, ""),
    }
    for name, (axes, color, label) in curves.items():
        factor = 100 if axes is below else 1
        if name in dataset:
            axes.plot(speed, factor * dataset[name].values, "o-", color=color, label=label, **look)
        if f"{name}_low" in dataset:
            low, high = (factor * dataset[f"{name}_{end}"].values for end in ("low", "high"))
            style.band(axes, speed, low, high, color, "")
    of_all = "friction_coefficient" in dataset
    # On one line it is longer than the panel, and would be cut off in files without a title.
    above.set_ylabel("friction coefficient" if of_all else "friction coefficient,\nhysteresis", ma="center")
    below.set(xlabel=style.with_unit("sliding speed", unit), ylabel="contact [%]")
    for axes in (above, below):
        axes.set(xscale="log", ylim=(0, None))
        style.finish(axes, legend=axes is above and of_all)
    area = float(dataset.attrs["nominal_area"])
    pressure = float(dataset.attrs["load"]) / area
    shown = written(pressure, "Pa") if unit == "m/s" else f"{pressure:.4g}"
    banded = ", 95 % bands" * ("contact_fraction_low" in dataset)
    direction = json.loads(dataset.attrs["direction"])
    figure.suptitle(f"Steady sliding under {shown}, direction {direction}{banded}")
    return figure
