"""Figure 1: a sketch of the model, drawn to scale from a simulation of a line contact."""

from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from asperity.base.words import power
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.paper.figures.curves import LABEL, mark
from asperity_research.paper.figures.paper_figure import PAGE, PaperFigure, captioned
from asperity_research.studies.evidence import Evidence

_BAR, _BULK, _LATERAL = "0.72", "0.90", "0.35"
_ROOM = 4  # Sites to either side of the place where the symbols are named


def figure_1(evidence: Evidence) -> PaperFigure:
    """Draw the surfaces and the springs before contact, right after it, and after a while.

    Table ``sites``: r, xi, u, u0, and whether it is in contact, by site and state, of the study ``sketch``.
    """
    dataset = evidence["sketch"]
    seed = int(dataset["seed"][0])
    sites = _sites(evidence.fields("sketch", seed=seed))
    load = float(dataset["load"].sel(seed=seed)[0])
    return captioned(1, _drawn(sites), {"sites": sites}, {"load": load})


def _sites(fields: xr.Dataset) -> pd.DataFrame:
    """One row a site and state."""
    heights = np.asarray(fields["heights"], dtype=np.float64)
    above = heights.max() + 0.12 * np.ptp(heights)
    site = {"r": np.arange(heights.size), "xi": heights}
    free = {"u": above, "u0": above, "in_contact": False}
    parts = [pd.DataFrame({"state": "before contact", "time": np.nan} | site | free)]
    for index in (0, -1):
        kept = fields.isel(field_time=index)
        time = float(kept["field_time"])
        held = {name: kept[name].values for name in ("u", "u0", "in_contact")}
        parts.append(pd.DataFrame({"state": f"{time:g}", "time": time} | site | held))
    return pd.concat(parts, ignore_index=True)


