"""Whether the contact area falls before it rises, after the load has fallen.

A contact is held under a load for a waiting time; then the load falls at once to a part of it, and stays.
Lost contact is counted from the state just after the step, so that what the step itself takes does not count.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from asperity.fits import Estimate
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, Solid, hold, waves
from asperity_research.studies.evidence import Around, Evidence
from asperity_research.studies.ledger import Finding, estimate, proportion
from asperity_research.studies.numbers import mean, slope
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)
WAIT, LOAD = "protocol.0.duration", "protocol.1.load"
RATIOS = (0.2, 0.5)  # Load after the step over that before
_BRANCHES = [[0.25, 1.0], [0.25, 10.0], [0.25, 100.0]]
_COATED = {
    "kind": "coated_half_space",
    "modulus": 1.0,
    "poisson": 0.4,
    "thickness": 4.0,
    "base_modulus": 1.0,
    "base_poisson": 0.4,
    "base_branches": _BRANCHES,
}
_SPRINGS, _WAITS = {"k0": 1.0, "k1": 3.0}, (5.0, 30.0, 200.0)

SOLIDS = {
    "half_space": Solid(
        "half-space, three relaxation times",
        {"kind": "half_space", "modulus": 1.0, "branches": _BRANCHES},
        0.05,
        (10.0,),
    ),
    "coated": Solid("elastic film on a half-space that relaxes", _COATED, 0.05, (10.0,)),
    "conserved": Solid(
        "lattice of springs, creep that conserves the mean (R)", _SPRINGS | {"R": 1.0}, 0.2, _WAITS
    ),
    "viscous": Solid(
        "lattice of springs, viscous creep (R_viscous)", _SPRINGS | {"R": 0.0, "R_viscous": 1.0}, 0.2, _WAITS
    ),
}
"""The solids by the names of their campaigns; k0 = 1 and E* = 1 set the unit of stiffness."""

SEPARABLE = ("half_space",)  # Those whose spectra are all proportional


def campaigns(*, surfaces: int, side: int) -> tuple[Campaign, ...]:
    """Return the campaigns, one for each solid: so many surfaces, of so many sites along a side."""
    found = []
    for name, solid in SOLIDS.items():
        loads = [ratio * (solid.load * side**2) for ratio in RATIOS]
        one = solid.campaign(
            name,
            "Area after a fall of the load",
            waves(side, side / 2, rms_slope=1.0),
            aging={"first": 1e-2, "per_decade": 4, "rtol": 5e-3},
            protocol=[hold(solid.waits[0]), {"kind": "step", "load": loads[0]}, hold(1e4)],
            output={},
            sweep={WAIT: list(solid.waits), LOAD: loads, "seeds": surfaces},
        )
        found.append(one)
    return tuple(found)


@dataclass(frozen=True, eq=False)
class After:
    """Areas after the step for one solid, one waiting time and one load ratio.

    Time since the step, 0 just after it; areas in sites, shape (surfaces, times).
    """

    solid: str
    wait: float
    ratio: float
    time: Field
    area: Field

    @classmethod
    def all_of(cls, data: xr.Dataset, solid: str) -> list[After]:
        """Read those for every waiting time and load of a campaign."""
        some = [
            (float(wait), ratio, Around.step(data.sel({WAIT: wait, LOAD: load})))
            for wait in data[WAIT].values
            for ratio, load in zip(RATIOS, data[LOAD].values, strict=True)
        ]
        return [cls(solid, wait, ratio, one.time, one.after) for wait, ratio, one in some]

    @property
    def depth(self) -> Field:
        """Lost area over the area just after the step, one a surface."""
        return np.asarray(1 - self.area.min(axis=1) / self.area[:, 0])

    @property
    def log_time(self) -> Field:
        """Logarithm of the time of the minimum, in the middle where it lasts; NaN without a dip."""
        at = [self.time[area == area.min()] for area in self.area]
        return np.array([np.log(some[[0, -1]]).mean() if some[0] > 0 else math.nan for some in at])

    def tables(self) -> tuple[dict[str, object], pd.DataFrame]:
        """Return depth and time of the minimum, a row; and the mean area over that just after the step."""
        head = {"solid": self.solid, "waiting_time": self.wait, "load_ratio": self.ratio}
        depth, log_time = self.depth, self.log_time[np.isfinite(self.log_time)]
        lost, time = mean(depth), mean(log_time) if log_time.size else _UNKNOWN
        dip = head | {
            "surfaces": depth.size,
            "with_a_dip": int((depth > 0).sum()),
            "depth": float(lost.value),
            "depth_stderr": float(lost.stderr),
            "deepest": float(depth.max()),
            "time_of_minimum": float(np.exp(time.value)),
            "log_time_stderr": float(time.stderr),
            "area_after_step": float(self.area[:, 0].mean()),
        }
        relative = mean(self.area / self.area[:, :1])
        course = {"time": self.time, "area": relative.value, "area_stderr": relative.stderr}
        return dip, pd.DataFrame(head | course)


def analyse(evidence: Evidence) -> Outcome:
    """Judge what is claimed of the area after a fall of the load."""
    found = {name: After.all_of(evidence[name][["area", "time", "leg"]], name) for name in SOLIDS}
    early = [one for one in found["conserved"] if one.wait < _relaxation_time(evidence["conserved"].attrs)]
    dips, curves = zip(*(one.tables() for some in found.values() for one in some), strict=True)
    tables = {"dips": pd.DataFrame(list(dips)), "curves": pd.concat(curves)}
    return Outcome(tuple(_findings(found, early)), tables)


def _findings(found: Mapping[str, list[After]], early: list[After]) -> Iterator[Finding]:
    for key, separable in (("separable", True), ("any-linear-solid", False)):
        lost = {
            f"share of surfaces that lose contact: {solid.what}": _surfaces_that_lose(found[name])
            for name, solid in SOLIDS.items()
            if (name in SEPARABLE) is separable
        }
        yield WORDS.judge(key, lost)
    waits = f"waits from {early[0].wait:g} to {early[-1].wait:g}" if early else "no wait is short enough"
    what = "d ln (time of the minimum)/d ln (waiting time), load ratio"
    numbers = {
        f"{what} {ratio:g}, {waits}: {SOLIDS['conserved'].what}": _exponent(
            [one for one in early if one.ratio == ratio]
        )
        for ratio in RATIOS
    }
    yield WORDS.judge("time-of-minimum", numbers)


_UNKNOWN = estimate(math.nan, math.nan, math.nan, math.nan, 0)


def _surfaces_that_lose(every: list[After]) -> Estimate:
    lose = np.any([one.depth > 0 for one in every], axis=0)
    return proportion(int(lose.sum()), lose.size)


def _relaxation_time(of: Mapping[str, float]) -> float:
    """Relaxation time of the longest waves of the surface on a lattice whose creep conserves the mean."""
    lam = (2 * np.pi / of["roll_off"]) ** 2
    return float((of["k0"] * lam + of["k1"]) / (of["R"] * of["k0"] * of["k1"] * lam**2))


def _exponent(every: list[After]) -> Estimate:
    """Slope of ln (time of the minimum) against ln (waiting time), surface by surface; their mean."""
    wait = np.array([one.wait for one in every])
    times = np.array([one.log_time for one in every] or [np.empty(0)])
    times = times[:, np.isfinite(times).all(axis=0)].T
    if wait.size < 2 or not len(times):
        return replace(_UNKNOWN, runs=len(times))
    return mean(np.array([slope(wait, one) for one in times]))


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw area after the step, depth of the dip and time of the minimum."""
    dips, curves = tables["dips"], tables["curves"]
    figure = Figure(figsize=(9.0, 3.4), layout="constrained")
    area, depth, time = figure.subplots(1, 3)
    ratio = min(RATIOS)
    for (name, solid), mark, shade in zip(SOLIDS.items(), "sD^o", ("0.6", "0.4", "0.2", "0.0"), strict=True):
        shown = (curves["waiting_time"] == solid.waits[-1]) & (curves["load_ratio"] == ratio)
        one = curves[shown & (curves["time"] > 0) & (curves["solid"] == name)]
        line = "--" if name in SEPARABLE else "-"
        style = {"marker": mark, "color": shade, "markersize": 4, "linestyle": line}
        area.errorbar(one["time"], one["area"], one["area_stderr"], label=name, **style)
        for part, fill in zip(RATIOS, (None, "white"), strict=True):
            here = dips[(dips["solid"] == name) & (dips["load_ratio"] == part)]
            at, lowest = here["waiting_time"], here["time_of_minimum"]
            style["markerfacecolor"] = fill
            depth.errorbar(at, 100 * here["depth"], 100 * here["depth_stderr"], **style)
            low, high = (lowest * np.exp(sign * here["log_time_stderr"]) for sign in (-1, 1))
            time.errorbar(at, lowest, [lowest - low, high - lowest], **style)
    waits = np.unique(dips["waiting_time"])
    time.plot(waits, waits, ":", color="black", linewidth=1)
    time.annotate("equal", (waits[-1], waits[-1]), fontsize=8, ha="right", va="bottom")
    area.set(xscale="log", yscale="log", xlabel="time since the step", ylabel="area / area after the step")
    area.set_title(f"longest waiting time, load × {ratio:g}", fontsize=9)
    area.legend(fontsize=8)
    depth.set(xscale="log", xlabel="waiting time", ylabel="depth of the dip (%)")
    depth.set_title("filled: load × 0.2, open: × 0.5", fontsize=9)
    time.set(xscale="log", yscale="log", xlabel="waiting time", ylabel="time of the minimum")
    return figure


UNLOADING = Study(
    **WORDS.study,
    quick=campaigns(surfaces=8, side=32),
    full=campaigns(surfaces=64, side=32),
    analyse=analyse,
    draw=draw,
)
