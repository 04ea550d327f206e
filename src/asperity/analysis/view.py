"""A measured surface as it is shown: its measured part, its axes, a histogram and a profile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.analysis.maps import color_range
from asperity.analysis.scan import measured_part, readable
from asperity.lattice import Field
from asperity.surfaces import Surface


@dataclass(frozen=True, eq=False)
class SurfaceView:
    """What a figure of a surface shows.

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
        As in `ContactMaps`.
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


def surface_view(surface: Surface) -> SurfaceView:
    """Prepare a surface for drawing.

    Parameters
    ----------
    surface
        From `asperity.surfaces.read`, or made of an array.

    Returns
    -------
    SurfaceView
    """
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
