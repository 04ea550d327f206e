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

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure

from asperity.checks import Floats
from asperity.figures import style
from asperity.fits.resampling import Estimate, jackknife
from asperity.studies.campaigns import Campaign, after_waits
from asperity.studies.evidence import Evidence
from asperity.studies.ledger import Finding
from asperity.studies.numbers import columns, crossing, mean, power, slope, vertex
from asperity.studies.panels import points
from asperity.studies.slide_hold_slide import before_shifts, steady_area
from asperity.studies.study import Outcome, Study

_STEPS = (1e-6, 1e-4, 1e-2, 1.0)
_DECADES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0)
_LINEAR = (0.1, 1.0, 10.0, 100.0, 1e3)
_END = 1e5
_SIDE = 64
_LOAD = 0.05
"""Load a site before the step."""

_FLAT = {"k0": 1.0, "k1": 3.0, "R": 0.0}


def _eyring(stress: float, stiffness: float) -> dict[str, Any]:
    """Eyring's law whose linear limit relaxes a spring of this stiffness in a time of 1."""
    return {"creep": "eyring", "creep_rate": stress / stiffness, "creep_stress": stress}


@dataclass(frozen=True)
class Solid:
    """A solid of the study.

    Attributes
    ----------
    what
        In words.
    table
        Its section of the campaign file.
    waits
        Waiting times before the step.
    ratios
        Loads after the step over that before.
    """

    what: str
    table: Mapping[str, Any]
    waits: tuple[float, ...]
    ratios: tuple[float, ...]

    @property
    def creep_stress(self) -> float:
        """s0; 0 for a linear solid."""
        return float(self.table.get("creep_stress", 0.0))


SOLIDS = {
    "lattice": Solid("lattice of springs, s0 = 0.05", _FLAT | _eyring(0.05, 3.0), _DECADES, (0.2, 0.5)),
    "lighter": Solid("lattice of springs, s0 = 0.05", _FLAT | _eyring(0.05, 3.0), _STEPS, (0.8,)),
    "cold": Solid("lattice of springs, s0 = 0.025", _FLAT | _eyring(0.025, 3.0), _STEPS, (0.5,)),
    "warm": Solid("lattice of springs, s0 = 0.1", _FLAT | _eyring(0.1, 3.0), _STEPS, (0.5,)),
    "bed": Solid("independent springs, s0 = 0.05", _FLAT | {"k0": 0.0} | _eyring(0.05, 3.0), _STEPS, (0.5,)),
    "half_space": Solid(
        "half-space in series with creep, s0 = 0.05",
        {"kind": "half_space", "modulus": 1.0} | _eyring(0.05, 1.0),
        _STEPS,
        (0.5, 0.8),
    ),
    "viscous": Solid("linear lattice, R_viscous = 1/3", _FLAT | {"R_viscous": 1 / 3}, _LINEAR, (0.2,)),
    "conserved": Solid("linear lattice, R = 1", _FLAT | {"R": 1.0}, _LINEAR, (0.2,)),
    "logarithm": Solid(
        "linear half-space, E(t) like ln t",
        {
            "kind": "half_space",
            "modulus": 1.0,
            "branches": [[0.06, 10.0**decade] for decade in range(-7, 6)],
        },
        (1e-3, 1e-2, 0.1, 1.0),
        (0.5,),
    ),
}
"""By the names of their campaigns. k1 = 3 k0 and E* = 1; M k1 = 1 in the linear limit of each lattice."""

TEMPERATURES = (0.015, 0.03, 0.06)
"""kT over the activation volume, which is s0 too."""

_BARRIER, _PREFACTOR = 1.0, 1e3
_HOLD = 1e5
_SLIDES = (16, 8, 12, 12)
_VELOCITIES = (1.0, 1.0, 100.0, 0.01)


def _surface() -> dict[str, Any]:
    return {"kind": "spectral", "shape": [_SIDE, _SIDE], "hurst": 0.8, "roll_off": 16.0, "cutoff": 4.0}


