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
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import NDArray

from asperity.checks import Floats
from asperity.figures import style
from asperity.fits.resampling import Estimate, jackknife
from asperity.studies.campaigns import Campaign
from asperity.studies.evidence import Evidence
from asperity.studies.ledger import Finding, Measurement
from asperity.studies.slide_hold_slide import before_shifts
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
    creep_stress
        s0; 0 for a linear solid.
    """

    what: str
    table: Mapping[str, Any]
    waits: tuple[float, ...]
    ratios: tuple[float, ...]
    creep_stress: float = 0.0

    @property
    def continuum(self) -> bool:
        """Whether it is a half-space."""
        return self.table.get("kind") == "half_space"


SOLIDS = {
    "lattice": Solid("lattice of springs, s0 = 0.05", _FLAT | _eyring(0.05, 3.0), _DECADES, (0.2, 0.5), 0.05),
    "lighter": Solid("lattice of springs, s0 = 0.05", _FLAT | _eyring(0.05, 3.0), _STEPS, (0.8,), 0.05),
    "cold": Solid("lattice of springs, s0 = 0.025", _FLAT | _eyring(0.025, 3.0), _STEPS, (0.5,), 0.025),
    "warm": Solid("lattice of springs, s0 = 0.1", _FLAT | _eyring(0.1, 3.0), _STEPS, (0.5,), 0.1),
    "bed": Solid(
        "independent springs, s0 = 0.05", _FLAT | {"k0": 0.0} | _eyring(0.05, 3.0), _STEPS, (0.5,), 0.05
    ),
    "half_space": Solid(
        "half-space in series with creep, s0 = 0.05",
        {"kind": "half_space", "modulus": 1.0} | _eyring(0.05, 1.0),
        _STEPS,
        (0.5, 0.8),
        0.05,
    ),
    "viscous": Solid(
        "linear lattice, R_viscous = 1/3",
        _FLAT | {"R_viscous": 1 / 3},
        _LINEAR,
        (0.2,),
    ),
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
_STEADY = 8


def _surface() -> dict[str, Any]:
    return {"kind": "spectral", "shape": [_SIDE, _SIDE], "hurst": 0.8, "roll_off": 16.0, "cutoff": 4.0}


def _two_steps(name: str, ratio: float, surfaces: int, waits: tuple[float, ...]) -> Campaign:
    """Creep t_w times as fast for a time of 1 is creep for t_w."""
    solid = SOLIDS[name]
    load = _LOAD * _SIDE**2
    return Campaign(
        _folder(name, ratio),
        f"Area after the load has fallen to {ratio:g} of it, waiting time as a factor on creep: {solid.what}",
        {
            "surface": _surface() | {"rms_slope" if solid.continuum else "rms_height": 1.0},
            "solid": solid.table,
            "contact": {"load": load},
            "aging": {"first": 1e-2, "per_decade": 4, "rtol": 5e-3},
            "protocol": [
                {"kind": "hold", "duration": 1.0},
                {"kind": "step", "load": ratio * load},
                {"kind": "hold", "duration": _END},
            ],
            "output": {"maps_at": []},
            "sweep": {
                "protocol.0.mobility": list(waits),
                "protocol.2.mobility": list(waits),
                "seeds": surfaces,
                "combine": "zip",
            },
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
    if at == 1:
        return float(time[1])
    near = slice(at - 1, at + 2)
    square, slope, _ = np.polyfit(np.log(time[near] / time[at]), area[near] / area[at], 2)
    return float(time[at] * math.exp(-slope / (2 * square))) if square > 0 else float(time[at])


def time_of_growth(time: Floats, area: Floats) -> float:
    """Time at which an area first exceeds the smallest one so far by 3 %; times and areas as above."""
    over = area / np.minimum.accumulate(area)
    at = int(np.argmax(over > RISE))
    if not over[at] > RISE:
        return math.nan
    if at == 1:
        return float(time[1])
    part = (RISE - over[at - 1]) / (over[at] - over[at - 1])
    return float(np.exp(np.interp(part, [0, 1], np.log(time[at - 1 : at + 1]))))


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
        area = data["area"].transpose("seed", "point", "time").values.astype(np.float64)
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
    def depth(self) -> Floats:
        """Lost area over that just after the step, shape (surfaces, waits)."""
        return np.asarray(1 - self.area.min(axis=2) / self.area[:, :, 0])

    def times(self, of: Callable[[Floats, Floats], float]) -> Callable[[Floats], Floats]:
        """Return ln(time / waiting time) at each wait, as a function of a sample of areas after the step."""
        return lambda area: np.log([of(self.time, one) for one in area.mean(axis=0)])

    def power(self, of: Callable[[Floats, Floats], float]) -> Estimate | None:
        """Power of the waiting time in a time; None where fewer than three waits have one in every sample."""
        times, shared = self.times(of), self.shared(of)
        if shared.sum() < 3:
            return None
        wait = np.log(self.wait[shared])
        return jackknife(lambda area: 1 + np.polyfit(wait, times(area)[shared], 1)[0], self.area)

    def shared(self, of: Callable[[Floats, Floats], float]) -> NDArray[np.bool_]:
        """Waits at which every sample has that time."""
        return np.isfinite(jackknife(self.times(of), self.area).high)

    def estimated(self, before: Floats, area: Floats) -> Floats:
        """Return ln(t_r/t_w) = (s_1 - s_2)/s0 from the mean forces before and after the step."""
        first = self.load / before.mean(axis=0)
        then = self.ratio * self.load / area[:, :, 0].mean(axis=0)
        return np.asarray((first - then) / SOLIDS[self.name].creep_stress)

    def estimated_power(self) -> Estimate | None:
        """Power of the waiting time in the estimate, at the waits at which growth resumes."""
        shared = self.shared(time_of_growth)
        if shared.sum() < 3 or not SOLIDS[self.name].creep_stress:
            return None
        wait = np.log(self.wait[shared])
        return jackknife(
            lambda before, area: 1 + np.polyfit(wait, self.estimated(before, area)[shared], 1)[0],
            (self.before, self.area),
        )

    def excess(self) -> Estimate | None:
        """Power of the waiting time in t_r less that of the estimate, where both are known."""
        if self.estimated_power() is None:
            return None
        times, shared = self.times(time_of_growth), self.shared(time_of_growth)
        wait = np.log(self.wait[shared])

        def difference(before: Floats, area: Floats) -> float:
            return float(np.polyfit(wait, (times(area) - self.estimated(before, area))[shared], 1)[0])

        return jackknife(difference, (self.before, self.area))


def analyse(evidence: Evidence) -> Outcome:
    """Judge what becomes of the area after a fall of the load, and of friction at rest."""
    every = [Steps.of(evidence, name, ratio) for name, solid in SOLIDS.items() for ratio in solid.ratios]
    rests = Rests.of(evidence)
    in_series = [one for one in every if one.name in IN_SERIES]
    beside = [one for one in every if one.name in ACTIVATED and one.name not in IN_SERIES]
    lost = "largest mean of lost area over that after the step: "
    findings = (
        Finding(
            "series",
            "the proof on this page",
            "Where all of the stiffness creeps, no contact is lost after the load has fallen",
            tuple(Measurement(lost + one.words, _deepest(one), high=FELL) for one in in_series),
        ),
        Finding(
            "falls",
            "Dillavou and Rubinstein 2018",
            "With activated creep beside permanent springs, the area falls before it rises",
            tuple(Measurement(lost + one.words, _deepest(one), low=FELL) for one in beside),
            note="The largest over the waiting times.",
        ),
        Finding(
            "minimum",
            "Dillavou and Rubinstein 2018",
            "The time of the minimum is proportional to the waiting time",
            _powers(every, time_of_minimum, "time of the minimum"),
        ),
        Finding(
            "growth",
            "this study",
            "The time at which growth resumes is proportional to the waiting time",
            _powers(every, time_of_growth, "time of growth"),
        ),
        Finding(
            "estimate",
            "this study",
            "The power in the time of growth is that of the mean forces",
            tuple(
                Measurement(f"power less d s_2/d s_1: {one.words}", found, -0.1, 0.1)
                for one in every
                if (found := one.excess()) is not None
            ),
        ),
        *rests.findings(),
    )
    return Outcome(
        tuple(finding for finding in findings if finding.measured),  # few waits give no power
        {
            "steps": pd.DataFrame([row for one in every for row in _rows(one)]),
            "powers": pd.DataFrame([_power_row(one) for one in every]),
            "curves": pd.concat([_curves(one) for one in every if one.ratio == every[0].ratio]),
            "rests": rests.table(),
        },
    )


ACTIVATED = tuple(name for name, solid in SOLIDS.items() if solid.creep_stress)
IN_SERIES = ("bed", "half_space")
"""Solids whose whole stiffness creeps."""


def _powers(every: list[Steps], of: Callable[[Floats, Floats], float], what: str) -> tuple[Measurement, ...]:
    return tuple(
        Measurement(f"power of the waiting time in the {what}: {one.words}", found, *PROPORTIONAL)
        for one in every
        if (found := one.power(of)) is not None
    )


def _rows(one: Steps) -> Iterator[dict[str, object]]:
    growth = jackknife(one.times(time_of_growth), one.area)
    minimum = jackknife(one.times(time_of_minimum), one.area)
    depth = jackknife(lambda some: some.mean(axis=0), one.depth)
    activated = SOLIDS[one.name].creep_stress > 0
    estimated = one.estimated(one.before, one.area) if activated else np.full(one.wait.size, np.nan)
    for at, wait in enumerate(one.wait):
        yield {
            "solid": one.name,
            "load_ratio": one.ratio,
            "waiting_time": wait,
            "surfaces": len(one.area),
            "area_before": one.before[:, at].mean(),
            "area_after": one.area[:, at, 0].mean(),
            "depth": float(depth.value[at]),
            "depth_low": float(depth.low[at]),
            "depth_high": float(depth.high[at]),
            **_as_times("minimum", minimum, at),
            **_as_times("growth", growth, at),
            "growth_estimated": float(np.exp(estimated[at])),
        }


def _as_times(name: str, found: Estimate, at: int) -> dict[str, float]:
    parts = {name: found.value, f"{name}_low": found.low, f"{name}_high": found.high}
    return {key: float(np.exp(part[at])) for key, part in parts.items()}


def _power_row(one: Steps) -> dict[str, object]:
    deepest = _deepest(one)
    row: dict[str, object] = {"solid": one.name, "load_ratio": one.ratio, "surfaces": len(one.area)}
    powers = {"minimum": one.power(time_of_minimum), "growth": one.power(time_of_growth)}
    for name, found in {"depth": deepest, **powers, "estimated": one.estimated_power()}.items():
        for end, part in (("", "value"), ("_low", "low"), ("_high", "high")):
            row[f"{name}{end}"] = float(getattr(found, part)) if found is not None else math.nan
    return row


def _deepest(one: Steps) -> Estimate:
    """Largest over the waits of the lost area, the mean over the surfaces."""
    return jackknife(lambda depth: depth.mean(axis=0).max(), one.depth)


def _curves(one: Steps) -> pd.DataFrame:
    relative = (one.area / one.area[:, :, :1]).mean(axis=0)
    parts = [
        pd.DataFrame(
            {"solid": one.name, "load_ratio": one.ratio, "waiting_time": wait}
            | {"time": one.time, "area": area}
        )
        for wait, area in zip(one.wait, relative, strict=True)
    ]
    return pd.concat(parts)


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
            steady.append([[before_shifts(one, leg)[-_STEADY:].mean() for leg in (2, 3, 4)] for one in runs])
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

    def findings(self) -> tuple[Finding, ...]:
        """Judge what is claimed of friction at rest."""
        logs = np.log(self.temperature)
        power = jackknife(lambda rest: np.polyfit(logs, np.log(self.growth(rest)), 1)[0], self.rest)
        ratio = jackknife(
            lambda rest, steady: (self.growth(rest) / (self.temperature / self.force(steady, rest))).mean(),
            (self.rest, self.steady),
        )
        same = jackknife(
            lambda rest, steady: (self.fall(steady) / self.growth(rest)).mean(), (self.rest, self.steady)
        )
        return (
            Finding(
                "temperature",
                "Baumberger and Caroli 2006",
                "Static friction grows with the logarithm of the hold time, in proportion to temperature",
                (Measurement("power of <i>T</i> in B", power, *PROPORTIONAL),),
            ),
            Finding(
                "slope",
                "docs/creep.md",
                "B of rests is s0/s",
                (Measurement("B s/s0, mean over temperatures", ratio, 0.5, 1.0),),
            ),
            Finding(
                "steady",
                "Dieterich 1979",
                "Steady friction falls with velocity as static friction grows with hold time",
                (Measurement("b of steady sliding over B, mean over temperatures", same, 0.8, 1.25),),
            ),
        )

    def table(self) -> pd.DataFrame:
        """B at rest and in steady sliding, and s0/s, at each temperature."""
        found = {"rest": jackknife(self.growth, self.rest), "steady": jackknife(self.fall, self.steady)}
        theory = self.temperature / self.force(self.steady, self.rest)
        return pd.DataFrame(
            {"kT": self.temperature, "s0_over_s": theory, "surfaces": len(self.rest)}
            | {
                f"{name}{end}": part
                for name, one in found.items()
                for end, part in (("", one.value), ("_low", one.low), ("_high", one.high))
            }
        )


_BROAD = 1e3
"""Upper over lower end of an interval from which on a time is not drawn."""

_LOOKS = {
    "lattice": ("o", style.INK),
    "lighter": ("o", style.INK),
    "cold": ("v", style.SKY),
    "warm": ("^", style.VERMILION),
    "bed": ("s", style.BLUE),
    "half_space": ("D", style.BLUE),
    "viscous": ("x", "0.5"),
    "conserved": ("+", "0.5"),
    "logarithm": ("*", "0.5"),
}


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw the area after the step, the times of minimum and growth, and the growth at rest."""
    figure = style.Drawing(figsize=(9.6, 6.0), layout="constrained")
    (curve, minimum), (growth, rest) = figure.subplots(2, 2)
    curves, steps, rests = tables["curves"], tables["steps"], tables["rests"]
    shown = curves[(curves["solid"] == "lattice") & (curves["time"] > 0)]
    waits = shown["waiting_time"].unique().tolist()
    for shade, wait in zip(np.linspace(0.75, 0, len(waits)), waits, strict=True):
        part = shown[shown["waiting_time"] == wait]
        words = f"${style.power(wait)}$"
        curve.plot(part["time"], part["area"], color=str(shade), label=words, linewidth=1)
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
            axis.errorbar(
                part["waiting_time"],
                part[name],
                yerr=(part[name] - part[f"{name}_low"], part[f"{name}_high"] - part[name]),
                fmt=f"{mark}-",
                color=color,
                markersize=4,
                linewidth=0.8,
                markerfacecolor=color if part["load_ratio"].iloc[0] < 0.5 or mark in "x+*" else "white",
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
    for name, mark, label in (("rest", "o", "at rest, B"), ("steady", "s", "in steady sliding, b")):
        rest.errorbar(
            rests["kT"],
            rests[name],
            yerr=(rests[name] - rests[f"{name}_low"], rests[f"{name}_high"] - rests[name]),
            fmt=mark,
            color=style.INK if name == "rest" else style.BLUE,
            markersize=4,
            label=label,
        )
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
