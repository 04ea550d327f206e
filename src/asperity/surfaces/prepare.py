"""Units, parts, bands and edges of measured heights: steps of `asperity.surfaces.read`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from asperity.base import checks, units
from asperity.base.readable import LENGTHS, conversion, is_length
from asperity.errors import InputError
from asperity.lattice import Field, Lattice

# Other spellings of units; the third of um is UTF-8 read as Latin-1.
_SPELLINGS = {"": "1"} | dict.fromkeys(("\u00b5m", "\u03bcm", "\u00c2\u00b5m"), "um")
_SPELLINGS |= dict.fromkeys(("\u00c5", "\u212b"), "angstrom")
_ROUNDING = 1e-12  # rms of a flat surface without its tilt, over its largest height; relative error of waves
_SQUARE = 0.01  # pixels are square if their sides differ by no more than this part
_BORDER = 0.1  # part of an axis, on either side, over which "taper" brings heights to their mean


def spelled(unit: str | None) -> str:
    """A unit in our spelling, such as um for µm and micron; "1" for none."""
    if not isinstance(unit, str | None) or is_length(unit):
        return unit
    unit = (unit or "").strip()
    unit = units.spelled(unit) or unit.lower()  # nobody means megameters
    return _SPELLINGS.get(unit, unit)


def part_of(
    shape: tuple[int, ...],
    bounds: Sequence[float],
    unit: str,
    pixel_size: tuple[float, ...] | None,
    length_unit: str | None,
) -> tuple[slice, ...]:
    """Pixels of a part of a surface of this shape; bounds and unit are those of `Surface.crop`."""
    scale = [1.0] * len(shape)
    if unit != "pixel":
        checks.choice("crop_unit", unit, ("pixel", *LENGTHS))
        across = conversion(length_unit, unit)
        if pixel_size is None or across is None:
            got = "none" if pixel_size is None else f"pixels in {length_unit or 'no unit'}"
            expected = f"pixels with a unit of length, to crop in {unit}"
            raise InputError("crop", expected=expected, got=got, advice="bounds in pixels")
        scale = [size * across for size in pixel_size]
    ends = checks.floats("crop", bounds)
    order = "top, bottom, left and right" if len(shape) == 2 else "left and right"
    if ends.shape != (2 * len(shape),):
        raise InputError("crop", expected=f"{2 * len(shape)} numbers, {order}", got=checks.shown(bounds))
    part = []
    for (begin, end), side, n in zip(ends.reshape(-1, 2).tolist(), scale, shape, strict=True):
        if not (-0.5 <= begin / side < end / side <= n + 0.5):
            most = f"{n * side:.6g} {unit}{'s' if unit == 'pixel' else ''}"
            got = f"{begin:g} to {end:g}"
            raise InputError("crop", expected=f"begin and end of a part, within 0 and {most}", got=got)
        first, last = max(round(begin / side), 0), min(round(end / side), n)
        if first == last:
            got = f"{begin:g} to {end:g} {unit}"
            raise InputError("crop", expected=f"a part of a pixel, {side:.4g} {unit}, or more", got=got)
        part.append(slice(first, last))
    return tuple(part)


def checked_band(longest: float | None, shortest: float | None) -> dict[str, float]:
    """Check the limits of a band of wavelengths, and return those that are not None by name."""
    limits = {} if longest is None else {"longest": checks.number("longest", longest, above=0)}
    if shortest is not None:
        below = limits.get("longest", np.inf)
        limits["shortest"] = checks.number("shortest", shortest, above=0, below=below)
    return limits


def band(
    heights: Field, pixel_size: tuple[float, ...] | None, limits: Mapping[str, float], *, reflecting: bool
) -> Field:
    """Remove the waves beyond the limits of `checked_band`, in the unit of the pixel size or in pixels.

    Waves of reflecting edges are cosines, those of a scan with its mirror images. Where there is no body,
    heights count as if it were filled.
    """
    if not limits:
        return heights
    lattice = Lattice(heights.shape, pixel_size or (), "reflecting" if reflecting else "periodic")
    count = lattice.wave_number / (2 * np.pi)  # waves in a unit of length
    kept = count <= (1 + _ROUNDING) / limits.get("shortest", 1e-300)
    kept &= (count == 0) | (count >= (1 - _ROUNDING) / limits.get("longest", np.inf))
    body = np.isfinite(heights)
    waves = lattice.apply(kept.astype(np.float64), fill(np.where(body, heights, np.nan)))
    return np.where(body, waves, heights)


def of_body(heights: Field) -> Field:
    """Heights that are masked where there is no body, so that means and pictures leave these sites out."""
    body = np.isfinite(heights)
    return heights if body.all() else np.ma.array(np.where(body, heights, 0.0), mask=~body)


def fill(heights: Field) -> Field:
    """Fill undefined pixels, NaN, with the discrete harmonic function; at least one pixel is defined.

    By its maximum principle filling creates no summit.
    """
    filled, grid = heights.copy(), np.pad(heights, 1, constant_values=np.inf)  # no neighbor beyond the edges
    missing, strides = np.flatnonzero(np.isnan(grid)), np.cumprod([1, *grid.shape[:0:-1]])
    if missing.size:
        # Only pixels of holes and those beside them: a matrix of the whole scan takes 30 times as long.
        beside = missing[:, np.newaxis] + np.append(-strides[::-1], strides)
        near = grid.ravel()[beside]
        rim, (one, side) = np.isfinite(near), np.nonzero(np.isnan(near))
        pairs, unknowns = (one, np.searchsorted(missing, beside[one, side])), (missing.size, missing.size)
        links = scipy.sparse.coo_array((np.ones(one.size), pairs), shape=unknowns).tocsc()
        laplacian = scipy.sparse.diags_array(np.sum(near != np.inf, axis=1, dtype=np.float64)) - links
        right = np.where(rim, near, 0.0).sum(axis=1)
        solution = scipy.sparse.linalg.spsolve(laplacian.tocsc(), right, permc_spec="MMD_AT_PLUS_A")
        # Rounding leaves no pixel below the lowest or above the highest one at the border of its hole.
        holes, hole = scipy.sparse.csgraph.connected_components(links, directed=False)
        lowest = scipy.ndimage.minimum(np.where(rim, near, np.inf).min(axis=1), hole, range(holes))
        highest = scipy.ndimage.maximum(np.where(rim, near, -np.inf).max(axis=1), hole, range(holes))
        filled[np.isnan(filled)] = np.clip(solution, lowest[hole], highest[hole])
    return filled


def is_square(pixel_size: tuple[float, ...]) -> bool:
    """Whether the sides of a pixel are equal, to 1 %."""
    return max(pixel_size) <= (1 + _SQUARE) * min(pixel_size)


def square(heights: Field, pixel_size: tuple[float, ...] | None) -> tuple[Field, tuple[float, ...] | None]:
    """Means over the larger spacing along the axis of the shorter one; the rest of the axis is dropped."""
    if pixel_size is None or is_square(pixel_size):
        return heights, pixel_size
    side, axis = max(pixel_size), int(np.argmin(pixel_size))
    ratio, n = side / pixel_size[axis], heights.shape[axis]
    count = int(n / ratio * (1 + 1e-9))  # sides that are multiples may be rounded
    if count < 2:
        got = f"{n * pixel_size[axis]:.4g} along an axis"
        raise InputError("resample", expected=f"two pixels of {side:.4g} or more", got=got)
    fine = np.moveaxis(heights, axis, -1)
    start = np.zeros((*fine.shape[:-1], 1))
    integral = np.concatenate([start, np.cumsum(fine, axis=-1)], axis=-1)
    edges = np.minimum(ratio * np.arange(count + 1), n)
    whole = np.minimum(edges.astype(int), n - 1)
    at_edges = integral[..., whole] + (edges - whole) * fine[..., whole]
    return np.moveaxis(np.diff(at_edges, axis=-1) / ratio, -1, axis), (side,) * heights.ndim


def scale_factor(heights: Field, unit: str, target: str | None, *, largest: float) -> tuple[float, str]:
    """Factor from a unit ("1" for none) to the target, and its name; `largest` is the height with tilt."""
    if target is None or target == unit:
        return 1.0, unit
    if target == "rms":
        rms = float(of_body(heights).std())
        if rms <= _ROUNDING * largest:
            expected = "a rough surface, to divide by its rms height"
            raise InputError("unit", expected=expected, got="a flat one")
        return 1 / rms, "rms"
    if (factor := conversion(unit, target)) is None:
        got = "heights without a unit" if unit == "1" else f"heights in {unit!r}"
        expected = f"heights with a unit of length, to give them in {target}"
        cure = {"file_unit": target} if unit == "1" else {"unit": "rms"}
        raise InputError("unit", expected=expected, got=got, cure=cure)
    return factor, target


def make_periodic(heights: Field, rule: str) -> Field:
    """Make a surface periodic by a rule of `asperity.surfaces.read`."""
    if rule == "mirror":
        return np.pad(heights, [(0, n) for n in heights.shape], mode="symmetric")
    if rule in ("wrap", "reflect", "free"):
        return heights
    from scipy.signal.windows import tukey  # scipy.signal is slow to import

    mean = of_body(heights).mean()
    weight = np.ones(heights.shape)
    for axis, n in enumerate(heights.shape):
        # The weight is 0 at the seam, half a pixel outside: take the inner points of a wider window.
        window = tukey(2 * n + 1, 2 * _BORDER)[1::2]
        weight *= window.reshape([-1 if a == axis else 1 for a in range(heights.ndim)])
    return np.asarray(mean + weight * (heights - mean))