def _two_steps(name: str, ratio: float, surfaces: int, waits: tuple[float, ...]) -> Campaign:
    solid = SOLIDS[name]
    load = _LOAD * _SIDE**2
    return Campaign(
        _folder(name, ratio),
        f"Area after the load has fallen to {ratio:g} of it, waiting time as a factor on creep: {solid.what}",
        {
            "surface": _surface() | {"rms_slope" if "modulus" in solid.table else "rms_height": 1.0},
            "solid": solid.table,
            "contact": {"load": load},
            "aging": {"first": 1e-2, "per_decade": 4, "rtol": 5e-3},
            **after_waits({"load": ratio * load}, waits, _END, surfaces),
        },
    )


def _folder(name: str, ratio: float) -> str:
    return f"{name}_{ratio:g}".replace(".", "_")


def _sliding(surfaces: int, temperatures: tuple[float, ...]) -> Campaign:
    slides = [
        {"kind": "slide", "distance": float(distance), "velocity": velocity}
        for distance, velocity in zip(_SLIDES, _VELOCITIES, strict=True)
    ]
    return Campaign(
        "sliding",
        "Slide, hold, slide, and two steps of the velocity, at several temperatures",
        {
            "surface": _surface() | {"rms_height": 1.0},
            "solid": _FLAT | _eyring(temperatures[0], 3.0),
            "contact": {"load": _LOAD * _SIDE**2},
            "friction": {"shear_strength": 1.0},
            "aging": {"first": 1.0, "per_decade": 1, "rtol": 0.02},
            "protocol": [slides[0], {"kind": "hold", "duration": _HOLD}, *slides[1:]],
            "output": {"maps_at": []},
            "sweep": {
                "creep_stress": list(temperatures),
                "creep_rate": [_PREFACTOR * math.exp(-_BARRIER / kT) for kT in temperatures],
                "seeds": surfaces,
                "combine": "zip",
            },
        },
    )


def campaigns(surfaces: int, *, quick: bool) -> tuple[Campaign, ...]:
    """Return the campaigns, with so many surfaces each; the quick ones have every other waiting time."""
    every = 2 if quick else 1
    found = [
        _two_steps(name, ratio, surfaces, solid.waits[::every])
        for name, solid in SOLIDS.items()
        for ratio in solid.ratios
    ]
    return (*found, _sliding(min(surfaces, 4), TEMPERATURES[::every]))


FELL = 0.01
"""Lost part of the area from which on it counts as a fall."""

RISE = 1.03
"""Area over the smallest one so far at which growth counts as resumed."""

PROPORTIONAL = (0.8, 1.2)
"""Powers of the waiting time that bear out that a time is proportional to it."""


Reading = Callable[[Floats, Floats], float]
"""What is read off times and areas, shapes (n,)."""


def time_of_minimum(time: Floats, area: Floats) -> float:
    """Time at which an area is smallest: that of the parabola in ln t through it and its neighbors.

    Parameters
    ----------
    time
        Since the step, the first 0 and all others above it, shape (n,).
    area
        Areas at them, the first just after the step.

    Returns
    -------
    float
        NaN where the area does not fall by a part `FELL`, or is smallest at the end.
    """
    at = int(np.argmin(area))
    if area[at] > (1 - FELL) * area[0] or at == area.size - 1:
        return math.nan
    return float(time[1]) if at == 1 else vertex(time, area, at)


def time_of_growth(time: Floats, area: Floats) -> float:
    """Time at which an area first exceeds the smallest one so far by 3 %; times and areas as above."""
    over = area / np.minimum.accumulate(area)
    at = int(np.argmax(over > RISE))
    if not over[at] > RISE:
        return math.nan
    return float(time[1]) if at == 1 else crossing(time, over, at, RISE)[0]


