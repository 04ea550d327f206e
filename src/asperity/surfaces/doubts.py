"""Remarks on what is implausible in a measured surface, each with the argument that cures it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from asperity.lattice import Field
from asperity.surfaces.levelling import SPIKE
from asperity.surfaces.moments import Statistics

_SLOPES = 1e-5, 10.0  # rms slopes: polished mirrors have 1e-4, the roughest fractures 3
_FIELD = 1.0  # largest side of a scan, m
_BOWED = 0.85, 0.9
"""Shares of the variance in a bow, and of the highest pixels at the edges, above which both are remarked: in
one of 300 square parts of self-affine surfaces without roll-off (H = 0.8), in none of 300 with roll-off."""

_BOW = 0.9  # share of the variance in a bow above which it alone is remarked: in none of these 600 parts
_UNEVEN = 1.5  # ratio of steps across rows to steps along them, above which it is remarked
_REPEATED = 10  # a height that is so many times as frequent as any other may mark undefined pixels
BORNE = 0.01  # share of filled pixels, or of the load on them, above which it is remarked


def repeated(heights: Field) -> dict[str, float]:
    """Find a height that may mark undefined pixels, and count these; empty if there is none.

    It occurs at least twice, and farther from all others than these are from each other; or ten times as
    often as any other height.
    """
    values, counts = np.unique(heights, return_counts=True)
    for at in (0, values.size - 1, int(counts.argmax())) if values.size > _REPEATED else ():
        others = np.delete(values, at)
        far = np.abs(others - values[at]).min() > np.ptp(others) and counts[at] > 1
        if far or counts[at] >= _REPEATED * np.delete(counts, at).max():
            return {"repeated_height": float(values[at]), "repeated_pixels": int(counts[at])}
    return {}


def remarks(
    facts: Mapping[str, Any], measures: Statistics, size: tuple[float, ...] | None, meters: float | None
) -> Iterator[str]:
    """Remark on provenance, statistics and pixel size, whose unit is so many `meters`, if that is known."""
    if count := facts.get("repeated_pixels"):
        void = f"{facts['repeated_height']:.10g}"
        yield (
            f"{count} pixels have the height {void}, which is far from all others or too frequent: "
            f"if it marks undefined pixels, try undefined_value = {void}"
        )
    share = facts.get("undefined_fraction", 0.0)
    if share > BORNE and facts.get("undefined_rule") == "fill":
        yield (
            f"{100 * share:.3g} % of the pixels are undefined and were filled; "
            "where there is no body, try undefined = 'no-body'"
        )
    odd, slope = [], measures.rms_slope
    side = max((n * pixel for n, pixel in zip(measures.shape, size or (), strict=False)), default=0.0)
    side *= meters or 0.0
    if measures.slope_unit == "1" and slope and not _SLOPES[0] <= slope <= _SLOPES[1]:
        odd.append(f"an rms slope of {slope:.2g}")
    if side > _FIELD:
        odd.append(f"a side of {side:.3g} m")
    if odd:
        yield (f"{' and '.join(odd)}: unusual, check the units; try file_unit, or pixel_size and length_unit")
    if count := facts.get("outlying_pixels"):
        yield (
            f"pixels more than {SPIKE:g} robust standard deviations above the median height: "
            f"{count}, up to {facts['outlying_height']:.3g}; spikes would carry the load; "
            "try despike = true"
        )
    share, outside = facts.get("bow_variance", 0.0), facts.get("highest_at_edges", 0.0)
    if share > _BOWED[0] and outside > _BOWED[1]:
        yield (
            f"the contact would be at the edges: {100 * outside:.0f} % of the highest pixels are in the "
            f"outer tenth, and a polynomial of second order has {100 * share:.0f} % of the variance; "
            "try tilt = 'quadratic', longest, or crop"
        )
    elif share > _BOW:
        yield (
            f"a polynomial of second order has {100 * share:.0f} % of the variance: "
            "if that is the bow of a scanner, try tilt = 'quadratic'"
        )
    between, along = measures.neighbor_steps[0], measures.neighbor_steps[-1]
    # Rows that are further apart than columns differ by more.
    if between > _UNEVEN * along * (max(1.0, size[0] / size[-1]) if size else 1.0) > 0:
        cure = "" if facts.get("lines_rule") == "median" else "; try lines = 'median'"
        yield (
            f"heights change {between / along:.2g} times as much from row to row as along a row: if that is "
            f"noise of the scan's lines, their ridges carry load that asperities would carry{cure}"
        )
