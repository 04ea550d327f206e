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

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.figures import Drawing
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
from asperity_research.studies.study import Outcome, Study

MEASURED = load("pmma-2018")
SERIES = PronySeries(
    1e6 * MEASURED["modulus"],
    ((MEASURED["share_1"], MEASURED["time_1"]), (MEASURED["share_2"], MEASURED["time_2"])),
)
MODULUS = contact_modulus([SERIES.modulus] * 2, [MEASURED["poisson"]] * 2)
_RATIO = MEASURED["time_2"] / MEASURED["time_1"]
LONGER = (*SERIES.branches, *((MEASURED["share_2"], MEASURED["time_2"] * _RATIO**n) for n in (1, 2)))

SLOPE = 0.094
"""Rms slope with which the mean contact pressure 10 s after the start is that of 100 N on 2.58 mm^2."""

LIGHT = 0.003
"""Pressure over the contact modulus times the rms slope: about 0.7 % of the surface touches."""

_RAMP, _DROP, _END = MEASURED["ramp"], MEASURED["drop_at"], MEASURED["end"]
_TIMES = (_RAMP, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, _DROP)
_AFTER = (1.0, 10.0, 100.0, 1000.0, _END - _DROP)


_KEPT = (10.0, _DROP)
"""Times between which growth is measured."""

_NEXT = {
    "fit": "The relaxation of the very material, from a second on, would tell how much of the rest is its.",
    "longer": "The relaxation beyond 1000 s would decide, as would the area after the drop over days.",
    "eyring": "It needs contact pressures near the hardness: a map of the pressure, or areas at more loads.",
}
"""What to measure next."""

WHOLE = (0.9, 1.1)
"""Parts of the growth that bear out that it is explained."""

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


def _campaigns(surface: Tables, samples: Tables, slope: float = SLOPE) -> Iterator[Campaign]:
    """Campaigns on surfaces of a slope, sampled by a sweep."""
    pressure = LIGHT * MODULUS * slope
    half_space = {"kind": "half_space", "modulus": MODULUS}
    branches = {"fit": SERIES.branches, "longer": LONGER}
    rest = {"aging": {"times": [*_TIMES, *(_DROP + after for after in _AFTER)]}, "output": {"maps_at": []}}
    history = [
        {"kind": "ramp", "duration": _RAMP, "pressure": pressure},
        hold(_DROP - _RAMP),
        {"kind": "step", "pressure": pressure * MEASURED["load_after"] / MEASURED["load"]},
        hold(_END - _DROP),
    ]
    for name, words in HYPOTHESES.items():
        own = {"branches": [list(one) for one in branches[name]]} if name in branches else pmma.ACTIVATED
        tables: dict[str, Any] = {"surface": surface, "solid": half_space | own, "contact": {"load": 0.0}}
        tables |= {"protocol": history, **rest, "sweep": samples}
        yield Campaign(name, f"Ramp, hold, drop and hold of {words}", tables)
    loads = [float(pressure * effective()[_TIMES.index(time)]) for time in _KEPT]
    tables = {"surface": surface, "solid": half_space, "contact": {"pressure": loads[0]}}
    tables |= {"aging": {"times": [0.0]}, "output": {"maps_at": []}}
    sweep = {"contact.pressure": loads, **samples}
    yield Campaign("elastic", "An elastic half-space under the effective loads", tables | {"sweep": sweep})


def _made(side: int, surfaces: int) -> tuple[Campaign, ...]:
    """Campaigns on self-affine surfaces."""
    lengths = {"roll_off": side * 0.5 / 16, "cutoff": 6 * 0.5, "rms_slope": SLOPE}
    return tuple(_campaigns(scanned(side, 0.5, "um", 0.8, **lengths), {"seeds": surfaces}))


@dataclass(frozen=True, eq=False)
class History:
    """Areas of one solid, shape (surfaces, times), with times after the start and legs.

    Counted sites overestimate small contacts at their rims, and their growth the less the smaller they are.
    """

    time: Field
    leg: Field
    area: Field

    @classmethod
    def of(cls, evidence: Evidence, name: str) -> History:
        """Read it from its campaign."""
        data = evidence[name]
        return cls(data["time"].values, data["leg"].values, evidence.samples(name, "contact_area_corrected"))

    def at(self, time: float, leg: int) -> Field:
        """Areas at a time in a leg, shape (surfaces,)."""
        (place,) = np.flatnonzero(np.isclose(self.time, time) & (self.leg == leg))
        return self.area[:, place]


def over(found: Estimate, value: float, error: float) -> Estimate:
    """A number over one that was measured with a standard error; its interval has both errors."""
    part = float(found.value) / value
    half = math.hypot(float(found.high - found.low) / 2 / value, 1.96 * part * error / value)
    return estimate(part, half / 1.96, part - half, part + half, found.runs)


def _measured_ratio(series: str, time: float) -> tuple[float, float]:
    """A measured area over that after 10 s, and the standard error of that."""
    growth, data = (MEASURED.series[name] for name in ("growth", series))
    first, one = growth.sel(time=_KEPT[0]), data.sel(time=time)
    found = float(one["area"] / first["area"])
    return found, found * math.hypot(*(float(each["area_error"] / each["area"]) for each in (first, one)))