@dataclass(frozen=True, eq=False)
class Steps:
    """All histories of a load that falls: one solid, one ratio of loads.

    Attributes
    ----------
    name, ratio
        Of the solid; load after the step over that before.
    wait
        Waiting times, shape (waits,).
    load
        Before the step.
    time
        Since the step, over the waiting time; 0 is just after it.
    before
        Area just before the step, shape (surfaces, waits).
    area
        Area after it, shape (surfaces, waits, times).
    """

    name: str
    ratio: float
    wait: Floats
    load: float
    time: Floats
    before: Floats
    area: Floats

    @classmethod
    def of(cls, evidence: Evidence, name: str, ratio: float) -> Steps:
        """Read them from a campaign."""
        data = evidence[_folder(name, ratio)]
        area = evidence.samples(_folder(name, ratio), "area")
        leg, time = (data[key].values.reshape(-1, area.shape[2])[0] for key in ("leg", "time"))
        wait = data["protocol.0.mobility"].values.astype(np.float64)
        since = leg >= 1
        held = np.flatnonzero(leg == 0)[-1]
        load = _LOAD * _SIDE**2
        return cls(name, ratio, wait, load, time[since] - 1, area[:, :, held], area[:, :, since])

    @property
    def words(self) -> str:
        """Which ones, for a reader."""
        return f"{SOLIDS[self.name].what}, load × {self.ratio:g}"

    @property
    def creeps(self) -> bool:
        """Whether creep is activated."""
        return SOLIDS[self.name].creep_stress > 0

    @property
    def depth(self) -> Floats:
        """Lost area over that just after the step, shape (surfaces, waits)."""
        return np.asarray(1 - self.area.min(axis=2) / self.area[:, :, 0])

    def times(self, of: Reading, area: Floats) -> Floats:
        """Return ln(time / waiting time) at each wait, for a sample of areas after the step."""
        return np.log([of(self.time, one) for one in area.mean(axis=0)])

    def estimated(self, before: Floats, area: Floats) -> Floats:
        """Return ln(t_r/t_w) = (s_1 - s_2)/s0 from mean forces before and after the step; NaN without s0."""
        first = self.load / before.mean(axis=0)
        then = self.ratio * self.load / area[:, :, 0].mean(axis=0)
        return np.asarray((first - then) / (SOLIDS[self.name].creep_stress or math.nan))

    def _slope(self, of: Reading, statistic: Callable[[Floats, Floats], Floats]) -> Estimate | None:
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
        return jackknife(lambda depth: depth.mean(axis=0).max(), self.depth)


def analyse(evidence: Evidence) -> Outcome:
    """Judge what becomes of the area after a fall of the load, and of friction at rest."""
    every = [Steps.of(evidence, name, ratio) for name, solid in SOLIDS.items() for ratio in solid.ratios]
    rests = Rests.of(evidence)
    findings = (*_of_steps(every), *rests.findings())
    return Outcome(
        tuple(finding for finding in findings if finding.measured),  # few waits give no power
        {
            "steps": pd.concat([_rows(one) for one in every], ignore_index=True),
            "powers": pd.DataFrame([_power_row(one) for one in every]),
            "curves": pd.concat([_curves(one) for one in every if one.ratio == every[0].ratio]),
            "rests": rests.table(),
        },
    )


def _of_steps(every: list[Steps]) -> Iterator[Finding]:
    """Judge what is claimed of the area after a fall of the load."""

    def known(what: str, number: Callable[[Steps], Estimate | None]) -> dict[str, Estimate]:
        return {f"{what}: {one.words}": found for one in every if (found := number(one)) is not None}

    def deepest(*, in_series: bool) -> dict[str, Estimate]:
        return known(
            "largest mean of lost area over that after the step",
            lambda one: one.deepest() if one.creeps and (one.name in IN_SERIES) is in_series else None,
        )

    dillavou, here = "Dillavou and Rubinstein 2018", "this study"
    in_time = "power of the waiting time in the time of"
    claim = "Where all of the stiffness creeps, no contact is lost after the load has fallen"
    numbers = deepest(in_series=True)
    yield Finding.within((-math.inf, FELL), "series", "the proof on this page", claim, numbers)
    claim = "With activated creep beside permanent springs, the area falls before it rises"
    numbers = deepest(in_series=False)
    note = "The largest over the waiting times."
    yield Finding.within((FELL, math.inf), "falls", dillavou, claim, numbers, note)
    claim = "The time of the minimum is proportional to the waiting time"
    numbers = known(f"{in_time} the minimum", lambda one: one.power(time_of_minimum))
    yield Finding.within(PROPORTIONAL, "minimum", dillavou, claim, numbers)
    claim = "The time at which growth resumes is proportional to the waiting time"
    numbers = known(f"{in_time} growth", lambda one: one.power(time_of_growth))
    yield Finding.within(PROPORTIONAL, "growth", here, claim, numbers)
    claim = "The power in the time of growth is that of the mean forces"
    numbers = known("power less d s_2/d s_1", Steps.excess)
    yield Finding.within((-0.1, 0.1), "estimate", here, claim, numbers)


