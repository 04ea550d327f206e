"""Figure 8: the compliance G of one site, closed form and simulation."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.theory import compliance, compliance_asymptote, compliance_asymptote_paper, torus_compliance
from asperity_research import style
from asperity_research.paper.figures import curves
from asperity_research.paper.figures.paper_figure import COLUMN, PaperFigure, captioned
from asperity_research.paper.studies import PEAK
from asperity_research.studies.evidence import Evidence

_STIFFNESS_RATIOS = (0.1, 1.0, 3.0, 10.0, 100.0)

_TIMES = np.geomspace(1e-3, 1e8, 177)

LARGE_LATTICE = 0.01
"""Relative difference of the closed forms up to which a finite lattice stands for an endless one."""

_LATE = 1e-2
"""From where on the late form is drawn."""


def figure_8(evidence: Evidence) -> PaperFigure:
    """Draw G(x1, x2), its late form, and a simulated indentation; below, how far these are apart.

    Tables ``theory``, ``asymptotes`` and ``simulated``, of the study ``point``.
    """
    simulated = indentation(evidence).query("R_viscous == 0")
    theory = pd.concat(
        [
            pd.DataFrame({"x1": x1, "x2": _TIMES, "G": compliance(x1, _TIMES)})
            for x1 in sorted({*_STIFFNESS_RATIOS, *simulated["k1"]})
        ],
        ignore_index=True,
    )
    late = _TIMES[_TIMES >= _LATE]
    tables = {
        "theory": theory,
        "asymptotes": pd.DataFrame(
            {"x2": late, "G": compliance_asymptote(late), "paper": compliance_asymptote_paper(late)}
        ),
        "simulated": simulated.reset_index(drop=True),
    }
    rounding = (tables["asymptotes"]["paper"] - tables["asymptotes"]["G"]).abs().max()
    return captioned(8, _draw(tables), tables, {"rounding": rounding, "large": LARGE_LATTICE})


def indentation(evidence: Evidence) -> pd.DataFrame:
    """Depth to which the lone asperity of the study ``point`` has sunk in, beside what theory says.

    The body comes down by the depth at time 0 and by its rigid approach since; with viscous creep the mean
    of u0, which flows through the body, does not tell how far.

    Returns
    -------
    DataFrame
        For each ``k1``, ``R_viscous`` and ``time`` (k0 = R = 1): ``depth``, k0 u(0, t)/f0 as simulated;
        ``lattice``, the closed form for the same periodic lattice, `asperity.theory.torus_compliance` with
        what the mode q = 0 adds with viscous creep, R_viscous t / N0; ``deviation``, of ``depth`` from
        ``lattice``, relative; ``plane``, the paper's G, for an endless lattice; ``sites``, N0; and whether
        the point is to be ``drawn`` beside ``plane``: not at time 0, nor once the two closed forms have
        differed by more than 1 %.
    """
    dataset = evidence["point"]
    time = dataset["time"].to_numpy()
    frames = []
    for k1, viscous in product(dataset["k1"].to_numpy(), dataset["R_viscous"].to_numpy()):
        run = dataset.sel(k1=k1, R_viscous=viscous)
        if not np.isfinite(run["sites"]):
            continue  # not finished
        sites = int(run["sites"])
        side = math.isqrt(sites)
        fallen = PEAK - run["separation"].to_numpy()[0] + run["approach"].to_numpy()
        depth = fallen / float(run["held"])
        lattice = torus_compliance(k1, time, (side, side), viscous) + viscous * time / sites
        columns = {"k1": k1, "R_viscous": viscous, "sites": sites, "time": time}
        columns |= {"depth": depth, "lattice": lattice, "deviation": depth / lattice - 1}
        plane = compliance(k1, time, viscous)
        # Once the dip has come round the lattice, chance crossings of the closed forms mean nothing.
        far = np.logical_or.accumulate(np.abs(lattice / plane - 1) > LARGE_LATTICE)
        frames.append(pd.DataFrame(columns | {"plane": plane, "drawn": ~far & (time > 0)}))
    return pd.concat(frames, ignore_index=True)


def _draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    figure = Figure(figsize=(COLUMN, 4.2), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    above.set_xscale("log")
    below.set_yscale("log")
    theory, simulated, late = tables["theory"], tables["simulated"].query("time > 0"), tables["asymptotes"]
    ratios = theory["x1"].unique()
    marks = []
    for at, (x1, look) in enumerate(zip(ratios, curves.looks(len(ratios)), strict=True)):
        part, run = theory.query("x1 == @x1"), simulated.query("k1 == @x1")
        curves.line(above, part["x2"], part["G"], look, at, label=f"{x1:g}")
        shown = run.query("drawn")
        if len(shown):
            marks.append(curves.symbols(above, shown["time"], shown["depth"], look))
        curves.symbols(below, run["time"], run["deviation"].abs(), look)
    above.plot(late["x2"], late["G"], ":", color=style.INK, linewidth=1.2, label="late form")
    above.set_ylim(bottom=0)
    curves.dress(above, "", r"$G(x_1, x_2)$")
    curves.dress(below, r"reduced time  $x_2 = k_0 R\,t$", "deviation")
    curves.legend(above, "upper left", "$x_1 = k_1/k_0$", together={"simulated": marks})
    return figure
