"""Asperities as if they were independent (Greenwood and Williamson): where to look for contacts first."""

from __future__ import annotations

from asperity.lattice import Field


def level_of_overlap(heights: Field, overlap: float) -> float:
    """Level d above which the heights overlap by a given sum, sum (heights - d)+ = overlap.

    Each asperity that reaches the level carries the site stiffness times its overlap: at d these forces
    add up to the load. (J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966), DOI
    10.1098/rspa.1966.0242.) The sum is convex and falls with d: Newton steps from below never overshoot. The
    maximum of the heights is 0, and so is the level where the sum is not above 0.
    """
    level = -overlap  # the highest site alone would overlap enough
    while overlap > 0:
        heights = heights[heights > level]  # sites below it stay below
        rise = (float((heights - level).sum()) - overlap) / max(heights.size, 1)
        if not rise > 1e-9 * abs(level):
            return level
        level += rise
    return 0.0
