"""How maps of the contact mark a site: one color for each state, and marks large enough to be seen."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from asperity.analysis import SiteState
from asperity_research import style

COLORS = {SiteState.KEPT: style.INK, SiteState.NEW: style.VERMILION, SiteState.LOST: style.SKY}
"""They differ from each other, and from white, in luminance too."""

SMALLEST = 0.8
"""Smallest side of a mark that is drawn faithfully at 200 dots per inch, points: about two pixels."""


def show_lattice(axes: Axes, shape: tuple[int, ...]) -> None:
    """Make room for a lattice of this shape: the first axis downward, sites as wide as high."""
    axes.set_xlim(-0.5, shape[1] - 0.5)
    axes.set_ylim(shape[0] - 0.5, -0.5)
    axes.set_aspect("equal")


def draw_marks(axes: Axes, states: NDArray[np.int8], side: float) -> None:
    """Put a square mark, its side in points, on each site that is, or was, in contact."""
    # Marks that only just meet leave light seams between them: below, the sites themselves, without any.
    palette = np.zeros((len(SiteState), 4))
    for state, color in COLORS.items():
        palette[state] = to_rgba(color)
    axes.imshow(palette[states], interpolation="none", rasterized=True)
    show_lattice(axes, states.shape)
    for state, color in COLORS.items():
        rows, columns = np.nonzero(states == state)
        if rows.size:
            # A color each and no snapping: else marks move to whole pixels, and gaps open between them.
            look: dict[str, Any] = {"marker": "s", "linewidths": 0, "rasterized": True, "snap": False}
            axes.scatter(columns, rows, s=side**2, c=[color] * rows.size, **look)


def mark(marker: str, face: str, edge: str, label: str, size: float = 5) -> Line2D:
    """Return a mark for a legend."""
    look: dict[str, Any] = {"color": face, "markeredgecolor": edge, "markersize": size}
    return Line2D([], [], ls="", marker=marker, label=label, **look)


def site_side(axes: Axes, sites: int) -> float:
    """Side of a site, points, in a figure that is laid out, of so many sites along the horizontal axis."""
    figure = axes.get_figure(root=True)
    assert figure is not None  # a map without a figure has no size
    figure.draw_without_rendering()
    return float(72 * axes.get_window_extent().width / figure.dpi / sites)


def width_in_words(side: float, site: float) -> str:
    """Say how wide marks are, for "sites, drawn ...": sides of a mark and of a site, points."""
    return "to scale" if side == site else f"{side / site:.1f} times as wide as they are, to be seen"
