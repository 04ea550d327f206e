"""Figure 5: the area against the load on self-affine surfaces of several sizes, before creep and relaxed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity_research import style
from asperity_research.paper.figures import curves
from asperity_research.paper.figures.paper_figure import COLUMN, PaperFigure, captioned
from asperity_research.studies.evidence import Evidence

_EXPONENT = 0.8
"""The paper's, of the area against the load."""

_PARTIAL = 0.1
"""Contact fraction up to which a contact counts as far from full."""


def figure_5(evidence: Evidence) -> PaperFigure:
    """Draw A(F_N) of self-affine surfaces, in sites.

    Tables ``instantaneous`` and ``relaxed``, of the study ``self_affine_load``.
    """
    tables = {
        state: curves.over_seeds(evidence, "self_affine_load", area, called="area")
        for state, area in (("instantaneous", "initial_area"), ("relaxed", "relaxed_area"))
    }
    return captioned(5, _draw(tables), tables, {"exponent": _EXPONENT})


def _draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    figure = Figure(figsize=(COLUMN, 3.2), layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log")
    areas, relaxed = tables["instantaneous"], tables["relaxed"]
    sizes = areas["size"].unique()
    shrinking = np.linspace(5, 3, len(sizes))  # what lies on each other shows as rings
    for size, look, points in zip(sizes, curves.looks(len(sizes)), shrinking, strict=True):
        for state, filled in ((areas, True), (relaxed, False)):
            label = f"${size:g}^2$ sites" if filled else None
            here = state.query("size == @size")
            curves.points(axes, here, "load", "area", look, filled=filled, label=label, size=float(points))
        axes.axhline(size**2, color=look.color, linewidth=0.6, linestyle=(0, (6, 3)), zorder=0)
    axes.plot([], [], "o", color=style.INK, markerfacecolor="none", markersize=4.5, label="open: relaxed")
    curves.note(axes, "full contact", (float(areas["load"].min()), 1.5 * float(sizes.max()) ** 2))
    part = areas[areas["area"] < _PARTIAL * areas["size"] ** 2]
    if len(part):
        _power_law(axes, part)
    axes.set_ylim(areas["area"].min() / 3, 3 * sizes.max() ** 2)
    curves.dress(axes, r"normal load  $F_N\,/\,k_0$", r"contact area  $A$  (sites)")
    curves.legend(axes, "lower right")
    return figure


def _power_law(axes: Axes, areas: pd.DataFrame) -> None:
    """Draw the reference below the points of light loads, for comparison by eye."""
    loads, level = areas["load"].to_numpy(np.float64), areas["area"].to_numpy(np.float64)
    prefactor = 0.35 * float(np.exp(np.mean(np.log(level / loads**_EXPONENT))))
    ends = np.array([loads.min(), loads.max()])
    axes.plot(ends, prefactor * ends**_EXPONENT, ":", color=style.INK, linewidth=1.2)
    middle = float(np.sqrt(ends.prod()))
    curves.note(axes, f"$F_N^{{{_EXPONENT:g}}}$", (1.5 * middle, 0.7 * prefactor * middle**_EXPONENT))
