"""Spheres in creep (2009): the form that the experiment reports, on a linear solid.

The experiment found one curve for all diameters and loads once area and time are dimensionless. On a linear
viscoelastic half-space the radius of a sphere's contact is that of H. Hertz for the creep compliance J (E. H.
Lee, J. R. M. Radok, J. Appl. Mech. 27, 438 (1960)): A(t)/A(0) = (E(0) J(t))^(2/3), for any diameter and load.
The numbers of the experiment are missing, so that the form is all that is compared.
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.relaxation import PronySeries
from asperity_research import style
from asperity_research.experiments.record import load
from asperity_research.studies.campaigns import Campaign
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import exact
from asperity_research.studies.study import Outcome, Study, Words

WORDS, MEASURED = Words.beside(__file__), load("ptfe-2009")

SERIES = PronySeries(1e9, ((0.2, 1.0), (0.2, 10.0), (0.2, 100.0)))  # A made-up polymer, Pa and s
RADII = {"small": 0.5e-3, "large": 2e-3}  # m


def _campaigns(side: int) -> tuple[Campaign, ...]:
    return tuple(_spheres(name, radius, side) for name, radius in RADII.items())


def _spheres(name: str, radius: float, side: int) -> Campaign:
    """One radius under three loads; at the largest the contact is a tenth of the side across, at first."""
    width = 0.4 * radius
    x = (np.arange(side) - side // 2) * width / side
    heights = -(x[:, np.newaxis] ** 2 + x**2) / (2 * radius)
    largest = 4 * SERIES.modulus * (0.05 * width) ** 3 / (3 * radius)
    file = {"kind": "file", "path": "sphere.npy", "tilt": "none", "periodic": "wrap"}
    branches = [list(branch) for branch in SERIES.branches]
    tables = {
        "surface": file | {"file_unit": "m", "pixel_size": [width / side], "length_unit": "m"},
        "solid": {"kind": "half_space", "modulus": SERIES.modulus, "branches": branches},
        "contact": {"load": largest},
        "aging": {"times": np.geomspace(0.01, 1e4, 25).tolist()},
        "output": {"maps_at": []},
        "sweep": {"contact.load": [float(f"{largest * part:.4g}") for part in (0.25, 0.5, 1.0)]},
    }
    purpose = f"Spheres of radius {1e3 * radius:g} mm under three loads"
    return Campaign(name, purpose, tables, {"sphere.npy": heights})


def analyse(evidence: Evidence) -> Outcome:
    """Compare the growth of every contact with the closed form."""
    rows, worst = [], {}
    for name, radius in RADII.items():
        data = evidence[name]["contact_area_corrected"].transpose("load", "time")
        time = data["time"].values
        expected = (SERIES.modulus * SERIES.compliance_at(time)) ** (2 / 3)
        for load_, area in zip(data["load"].values.tolist(), data.values, strict=True):
            grown = area / area[0]
            off = float(np.abs(grown / expected - 1).max()) + 1.0
            worst[f"greatest factor off the closed form, {1e3 * radius:g} mm, {load_:.3g} N"] = exact(off)
            course = {"radius": radius, "load": load_, "time": time, "area": grown, "form": expected}
            rows.append(pd.DataFrame(course))
    finding = WORDS.judge("one curve", worst, missing="; ".join(MEASURED.missing))
    return Outcome((finding,), {"areas": pd.concat(rows, ignore_index=True)})


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw growth against time, and the closed form."""
    figure, (ax,) = style.panels(4.5, 3.3)
    rows = tables["areas"]
    rows = rows[rows["time"] > 0]
    colors = {RADII["small"]: style.BLUE, RADII["large"]: style.VERMILION}
    for radius, color in colors.items():
        of_radius = rows[rows["radius"] == radius]
        for newtons, mark in zip(sorted(of_radius["load"].unique()), ("^", "o", "s"), strict=True):
            curve, words = of_radius[of_radius["load"] == newtons], f"{1e3 * radius:g} mm, {newtons:.2g} N"
            ax.plot(curve["time"], curve["area"], mark, markersize=3.5, color=color, label=words)
    ax.plot(curve["time"], curve["form"], "-", color=style.INK, linewidth=0.9, label="Lee and Radok")
    WORDS.dress(ax)
    return figure


PTFE_2009 = Study(**WORDS.study, quick=_campaigns(512), full=_campaigns(1024), analyse=analyse, draw=draw)
