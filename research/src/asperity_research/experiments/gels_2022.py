"""Gels under an AFM: the solid of each approach, and the retraction that it predicts."""

from collections.abc import Mapping
from dataclasses import replace

import pandas as pd
from matplotlib.figure import Figure

import asperity as asp
from asperity.inference import Indentation, IndentedSolid
from asperity_research import style
from asperity_research.experiments.record import load
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import exact
from asperity_research.studies.study import Outcome, Study, Words

WORDS, MEASURED = Words.beside(__file__), load("gels-2022")

GELS, SPEEDS = ("polyacrylamide", "agarose"), (5, 10, 15)
AT = 0.1
"""Time after a load at which moduli are compared, s."""
SHOWN = 1.0
"""Depth before the contact from which the figure shows the record, um."""


def fitted(gel: str, speed: int, contact: float | str = 0.0) -> IndentedSolid:
    """The solid of an approach; the contact is that of the data set, or fitted."""
    series = MEASURED.series[f"{gel}_{speed}"]
    time, depth, force = (series[name].values for name in ("time", "depth", "force"))
    record = Indentation.of(time, 1e-6 * depth, 1e-9 * force, contact=contact)
    found = asp.infer(record, model="ball", radius=f"{MEASURED['radius']} um", poisson=MEASURED["poisson"])
    assert isinstance(found, IndentedSolid)
    return found


def analyse(_: Evidence) -> Outcome:
    """Predict each retraction, and judge."""
    rows, curves, findings = [], [], []
    for gel in GELS:
        for speed in SPEEDS:
            found, free = fitted(gel, speed), fitted(gel, speed, "fit")
            deviation, low, high = found.deviation
            least, modulus, most = found.modulus_at(AT)[:, 0]
            row = {"gel": gel, "speed_um_per_s": speed, "deviation": deviation}
            row |= {
                "deviation_low": low,
                "deviation_high": high,
                "deviation_contact_fitted": free.deviation[0],
            }
            row |= {"modulus_Pa": modulus, "modulus_Pa_low": least, "modulus_Pa_high": most}
            rows.append(row)
            curves.append(found.forces.assign(gel=gel, speed=speed))
            facts = {"modulus": f"{modulus / 1e3:.2f} kPa [{least / 1e3:.2f}, {most / 1e3:.2f}]"}
            facts |= {"gel": gel.capitalize(), "speed": str(speed), "fitted": f"{free.deviation[0]:.3f}"}
            numbers, ends = {f"{low:.3f} to {high:.3f}": exact(deviation)}, (0.0, MEASURED["largest"])
            finding = WORDS.judge("predicts", numbers, key=gel, ends=ends, **facts)
            findings.append(replace(finding, key=f"{gel} {speed}"))
    tables = {"gels": pd.DataFrame(rows), "curves": pd.concat(curves)}
    return Outcome(tuple(findings), tables)


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw force against depth."""
    figure, axes = style.panels(7.2, 4.6, columns=len(SPEEDS), rows=len(GELS))
    cases = [(gel, speed) for gel in GELS for speed in SPEEDS]
    for ax, (gel, speed) in zip(axes, cases, strict=True):
        curves = tables["curves"]
        rows = curves[
            (curves["gel"] == gel) & (curves["speed"] == speed) & (curves["depth_m"] > -1e-6 * SHOWN)
        ]
        depth = 1e6 * rows["depth_m"]
        back = (rows["segment"] == "retraction").to_numpy()
        ax.plot(depth, 1e9 * rows["force_N"], ".", color=style.INK, markersize=3)
        ax.plot(depth[~back], 1e9 * rows["predicted_N"][~back], color=style.BLUE)
        ends = [1e9 * rows[f"predicted_N_{end}"][back] for end in ("low", "high")]
        ax.fill_between(depth[back], *ends, color=style.VERMILION, alpha=0.25)
        ax.plot(depth[back], 1e9 * rows["predicted_N"][back], color=style.VERMILION)
        ax.set_title(f"{gel}, {speed} µm/s", fontsize=8)
    for ax in axes[-len(SPEEDS) :]:
        ax.set_xlabel("depth [µm]")
    for ax in axes[:: len(SPEEDS)]:
        ax.set_ylabel("force [nN]")
    return figure


GELS_2022 = Study(**WORDS.study, quick=(), full=(), analyse=analyse, draw=draw, takes="a minute")
