"""Asperities as if they were independent (Greenwood and Williamson): where to look for contacts first."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.lattice import Field


@dataclass(frozen=True)
class Tuning:
    """Numbers of the search for a level."""

    sample: int = 16
    """The search begins with one of so many sites."""


TUNING = Tuning()


def level_of_overlap(heights: Field, overlap: float) -> float:
    """Level d above which the heights overlap by a given sum, sum (heights - d)+ = overlap.

    Each asperity that reaches the level carries the site stiffness times its overlap: at d these forces
    add up to the load. (J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966), DOI
    10.1098/rspa.1966.0242.) The sum is convex and falls with d: Newton steps from below never overshoot. The
    maximum of the heights is 0, and so is the level where the sum is not above 0.
    """
    if not overlap > 0:
        return 0.0
    level = -overlap  # the highest site alone would overlap enough
    if heights.size > TUNING.sample:
        sample = heights.reshape(-1)[:: TUNING.sample]
        level = level_of_overlap(sample, overlap * sample.size / heights.size)
        level += _rise(heights[heights > level], level, overlap)  # a step from above overshoots, to below
    while True:
        heights = heights[heights > level]  # sites below it stay below
        rise = _rise(heights, level, overlap)
        if not rise > 1e-9 * abs(level):
            return level
        level += rise


def _rise(higher: Field, level: float, overlap: float) -> float:
    """A Newton step from a level, above which some heights are."""
    return (float((higher - level).sum()) - overlap) / max(higher.size, 1)
