"""Maps of the contact at several times, beside the topography; for a line contact, profiles."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize, to_rgb, to_rgba
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from asperity.analysis import ContactMaps, SiteState
from asperity.base import checks
from asperity.base.readable import readable, written
from asperity.base.words import counted, power, thousands
from asperity.figures import style
from asperity.lattice import Field
from asperity.surfaces.prepare import of_body

_COLUMNS = 4
_PANEL, _BAR = 2.45, 0.8
"""Largest side of a map with its surroundings, and width of the bar of heights, inches."""

_FILLED = 0.93
"""Part of it that the map takes."""

_SMALLEST = 1.5
"""Smallest side of a mark that is easily seen, pixels of `style.RESOLUTION`."""

COLORS = {SiteState.KEPT: style.INK, SiteState.NEW: style.VERMILION, SiteState.LOST: style.SKY}
"""How maps mark a site; the colors differ from each other, and from white, in luminance too."""

_YIELDED = to_rgba(style.PURPLE)
"""Color of the parts of the rough surface that have yielded."""

Region = tuple[slice, slice]
_WHOLE: Region = np.s_[:, :]

_STRIP, _TICK = 5.5, 0.4
"""Width of a whole profile, inches; least width of a tick, points."""

_WORDS = {
    SiteState.KEPT: "in contact then and at {first}",
    SiteState.NEW: "new: not in contact at {first}",
    SiteState.LOST: "lost: in contact only at {first}",
}


@style.drawn
def contact_figure(maps: ContactMaps) -> style.Drawing:
    """Draw which sites touch at each time: since the map of reference, newly, or no longer.

    Parameters
    ----------
    maps
        From `asperity.analysis.contact_maps`.

    Returns
    -------
    Figure
        For a surface, the topography and one map a time; for a profile, heights and elastic surfaces in
        the stretch with most contacts, above the contacts of the whole profile against time.
    """
    checks.instance("maps", maps, ContactMaps, "asperity.analysis.contact_maps(history.dataset)")
    return _profile_figure(maps) if maps.heights.ndim == 1 else _map_figure(maps)


def _map_figure(maps: ContactMaps) -> style.Drawing:
    """Topography and maps; where sites are too small to be seen, a coarser sample above close-ups."""
    shape = maps.heights.shape
    panels = 1 + len(maps.times)
    columns = min(_COLUMNS, panels)
    rows = math.ceil(panels / columns)
    tall = min(3.0, max(0.4, maps.aspect * shape[0] / shape[1]))
    panel = min(_PANEL, (style.PAGE - _BAR) / columns)
    side = side_of_cells(maps, panel * _FILLED * min(1.0, 3.0 * shape[1] / shape[0]))
    heights = [tall, 1.0] * rows if side > 1 else [tall] * rows
    size = panel * columns + _BAR, sum(panel * height + 0.4 for height in heights) + 0.9
    figure = style.Drawing(figsize=size)
    grid = figure.subplots(len(heights), columns, squeeze=False, height_ratios=heights)
    for axes in grid.ravel():
        axes.set_axis_off()
    whole = (grid[::2] if side > 1 else grid).ravel()
    image = _draw_heights(whole[0], maps)
    deepest = style.spaced(written(float(maps.indentation.max()), maps.unit, 2))
    yielded = f"\nhas yielded by up to {deepest}" if maps.indentation.any() else ""
    whole[0].set_title(f"rough surface{yielded}")
    label = style.with_unit("height", maps.unit)
    figure.colorbar(image, ax=whole[0], location="left", shrink=0.8, label=label, pad=0.02, extend="both")
    states = maps.sampled(side)
    for number, axes in enumerate(whole[1:panels]):
        draw_states(axes, maps, states[number], side)
        axes.set_title(caption(maps, number), fontsize=style.SMALL)
    if side > 1:
        _draw_close_ups(maps, whole[0], grid[1::2].ravel())
    style.entitle(figure, "Where the solids touch as the contact ages", _scales(maps, side))
    _tabulate(figure, maps)
    legend(figure, maps, topography=True)
    return figure


def side_of_cells(maps: ContactMaps, width: float) -> int:
    """Sites along a side of the smallest cell that is seen in a map so many inches wide."""
    columns: int = maps.heights.shape[1]
    return math.ceil(_SMALLEST * columns / (style.RESOLUTION * width))


def _scales(maps: ContactMaps, side: int) -> list[str]:
    """At which scale the maps show what."""
    size = ""
    if maps.pixel_size is not None:
        unit, factor = readable(maps.length_unit, maps.pixel_size)
        across = maps.pixel_size * factor
        sides = [across] if abs(maps.aspect - 1) < 0.01 else [across * maps.aspect, across]
        size = f" of {' × '.join(f'{length:.4g}' for length in sides)} {style.spelled(unit)}"
    parts = [f"each map: {' × '.join(map(str, maps.heights.shape))} sites{size}"]
    if maps.copies > 1:
        parts.append(f"the scan is mirrored: one of {maps.copies} copies is shown")
    if side > 1:
        parts.append(
            f"of {side**2} sites in contact one is drawn, {side} × {side} sites large, so that areas are true"
        )
        parts.append("below each map: the framed square, site by site")
    return parts


def _draw_close_ups(maps: ContactMaps, topography: Axes, below: NDArray[np.object_]) -> None:
    _draw_heights(below[0], maps, region := maps.close_up())
    (left, right), (bottom, top) = below[0].get_xlim(), below[0].get_ylim()
    frame: dict[str, Any] = {"fill": False, "edgecolor": "white", "linewidth": 1.2}
    topography.add_patch(Rectangle((left, top), right - left, bottom - top, **frame))
    for states, axes in zip(maps.states, below[1:], strict=False):
        draw_states(axes, maps, states[region], region=region)


def _draw_heights(axes: Axes, maps: ContactMaps, region: Region = _WHOLE) -> AxesImage:
    """Draw the topography of a region, where it has yielded, and a scale bar."""
    look: dict[str, Any] = {"cmap": style.HEIGHT_MAP, "clim": maps.height_range, "interpolation_stage": None}
    image = _draw_cells(axes, maps, maps.heights[region], region=region, **look)
    if (yielded := maps.indentation[region] > 0).any():
        _draw_cells(axes, maps, np.array(_YIELDED) * yielded[..., np.newaxis], region=region)
    draw_scale_bar(axes, maps, region)
    return image


def draw_scale_bar(axes: Axes, maps: ContactMaps, region: Region = _WHOLE) -> None:
    """Draw a round length below a map of a region, where the size of a pixel is known."""
    columns = range(maps.heights.shape[1])[region[1]]
    if bar := maps.scale_bar(len(columns)):
        sites, length, unit = bar
        start = columns.start - 0.5
        end, mixed = start + sites, axes.get_xaxis_transform()  # sites along, parts of the axes across
        look: dict[str, Any] = {"transform": mixed, "clip_on": False}
        axes.plot([start, end], [-0.04, -0.04], color=style.INK, linewidth=2.5, **look)
        text = f"  {length:g} {style.spelled(unit)}"
        axes.text(end, -0.04, text, transform=mixed, va="center")


def draw_states(
    axes: Axes, maps: ContactMaps, states: NDArray[np.int8], side: int = 1, region: Region = _WHOLE
) -> None:
    """Color each cell of side x side sites of a region by its state."""
    palette = np.array([to_rgb(COLORS.get(state, "white")) for state in SiteState])
    _draw_cells(axes, maps, palette[states], side, region)


def draw_pressure(axes: Axes, maps: ContactMaps, pressure: Field, norm: Normalize, side: int) -> AxesImage:
    """Color each cell of side x side sites by its pressure; without contact it is NaN."""
    axes.set_facecolor("0.93")
    return _draw_cells(axes, maps, pressure, side, cmap=style.PRESSURE_MAP, norm=norm)


def _draw_cells(
    axes: Axes, maps: ContactMaps, cells: Field, side: int = 1, region: Region = _WHOLE, **look: Any
) -> AxesImage:
    """Draw cells of side x side sites, of which the last may reach beyond the region.

    The first axis runs downward. Colors of cells that share a pixel are mixed, rather than their values.
    """
    rows, columns = (range(n)[part] for n, part in zip(maps.heights.shape, region, strict=True))
    top, start = rows.start - 0.5, columns.start - 0.5
    image = axes.imshow(
        cells,
        extent=(start, start + side * cells.shape[1], top + side * cells.shape[0], top),
        aspect=maps.aspect,
        **style.PIXELS | {"interpolation_stage": "rgba"} | look,
    )
    axes.set_axis_on()
    axes.set(xticks=[], yticks=[], xlim=(start, columns.stop - 0.5), ylim=(rows.stop - 0.5, top))
    return image


def caption(maps: ContactMaps, number: int) -> str:
    """Time, contact fraction, and sites won and lost."""
    new, lost = (maps.count(number, state) for state in (SiteState.NEW, SiteState.LOST))
    percent = 100.0 * maps.area(number) / maps.sites
    changes = f", +{thousands(new)}" if number > maps.reference else ""
    changes += f" −{thousands(lost)}" if lost else ""
    # Both sides of a jump may have been kept.
    before, time, after = (maps.times[at : at + 1].tolist() for at in (number - 1, number, number + 1))
    side = ", just before" if time == after else ", just after" if time == before else ""
    return f"{_moment(maps, *time)}{side}:  {percent:.3g} %\n{counted(maps.area(number), 'site')}{changes}"


def legend(figure: Figure, maps: ContactMaps, *, topography: bool = False) -> None:
    """Explain the colors of the states that occur, and that of the topography, below all panels."""
    first = _moment(maps, float(maps.times[maps.reference]))
    words = {state: word.format(first=first) for state, word in _WORDS.items()}
    handles = swatches(maps.states, words)
    if topography and maps.indentation.any():
        handles.append(style.swatch(_YIELDED, "rough surface has yielded"))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles) or 1, frameon=False)


def swatches(states: NDArray[np.int8], words: Mapping[SiteState, str], size: float = 7) -> list[Line2D]:
    """Explain the colors of those states that occur."""
    colors = {state: color for state, color in COLORS.items() if (states == state).any()}
    return [style.swatch(color, words[state], size) for state, color in colors.items()]


def _moment(maps: ContactMaps, time: float) -> str:
    if math.isinf(time):
        return r"relaxed, $t \to \infty$"
    return f"$t$ = ${power(time)}$" + (f" {maps.time_unit}" if time else "").rstrip()


def _profile_figure(maps: ContactMaps) -> style.Drawing:
    figure = style.Drawing(figsize=(style.PAGE, 4.6))
    upper, lower = figure.subplots(2, 1, height_ratios=(3, 2))
    first, last = maps.window
    step, label = positions(maps)
    draw_profile(upper, maps, {n: _moment(maps, float(time)) for n, time in enumerate(maps.times)})
    ends = (SiteState.KEPT, SiteState.NEW)
    draw_sites(upper, maps, ends, color=style.VERMILION, label="contact at the end")
    stretch = "the whole profile" if last - first == maps.heights.size else "the stretch with most contacts"
    upper.set_title(f"The elastic surface sinks onto the rough one as it ages ({stretch})")
    upper.legend(loc="upper left", bbox_to_anchor=(1.0, 1.02), frameon=False)
    _draw_strips(lower, maps, step)
    lower.set_xlabel(label)
    legend(figure, maps)
    _tabulate(figure, maps)
    return figure


def _tabulate(figure: style.Drawing, maps: ContactMaps) -> None:
    """Let the table of a figure have the areas of the maps."""
    counts = {state: [maps.count(n, state) for n in range(len(maps.times))] for state in SiteState}
    touching = np.add(counts[SiteState.KEPT], counts[SiteState.NEW])
    time = style.with_unit("time", maps.time_unit or "1")
    figure.table = {time: maps.times, "contact [%]": 100 * touching / maps.sites}
    figure.table |= {"sites": touching, "new": counts[SiteState.NEW], "lost": counts[SiteState.LOST]}
    figure.elsewhere = "in_contact, u and heights in history.zarr"


def draw_profile(axes: Axes, maps: ContactMaps, labels: Mapping[int, str]) -> None:
    """Draw the rough profile in the stretch with most contacts, and above it some of the elastic surfaces."""
    first, last = maps.window
    step, _ = positions(maps)
    place = step * np.arange(first, last)
    heights, surfaces = of_body(maps.heights[first:last]), maps.surfaces[list(labels), first:last]
    floor = float(heights.min()) - 0.08 * float(np.ptp(surfaces) + np.ptp(heights) or 1.0)
    now = heights - maps.indentation[first:last]
    axes.fill_between(place, now, floor, step="mid", color="0.8", linewidth=0, label="rough solid")
    if (now < heights).any():
        label = "has yielded"
        axes.fill_between(place, heights, now, step="mid", color=style.PURPLE, linewidth=0, label=label)
    light, dark = np.array([0.62, 0.79, 0.93]), np.array([0.0, 0.20, 0.42])  # blue
    for number, (surface, label) in enumerate(zip(surfaces, labels.values(), strict=True)):
        shade = 1 - (len(labels) - 1 - number) / max(1, len(labels) - 1)
        color = tuple(light + shade * (dark - light))
        axes.plot(place, surface, color=color, linewidth=1.1 + 0.7 * shade, label=label)
    axes.set_xlim(step * (first - 0.5), step * (last - 0.5))
    axes.set_ylim(floor, None)
    axes.set_ylabel(style.with_unit("height", maps.unit))


def draw_sites(
    axes: Axes, maps: ContactMaps, states: Collection[SiteState], number: int = -1, **look: Any
) -> None:
    """Mark the sites of a profile that are in these states in one map, where there are such."""
    first, last = maps.window
    at = first + np.flatnonzero(np.isin(maps.states[number, first:last], list(states)))
    if at.size:
        step, _ = positions(maps)
        heights = (maps.heights - maps.indentation)[at]
        axes.plot(step * at, heights, "s", markersize=4, zorder=5, **look)


def positions(maps: ContactMaps) -> tuple[float, str]:
    """Distance between sites along a profile, and the name of its axis."""
    if maps.pixel_size is None:
        return 1.0, "site"
    length = maps.heights.size * maps.pixel_size
    label, factor = style.scaled("position", maps.length_unit, length)
    return maps.pixel_size * factor, label


def _draw_strips(axes: Axes, maps: ContactMaps, step: float) -> None:
    """One row of ticks a time, over the whole profile; contacts that were there first are drawn last."""
    tick = max(_TICK, 72 * _STRIP / maps.heights.size)
    labels = []
    for number, time in enumerate(maps.times):
        for state in (SiteState.NEW, SiteState.LOST, SiteState.KEPT):
            (at,) = np.nonzero(maps.states[number] == state)
            look: dict[str, Any] = {"color": COLORS[state], "linewidth": tick, "rasterized": True}
            axes.vlines(step * at, number - 0.38, number + 0.38, **look)
        percent = 100.0 * maps.area(number) / maps.sites
        labels.append(f"{_moment(maps, float(time))}:  {percent:.3g} %")
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    axes.set_xlim(-0.5 * step, (maps.heights.size - 0.5) * step)
    title = "Contacts along the whole profile"
    title += ", which is mirrored: one of 2 copies is shown" if maps.copies > 1 else ""
    title += "; ticks are wider than sites" if tick == _TICK else ""
    axes.set_title(title)
