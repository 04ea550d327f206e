"""Figure 1: a sketch of the model, drawn to scale from a simulation of a line contact."""

from __future__ import annotations

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
from asperity_research.paper.figures.marks import mark
from asperity_research.paper.figures.paper_figure import PAGE, PaperFigure, captioned
from asperity_research.studies.evidence import Evidence

_BEFORE = "before contact"
_STUDY = "sketch"
_BAR = "0.72"
_BULK = "0.90"
_TEXT = 8.0


def figure_1(evidence: Evidence) -> PaperFigure:
    """Draw the surfaces and the springs before contact, right after it, and after a while."""
    dataset = evidence[_STUDY]
    seed = int(dataset["seed"][0])
    fields = evidence.fields(_STUDY, seed=seed)
    sites = _sites(fields)
    load = float(dataset["load"].sel(seed=seed)[0])
    states = list(sites["state"].unique())
    return captioned(1, _drawn(sites, states), {"sites": sites}, {"load": load})


def _sites(fields: xr.Dataset) -> pd.DataFrame:
    """One row a site and state: r, xi, u, u0, and whether it is in contact."""
    heights = np.asarray(fields["heights"], dtype=np.float64)
    above = heights.max() + 0.12 * np.ptp(heights)
    site = {"r": np.arange(heights.size), "xi": heights}
    free = {"u": above, "u0": above, "in_contact": False}
    parts = [pd.DataFrame({"state": _BEFORE, "time": np.nan} | site | free)]
    times = np.asarray(fields["field_time"], dtype=np.float64)
    for index in sorted({0, len(times) - 1}):
        kept = fields.isel(field_time=index)
        held = {name: kept[name].values for name in ("u", "u0", "in_contact")}
        parts.append(pd.DataFrame({"state": f"{times[index]:g}", "time": times[index]} | site | held))
    return pd.concat(parts, ignore_index=True)


def _drawn(sites: pd.DataFrame, states: list[str]) -> Figure:
    figure = Figure(figsize=(PAGE, 1.65 * len(states) + 0.3), layout="constrained")
    panels = figure.subplots(len(states), 1, squeeze=False, sharex=True, sharey=True).ravel()
    rest = _rest_length(sites)
    top = float((sites["u0"] + rest).max())
    bottom = float(sites["xi"].min())
    span = top - bottom
    for letter, axes, state in zip("abcdef", panels, states, strict=False):
        here = sites[sites["state"] == state]
        axes.set_ylim(bottom - 0.04 * span, top + 0.24 * span)
        axes.set_xlim(-1.0, len(here) + 1.3)
        _draw_state(axes, here, rest)
        time = here["time"].iloc[0]
        words = _BEFORE if np.isnan(time) else f"in contact, $t\\,k_0 R = {power(time)}$"
        axes.set_title(f"({letter}) {words}", fontsize=_TEXT + 1, loc="left")
        axes.set_axis_off()
    _name_symbols(panels[0], sites[sites["state"] == states[0]], rest)
    _add_legend(figure)
    return figure


def _rest_length(sites: pd.DataFrame) -> float:
    """Long enough that every spring has a length, at its shortest a fifth of that at rest."""
    return 1.25 * max(float((sites["u"] - sites["u0"]).max()), 0.2 * float(np.ptp(sites["xi"])))


