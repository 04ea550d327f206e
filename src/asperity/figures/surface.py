"""A measured surface: height map, histogram and profile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import asperity.checks as checks
from asperity.analysis.maps import color_range
from asperity.analysis.scan import measured_part, readable
from asperity.figures import style
from asperity.lattice import Field
from asperity.surfaces import Surface

_PAD = 0.15
"""Room around each panel, inches: tick labels reach beyond their axes."""


@dataclass(frozen=True, eq=False)
class SurfaceView:
    """A surface as it is shown: its measured part, its axes, a histogram and a profile.

    Attributes
    ----------
    heights
        The measured part of the surface: not its mirror images. Shape ``(n,)`` or ``(n, m)``.
    unit, length_unit
        Units of the heights ("1" or a power of ten, such as "1e-06", if unknown) and of the axes ("pixel" if
        unknown). Lengths are given in the unit that makes the numbers readable, which need not be the
        surface's.
    pixel_size
        Distance between sites along each axis in `length_unit`.
    height_range
        As in `asperity.analysis.ContactMaps`.
    bin_edges, density
        Histogram of the heights: edges, shape ``(k + 1,)``, and probability per unit height, ``(k,)``.
    normal_density
        The Gaussian of the same mean and rms, at the middles of the bins.
    profile_position, profile
        The heights along the horizontal middle line of the picture.
    middle
        Where this line is, along the other axis; 0 for a profile.
    """

    heights: Field
    unit: str
    length_unit: str
    pixel_size: tuple[float, ...]
    height_range: tuple[float, float]
    bin_edges: Field
    density: Field
    normal_density: Field
    profile_position: Field
    profile: Field
    middle: float


def surface_figure(surface: Surface, *, title: str, note: str = "") -> Figure:
    """Draw a surface: map (if it has two axes), histogram of the heights, and profile.

    Parameters
    ----------
    surface
        From `asperity.surfaces.read`, or made of an array: ``Surface(heights)``.
    title
        What it is, such as the name of the file.
    note
        What must be said about it, such as how many pixels were undefined; may be empty.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        It is no `Surface`.
    """
    view = surface_view(checks.instance("surface", surface, Surface, "asperity.surfaces.Surface(heights)"))
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


def surface_view(surface: Surface) -> SurfaceView:
    """Prepare a surface for drawing."""
    heights = surface.heights[measured_part(surface.shape, surface.provenance)]
    unit, factor = readable(surface.unit, float(np.ptp(heights)))
    heights = heights * factor
    size, length_unit = _axes(surface, heights.shape)
    middle = heights.shape[0] // 2
    profile = heights if heights.ndim == 1 else heights[middle]
    # At most 80 bins, and about 20 heights a bin for short profiles; one bin for a flat surface.
    bins = int(np.clip(heights.size // 20, 1, 80)) if heights.min() < heights.max() else 1
    density, edges = np.histogram(heights, bins=bins, density=True)
    middles = (edges[:-1] + edges[1:]) / 2
    rms = float(heights.std())
    normal = (
        np.exp(-0.5 * ((middles - heights.mean()) / rms) ** 2) / (rms * np.sqrt(2 * np.pi))
        if bins > 1
        else np.full(1, np.nan)
    )
    return SurfaceView(
        heights=heights,
        unit=unit,
        length_unit=length_unit,
        pixel_size=size,
        height_range=color_range(heights),
        bin_edges=edges,
        density=density,
        normal_density=normal,
        profile_position=(np.arange(profile.size) + 0.5) * size[-1],
        profile=profile,
        middle=(middle + 0.5) * size[0] if heights.ndim == 2 else 0.0,
    )


def _axes(surface: Surface, shape: tuple[int, ...]) -> tuple[tuple[float, ...], str]:
    """Pixel size and its unit."""
    if surface.pixel_size is None:
        return (1.0,) * len(shape), "pixel"
    unit = surface.length_unit or "unit of the file"
    longest = max(n * s for n, s in zip(shape, surface.pixel_size, strict=True))
    shown, factor = readable(unit, longest)
    return tuple(s * factor for s in surface.pixel_size), shown


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
