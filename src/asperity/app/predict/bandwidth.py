"""How far a scan suffices: the same prediction with short waves left out, beside that of the whole scan."""

from __future__ import annotations

from collections.abc import Callable

from asperity.analysis.prediction import Band
from asperity.progress import Progress
from asperity.results import History
from asperity.surfaces import Surface
from asperity.surfaces.prepare import length_factor

_FACTORS = (1, 2, 4, 8, 16)
"""Shortest waves, over two pixels, which are the shortest that a scan has."""

_FEWEST = 8
"""Waves along the shorter side that a band has at least."""


def bands_of(
    scan: Surface, followed: Callable[[Surface, list[float]], History], span: list[float], progress: Progress
) -> tuple[Band, ...]:
    """Follow the scan with ever fewer waves as the prediction does, to the first and the last time (s)."""
    sides = scan.pixel_size or ()
    meter = length_factor(str(scan.length_unit), "m")
    longest = min(n * side for n, side in zip(scan.shape, sides, strict=True)) / _FEWEST
    found = []
    for factor in _FACTORS:
        shortest = 2 * max(sides) * factor
        if factor > 1 and shortest > longest:
            break
        progress.stage(f"waves from {factor * 2} pixels on")
        history = followed(scan if factor == 1 else scan.band(shortest=shortest), span)
        first, last = history.dataset["time"].values == span[0], history.final
        area, pressure = last.contact_area_corrected, last.load / last.contact_area_corrected
        growth = area / float(history.dataset["contact_area_corrected"][first][0])
        found.append(Band(shortest * meter, area, pressure, growth, last.normal_stiffness))
    return tuple(found)
