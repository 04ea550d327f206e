r"""Study: two-step loads, and slide-hold-slide, with creep that stress and heat activate.

A contact is held under a load for a waiting time t_w; then the load falls at once to a part of it, and stays.
Creep follows Eyring's law v0 sinh(s/s0), and linear laws on the same surfaces stand beside it. The unit of
time is s0/(k1 v0): the relaxation time of a creeping spring under a small force.

While s >> s0 the force that a contact still bears after a time t is about s0 ln(2/t), whatever it was at
first. A load that falls at t_w leaves contacts with a mean force s_2 below the mean s_1 before. They
flow again once s0 ln(2/t) has come down to s_2, that is, at the time t_r with

    ln(t_r/t_w) = (s_1 - s_2)/s0,       d ln t_r/d ln t_w = d s_2/d s_1 ,

a number below 1 where s_2 is a fixed part of s_1. This is an estimate from mean forces, not a theorem.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Self

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure

from asperity.base.words import power as power_of_ten
from asperity.fits import Estimate, jackknife
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, after_waits, hold, slide, waves, zipped
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import all_columns, columns, crossing, mean, power, slope, vertex
from asperity_research.studies.sliding import before_shifts, steady_area
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)
SIDE = 64  # Sites along a side
ROUGH = waves(SIDE, 16.0)  # The table of the surface, without its height
SOLIDS = WORDS.solids  # By the names of their campaigns
LOAD = SOLIDS["lattice"].load  # Load a site before the step, of all
IN_SERIES = ("bed", "half_space")  # Solids whose whole stiffness creeps


def _two_steps(surfaces: int, every: int) -> Iterator[Campaign]:
    """Give the campaigns, with so many surfaces each and every so many waiting times."""
    for name, solid in SOLIDS.items():
        for ratio in solid.steps:
            yield solid.campaign(
                f"{name}_{ratio:g}",
                f"Area after the load has fallen to {ratio:g} of it, waiting time as a factor on creep",
                ROUGH | solid.rough,
                aging={"first": 1e-2, "per_decade": 4, "rtol": 5e-3},
                **after_waits({"load": ratio * (LOAD * SIDE**2)}, solid.waits[::every], 1e5, surfaces),
            )


FELL = 0.01  # Lost part of the area from which on it counts as a fall
RISE = 1.03  # Area over the smallest one so far at which growth counts as resumed
Reading = Callable[[Field, Field], float]
"""What is read off times since the step, the first 0, and areas, shape (n,)."""


def time_of_minimum(time: Field, area: Field) -> float:
    """Time at which an area is smallest: that of the parabola in ln t through it and its neighbors.

    NaN where the area does not fall by a part `FELL`, or is smallest at the end.
    """
    at = int(np.argmin(area))
    if area[at] > (1 - FELL) * area[0] or at == area.size - 1:
        return math.nan
    return float(time[1]) if at == 1 else vertex(time, area, at)


def time_of_growth(time: Field, area: Field) -> float:
    """Time at which an area first exceeds the smallest one so far by 3 %."""
    over = area / np.minimum.accumulate(area)
    at = int(np.argmax(over > RISE))
    if not over[at] > RISE:
        return math.nan
    return float(time[1]) if at == 1 else crossing(time, over, at, RISE)[0]


@dataclass(frozen=True, eq=False)
class Steps:
    """All histories of a load that falls: one solid, one ratio of the load after the step over that before.

    Waiting times, shape (waits,); the load before the step; times since the step over the waiting time, of
    which the first is 0; areas before it, shape (surfaces, waits), and after it, (surfaces, waits, times).
    """

    name: str
    ratio: float
    wait: Field
    load: float
    time: Field
    before: Field
    area: Field

    @classmethod
    def of(cls, evidence: Evidence, name: str, ratio: float) -> Self:
        """Read them from a campaign."""
        wait, some = zip(*evidence.waits(f"{name}_{ratio:g}"), strict=True)
        before = np.stack([one.before for one in some], axis=1)
        area = np.stack([one.after for one in some], axis=1)
        return cls(name, ratio, np.array(wait), LOAD * SIDE**2, some[0].time, before, area)

    @property
    def words(self) -> str:
        """Which ones, for a reader."""
        return f"{SOLIDS[self.name].what}, load × {self.ratio:g}"

    @property
    def creep_stress(self) -> float:
        """s0; 0 for a linear solid."""
        return float(SOLIDS[self.name].table.get("creep_stress", 0.0))

    @property
    def head(self) -> dict[str, object]:
        """What they are of, as columns."""
        return {"solid": self.name, "load_ratio": self.ratio}

    def times(self, of: Reading, area: Field) -> Field:
        """Return ln(time / waiting time) at each wait, for a sample of areas after the step."""
        return np.log([of(self.time, one) for one in area.mean(axis=0)])

    def estimated(self, before: Field, area: Field) -> Field:
        """Return ln(t_r/t_w) = (s_1 - s_2)/s0 from mean forces before and after the step; NaN without s0."""
        first = self.load / before.mean(axis=0)
        then = self.ratio * self.load / area[:, :, 0].mean(axis=0)
        return np.asarray((first - then) / (self.creep_stress or math.nan))

    def _slope(self, of: Reading, statistic: Callable[[Field, Field], Field]) -> Estimate | None:
        """Slope against ln t_w, where every sample has that time; None for fewer than three waits."""
        shared = np.isfinite(jackknife(partial(self.times, of), self.area).high)
        if shared.sum() < 3 or np.isnan(statistic(self.before, self.area)[shared]).any():
            return None
        samples = (self.before, self.area)
        return jackknife(lambda *some: slope(self.wait[shared], statistic(*some)[shared]), samples)

    def power(self, of: Reading) -> Estimate | None:
        """Power of the waiting time in a time; None where fewer than three waits have one in every sample."""
        return self._slope(of, lambda _, area: np.log(self.wait) + self.times(of, area))

    def estimated_power(self) -> Estimate | None:
        """Power of the waiting time in the estimate, at the waits at which growth resumes."""
        return self._slope(time_of_growth, lambda *some: np.log(self.wait) + self.estimated(*some))

    def excess(self) -> Estimate | None:
        """Power of the waiting time in t_r less that of the estimate, where both are known."""
        of = time_of_growth
        return self._slope(of, lambda before, area: self.times(of, area) - self.estimated(before, area))

    def deepest(self) -> Estimate:
        """Largest over the waits of the lost area, the mean over the surfaces."""
        return jackknife(lambda area: (1 - area.min(axis=2) / area[:, :, 0]).mean(axis=0).max(), self.area)

    def rows(self) -> pd.DataFrame:
        """Return areas, lost area and times, a row each waiting time."""
        logarithms = all_columns(
            minimum=jackknife(partial(self.times, time_of_minimum), self.area),
            growth=jackknife(partial(self.times, time_of_growth), self.area),
        ) | {"growth_estimated": self.estimated(self.before, self.area)}
        areas = {
            "waiting_time": self.wait,
            "surfaces": len(self.area),
            "area_before": self.before.mean(axis=0),
            "area_after": self.area[:, :, 0].mean(axis=0),
        }
        rates = {name: np.exp(values) for name, values in logarithms.items()}
        depth = mean(1 - self.area.min(axis=2) / self.area[:, :, 0])
        return pd.DataFrame(self.head | areas | columns("depth", depth) | rates)

    def powers(self) -> dict[str, object]:
        """Return the lost area and the powers of the waiting time."""
        head = self.head | {"surfaces": len(self.area)}
        return head | all_columns(
            depth=self.deepest(),
            minimum=self.power(time_of_minimum),
            growth=self.power(time_of_growth),
            estimated=self.estimated_power(),
        )

    def curves(self) -> pd.DataFrame:
        """Return the mean area over that just after the step, for each waiting time."""
        course = {
            "waiting_time": np.repeat(self.wait, self.time.size),
            "time": np.tile(self.time, self.wait.size),
            "area": (self.area / self.area[:, :, :1]).mean(axis=0).ravel(),
        }
        return pd.DataFrame(self.head | course)


_TEMPERATURES = (0.015, 0.03, 0.06)  # kT over the activation volume, which is s0 too
_BARRIER, _PREFACTOR, _HOLD = 1.0, 1e3, 1e5
_SLIDES, _VELOCITIES = (16, 8, 12, 12), (1.0, 1.0, 100.0, 0.01)


def _campaigns(surfaces: int, every: int) -> tuple[Campaign, ...]:
    """Return the campaigns, with so many surfaces each and every so many waiting times and temperatures."""
    temperatures = _TEMPERATURES[::every]
    slides = [slide(*one) for one in zip(_SLIDES, _VELOCITIES, strict=True)]
    law = {"creep_rate": temperatures[0] / 3.0, "creep_stress": temperatures[0]}
    solid = replace(SOLIDS["lattice"], what="lattice of springs", table={**SOLIDS["lattice"].table, **law})
    rates = [_PREFACTOR * math.exp(-_BARRIER / kT) for kT in temperatures]
    sliding = solid.campaign(
        "sliding",
        "Slide, hold, slide, and two steps of the velocity, at several temperatures",
        ROUGH | solid.rough,
        friction={"shear_strength": 1.0},
        aging={"first": 1.0, "per_decade": 1, "rtol": 0.02},
        protocol=[slides[0], hold(_HOLD), *slides[1:]],
        sweep=zipped(min(surfaces, 4), creep_stress=temperatures, creep_rate=rates),
    )
    return (*_two_steps(surfaces, every), sliding)


def analyse(evidence: Evidence) -> Outcome:
    """Judge what becomes of the area after a fall of the load, and of friction at rest."""
    every = [Steps.of(evidence, name, ratio) for name, solid in SOLIDS.items() for ratio in solid.steps]
    rests, at_rest = _rests(evidence)

    def known(number: Callable[[Steps], Estimate | None]) -> dict[str, Estimate]:
        return {one.words: value for one in every if (value := number(one)) is not None}

    def deepest(one: Steps, *, in_series: bool) -> Estimate | None:
        return one.deepest() if one.creep_stress and (one.name in IN_SERIES) is in_series else None

    numbers: dict[str, Estimate | dict[str, Estimate]] = {
        "series": known(partial(deepest, in_series=True)),
        "falls": known(partial(deepest, in_series=False)),
        "minimum": known(lambda one: one.power(time_of_minimum)),
        "growth": known(lambda one: one.power(time_of_growth)),
        "estimate": known(Steps.excess),
        **at_rest,
    }
    tables = {
        "steps": pd.concat([one.rows() for one in every], ignore_index=True),
        "powers": pd.DataFrame([one.powers() for one in every]),
        "curves": pd.concat([one.curves() for one in every if one.ratio == every[0].ratio]),
        "rests": rests,
    }
    findings = (WORDS.judge(claim, some) for claim, some in numbers.items() if some)  # few waits: no power
    return Outcome(tuple(findings), tables)


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


def _rests(evidence: Evidence) -> tuple[pd.DataFrame, dict[str, Estimate]]:
    """Return B at rest and in steady sliding at each temperature; and what decides the claims, by claim."""
    data = evidence["sliding"]
    at = data["creep_stress"].values.astype(np.float64)
    record = data.isel(seed=0, point=0)
    held = record["leg"].values == 1
    time = record["time"].values[held] - _SLIDES[0] / _VELOCITIES[0]
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
        return np.asarray(at / (LOAD * SIDE**2 / np.exp(np.log(area).mean(axis=1))))

    temperature = jackknife(lambda rest: power(at, growth(rest)), both[0])
    slope = jackknife(lambda rest, steady: (growth(rest) / stress(rest, steady)).mean(), both)
    fall = jackknife(lambda rest, steady: (fall_with_velocity(steady) / growth(rest)).mean(), both)
    head = {"kT": at, "s0_over_s": stress(*both), "surfaces": len(rests)}
    estimates = {"rest": jackknife(growth, both[0]), "steady": jackknife(fall_with_velocity, both[1])}
    judged = {"temperature": temperature, "slope": slope, "steady": fall}
    return pd.DataFrame(head | all_columns(**estimates)), judged


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
    figure, (curve, minimum, growth, rest) = style.panels(6.4, 6.4, 2, 2)
    curves, steps, rests = tables["curves"], tables["steps"], tables["rests"]
    shown = curves[(curves["solid"] == "lattice") & (curves["time"] > 0)].groupby("waiting_time")
    shades = colormaps["viridis"](np.linspace(0.9, 0, len(shown)))
    for shade, (wait, part) in zip(shades, shown, strict=True):
        curve.plot(
            part["time"], part["area"], color=shade, label=f"${power_of_ten(float(str(wait)))}$", linewidth=1
        )
    low, high = curve.get_ylim()
    curve.set_ylim(low - 0.35 * (high - low), high)
    for axis, name in ((minimum, "minimum"), (growth, "growth")):
        sharp = steps[steps[f"{name}_high"] < _BROAD * steps[f"{name}_low"]]
        for (solid, ratio), part in sharp.groupby(["solid", "load_ratio"], sort=False):
            mark, color = _LOOKS[str(solid)]
            line, filled = _LINES[str(ratio)]
            look = {"label": f"{str(solid).replace('_', '-')}, × {ratio}"}
            look["markerfacecolor"] = color if filled or mark in "x+*" else "white"
            style.points(axis, part, "waiting_time", name, mark + line, color, **look)
        axis.set(xscale="log", yscale="log")
        axis.set_ylim(top=axis.get_ylim()[1] * (1e5 if name == "growth" else 1))
    shared = {"linewidth": None}
    style.points(rest, rests, "kT", "rest", "o", style.INK, label="at rest, B", **shared)
    style.points(rest, rests, "kT", "steady", "s", style.BLUE, label="in steady sliding, b", **shared)
    rest.plot(rests["kT"], rests["s0_over_s"], "--", color="0.5", label="$s_0/s$")
    WORDS.dress(curve, minimum, growth, rest)
    return figure


ACTIVATED_CREEP = Study(
    **WORDS.study, quick=_campaigns(3, every=2), full=_campaigns(8, every=1), analyse=analyse, draw=draw
)
