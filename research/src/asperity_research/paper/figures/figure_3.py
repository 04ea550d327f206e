"""Figure 3: the growth of the area at constant load, the law of saturation, and its exponent."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.errors import ConvergenceError, InputError
from asperity.fits import EnsembleFit, SaturationFit, ensemble, saturation
from asperity_research import style
from asperity_research.paper.figures import curves
from asperity_research.paper.figures.paper_figure import PAGE, PaperFigure, captioned
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import all_columns

_SLOPE = 0.5
"""The paper's beta, of q against the load."""


def figure_3(evidence: Evidence) -> PaperFigure:
    """Draw A(t)/A(0) for several loads and stiffness ratios with fits of Eq. (a), and their exponents q.

    Tables ``growth`` (with the fitted law at the same times) and ``fits``, of the study ``aging``.
    """
    sites = evidence.sites("aging")
    growth = curves.over_seeds(
        evidence, "aging", "area", called="area_ratio", statistic=curves.growth
    ).assign(fitted=np.nan)
    growth.insert(2, "load_per_site", growth["load"] / sites)
    rows = []
    for k1, load in growth[["k1", "load"]].drop_duplicates().itertuples(index=False):
        fit = _fit(evidence, k1, load)
        if fit is not None:
            here = (growth["k1"] == k1) & (growth["load"] == load)
            growth.loc[here, "fitted"] = fit.mean.area_ratio(growth.loc[here, "time"])
            rows.append({"k1": k1, "load": load, "load_per_site": load / sites, **_numbers(fit)})
    tables = {"growth": growth, "fits": pd.DataFrame(rows, columns=_FITTED)}
    return captioned(3, _draw(tables), tables, {"sites": sites, "slope": _SLOPE})


_PARAMETERS = ("a", "q", "t0", "C")
_FITTED = [
    *("k1", "load", "load_per_site"),
    *(f"{name}{end}" for name in _PARAMETERS for end in ("", "_low", "_high")),
    *("rms_misfit", "seeds"),
]


def _fit(evidence: Evidence, k1: float, load: float) -> EnsembleFit[SaturationFit] | None:
    """Fit the mean of the surfaces; None where there is nothing to fit, as for an area that does not grow."""
    areas = curves.finished(evidence.samples("aging", "area", k1=k1, load=load))
    try:
        return ensemble(saturation, evidence["aging"]["time"].to_numpy(), areas)
    except (InputError, ConvergenceError):
        return None


def _numbers(fit: EnsembleFit[SaturationFit]) -> dict[str, float]:
    parameters = all_columns(**{name: fit.parameters[name] for name in _PARAMETERS})
    return {"rms_misfit": fit.mean.rms_residual, "seeds": float(fit.runs), **parameters}


def _draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    growth, fits = tables["growth"], tables["fits"]
    ratios, loads = growth["k1"].unique(), growth["load_per_site"].unique()
    looks = dict(zip(loads, curves.looks(len(loads)), strict=True))
    figure = Figure(figsize=(PAGE, 2.7), layout="constrained")
    panels = figure.subplots(1, len(ratios) + 1)
    for at, (axes, k1) in enumerate(zip(panels, ratios, strict=False)):
        _growth(axes, growth.query("k1 == @k1 and time > 0"), looks)
        curves.dress(axes, r"hold time  $t\,k_0 R$", r"$A(t)\,/\,A(0)$", panel=f"({'abcdefgh'[at]})")
        axes.set_title(rf"$k_1/k_0 = {k1:g}$", fontsize=curves.LABEL, pad=3)
    curves.legend(panels[0], "upper left", r"$F_N/(N_0 k_0\sigma)$")
    _exponents(panels[-1], fits, ratios)
    last = f"({'abcdefgh'[len(ratios)]})"
    curves.dress(panels[-1], r"$F_N\,/\,(N_0 k_0\sigma)$", r"exponent  $q$", panel=last)
    return figure


def _growth(axes: Axes, growth: pd.DataFrame, looks: Mapping[float, curves.Look]) -> None:
    axes.set_xscale("log")
    for load, look in looks.items():
        part = growth.query("load_per_site == @load")
        curves.band(axes, part, "time", "area_ratio", look, label=f"{load:g}")
        axes.plot(part["time"], part["fitted"], "-", color=style.INK, linewidth=0.6)


def _exponents(axes: Axes, fits: pd.DataFrame, ratios: np.ndarray) -> None:
    axes.set(xscale="log", yscale="log")
    for at, k1 in enumerate(ratios):
        part, look = fits.query("k1 == @k1"), curves.Look(style.INK, "os"[at % 2])
        label = rf"$k_1/k_0 = {k1:g}$"
        curves.points(axes, part, "load_per_site", "q", look, filled=at % 2 == 0, label=label)
    if len(fits):
        ends = np.array([fits["load_per_site"].min(), fits["load_per_site"].max()])
        middle = float(np.exp(np.log(fits["q"]).mean())), float(np.exp(np.log(fits["load_per_site"]).mean()))
        axes.plot(
            ends, middle[0] * (ends / middle[1]) ** _SLOPE, ":", color=style.INK, label=f"slope {_SLOPE:g}"
        )
        curves.legend(axes, "lower right")
