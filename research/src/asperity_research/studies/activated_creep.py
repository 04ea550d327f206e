r"""Study: two-step loads, and slide-hold-slide, with creep that stress and heat activate."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure

import asperity_research.studies.activated_steps as stepping
from asperity.base.words import power
from asperity.fits import Estimate
from asperity_research import style
from asperity_research.studies.activated_rests import TEMPERATURES, Rests, sliding
from asperity_research.studies.activated_steps import (
    IN_SERIES,
    SOLIDS,
    Steps,
    time_of_growth,
    time_of_minimum,
)
from asperity_research.studies.campaigns import Campaign
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)


def _campaigns(surfaces: int, every: int) -> tuple[Campaign, ...]:
    """Return the campaigns, with so many surfaces each and every so many waiting times."""
    return (*stepping.campaigns(surfaces, every), sliding(min(surfaces, 4), TEMPERATURES[::every]))


def analyse(evidence: Evidence) -> Outcome:
    """Judge what becomes of the area after a fall of the load, and of friction at rest."""
    every = [Steps.of(evidence, name, ratio) for name, solid in SOLIDS.items() for ratio in solid.steps]
    rests = Rests.of(evidence)
    numbers = {**_after_steps(every), **rests.numbers()}
    return Outcome(
        tuple(WORDS.judge(claim, some) for claim, some in numbers.items() if some),  # few waits: no power
        {
            "steps": pd.concat([one.rows() for one in every], ignore_index=True),
            "powers": pd.DataFrame([one.powers() for one in every]),
            "curves": pd.concat([one.curves() for one in every if one.ratio == every[0].ratio]),
            "rests": rests.table(),
        },
    )


def _after_steps(every: list[Steps]) -> dict[str, dict[str, Estimate]]:
    """Return what decides the claims on the area after a fall of the load, by claim."""

    def known(what: str, number: Callable[[Steps], Estimate | None]) -> dict[str, Estimate]:
        return {f"{what}: {one.words}": found for one in every if (found := number(one)) is not None}

    def deepest(*, in_series: bool) -> dict[str, Estimate]:
        return known(
            "largest mean of lost area over that after the step",
            lambda one: one.deepest() if one.creep_stress and (one.name in IN_SERIES) is in_series else None,
        )

    time = "power of the waiting time in the time of"
    return {
        "series": deepest(in_series=True),
        "falls": deepest(in_series=False),
        "minimum": known(f"{time} the minimum", lambda one: one.power(time_of_minimum)),
        "growth": known(f"{time} growth", lambda one: one.power(time_of_growth)),
        "estimate": known("power less d s_2/d s_1", Steps.excess),
    }


_BROAD = 1e3  # Upper over lower end of an interval from which on a time is not drawn

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
    figure, (curve, minimum, growth, rest) = style.panels(9.6, 6.0, 2, 2)
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
    **WORDS.study, quick=_campaigns(3, every=2), full=_campaigns(8, every=1), analyse=analyse, draw=draw
)
