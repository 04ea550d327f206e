r"""Study: slide, hold, slide: static friction against hold time, D_c, and steady friction against velocity.

By Tabor's relation with a constant shear strength, friction is in proportion to the real area of contact, so
that all is said of the area A, over that of steady sliding at the velocity 1, A_1. The rough surface slides
by whole sites under a body that keeps its crept shape. Rate-and-state friction with the aging law (J. H.
Dieterich, J. Geophys. Res. 84, 2161 (1979), DOI 10.1029/JB084iB05p02161) says without a direct effect

    at rest      A(t)/A_1 = 1 + b ln(1 + V t/D_c)
    steady       A(V)/A_1 = 1 - b ln(V)
    after a rest the excess of A falls by a factor e within a slip of D_c (if it is small).

A velocity V is a mobility of creep 1/V at the velocity 1, so that all runs have the same times.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from asperity.checks import Floats
from asperity.figures import style
from asperity.fits.resampling import jackknife
from asperity.studies.campaigns import Campaign
from asperity.studies.evidence import Evidence
from asperity.studies.ledger import Finding, Measurement
from asperity.studies.study import Outcome, Study

HOLDS = (1.0, 10.0, 100.0, 1e3, 1e4)
VELOCITIES = (0.01, 0.1, 1.0, 10.0, 100.0)
_SIDE = 64
_RUN_IN, _AGAIN = 24, 12
_STEADY = 8
"""Shifts at the end of a slide that count as steady."""

_ROLL_OFFS = (8.0, 16.0, 32.0)
_SOLID = {"k0": 1.0, "k1": 3.0, "R": 1.0}


def _campaign(name: str, purpose: str, protocol: list[dict[str, Any]], sweep: dict[str, Any]) -> Campaign:
    return Campaign(
        name,
        purpose,
        {
            "surface": {
                "kind": "spectral",
                "shape": [_SIDE, _SIDE],
                "hurst": 0.8,
                "roll_off": 16.0,
                "cutoff": 4.0,
                "rms_height": 1.0,
            },
            "solid": _SOLID,
            "contact": {"load": 0.05 * _SIDE**2},
            "friction": {"shear_strength": 1.0},
            "aging": {"first": 1.0, "per_decade": 1},
            "protocol": protocol,
            "output": {"maps_at": []},
            "sweep": sweep,
        },
    )


def _slide(distance: float) -> dict[str, Any]:
    return {"kind": "slide", "distance": float(distance), "velocity": 1.0}


def campaigns(seeds: int) -> tuple[Campaign, ...]:
    """Return the campaigns, with so many surfaces each."""
    holds = [leg for time in HOLDS for leg in ({"kind": "hold", "duration": time}, _slide(_AGAIN))]
    return (
        _campaign(
            "holds", "Slides with longer and longer rests", [_slide(_RUN_IN), *holds], {"seeds": seeds}
        ),
        _campaign(
            "velocities",
            "Steady sliding, with the inverse velocity as a factor on mobility",
            [_slide(_RUN_IN)],
            {"protocol.0.mobility": [1 / velocity for velocity in VELOCITIES], "seeds": seeds},
        ),
        _campaign(
            "lengths",
            "A rest and a slide on surfaces of several longest wavelengths",
            [_slide(_RUN_IN), {"kind": "hold", "duration": 100.0}, _slide(_RUN_IN)],
            {"roll_off": list(_ROLL_OFFS), "seeds": seeds},
        ),
    )


def before_shifts(one: xr.Dataset, leg: int) -> Floats:
    """Area in a slide at the end of each time between shifts, shape (shifts,)."""
    chosen = one["leg"].values == leg
    place, area = one["displacement"].values[chosen], one["area"].values[chosen]
    last = np.append(np.diff(place) > 0, True)
    return np.asarray(area[last & (place > 0)], dtype=np.float64)


def slip_of_memory(excess: Floats) -> float:
    """Slip over which an excess that falls exponentially loses a factor e, from its sum.

    Parameters
    ----------
    excess
        At slips of 0, 1, 2 and so on, shape (n,); the sum 1 + e^(-1/D) + ... is 1/(1 - e^(-1/D)).
    """
    total = float(np.sum(excess) / excess[0])
    return 1 / math.log(total / (total - 1)) if total > 1 else 0.0


def correlation_length(roll_off: float) -> float:
    """Distance at which the correlation of such heights has fallen to 1/e, in sites, by their spectrum."""
    from asperity.surfaces import spectral

    heights = spectral((512, 512), hurst=0.8, roll_off=roll_off, cutoff=4.0, rms_height=1.0, seed=0)
    row = np.fft.ifft(np.mean(np.abs(np.fft.fft(heights, axis=1)) ** 2, axis=0)).real
    falls = int(np.argmax(row < row[0] / math.e))
    high, low = row[falls - 1] / row[0], row[falls] / row[0]
    return float(falls - 1 + (high - 1 / math.e) / (high - low))


def analyse(evidence: Evidence) -> Outcome:
    """Find the growth at rest, the fall with velocity and the slip of memory."""
    holds, rests = evidence["holds"], []
    for seed in holds["seed"].values:
        one = holds.sel(seed=seed)
        steady = before_shifts(one, 0)[-_STEADY:].mean()
        ends = [one["area"].values[one["leg"].values == 1 + 2 * n][-1] for n in range(len(HOLDS))]
        rests.append(np.array(ends) / steady)
    rest = np.array(rests)
    velocities = evidence["velocities"]
    sliding = np.array(
        [
            [
                before_shifts(velocities.sel({"protocol.0.mobility": 1 / v, "seed": seed}), 0)[
                    -_STEADY:
                ].mean()
                for v in VELOCITIES
            ]
            for seed in velocities["seed"].values
        ]
    )
    sliding /= sliding[:, [VELOCITIES.index(1.0)]]
    decays = {value: _excesses(evidence["lengths"].sel(roll_off=value)) for value in _ROLL_OFFS}
    lengths = np.array([correlation_length(value) for value in _ROLL_OFFS])

    def slips(*excesses: Floats) -> Floats:
        return np.array([slip_of_memory(excess.mean(axis=0)) for excess in excesses])

    slip = jackknife(slips, tuple(decays.values()))
    exponent = jackknife(
        lambda *sample: np.polyfit(np.log(lengths), np.log(slips(*sample)), 1)[0], tuple(decays.values())
    )
    rate_rest = jackknife(lambda sample: _slope(HOLDS[1:], sample[:, 1:]), rest)
    rate_slide = jackknife(lambda sample: -_slope(VELOCITIES, sample), sliding)
    bend = jackknife(_bend, rest)
    same = jackknife(
        lambda at_rest, moving: -_slope(VELOCITIES, moving) / _slope(HOLDS[1:], at_rest[:, 1:]),
        (rest, sliding),
    )
    findings = (
        Finding(
            "logarithm",
            "Dieterich 1979",
            "Static friction grows with the logarithm of the hold time",
            (Measurement("growth in the last decade of hold time over that in the second", bend, 0.8, 1.25),),
            note=f"Per decade it grows by {float(rate_rest.value) * math.log(10):.2g} of steady friction.",
        ),
        Finding(
            "same_b",
            "Dieterich 1979",
            "Steady friction falls with velocity as static friction grows with hold time",
            (Measurement("b of steady sliding over b of rests", same, 0.8, 1.25),),
        ),
        Finding(
            "length",
            "Dieterich 1979",
            "The slip D_c that forgets a rest is in proportion to the correlation length",
            (Measurement("d ln <i>D</i><sub>c</sub> / d ln (correlation length)", exponent, 0.8, 1.2),),
        ),
    )
    rows = [
        *_rows("rest", "hold time", HOLDS, jackknife(lambda sample: sample.mean(axis=0), rest)),
        *_rows("steady", "velocity", VELOCITIES, jackknife(lambda sample: sample.mean(axis=0), sliding)),
        *_rows("slip", "correlation length", lengths, slip),
        *_rows("b", "from rests", [math.nan], rate_rest),
        *_rows("b", "from steady sliding", [math.nan], rate_slide),
    ]
    forgotten = [
        {"correlation_length": length, "slip": at, "excess": value}
        for length, excess in zip(lengths, decays.values(), strict=True)
        for at, value in enumerate(excess.mean(axis=0) / excess.mean(axis=0)[0])
    ]
    return Outcome(findings, {"points": pd.DataFrame(rows), "forgotten": pd.DataFrame(forgotten)})


def _slope(x: tuple[float, ...], samples: Floats) -> float:
    """Slope of the mean over surfaces against ln x."""
    return float(np.polyfit(np.log(x), samples.mean(axis=0), 1)[0])


def _bend(rest: Floats) -> float:
    mean = rest.mean(axis=0)
    return float((mean[-1] - mean[-2]) / (mean[2] - mean[1]))


def _excesses(runs: xr.Dataset) -> Floats:
    """Excess of area over that of steady sliding, after 0, 1, 2 and so on shifts from a rest, (seeds, n)."""
    rows = []
    for seed in runs["seed"].values:
        one = runs.sel(seed=seed)
        again = before_shifts(one, 2)
        rest = one["area"].values[one["leg"].values == 1][-1]
        rows.append(np.append(rest, again[:-_STEADY]) / again[-_STEADY:].mean() - 1)
    return np.array(rows)


def _rows(what: str, name: str, values: Any, found: Any) -> list[dict[str, object]]:
    parts = (np.atleast_1d(part) for part in (found.value, found.low, found.high))
    return [
        {"what": what, "of": name, "at": at, "value": value, "low": low, "high": high, "runs": found.runs}
        for at, value, low, high in zip(values, *parts, strict=True)
    ]


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw static and steady friction, and how a rest is forgotten."""
    figure = style.Drawing(figsize=(8.4, 3.0), layout="constrained")
    rest, steady, memory = figure.subplots(1, 3)
    points = tables["points"]
    for ax, what, label in (
        (rest, "rest", "hold time (sites / velocity 1)"),
        (steady, "steady", "velocity (sites / time)"),
    ):
        part = points[points["what"] == what]
        error = (part["value"] - part["low"], part["high"] - part["value"])
        ax.errorbar(
            part["at"], part["value"], yerr=error, fmt="o-", color=style.INK, markersize=4, linewidth=0.8
        )
        ax.set(xscale="log", xlabel=label, ylabel=r"friction over that steady at $V = 1$")
    for (length, part), look in zip(tables["forgotten"].groupby("correlation_length"), "os^", strict=True):
        memory.plot(
            part["slip"], part["excess"], f"{look}-", markersize=3, label=f"{length:.2g} sites", linewidth=0.8
        )
    memory.set(
        yscale="log", ylim=(5e-3, 1.5), xlabel="slip after the rest (sites)", ylabel="excess that is left"
    )
    memory.legend(title="correlation length", fontsize=7, title_fontsize=7)
    return figure


SLIDE_HOLD_SLIDE = Study(
    name="slide-hold-slide",
    question="How do static and steady friction depend on hold time, velocity and correlation length?",
    quick=campaigns(seeds=3),
    full=campaigns(seeds=5),
    analyse=analyse,
    draw=draw,
    caption="Friction by Tabor's relation. Left: at the end of a rest. Middle: in steady sliding "
    "against the velocity. Right: part of the excess that is left after a slip. Bars: 95 % intervals.",
    page="docs/studies/slide_hold_slide.md",
)
