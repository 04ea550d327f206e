"""Figure 4: a self-affine surface, and where it touches as the load grows."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from asperity.analysis import SiteState
from asperity.base.words import power, thousands
from asperity_research.paper.figures.marks import SMALLEST, draw_marks, site_side, width_in_words
from asperity_research.paper.figures.paper_figure import PAGE, PaperFigure, captioned
from asperity_research.studies.evidence import Evidence

_STUDY = "load_maps"
_COLUMNS = 2
_TEXT = 8.0
_FAINT = LinearSegmentedColormap.from_list("faint", ["0.80", "1.0"])
"""A relief light enough that black sites stand out on it."""


def figure_4(evidence: Evidence) -> PaperFigure:
    """Draw the topography, and for each load a map of the sites in contact."""
    tables = _tables(evidence)
    figure, width = _drawn(tables)
    return captioned(4, figure, tables, {"width": width})


def _tables(evidence: Evidence) -> dict[str, pd.DataFrame]:
    """The heights; the sites in contact at each load; and their number."""
    seed = int(evidence[_STUDY]["seed"][0])
    contacts, areas = [], []
    for load in sorted(evidence.values(_STUDY, "load")):
        kept = evidence.fields(_STUDY, load=load, seed=seed)
        heights = np.asarray(kept["heights"], dtype=np.float64)
        y, x = np.nonzero(np.asarray(kept["in_contact"].sel(field_time=0.0), dtype=bool))
        contacts.append(pd.DataFrame({"load": load, "time": 0.0, "state": "in contact", "x": x, "y": y}))
        areas.append({"load": load, "area": x.size, "contact_fraction": x.size / heights.size})
    rows, columns = np.indices(heights.shape)
    return {
        "topography": pd.DataFrame({"x": columns.ravel(), "y": rows.ravel(), "height": heights.ravel()}),
        "contacts": pd.concat(contacts, ignore_index=True),
        "area": pd.DataFrame(areas),
    }


def _drawn(tables: dict[str, pd.DataFrame]) -> tuple[Figure, str]:
    """Draw the panels; say also how wide the marks are."""
    topography, contacts, area = tables["topography"], tables["contacts"], tables["area"]
    heights = topography.pivot_table(index="y", columns="x", values="height").to_numpy()
    count = 1 + len(area)
    rows = math.ceil(count / _COLUMNS)
    figure = Figure(figsize=(PAGE, 3.1 * rows), layout="constrained")
    panels = figure.subplots(rows, _COLUMNS, squeeze=False).ravel()
    for unused in panels[count:]:
        unused.set_axis_off()
    image = panels[0].imshow(heights, cmap="gray", interpolation="none", rasterized=True)
    panels[0].set_title(r"(a) topography $\xi(\mathbf{r})$", fontsize=_TEXT + 1)
    bar = figure.colorbar(image, ax=panels[:count].tolist(), location="right", aspect=40, pad=0.02)
    bar.set_label(r"height $\xi$ in (a)", fontsize=_TEXT)
    bar.ax.tick_params(labelsize=_TEXT - 1)
    for number, axes in enumerate(panels[:count]):
        if number:
            axes.imshow(heights, cmap=_FAINT, interpolation="none", rasterized=True)
            axes.set_title(_title(number, area.iloc[number - 1]), fontsize=_TEXT + 1)
        _label(axes, heights.shape, left=number % _COLUMNS == 0, low=number + _COLUMNS >= count)
    site = site_side(panels[0], heights.shape[1])
    side = max(site, SMALLEST)
    for axes, load in zip(panels[1:count], area["load"], strict=True):
        states = np.full(heights.shape, SiteState.FREE, dtype=np.int8)
        here = contacts[contacts["load"] == load]
        states[here["y"], here["x"]] = SiteState.KEPT
        draw_marks(axes, states, side)
    return figure, width_in_words(side, site)


def _title(number: int, row: pd.Series[float]) -> str:
    letter = chr(ord("a") + number)
    load, size = power(row["load"]), thousands(int(row["area"]))
    return f"({letter}) $F_N/k_0 = {load}$:  $A$ = {size} ({100 * row['contact_fraction']:.2g} %)"


def _label(axes: Axes, shape: tuple[int, ...], *, left: bool, low: bool) -> None:
    axes.set_xticks([0, shape[1] // 2, shape[1] - 1])
    axes.set_yticks([0, shape[0] // 2, shape[0] - 1])
    axes.tick_params(labelsize=_TEXT - 1, labelbottom=low, labelleft=left)
    if low:
        axes.set_xlabel("$x$ (sites)", fontsize=_TEXT)
    if left:
        axes.set_ylabel("$y$ (sites)", fontsize=_TEXT)