def analyse(evidence: Evidence) -> Outcome:
    """Compare growth, and the drop, of each hypothesis with what was measured."""
    histories = {name: History.of(evidence, name) for name in HYPOTHESES}
    rows: list[dict[str, Any]] = []
    for name, history in histories.items():
        start = history.at(_KEPT[0], 1)
        for time, leg, areas in zip(history.time, history.leg, history.area.T, strict=True):
            if time > 0:
                row = {"solid": name, "time": time, "leg": leg}
                rows.append(row | columns("area", ratio(areas, start), shared=True))
    pressed = evidence.samples("elastic", "contact_area_corrected")[..., 0]
    findings = tuple(_findings(histories, pressed))
    return Outcome(findings, {"areas": pd.DataFrame(rows), "measured": _measured()})


def _findings(histories: Mapping[str, History], pressed: Field) -> Iterator[Finding]:
    within, of, form = Finding.within, "Dillavou and Rubinstein 2018", "closed form"
    first, last = _KEPT
    growth = {name: ratio(one.at(last, 1), one.at(first, 1)) for name, one in histories.items()}
    claim = "The effective load grows by 1.1746 from 10 to 1000 s"
    numbers = {"(<i>J</i> * d<i>F</i>)(1000 s) over that at 10 s": exact(growth_of_effective_load())}
    yield within((1.1741, 1.1751), "effective", form, claim, numbers)
    claim = "At light load the area grows like the effective load"
    yield within((1.165, 1.185), "light", form, claim, {"<i>A</i>(1000 s)/<i>A</i>(10 s)": growth["fit"]})
    claim = "The area is that of an elastic solid at the effective load"
    numbers = {
        f"<i>A</i> over that of the elastic solid at {time:g} s": mean(histories["fit"].at(time, 1) / areas)
        for time, areas in zip(_KEPT, pressed.T, strict=True)
    }
    yield within((0.999, 1.001), "elastic", "Lee and Radok 1960", claim, numbers)
    grown, error = _measured_ratio("growth", last)
    explains = "part of the measured growth from 10 to 1000 s"
    measured = f"Measured: A(1000 s)/A(10 s) = {grown:.3f} with a standard error of {error:.3f}."
    for name, words in HYPOTHESES.items():
        one = growth[name]
        one = Estimate(one.value - 1, one.stderr, one.low - 1, one.high - 1, one.runs)
        claim, numbers = f"The growth of the area is that of {words}", {explains: over(one, grown - 1, error)}
        yield within(WHOLE, f"growth {name}", of, claim, numbers, f"{measured} {_NEXT[name]}")
    dropped, error = _measured_ratio("drop", _DROP + 1)
    ends = dropped - 2 * error, dropped + 2 * error
    for name, words in HYPOTHESES.items():
        claim = f"After the drop to a quarter of the load the area is that of {words}"
        found = ratio(histories[name].at(last, 2), histories[name].at(first, 1))
        numbers = {"<i>A</i> just after the drop, over <i>A</i>(10 s)": found}
        yield within(ends, f"drop {name}", of, claim, numbers)
    flatness = 0.015 / float(MEASURED.series["drop"]["area"][0])
    for name, words in HYPOTHESES.items():
        found = ratio(histories[name].at(_END, 3), histories[name].at(last, 2))
        claim, numbers = (
            f"It then stays as flat as that of {words}",
            {"<i>A</i> 4000 s later, over that": found},
        )
        yield within((1 - flatness, 1 + flatness), f"memory {name}", of, claim, numbers)


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
    figure = Drawing(figsize=(7.2, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    areas, measured = tables["areas"], tables["measured"]
    for name, words in HYPOTHESES.items():
        color, line = _LOOKS[name]
        own = areas[areas["solid"] == name]
        held, later = own[own["leg"] <= 1], own[own["leg"] >= 2]
        for ax, part, time in ((left, held, held["time"]), (right, later, later["time"] - _DROP + 1)):
            ax.plot(time, part["area"], line, color=color, linewidth=1.2, label=words.removeprefix("a "))
            ax.fill_between(time, part["low"], part["high"], color=color, alpha=0.15, linewidth=0)
    for ax, series, shift in ((left, "growth", 0.0), (right, "drop", _DROP - 1)):
        rows = measured[measured["series"] == series]
        style.points(
            ax, rows.assign(time=rows["time"] - shift), "time", "area", "o", style.VERMILION, label="measured"
        )
    left.set(xscale="log", xlabel="time since first contact, s", ylabel="area over that after 10 s")
    right.set(xscale="log", xlabel="time since the drop to a quarter + 1 s, s", ylim=(0.2, 0.4))
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8)
    return figure


PMMA_2018 = Study(
    name=MEASURED.name,
    question="How much of the growth of a contact of PMMA is the relaxation of its bulk?",
    quick=_made(256, 3),
    full=_made(512, 8),
    analyse=analyse,
    draw=draw,
    caption="Left: area under 100 N over that after 10 s; right: after the drop to 25 N. Lines: means over "
    "the surfaces of three solids, with 95 % intervals; points: measured, with the intervals of its reading.",
    page="docs/experiments.md",
)


def on_scans(scans: Tables, samples: Tables, slope: float) -> tuple[Campaign, ...]:
    """Campaigns on scans, whose rms slope sets the pressure."""
    return tuple(_campaigns(scans, samples, slope))
