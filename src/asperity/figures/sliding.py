"""Friction, or the contact area, against the length that the rough surface has slid."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from asperity.analysis.legs import leg_table, numbers_of
from asperity.analysis.scan import readable
from asperity.errors import InputError
from asperity.figures import style
from asperity.figures.history import shown_series
from asperity.protocols import Slide

_COLORS = (style.BLUE, style.VERMILION, style.GRAY)
_MOST_VELOCITIES = 3


def sliding_figure(dataset: xr.Dataset) -> Figure:
    """Draw friction against displacement; without a shear strength, the contact area.

    Parameters
    ----------
    dataset
        That of a `History` that slides, with friction (`asperity.friction.add_friction`) or without.

    Returns
    -------
    Figure
        Before a shift the contact has crept, so friction is higher than just after it: both are drawn.
        What happens at rest is a vertical line.

    Raises
    ------
    InputError
        The history does not slide.
    """
    if "displacement" not in dataset:
        raise InputError(
            "dataset", expected="a history that slides", got="one that does not", advice="protocols.Slide"
        )
    name = "friction" if "friction" in dataset else "area"
    values, label, per_site = shown_series(dataset, name)
    way = dataset["displacement"].values
    unit, factor = str(dataset["displacement"].attrs["units"]), 1.0
    if dataset.attrs.get("si"):
        unit, factor = readable(unit, float(way.max()))
    figure = style.Drawing(figsize=(6.4, 4.2), layout="constrained")
    axes = figure.subplots()
    numbers = numbers_of(dataset)
    rests = [row for row in leg_table(dataset) if not isinstance(row.leg, Slide)]
    slides = [row for row in leg_table(dataset) if isinstance(row.leg, Slide)]
    speeds = list(dict.fromkeys(row.leg.velocity for row in slides if isinstance(row.leg, Slide)))
    for row in [*rests, *slides]:
        own = np.flatnonzero(numbers == row.number)
        own = np.append(np.arange(max(own[0] - 1, 0), own[0]), own) if own.size else own
        color, width, text = style.INK, 1.6, "at rest"
        if isinstance(row.leg, Slide):
            kind = min(speeds.index(row.leg.velocity), _MOST_VELOCITIES - 1)
            speed = style.said(dataset, "velocity", row.leg.velocity) if row.leg.duration else ""
            text = f"slides at {speed}" if speed else "slides at once"
            text = (
                text if len(speeds) <= _MOST_VELOCITIES or kind < _MOST_VELOCITIES - 1 else "other velocities"
            )
            color, width = _COLORS[kind], 0.9
        known = axes.get_legend_handles_labels()[1]
        axes.plot(
            way[own] * factor,
            values[own],
            "-" if isinstance(row.leg, Slide) else "o-",
            color=color,
            linewidth=width,
            markersize=3,
            label=text if text not in known else None,
        )
    axes.set_xlabel(style.with_unit("displacement", "1" if unit in _UNITLESS else unit))
    axes.set_ylabel("friction coefficient" if name == "friction" else label)
    if name == "area":
        style.count_nominal_area(axes, 100.0 / (dataset["heights"].size * per_site))
    axes.legend(loc="best", fontsize=8, framealpha=0.95)
    what = "Friction" if name == "friction" else "Contact area"
    first = f"load {style.said(dataset, 'load', float(dataset['load'].values[0]))} at first"
    conditions = style.lines(style.conditions(dataset, first), figure.room)
    figure.suptitle(f"{what} against displacement\n{conditions}", fontsize=10)
    return figure


_UNITLESS = ("length unit",)
