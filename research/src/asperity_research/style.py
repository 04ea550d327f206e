"""What all figures share: colors, and points with their intervals.

The hues are of the set of M. Okabe and K. Ito, "Color Universal Design" (2008), as in Asperity.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from asperity.figures import Drawing

INK, BLUE, VERMILION, SKY, GRAY = "#000000", "#0072B2", "#D55E00", "#56B4E9", "#8C8C8C"


def points(ax: Axes, rows: pd.DataFrame, x: str, y: str, look: str, color: str, **more: Any) -> None:
    """Draw column y of a table against x, with 95 % intervals as bars.

    These end at Y_low and Y_high, or low and high. Look and more: as of `Axes.errorbar`.
    """
    head = f"{y}_" if f"{y}_low" in rows else ""
    bars = (rows[y] - rows[f"{head}low"], rows[f"{head}high"] - rows[y])
    shared = {"markersize": 4, "linewidth": 0.8}
    ax.errorbar(rows[x], rows[y], yerr=bars, fmt=look, color=color, **{**shared, **more})


def families(
    ax: Axes,
    rows: pd.DataFrame,
    of: str,
    x: str,
    y: str,
    looks: Mapping[str, tuple[str, str, str]],
    **more: Any,
) -> None:
    """Draw the points of each value of a column that has a look: mark and line, color, and label."""
    for name, (look, color, label) in looks.items():
        points(ax, rows[rows[of] == name], x, y, look, color, label=label, **more)


def panels(width: float, height: float, columns: int = 1, rows: int = 1) -> tuple[Drawing, np.ndarray]:
    """Return a figure of a size in inches, and its axes in the order of reading."""
    figure = Drawing(figsize=(width, height))
    return figure, figure.subplots(rows, columns, squeeze=False).ravel()