def _drawn(sites: pd.DataFrame) -> Figure:
    # Long enough that every spring has a length, at its shortest a fifth of that at rest.
    rest = 1.25 * max(float((sites["u"] - sites["u0"]).max()), 0.2 * float(np.ptp(sites["xi"])))
    sites = sites.assign(anchor=sites["u0"] + rest)
    top, bottom = float(sites["anchor"].max()), float(sites["xi"].min())
    span = top - bottom
    figure = Figure(figsize=(PAGE, 1.65 * 3 + 0.3), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True, sharey=True)
    states = [state for _, state in sites.groupby("state", sort=False)]
    for letter, axes, state in zip("abc", panels, states, strict=True):
        axes.set_ylim(bottom - 0.04 * span, top + 0.24 * span)
        axes.set_xlim(-1.0, len(state) + 1.3)
        _draw_state(axes, state)
        time = state["time"].iloc[0]
        words = "before contact" if np.isnan(time) else f"in contact, $t\\,k_0 R = {power(time)}$"
        axes.set_title(f"({letter}) {words}", fontsize=LABEL + 1, loc="left")
        axes.set_axis_off()
    _name_symbols(panels[0], states[0], rest)
    handles = [
        mark("o", "white", style.BLUE, "anchors $u^0$", 4.5),
        mark("o", style.INK, style.INK, "elastic surface $u$", 4.5),
        mark("D", style.VERMILION, style.INK, "in contact", 4.5),
        Patch(color=_BAR, label=r"rigid rough surface $\xi$"),
        Patch(color=_BULK, label="bulk"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=5, fontsize=LABEL, frameon=False)
    return figure


def _draw_state(axes: Axes, state: pd.DataFrame) -> None:
    r, xi, u, anchors, touching = (
        state[name].to_numpy() for name in ("r", "xi", "u", "anchor", "in_contact")
    )
    last = len(r) - 1
    floor, ceiling = axes.get_ylim()
    axes.bar(r, xi - floor, bottom=floor, width=0.62, color=_BAR, linewidth=0, zorder=1)
    axes.hlines(xi, r - 0.31, r + 0.31, color=_LATERAL, linewidth=1.0, zorder=2)
    around = np.concatenate([[-0.5], r, [last + 0.5]])
    axes.fill_between(around, np.interp(around, r, anchors), ceiling, color=_BULK, linewidth=0, zorder=0)
    vertical = [_zigzag((x, low), (x, high), (0.2, 0.0)) for x, low, high in zip(r, u, anchors, strict=True)]
    axes.add_collection(LineCollection(vertical, colors=style.BLUE, linewidths=0.8, zorder=3))
    wave = (0.0, 0.018 * (ceiling - floor))
    lateral = [_zigzag((x, u[x]), (x + 1, u[x + 1]), wave, turns=5) for x in range(last)]
    seam = (u[0] + u[-1]) / 2  # half a spring at either end: the line is periodic
    lateral += [_zigzag((-0.5, seam), (0, u[0]), wave, turns=2)]
    lateral += [_zigzag((last, u[-1]), (last + 0.5, seam), wave, turns=2)]
    axes.add_collection(LineCollection(lateral, colors=_LATERAL, linewidths=0.8, zorder=4))
    axes.plot(r, anchors, "o", color="white", markeredgecolor=style.BLUE, markersize=4, zorder=5)
    axes.plot(r[~touching], u[~touching], "o", color=style.INK, markersize=4, zorder=6)
    diamonds: dict[str, Any] = {"color": style.VERMILION, "markeredgecolor": style.INK, "markersize": 5}
    axes.plot(r[touching], u[touching], "D", zorder=7, **diamonds)
    mean, edge = float(anchors.mean()), len(r) + 0.1
    axes.plot([-0.5, edge + 0.6], [mean, mean], "--", color=style.INK, linewidth=0.8, zorder=4)
    arrow = {"arrowstyle": "<->", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=(edge, mean), xytext=(edge, floor), arrowprops=arrow)
    axes.text(edge + 0.2, (mean + floor) / 2, r"$\overline{u^0}$", fontsize=LABEL + 1, va="center")


def _zigzag(
    start: tuple[float, float], end: tuple[float, float], wave: tuple[float, float], turns: int = 7
) -> Field:
    """A spring as a polyline: straight ends, and between them turns to either side by half of `wave`."""
    along = np.concatenate([[0.0], np.linspace(0.18, 0.82, turns + 2), [1.0]])
    aside = np.concatenate([[0.0, 0.0], 0.5 * (-1.0) ** np.arange(turns), [0.0, 0.0]])
    line = np.outer(1 - along, start) + np.outer(along, end)
    return np.asarray(line + np.outer(aside, wave))


def _name_symbols(axes: Axes, state: pd.DataFrame, rest: float) -> None:
    """Point at one of each thing, below the flat surface where there is most room."""
    xi, level = state["xi"].to_numpy(), float(state["u"].iloc[0])
    crests = np.lib.stride_tricks.sliding_window_view(xi, 2 * _ROOM + 1).max(axis=1)
    at = _ROOM + int(crests.argmin())
    low = (level + crests.min()) / 2
    high = level + rest + 0.1 * (axes.get_ylim()[1] - axes.get_ylim()[0])
    look: dict[str, Any] = {"fontsize": LABEL + 1, "ha": "center", "zorder": 9}
    look["arrowprops"] = {"arrowstyle": "-", "linewidth": 0.6, "shrinkA": 1, "shrinkB": 2}
    for text, point, place in (
        (r"$u^0(r)$", (at - 3, level + rest), (at - 3, high)),
        (r"$k_1$", (at + 0.1, level + 0.6 * rest), (at + 1.2, high)),
        (r"$u(r)$", (at - 3, level), (at - 3, low)),
        (r"$k_0$", (at - 0.5, level), (at - 0.5, low)),
        (r"$\xi(r)$", (at + 2, xi[at + 2]), (at + 2, low)),
    ):
        side = "bottom" if place[1] > point[1] else "top"
        axes.annotate(text, xy=point, xytext=place, va=side, **look)
