"""The printed Contact Mechanics Challenge (2017): what the thickness of the soft layer changes.

The print is pressed on a layer that is thinner than the print's longest waves, so that a half-space errs
there. The surface is one of the same statistics, not the same surface: self-affine waves from the print's
roll-off down to eight sites, with its rms slope. It is periodic, where the print ends.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.figures import Drawing
from asperity.fits import Estimate, jackknife
from asperity.solids import contact_modulus
from asperity_research import style
from asperity_research.experiments.library import load
from asperity_research.studies.campaigns import Campaign, Tables
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding
from asperity_research.studies.numbers import columns, mean
from asperity_research.studies.study import Outcome, Study

MEASURED = load("printed-2017")

YOUNG, POISSON = 1e6, 0.495
"""Pa, of which areas under a pressure over it do not depend; rubber hardly changes its volume: assumed."""

GAPS_AT = 0.164
"""Pressure, over Young's modulus, at which gaps were compared with simulations."""

PRESSURES = tuple(
    sorted(
        [
            0.0005,
            GAPS_AT,
            *np.geomspace(MEASURED["least_pressure"], MEASURED["greatest_pressure"], 10).tolist(),
        ]
    )
)
"""Over Young's modulus."""

SOLIDS = {"half_space": "a half-space", "layer": "the layer, bonded to a rigid base"}


def _campaigns(surface: Tables, samples: Tables) -> Iterator[Campaign]:
    modulus = contact_modulus(YOUNG, POISSON)
    layer = {"poisson": [POISSON], "thickness": 1e-3 * MEASURED["thickness"]}
    for kind, more in zip(SOLIDS, ({}, layer), strict=True):
        tables = {
            "surface": surface,
            "solid": {
                "kind": kind,
                **({"modulus": modulus} if kind == "half_space" else {"young": [YOUNG], **more}),
            },
            "contact": {"pressure": YOUNG * PRESSURES[0]},
            "aging": {"times": [0.0]},
            "output": {"maps_at": []},
            "sweep": {"contact.pressure": [YOUNG * pressure for pressure in PRESSURES], **samples},
        }
        yield Campaign(kind, f"Area against pressure on {SOLIDS[kind]}", tables)


def _made(side: int, surfaces: int) -> tuple[Campaign, ...]:
    spacing = MEASURED["side"] / side
    surface = {
        **{
            "kind": "spectral",
            "shape": [side, side],
            "spacing": [spacing],
            "unit": "mm",
            "hurst": MEASURED["hurst"],
        },
        **{"roll_off": MEASURED["roll_off"], "cutoff": 8 * spacing, "rms_slope": MEASURED["rms_slope"]},
    }
    return tuple(_campaigns(surface, {"seeds": surfaces}))


def on_scans(scans: Tables, samples: Tables, slope: float) -> tuple[Campaign, ...]:
    """Campaigns on scans."""
    del slope
    return tuple(_campaigns(scans, samples))


