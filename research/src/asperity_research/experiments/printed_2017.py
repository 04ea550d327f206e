"""The printed Contact Mechanics Challenge (2017): what the thickness of the soft layer changes.

The print is pressed on a layer that is thinner than the print's longest waves, so that a half-space errs
there. The surface is one of the same statistics, not the same surface: self-affine waves from the print's
roll-off down to eight sites, with its rms slope. It is periodic, where the print ends.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.fits import Estimate
from asperity.solids import contact_modulus
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.experiments.record import load
from asperity_research.studies.campaigns import Campaign, Tables, scanned
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding
from asperity_research.studies.numbers import all_columns, mean, mean_of, ratio
from asperity_research.studies.study import Outcome, Study, Words

WORDS, MEASURED = Words.beside(__file__), load("printed-2017")

YOUNG, POISSON = 1e6, 0.495
"""Pa, of which areas under a pressure over it do not depend; rubber hardly changes its volume: assumed."""

GAPS_AT = 0.164  # Pressure, over Young's modulus, at which gaps were compared with simulations
_MEASURED_AT = np.geomspace(MEASURED["least_pressure"], MEASURED["greatest_pressure"], 10).tolist()
PRESSURES = tuple(sorted([0.0005, GAPS_AT, *_MEASURED_AT]))  # Over Young's modulus
SOLIDS = {"half_space": "a half-space", "layer": "the layer, bonded to a rigid base"}


def campaigns(surface: Tables, samples: Tables, _slope: float = 0.0) -> tuple[Campaign, ...]:
    """Return the campaigns on surfaces that are sampled by a sweep; the pressures are those of the print."""
    layer = {"young": [YOUNG], "poisson": [POISSON], "thickness": 1e-3 * MEASURED["thickness"]}
    solids: dict[str, dict[str, Any]] = {
        "half_space": {"modulus": contact_modulus(YOUNG, POISSON)},
        "layer": layer,
    }
    tables: dict[str, Any] = {
        "surface": surface,
        "solid": {},
        "contact": {"pressure": YOUNG * PRESSURES[0]},
        "aging": {"times": [0.0]},
        "output": {"maps_at": []},
        "sweep": {"contact.pressure": [YOUNG * pressure for pressure in PRESSURES], **samples},
    }
    return tuple(
        Campaign(
            kind, f"Area against pressure on {SOLIDS[kind]}", tables | {"solid": {"kind": kind, **table}}
        )
        for kind, table in solids.items()
    )


def _made(side: int, surfaces: int) -> tuple[Campaign, ...]:
    spacing = MEASURED["side"] / side
    waves = {"roll_off": MEASURED["roll_off"], "cutoff": 8 * spacing, "rms_slope": MEASURED["rms_slope"]}
    return campaigns(scanned(side, spacing, "mm", MEASURED["hurst"], **waves), {"seeds": surfaces})


def analyse(evidence: Evidence) -> Outcome:
    """Compare areas on the layer and on the half-space, and at the ends with what was measured."""
    nominal = (1e-3 * MEASURED["side"]) ** 2
    areas = {kind: evidence.samples(kind, "contact_area_corrected")[..., 0] / nominal for kind in SOLIDS}
    rows, ratios = [], []
    for pressure, layer, half_space in zip(PRESSURES, areas["layer"].T, areas["half_space"].T, strict=True):
        ratios.append(ratio(layer, half_space))
        numbers = all_columns(layer=mean(layer), half_space=mean(half_space), ratio=ratios[-1])
        rows.append({"pressure": pressure} | numbers)
    at = PRESSURES.index(GAPS_AT)
    gap = ratio(*(evidence.samples(kind, "mean_gap")[:, at, 0] for kind in ("layer", "half_space")))
    findings = tuple(_findings(areas["layer"], ratios, gap))
    return Outcome(findings, {"areas": pd.DataFrame(rows)})


def _findings(layer: Field, ratios: list[Estimate], gap: Estimate) -> Iterator[Finding]:
    near = (1 - MEASURED["gap_error"], 1 + MEASURED["gap_error"])
    lightest, heaviest = MEASURED.series["area"]["fraction"].values.tolist()
    pressures = np.log(PRESSURES)
    found = mean_of(lambda area: np.exp(np.interp(np.log(lightest), np.log(area), pressures)), layer)
    yield WORDS.judge("lightest", found, ends=(0.0, MEASURED["least_pressure"]))
    yield WORDS.judge("heaviest", mean(layer[:, -1]), ends=(heaviest, 1.0))
    numbers = {f"{pressure:g}": one for pressure, one in zip(PRESSURES, ratios, strict=True)}
    yield WORDS.judge("area", numbers, ends=near)
    yield WORDS.judge("gap", {f"{GAPS_AT:g}": gap}, ends=near)


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw area against pressure, and the ratio of both solids."""
    figure, (upper, lower) = style.panels(5.4, 6.6, rows=2)
    rows = tables["areas"]
    for kind, look, color in (("half_space", "s-", style.GRAY), ("layer", "o-", style.INK)):
        words = SOLIDS[kind].removeprefix("a ").removeprefix("the ")
        style.points(upper, rows, "pressure", kind, look, color, label=words)
    ends = MEASURED.series["area"]
    marks = {"s": 60, "color": style.VERMILION, "zorder": 3}
    upper.scatter(ends["pressure"][0], ends["fraction"][0], marker="v", label="measured: below", **marks)
    upper.scatter(ends["pressure"][1], ends["fraction"][1], marker="^", label="measured: above", **marks)
    error = MEASURED["gap_error"]
    style.points(lower, rows, "pressure", "ratio", "o-", style.INK)
    lower.axhspan(1 - error, 1 + error, color="0.9", zorder=0, label="within a tenth")
    WORDS.dress(upper, lower)
    return figure


PRINTED_2017 = Study(**WORDS.study, quick=_made(128, 2), full=_made(512, 8), analyse=analyse, draw=draw)
