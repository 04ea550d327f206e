r"""Study: two-step loads, and slide-hold-slide, with creep that stress and heat activate."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure

import asperity_research.studies.activated_steps as stepping
from asperity.base.words import power as power_of_ten
from asperity.fits import Estimate, jackknife
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.activated_steps import Steps, time_of_growth, time_of_minimum
from asperity_research.studies.campaigns import Campaign, hold, slide, zipped
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import all_columns, power
from asperity_research.studies.sliding import before_shifts, steady_area
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)

_TEMPERATURES = (0.015, 0.03, 0.06)  # kT over the activation volume, which is s0 too
_BARRIER, _PREFACTOR, _HOLD = 1.0, 1e3, 1e5
_SLIDES, _VELOCITIES = (16, 8, 12, 12), (1.0, 1.0, 100.0, 0.01)


def _campaigns(surfaces: int, every: int) -> tuple[Campaign, ...]:
    """Return the campaigns, with so many surfaces each and every so many waiting times and temperatures."""
    temperatures = _TEMPERATURES[::every]
    slides = [slide(*one) for one in zip(_SLIDES, _VELOCITIES, strict=True)]
    solid = replace(stepping.eyring_lattice(temperatures[0]), what="lattice of springs")
    rates = [_PREFACTOR * math.exp(-_BARRIER / kT) for kT in temperatures]
    sliding = solid.campaign(
        "sliding",
        "Slide, hold, slide, and two steps of the velocity, at several temperatures",
        stepping.ROUGH | solid.rough,
        friction={"shear_strength": 1.0},
        aging={"first": 1.0, "per_decade": 1, "rtol": 0.02},
        protocol=[slides[0], hold(_HOLD), *slides[1:]],
        sweep=zipped(min(surfaces, 4), creep_stress=temperatures, creep_rate=rates),
    )
    return (*stepping.campaigns(surfaces, every), sliding)


def analyse(evidence: Evidence) -> Outcome:
    """Judge what becomes of the area after a fall of the load, and of friction at rest."""
    solids = stepping.SOLIDS.items()
    every = [Steps.of(evidence, name, ratio) for name, solid in solids for ratio in solid.steps]
    rests, at_rest = _rests(evidence)
    numbers = {**_after_steps(every), **at_rest}
    tables = {
        "steps": pd.concat([one.rows() for one in every], ignore_index=True),
        "powers": pd.DataFrame([one.powers() for one in every]),
        "curves": pd.concat([one.curves() for one in every if one.ratio == every[0].ratio]),
        "rests": rests,
    }
    findings = (WORDS.judge(claim, some) for claim, some in numbers.items() if some)  # few waits: no power
    return Outcome(tuple(findings), tables)


def _after_steps(every: list[Steps]) -> dict[str, dict[str, Estimate]]:
    """Return what decides the claims on the area after a fall of the load, by claim."""

    def known(what: str, number: Callable[[Steps], Estimate | None]) -> dict[str, Estimate]:
        return {f"{what}: {one.words}": found for one in every if (found := number(one)) is not None}

    def deepest(one: Steps, *, in_series: bool) -> Estimate | None:
        return one.deepest() if one.creep_stress and (one.name in stepping.IN_SERIES) is in_series else None

    lost = "largest mean of lost area over that after the step"
    time = "power of the waiting time in the time of"
    return {
        "series": known(lost, partial(deepest, in_series=True)),
        "falls": known(lost, partial(deepest, in_series=False)),
        "minimum": known(f"{time} the minimum", lambda one: one.power(time_of_minimum)),
        "growth": known(f"{time} growth", lambda one: one.power(time_of_growth)),
        "estimate": known("power less d s_2/d s_1", Steps.excess),
    }


def growth_at_rest(time: Field, rest: Field) -> Field:
    """B, the growth at rest for every e-fold of time over the area before, at each temperature.

    Times at rest, shape (times,), and area then over that before, shape (surfaces, temperatures, times).
    """
    return np.asarray(np.polyfit(np.log(time), rest.mean(axis=0).T, 1)[0])


def fall_with_velocity(steady: Field) -> Field:
    """Fall of the area in steady sliding for every e-fold of the velocity, over that at 1.

    Areas at each of `_VELOCITIES` but the first, shape (surfaces, temperatures, 3).
    """
    mean = steady.mean(axis=0)
    return np.asarray(-np.polyfit(np.log(_VELOCITIES[1:]), (mean / mean[:, :1]).T, 1)[0])


def _rests(evidence: Evidence) -> tuple[pd.DataFrame, dict[str, dict[str, Estimate]]]:
    """Return B at rest and in steady sliding at each temperature; and what decides the claims, by claim."""
    data = evidence["sliding"]
    at = data["creep_stress"].values.astype(np.float64)
    one = data.isel(seed=0, point=0)
    held = one["leg"].values == 1
    time = one["time"].values[held] - _SLIDES[0] / _VELOCITIES[0]
    late = time >= 10  # times in which a slide would have passed several contacts
    rests, slides = [], []
    for seed in data["seed"].values:
        runs = [data.sel(seed=seed).isel(point=point) for point in range(len(at))]
        rests.append([run["area"].values[held][late] / before_shifts(run, 0)[-1] for run in runs])
        slides.append([[steady_area(run, leg) for leg in (2, 3, 4)] for run in runs])
    growth, both = partial(growth_at_rest, time[late]), (np.array(rests), np.array(slides))

    def stress(rest: Field, steady: Field) -> Field:
        """s0/s, by the mean force of a contact at rest, in the middle of the times that count."""
        area = (steady[:, :, :1] * rest).mean(axis=0)
        return np.asarray(at / (stepping.LOAD * stepping.SIDE**2 / np.exp(np.log(area).mean(axis=1))))

    temperature = jackknife(lambda rest: power(at, growth(rest)), both[0])
    slope = jackknife(lambda rest, steady: (growth(rest) / stress(rest, steady)).mean(), both)
    fall = jackknife(lambda rest, steady: (fall_with_velocity(steady) / growth(rest)).mean(), both)
    head = {"kT": at, "s0_over_s": stress(*both), "surfaces": len(rests)}
    found = {"rest": jackknife(growth, both[0]), "steady": jackknife(fall_with_velocity, both[1])}
    return pd.DataFrame(head | all_columns(**found)), {
        "temperature": {"power of <i>T</i> in B": temperature},
        "slope": {"B s/s0, mean over temperatures": slope},
        "steady": {"b of steady sliding over B, mean over temperatures": fall},
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
        curve.plot(
            part["time"], part["area"], color=shade, label=f"${power_of_ten(float(str(wait)))}$", linewidth=1
        )
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