def analyse(evidence: Evidence) -> Outcome:
    """Compare areas on the layer and on the half-space, and at the ends with what was measured."""
    nominal = (1e-3 * MEASURED["side"]) ** 2
    areas = {kind: evidence.samples(kind, "contact_area_corrected")[..., 0] / nominal for kind in SOLIDS}
    gaps = {kind: evidence.samples(kind, "mean_gap")[..., 0] for kind in SOLIDS}
    rows, ratios = [], []
    for at, pressure in enumerate(PRESSURES):
        layer, half_space = (areas[kind][:, at] for kind in ("layer", "half_space"))
        ratio = jackknife(lambda a, b: a.mean() / b.mean(), (layer, half_space))
        row = {
            "pressure": pressure,
            **columns("layer", mean(layer)),
            **columns("half_space", mean(half_space)),
        }
        rows.append(row | columns("ratio", ratio))
        ratios.append(ratio)
    at = PRESSURES.index(GAPS_AT)
    gap = jackknife(lambda a, b: a.mean() / b.mean(), (gaps["layer"][:, at], gaps["half_space"][:, at]))
    (lightest, heaviest), error = MEASURED.series["area"]["fraction"].values.tolist(), MEASURED["gap_error"]
    pressures = np.log(PRESSURES)
    lightly = jackknife(
        lambda some: np.exp(np.interp(np.log(lightest), np.log(some.mean(axis=0)), pressures)), areas["layer"]
    )
    part = "part of the nominal area, at a pressure of {:g} <i>E</i>"
    findings = (
        Finding.within(
            (0.0, MEASURED["least_pressure"]),
            "lightest",
            "Bennett et al. 2017",
            "Less than 0.1 % of the layer touches at a pressure below 0.001 <i>E</i>",
            {"pressure over <i>E</i> at which 0.1 % touch": lightly},
            note="The least pressure was below 0.001 E; by how much is not known.",
        ),
        Finding.within(
            (heaviest, 1.0),
            "heaviest",
            "Bennett et al. 2017",
            "At a pressure of <i>E</i> more than 60 % of the layer touches",
            {part.format(PRESSURES[-1]): _of(areas["layer"], -1)},
        ),
        Finding.within(
            (1 - error, 1 + error),
            "area",
            "Bennett et al. 2017",
            "The area on a half-space is that on the layer within a tenth, as closely as gaps were compared",
            {
                f"layer over half-space, at {p:g} <i>E</i>": one
                for p, one in zip(PRESSURES, ratios, strict=True)
            },
            note="The uncertainty of the measured area is not stated; that of the gap stands for it.",
        ),
        Finding.within(
            (1 - error, 1 + error),
            "gap",
            "Bennett et al. 2017",
            "The mean gap on a half-space is that on the layer within a tenth",
            {f"layer over half-space, at {GAPS_AT:g} <i>E</i>": gap},
        ),
    )
    return Outcome(findings, {"areas": pd.DataFrame(rows)})


def _of(areas: np.ndarray, at: int) -> Estimate:
    return mean(areas[:, at])


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw area against pressure, and the ratio of both solids."""
    figure = Drawing(figsize=(7.2, 3.3), layout="constrained")
    left, right = figure.subplots(1, 2)
    rows = tables["areas"]
    for kind, look, color in (("half_space", "s-", style.GRAY), ("layer", "o-", style.INK)):
        words = SOLIDS[kind].removeprefix("a ").removeprefix("the ")
        style.points(left, rows, "pressure", kind, look, color, label=words)
    ends = MEASURED.series["area"]
    known = {"s": 60, "color": style.VERMILION, "zorder": 3}
    left.scatter(ends["pressure"][0], ends["fraction"][0], marker="v", label="measured: below", **known)
    left.scatter(ends["pressure"][1], ends["fraction"][1], marker="^", label="measured: above", **known)
    left.set(
        xscale="log",
        yscale="log",
        xlabel="pressure over Young's modulus",
        ylabel="part of the area that touches",
    )
    left.legend(fontsize=7)
    error = MEASURED["gap_error"]
    style.points(right, rows, "pressure", "ratio", "o-", style.INK)
    right.axhspan(1 - error, 1 + error, color="0.9", zorder=0, label="a tenth")
    right.set(
        xscale="log",
        xlabel="pressure over Young's modulus",
        ylabel="area, layer over half-space",
    )
    right.legend(fontsize=7)
    return figure


PRINTED_2017 = Study(
    name=MEASURED.name,
    question="From which pressure on does the thickness of the soft layer under a printed surface matter?",
    quick=_made(128, 2),
    full=_made(512, 8),
    analyse=analyse,
    draw=draw,
    caption="Left: area against pressure on a layer of 15 mm and on a half-space, means over the surfaces, "
    "with the ends of the measured range; right: their ratio, with 95 % intervals.",
    page="docs/experiments.md",
)
