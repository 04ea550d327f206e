"""Figures 2 and 5: the area against the load, before creep and relaxed, on white and self-affine surfaces."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.theory import GaussianHeights, compliance, dilute_area
from asperity_research import style
from asperity_research.paper.figures import curves
from asperity_research.paper.figures.paper_figure import COLUMN, PaperFigure, captioned
from asperity_research.studies.evidence import Evidence

_FAR_APART = 3.0
"""Spacing of contacts, in widths of the dips around them, from which on they are drawn as independent."""

_DILUTE = 0.1  # Largest contact fraction at which the dilute theory is drawn
_EXPONENT = 0.8  # The paper's, of the area against the load on self-affine surfaces
_PARTIAL = 0.1  # Contact fraction up to which a contact counts as far from full


def figure_2(evidence: Evidence) -> PaperFigure:
    """Draw A(F_N) for several stiffness ratios, and of the relaxed state.

    Tables ``instantaneous``, ``relaxed`` (for every k1, though all are the same) and ``dilute``, of the
    study ``load``.
    """
    sites, tables = evidence.sites("load"), _areas(evidence, "load")
    for table in tables.values():
        for end in ("", "_low", "_high"):
            table[f"contact_fraction{end}"] = table[f"area{end}"] / sites
        table.insert(2, "load_per_site", table["load"] / sites)
    tables["dilute"] = _dilute(tables["instantaneous"])
    spread = float(tables["relaxed"].groupby("load")["area"].agg(np.ptp).max())
    facts = {"sites": sites, "spread": spread, "far_apart": _FAR_APART, "dilute_fraction": _DILUTE}
    figure, axes = _panel()
    areas, relaxed = tables["instantaneous"], tables["relaxed"]
    columns = ("load_per_site", "contact_fraction")
    for k1, look in curves.looks(areas["k1"].unique()).items():
        theory = tables["dilute"].query("k1 == @k1")
        axes.plot(*(theory[name] for name in columns), color=look.color, linewidth=0.8)
        curves.points(axes, areas.query("k1 == @k1"), *columns, look, f"{k1:g}")
    curve = relaxed[relaxed["k1"] == relaxed["k1"].iloc[0]]
    curves.points(axes, curve, *columns, curves.Look(style.INK, filled=False), "relaxed", size=5)
    start, level = curve["load_per_site"].iloc[0], 3 * curve["contact_fraction"].iloc[0]
    span = np.array([1.0, max(1.0, 0.6 / level)])
    curves.dotted(axes, start * span, level * span)
    curves.note(axes, "slope 1", (start * 8, level * 15), where="right")
    axes.set_ylim(areas["contact_fraction"].min() / 3, 2)
    curves.dress(axes, r"normal load  $F_N\,/\,(N_0 k_0 \sigma)$", r"contact area  $A\,/\,N_0$")
    curves.legend(axes, "lower right", r"$k_1/k_0$")
    return captioned(2, figure, tables, facts)


def _areas(evidence: Evidence, study: str) -> dict[str, pd.DataFrame]:
    """Areas of both states."""
    states = {"instantaneous": "initial_area", "relaxed": "relaxed_area"}
    return {state: curves.over_seeds(evidence, study, area, "area") for state, area in states.items()}


def _dilute(areas: pd.DataFrame) -> pd.DataFrame:
    """Independent asperities, each with the compliance of the lattice; where they are far apart."""
    loads = np.geomspace(areas["load_per_site"].min(), areas["load_per_site"].max(), 241)
    frames = []
    for k1 in areas["k1"].unique():
        fraction = dilute_area(loads, compliance(k1, 0.0), GaussianHeights(rms=1.0))
        apart = (fraction <= _DILUTE) & (_FAR_APART * np.sqrt(1 / k1) < fraction**-0.5)
        columns = {"load_per_site": loads[apart], "contact_fraction": fraction[apart]}
        frames.append(pd.DataFrame({"k1": k1, **columns}))
    return pd.concat(frames, ignore_index=True)


def _panel() -> tuple[Figure, Axes]:
    figure = Figure(figsize=(COLUMN, 3.2), layout="constrained")
    return figure, figure.add_subplot(xscale="log", yscale="log")


def figure_5(evidence: Evidence) -> PaperFigure:
    """Draw A(F_N) of self-affine surfaces, in sites.

    Tables ``instantaneous`` and ``relaxed``, of the study ``self_affine_load``.
    """
    tables = _areas(evidence, "self_affine_load")
    figure, axes = _panel()
    areas, relaxed = tables["instantaneous"], tables["relaxed"]
    sizes = areas["size"].unique()
    shrinking = np.linspace(5, 3, len(sizes))  # what lies on each other shows as rings
    for (size, look), points in zip(curves.looks(sizes).items(), shrinking, strict=True):
        full, open_ = (state[state["size"] == size] for state in (areas, relaxed))
        curves.points(axes, full, "load", "area", look, f"${size:g}^2$ sites", float(points))
        curves.points(axes, open_, "load", "area", look.open(), size=float(points))
        axes.axhline(size**2, color=look.color, linewidth=0.6, linestyle=(0, (6, 3)), zorder=0)
    axes.plot([], [], "o", color=style.INK, markerfacecolor="none", markersize=4.5, label="open: relaxed")
    curves.note(axes, "full contact", (float(areas["load"].min()), 1.5 * float(sizes.max()) ** 2))
    _power_law(axes, areas[areas["area"] < _PARTIAL * areas["size"] ** 2])
    axes.set_ylim(areas["area"].min() / 3, 3 * sizes.max() ** 2)
    curves.dress(axes, r"normal load  $F_N\,/\,k_0$", r"contact area  $A$  (sites)")
    curves.legend(axes, "lower right")
    return captioned(5, figure, tables, {"exponent": _EXPONENT})


def _power_law(axes: Axes, areas: pd.DataFrame) -> None:
    """Draw the reference below the points of light loads, for comparison by eye."""
    loads, level = areas["load"].to_numpy(np.float64), areas["area"].to_numpy(np.float64)
    prefactor = 0.35 * float(np.exp(np.mean(np.log(level / loads**_EXPONENT))))
    ends = np.array([loads.min(), loads.max()])
    curves.dotted(axes, ends, prefactor * ends**_EXPONENT)
    middle = float(np.sqrt(ends.prod()))
    curves.note(axes, f"$F_N^{{{_EXPONENT:g}}}$", (1.5 * middle, 0.7 * prefactor * middle**_EXPONENT))
