"""A measured surface: height map, histogram and profile."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

import asperity.checks as checks
from asperity.analysis.maps import color_range
from asperity.analysis.scan import readable
from asperity.figures import style
from asperity.lattice import Field
from asperity.surfaces import PowerSpectrum, Surface, power_spectrum
from asperity.surfaces.prepare import is_length
from asperity.words import uncertain

_PAD = 0.15
"""Room around each panel, inches: tick labels reach beyond their axes."""

_ROUNDING = 1e-18
"""Part of the largest power below which nothing is drawn."""


@dataclass(frozen=True, eq=False)
class HeightView:
    """The heights of a surface as they are shown.

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
    """

    heights: Field
    unit: str
    length_unit: str
    pixel_size: tuple[float, ...]
    height_range: tuple[float, float]


@dataclass(frozen=True, eq=False)
class SurfaceView(HeightView):
    """A surface as it is shown: besides its heights a histogram, a profile and its power spectrum.

    Attributes
    ----------
    heights, unit, length_unit, pixel_size, height_range
        As in `HeightView`.
    bin_edges, density
        Histogram of the heights: edges, shape ``(k + 1,)``, and probability per unit height, ``(k,)``.
    normal_density
        The Gaussian of the same mean and rms, at the middles of the bins.
    profile_position, profile
        The heights along the horizontal middle line of the picture.
    middle
        Where this line is, along the other axis; 0 for a profile.
    spectrum
        The power spectrum, in `unit` where that is a length, else in the surface's, and in `length_unit`.
    """

    bin_edges: Field
    density: Field
    normal_density: Field
    profile_position: Field
    profile: Field
    middle: float
    spectrum: PowerSpectrum


def surface_figure(
    surface: Surface, *, title: str, note: str = "", spectrum: PowerSpectrum | None = None
) -> Figure:
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

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        It is no `Surface`.
    """
    checks.instance("surface", surface, Surface, "asperity.surfaces.Surface(heights)")
    view = surface_view(surface, spectrum)
    flat = view.heights.ndim == 2
    figure = style.Drawing(figsize=(9.0, 7.4) if flat else (9.0, 5.6), layout="constrained")
    engine = figure.get_layout_engine()
    assert engine is not None
    engine.set(w_pad=_PAD, h_pad=_PAD / 2)  # type: ignore[call-arg]
    if flat:
        grid = figure.add_gridspec(2, 2, width_ratios=(1.2, 1), height_ratios=(1.5, 1))
        upper_left = figure.add_subplot(grid[0, 0])
        draw_map(upper_left, view)
        upper_left.axhline(view.middle, color="white", linestyle="--", linewidth=1.0)
        waves, profile, histogram = (figure.add_subplot(grid[i, j]) for i, j in ((0, 1), (1, 0), (1, 1)))
        profile.set_title("profile along the dashed line", fontsize=9)
    else:
        grid = figure.add_gridspec(2, 2)
        profile, histogram = figure.add_subplot(grid[0, :]), figure.add_subplot(grid[1, 0])
        waves = figure.add_subplot(grid[1, 1])
        profile.set_title("profile", fontsize=9)
    profile.plot(view.profile_position, view.profile, color=style.INK, linewidth=0.8)
    profile.set_xlabel(style.with_unit("position", view.length_unit))
    profile.set_ylabel(style.with_unit("height", view.unit))
    profile.margins(x=0)
    _draw_histogram(histogram, view)
    draw_spectrum(waves, view.spectrum)
    about = [title, *(style.lines(note.split(", "), figure.room).split("\n") if note else [])]
    about[0] = style.lines([title], figure.room)
    figure.suptitle("\n".join(about), fontsize=10)
    return figure


def height_view(surface: Surface) -> HeightView:
    """Prepare the heights of a surface for drawing."""
    heights = surface.scan.heights
    unit, factor = readable(surface.unit, float(np.ptp(heights)))
    size, length_unit, _ = _axes(surface, heights.shape)
    heights = heights * factor
    return HeightView(heights, unit, length_unit, size, color_range(heights))


def surface_view(surface: Surface, spectrum: PowerSpectrum | None = None) -> SurfaceView:
    """Prepare a surface for drawing."""
    measured = power_spectrum(surface) if spectrum is None else spectrum
    shown = height_view(surface)
    heights, unit, size = shown.heights, shown.unit, shown.pixel_size
    _, factor = readable(surface.unit, float(np.ptp(surface.scan.heights)))
    _, length_unit, across = _axes(surface, heights.shape)
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
        **vars(shown),
        bin_edges=edges,
        density=density,
        normal_density=normal,
        profile_position=(np.arange(profile.size) + 0.5) * size[-1],
        profile=profile,
        middle=(middle + 0.5) * size[0] if heights.ndim == 2 else 0.0,
        spectrum=_in_units(measured, (unit, factor) if is_length(unit) else None, (length_unit, across)),
    )


