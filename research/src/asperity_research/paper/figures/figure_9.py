"""Figure 9: indentation by a constant force with viscous creep, closed form and simulation."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.theory import LATE_SLOPE, compliance
from asperity_research import style
from asperity_research.paper.figures import curves
from asperity_research.paper.figures.figure_8 import LARGE_LATTICE, indentation
from asperity_research.paper.figures.paper_figure import COLUMN, PaperFigure, captioned
from asperity_research.studies.evidence import Evidence

_STIFFNESS_RATIO = 3.0

_MOBILITY_RATIOS = (0.0, 0.01, 0.1, 1.0, 10.0)

_TIMES = np.geomspace(1e-3, 1e8, 177)


def figure_9(evidence: Evidence) -> PaperFigure:
    """Draw the depth under a constant force for several ratios of the mobilities.

    Tables ``theory`` and ``simulated``, of the study ``point``; the latter has all times, also those at
    which the lattice is too small to be ``drawn``.
    """
    simulated = indentation(evidence).query("k1 == @_STIFFNESS_RATIO").reset_index(drop=True)
    theory = pd.concat(
        [
            pd.DataFrame({"R_viscous": r, "x2": _TIMES, "depth": compliance(_STIFFNESS_RATIO, _TIMES, r)})
            for r in sorted({*_MOBILITY_RATIOS, *simulated["R_viscous"]})
        ],
        ignore_index=True,
    )
    tables = {"theory": theory, "simulated": simulated}
    return captioned(9, _draw(tables), tables, {"k1": _STIFFNESS_RATIO, "large": LARGE_LATTICE})


def _draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    figure = Figure(figsize=(COLUMN, 3.2), layout="constrained")
    axes = figure.add_subplot(xscale="log")
    theory, simulated = tables["theory"], tables["simulated"].query("drawn")
    mobilities = theory["R_viscous"].unique()
    marks = []
    for at, (r, look) in enumerate(zip(mobilities, curves.looks(len(mobilities)), strict=True)):
        part, run = theory.query("R_viscous == @r"), simulated.query("R_viscous == @r")
        curves.line(axes, part["x2"], part["depth"], look, at, label=f"{r:g}")
        if len(run):
            marks.append(curves.symbols(axes, run["time"], run["depth"], look))
    highest = theory[theory["R_viscous"] == mobilities.max()]
    lowest = theory[theory["R_viscous"] == mobilities.min()]
    for family, shift, slope, text in (
        (highest, 0.12, 2 * LATE_SLOPE, r"slope $1/(4\pi)$"),
        (lowest, -0.12, LATE_SLOPE, r"slope $1/(8\pi)$"),
    ):
        ends = np.array([1e4, 1e7])
        level = float(np.interp(math.log(ends[0]), np.log(family["x2"]), family["depth"])) + shift
        axes.plot(ends, level + slope * np.log(ends / ends[0]), ":", color=style.INK, linewidth=1.2)
        where = (ends[0] / 2, level + 0.03) if shift > 0 else (ends[0] * 3, level - 0.05)
        curves.note(axes, text, where, where="right" if shift > 0 else "left")
    axes.set_ylim(bottom=0)
    curves.dress(axes, r"reduced time  $k_0 R\,t$", r"indentation  $k_0\,u(0,t)\,/\,f_0$")
    curves.legend(axes, "upper left", r"$\tilde{R}/R$", together={"simulated": marks})
    return figure
