"""What is implausible in a measured surface, each with the flag that cures it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from asperity.lattice import Field, Mask
from asperity.surfaces.levelling import SPIKE
from asperity.surfaces.moments import Statistics

_SLOPES = 1e-5, 10.0  # rms slopes: polished mirrors have 1e-4, the roughest fractures 3
_FIELD = 1.0  # largest side of a scan, m
_BOWED = 0.85, 0.9
"""Parts of the variance in a bow, and of the highest pixels at the edges, from which on both are remarked:
in one of 300 square parts of self-affine surfaces without a roll-off (H = 0.8), in none with one."""

_BOW = (
    0.9  # part of the variance in a bow that is remarked wherever the contact is; in none of 600 such parts
)
_UNEVEN = 1.5  # ratio of steps across rows to steps along them, above which it is remarked
_REPEATED = 10  # times as many pixels as of any other height: it may be a void value
_BORNE = 0.01  # share of the load on filled pixels that is remarked


def repeated(heights: Field) -> dict[str, float]:
    """A height that may stand for undefined pixels, and how many have it, if there is one.

    It occurs twice or more, further from the others than these from each other; or ten times as often as any.
    """
    values, counts = np.unique(heights, return_counts=True)
    for at in (0, values.size - 1, int(counts.argmax())) if values.size > _REPEATED else ():
        others = np.delete(values, at)
        far = np.abs(others - values[at]).min() > np.ptp(others) and counts[at] > 1
        if far or counts[at] >= _REPEATED * np.delete(counts, at).max():
            return {"repeated_height": float(values[at]), "repeated_pixels": int(counts[at])}
    return {}


def remarks(
    facts: Mapping[str, Any], found: Statistics, size: tuple[float, ...] | None, across: float | None
) -> Iterator[str]:
    """What may be no height of a surface, from its provenance, its statistics and its pixels.

    `across` is the meters in a unit of the pixel size, or None.
    """
    if count := facts.get("repeated_pixels"):
        void = f"{facts['repeated_height']:.10g}"
        yield (
            f"{count} pixels have the height {void}, far from all others or too often: if that stands for "
            f"undefined pixels, try undefined_value = {void} (--undefined-value {void})"
        )
    odd, side = [], max((n * pixel for n, pixel in zip(found.shape, size or (), strict=False)), default=0.0)
    if found.slope_unit == "1" and found.rms_slope and not _SLOPES[0] <= found.rms_slope <= _SLOPES[1]:
        odd.append(f"an rms slope of {found.rms_slope:.2g}")
    if side * (across or 0.0) > _FIELD:
        odd.append(f"a side of {side * (across or 0.0):.3g} m")
    if odd:
        yield (
            f"{' and '.join(odd)}: unusual, check the units; "
            "try file_unit (--file-unit), or pixel_size and length_unit (--pixel-size, --length-unit)"
        )
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
            "try tilt = 'quadratic' (--tilt quadratic), longest (--longest), or crop (--crop)"
        )
    elif share > _BOW:
        yield (
            f"a polynomial of second order has {100 * share:.0f} % of the variance: "
            "if that is the bow of a scanner, try tilt = 'quadratic' (--tilt quadratic)"
        )
    between, along = found.neighbor_steps[0], found.neighbor_steps[-1]
    # Rows that are further apart than columns differ by more.
    if between > _UNEVEN * along * (max(1.0, size[0] / size[-1]) if size else 1.0) > 0:
        cure = "" if facts.get("lines_rule") == "median" else "; try lines = 'median' (--lines median)"
        yield (
            f"heights change {between / along:.2g} times as much from row to row as along a row: if that is "
            f"noise of the scan's lines, their ridges carry load that asperities would carry{cure}"
        )


def load_on_filled(filled: Mask | None, forces: Field) -> tuple[str, ...]:
    """Remark that pixels which nobody measured bear load; forces of one or of several maps."""
    if filled is None:
        return ()
    total = np.maximum(forces.sum(axis=tuple(range(-filled.ndim, 0))), np.finfo(float).tiny)
    share = float(np.max(forces[..., filled].sum(axis=-1) / total))
    if share <= _BORNE:
        return ()
    return (
        f"{100 * share:.3g} % of the load is on filled pixels, which nobody measured: "
        "crop the scan to its measured part (--crop), or measure another place",
    )
