"""Maps of the contact at several times, beside the topography; for a line contact, profiles."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from asperity.analysis import ContactMaps, SiteState
from asperity.figures import style
from asperity.figures.marks import COLORS, SMALLEST, draw_marks

_COLUMNS = 4
_PANEL = 2.45
"""Side of a map, inches."""

_READABLE = 1.8
"""Side of a mark that is easily seen, points."""

_INK_LIMIT = 0.3
"""Marks are not enlarged beyond this part of the map."""

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
    return _profile_figure(maps) if maps.heights.ndim == 1 else _map_figure(maps)


def _map_figure(maps: ContactMaps) -> Figure:
    panels = 1 + len(maps.times)
    columns = min(_COLUMNS, panels)
    rows = math.ceil(panels / columns)
    tall = min(3.0, max(0.4, maps.heights.shape[0] / maps.heights.shape[1]))
    figure = Figure(
        figsize=(_PANEL * columns + 0.8, (_PANEL * tall + 0.4) * rows + 0.7), layout="constrained"
    )
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for unused in grid[panels:]:
        unused.set_axis_off()
    image = grid[0].imshow(
        maps.heights,
        cmap=style.HEIGHT_MAP,
        clim=maps.height_range,
        interpolation="antialiased",
        rasterized=True,
    )
    grid[0].set_title("rough surface", fontsize=9)
    figure.colorbar(
        image,
        ax=grid[0],
        location="left",
        shrink=0.9,
        label=style.with_unit("height", maps.unit),
        pad=0.02,
        extend="both",
    )
    enlarged = _enlarged_side(maps, maps.heights.shape)
    for number, axes in enumerate(grid[1:panels]):
        if enlarged is None:
            _draw_sites(axes, maps, number)
        else:
            draw_marks(axes, maps.states[number], enlarged)
        axes.set_title(_caption(maps, number), fontsize=8.5)
    for axes in grid[:panels]:
        axes.set_xticks([])
        axes.set_yticks([])
    note = f"each panel: {maps.heights.shape[0]} × {maps.heights.shape[1]} sites"
    if enlarged is not None:
        note += "; marks are larger than a site"
    figure.suptitle(f"Where the solids touch as the contact ages  ({note})", fontsize=11)
    _legend(figure, maps)
    return figure


def _draw_sites(axes: Axes, maps: ContactMaps, number: int) -> None:
    """Color each site; where sites are smaller than the pixels of the figure, shades show their density."""
    states = maps.states[number]
    palette = np.ones((len(SiteState), 3))
    for state, color in COLORS.items():
        palette[state] = to_rgb(color)
    axes.imshow(palette[states], interpolation="antialiased", interpolation_stage="rgba", rasterized=True)


def _caption(maps: ContactMaps, number: int) -> str:
    """Time, contact fraction, and sites won and lost."""
    new, lost = (maps.count(number, state) for state in (SiteState.NEW, SiteState.LOST))
    percent = 100.0 * maps.area(number) / maps.heights.size
    changes = f", +{style.count(new)}" if number else ""
    changes += f" −{style.count(lost)}" if lost else ""
    moment = _moment(float(maps.times[number]))
    return f"{moment}:  {percent:.3g} %\n{style.count(maps.area(number))} sites{changes}"


def _legend(figure: Figure, maps: ContactMaps) -> None:
    first = _moment(float(maps.times[0]))
    handles = [
        Line2D([], [], ls="", marker="s", markersize=7, color=color, label=_WORDS[state].format(first=first))
        for state, color in COLORS.items()
        if (maps.states == state).any()
    ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles) or 1, fontsize=9, frameon=False
    )


def _enlarged_side(maps: ContactMaps, shape: tuple[int, ...]) -> float | None:
    """Side of a mark in points, where contacts are so few and small that they must be enlarged to be seen.

    None where sites are large enough as they are, or contacts too many for larger marks.
    """
    site = 72 * _PANEL * 0.93 / shape[1]
    fullest = max(maps.area(number) for number in range(len(maps.times))) / maps.heights.size
    if site >= _READABLE or fullest == 0:
        return None
    bearable = min(_READABLE, site * math.sqrt(_INK_LIMIT / fullest))
    return bearable if bearable >= max(SMALLEST, 1.2 * site) else None


def _moment(time: float) -> str:
    if math.isinf(time):
        return r"relaxed, $t \to \infty$"
    return f"$t$ = ${style.power(time)}$"


def _profile_figure(maps: ContactMaps) -> Figure:
    figure = Figure(figsize=(8.0, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, height_ratios=(3, 2))
    first, last = maps.window
    here = np.arange(first, last)
    heights = maps.heights[first:last]
    surfaces = maps.surfaces[:, first:last]
    floor = float(heights.min()) - 0.08 * float(np.ptp(surfaces) + np.ptp(heights) or 1.0)
    upper.fill_between(here, heights, floor, step="mid", color="0.8", linewidth=0, label="rough solid")
    for number, time in enumerate(maps.times):
        shade = number / max(1, len(maps.times) - 1)
        upper.plot(
            here,
            surfaces[number],
            color=_shade(shade),
            linewidth=1.1 + 0.7 * shade,
            label=_moment(float(time)),
        )
    touching = np.isin(maps.states[-1, first:last], (SiteState.KEPT, SiteState.NEW))
    upper.plot(
        here[touching],
        heights[touching],
        "s",
        color=style.VERMILION,
        markersize=4,
        zorder=5,
        label="contact at the end",
    )
    upper.set_xlim(first - 0.5, last - 0.5)
    upper.set_ylim(floor, None)
    upper.set_ylabel(style.with_unit("height", maps.unit))
    stretch = "the whole profile" if last - first == maps.heights.size else "the stretch with most contacts"
    upper.set_title(f"The elastic surface sinks onto the rough one as it ages ({stretch})", fontsize=10)
    upper.legend(fontsize=7.5, ncols=2, loc="best", framealpha=0.95)
    _draw_strips(lower, maps)
    _legend(figure, maps)
    return figure


def _draw_strips(axes: Axes, maps: ContactMaps) -> None:
    """One row of ticks a time, over the whole profile."""
    labels = []
    for number, time in enumerate(maps.times):
        for state, color in COLORS.items():
            (at,) = np.nonzero(maps.states[number] == state)
            axes.vlines(at, number - 0.38, number + 0.38, color=color, linewidth=0.9, rasterized=True)
        percent = 100.0 * maps.area(number) / maps.heights.size
        labels.append(f"{_moment(float(time))}:  {percent:.3g} %")
    axes.set_yticks(range(len(labels)), labels, fontsize=8)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    axes.set_xlim(-0.5, maps.heights.size - 0.5)
    axes.set_xlabel("site")
    axes.set_title("Contacts along the whole profile", fontsize=10)


def _shade(part: float) -> tuple[float, float, float]:
    """From light to dark blue."""
    light, dark = (0.62, 0.79, 0.93), (0.0, 0.20, 0.42)
    red, green, blue = (a + part * (b - a) for a, b in zip(light, dark, strict=True))
    return red, green, blue
