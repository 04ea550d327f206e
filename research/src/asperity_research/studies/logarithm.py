r"""Study: which relaxation makes the contact of a rough half-space grow like the logarithm of time.

The stiffness of a half-space is E* abs(q)/2. If all of it relaxes alike, with the creep compliance J(t),
J(0) = 1, the contact under a constant load F is the elastic one under the load J(t) F (E. H. Lee and J. R. M.
Radok, J. Appl. Mech. 27, 438 (1960), DOI 10.1115/1.3644020). With the elastic area A_e(F),

    A(t)/A(0) = A_e(J(t) F)/A_e(F),        B = d (A/A(0))/d ln t,    n = d ln A_e/d ln F.

So the area grows like ln t if J does, while A_e is near proportional to F. One relaxation time gives an
exponential approach to a limit. Equal parts of compliance in each decade give J = 1 + j log10(t/t_0),
and B near n j/ln 10. Equal parts g of the modulus give J near 1/(1 - g log10(t/t_0)), which bends up.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.fits import Estimate, jackknife
from asperity.relaxation import PronySeries, from_retardation
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, Solid, hold, waves
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding
from asperity_research.studies.numbers import columns, power, slope
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)
SIDE = 128

# Loads over E* and nominal area; and those of the curve of the elastic area, over that which is kept.
_PRESSURE, _PRESSURES = 0.01, (0.0025, 0.01, 0.04)
_FACTORS = (1.0, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0, 2.5)

_TIMES = tuple(10.0**decade for decade in range(9))
_FIRST, _LAST, _END_DECADES = 10.0, 1e7, 2
"""The decades of time in which growth is judged; and how many of them, at each end, are compared."""

WANTED = 0.01  # B that is looked for


@dataclass(frozen=True)
class Relaxing:
    """A relaxation in words, its branches, and the share of a decade of time; NaN if there is none."""

    what: str
    series: PronySeries
    share: float = math.nan


def equal_compliance(share: float, times: tuple[float, ...] = _TIMES) -> PronySeries:
    """J = 1 + a share at every one of the retardation times."""
    return from_retardation(1.0, [(share, time) for time in times])


def equal_modulus(share: float) -> PronySeries:
    """E = 1 less a share at every one of the relaxation times."""
    return PronySeries(1.0, tuple((share, time) for time in _TIMES))


_SHARES = {"modulus": (0.01, 0.02, 0.05), "compliance": (0.01, 0.02, 0.03, 0.1)}
RELAXATIONS = {
    "one_time": Relaxing("one relaxation time, 30, of share 0.2", PronySeries(1.0, ((0.2, 30.0),))),
    "power": Relaxing(
        "parts of compliance that rise like the power 0.1 of their time",
        from_retardation(1.0, [(0.01 * time**0.1, time) for time in _TIMES]),
    ),
    **{
        f"{kind}_{share:g}": Relaxing(words.format(share), series(share), share)
        for kind, words, series in (
            ("modulus", "{:g} of the modulus in each decade", equal_modulus),
            ("compliance", "compliance grows by {:g} in each decade", equal_compliance),
        )
        for share in _SHARES[kind]
    },
}
_OF_LOADS = "compliance_0.03"


def _campaigns(seeds: int) -> Iterator[Campaign]:
    def campaign(
        name: str, purpose: str, relaxing: Relaxing, duration: float = _LAST, **sweep: object
    ) -> Campaign:
        branches = [list(solid) for solid in relaxing.series.branches]
        half_space = {"kind": "half_space", "modulus": 1.0, "branches": branches}
        return Solid(relaxing.what, half_space, _PRESSURE).campaign(
            name,
            purpose,
            waves(SIDE, SIDE / 2, rms_slope=0.2),
            aging={"first": 1.0, "per_decade": 4, "rtol": 5e-3},
            protocol=[hold(duration)],
            sweep={**sweep, "seeds": seeds},
        )

    for name, relaxing in RELAXATIONS.items():
        yield campaign(name, "Growth under a constant load", relaxing)
    solid = RELAXATIONS[_OF_LOADS]
    loads = [SIDE**2 * pressure for pressure in _PRESSURES]
    yield campaign("loads", "Growth under other loads", solid, load=loads)
    loads = [SIDE**2 * _PRESSURE * factor for factor in _FACTORS]
    yield campaign("elastic", "Area against load, before anything has relaxed", solid, 1.0, load=loads)


def rate(time: Field, growth: Field, first: float = _FIRST, last: float = _LAST) -> float:
    """B between two times: of the mean growth A/A(0), shape (runs, times)."""
    return slope(time, growth.mean(axis=0), first, last)


def straightness(time: Field, growth: Field) -> float:
    """B in the last two of the decades over that in the first two; 1 for a logarithm."""
    decades = 10.0**_END_DECADES
    return rate(time, growth, _LAST / decades) / rate(time, growth, last=_FIRST * decades)


def share_for(shares: Field, slopes: Field, wanted: float = WANTED) -> float:
    """Share a decade at which B has a value: ln B linear in ln share between neighbors, both increasing."""
    return float(np.exp(np.interp(math.log(wanted), np.log(slopes), np.log(shares))))


def predicted(loads: Field, areas: Field, series: PronySeries, time: Field) -> Field:
    """A/A(0), shape (runs, times), from the curve of the elastic area against load.

    Loads over that which is kept, increasing from 1, shape (n,), and elastic areas at them, shape (runs, n);
    ln A is linear in ln F between them.
    """
    at = np.log(series.compliance_at(time))
    ratios = np.log(areas / areas[:, :1])
    return np.exp([np.interp(at, np.log(loads), one) for one in ratios])


def analyse(evidence: Evidence) -> Outcome:
    """Find B and the straightness of all relaxations, and the share for a given B."""
    loads, areas = np.array(evidence.values("elastic", "load")), evidence.samples("elastic", "area")[..., 0]
    time = np.array(evidence.values("loads", "time"))
    rows: list[dict[str, Any]] = []
    estimates: dict[tuple[str, str], Estimate] = {}
    curves, grown = [], {}
    of_time = partial(rate, time)

    def growth_in(name: str, **where: float) -> Field:
        area = evidence.samples(name.replace(".", "_"), "area", **where)
        return area / area[:, :1]

    def over(first: Field, second: Field) -> float:
        return of_time(first) / of_time(second)

    def noted(
        number: str, relaxation: str, at: float, statistic: Callable[..., float], *samples: Field
    ) -> None:
        measured = estimates[number, relaxation] = jackknife(statistic, samples)
        row = {"number": number, "relaxation": relaxation, "at": at}
        rows.append(row | columns("value", measured, shared=True) | {"runs": measured.runs})

    for name, relaxing in RELAXATIONS.items():
        growth = grown[name] = growth_in(name)
        forecast = predicted(loads / loads[0], areas, relaxing.series, time)
        noted("straightness", name, relaxing.share, partial(straightness, time), growth)
        noted("B", name, relaxing.share, of_time, growth)
        if not math.isnan(relaxing.share):
            noted("B over prediction", name, relaxing.share, over, growth, forecast)
        course = {"relaxation": name, "time": time, "growth": growth.mean(axis=0)}
        course |= {"predicted": forecast.mean(axis=0), "compliance": relaxing.series.compliance_at(time)}
        curves.append(pd.DataFrame(course))
    for kind in ("compliance", "modulus"):
        shares = _SHARES[kind]

        def share_of(*samples: Field, shares: tuple[float, ...] = shares) -> float:
            return share_for(np.array(shares), np.array([of_time(sample) for sample in samples]))

        noted("share for B = 0.01", kind, WANTED, share_of, *(grown[f"{kind}_{share:g}"] for share in shares))
    near = loads <= 2.001 * loads[0]
    noted(
        "d ln A/d ln F",
        "elastic",
        _PRESSURE,
        lambda some: power(loads[near], some.mean(axis=0)),
        areas[:, near],
    )
    by_load = [growth_in("loads", load=load) for load in evidence.values("loads", "load")]
    for pressure, growth in zip(_PRESSURES, by_load, strict=True):
        noted("B of a load", _OF_LOADS, pressure, of_time, growth)
    findings = tuple(_findings(estimates, jackknife(over, (by_load[-1], by_load[0]))))
    return Outcome(findings, {"numbers": pd.DataFrame(rows), "curves": pd.concat(curves, ignore_index=True)})


def _findings(found: Mapping[tuple[str, str], Estimate], of_loads: Estimate) -> Iterator[Finding]:
    def of(number: str, start: str = "") -> dict[str, Estimate]:
        selected = {
            name: one for (kind, name), one in found.items() if kind == number and name.startswith(start)
        }
        return {RELAXATIONS[name].what: one for name, one in selected.items()}

    for key, words in (
        ("one_time", "one relaxation time"),
        ("power", "a compliance like a power of time"),
        ("modulus", "equal parts of the modulus in each decade"),
        ("compliance", "equal parts of compliance in each decade"),
    ):
        yield WORDS.judge("straight", of("straightness", key), key=key, words=words)
    ends = [factor * (math.log(10) * WANTED) for factor in (0.8, 1.2)]
    numbers = {kind: found["share for B = 0.01", kind] for kind in ("compliance", "modulus")}
    yield WORDS.judge("share", numbers, ends=ends)
    yield WORDS.judge("prediction", of("B over prediction"))
    yield WORDS.judge("load", {RELAXATIONS[_OF_LOADS].what: of_loads})


_LOOKS = {
    "one_time": ("one time", "^", style.SKY),
    "power": ("power", "v", style.VERMILION),
    "modulus_0.05": ("modulus, 0.05", "s", style.BLUE),
    "compliance_0.1": ("compliance, 0.1", "o", style.INK),
    "compliance_0.03": ("compliance, 0.03", "D", style.INK),
}
_KINDS = {"compliance": ("o", style.INK, "compliance"), "modulus": ("s", style.BLUE, "modulus")}


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw growth against time, and B against the part that relaxes in a decade."""
    figure, (upper, lower) = style.panels(5.4, 6.6, rows=2)
    curves, numbers = tables["curves"], tables["numbers"]
    for name, (words, mark, color) in _LOOKS.items():
        curve = curves[(curves["relaxation"] == name) & (curves["time"] > 0)]
        upper.plot(curve["time"], curve["growth"], mark, color=color, markersize=3, label=words)
        upper.plot(curve["time"], curve["predicted"], "-", color=color, linewidth=0.8)
    rates = numbers[numbers["number"] == "B"]
    rates = rates.assign(kind=rates["relaxation"].str.partition("_")[0])
    style.families(lower, rates, "kind", "at", "value", _KINDS, linewidth=None)
    shares = np.geomspace(0.008, 0.12, 20)
    lower.plot(shares, shares / math.log(10), ":", color="0.5", label=r"that part$\,/\ln 10$")
    lower.axhline(WANTED, color="0.7", linewidth=0.8)
    WORDS.dress(upper, lower)
    return figure


LOGARITHM = Study(
    **WORDS.study, quick=tuple(_campaigns(4)), full=tuple(_campaigns(16)), analyse=analyse, draw=draw
)
