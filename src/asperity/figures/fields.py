"""Kept fields, drawn: patches over time, and how gaps, pressures and areas of patches are distributed."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from asperity.analysis import distributions
from asperity.analysis.field_values import cell_of
from asperity.base.words import power
from asperity.errors import InputError
from asperity.figures import style
from asperity.lattice import Field
from asperity.results.history import check_dataset

_GAINS = (
    ("gained_by_expansion", "expansion", style.BLUE),
    ("gained_by_coalescence", "coalescence", style.SKY),
    ("gained_by_births", "new patches", style.ORANGE),
)
_LOSSES = (("lost_by_shrinkage", "shrinkage", style.GRAY), ("lost_by_deaths", "patches gone", "#C8C8C8"))

_LOOKS = ((style.GRAY, "--"), (style.VERMILION, "-"))


@style.drawn
def patch_figure(dataset: xr.Dataset) -> style.Drawing:
    """Draw number and sizes of the patches, sites gained and lost since the first map, and contact ages.

    Parameters
    ----------
    dataset
        The dataset of a `History` that kept fields at two times or more.

    Raises
    ------
    InputError
        The history kept fewer fields.
    """
    check_dataset(dataset)
    count = dataset.sizes.get("field_time", 0) if "patches" in dataset else 0
    if count < 2:
        expected, advice = "a history that kept fields at two times or more", "age(..., fields_at=times)"
        raise InputError("dataset", expected=expected, got=f"{count}", advice=advice)
    time = dataset["field_time"].values.astype(np.float64)
    figure = style.Drawing(figsize=(style.PAGE, 4.6))
    (number, size), (growth, age) = figure.subplots(2, 2, sharex=True)
    style.curve(number, time, dataset["patches"].values, "o-", style.BLUE, "")
    number.set(ylabel="patches", ylim=(0, None))
    sizes = (("largest", style.VERMILION), ("mean", style.BLUE), ("median", style.GRAY))
    for name, color in sizes:
        style.curve(size, time, dataset[f"{name}_patch_size"].values, "o-", color, name)
    size.set_ylabel("size of a patch [sites]")
    if dataset["largest_patch_size"].max() >= 10:
        size.set_yscale("log")
        style.few_ticks(size.yaxis)
    else:
        size.set_ylim(bottom=0)
    size.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False)
    for parts, sign in ((_GAINS, 1), (_LOSSES, -1)):
        names, labels, colors = zip(*parts, strict=True)
        sums = [sign * np.cumsum(dataset[name].values) for name in names]
        growth.stackplot(time, sums, labels=labels, colors=colors, linewidth=0)
    growth.axhline(0, color=style.INK, linewidth=0.8)
    growth.set_ylabel("gained and lost since\nthe first map [sites]", multialignment="center")
    ages = dataset["contact_age"]
    low, middle, high = (ages.sel(quantile=share).values for share in (0.05, 0.5, 0.95))
    age.fill_between(time, low, high, color=style.SKY, alpha=0.5, linewidth=0, label="5 to 95 % of the sites")
    style.curve(age, time, middle, "o-", style.BLUE, "median")
    age.set_ylabel(style.over_time(dataset, "contact age").replace("  [", "\n["), multialignment="center")
    if "protocol" not in dataset.attrs:
        _scale(time, growth, "x")
    _scale(np.unique(ages.values[ages.values >= 0]), age, "y")
    for axes in (number, size, growth, age):
        style.finish(axes, legend=axes in (growth, age))
    for axes in (growth, age):
        axes.set_xlabel(style.over_time(dataset, "time $t$"))
    return figure


def _scale(values: Field, axes: Axes, which: str) -> None:
    """Scale an axis by decades, with 0 where there is one; linearly where the values are within a decade."""
    positive = values[values > 0]
    if positive.size and values.max() >= 10 * positive.min():
        scale = axes.set_xscale if which == "x" else axes.set_yscale
        # A power of ten, or the labels of 0 and of the first decade would overlap.
        scale("symlog", linthresh=10.0 ** math.floor(math.log10(float(positive.min()))), linscale=1.0)


@style.drawn
def distribution_figure(dataset: xr.Dataset) -> style.Drawing:
    """Draw which part of the surface has a larger gap, of the contact more pressure, of patches more area.

    Parameters
    ----------
    dataset
        The dataset of a `History` that kept fields; the first and the last of them are drawn.

    Returns
    -------
    Figure
        Without the pressure for solids that are defined on sites.

    Raises
    ------
    InputError
        The history kept no fields.
    """
    every = distributions(dataset)
    moments = [every[0], every[-1]][: len(every)]
    si, plane = bool(dataset.attrs.get("si")), dataset["heights"].ndim == 2
    gaps = [(moment.gap, moment.sites) for moment in moments]
    sizes = [(cell_of(dataset) * moment.patch, moment.patch.size) for moment in moments]
    pressures = [(field, field.size) for moment in moments if (field := moment.pressure) is not None]
    panels: list[tuple[str, str, str, list[tuple[Field, int]]]] = [
        ("gap", "m", "surface", gaps),
        ("area of a patch" if si else "sites of a patch", "m^2" if plane else "m", "patches", sizes),
        *([("contact pressure", "Pa", "contact", pressures)] if pressures else []),
    ]
    figure = style.Drawing(figsize=(style.PAGE, 2.4))
    for axes, (name, unit, of_what, samples) in zip(figure.subplots(1, len(panels)), panels, strict=True):
        largest = max((float(values[-1]) for values, _ in samples if values.size), default=0.0)
        label, factor = style.scaled(name, unit if si else "1", largest)
        for moment, (values, whole), (color, dash) in zip(moments, samples, _LOOKS, strict=False):
            legend = f"$t$ = ${power(moment.time)}${' s' if si else ''}"
            _draw(axes, factor * values, whole, color=color, linestyle=dash, label=legend)
        axes.set(xlabel=label, ylabel=f"part of the {of_what}\nwith as much or more")
        if "patch" in name and largest:
            axes.loglog()
            style.few_ticks(axes.xaxis)
            style.few_ticks(axes.yaxis)
        style.finish(axes)
    return figure


def _draw(axes: Axes, rising: Field, whole: int, **look: str) -> None:
    """Draw the part of the whole that has each value or more."""
    values, first = np.unique(rising, return_index=True)
    above = (rising.size - first) / max(whole, 1)
    axes.step(values, above, where="pre", linewidth=1.4, **look)  # type: ignore[arg-type]
