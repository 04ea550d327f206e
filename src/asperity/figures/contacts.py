"""Maps of the contact at several times, beside the topography; for a line contact, profiles."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize, to_rgb, to_rgba
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from asperity.analysis import ContactMaps, SiteState
from asperity.analysis.scan import readable, written
from asperity.base import checks
from asperity.base.words import counted, power, thousands
from asperity.figures import style
from asperity.figures.marks import COLORS
from asperity.lattice import Field

_COLUMNS = 4
_PANEL = 2.45
"""Side of a map with its surroundings, inches."""

_FILLED = 0.93
"""Part of it that the map takes."""

_SMALLEST = 1.5
"""Smallest side of a mark that is easily seen, pixels of `style.RESOLUTION`."""

_YIELDED = to_rgba(style.PURPLE)
"""Color of what the rough surface has lost where it yielded."""

_STRIP, _TICK = 5.5, 0.4
"""Width of a whole profile, inches; least width of a tick, points."""

_WORDS = {
    SiteState.KEPT: "in contact then and at {first}",
    SiteState.NEW: "new: not in contact at {first}",
    SiteState.LOST: "lost: in contact only at {first}",
}


def contact_figure(maps: ContactMaps) -> Figure:
    """Draw which sites touch at each time: since the first map, newly, or no longer.

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


def _map_figure(maps: ContactMaps) -> Figure:
    """Topography and maps; where sites are too small to be seen, a coarser sample above close-ups."""
    shape = maps.heights.shape
    panels = 1 + len(maps.times)
    columns = min(_COLUMNS, panels)
    rows = math.ceil(panels / columns)
    tall = min(3.0, max(0.4, maps.aspect * shape[0] / shape[1]))
    side = side_of_cells(maps, _PANEL * _FILLED * min(1.0, 3.0 * shape[1] / shape[0]))
    heights = [tall, 1.0] * rows if side > 1 else [tall] * rows
    figure = style.Drawing(
        figsize=(_PANEL * columns + 0.8, sum(_PANEL * height + 0.4 for height in heights) + 0.9),
        layout="constrained",
    )
    grid = figure.subplots(len(heights), columns, squeeze=False, height_ratios=heights)
    for axes in grid.ravel():
        axes.set_axis_off()
    whole = (grid[::2] if side > 1 else grid).ravel()
    everything = everywhere(maps)
    image = draw_heights(whole[0], maps, everything)
    deepest = style.spaced(written(float(maps.indentation.max()), maps.unit, 2))
    yielded = f"\nhas yielded by up to {deepest}" if maps.indentation.any() else ""
    whole[0].set_title(f"rough surface{yielded}", fontsize=8.5 if yielded else 9)
    figure.colorbar(
        image,
        ax=whole[0],
        location="left",
        shrink=0.9,
        label=style.with_unit("height", maps.unit),
        pad=0.02,
        extend="both",
    )
    states = maps.sampled(side) if side > 1 else maps.states
    for number, axes in enumerate(whole[1:panels]):
        draw_states(axes, states[number], everything, side, maps.aspect)
        axes.set_title(caption(maps, number), fontsize=8.5)
    if side > 1:
        _draw_close_ups(maps, whole[0], grid[1::2].ravel())
    figure.suptitle(_title(maps, side, figure), fontsize=10)
    legend(figure, maps, topography=True)
    return figure


def side_of_cells(maps: ContactMaps, width: float) -> int:
    """Sites along a side of the smallest cell that is seen in a map so many inches wide."""
    columns: int = maps.heights.shape[1]
    return math.ceil(_SMALLEST * columns / (style.RESOLUTION * width))


def everywhere(maps: ContactMaps) -> tuple[slice, slice]:
    """Region that is the whole map."""
    rows, columns = maps.heights.shape
    return slice(0, rows), slice(0, columns)


def _title(maps: ContactMaps, side: int, figure: style.Drawing) -> str:
    """Say what the maps show, and at which scale."""
    sites = " × ".join(map(str, maps.heights.shape))
    size = ""
    if maps.pixel_size is not None:
        unit, factor = readable(maps.length_unit, maps.pixel_size)
        across = maps.pixel_size * factor
        sides = (
            [f"{across:.4g}"]
            if abs(maps.aspect - 1) < 0.01
            else [f"{across * maps.aspect:.4g}", f"{across:.4g}"]
        )
        size = f" of {' × '.join(sides)} {style.spelled(unit)}"
    parts = [f"each map: {sites} sites{size}"]
    if maps.copies > 1:
        parts.append(f"the scan is mirrored: one of {maps.copies} copies is shown")
    if side > 1:
        parts.append(
            f"of {side**2} sites in contact one is drawn, {side} × {side} sites large, so that areas are true"
        )
        parts.append("below each map: the framed square, site by site")
    said = style.lines(parts, figure.room)
    return f"Where the solids touch as the contact ages\n{said}"


