"""A campaign: curves of its answers for the values of the swept parameters, with their scatter."""

from __future__ import annotations

import math
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps

from asperity.base import checks
from asperity.errors import InputError
from asperity.figures import style
from asperity.lattice import Field

_DRAWN = {
    "time": ("contact_fraction", "Growth of the real contact"),
    "speed": ("hysteresis_friction_coefficient", "Friction"),
    "pressure": ("stiffness", "Stiffness"),
}
"""What is drawn over the last dimension of an answer, and the title."""

_MOST_PANELS, _MOST_CURVES = 6, 7
_MARKERS = "osD^vP*"
_WIDE = 20.0
"""Ratio of the largest to the smallest contact from which its axis is logarithmic."""

Where = dict[str, int]


@style.drawn
def campaign_figure(dataset: xr.Dataset) -> style.Drawing:
    """Draw the answers at each point of a campaign: means over the seeds, standard errors, and 95 % bands.

    Of histories and predictions the contact against time, of steady sliding the friction against speed, of
    laws the stiffness against pressure under loading. The parameter with most values tells the curves of a
    panel apart; each point of the others has a panel.

    Parameters
    ----------
    dataset
        From `asperity.campaign.open`.

    Returns
    -------
    Figure
        Of 6 panels and of 7 curves in each at most, evenly chosen; the title says what is left out.

    Raises
    ------
    InputError
        It is no such dataset, or holds no time above 0.
    """
    checks.instance("dataset", dataset, xr.Dataset, "asperity.campaign.open(directory)")
    over = str(dataset.attrs.get("over", "time")).split()[-1]
    dataset = dataset.isel(direction=0) if over == "pressure" else dataset
    place = "time" if over == "entry" else over
    quantity, title = _DRAWN.get(place, ("", ""))
    name = f"{quantity}_mean" if f"{quantity}_mean" in dataset else quantity
    if (
        not {name, place} <= set(dataset.variables)
        or dataset[place].ndim == 0
        or not float(dataset[place].max()) > 0
    ):
        expected = "the dataset of a campaign, with times above 0"
        raise InputError("dataset", expected=expected, got="another", advice="asperity.campaign.open(folder)")
    mean, *more = _series(dataset, quantity, over, 100 if place == "time" else 1)
    banded, several = f"{quantity}_low" in dataset, dataset.sizes.get("seed", 0) > 1
    swept = sorted(map(str, mean.dims[:-1]), key=lambda dim: dataset.sizes[dim])
    along, others = (swept[-1:], swept[:-1])
    panels, curves = _points(dataset, others, _MOST_PANELS), _points(dataset, along, _MOST_CURVES)
    columns = min(3, len(panels))
    rows = math.ceil(len(panels) / columns)
    figure = style.Drawing(figsize=(style.PAGE if columns > 1 else style.COLUMN, 1.2 + 1.9 * rows))
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    drawn = mean.where(mean > 0)
    logarithmic = float(drawn.max()) > _WIDE * float(drawn.min())
    for axes, panel in zip(grid.flat, panels, strict=False):
        for number, curve in enumerate(curves):
            time, (middle, half, low, high) = _curve(dataset[place], (mean, *more), panel | curve)
            color = colormaps["cividis"](0.85 * number / max(len(curves) - 1, 1))
            label = _said(dataset, curve)
            style.band(axes, time, low, high, color, f"_95 % band, {label}" * banded)
            look: dict[str, Any] = {"linewidth": 1.3, "markersize": 3.5, "color": color}
            style.curve(axes, time, middle, f"{_MARKERS[number]}-", label=label, **look)
            if banded and several:
                bars = f"_standard error, {label}"
                axes.errorbar(time, middle, half, fmt="none", ecolor=color, capsize=1.5, label=bars)
        if "leg" not in dataset.coords:
            axes.set_xscale("log")
        if logarithmic:
            axes.set_yscale("log")
            style.few_ticks(axes.yaxis)
        axes.set_title(_said(dataset, panel))
        style.finish(axes, legend=False)
    for axes in grid.flat[len(panels) :]:
        axes.set_axis_off()
    style.legend_below(figure, grid[0, 0], 1 + columns)
    if place == "time":
        along_place = style.over_time(dataset, f"{'time' if 'leg' in dataset.coords else 'hold time'} $t$")
    else:
        along_place = _labelled(dataset[place])
    for axes in grid.flat[max(len(panels) - columns, 0) : len(panels)]:
        axes.set_xlabel(along_place)
        axes.tick_params(labelbottom=True)
    figure.supylabel("real contact [% of nominal area]" if place == "time" else _labelled(dataset[quantity]))
    style.entitle(figure, "", _title(title, dataset, others, along, banded=banded))
    return figure


