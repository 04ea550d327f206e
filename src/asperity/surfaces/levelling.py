"""Tilt, bow and spikes of a measured surface: found, removed, and told of."""

from __future__ import annotations

import math
from itertools import combinations_with_replacement
from typing import Literal, NamedTuple

import numpy as np

from asperity.errors import InputError
from asperity.lattice import Field, Mask
from asperity.surfaces.prepare import fill

Tilt = Literal["plane", "quadratic", "mean", "none"]

SPIKE = 6.0
"""Robust standard deviations above the median from which on a pixel is a spike; no Gaussian surface of
less than a thousand million pixels has any."""
_LOOKED_AT = 256
"""Pixels along an axis that tell a bow."""
_FEW = 100
"""Pixels below which highest ones are too few to say where they are."""


def remove_tilt(heights: Field, defined: Mask, rule: Tilt) -> tuple[Field, list[float]]:
    """Remove the tilt, found from the defined pixels alone; also return what was removed.

    The rule is "plane" (the least-squares plane; a line for a profile), "quadratic" (the least-squares
    polynomial of second order), "mean" (a level plane) or "none". What was removed is the height at
    pixel 0, the slope along each axis, a pixel, and of a polynomial its coefficients of second order, a
    pixel squared: of i^2, i j and j^2, where i counts rows and j columns.
    """
    axes = heights.ndim
    if rule == "none":
        return heights, [0.0] * (1 + axes)
    mean = float(heights[defined].mean())
    level = heights - mean
    if rule == "mean":
        return level, [mean] + [0.0] * axes
    terms, grids, parts = _polynomial(level, defined, 2 if rule == "quadratic" else 1)
    rest = zip(parts[1:], terms[1:], strict=True)
    left = np.asarray(
        level - (parts[0] + sum(part * math.prod(grids[a] for a in term) for part, term in rest))
    )
    # What a perfect plane leaves is rounding, and no surface to press anything onto.
    rounding = 16 * np.finfo(float).eps * float(np.abs(heights).max())
    if float(np.abs(left).max()) <= rounding:
        left = np.zeros_like(left)
    # From coordinates u = s i - 1 to pixels i: u v = 1 - s i - t j + s t i j.
    per_pixel = [2 / (n - 1) if n > 1 else 0.0 for n in heights.shape]
    removed = dict(zip(terms, parts, strict=True))
    removed[()] += mean - sum(parts[1 : 1 + axes])
    for (first, second), part in zip(terms[1 + axes :], parts[1 + axes :], strict=True):
        removed[()] += part
        removed[first,] -= part
        removed[second,] -= part
    return left, [part * math.prod(per_pixel[a] for a in term) for term, part in removed.items()]


def _polynomial(
    heights: Field, chosen: Mask, order: int
) -> tuple[list[tuple[int, ...]], list[Field], list[float]]:
    """Least-squares polynomial of the chosen pixels.

    Returns its terms, each the axes whose coordinates are multiplied; the coordinate along each axis,
    from -1 to 1, with which the problem is well conditioned at any size; and the coefficients.
    """
    ends = [np.linspace(-1, 1, n) if n > 1 else np.zeros(1) for n in heights.shape]
    grids = np.meshgrid(*ends, indexing="ij", sparse=True)
    terms = [term for n in range(order + 1) for term in combinations_with_replacement(range(heights.ndim), n)]
    shape = heights.shape
    columns = [np.broadcast_to(math.prod(grids[a] for a in term), shape)[chosen] for term in terms]
    found = np.linalg.lstsq(np.stack(columns, axis=1), heights[chosen], rcond=None)[0]
    return terms, list(grids), found.tolist()


class Levelled(NamedTuple):
    """Heights without tilt and spikes, with the undefined pixels filled.

    Attributes
    ----------
    level, filled
        The heights; and as they were before the tilt was removed.
    facts
        What was done, and what was found: how many pixels are spikes, the highest in robust standard
        deviations, and how many spikes were filled, if that was asked.
    """

    level: Field
    filled: Field
    facts: dict[str, str | int | float | list[float]]


def levelled(heights: Field, missing: Mask, tilt: Tilt, most_spikes: float | None) -> Levelled:
    """Fill undefined pixels and remove the tilt; fill the spikes too, unless None of the pixels may be any.

    Without its spikes a surface has another tilt and deviation, so that is repeated until there is none.
    `InputError` if more than this part of the pixels are spikes.
    """
    ignored = missing.copy()
    while True:
        filled = fill(np.where(ignored, np.nan, heights))
        level, removed = remove_tilt(filled, ~ignored, tilt)
        outlying, highest = spikes(level, ~ignored)
        if most_spikes is None or not outlying.any():
            break
        ignored |= outlying
        if (share := float((ignored & ~missing).mean())) > most_spikes:
            expected = f"at most {most_spikes:.3g} of the pixels to be spikes"
            raise InputError("despike", expected=expected, got=f"{share:.3g}", advice="heights as they are")
    facts: dict[str, str | int | float | list[float]] = {"tilt_rule": tilt, "tilt_coefficients": removed}
    facts |= {"outlying_pixels": int(outlying.sum()), "outlying_height": highest}
    if most_spikes is not None:
        facts["despiked_pixels"] = int((ignored & ~missing).sum())
    return Levelled(level, filled, facts)


def spikes(heights: Field, defined: Mask) -> tuple[Mask, float]:
    """Find the defined pixels far above all others, and the highest one in robust standard deviations.

    These are 1.4826 times the median distance from the median, which is the standard deviation of Gaussian
    heights: Hampel's identifier, L. Davies and U. Gather, J. Am. Stat. Assoc. 88, 782 (1993), DOI
    10.1080/01621459.1993.10476339.
    """
    known = heights[defined]
    median = np.median(known)
    deviation = 1.4826 * float(np.median(np.abs(known - median)))
    if deviation == 0:  # most heights are equal: no measure of what is far
        return np.zeros_like(defined), 0.0
    above = (heights - median) / deviation
    return (above > SPIKE) & defined, float(above[defined].max())


def bow(heights: Field) -> dict[str, float]:
    """Part of the variance in a polynomial of second order, and part of the highest 1 % at the edges.

    Spikes are left out. At the edges is what lies in the outer tenth of an axis. Of large surfaces, every so
    many rows and columns are looked at. Both are 0 of surfaces too small to tell.
    """
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