def _draw_close_ups(maps: ContactMaps, topography: Axes, below: NDArray[np.object_]) -> None:
    rows, columns = region = maps.close_up()
    topography.add_patch(
        Rectangle(
            (columns.start - 0.5, rows.start - 0.5),
            columns.stop - columns.start,
            rows.stop - rows.start,
            fill=False,
            edgecolor="white",
            linewidth=1.2,
        )
    )
    draw_heights(below[0], maps, region)
    for number, axes in enumerate(below[1 : 1 + len(maps.times)]):
        draw_states(axes, maps.states[number, rows, columns], region, 1, maps.aspect)


def draw_heights(axes: Axes, maps: ContactMaps, region: tuple[slice, slice]) -> AxesImage:
    """Topography of a region, what of it has yielded, and below a scale bar where a pixel's size is known."""
    image = axes.imshow(
        maps.heights[region],
        cmap=style.HEIGHT_MAP,
        clim=maps.height_range,
        extent=_extent(region),
        interpolation="antialiased",
        aspect=maps.aspect,
        rasterized=True,
    )
    if (yielded := maps.indentation[region] > 0).any():
        _draw_cells(axes, np.array(_YIELDED) * yielded[..., np.newaxis], region, 1, maps.aspect)
    _frame(axes, region)
    draw_scale_bar(axes, maps, region)
    return image


def draw_scale_bar(axes: Axes, maps: ContactMaps, region: tuple[slice, slice]) -> None:
    """Draw a round length below a map of a region, where the size of a pixel is known."""
    columns = region[1]
    if bar := maps.scale_bar(columns.stop - columns.start):
        sites, length, unit = bar
        start = columns.start - 0.5
        mixed = axes.get_xaxis_transform()  # sites along, parts of the axes across
        axes.plot(
            [start, start + sites],
            [-0.04, -0.04],
            color=style.INK,
            linewidth=2.5,
            transform=mixed,
            clip_on=False,
        )
        axes.text(
            start + sites,
            -0.04,
            f"  {length:g} {style.spelled(unit)}",
            transform=mixed,
            va="center",
            fontsize=8.5,
        )


def _frame(axes: Axes, region: tuple[slice, slice]) -> None:
    left, right, bottom, top = _extent(region)
    axes.set_axis_on()
    axes.set(xticks=[], yticks=[], xlim=(left, right), ylim=(bottom, top))


def _extent(region: tuple[slice, slice]) -> tuple[float, float, float, float]:
    """Left, right, lower and upper end; the first axis runs downward."""
    rows, columns = region
    return columns.start - 0.5, columns.stop - 0.5, rows.stop - 0.5, rows.start - 0.5


def draw_states(
    axes: Axes, states: NDArray[np.int8], region: tuple[slice, slice], side: int, aspect: float
) -> AxesImage:
    """Color each cell of side x side sites."""
    return _draw_cells(axes, colored(states), region, side, aspect)


def _draw_cells(
    axes: Axes,
    cells: Field,
    region: tuple[slice, slice],
    side: int,
    aspect: float,
    norm: Normalize | None = None,
) -> AxesImage:
    """Draw cells of side x side sites: their colors, or values on the scale of pressures."""
    image = axes.imshow(
        cells,
        cmap=style.PRESSURE_MAP,
        norm=norm,
        extent=_extent_of_cells(cells.shape[:2], region, side),
        interpolation="antialiased",
        interpolation_stage="rgba",
        aspect=aspect,
        rasterized=True,
    )
    _frame(axes, region)
    return image


def colored(states: NDArray[np.int8]) -> Field:
    """Colors of sites or cells: red, green and blue along the last axis."""
    palette = np.ones((len(SiteState), 3))
    for state, color in COLORS.items():
        palette[state] = to_rgb(color)
    return palette[states]


def draw_pressure(
    axes: Axes, pressure: Field, norm: Normalize, region: tuple[slice, slice], side: int, aspect: float
) -> AxesImage:
    """Color each cell of side x side sites by its pressure; without contact it is NaN."""
    axes.set_facecolor("0.93")
    return _draw_cells(axes, pressure, region, side, aspect, norm)


def _extent_of_cells(
    cells: tuple[int, ...], region: tuple[slice, slice], side: int
) -> tuple[float, float, float, float]:
    """Left, right, lower and upper end; the last cells may reach beyond the region."""
    top, left = (part.start - 0.5 for part in region)
    return left, left + side * cells[1], top + side * cells[0], top


def caption(maps: ContactMaps, number: int) -> str:
    """Time, contact fraction, and sites won and lost."""
    new, lost = (maps.count(number, state) for state in (SiteState.NEW, SiteState.LOST))
    percent = 100.0 * maps.area(number) / maps.heights.size
    changes = f", +{thousands(new)}" if number else ""
    changes += f" −{thousands(lost)}" if lost else ""
    moment = _moment(maps, float(maps.times[number])) + _side(maps, number)
    return f"{moment}:  {percent:.3g} %\n{counted(maps.area(number), 'site')}{changes}"


def _side(maps: ContactMaps, number: int) -> str:
    """On which side of a jump a map is, where both were kept."""
    before, time, after = (maps.times[at : at + 1].tolist() for at in (number - 1, number, number + 1))
    return ", just before" if time == after else ", just after" if time == before else ""


