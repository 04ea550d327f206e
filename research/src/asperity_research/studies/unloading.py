"""Whether the contact area falls before it rises, after the load has fallen.

A contact is held under a load for a waiting time; then the load falls at once to a part of it, and stays.
Lost contact is counted from the state just after the step, so that what the step itself takes does not count.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import product

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.fits import Estimate
from asperity_research.arrays import Field, Mask
from asperity_research.studies.campaigns import Campaign, hold, waves
from asperity_research.studies.evidence import Around, Evidence
from asperity_research.studies.ledger import Finding, estimate, proportion
from asperity_research.studies.numbers import mean, slope
from asperity_research.studies.study import Outcome, Study, Words
from asperity_research.style import panels

WORDS = Words.beside(__file__)
WAIT, LOAD = "protocol.0.duration", "protocol.1.load"
RATIOS = (0.2, 0.5)  # Load after the step over that before
SOLIDS = WORDS.solids  # By the names of their campaigns; k0 = 1 and E* = 1 set the unit of stiffness
SEPARABLE = ("half_space",)  # Those whose spectra are all proportional


def campaigns(*, surfaces: int, side: int) -> tuple[Campaign, ...]:
    """Return the campaigns, one for each solid: so many surfaces, of so many sites along a side."""
    planned = []
    for name, solid in SOLIDS.items():
        loads = [ratio * (solid.load * side**2) for ratio in RATIOS]
        campaign = solid.campaign(
            name,
            "Area after a fall of the load",
            waves(side, side / 2, rms_slope=1.0),
            aging={"first": 1e-2, "per_decade": 4, "rtol": 5e-3},
            protocol=[hold(solid.waits[0]), {"kind": "step", "load": loads[0]}, hold(1e4)],
            output={},
            sweep={WAIT: list(solid.waits), LOAD: loads, "seeds": surfaces},
        )
        planned.append(campaign)
    return tuple(planned)


def analyse(evidence: Evidence) -> Outcome:
    """Judge what is claimed of the area after a fall of the load."""
    dips, curves = [], []
    lost: dict[str, list[Mask]] = {name: [] for name in SOLIDS}  # where a surface loses contact
    times: dict[float, dict[float, Field]] = {ratio: {} for ratio in RATIOS}  # of minima, by ratio and wait
    relaxation = _relaxation_time(evidence["conserved"].attrs)
    for name in SOLIDS:
        data = evidence[name][["area", "time", "leg"]]
        for wait, (ratio, load) in product(data[WAIT].values, zip(RATIOS, data[LOAD].values, strict=True)):
            step = Around.step(data.sel({WAIT: wait, LOAD: load}))
            since, area = step.time, step.after
            depth = 1 - area.min(axis=1) / area[:, 0]  # lost area over that just after the step
            log_time = np.array([_log_of_minimum(since, each) for each in area])
            lost[name].append(depth > 0)
            if name == "conserved" and wait < relaxation:
                times[ratio][wait] = log_time
            log_time = log_time[np.isfinite(log_time)]
            deep, time = mean(depth), mean(log_time) if log_time.size else _UNKNOWN
            head = {"solid": name, "waiting_time": float(wait), "load_ratio": ratio}
            dip = head | {
                "surfaces": depth.size,
                "with_a_dip": int((depth > 0).sum()),
                "depth": float(deep.value),
                "depth_stderr": float(deep.stderr),
                "deepest": float(depth.max()),
                "time_of_minimum": float(np.exp(time.value)),
                "log_time_stderr": float(time.stderr),
                "area_after_step": float(area[:, 0].mean()),
            }
            relative = mean(area / area[:, :1])
            course = {"time": since, "area": relative.value, "area_stderr": relative.stderr}
            dips.append(dip)
            curves.append(pd.DataFrame(head | course))
    tables = {"dips": pd.DataFrame(dips), "curves": pd.concat(curves)}
    return Outcome(tuple(_findings(lost, times)), tables)


def _findings(
    lost: Mapping[str, list[Mask]], times: Mapping[float, Mapping[float, Field]]
) -> Iterator[Finding]:
    for key, separable in (("separable", True), ("any-linear-solid", False)):
        lose = {name: np.any(some, axis=0) for name, some in lost.items() if (name in SEPARABLE) is separable}
        shares = {SOLIDS[name].what: proportion(int(one.sum()), one.size) for name, one in lose.items()}
        yield WORDS.judge(key, shares)
    early = [*times[RATIOS[0]]]
    waits = f"waits from {early[0]:g} to {early[-1]:g}" if early else "no wait is short enough"
    which = f"{waits}: {SOLIDS['conserved'].what}"
    numbers = {f"{ratio:g}, {which}": _exponent(some) for ratio, some in times.items()}
    yield WORDS.judge("time-of-minimum", numbers)


_UNKNOWN = estimate(math.nan, math.nan, math.nan, math.nan, 0)


def _log_of_minimum(time: Field, area: Field) -> float:
    """Logarithm of the time of the minimum, in the middle where it lasts; NaN without a dip."""
    at = time[area == area.min()]
    return float(np.log(at[[0, -1]]).mean()) if at[0] > 0 else math.nan


def _relaxation_time(of: Mapping[str, float]) -> float:
    """Relaxation time of the longest waves of the surface on a lattice whose creep conserves the mean."""
    lam = (2 * np.pi / of["roll_off"]) ** 2
    return float((of["k0"] * lam + of["k1"]) / (of["R"] * of["k0"] * of["k1"] * lam**2))


def _exponent(times: Mapping[float, Field]) -> Estimate:
    """Slope of ln (time of the minimum) against ln (waiting time), surface by surface; their mean."""
    logs = np.array([*times.values()] or [np.empty(0)])
    logs = logs[:, np.isfinite(logs).all(axis=0)].T
    if len(times) < 2 or not len(logs):
        return replace(_UNKNOWN, runs=len(logs))
    return mean(np.array([slope(np.array([*times]), one) for one in logs]))


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw area after the step, depth of the dip and time of the minimum."""
    dips, curves = tables["dips"], tables["curves"]
    figure, (area, depth, time) = panels(5.4, 8.6, rows=3)
    ratio = min(RATIOS)
    for (name, solid), mark, shade in zip(SOLIDS.items(), "sD^o", ("0.6", "0.4", "0.2", "0.0"), strict=True):
        shown = (curves["waiting_time"] == solid.waits[-1]) & (curves["load_ratio"] == ratio)
        curve = curves[shown & (curves["time"] > 0) & (curves["solid"] == name)]
        line = "--" if name in SEPARABLE else "-"
        style = {"marker": mark, "color": shade, "markersize": 4, "linestyle": line}
        label = name.replace("_", "-")
        area.errorbar(curve["time"], curve["area"], curve["area_stderr"], label=label, **style)
        for part, fill in zip(RATIOS, (None, "white"), strict=True):
            selected = dips[(dips["solid"] == name) & (dips["load_ratio"] == part)]
            at, lowest = selected["waiting_time"], selected["time_of_minimum"]
            style["markerfacecolor"] = fill
            depth.errorbar(at, 100 * selected["depth"], 100 * selected["depth_stderr"], **style)
            low, high = (lowest * np.exp(sign * selected["log_time_stderr"]) for sign in (-1, 1))
            time.errorbar(at, lowest, [lowest - low, high - lowest], **style)
    waits = np.unique(dips["waiting_time"])
    time.plot(waits, waits, ":", color="black", linewidth=1)
    time.annotate("equal", (waits[-1], waits[-1]), fontsize=8, ha="right", va="bottom")
    WORDS.dress(area, depth, time)
    return figure


UNLOADING = Study(
    **WORDS.study,
    quick=campaigns(surfaces=8, side=32),
    full=campaigns(surfaces=64, side=32),
    analyse=analyse,
    draw=draw,
)