IN_SERIES = ("bed", "half_space")
"""Solids whose whole stiffness creeps."""


def _rows(one: Steps) -> pd.DataFrame:
    growth, minimum = (
        jackknife(partial(one.times, of), one.area) for of in (time_of_growth, time_of_minimum)
    )
    estimated = one.estimated(one.before, one.area)
    logarithms = columns("minimum", minimum) | columns("growth", growth) | {"growth_estimated": estimated}
    return pd.DataFrame(
        {
            "solid": one.name,
            "load_ratio": one.ratio,
            "waiting_time": one.wait,
            "surfaces": len(one.area),
            "area_before": one.before.mean(axis=0),
            "area_after": one.area[:, :, 0].mean(axis=0),
            **columns("depth", mean(one.depth)),
            **{name: np.exp(values) for name, values in logarithms.items()},
        }
    )


def _power_row(one: Steps) -> dict[str, object]:
    return {
        "solid": one.name,
        "load_ratio": one.ratio,
        "surfaces": len(one.area),
        **columns("depth", one.deepest()),
        **columns("minimum", one.power(time_of_minimum)),
        **columns("growth", one.power(time_of_growth)),
        **columns("estimated", one.estimated_power()),
    }


def _curves(one: Steps) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "solid": one.name,
            "load_ratio": one.ratio,
            "waiting_time": np.repeat(one.wait, one.time.size),
            "time": np.tile(one.time, one.wait.size),
            "area": (one.area / one.area[:, :, :1]).mean(axis=0).ravel(),
        }
    )