def legend(figure: Figure, maps: ContactMaps, *, topography: bool = False) -> None:
    """Explain the colors of the states that occur, and that of the topography, below all panels."""
    first = _moment(maps, float(maps.times[0]))
    found = {state: color for state, color in COLORS.items() if (maps.states == state).any()}
    handles = [style.swatch(color, _WORDS[state].format(first=first)) for state, color in found.items()]
    if topography and maps.indentation.any():
        handles.append(style.swatch(_YIELDED, "rough surface has yielded"))
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles) or 1, fontsize=9, frameon=False
    )


def _moment(maps: ContactMaps, time: float) -> str:
    if math.isinf(time):
        return r"relaxed, $t \to \infty$"
    return f"$t$ = ${power(time)}$" + (f" {maps.time_unit}" if time else "").rstrip()


def _profile_figure(maps: ContactMaps) -> Figure:
    figure = style.Drawing(figsize=(8.0, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, height_ratios=(3, 2))
    first, last = maps.window
    step, label = positions(maps)
    draw_profile(upper, maps, [_moment(maps, float(time)) for time in maps.times])
    touching = np.isin(maps.states[-1, first:last], (SiteState.KEPT, SiteState.NEW))
    upper.plot(
        step * np.arange(first, last)[touching],
        (maps.heights - maps.indentation)[first:last][touching],
        "s",
        color=style.VERMILION,
        markersize=4,
        zorder=5,
        label="contact at the end",
    )
    stretch = "the whole profile" if last - first == maps.heights.size else "the stretch with most contacts"
    upper.set_title(f"The elastic surface sinks onto the rough one as it ages ({stretch})", fontsize=10)
    upper.legend(fontsize=7.5, loc="upper left", bbox_to_anchor=(1.0, 1.02), frameon=False)
    _draw_strips(lower, maps, step)
    lower.set_xlabel(label)
    legend(figure, maps)
    return figure


def draw_profile(axes: Axes, maps: ContactMaps, labels: list[str]) -> None:
    """Draw the rough profile in the stretch with most contacts, and above it the elastic surfaces."""
    first, last = maps.window
    step, _ = positions(maps)
    here = step * np.arange(first, last)
    heights, surfaces = maps.heights[first:last], maps.surfaces[:, first:last]
    floor = float(heights.min()) - 0.08 * float(np.ptp(surfaces) + np.ptp(heights) or 1.0)
    now = heights - maps.indentation[first:last]
    axes.fill_between(here, now, floor, step="mid", color="0.8", linewidth=0, label="rough solid")
    if (now < heights).any():
        label = "what has yielded"
        axes.fill_between(here, heights, now, step="mid", color=style.PURPLE, linewidth=0, label=label)
    for number, (surface, label) in enumerate(zip(surfaces, labels, strict=True)):
        shade = 1 - (len(labels) - 1 - number) / max(1, len(labels) - 1)
        axes.plot(here, surface, color=_shade(shade), linewidth=1.1 + 0.7 * shade, label=label)
    axes.set_xlim(step * (first - 0.5), step * (last - 0.5))
    axes.set_ylim(floor, None)
    axes.set_ylabel(style.with_unit("height", maps.unit))


def positions(maps: ContactMaps) -> tuple[float, str]:
    """Distance between sites along a profile, and the name of its axis."""
    if maps.pixel_size is None:
        return 1.0, "site"
    unit, factor = readable(maps.length_unit, maps.heights.size * maps.pixel_size)
    return maps.pixel_size * factor, style.with_unit("position", unit)


def _draw_strips(axes: Axes, maps: ContactMaps, step: float) -> None:
    """One row of ticks a time, over the whole profile; contacts that were there first are drawn last."""
    tick = max(_TICK, 72 * _STRIP / maps.heights.size)
    labels = []
    for number, time in enumerate(maps.times):
        for state in (SiteState.NEW, SiteState.LOST, SiteState.KEPT):
            (at,) = np.nonzero(maps.states[number] == state)
            axes.vlines(
                step * at, number - 0.38, number + 0.38, color=COLORS[state], linewidth=tick, rasterized=True
            )
        percent = 100.0 * maps.area(number) / maps.heights.size
        labels.append(f"{_moment(maps, float(time))}:  {percent:.3g} %")
    axes.set_yticks(range(len(labels)), labels, fontsize=8)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    axes.set_xlim(-0.5 * step, (maps.heights.size - 0.5) * step)
    title = "Contacts along the whole profile"
    title += ", which is mirrored: one of 2 copies is shown" if maps.copies > 1 else ""
    title += "; ticks are wider than sites" if tick == _TICK else ""
    axes.set_title(title, fontsize=10)


def _shade(part: float) -> tuple[float, float, float]:
    """From light to dark blue."""
    light, dark = (0.62, 0.79, 0.93), (0.0, 0.20, 0.42)
    red, green, blue = (a + part * (b - a) for a, b in zip(light, dark, strict=True))
    return red, green, blue
