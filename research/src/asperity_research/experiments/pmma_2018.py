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
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.figures import Drawing
from asperity.fits import Estimate, jackknife
from asperity.relaxation import PronySeries
from asperity.solids import contact_modulus
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.experiments.library import load
from asperity_research.studies import pmma
from asperity_research.studies.campaigns import Campaign, Tables, hold
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding, exact
from asperity_research.studies.numbers import mean
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
    activated = {
        **{"creep": "eyring", "creep_energy": pmma.energy(4e8), "creep_volume": float(f"{pmma.VOLUME:.4g}")},
        **{"creep_prefactor": pmma.PREFACTOR, "temperature": pmma.ROOM},
    }
    branches = {"fit": SERIES.branches, "longer": LONGER}
    rest = {"aging": {"times": [*_TIMES, *(_DROP + after for after in _AFTER)]}, "output": {"maps_at": []}}
    history = [
        {"kind": "ramp", "duration": _RAMP, "pressure": pressure},
        hold(_DROP - _RAMP),
        {"kind": "step", "pressure": pressure * MEASURED["load_after"] / MEASURED["load"]},
        hold(_END - _DROP),
    ]
    for name, words in HYPOTHESES.items():
        solid = half_space | (
            {"branches": [list(one) for one in branches[name]]} if name in branches else activated
        )
        tables = {"surface": surface, "solid": solid, "contact": {"load": 0.0}, "protocol": history, **rest}
        yield Campaign(name, f"Ramp, hold, drop and hold of {words}", tables | {"sweep": samples})
    loads = [float(pressure * effective()[_TIMES.index(time)]) for time in _KEPT]
    tables = {"surface": surface, "solid": half_space, "contact": {"pressure": loads[0]}}
    tables |= {"aging": {"times": [0.0]}, "output": {"maps_at": []}}
    sweep = {"contact.pressure": loads, **samples}
    yield Campaign("elastic", "An elastic half-space under the effective loads", tables | {"sweep": sweep})


def _made(side: int, surfaces: int) -> tuple[Campaign, ...]:
    """Campaigns on self-affine surfaces."""
    spacing = 0.5
    surface = {
        **{"kind": "spectral", "shape": [side, side], "spacing": [spacing], "unit": "um", "hurst": 0.8},
        **{"roll_off": side * spacing / 16, "cutoff": 6 * spacing, "rms_slope": SLOPE},
    }
    return tuple(_campaigns(surface, {"seeds": surfaces}))


def _history(evidence: Evidence, name: str) -> tuple[Field, Field, Field]:
    """Times after the start, legs, and areas, shape (surfaces, times).

    Counted sites overestimate small contacts at their rims, and their growth the less the smaller they are.
    """
    data = evidence[name]
    return data["time"].values, data["leg"].values, evidence.samples(name, "contact_area_corrected")


def _at(history: tuple[Field, Field, Field], time: float, leg: int) -> Field:
    """Areas at a time in a leg, shape (surfaces,)."""
    times, legs, areas = history
    (place,) = np.flatnonzero(np.isclose(times, time) & (legs == leg))
    return areas[:, place]


def over(found: Estimate, value: float, error: float) -> Estimate:
    """A number over one that was measured with a standard error; its interval has both errors."""
    ratio = float(found.value) / value
    half = math.hypot(float(found.high - found.low) / 2 / value, 1.96 * ratio * error / value)
    numbers = (ratio, half / 1.96, ratio - half, ratio + half)
    part, stderr, low, high = (np.asarray(one, dtype=np.float64)[()] for one in numbers)
    return Estimate(part, stderr, low, high, found.runs)


def _ratio(series: str, time: float) -> tuple[float, float]:
    """A measured area over that after 10 s, and the standard error of that."""
    growth, data = (MEASURED.series[name] for name in ("growth", series))
    first, one = growth.sel(time=_KEPT[0]), data.sel(time=time)
    ratio = float(one["area"] / first["area"])
    parts = [float(each["area_error"] / each["area"]) for each in (first, one)]
    return ratio, ratio * math.hypot(*parts)


