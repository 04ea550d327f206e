"""A prediction drawn: growth of the area, contact and pressure on the scan, the image of an instrument."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from numpy.typing import NDArray

from asperity.analysis.bands import rows_of_maps
from asperity.analysis.maps import SiteState, color_range, states_since
from asperity.base.readable import readable
from asperity.base.words import power
from asperity.figures import style
from asperity.figures.contacts import COLORS
from asperity.figures.measured import draw_measured
from asperity.figures.plots import draw_series, pressure_norm
from asperity.fits import Measurements
from asperity.fits.measurements import measured_area
from asperity.prediction.results import Growth, Prediction
from asperity.results.quantities import select

_BINS, _WIDE = 60, 28
"""Of the distribution of pressures; and letters of a label that leave no room for another beside it."""

_MIXED: dict[str, Any] = {"interpolation_stage": "rgba"}
"""Colors of sites that share a pixel are mixed, rather than their values."""


@style.drawn
def growth_figure(prediction: Prediction, measured: Measurements | Path | str | None = None) -> style.Drawing:
    """Draw the area against the logarithm of time, its growth in each decade, and friction.

    A measured area is drawn beside the first, and below it the ratio of both.
    """
    panels = style.panels_of(prediction)
    chosen = [panels[kind] for kind in ("area", "growth", "friction") if kind in panels]
    if measured is not None:
        chosen.insert(1, style.Panel(lambda _: None, "", 1.2))
    figure, grid = style.figure_of(chosen)
    if measured is not None:
        _, square = _areas(prediction)
        area = square * prediction.series("contact_area_corrected")
        seen = measured_area(measured, prediction.nominal_area, si=True)
        draw_measured(grid[:2], seen, prediction.time, area, square)
    if prediction.growth is not None:
        figure.suptitle(f"{prediction.between('A')} = {prediction.growth.ratio:.5g}")
    for axes in grid:
        # Above the panel: areas that do not grow would leave no room in it.
        if shown := axes.get_legend_handles_labels()[1]:
            columns = 1 if max(map(len, shown)) > _WIDE else 2
            axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=columns, frameon=False)
    return figure


@style.panels_of.register
def _(prediction: Prediction) -> dict[str, style.Panel]:
    time = "time since the loading began [s]" if prediction.ramp else "time under load [s]"
    panels = {"area": style.Panel(partial(draw_growth, prediction=prediction), time, 3)}
    if (growth := prediction.growth) is not None:
        panels["growth"] = style.Panel(partial(_draw_decades, growth=growth), time, 1.6)
    if prediction.friction is not None:
        panels["friction"] = style.Panel(partial(_draw_friction, prediction=prediction), time, 1.6)
    panels["pressure"] = style.Panel(partial(_draw_pressures, prediction=prediction), "", 2.1)
    panels["contacts"] = style.Panel(partial(_draw_touching, prediction=prediction), "")
    for name in select("series"):
        if name in prediction.dataset and name not in panels:
            panels[name] = style.Panel(partial(draw_series, dataset=prediction.dataset, quantity=name), "")
    return panels


def _draw_decades(axes: Axes, growth: Growth) -> None:
    """Draw the growth of the area in each decade, and the band of its mean."""
    begin, end, slope = np.transpose(growth.decades)
    edges, label = np.append(begin, end[-1]), "decade by decade"
    axes.stairs(100 * slope, edges, baseline=None, color=style.BLUE, linewidth=1.2, label=label)
    low, high = (100 * edge for edge in growth.band)
    mean = f"mean {100 * growth.per_decade:.3g} %"
    if math.isnan(low):
        axes.axhline(100 * growth.per_decade, color=style.SKY, label=mean)
    else:
        axes.axhspan(low, high, color=style.SKY, alpha=0.35, linewidth=0, label=f"{mean}, 95 % band")
    axes.set_xscale("log")
    axes.set_ylabel("growth per decade\n[% of first area]", multialignment="center")


def _draw_friction(axes: Axes, prediction: Prediction) -> None:
    """Draw the coefficient of static friction, which a shear strength gives."""
    friction, label = prediction.friction, "shear strength × area / load"
    assert friction is not None
    style.curve(axes, prediction.time, friction, "o-", style.VERMILION, label, linewidth=1.0)
    style.band(axes, prediction.time, *prediction.band("friction"))
    axes.set(xscale="log", ylabel="static friction $\\mu$")


def draw_growth(axes: Axes, prediction: Prediction) -> None:
    """Draw the area against the logarithm of time, raw and corrected for pixel rims, and by theory."""
    unit, square = _areas(prediction)
    counted, corrected = (
        square * prediction.series(name) for name in ("contact_area", "contact_area_corrected")
    )
    style.curve(axes, prediction.time, counted, "s-", style.GRAY, "raw", linewidth=1.0)
    style.curve(axes, prediction.time, corrected, "o-", style.INK, "corrected for pixel rims", linewidth=1.0)
    low, high = (square * end for end in prediction.band("contact_area_corrected"))
    style.band(axes, prediction.time, low, high)
    if (effective := prediction.effective_load) is not None:
        followed = corrected[0] * effective / effective[0]
        label = f"as the {prediction.beside[0]} grows"
        axes.plot(prediction.time, followed, ":", color=style.VERMILION, label=label)
    if prediction.theory is not None:
        name, area = prediction.theory
        shown = square * area
        if prediction.relaxing is None:  # contacts that flow: before they do, the theory is far above
            shown = np.where(shown < 1.2 * counted.max(), shown, np.nan)
        if np.isfinite(shown).any():
            axes.plot(prediction.time, shown, "--", color=style.BLUE, linewidth=1.2, label=name)
    axes.set(xscale="log", ylabel=f"real contact area [{unit}]")
    style.count_nominal_area(axes, 100.0 / (prediction.nominal_area * square))


@style.drawn
def contact_maps_figure(prediction: Prediction) -> style.Drawing:
    """Draw where the scan touches at the first and the last time, and with which pressure."""
    heights = np.asarray(prediction.dataset["heights"])
    touching, pressure = (_ends(prediction, name) for name in ("in_contact", "pressure"))
    tall = heights.shape[0] * prediction.spacing[0] / (heights.shape[1] * prediction.spacing[1])
    figure = style.Drawing(figsize=(style.PAGE, 1.0 + 4.8 * min(max(tall, 0.3), 1.6)))
    grid = figure.subplots(2, 2, sharex=True, sharey=True)
    of_axes = _pixel(prediction, prediction.spacing)
    low, high = color_range(heights)
    height_label, factor = style.scaled("height", "m", high - low)
    pressure_label, scale = style.scaled("contact pressure", "Pa", float(pressure.max()))
    limits = pressure_norm(pressure * scale)
    gray = {"cmap": "gray", "clim": (low * factor, high * factor), "alpha": 0.75, **_MIXED}
    for column in range(2):
        upper, lower = grid[:, column]
        relief = style.show_map(upper, heights * factor, *of_axes, **gray)
        _draw_touching(upper, prediction, -column)
        lower.set_facecolor("0.93")
        values = np.where(touching[column], pressure[column] * scale, np.nan)
        image = style.show_map(lower, values, *of_axes, cmap=style.PRESSURE_MAP, norm=limits, **_MIXED)
    for axes in grid.flat:
        axes.label_outer()
    figure.colorbar(relief, ax=grid[0, :], label=height_label, shrink=0.9, extend="both")
    style.bar_of_pressures(figure, image, grid[1, :], pressure_label)
    words = {
        SiteState.KEPT: "touches since the first time",
        SiteState.NEW: "touches at the last time only",
        SiteState.LOST: "touches at the first time only",
    }
    lost = (touching[0] & ~touching[1]).any()
    handles = [style.swatch(COLORS[state], word) for state, word in list(words.items())[: 2 + lost]]
    figure.table = {
        "time [s]": _ends(prediction, "field_time"),
        "contact [%]": 100 * touching.sum(axis=(1, 2)) / prediction.dataset.attrs["sites"],
        "largest pressure [Pa]": pressure.max(axis=(1, 2)),
    }
    figure.elsewhere = "in_contact, pressure and heights in history.zarr"
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
    return figure


def _draw_touching(axes: Axes, prediction: Prediction, number: int = -1) -> None:
    """Color the pixels that touch in a map, by whether they touched at first, and that touched then."""
    touching = _ends(prediction, "in_contact")[[0, number]]
    time = float(_ends(prediction, "field_time")[number])
    palette = np.array([to_rgba(COLORS.get(state, "none")) for state in SiteState])
    style.show_map(axes, palette[states_since(*touching)], *_pixel(prediction, prediction.spacing), **_MIXED)
    percent = 100 * touching[1].sum() / prediction.dataset.attrs["sites"]
    axes.set_title(f"$t$ = ${power(time)}$ s: {percent:.3g} % of the pixels touch")


def _draw_pressures(axes: Axes, prediction: Prediction) -> None:
    """Draw the distribution of the contact pressure at the first and the last time."""
    times, touching, pressure = (_ends(prediction, name) for name in ("field_time", "in_contact", "pressure"))
    unit, scale = readable("Pa", float(np.quantile(pressure[touching], 0.9)))
    edges = np.linspace(0, scale * float(np.quantile(pressure[0][touching[0]], 0.98)), _BINS + 1)
    looks = ((style.GRAY, "--"), (style.VERMILION, "-"))
    for field, mask, time, (color, dash) in zip(pressure, touching, times, looks, strict=True):
        values = scale * field[mask]
        density = np.histogram(values, bins=edges)[0] / values.size / np.diff(edges)
        label = f"$t$ = ${power(float(time))}$ s, mean {values.mean():.3g} {unit}"
        axes.stairs(density, edges, color=color, linestyle=dash, linewidth=1.2, label=label)
        axes.axvline(values.mean(), color=color, linestyle=":", linewidth=1.2)
    axes.set_xlim(0, edges[-1])
    axes.set_ylim(0, 1.35 * axes.get_ylim()[1])  # room for the legend
    axes.set_xlabel(f"contact pressure [{unit}]")
    axes.set_ylabel(f"part of the contact area\nper pressure [1/{unit}]")
    style.finish(axes)


@style.drawn
def observed_figure(prediction: Prediction) -> style.Drawing:
    """Draw the contact at the last time, its image in the instrument, and the part that counts as contact."""
    observation = prediction.observed[-1]
    touching = np.asarray(prediction.dataset["in_contact"])[-1]
    figure = style.Drawing(figsize=(style.PAGE, 3.0))
    grid = figure.subplots(1, 3, sharex=True, sharey=True)
    assert observation.seen is not None
    above, sharp = f"above {observation.threshold:g} of full contact", {"interpolation": "nearest"}
    maps: tuple[Any, ...] = (
        (observation.seen, observation.spacing, sharp, above),
        (observation.image, observation.spacing, {}, "its image"),
        (touching, prediction.spacing, {}, "contact"),
    )
    for axes, (field, spacing, look, title) in zip(grid[::-1], maps, strict=True):  # all end as the last
        style.show_map(axes, field, *_pixel(prediction, spacing), cmap="gray_r", clim=(0, 1), **look)
        axes.set_title(title)
        axes.label_outer()
    figure.table = {f"{title} [%]": [100 * np.mean(field)] for field, *_, title in maps[::-1]}
    figure.elsewhere = "area_observed and in_contact in history.zarr"
    return figure


def _ends(prediction: Prediction, name: str) -> NDArray[Any]:
    """A quantity of the maps at the first time under all of the load, and at the last."""
    rows = [row - 1 for row in rows_of_maps(prediction.dataset)]
    first = next(number for number, row in enumerate(rows) if row >= prediction.loaded)
    return np.asarray(prediction.dataset[name])[[first, -1]]


def _areas(prediction: Prediction) -> tuple[str, float]:
    """Unit of areas, and the factor to it from m^2."""
    unit, factor = readable("m^2", float(prediction.series("contact_area").max()))
    return style.spelled(unit), factor


def _pixel(prediction: Prediction, spacing: tuple[float, ...]) -> tuple[list[float], str]:
    """Sides of a pixel in the unit of the axes, and that unit."""
    shape = prediction.dataset["heights"].shape
    sides = (n * side for n, side in zip(shape, prediction.spacing, strict=True))
    unit, factor = readable("m", max(sides))
    return [side * factor for side in spacing], unit
