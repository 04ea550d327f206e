r"""Study: two-step loads, and slide-hold-slide, with creep that stress and heat activate."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure

from asperity.base.words import power
from asperity.figures import Drawing
from asperity_research import style
from asperity_research.studies.activated_creep import steps as stepping
from asperity_research.studies.activated_creep.rests import TEMPERATURES, Rests, sliding
from asperity_research.studies.activated_creep.steps import (
    RISE,
    SOLIDS,
    Steps,
    time_of_growth,
    time_of_minimum,
)
from asperity_research.studies.campaigns import Campaign
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.study import Outcome, Study

__all__ = ["ACTIVATED_CREEP", "RISE", "Rests", "Steps", "time_of_growth", "time_of_minimum"]


def campaigns(surfaces: int, *, quick: bool) -> tuple[Campaign, ...]:
    """Return the campaigns, with so many surfaces each; the quick ones have every other waiting time."""
    every = 2 if quick else 1
    return (*stepping.campaigns(surfaces, every), sliding(min(surfaces, 4), TEMPERATURES[::every]))


def analyse(evidence: Evidence) -> Outcome:
    """Judge what becomes of the area after a fall of the load, and of friction at rest."""
    every = [Steps.of(evidence, name, ratio) for name, solid in SOLIDS.items() for ratio in solid.steps]
    rests = Rests.of(evidence)
    findings = (*stepping.findings(every), *rests.findings())
    return Outcome(
        tuple(finding for finding in findings if finding.measured),  # few waits give no power
        {
            "steps": pd.concat([one.rows() for one in every], ignore_index=True),
            "powers": pd.DataFrame([one.powers() for one in every]),
            "curves": pd.concat([one.curves() for one in every if one.ratio == every[0].ratio]),
            "rests": rests.table(),
        },
    )


_BROAD = 1e3
"""Upper over lower end of an interval from which on a time is not drawn."""

_LOOKS = {
    "lattice": ("o", style.INK),
    "lighter": ("d", style.INK),
    "cold": ("v", style.SKY),
    "warm": ("^", style.VERMILION),
    "bed": ("s", style.BLUE),
    "half_space": ("D", style.BLUE),
    "viscous": ("x", "0.5"),
    "conserved": ("+", "0.5"),
    "logarithm": ("*", "0.5"),
}
_LINES = {"0.2": ("-", True), "0.5": ("--", False), "0.8": (":", False)}
"""Line of each ratio of the loads, and whether its marks are filled."""


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw the area after the step, the times of minimum and growth, and the growth at rest."""
    figure = Drawing(figsize=(9.6, 6.0), layout="constrained")
    (curve, minimum), (growth, rest) = figure.subplots(2, 2)
    curves, steps, rests = tables["curves"], tables["steps"], tables["rests"]
    shown = curves[(curves["solid"] == "lattice") & (curves["time"] > 0)].groupby("waiting_time")
    shades = colormaps["viridis"](np.linspace(0.9, 0, len(shown)))
    for shade, (wait, part) in zip(shades, shown, strict=True):
        curve.plot(part["time"], part["area"], color=shade, label=f"${power(float(str(wait)))}$", linewidth=1)
    curve.set(xscale="log", xlabel=r"time since the step over $t_\mathrm{w}$")
    curve.set_ylabel("area over that after the step")
    low, high = curve.get_ylim()
    curve.set_ylim(low - 0.35 * (high - low), high)
    curve.legend(title=r"$t_\mathrm{w}$", fontsize=6, title_fontsize=7, ncols=4, loc="lower left")
    for axis, name, words in ((minimum, "minimum", "the minimum"), (growth, "growth", "growth")):
        sharp = steps[steps[f"{name}_high"] < _BROAD * steps[f"{name}_low"]]
        for (solid, ratio), part in sharp.groupby(["solid", "load_ratio"], sort=False):
            mark, color = _LOOKS[str(solid)]
            line, filled = _LINES[str(ratio)]
            look = {"label": f"{str(solid).replace('_', '-')}, × {ratio}"}
            look["markerfacecolor"] = color if filled or mark in "x+*" else "white"
            style.points(axis, part, "waiting_time", name, mark + line, color, **look)
        axis.set(xscale="log", yscale="log", xlabel=r"waiting time $t_\mathrm{w}$")
        axis.set_ylabel(rf"time of {words} over $t_\mathrm{{w}}$")
        axis.set_ylim(top=axis.get_ylim()[1] * (1e3 if name == "growth" else 1))
        axis.legend(fontsize=6, ncols=2, loc="upper right")
    shared = {"linewidth": None}
    style.points(rest, rests, "kT", "rest", "o", style.INK, label="at rest, B", **shared)
    style.points(rest, rests, "kT", "steady", "s", style.BLUE, label="in steady sliding, b", **shared)
    rest.plot(rests["kT"], rests["s0_over_s"], "--", color="0.5", label="$s_0/s$")
    rest.set(xlabel="$kT$ over the activation volume", ylabel="friction per e-fold")
    rest.set(xlim=(0, None), ylim=(0, None))
    rest.legend(fontsize=7)
    return figure


ACTIVATED_CREEP = Study(
    name="activated-creep",
    question="What does a contact whose creep is thermally activated remember of a load, and of a rest?",
    quick=campaigns(3, quick=True),
    full=campaigns(8, quick=False),
    analyse=analyse,
    draw=draw,
    caption="Top left: mean area after the load has fallen to a fifth, on the lattice of springs with "
    "Eyring's law; one line a waiting time. Top right: time of the minimum, bottom left: time at which the "
    "area has grown by 3 % over its smallest, both over the waiting time; filled for the load × 0.2, grey "
    "for linear solids. Bottom right: growth of friction at rest, and its fall in steady sliding. Bars: 95 % "
    "intervals.",
    page="docs/studies/activated_creep.md",
)
