"""A step of rock on rock at 100 MPa, the example of xlook: parameters beside those published.

The record has no license and is not in this package. Without a path it is sought in the folder of measured
data (``ASPERITY_DATA``), as friction/p655intact100l.xlook.
"""

import math
import os
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity import friction
from asperity.errors import InputError
from asperity_research import style
from asperity_research.experiments.record import load
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Measurement, estimate
from asperity_research.studies.study import Outcome, Study, Words

WORDS, MEASURED = Words.beside(__file__), load("p655")

FILE = "p655intact100l.xlook"
VARIANTS: tuple[tuple[Literal["slip", "aging"], int], ...] = (("slip", 1600), ("slip", 1000), ("aging", 1000))
"""Laws and stiffnesses (1/m) of the published fits."""

NUMBERS = ("mu_0", "a", "b", "D_c")
PART = {"mu_0": 0.002, "a": 0.1, "b": 0.1, "D_c": 0.3}
"""Part of a published number within which ours is the same: windows, weights and drift are choices."""


def found(record: Path | None) -> Path:
    """The file, or where it can be had."""
    path = record or Path(os.environ.get("ASPERITY_DATA", "."), "friction", FILE)
    if not path.is_file():
        advice = f"--record FILE, from the repository PennStateRockandSedimentMechanics/xlook, {FILE}"
        raise InputError(
            "record", expected="the record, which is not ours to give", got="none", advice=advice
        )
    return path


def read(path: Path) -> friction.Record:
    """The step, with the calibration of the file."""
    record = MEASURED
    lines = [f"{record['time_bit']}, s", f"{record['load_point_bit']}, um"]
    lines += [f"{record['shear_bit']}, MPa, {record['shear_zero']}", "-"]
    lines += [f"{record['normal_bit']}, MPa, {record['normal_zero']}"]
    with tempfile.TemporaryDirectory() as folder:
        calibration = Path(folder, "calibration.txt")
        calibration.write_text("\n".join(lines))
        return friction.read_record(path, calibration=calibration, start=record["start"], stop=record["stop"])


def analyse(_: Evidence, record: Path | None = None) -> Outcome:
    """Fit each variant, and compare."""
    measured = read(found(record))
    rows, findings, fits = [], [], {}
    for law, k in VARIANTS:
        fit = fits[law, k] = friction.rate_and_state(measured, law=law, stiffness=f"{k} 1/m")
        judged = []
        for name in NUMBERS:
            unit = 1e-6 if name == "D_c" else 1.0
            value, (low, high) = getattr(fit, name) / unit, (end / unit for end in fit.interval(name))
            printed, part = MEASURED[f"{law}_{k}_{name}"], PART[name]
            ours = estimate(value, getattr(fit, f"{name}_stderr") / unit, low, high, 1)
            ends = (printed * (1 - part), printed * (1 + part))
            judged.append(Measurement(name + " (um)" * (name == "D_c"), ours, *ends))
            row = {"law": law, "stiffness": k, "parameter": name, "value": value, "low": low, "high": high}
            rows.append(row | {"published": printed, "misfit": float(np.std(fit.residual))})
        findings.append(
            WORDS.judge("published", judged, key=f"published {law} {k}", law=law, k=f"{k * 1e-6:g}")
        )
    first, last = fits[VARIANTS[0]], fits[VARIANTS[-1]]
    for claim, names in (("robust", ("a", "b")), ("moves", ("D_c",))):
        ratios = {}
        for name in names:
            ratio = getattr(first, name) / getattr(last, name)
            errors = [getattr(fit, f"{name}_stderr") / getattr(fit, name) for fit in (first, last)]
            spread = math.hypot(*errors)
            ends = (ratio * math.exp(-1.96 * spread), ratio * math.exp(1.96 * spread))
            ratios[name] = estimate(ratio, ratio * spread, *ends, 1)
        findings.append(WORDS.judge(claim, ratios))
    return Outcome(tuple(findings), {"parameters": pd.DataFrame(rows)})


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw each parameter over the published one."""
    figure, (ax,) = style.panels(4.5, 3.3)
    rows = tables["parameters"]
    looks = zip(VARIANTS, (style.BLUE, style.VERMILION, style.INK), strict=True)
    for n, ((law, k), color) in enumerate(looks):
        curve = rows[(rows["law"] == law) & (rows["stiffness"] == k)]
        x, over = np.arange(len(curve)) + 0.15 * (n - 1), curve["value"] / curve["published"]
        errors = [over - curve["low"] / curve["published"], curve["high"] / curve["published"] - over]
        ax.errorbar(
            x, over, errors, fmt="o", markersize=3.5, color=color, label=f"{law} law, k = {k * 1e-6:g}/µm"
        )
    ax.axhline(1, color=style.INK, linewidth=0.8)
    ax.set_xticks(range(len(NUMBERS)), [r"$\mu_0$", "$a$", "$b$", "$D_c$"])
    WORDS.dress(ax)
    return figure


P655 = Study(**WORDS.study, quick=(), full=(), analyse=analyse, draw=draw)


def of_record(record: Path | None) -> Study:
    """The comparison with a file; `InputError` where there is none."""
    return replace(P655, analyse=partial(analyse, record=found(record)))
