"""Tilt, bow and spikes of a measured surface: found, removed, and told of."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import combinations_with_replacement
from typing import Any, Literal

import numpy as np

from asperity.errors import InputError
from asperity.lattice import Field, Mask
from asperity.surfaces.prepare import fill

Tilt = Literal["plane", "quadratic", "mean", "none"]
Facts = dict[str, str | int | float | list[float]]

SPIKE = 6.0
"""Robust standard deviations above the median from which on a pixel is a spike; no Gaussian surface of
less than a thousand million pixels has any."""
_BOWED = 0.85, 0.9
"""Parts of the variance in a bow, and of the highest pixels at the edges, from which on both are remarked:
in one of 300 square parts of self-affine surfaces without a roll-off (H = 0.8), in none with one."""
_LOOKED_AT = 256  # pixels along an axis that tell a bow
_FEW = 100  # pixels below which highest ones are too few to say where they are


def remove_tilt(heights: Field, defined: Mask, rule: Tilt) -> tuple[Field, list[float]]:
    """Remove the tilt, found from the defined pixels alone; also return what was removed.

    That is the height at pixel 0, the slope along each axis, a pixel, and of a polynomial of second order its
    coefficients of i^2, i j and j^2, a pixel squared, where i counts rows and j columns.
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
    left = np.asarray(level - sum(part * column for part, column in zip(parts, columns, strict=True)))
    # What a perfect plane leaves is rounding, and no surface to press anything onto.
    if float(np.abs(left).max()) <= 16 * np.finfo(float).eps * float(np.abs(heights).max()):
        left = np.zeros_like(left)
    parts[0] += mean
    sides = [max(n - 1, 1) for n in heights.shape]
    return left, [
        float(part) / math.prod(sides[a] for a in term) for part, term in zip(parts, terms, strict=True)
    ]


def levelled(
    heights: Field, missing: Mask, tilt: Tilt, most_spikes: float | None
) -> tuple[Field, Field, Facts]:
    """Fill undefined pixels and remove the tilt; fill the spikes too, unless None of the pixels may be any.

    Returns the heights, these before the tilt was removed, and what was done and found.
    """
    ignored = missing.copy()
    while True:  # without its spikes a surface has another tilt and deviation
        filled = fill(np.where(ignored, np.nan, heights))
        level, removed = remove_tilt(filled, ~ignored, tilt)
        outlying, highest = spikes(level, ~ignored)
        if most_spikes is None or not outlying.any():
            break
        ignored |= outlying
        if (share := float((ignored & ~missing).mean())) > most_spikes:
            expected = f"at most {most_spikes:.3g} of the pixels to be spikes"
            raise InputError("despike", expected=expected, got=f"{share:.3g}", advice="heights as they are")
    facts: Facts = {"tilt_rule": tilt, "tilt_coefficients": removed}
    facts |= {"outlying_pixels": int(outlying.sum()), "outlying_height": highest}
    if most_spikes is not None:
        facts["despiked_pixels"] = int((ignored & ~missing).sum())
    return level, filled, facts


def spikes(heights: Field, defined: Mask) -> tuple[Mask, float]:
    """Defined pixels far above all others, and the highest in robust deviations; see `surfaces.read`."""
    known = heights[defined]
    median = np.median(known)
    deviation = 1.4826 * float(np.median(np.abs(known - median)))
    if deviation == 0:  # most heights are equal: no measure of what is far
        return np.zeros_like(defined), 0.0
    above = (heights - median) / deviation
    return (above > SPIKE) & defined, float(above[defined].max())


def bow(heights: Field) -> dict[str, float]:
    """Parts of the variance in a polynomial of second order, and of the highest 1 % in the outer tenth."""
    part = heights[tuple(slice(None, None, -(-n // _LOOKED_AT)) for n in heights.shape)]
    chosen = ~spikes(part, np.ones(part.shape, dtype=bool))[0]
    variance = float(part[chosen].var())
    if part.size < _FEW or variance == 0:
        return {"bow_variance": 0.0, "highest_at_edges": 0.0}
    left, _ = remove_tilt(part, chosen, "quadratic")
    highest = np.nonzero(chosen & (part >= np.quantile(part[chosen], 0.99)))
    outer = [np.minimum(i, n - 1 - i) < n / 10 for i, n in zip(highest, part.shape, strict=True)]
    share = 1 - float(left[chosen].var()) / variance
    return {"bow_variance": share, "highest_at_edges": float(np.any(outer, axis=0).mean())}


def remarks(facts: Mapping[str, Any]) -> Iterator[str]:
    """What `levelled` and `bow` found, where it may be no height of the surface."""
    if count := facts.get("outlying_pixels"):
        yield (
            f"pixels more than {SPIKE:g} robust standard deviations above the median height: "
            f"{count}, up to {facts['outlying_height']:.3g}; spikes would carry the load; "
            "try despike = true (--despike)"
        )
    share, outside = facts.get("bow_variance", 0.0), facts.get("highest_at_edges", 0.0)
    if share > _BOWED[0] and outside > _BOWED[1]:
        yield (
            f"the contact would be at the edges: {100 * outside:.0f} % of the highest pixels are in the "
            f"outer tenth, and a polynomial of second order has {100 * share:.0f} % of the variance; "
            "try tilt = 'quadratic' (--tilt quadratic), or longest (--longest)"
        )