def _in_units(
    spectrum: PowerSpectrum, height: tuple[str, float] | None, length: tuple[str, float]
) -> PowerSpectrum:
    """A spectrum in other units, each with the factor to it; heights may keep theirs."""
    unit, up = height or (spectrum.unit, 1.0)
    length_unit, across = length
    axes = len(spectrum.along)
    fit = spectrum.fit
    if fit is not None:
        fit = dataclasses.replace(
            fit,
            longest=fit.longest * across,
            shortest=fit.shortest * across,
            middle=(fit.middle[0] / across, fit.middle[1] * up**2 * across**axes),
        )
    return dataclasses.replace(
        spectrum,
        wave_number=spectrum.wave_number / across,
        power=spectrum.power * up**2 * across**axes,
        along=tuple((q / across, power * up**2 * across) for q, power in spectrum.along),
        fit=fit,
        unit=unit,
        length_unit=length_unit,
    )


def _axes(surface: Surface, shape: tuple[int, ...]) -> tuple[tuple[float, ...], str, float]:
    """Pixel size, its unit, and the factor to it."""
    if surface.pixel_size is None:
        return (1.0,) * len(shape), "pixel", 1.0
    unit = surface.length_unit or "unit of the file"
    longest = max(n * s for n, s in zip(shape, surface.pixel_size, strict=True))
    shown, factor = readable(unit, longest)
    return tuple(s * factor for s in surface.pixel_size), shown, factor


def draw_map(axes: Axes, view: HeightView) -> None:
    """Draw the heights of a surface, with axes in its unit of length."""
    rows, columns = view.heights.shape
    image = axes.imshow(
        view.heights,
        cmap=style.HEIGHT_MAP,
        clim=view.height_range,
        extent=(0.0, columns * view.pixel_size[1], rows * view.pixel_size[0], 0.0),
        interpolation="antialiased",
        rasterized=True,
    )
    axes.set_xlabel(style.with_unit("x", view.length_unit))
    axes.set_ylabel(style.with_unit("y", view.length_unit))
    axes.set_title("height map", fontsize=9)
    figure = axes.get_figure()
    assert figure is not None
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


def draw_spectrum(axes: Axes, spectrum: PowerSpectrum) -> None:
    """Draw a power spectrum, with the power law of its self-affine range."""
    flat = len(spectrum.along) == 2
    # What a surface of smooth waves has beyond the shortest of them is rounding.
    shown = spectrum.power > _ROUNDING * spectrum.power.max(initial=0.0)
    axes.loglog(
        spectrum.wave_number[shown],
        spectrum.power[shown],
        "o",
        color=style.BLUE,
        markersize=3.5,
        label="mean over directions" if flat else "mean over bins",
    )
    fit = spectrum.fit
    if fit is not None:
        q = 2 * np.pi / np.array([fit.longest, fit.shortest])
        label = f"H = {uncertain(fit.hurst, fit.interval[1] - fit.hurst)} (95 %)"
        axes.loglog(q, fit.power(q), color=style.VERMILION, linewidth=1.5, label=label)
    if shown.any():
        axes.legend(fontsize=7, loc="lower left", framealpha=0.9)
    else:
        axes.text(0.5, 0.5, "none", transform=axes.transAxes, ha="center")
    across = style.spelled(spectrum.length_unit)
    axes.set_xlabel(f"wave number q [1/{across}]")
    axes.set_ylabel(f"power spectrum C(q) [{_power_unit(spectrum)}]")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_major_locator(LogLocator(numticks=5))
    window = "" if spectrum.window == "none" else f", {spectrum.window} window"
    axes.set_title(f"power spectrum{window}", fontsize=9)


def _power_unit(spectrum: PowerSpectrum) -> str:
    """Unit of C(q): that of the heights squared, times that of the lengths, for each axis."""
    height, length = style.spelled(spectrum.unit), style.spelled(spectrum.length_unit)
    power = "²" if len(spectrum.along) == 2 else ""
    if spectrum.unit == spectrum.length_unit:
        return f"{height}{'⁴' if power else '³'}"
    across = f"({length}){power}" if " " in length and power else f"{length}{power}"
    if spectrum.unit == "1":
        return across
    return f"{f'({height})²' if ' ' in height else f'{height}²'} {across}"