def _series(dataset: xr.Dataset, quantity: str, over: str, factor: float) -> tuple[xr.DataArray, ...]:
    """Mean over the seeds, its standard error, and ends of the band: that of the answers if they have one."""
    of_seeds = f"{quantity}_mean" in dataset
    mean = factor * dataset[f"{quantity}_mean" if of_seeds else quantity].transpose(..., over)
    spread = factor * dataset[f"{quantity}_stderr"].fillna(0.0) if of_seeds else 0 * mean
    if f"{quantity}_low" not in dataset:
        return mean, spread, mean - spread, mean + spread
    # Relative to each answer, as an end may be unknown in some of those that the mean is of.
    parts = [dataset[f"{quantity}_{end}"] / dataset[quantity] for end in ("low", "high")]
    return mean, spread, *(mean * (part.mean("seed") if of_seeds else part) for part in parts)


def _labelled(array: xr.DataArray) -> str:
    return style.with_unit(array.attrs["long_name"], array.attrs["units"])


def _points(dataset: xr.Dataset, dims: list[str], most: int) -> list[Where]:
    """Points along some of the dimensions, evenly chosen where there are too many."""
    points = [dict(zip(dims, at, strict=True)) for at in product(*(range(dataset.sizes[d]) for d in dims))]
    chosen = np.unique(np.linspace(0, len(points) - 1, min(most, len(points))).round().astype(int))
    return [points[number] for number in chosen]


def _curve(places: xr.DataArray, series: tuple[xr.DataArray, ...], where: Where) -> tuple[Field, list[Field]]:
    """Places of a curve, and its series, the values first; what is not finished is left out."""
    time = places.isel(where, missing_dims="ignore").values
    values = [one.transpose(..., series[0].dims[-1]).isel(where).values for one in series]
    shown = np.isfinite(values[0]) & (time > 0 if "leg" not in places.coords else np.isfinite(time))
    return time[shown], [one[shown] for one in values]


def _said(dataset: xr.Dataset, where: Where) -> str:
    """Values of the parameters at a point; along zipped ones, of each of them."""
    texts = []
    for dim, at in where.items():
        zipped = [str(name) for name in dataset.coords if dataset[name].dims == (dim,) and name != dim]
        for name in zipped if dim == "point" and zipped else [dim]:
            value = dataset[name].values[at]
            text = style.said(dataset, name, float(value)) if value.dtype.kind in "iuf" else str(value)
            texts.append(f"{name} = {text}")
    return style.verbatim(", ".join(texts))


def _title(
    title: str, dataset: xr.Dataset, others: list[str], along: list[str], *, banded: bool
) -> list[str]:
    """What is drawn, and how much of it."""
    parts = [title]
    if "seed" in dataset.dims:
        seeds = dataset.sizes["seed"]
        parts.append(f"mean of {seeds} seeds ± standard error" if seeds > 1 else "one seed")
    parts += ["shaded: 95 % band of an answer"] * banded
    for dims, most, plural in ((others, _MOST_PANELS, "panels"), (along, _MOST_CURVES, "curves a panel")):
        if (count := math.prod(dataset.sizes[dim] for dim in dims)) > most:
            parts.append(f"{most} of {count} {plural} drawn")
    finished, runs = dataset.attrs.get("finished"), dataset.attrs.get("runs")
    if finished != runs:
        parts.append(f"{finished} of {runs} runs finished")
    return parts