@dataclass(frozen=True, eq=False)
class Rests:
    """Slide, hold, slide at several temperatures.

    Attributes
    ----------
    temperature
        kT over the activation volume, shape (temperatures,).
    time
        At rest, shape (times,).
    rest
        Area at rest over that just before, shape (surfaces, temperatures, times).
    steady
        Area in steady sliding at each of `_VELOCITIES` but the first, shape (surfaces, temperatures, 3).
    """

    temperature: Floats
    time: Floats
    rest: Floats
    steady: Floats

    @classmethod
    def of(cls, evidence: Evidence) -> Rests:
        """Read them from the campaign."""
        data = evidence["sliding"]
        temperature = data["creep_stress"].values.astype(np.float64)
        rest, steady = [], []
        for seed in data["seed"].values:
            runs = [data.sel(seed=seed).isel(point=point) for point in range(len(temperature))]
            before = [before_shifts(one, 0)[-1] for one in runs]
            held = [one["area"].values[one["leg"].values == 1] for one in runs]
            rest.append([area / start for area, start in zip(held, before, strict=True)])
            steady.append([[steady_area(one, leg) for leg in (2, 3, 4)] for one in runs])
        one = data.isel(seed=0, point=0)
        time = one["time"].values[one["leg"].values == 1] - _SLIDES[0] / _VELOCITIES[0]
        return cls(temperature, time, np.array(rest), np.array(steady))

    @property
    def late(self) -> Floats:
        """Which times at rest count for B: those in which a slide would have passed several contacts."""
        return np.asarray(self.time >= 10)

    def growth(self, rest: Floats) -> Floats:
        """B, the growth at rest for every e-fold of time over the area before, at each temperature."""
        slopes: Floats = np.polyfit(np.log(self.time[self.late]), rest.mean(axis=0)[:, self.late].T, 1)[0]
        return slopes

    def fall(self, steady: Floats) -> Floats:
        """Fall of the area in steady sliding for every e-fold of the velocity, over that at 1."""
        mean = steady.mean(axis=0)
        order = np.log(_VELOCITIES[1:])
        slopes: Floats = np.polyfit(order, (mean / mean[:, :1]).T, 1)[0]
        return -slopes

    def force(self, steady: Floats, rest: Floats) -> Floats:
        """Mean force of a contact at rest, in the middle of the times that count."""
        area = steady[:, :, :1] * rest[:, :, self.late]
        return np.asarray(_LOAD * _SIDE**2 / np.exp(np.log(area.mean(axis=0)).mean(axis=1)))

    def findings(self) -> Iterator[Finding]:
        """Judge what is claimed of friction at rest."""
        at, both = self.temperature, (self.rest, self.steady)
        found = jackknife(lambda rest: power(at, self.growth(rest)), self.rest)
        claim = "Static friction grows with the logarithm of the hold time, in proportion to temperature"
        numbers = {"power of <i>T</i> in B": found}
        yield Finding.within(PROPORTIONAL, "temperature", "Baumberger and Caroli 2006", claim, numbers)
        found = jackknife(
            lambda rest, steady: (self.growth(rest) / (at / self.force(steady, rest))).mean(), both
        )
        numbers = {"B s/s0, mean over temperatures": found}
        yield Finding.within((0.5, 1.0), "slope", "docs/creep.md", "B of rests is s0/s", numbers)
        found = jackknife(lambda rest, steady: (self.fall(steady) / self.growth(rest)).mean(), both)
        claim = "Steady friction falls with velocity as static friction grows with hold time"
        numbers = {"b of steady sliding over B, mean over temperatures": found}
        yield Finding.within((0.8, 1.25), "steady", "Dieterich 1979", claim, numbers)

    def table(self) -> pd.DataFrame:
        """B at rest and in steady sliding, and s0/s, at each temperature."""
        return pd.DataFrame(
            {
                "kT": self.temperature,
                "s0_over_s": self.temperature / self.force(self.steady, self.rest),
                "surfaces": len(self.rest),
                **columns("rest", jackknife(self.growth, self.rest)),
                **columns("steady", jackknife(self.fall, self.steady)),
            }
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
_LINES = {0.2: "-", 0.5: "--", 0.8: ":"}
"""Lines of each ratio of the loads."""


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw the area after the step, the times of minimum and growth, and the growth at rest."""
    figure = style.Drawing(figsize=(9.6, 6.0), layout="constrained")
    (curve, minimum), (growth, rest) = figure.subplots(2, 2)
    curves, steps, rests = tables["curves"], tables["steps"], tables["rests"]
    shown = curves[(curves["solid"] == "lattice") & (curves["time"] > 0)]
    waits = shown["waiting_time"].unique().tolist()
    shades = colormaps[style.PRESSURE_MAP](np.linspace(0.9, 0, len(waits)))
    for shade, wait in zip(shades, waits, strict=True):
        part = shown[shown["waiting_time"] == wait]
        words = f"${style.power(wait)}$"
        curve.plot(part["time"], part["area"], color=shade, label=words, linewidth=1)
    curve.set(
        xscale="log",
        xlabel=r"time since the step over $t_\mathrm{w}$",
        ylabel="area over that after the step",
    )
    low, high = curve.get_ylim()
    curve.set_ylim(low - 0.35 * (high - low), high)
    curve.legend(title=r"$t_\mathrm{w}$", fontsize=6, title_fontsize=7, ncols=4, loc="lower left")
    for axis, name in ((minimum, "minimum"), (growth, "growth")):
        for (solid, ratio), part in steps.groupby(["solid", "load_ratio"], sort=False):
            part = part[part[f"{name}_high"] < _BROAD * part[f"{name}_low"]]
            if part.empty:
                continue
            mark, color = _LOOKS[str(solid)]
            filled = part["load_ratio"].iloc[0] < 0.5 or mark in "x+*"
            points(
                axis,
                part,
                "waiting_time",
                name,
                mark + _LINES[float(part["load_ratio"].iloc[0])],
                color,
                markerfacecolor=color if filled else "white",
                label=f"{str(solid).replace('_', '-')}, × {ratio:g}",
            )
        axis.set(
            xscale="log",
            yscale="log",
            xlabel=r"waiting time $t_\mathrm{w}$",
            ylabel=rf"time of {'the minimum' if name == 'minimum' else 'growth'} over $t_\mathrm{{w}}$",
        )
        axis.set_ylim(top=axis.get_ylim()[1] * (1e3 if name == "growth" else 1))
        axis.legend(fontsize=6, ncols=2, loc="upper right")
    for name, mark, color, label in (
        ("rest", "o", style.INK, "at rest, B"),
        ("steady", "s", style.BLUE, "in steady sliding, b"),
    ):
        points(rest, rests, "kT", name, mark, color, label=label, linewidth=None)
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
