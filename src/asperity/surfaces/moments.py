"""Statistics of a surface: moments of its heights, slope, curvature, and the step at its periodic seam."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from asperity.lattice import Field
from asperity.surfaces.heights import check_heights, checked_spacing
from asperity.surfaces.prepare import of_body


@dataclass(frozen=True)
class Statistics:
    """Statistics of a surface; lengths along z are in `unit`.

    Attributes
    ----------
    shape
        Sites along each axis.
    minimum, maximum, mean
        Of the heights.
    rms_height
        Standard deviation of the heights about their mean.
    rms_slope
        Root mean square of the gradient, from differences of neighbors without those across the seam, in
        `slope_unit`.
    rms_curvature
        Root mean square of the mean curvature, half the Laplacian (of a profile: of the second derivative),
        from second differences at sites with both neighbors along each axis, in `curvature_unit`; 0 for fewer
        than three sites along an axis. T. D. B. Jacobs, T. Junge and L. Pastewka, Surf. Topogr.: Metrol.
        Prop. 5, 013001 (2017), DOI 10.1088/2051-672X/aa51f8.
    skewness
        Third moment about the mean over ``rms_height**3``; NaN for a flat surface.
    kurtosis
        Fourth moment about the mean over ``rms_height**4``, which is 3 for Gaussian heights; NaN for a
        flat surface.
    neighbor_steps
        For each axis, the rms difference of neighbors inside the surface.
    seam_steps
        For each axis, the rms difference of the neighbors across the periodic seam (last and first site).
    unit, slope_unit, curvature_unit
        Units of heights, slope and curvature; "1" if none is known.
    undefined_pixels
        Number of pixels that were not measured.
    """

    shape: tuple[int, ...]
    minimum: float
    maximum: float
    mean: float
    rms_height: float
    rms_slope: float
    rms_curvature: float
    skewness: float
    kurtosis: float
    neighbor_steps: tuple[float, ...]
    seam_steps: tuple[float, ...]
    unit: str = "1"
    slope_unit: str = "1/pixel"
    curvature_unit: str = "1/pixel^2"
    undefined_pixels: int = 0

    @property
    def seam_ratio(self) -> float:
        """Largest step at a seam, in units of the usual step along the same axis.

        About 1 for a periodic surface, 0 for a mirrored one, far above 1 if the solver would see a cliff.
        """
        pairs = zip(self.seam_steps, self.neighbor_steps, strict=True)
        return float(max(0.0 if seam == 0 else (seam / step if step else np.inf) for seam, step in pairs))


def statistics(heights: ArrayLike, pixel_size: tuple[float, ...] | None = None) -> Statistics:
    """Measure a surface.

    Parameters
    ----------
    heights
        As for `check_heights`.
    pixel_size
        Distance between sites along each axis, in the unit of the heights; None counts in pixels.

    Raises
    ------
    InputError
        `check_heights` refuses the heights, or the pixel size is not one positive number for each axis.
    """
    xi = of_body(check_heights(heights))
    sizes = checked_spacing("pixel_size", 1.0 if pixel_size is None else pixel_size, xi.ndim)
    steps = [np.diff(xi, axis=axis) for axis in range(xi.ndim)]
    seams = [np.take(xi, 0, axis=axis) - np.take(xi, -1, axis=axis) for axis in range(xi.ndim)]
    mean = float(xi.mean())
    # Rounding leaves a flat surface a tiny rms.
    flat = bool(xi.min() == xi.max())
    rms = 0.0 if flat else float(xi.std())
    normal = np.full(1, np.nan) if flat else (xi - mean) / rms
    squared = normal * normal  # powers of arrays take ten times as long
    return Statistics(
        shape=xi.shape,
        minimum=float(xi.min()),
        maximum=float(xi.max()),
        mean=mean,
        rms_height=rms,
        rms_slope=float(np.sqrt(sum(_rms(d / s) ** 2 for d, s in zip(steps, sizes, strict=True)))),
        rms_curvature=_rms(_mean_curvature(xi, sizes)),
        skewness=float(np.mean(squared * normal)),
        kurtosis=float(np.mean(squared * squared)),
        neighbor_steps=tuple(_rms(d) for d in steps),
        seam_steps=tuple(_rms(d) for d in seams),
        slope_unit="1/pixel" if pixel_size is None else "1",
        curvature_unit="1/pixel^2" if pixel_size is None else "1/unit of the pixel size",
    )


def _mean_curvature(xi: Field, sizes: tuple[float, ...]) -> Field:
    inside = tuple(slice(1, -1) for _ in xi.shape)
    total = xi[inside] * 0.0
    if total.size:
        for axis, size in enumerate(sizes):
            others = tuple(slice(None) if a == axis else slice(1, -1) for a in range(xi.ndim))
            total += np.diff(xi[others], n=2, axis=axis) / size**2
    return total / xi.ndim


def _rms(values: Field) -> float:
    """Root mean square about zero; 0 without values, as for neighbors along an axis of one site."""
    squares = np.ma.compressed(np.square(values))
    return float(np.sqrt(squares.mean())) if squares.size else 0.0
