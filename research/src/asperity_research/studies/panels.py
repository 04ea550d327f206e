"""What the figures of studies share: points of a table with their intervals."""

from __future__ import annotations

from typing import Any

import pandas as pd
from matplotlib.axes import Axes


def points(ax: Axes, rows: pd.DataFrame, x: str, y: str, look: str, color: str, **more: Any) -> None:
    """Draw a column of a table against another, with 95 % intervals as bars.

    Parameters
    ----------
    ax
        Where.
    rows
        The table; see `asperity_research.studies.numbers.columns`.
    x, y
        The columns. The ends of the intervals are Y_low and Y_high, or low and high.
    look, color
        Marks and line, as matplotlib has them.
    more
        As `matplotlib.axes.Axes.errorbar`, such as a label.
    """
    head = f"{y}_" if f"{y}_low" in rows else ""
    bars = (rows[y] - rows[f"{head}low"], rows[f"{head}high"] - rows[y])
    shared = {"markersize": 4, "linewidth": 0.8}
    ax.errorbar(rows[x], rows[y], yerr=bars, fmt=look, color=color, **{**shared, **more})
