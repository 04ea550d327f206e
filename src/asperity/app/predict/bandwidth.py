"""How far a scan suffices: the same prediction with short waves left out, beside that of the whole scan."""

from __future__ import annotations

from typing import Any

from asperity.analysis.prediction import Band
from asperity.progress import Progress
from asperity.simulate import age, press
from asperity.solids import Solid
from asperity.surfaces import Surface
from asperity.surfaces.prepare import length_factor

_FACTORS = (1, 2, 4, 8, 16)
"""Shortest waves, over two pixels, which are the shortest that a scan has."""

_FEWEST = 8
"""Waves along the shorter side that a band has at least."""


def bands_of(
    scan: Surface,
    solid: Solid,
    pressed: dict[str, Any],
    span: tuple[float, float],
    rtol: float,
    progress: Progress,
) -> tuple[Band, ...]:
    """Press the scan, at once, and let it age from the first to the last time (s), with ever fewer waves."""
    sides = scan.pixel_size or ()
    meter = length_factor(str(scan.length_unit), "m")
    longest = min(n * side for n, side in zip(scan.shape, sides, strict=True)) / _FEWEST
    found = []
    for factor in _FACTORS:
        shortest = 2 * max(sides) * factor
        if factor > 1 and shortest > longest:
            break
        progress.stage(f"waves from {factor * 2} pixels on")
        part = scan if factor == 1 else scan.band(shortest=shortest)
        start = press(part, solid, **pressed)
        first = age(start, [span[0]], rtol=rtol).final
        last = age(start, [span[1]], rtol=rtol).final
        area = last.contact_area_corrected
        growth, pressure = area / first.contact_area_corrected, last.load / area
        found.append(Band(shortest * meter, area, pressure, growth, last.normal_stiffness))
    return tuple(found)
