"""Asperities as if they were independent (Greenwood and Williamson): where to look for contacts first."""

from __future__ import annotations

import numpy as np

from asperity.contact.compiled import compiled
from asperity.lattice import Field


def level_of_overlap(heights: Field, overlap: float) -> float:
    """Level d above which the heights overlap by a given sum, sum (heights - d)+ = overlap.

    Each asperity that reaches the level carries the site stiffness times its overlap: at d these forces
    add up to the load. (J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966), DOI
    10.1098/rspa.1966.0242.) The sum is convex and falls with d: Newton steps from below never overshoot. The
    maximum of the heights is 0, and so is the level where the sum is not above 0.
    """
    rows = np.atleast_2d(heights)
    sums = np.empty((len(rows), 2))
    level = -overlap  # the highest site alone would overlap enough
    while overlap > 0:
        overlap_by_rows(rows, level, sums)
        total, count = sums.sum(axis=0).tolist()
        rise = (total - overlap) / count if count else 0.0
        if not rise > 1e-9 * abs(level):
            return level
        level += rise
    return 0.0


@compiled
def overlap_by_rows(heights: Field, level: float, out: Field) -> None:
    """Sum of what rises above a level, and the number of sites that do, by rows."""
    for i in range(heights.shape[0]):
        row = heights[i]
        total = count = 0.0
        for j in range(row.shape[0]):
            rise = row[j] - level
            total += rise if rise > 0.0 else 0.0
            count += 1.0 if rise > 0.0 else 0.0
        out[i, 0], out[i, 1] = total, count
