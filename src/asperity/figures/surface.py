"""A measured surface: height map, histogram and profile."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.analysis import SurfaceView
from asperity.figures import style

_PAD = 0.15
"""Room around each panel, inches: tick labels reach beyond their axes."""


def surface_figure(view: SurfaceView, *, title: str, note: str = "") -> Figure:
    """Draw a surface: map (if it has two axes), histogram of the heights, and profile.

    Parameters
    ----------
    view
        From `asperity.analysis.surface_view`.
    title
        What it is, such as the name of the file.
    note
        What must be said about it, such as how many pixels were undefined; may be empty.

    Returns
    -------
    Figure
    """
    figure = style.Drawing(figsize=(9.0, 4.4) if view.heights.ndim == 2 else (7.6, 4.6), layout="constrained")
    engine = figure.get_layout_engine()
    assert engine is not None
    engine.set(w_pad=_PAD, h_pad=_PAD / 2)  # type: ignore[call-arg]
    if view.heights.ndim == 2:
        grid = figure.add_gridspec(2, 2, width_ratios=(1.35, 1))
        _draw_map(figure, figure.add_subplot(grid[:, 0]), view)
        profile, histogram = figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1])
        profile.set_title("profile along the dashed line", fontsize=9)
    else:
        profile, histogram = figure.subplots(2, 1)
        profile.set_title("profile", fontsize=9)
    profile.plot(view.profile_position, view.profile, color=style.INK, linewidth=0.8)
    profile.set_xlabel(style.with_unit("position", view.length_unit))
    profile.set_ylabel(style.with_unit("height", view.unit))
    profile.margins(x=0)
    _draw_histogram(histogram, view)
    about = [title, *(style.lines(note.split(", "), figure.room).split("\n") if note else [])]
    about[0] = style.lines([title], figure.room)
    figure.suptitle("\n".join(about), fontsize=10)
    return figure


def _draw_map(figure: Figure, axes: Axes, view: SurfaceView) -> None:
    rows, columns = view.heights.shape
    image = axes.imshow(
        view.heights,
        cmap=style.HEIGHT_MAP,
        clim=view.height_range,
        extent=(0.0, columns * view.pixel_size[1], rows * view.pixel_size[0], 0.0),
        interpolation="antialiased",
        rasterized=True,
    )
    axes.axhline(view.middle, color="white", linestyle="--", linewidth=1.0)
    axes.set_xlabel(style.with_unit("x", view.length_unit))
    axes.set_ylabel(style.with_unit("y", view.length_unit))
    axes.set_title("height map", fontsize=9)
    figure.colorbar(image, ax=axes, label=style.with_unit("height", view.unit), shrink=0.85, extend="both")


def _draw_histogram(axes: Axes, view: SurfaceView) -> None:
    axes.stairs(view.density, view.bin_edges, fill=True, color=style.SKY, label="pixels")
    if np.isfinite(view.normal_density).all():
        middles = (view.bin_edges[:-1] + view.bin_edges[1:]) / 2
        axes.plot(
            middles, view.normal_density, "--", color=style.INK, linewidth=1.2, label="Gaussian, same rms"
        )
        axes.margins(y=0.45)  # room for the legend
        axes.legend(fontsize=7, loc="upper left", framealpha=0.9)
    unit = style.spelled(view.unit)
    per = f"1/({unit})" if " " in unit else f"1/{unit}"
    axes.set_xlabel(style.with_unit("height", view.unit))
    axes.set_ylabel("density" if view.unit == "1" else f"density [{per}]")
    axes.set_title("heights", fontsize=9)
