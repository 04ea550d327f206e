r"""PMMA on PMMA (2018): how much of the growth of the imaged area is the relaxation of the bulk.

The load goes up in a ramp, stays for 1000 s, drops to a quarter and stays again. Three solids stand for the
material. Nothing is fitted to the areas, but the rms slope is such that the mean contact pressure is that of
the experiment, on which the ratios of areas of the first two do not depend.

* ``fit``: a separable half-space of the published relaxation. At light load its area goes like the effective
  load (J * dF)(t), see `asperity.relaxation.PronySeries.effective_load`.
* ``longer``: a hypothesis, a spectrum that goes on beyond the fit: two more branches of the share of its
  last, each as much later than the one before as its second is than its first.
* ``eyring``: a hypothesis, activated flow of each site, with the activation volume of PMMA and an energy with
  which a surface of a hardness of 0.4 GPa sinks by 1 nm/s (`asperity_research.studies.pmma`), in series with
  the modulus at once.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.fits import Estimate
from asperity.relaxation import PronySeries
from asperity.solids import contact_modulus
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.experiments.record import load
from asperity_research.studies import pmma
from asperity_research.studies.campaigns import Campaign, Tables, hold, scanned
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding, estimate, exact
from asperity_research.studies.numbers import columns, mean, ratio
from asperity_research.studies.study import Outcome, Study, Words

WORDS, MEASURED = Words.beside(__file__), load("pmma-2018")
SERIES = PronySeries(
    1e6 * MEASURED["modulus"],
    ((MEASURED["share_1"], MEASURED["time_1"]), (MEASURED["share_2"], MEASURED["time_2"])),
)
MODULUS = contact_modulus([SERIES.modulus] * 2, [MEASURED["poisson"]] * 2)
_RATIO = MEASURED["time_2"] / MEASURED["time_1"]
LONGER = (*SERIES.branches, *((MEASURED["share_2"], MEASURED["time_2"] * _RATIO**n) for n in (1, 2)))

SLOPE = 0.094
"""Rms slope with which the mean contact pressure 10 s after the start is that of 100 N on 2.58 mm^2."""

LIGHT = 0.003  # Pressure over the contact modulus times the rms slope: about 0.7 % of the surface touches
_RAMP, _DROP, _END = MEASURED["ramp"], MEASURED["drop_at"], MEASURED["end"]
_TIMES = (_RAMP, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, _DROP)
_AFTER = (1.0, 10.0, 100.0, 1000.0, _END - _DROP)
_KEPT = (10.0, _DROP)  # Times between which growth is measured
_AREA = "contact_area_corrected"
"""Counted sites overestimate small contacts at their rims, and their growth the less the smaller they are."""

HYPOTHESES = {
    "fit": "a separable half-space of the published relaxation",
    "longer": "the same with a spectrum that goes on beyond the fit",
    "eyring": "activated flow with the activation volume of PMMA",
}


def effective() -> Field:
    """Effective load at the times up to the drop, over the load, shape (n,)."""
    times = np.array([0.0, *_TIMES])
    return SERIES.effective_load(times, np.minimum(times / _RAMP, 1.0))[1:]


def growth_of_effective_load() -> float:
    """How much it grows between the times between which growth is measured."""
    first, last = (effective()[_TIMES.index(time)] for time in _KEPT)
    return float(last / first)


def campaigns(surface: Tables, samples: Tables, slope: float = SLOPE) -> tuple[Campaign, ...]:
    """Return the campaigns on surfaces of an rms slope, which sets the pressure, sampled by a sweep."""
    pressure = LIGHT * MODULUS * slope
    half_space: dict[str, Any] = {"kind": "half_space", "modulus": MODULUS}
    branches = {"fit": SERIES.branches, "longer": LONGER}
    history = [
        {"kind": "ramp", "duration": _RAMP, "pressure": pressure},
        hold(_DROP - _RAMP),
        {"kind": "step", "pressure": pressure * MEASURED["load_after"] / MEASURED["load"]},
        hold(_END - _DROP),
    ]
    campaigns_made = []
    for name, words in HYPOTHESES.items():
        creep = {"branches": [list(one) for one in branches[name]]} if name in branches else pmma.ACTIVATED
        tables: dict[str, Any] = {
            "surface": surface,
            "solid": half_space | creep,
            "contact": {"load": 0.0},
            "protocol": history,
            "aging": {"times": [*_TIMES, *(_DROP + after for after in _AFTER)]},
            "output": {"maps_at": []},
            "sweep": samples,
        }
        campaigns_made.append(Campaign(name, f"Ramp, hold, drop and hold of {words}", tables))
    loads = [float(pressure * effective()[_TIMES.index(time)]) for time in _KEPT]
    tables = {
        "surface": surface,
        "solid": half_space,
        "contact": {"pressure": loads[0]},
        "aging": {"times": [0.0]},
        "output": {"maps_at": []},
        "sweep": {"contact.pressure": loads, **samples},
    }
    return (*campaigns_made, Campaign("elastic", "An elastic half-space under the effective loads", tables))


def _made(side: int, surfaces: int) -> tuple[Campaign, ...]:
    """Campaigns on self-affine surfaces."""
    lengths = {"roll_off": side * 0.5 / 16, "cutoff": 6 * 0.5, "rms_slope": SLOPE}
    return campaigns(scanned(side, 0.5, "um", 0.8, **lengths), {"seeds": surfaces})


def over(found: Estimate, value: float, error: float) -> Estimate:
    """A number over one that was measured with a standard error; its interval has both errors."""
    part = float(found.value) / value
    half = math.hypot(float(found.high - found.low) / 2 / value, 1.96 * part * error / value)
    return estimate(part, half / 1.96, part - half, part + half, found.runs)


def _measured_ratio(series: str, time: float) -> tuple[float, float]:
    """A measured area over that after 10 s, and the standard error of that."""
    growth, data = (MEASURED.series[name] for name in ("growth", series))
    first, later = growth.sel(time=_KEPT[0]), data.sel(time=time)
    ratio = float(later["area"] / first["area"])
    return ratio, ratio * math.hypot(*(float(each["area_error"] / each["area"]) for each in (first, later)))


def analyse(evidence: Evidence) -> Outcome:
    """Compare growth, and the drop, of each hypothesis with what was measured."""
    rows = []
    for name in HYPOTHESES:
        start, data = _at(evidence, name, _KEPT[0], 1), evidence[name]
        each = zip(data["time"].values, data["leg"].values, evidence.samples(name, _AREA).T, strict=True)
        for time, leg, areas in each:
            if time > 0:
                row = {"solid": name, "time": time, "leg": leg}
                rows.append(row | columns("area", ratio(areas, start), shared=True))
    return Outcome(tuple(_findings(evidence)), {"areas": pd.DataFrame(rows), "measured": _measured()})


def _at(evidence: Evidence, name: str, time: float, leg: int) -> Field:
    """Areas of a solid at a time in a leg, shape (surfaces,)."""
    data = evidence[name]
    (place,) = np.flatnonzero(np.isclose(data["time"].values, time) & (data["leg"].values == leg))
    return evidence.samples(name, _AREA)[:, place]


def _findings(evidence: Evidence) -> Iterator[Finding]:
    def over_that(name: str, at: tuple[float, int], first: tuple[float, int]) -> Estimate:
        return ratio(_at(evidence, name, *at), _at(evidence, name, *first))

    start, end, fallen = (_KEPT[0], 1), (_KEPT[1], 1), (_KEPT[1], 2)
    growth = {name: over_that(name, end, start) for name in HYPOTHESES}
    yield WORDS.judge("effective", exact(growth_of_effective_load()))
    yield WORDS.judge("light", growth["fit"])
    pressed = evidence.samples("elastic", _AREA)[..., 0]
    times = zip(_KEPT, pressed.T, strict=True)
    numbers = {f"{time:g}": mean(_at(evidence, "fit", time, 1) / areas) for time, areas in times}
    yield WORDS.judge("elastic", numbers)
    grown, error = _measured_ratio("growth", _DROP)
    for name, words in HYPOTHESES.items():
        estimate = growth[name]
        estimate = Estimate(
            estimate.value - 1, estimate.stderr, estimate.low - 1, estimate.high - 1, estimate.runs
        )
        part = over(estimate, grown - 1, error)
        yield WORDS.judge("growth", part, key=f"growth {name}", words=words, grown=grown, error=error)
    dropped, error = _measured_ratio("drop", _DROP + 1)
    flatness = 0.015 / float(MEASURED.series["drop"]["area"][0])
    for claim, (middle, half), moments in (
        ("drop", (dropped, 2 * error), (fallen, start)),
        ("memory", (1.0, flatness), ((_END, 3), fallen)),
    ):
        for name, words in HYPOTHESES.items():
            kept, ends = over_that(name, *moments), (middle - half, middle + half)
            yield WORDS.judge(claim, kept, key=f"{claim} {name}", ends=ends, words=words)


def _measured() -> pd.DataFrame:
    """Measured ratios, with 95 % intervals."""
    rows = []
    for series in ("growth", "drop"):
        for time in MEASURED.series[series]["time"].values.tolist():
            area, error = _measured_ratio(series, time)
            ends = {"low": area - 1.96 * error, "high": area + 1.96 * error}
            rows.append({"series": series, "time": time, "area": area, **ends})
    return pd.DataFrame(rows)


_LOOKS = {"fit": (style.INK, "-"), "longer": (style.BLUE, "--"), "eyring": (style.GRAY, ":")}


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw growth under the load, and the area after the drop, beside what was measured."""
    figure, (upper, lower) = style.panels(5.4, 7.0, rows=2)
    areas, measured = tables["areas"], tables["measured"]
    for name, words in HYPOTHESES.items():
        color, line = _LOOKS[name]
        curve = areas[areas["solid"] == name]
        held, later = curve[curve["leg"] <= 1], curve[curve["leg"] >= 2]
        for ax, part, time in ((upper, held, held["time"]), (lower, later, later["time"] - _DROP + 1)):
            ax.plot(time, part["area"], line, color=color, linewidth=1.2, label=words.removeprefix("a "))
            ax.fill_between(time, part["low"], part["high"], color=color, alpha=0.15, linewidth=0)
    for ax, series, shift in ((upper, "growth", 0.0), (lower, "drop", _DROP - 1)):
        rows = measured[measured["series"] == series]
        style.points(
            ax, rows.assign(time=rows["time"] - shift), "time", "area", "o", style.VERMILION, label="measured"
        )
    WORDS.dress(upper, lower)
    figure.legend(*upper.get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8)
    return figure


PMMA_2018 = Study(**WORDS.study, quick=_made(256, 3), full=_made(512, 8), analyse=analyse, draw=draw)
