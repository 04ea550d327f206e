"""Figure 6: the growth of the area at constant load on self-affine surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from asperity.errors import ConvergenceError, InputError
from asperity.fits import logarithm
from asperity_research import style
from asperity_research.paper.figures import curves
from asperity_research.paper.figures.paper_figure import PAGE, PaperFigure, captioned
from asperity_research.studies.evidence import Evidence

_LAST = 1e4
"""Latest time (1/(k0 R)) to which the logarithm is fitted: the paper excepts very long times."""


def figure_6(evidence: Evidence) -> PaperFigure:
    """Draw A(t), and A(t)/A(0), for several loads and sizes, with fits of Eq. (log).

    Tables ``area``, ``growth``, ``fits`` and ``fitted``, of the study ``self_affine_aging``.
    """
    growth = curves.over_seeds(
        evidence, "self_affine_aging", "area", called="area_ratio", statistic=curves.growth
    )
    fits = _fits(growth)
    tables = {
        "area": curves.over_seeds(evidence, "self_affine_aging", "area", called="area"),
        "growth": growth,
        "fits": fits,
        "fitted": _fitted(fits, growth["time"]),
    }
    return captioned(6, _draw(tables), tables, {"last": _LAST})


def _fits(growth: pd.DataFrame) -> pd.DataFrame:
    """One logarithm for all loads and sizes of a stiffness ratio; none where the areas refuse it."""
    rows = []
    for k1, part in growth.query("0 < time <= @_LAST").groupby("k1"):
        time, ratio = part["time"].to_numpy(np.float64), part["area_ratio"].to_numpy(np.float64)
        try:
            fit = logarithm(np.append(0.0, time), np.append(1.0, ratio))
        except (InputError, ConvergenceError):
            continue
        rows.append({"k1": k1, "C": fit.C, "t0": fit.t0, "last": time.max(), "rms_misfit": fit.rms_residual})
    return pd.DataFrame(rows, columns=["k1", "C", "t0", "last", "rms_misfit"])


def _fitted(fits: pd.DataFrame, times: pd.Series) -> pd.DataFrame:
    time = np.unique(times[times > 0])
    return curves.stacked(
        [
            pd.DataFrame({"k1": k1, "time": time, "area_ratio": 1 + C * np.log1p(time / t0)})
            for k1, C, t0 in fits[["k1", "C", "t0"]].to_numpy(np.float64)
        ],
        ["k1", "time", "area_ratio"],
    )


def _draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    area, growth = tables["area"].query("time > 0"), tables["growth"].query("time > 0")
    figure = Figure(figsize=(PAGE, 3.0), layout="constrained")
    raw, scaled = figure.subplots(1, 2)
    raw.set(xscale="log", yscale="log")
    stiff = float(area["k1"].max())
    stiffest = area[area["k1"] == stiff]
    for (load, size), (look, filled) in _styles(stiffest).items():
        part = stiffest[(stiffest["load"] == load) & (stiffest["size"] == size)]
        curves.band(raw, part, "time", "area", look, filled=filled)
    heaviest = float(stiffest["load"].max())
    for load in stiffest["load"].unique():
        part = stiffest[stiffest["load"] == load]
        text = rf"$F_N/k_0 = {load:g}$" if load == heaviest else f"{load:g}"
        last = part[part["time"] == part["time"].max()]
        at = float(last["time"].iloc[0]), 1.3 * float(last[["area", "area_high"]].max(axis=None))
        curves.note(raw, text, at, where="right")
    curves.dress(raw, r"hold time  $t\,k_0 R$", r"contact area  $A(t)$  (sites)", panel="(a)")
    raw.set_title(rf"$k_1/k_0 = {stiff:g}$", fontsize=curves.LABEL, pad=3)
    raw.set_ylim(top=2.0 * float(stiffest["area"].max()))
    scaled.set_xscale("log")
    _relative(scaled, growth)
    _last_intervals(scaled, growth)
    for _, fitted in tables["fitted"].groupby("k1"):
        scaled.plot(fitted["time"], fitted["area_ratio"], "--", color=style.INK, linewidth=1.0, zorder=5)
    curves.dress(scaled, r"hold time  $t\,k_0 R$", r"$A(t)\,/\,A(0)$", panel="(b)")
    _explain(scaled, area)
    return figure


def _last_intervals(axes: Axes, growth: pd.DataFrame) -> None:
    """Draw the intervals of the last values side by side, right of the curves, which they would hide.

    Below those of each stiffness ratio, and above those of the largest, is its name.
    """
    last = growth[growth["time"] == growth["time"].max()]
    for at, ((load, size), (look, filled)) in enumerate(_styles(growth).items()):
        part = last[(last["load"] == load) & (last["size"] == size)]
        aside = part.assign(time=part["time"] * 10 ** (0.4 + 0.25 * at))
        curves.points(axes, aside, "time", "area_ratio", look, filled=filled, size=2.5)
    middle = float(last["time"].iloc[0]) * 10 ** (0.4 + 0.125 * (len(_styles(growth)) - 1))
    ends = last[["area_ratio", "area_ratio_low", "area_ratio_high"]]
    axes.set_ylim(top=1.1 * float(ends.max(axis=None)))
    for k1 in last["k1"].unique():
        here, top = ends[last["k1"] == k1], k1 == last["k1"].max()
        level = float((here.max() if top else here.min()).agg("max" if top else "min"))
        away = 0.04 * float(ends.max(axis=None)) * (1 if top else -1)
        curves.note(axes, rf"$k_1/k_0 = {k1:g}$", (middle, level + away), where="center")


def _styles(table: pd.DataFrame) -> dict[tuple[float, float], tuple[curves.Look, bool]]:
    """Colors and markers tell loads, whether markers are full tells sizes."""
    loads, sizes = np.unique(table["load"]), np.unique(table["size"])
    return {
        (load, size): (look, at % 2 == 0)
        for load, look in zip(loads, curves.looks(len(loads)), strict=True)
        for at, size in enumerate(sizes)
    }


def _relative(axes: Axes, growth: pd.DataFrame) -> None:
    """Draw thin curves whose symbols take turns: at each time one load and size has its symbol."""
    styles = _styles(growth)
    for at, ((load, size), (look, filled)) in enumerate(styles.items()):
        for _, part in growth[(growth["load"] == load) & (growth["size"] == size)].groupby("k1"):
            face = {"markerfacecolor": look.color if filled else "white", "markeredgewidth": 0.7}
            how: dict[str, Any] = {
                "markevery": (at, len(styles)),
                "linewidth": 0.6,
                "markersize": 3.5,
                **face,
            }
            axes.plot(part["time"], part["area_ratio"], marker=look.marker, color=look.color, **how)


def _explain(axes: Axes, table: pd.DataFrame) -> None:
    """Legend: what tells loads, and what tells sizes."""
    entries: dict[str, list[Line2D]] = {}
    for (load, size), (look, filled) in _styles(table).items():
        face = look.color if filled else "none"
        mark = Line2D([], [], ls="", marker=look.marker, color=look.color, mfc=face, markersize=3.5, mew=0.7)
        entries.setdefault(f"$F_N/k_0 = {load:g}$", []).append(mark)
        entries.setdefault(f"${size:g}^2$ sites", []).append(mark)
    axes.plot([], [], "--", color=style.INK, linewidth=1.0, label="logarithm")
    ordered = sorted(entries.items(), key=lambda entry: "sites" in entry[0])
    curves.legend(axes, "upper left", together=dict(ordered))
