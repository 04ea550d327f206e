"""Tilt, bow, spikes and offsets of lines of a measured surface: found and removed."""

from __future__ import annotations

import math
from itertools import combinations_with_replacement
from typing import Literal

import numpy as np

from asperity.errors import InputError
from asperity.lattice import Field, Mask
from asperity.surfaces.prepare import fill

Tilt = Literal["plane", "quadratic", "mean", "none"]
Lines = Literal["none", "median"]
Facts = dict[str, str | int | float | list[float]]

SPIKE = 6.0
"""Robust standard deviations above the median beyond which a pixel is a spike: in Gaussian surfaces one in
1e9 pixels."""
_LOOKED_AT = 256  # pixels along an axis from which a bow is found
_ROUNDING = 128 * np.finfo(float).eps  # of the largest height; random polynomials left 30 eps at most
_FEW = 100  # pixels of which the highest 1 % are too few to say where they are


def remove_tilt(heights: Field, defined: Mask, rule: Tilt) -> tuple[Field, list[float]]:
    """Remove the tilt of the defined pixels; also return its coefficients.

    They are the height at pixel 0 and the slope per pixel along each axis; of a polynomial of second order
    also the coefficients of i^2, i j and j^2, where i counts rows and j columns.
    """
    axes = heights.ndim
    if rule == "none":
        return heights, [0.0] * (1 + axes)
    mean = float(heights[defined].mean())
    level = heights - mean
    if rule == "mean":
        return level, [mean] + [0.0] * axes
    # With coordinates from 0 to 1 the problem is well conditioned at any size.
    along = np.meshgrid(*(np.linspace(0, 1, n) for n in heights.shape), indexing="ij", sparse=True)
    order = 2 if rule == "quadratic" else 1
    terms = [term for n in range(order + 1) for term in combinations_with_replacement(range(axes), n)]
    columns = [np.broadcast_to(math.prod(along[a] for a in term), heights.shape) for term in terms]
    parts = np.linalg.lstsq(np.stack([c[defined] for c in columns], axis=1), level[defined], rcond=None)[0]
    flat = np.asarray(level - sum(part * column for part, column in zip(parts, columns, strict=True)))
    # A perfect polynomial leaves rounding, which is no roughness.
    if np.abs(flat[defined]).max() <= _ROUNDING * np.abs(heights[defined]).max():
        flat = np.zeros_like(flat)
    parts[0] += mean
    sides = [max(n - 1, 1) for n in heights.shape]
    sizes = [math.prod(sides[a] for a in term) for term in terms]
    return flat, [float(part) / size for part, size in zip(parts, sizes, strict=True)]


def levelled(
    heights: Field, missing: Mask, tilt: Tilt, most_spikes: float | None, lines: Lines = "none"
) -> tuple[Field, Mask, Facts]:
    """Level the defined pixels, then fill the others, and the spikes unless `most_spikes` is None.

    Holes that are filled before the tilt is removed would be wedges after it.
    Returns the heights, the filled pixels, and the facts for the provenance.
    """
    filled = missing.copy()
    while True:  # without its spikes a surface has another tilt and deviation
        level, removed = remove_tilt(heights, ~filled, tilt)
        if lines == "median":
            level, more = remove_tilt(level - _medians(level, ~filled), ~filled, tilt)
            removed = [total + other for total, other in zip(removed, more, strict=True)]
        outlying, highest = spikes(level, ~filled)
        if most_spikes is None or not outlying.any():
            break
        filled |= outlying
        if (share := float((filled & ~missing).mean())) > most_spikes:
            expected = f"at most {most_spikes:.3g} of the pixels to be spikes"
            raise InputError("despike", expected=expected, got=f"{share:.3g}", advice="heights as they are")
    facts: Facts = {"tilt_rule": tilt, "tilt_coefficients": removed, "lines_rule": lines}
    facts |= {"outlying_pixels": int(outlying.sum()), "outlying_height": highest}
    facts |= {} if most_spikes is None else {"despiked_pixels": int((filled & ~missing).sum())}
    return fill(np.where(filled, np.nan, level)), filled, facts


def _medians(heights: Field, defined: Mask) -> Field:
    """Median of the defined pixels of each row, shape (rows, 1); 0 for a row without any."""
    if heights.ndim == 1:
        raise InputError("lines", expected="'none' for a profile, which is a single line", got="'median'")
    measured = np.where(defined, heights, np.nan)
    measured[~defined.any(axis=1)] = 0.0
    return np.asarray(np.nanmedian(measured, axis=1, keepdims=True))


def spikes(heights: Field, defined: Mask) -> tuple[Mask, float]:
    """Spikes among the defined pixels, and the highest pixel in robust deviations; see `surfaces.read`."""
    measured = heights[defined]
    median = np.median(measured)
    deviation = 1.4826 * float(np.median(np.abs(measured - median)))
    if deviation == 0:  # most heights are equal
        return np.zeros_like(defined), 0.0
    above = (heights - median) / deviation
    return (above > SPIKE) & defined, float(above[defined].max())


def bow(heights: Field) -> dict[str, float]:
    """Share of the variance in a polynomial of second order; share of the highest 1 % in the outer tenth."""
    part = heights[tuple(slice(None, None, -(-n // _LOOKED_AT)) for n in heights.shape)]
    chosen = np.isfinite(part)
    if chosen.any():
        chosen &= ~spikes(part, chosen)[0]
    variance = float(part[chosen].var()) if chosen.sum() >= _FEW else 0.0
    if variance == 0:
        return {"bow_variance": 0.0, "highest_at_edges": 0.0}
    flat, _ = remove_tilt(part, chosen, "quadratic")
    highest = np.nonzero(chosen & (part >= np.quantile(part[chosen], 0.99)))
    outer = [np.minimum(i, n - 1 - i) < n / 10 for i, n in zip(highest, part.shape, strict=True)]
    share = 1 - float(flat[chosen].var()) / variance
    return {"bow_variance": share, "highest_at_edges": float(np.any(outer, axis=0).mean())}
