"""Figures 3 and 6: the growth of the area at constant load, with the laws that are fitted to it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from asperity.fits import ensemble, logarithm, saturation
from asperity_research import style
from asperity_research.paper.figures import curves
from asperity_research.paper.figures.paper_figure import PAGE, PaperFigure, captioned
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import all_columns

_SLOPE = 0.5  # The paper's beta, of q against the load
_LAST = 1e4  # Latest time (1/(k0 R)) to which the logarithm is fitted: the paper excepts very long times
_TIME, _RATIO = r"hold time  $t\,k_0 R$", r"$A(t)\,/\,A(0)$"


def figure_3(evidence: Evidence) -> PaperFigure:
    """Draw A(t)/A(0) for several loads and stiffness ratios with fits of Eq. (a), and their exponents q.

    Tables ``growth`` (with the fitted law at the same times) and ``fits``, of the study ``aging``.
    """
    sites = evidence.sites("aging")
    growth = curves.over_seeds(evidence, "aging", "area", "area_ratio", curves.growth)
    growth.insert(2, "load_per_site", growth["load"] / sites)
    rows = []
    for (k1, load), part in curves.parts(growth, ["k1", "load"]):
        areas = evidence.samples("aging", "area", k1=k1, load=load)
        fit = ensemble(saturation, part["time"].to_numpy(), areas)
        growth.loc[part.index, "fitted"] = fit.mean.area_ratio(part["time"])
        columns = all_columns(**{name: fit.parameters[name] for name in ("a", "q", "t0", "C")})
        row = {"k1": k1, "load": load, "load_per_site": load / sites, **columns}
        rows.append(row | {"rms_misfit": fit.mean.rms_residual, "seeds": float(fit.runs)})
    fits = pd.DataFrame(rows)
    tables, growth = {"growth": growth, "fits": fits}, growth.query("time > 0")
    looks = curves.looks(growth["load_per_site"].unique())
    figure = Figure(figsize=(PAGE, 2.7), layout="constrained")
    *panels, inset = figure.subplots(1, growth["k1"].nunique() + 1)
    inset.set(xscale="log", yscale="log")
    for at, (axes, (k1, curve)) in enumerate(zip(panels, curves.parts(growth, "k1"), strict=True)):
        axes.set_xscale("log")
        for load, part in curves.parts(curve, "load_per_site"):
            curves.band(axes, part, "time", "area_ratio", looks[load], f"{load:g}")
            axes.plot(part["time"], part["fitted"], "-", color=style.INK, linewidth=0.6)
        curves.dress(axes, _TIME, _RATIO, panel=f"({'abcdefgh'[at]})")
        name = rf"$k_1/k_0 = {k1:g}$"
        axes.set_title(name, fontsize=curves.LABEL, pad=3)
        look = curves.Look(style.INK, "os"[at % 2], at % 2 == 0)
        curves.points(inset, fits.query("k1 == @k1"), "load_per_site", "q", look, name)
    curves.legend(panels[0], "upper left", r"$F_N/(N_0 k_0\sigma)$")
    ends = np.array([fits["load_per_site"].min(), fits["load_per_site"].max()])
    load, q = (float(np.exp(np.log(fits[name]).mean())) for name in ("load_per_site", "q"))
    inset.plot(ends, q * (ends / load) ** _SLOPE, ":", color=style.INK, label=f"slope {_SLOPE:g}")
    curves.legend(inset, "lower right")
    last = f"({'abcdefgh'[len(panels)]})"
    curves.dress(inset, r"$F_N\,/\,(N_0 k_0\sigma)$", r"exponent  $q$", panel=last)
    return captioned(3, figure, tables, {"sites": sites, "slope": _SLOPE})


def figure_6(evidence: Evidence) -> PaperFigure:
    """Draw A(t), and A(t)/A(0), for several loads and sizes, with fits of Eq. (log).

    Tables ``area``, ``growth``, ``fits`` and ``fitted``, of the study ``self_affine_aging``.
    """
    study = "self_affine_aging"
    growth = curves.over_seeds(evidence, study, "area", "area_ratio", curves.growth)
    fits, laws, times = [], [], np.unique(growth.query("time > 0")["time"])
    for k1, part in growth.query("0 < time <= @_LAST").groupby("k1"):
        # One logarithm for all loads and sizes of a stiffness ratio.
        fit = logarithm(np.append(0.0, part["time"]), np.append(1.0, part["area_ratio"]))
        last = part["time"].max()
        fits.append({"k1": k1, "C": fit.C, "t0": fit.t0, "last": last, "rms_misfit": fit.rms_residual})
        law = 1 + fit.C * np.log1p(times / fit.t0)
        laws.append(pd.DataFrame({"k1": k1, "time": times, "area_ratio": law}))
    tables = {
        "area": curves.over_seeds(evidence, study, "area", "area"),
        "growth": growth,
        "fits": pd.DataFrame(fits),
        "fitted": pd.concat(laws, ignore_index=True),
    }
    area, growth = tables["area"].query("time > 0"), tables["growth"].query("time > 0")
    looks = _looks(area)
    figure = Figure(figsize=(PAGE, 3.0), layout="constrained")
    raw, scaled = figure.subplots(1, 2)
    raw.set(xscale="log", yscale="log")
    stiff = float(area["k1"].max())
    stiffest = area[area["k1"] == stiff]
    for place, part in curves.parts(stiffest, ["load", "size"]):
        curves.band(raw, part, "time", "area", looks[place])
    for load, part in curves.parts(stiffest, "load"):
        text = rf"$F_N/k_0 = {load:g}$" if load == stiffest["load"].max() else f"{load:g}"
        last = part[part["time"] == part["time"].max()]
        end = float(last["time"].iloc[0]), 1.3 * float(last[["area", "area_high"]].max(axis=None))
        curves.note(raw, text, end, where="right")
    curves.dress(raw, _TIME, r"contact area  $A(t)$  (sites)", panel="(a)")
    raw.set_title(rf"$k_1/k_0 = {stiff:g}$", fontsize=curves.LABEL, pad=3)
    raw.set_ylim(top=2.0 * float(stiffest["area"].max()))
    scaled.set_xscale("log")
    for at, (place, look) in enumerate(looks.items()):
        # Symbols take turns: at each time one load and size has its own.
        face = {"markerfacecolor": look.color if look.filled else "white", "markeredgewidth": 0.7}
        how: dict[str, Any] = {"markevery": (at, len(looks)), "linewidth": 0.6, "markersize": 3.5, **face}
        for _, part in curves.parts(growth.groupby(["load", "size"]).get_group(place), "k1"):
            scaled.plot(part["time"], part["area_ratio"], marker=look.marker, color=look.color, **how)
    _last_intervals(scaled, growth, looks)
    for _, fitted in curves.parts(tables["fitted"], "k1"):
        scaled.plot(fitted["time"], fitted["area_ratio"], "--", color=style.INK, linewidth=1.0, zorder=5)
    curves.dress(scaled, _TIME, _RATIO, panel="(b)")
    scaled.plot([], [], "--", color=style.INK, linewidth=1.0, label="logarithm")
    together: dict[str, list[Line2D]] = {}
    for name in ("$F_N/k_0 = {load:g}$", "${size:g}^2$ sites"):
        for (load, size), look in looks.items():
            mark = Line2D(
                [], [], ls="", marker=look.marker, color=look.color, mfc=look.face, markersize=3.5, mew=0.7
            )
            together.setdefault(name.format(load=load, size=size), []).append(mark)
    curves.legend(scaled, "upper left", together=together)
    return captioned(6, figure, tables, {"last": _LAST})


def _looks(table: pd.DataFrame) -> dict[tuple[float, float], curves.Look]:
    """Colors and markers tell loads, whether markers are full tells sizes."""
    return {
        (load, size): look._replace(filled=at % 2 == 0)
        for load, look in curves.looks(np.unique(table["load"])).items()
        for at, size in enumerate(np.unique(table["size"]))
    }


def _last_intervals(
    axes: Axes, growth: pd.DataFrame, looks: Mapping[tuple[float, float], curves.Look]
) -> None:
    """Draw the intervals of the last values side by side, right of the curves, which they would hide.

    Below those of each stiffness ratio, and above those of the largest, is its name.
    """
    last = growth[growth["time"] == growth["time"].max()]
    for at, (place, part) in enumerate(curves.parts(last, ["load", "size"])):
        aside = part.assign(time=part["time"] * 10 ** (0.4 + 0.25 * at))
        curves.points(axes, aside, "time", "area_ratio", looks[place], size=2.5)
    middle = float(last["time"].iloc[0]) * 10 ** (0.4 + 0.125 * (len(looks) - 1))
    ends = last[["area_ratio", "area_ratio_low", "area_ratio_high"]]
    axes.set_ylim(top=1.1 * float(ends.max(axis=None)))
    for k1 in last["k1"].unique():
        rows, top = ends[last["k1"] == k1], k1 == last["k1"].max()
        level = float((rows.max() if top else rows.min()).agg("max" if top else "min"))
        away = 0.04 * float(ends.max(axis=None)) * (1 if top else -1)
        curves.note(axes, rf"$k_1/k_0 = {k1:g}$", (middle, level + away), where="center")
