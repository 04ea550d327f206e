"""Figures 8 and 9: the compliance G of one site, also with viscous creep, closed form and simulation."""

import math
from collections.abc import Callable, Iterable
from itertools import product

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from asperity.theory import (
    LATE_SLOPE,
    compliance,
    compliance_asymptote,
    compliance_asymptote_paper,
    torus_compliance,
)
from asperity_research.arrays import Field
from asperity_research.paper.figures import curves
from asperity_research.paper.figures.paper_figure import COLUMN, PaperFigure, captioned
from asperity_research.paper.studies import PEAK
from asperity_research.studies.evidence import Evidence

_STIFFNESS_RATIOS = (0.1, 1.0, 3.0, 10.0, 100.0)
_STIFFNESS_RATIO, _MOBILITY_RATIOS = 3.0, (0.0, 0.01, 0.1, 1.0, 10.0)  # Of Figure 9
_TIMES = np.geomspace(1e-3, 1e8, 177)

LARGE_LATTICE = 0.01
"""Relative difference of the closed forms up to which a finite lattice stands for an endless one."""

_LATE = 1e-2  # From where on the late form is drawn


def indentation(evidence: Evidence) -> pd.DataFrame:
    """Depth to which the lone asperity of the study ``point`` has sunk in, beside what theory says.

    The body comes down by the depth at time 0 and by its rigid approach since; with viscous creep the mean
    of u0, which flows through the body, does not tell how far. ``depth`` is k0 u(0, t)/f0 as simulated;
    ``lattice`` the closed form for the same periodic lattice, with what the mode q = 0 adds with viscous
    creep, R_viscous t / N0; ``plane`` the paper's G, for an endless lattice. A point is ``drawn`` beside it
    but at time 0, and once the two closed forms have differed by more than 1 %.
    """
    dataset, sites = evidence["point"], int(evidence.sites("point"))
    time, side = dataset["time"].to_numpy(), math.isqrt(sites)
    frames = []
    for k1, viscous in product(dataset["k1"].to_numpy(), dataset["R_viscous"].to_numpy()):
        run = dataset.sel(k1=k1, R_viscous=viscous)
        fallen = PEAK - run["separation"].to_numpy()[0] + run["approach"].to_numpy()
        depth = fallen / float(run["held"])
        lattice = torus_compliance(k1, time, (side, side), viscous) + viscous * time / sites
        plane = compliance(k1, time, viscous)
        # Once the dip has come round the lattice, chance crossings of the closed forms mean nothing.
        far = np.logical_or.accumulate(np.abs(lattice / plane - 1) > LARGE_LATTICE)
        columns = {"k1": k1, "R_viscous": viscous, "sites": sites, "time": time}
        columns |= {"depth": depth, "lattice": lattice, "deviation": depth / lattice - 1}
        frames.append(pd.DataFrame(columns | {"plane": plane, "drawn": ~far & (time > 0)}))
    return pd.concat(frames, ignore_index=True)


def _closed(name: str, values: Iterable[float], depth: Callable[[float], Field], of: str) -> pd.DataFrame:
    """Curves of the closed form at `_TIMES`, one for each value of what is named."""
    every = [pd.DataFrame({name: value, "x2": _TIMES, of: depth(value)}) for value in sorted({*values})]
    return pd.concat(every, ignore_index=True)


def _family(
    axes: Axes, theory: pd.DataFrame, simulated: pd.DataFrame, names: tuple[str, str], of: str
) -> list[Line2D]:
    """Draw the closed form and, beside it, what was simulated; what varies has a name in either table."""
    marks = []
    for at, (value, look) in enumerate(curves.looks(theory[names[0]].unique()).items()):
        part, run = theory[theory[names[0]] == value], simulated[simulated[names[1]] == value]
        curves.line(axes, part["x2"], part[of], look, at, label=f"{value:g}")
        if len(run):
            marks.append(curves.symbols(axes, run["time"], run["depth"], look))
    return marks