def _draw_state(axes: Axes, here: pd.DataFrame, rest: float) -> None:
    r, xi, u = (here[name].to_numpy() for name in ("r", "xi", "u"))
    anchors = here["u0"].to_numpy() + rest
    touching = here["in_contact"].to_numpy()
    floor, ceiling = axes.get_ylim()
    axes.bar(r, xi - floor, bottom=floor, width=0.62, color=_BAR, linewidth=0, zorder=1)
    axes.hlines(xi, r - 0.31, r + 0.31, color="0.35", linewidth=1.0, zorder=2)
    around = np.concatenate([[r[0] - 0.5], r, [r[-1] + 0.5]])
    bulk = np.interp(around, r, anchors)
    axes.fill_between(around, bulk, ceiling, color=_BULK, linewidth=0, zorder=0)
    vertical = [_zigzag((x, low), (x, high), (0.2, 0.0)) for x, low, high in zip(r, u, anchors, strict=True)]
    axes.add_collection(LineCollection(vertical, colors=style.BLUE, linewidths=0.8, zorder=3))
    wave = 0.018 * (ceiling - floor)
    lateral = [_zigzag((x, u[x]), (x + 1, u[x + 1]), (0.0, wave), turns=5) for x in range(len(r) - 1)]
    seam = (u[0] + u[-1]) / 2  # half a spring at either end: the line is periodic
    lateral += [_zigzag((-0.5, seam), (0, u[0]), (0.0, wave), turns=2)]
    lateral += [_zigzag((len(r) - 1, u[-1]), (len(r) - 0.5, seam), (0.0, wave), turns=2)]
    axes.add_collection(LineCollection(lateral, colors="0.35", linewidths=0.8, zorder=4))
    axes.plot(r, anchors, "o", color="white", markeredgecolor=style.BLUE, markersize=4, zorder=5)
    axes.plot(r[~touching], u[~touching], "o", color=style.INK, markersize=4, zorder=6)
    diamonds: dict[str, Any] = {"color": style.VERMILION, "markeredgecolor": style.INK, "markersize": 5}
    axes.plot(r[touching], u[touching], "D", zorder=7, **diamonds)
    mean = float(anchors.mean())
    edge = len(r) + 0.1
    axes.plot([-0.5, edge + 0.6], [mean, mean], "--", color=style.INK, linewidth=0.8, zorder=4)
    arrow = {"arrowstyle": "<->", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=(edge, mean), xytext=(edge, floor), arrowprops=arrow)
    axes.text(edge + 0.2, (mean + floor) / 2, r"$\overline{u^0}$", fontsize=_TEXT + 1, va="center")


def _zigzag(
    start: tuple[float, float], end: tuple[float, float], wave: tuple[float, float], turns: int = 7
) -> Field:
    """A spring as a polyline: straight ends, and between them turns to either side by half of `wave`."""
    along = np.concatenate([[0.0], np.linspace(0.18, 0.82, turns + 2), [1.0]])
    aside = np.concatenate([[0.0, 0.0], 0.5 * (-1.0) ** np.arange(turns), [0.0, 0.0]])
    line = np.outer(1 - along, start) + np.outer(along, end)
    return np.asarray(line + np.outer(aside, wave))


def _name_symbols(axes: Axes, here: pd.DataFrame, rest: float) -> None:
    """Point at one of each thing, below the flat surface where there is most room."""
    r, xi, u = (here[name].to_numpy() for name in ("r", "xi", "u"))
    room = 4
    crests = np.array([xi[x - room : x + room + 1].max() for x in range(room, len(r) - room)])
    at = room + int(crests.argmin()) if crests.size else len(r) // 2
    level = float(u[0])
    low = (level + crests.min()) / 2 if crests.size else level
    high = level + rest + 0.1 * (axes.get_ylim()[1] - axes.get_ylim()[0])
    named = [
        (r"$u^0(r)$", (at - 3, level + rest), (at - 3, high)),
        (r"$k_1$", (at + 0.1, level + 0.6 * rest), (at + 1.2, high)),
        (r"$u(r)$", (at - 3, level), (at - 3, low)),
        (r"$k_0$", (at - 0.5, level), (at - 0.5, low)),
        (r"$\xi(r)$", (at + 2, xi[(at + 2) % len(r)]), (at + 2, low)),
    ]
    look: dict[str, Any] = {"fontsize": _TEXT + 1, "ha": "center", "zorder": 9}
    look["arrowprops"] = {"arrowstyle": "-", "linewidth": 0.6, "shrinkA": 1, "shrinkB": 2}
    for text, point, place in named:
        side = "bottom" if place[1] > point[1] else "top"
        axes.annotate(text, xy=point, xytext=place, va=side, **look)


def _add_legend(figure: Figure) -> None:
    handles = [
        mark("o", "white", style.BLUE, "anchors $u^0$", 4.5),
        mark("o", style.INK, style.INK, "elastic surface $u$", 4.5),
        mark("D", style.VERMILION, style.INK, "in contact", 4.5),
        Patch(color=_BAR, label=r"rigid rough surface $\xi$"),
        Patch(color=_BULK, label="bulk"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=5, fontsize=_TEXT, frameon=False)
