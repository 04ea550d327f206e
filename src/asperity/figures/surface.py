"""A measured surface: height map, histogram and profile."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import LogLocator, NullFormatter

from asperity.analysis.maps import color_range
from asperity.base import checks
from asperity.base.readable import is_length, readable
from asperity.base.words import uncertain
from asperity.figures import style
from asperity.lattice import Field
from asperity.surfaces import PowerSpectrum, Surface, power_spectrum
from asperity.surfaces.prepare import of_body
from asperity.surfaces.provenance import lateral_unit

_PAD = 0.15
"""Room around each panel, inches: tick labels reach beyond their axes."""

_ROUNDING = 1e-18
"""Part of the largest power below which nothing is drawn."""


class SurfaceView:
    """A surface as it is shown: the measured part of it, not its mirror images, in readable units.

    `unit` is that of the `heights`, "1" or a power of ten such as "1e-06" if unknown; `length_unit` that of
    the axes and of the `pixel_size` along each, "pixel" if unknown; `factor` and `across` lead to them.
    `height_range` is what colors tell apart.
    """

    def __init__(self, surface: Surface) -> None:
        heights = of_body(surface.scan.heights)
        self.unit, self.factor = readable(surface.unit, float(np.ptp(heights)))
        self.heights = heights * self.factor
        self.height_range = color_range(surface.scan.heights * self.factor)
        self.length_unit, self.across = "pixel", 1.0
        self.pixel_size = (1.0,) * heights.ndim
        if surface.pixel_size is not None:
            longest = max(n * s for n, s in zip(heights.shape, surface.pixel_size, strict=True))
            unit = lateral_unit(surface.length_unit, surface.provenance)
            self.length_unit, self.across = readable(unit, longest)
            self.pixel_size = tuple(s * self.across for s in surface.pixel_size)

    def along(self, axis: int, site: float | Field) -> Field:
        """Where sites along an axis are, in `length_unit`."""
        return np.asarray((np.asarray(site) + 0.5) * self.pixel_size[axis])

    def profile(self) -> tuple[Field, Field]:
        """Positions and heights along the horizontal middle line of the picture."""
        heights = self.heights if self.heights.ndim == 1 else self.heights[self.heights.shape[0] // 2]
        return self.along(-1, np.arange(heights.size)), heights

    def histogram(self) -> tuple[Field, Field, Field]:
        """Edges of bins, shape ``(k + 1,)``, and in each the probability per unit height, ``(k,)``.

        At the middle of each the Gaussian of the same mean and rms too; NaN for a flat surface.
        """
        heights = np.ma.compressed(self.heights)
        # At most 80 bins, and about 20 heights a bin for short profiles; one bin for a flat surface.
        bins = int(np.clip(heights.size // 20, 1, 80)) if heights.min() < heights.max() else 1
        density, edges = np.histogram(heights, bins=bins, density=True)
        if bins == 1:
            return edges, density, np.full(1, np.nan)
        middles, rms = (edges[:-1] + edges[1:]) / 2, float(heights.std())
        normal = np.exp(-0.5 * ((middles - heights.mean()) / rms) ** 2) / (rms * np.sqrt(2 * np.pi))
        return edges, density, normal


@style.drawn
def surface_figure(
    surface: Surface, *, title: str, note: str = "", spectrum: PowerSpectrum | None = None
) -> style.Drawing:
    """Draw a surface: map (if it has two axes), profile, histogram of the heights, and power spectrum.

    Parameters
    ----------
    surface
        From `asperity.surfaces.read`, or made of an array: ``Surface(heights)``.
    title
        What it is, such as the name of the file.
    note
        What must be said about it, such as how many pixels were undefined; may be empty.
    spectrum
        Its power spectrum, if it has been measured already.

    Raises
    ------
    InputError
        It is no `Surface`.
    """
    checks.instance("surface", surface, Surface, "asperity.surfaces.Surface(heights)")
    view = SurfaceView(surface)
    flat = view.heights.ndim == 2
    figure = style.Drawing(figsize=(style.PAGE, 5.6 if flat else 4.4))
    figure.set_layout_engine(ConstrainedLayoutEngine(w_pad=_PAD, h_pad=_PAD / 2))
    grid: list[Any] = [["profile", "profile"], ["heights", "waves"]]
    ratios: dict[str, Any] = {}
    if flat:
        grid = [["map", "waves"], ["profile", "heights"]]
        ratios = {"width_ratios": (1.2, 1), "height_ratios": (1.5, 1)}
    panels = figure.subplot_mosaic(grid, **ratios)
    if flat:
        draw_map(panels["map"], view)
        middle = float(view.along(0, view.heights.shape[0] // 2))
        panels["map"].axhline(middle, color="white", linestyle="--", linewidth=1.0)
    panels["profile"].set_title("profile along the dashed line" if flat else "profile")
    draw_heights(panels["profile"], view)
    _draw_histogram(panels["heights"], view)
    if np.ma.is_masked(view.heights):
        panels["waves"].set_axis_off()  # a body that ends has no spectrum
    else:
        draw_spectrum(panels["waves"], spectrum or power_spectrum(surface), view)
    figure.elsewhere = "the surface itself" * flat
    style.entitle(figure, style.lines([title], figure.room), note.split(", ") if note else [])
    return figure


def draw_heights(axes: Axes, view: SurfaceView) -> None:
    """Draw the heights of a profile, or along the middle line of a surface."""
    axes.plot(*view.profile(), color=style.INK, linewidth=0.8)
    along, height = style.with_unit("position", view.length_unit), style.with_unit("height", view.unit)
    axes.set(xlabel=along, ylabel=height, xmargin=0)


def draw_map(axes: Axes, view: SurfaceView) -> None:
    """Draw the heights of a surface, with axes in its unit of length."""
    look = {"cmap": style.HEIGHT_MAP, "clim": view.height_range}
    image = style.show_map(axes, view.heights, view.pixel_size, view.length_unit, **look)
    axes.set_title("height map")
    label = style.with_unit("height", view.unit)
    axes.figure.colorbar(image, ax=axes, label=label, shrink=0.85, extend="both")


def _draw_histogram(axes: Axes, view: SurfaceView) -> None:
    edges, density, normal = view.histogram()
    axes.stairs(density, edges, fill=True, color=style.SKY, label="pixels")
    if np.isfinite(normal).all():
        middles = (edges[:-1] + edges[1:]) / 2
        axes.plot(middles, normal, "--", color=style.INK, linewidth=1.2, label="Gaussian, same rms")
        axes.margins(y=0.45)  # room for the legend
        axes.legend(loc="upper left", framealpha=0.9)
    unit = style.spelled(view.unit)
    per = f"1/({unit})" if " " in unit else f"1/{unit}"
    axes.set_xlabel(style.with_unit("height", view.unit))
    axes.set_ylabel("density" if view.unit == "1" else f"density [{per}]")
    axes.set_title("heights")


def draw_spectrum(axes: Axes, spectrum: PowerSpectrum, view: SurfaceView | None = None) -> None:
    """Draw a power spectrum, with the power law of its self-affine range; of a view, in its units."""
    dimensions, up, across = len(spectrum.along), 1.0, 1.0
    unit, length_unit = spectrum.unit, spectrum.length_unit
    if view is not None:
        across, length_unit = view.across, view.length_unit
        if is_length(view.unit):
            up, unit = view.factor, view.unit
    scale = up**2 * across**dimensions
    # What a surface of smooth waves has beyond the shortest of them is rounding.
    shown = spectrum.power > _ROUNDING * spectrum.power.max(initial=0.0)
    label = "mean over directions" if dimensions == 2 else "mean over bins"
    look: dict[str, Any] = {"color": style.BLUE, "markersize": 3.5, "label": label}
    axes.loglog(spectrum.wave_number[shown] / across, scale * spectrum.power[shown], "o", **look)
    fit = spectrum.fit
    if fit is not None:
        q = 2 * np.pi / np.array([fit.longest, fit.shortest])
        label = f"H = {uncertain(fit.hurst, fit.interval[1] - fit.hurst)} (95 %)"
        axes.loglog(q / across, scale * fit.power(q), color=style.VERMILION, linewidth=1.5, label=label)
    if shown.any():
        axes.legend(loc="lower left", framealpha=0.9)
    else:
        axes.text(0.5, 0.5, "none", transform=axes.transAxes, ha="center")
    axes.set_xlabel(f"wave number q [1/{style.spelled(length_unit)}]")
    axes.set_ylabel(f"power spectrum C(q) [{_power_unit(unit, length_unit, dimensions)}]")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_major_locator(LogLocator(numticks=5))
    axes.set_title("power spectrum" + f", {spectrum.window} window" * (spectrum.window != "none"))


def _power_unit(unit: str, length_unit: str, dimensions: int) -> str:
    """Unit of C(q): that of the heights squared, times that of the lengths, for each axis."""
    height, length = map(style.spelled, (unit, length_unit))
    length = f"({length})" if " " in length else length
    if unit == length_unit:
        return f"{style.spelled(unit)}{'³⁴'[dimensions - 1]}"
    across = f"{length}²" if dimensions == 2 else style.spelled(length_unit)
    return across if unit == "1" else f"{height}² {across}"