def analyse(evidence: Evidence) -> Outcome:
    """Compare growth, and the drop, of each hypothesis with what was measured."""
    first, last = _KEPT
    grown, error = _ratio("growth", last)
    dropped, drop_error = _ratio("drop", _DROP + 1)
    histories = {name: _history(evidence, name) for name in HYPOTHESES}
    growth, shares, drops, stays = {}, {}, {}, {}
    rows: list[dict[str, Any]] = []
    for name, history in histories.items():
        start = _at(history, first, 1)
        growth[name] = jackknife(lambda a, b: b.mean() / a.mean(), (start, _at(history, last, 1)))
        shares[name] = over(_less_one(growth[name]), grown - 1, error)
        drops[name] = jackknife(lambda a, b: b.mean() / a.mean(), (start, _at(history, last, 2)))
        stays[name] = jackknife(
            lambda a, b: b.mean() / a.mean(), (_at(history, last, 2), _at(history, _END, 3))
        )
        for time, leg, areas in zip(history[0], history[1], history[2].T, strict=True):
            if time > 0:
                each = jackknife(lambda a, b: b.mean() / a.mean(), (start, areas))
                row = {"solid": name, "time": time, "leg": leg, "area": each.value}
                rows.append(row | {"low": each.low, "high": each.high})
    pressed = evidence.samples("elastic", "contact_area_corrected")[..., 0]
    equal = {
        f"<i>A</i> over that of the elastic solid at {time:g} s": mean(_at(histories["fit"], time, 1) / areas)
        for time, areas in zip(_KEPT, pressed.T, strict=True)
    }
    explains = "part of the measured growth from 10 to 1000 s"
    after = "<i>A</i> just after the drop, over <i>A</i>(10 s)"
    flat = "<i>A</i> 4000 s later, over that"
    flatness = 0.015 / float(MEASURED.series["drop"]["area"][0])
    within = Finding.within
    findings = (
        within(
            (1.1741, 1.1751),
            "effective",
            "closed form",
            "The effective load grows by 1.1746 from 10 to 1000 s",
            {"(<i>J</i> * d<i>F</i>)(1000 s) over that at 10 s": exact(growth_of_effective_load())},
        ),
        within(
            (1.165, 1.185),
            "light",
            "closed form",
            "At light load the area grows like the effective load",
            {"<i>A</i>(1000 s)/<i>A</i>(10 s)": growth["fit"]},
        ),
        within(
            (0.999, 1.001),
            "elastic",
            "Lee and Radok 1960",
            "The area is that of an elastic solid at the effective load",
            equal,
        ),
        *(
            within(
                WHOLE,
                f"growth {name}",
                "Dillavou and Rubinstein 2018",
                f"The growth of the area is that of {words}",
                {explains: shares[name]},
                note=f"Measured: A(1000 s)/A(10 s) = {grown:.3f} with a standard error of {error:.3f}. "
                + _NEXT[name],
            )
            for name, words in HYPOTHESES.items()
        ),
        *(
            within(
                (dropped - 2 * drop_error, dropped + 2 * drop_error),
                f"drop {name}",
                "Dillavou and Rubinstein 2018",
                f"After the drop to a quarter of the load the area is that of {words}",
                {after: drops[name]},
            )
            for name, words in HYPOTHESES.items()
        ),
        *(
            within(
                (1 - flatness, 1 + flatness),
                f"memory {name}",
                "Dillavou and Rubinstein 2018",
                f"It then stays as flat as that of {words}",
                {flat: stays[name]},
            )
            for name, words in HYPOTHESES.items()
        ),
    )
    return Outcome(findings, {"areas": pd.DataFrame(rows), "measured": _measured()})


def _less_one(found: Estimate) -> Estimate:
    return Estimate(found.value - 1, found.stderr, found.low - 1, found.high - 1, found.runs)


def _measured() -> pd.DataFrame:
    """Measured ratios, with 95 % intervals."""
    rows = []
    for series in ("growth", "drop"):
        for time in MEASURED.series[series]["time"].values.tolist():
            ratio, error = _ratio(series, time)
            rows.append(
                {
                    "series": series,
                    "time": time,
                    "area": ratio,
                    "low": ratio - 1.96 * error,
                    "high": ratio + 1.96 * error,
                }
            )
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