def figure_8(evidence: Evidence) -> PaperFigure:
    """Draw G(x1, x2), its late form, and a simulated indentation; below, how far these are apart.

    Tables ``theory``, ``asymptotes`` and ``simulated``, of the study ``point``.
    """
    simulated = indentation(evidence).query("R_viscous == 0").reset_index(drop=True)
    ratios = (*_STIFFNESS_RATIOS, *simulated["k1"])
    theory = _closed("x1", ratios, lambda x1: compliance(x1, _TIMES), "G")
    times = _TIMES[_TIMES >= _LATE]
    forms = {"x2": times, "G": compliance_asymptote(times), "paper": compliance_asymptote_paper(times)}
    tables = {"theory": theory, "asymptotes": pd.DataFrame(forms), "simulated": simulated}
    rounding = float(np.abs(forms["paper"] - forms["G"]).max())
    figure = Figure(figsize=(COLUMN, 4.2), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    above.set_xscale("log")
    below.set_yscale("log")
    simulated, late = simulated.query("time > 0"), tables["asymptotes"]
    marks = _family(above, theory, simulated.query("drawn"), ("x1", "k1"), "G")
    for x1, look in curves.looks(theory["x1"].unique()).items():
        run = simulated[simulated["k1"] == x1]
        curves.symbols(below, run["time"], run["deviation"].abs(), look)
    curves.dotted(above, late["x2"], late["G"], "late form")
    above.set_ylim(bottom=0)
    curves.dress(above, "", r"$G(x_1, x_2)$")
    curves.dress(below, r"reduced time  $x_2 = k_0 R\,t$", "deviation")
    curves.legend(above, "upper left", "$x_1 = k_1/k_0$", together={"simulated": marks})
    return captioned(8, figure, tables, {"rounding": rounding, "large": LARGE_LATTICE})


def figure_9(evidence: Evidence) -> PaperFigure:
    """Draw the depth under a constant force for several ratios of the mobilities.

    Tables ``theory`` and ``simulated``, of the study ``point``; the latter has all times, also those at
    which the lattice is too small to be ``drawn``.
    """
    simulated = indentation(evidence).query("k1 == @_STIFFNESS_RATIO").reset_index(drop=True)
    ratios = (*_MOBILITY_RATIOS, *simulated["R_viscous"])
    theory = _closed("R_viscous", ratios, lambda r: compliance(_STIFFNESS_RATIO, _TIMES, r), "depth")
    tables = {"theory": theory, "simulated": simulated}
    figure = Figure(figsize=(COLUMN, 3.2), layout="constrained")
    axes = figure.add_subplot(xscale="log")
    marks = _family(axes, theory, simulated.query("drawn"), ("R_viscous", "R_viscous"), "depth")
    for mobility, shift, slope, text, factor, lift in (
        (theory["R_viscous"].max(), 0.12, 2 * LATE_SLOPE, r"slope $1/(4\pi)$", 1 / 2, 0.03),
        (theory["R_viscous"].min(), -0.12, LATE_SLOPE, r"slope $1/(8\pi)$", 3, -0.05),
    ):
        family, ends = theory[theory["R_viscous"] == mobility], np.array([1e4, 1e7])
        level = float(np.interp(math.log(ends[0]), np.log(family["x2"]), family["depth"])) + shift
        curves.dotted(axes, ends, level + slope * np.log(ends / ends[0]))
        at = (ends[0] * factor, level + lift)
        curves.note(axes, text, at, where="right" if shift > 0 else "left")
    axes.set_ylim(bottom=0)
    curves.dress(axes, r"reduced time  $k_0 R\,t$", r"indentation  $k_0\,u(0,t)\,/\,f_0$")
    curves.legend(axes, "upper left", r"$\tilde{R}/R$", together={"simulated": marks})
    return captioned(9, figure, tables, {"k1": _STIFFNESS_RATIO, "large": LARGE_LATTICE})
