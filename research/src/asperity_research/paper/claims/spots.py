"""Section 4 of the paper, self-affine surfaces: what becomes of the contact spots."""

from __future__ import annotations

from math import inf

import numpy as np

from asperity.analysis import clustering, turnover
from asperity_research.arrays import Field, Mask
from asperity_research.paper.claims.claim import Claim, Number, Numbers
from asperity_research.paper.claims.measures import mean_of
from asperity_research.paper.studies import MAP_BOXES
from asperity_research.studies.evidence import Evidence

BOXES = (64, 16, MAP_BOXES)
"""Boxes along a side of the lattice in which contacts are counted; the last is that of Figure 7."""


def sites_gained(evidence: Evidence) -> Numbers:
    """Of the sites gained by the second map after t = 0, the share in spots of t = 0."""
    times, maps = _maps(evidence)
    grown = [turnover(first, middle) for first, _, middle, _ in maps]
    share = np.array([one.gained_attached / one.gained for one in grown])
    yield Number("attached", mean_of(float, share), {"time": times[2]})


def sites_lost(evidence: Evidence) -> Numbers:
    """Of the sites of t = 0, the share free in the relaxed state; and that at the next map over it."""
    times, maps = _maps(evidence)
    lost = np.array([[turnover(each[0], each[at]).lost / each[0].sum() for at in (1, -1)] for each in maps])
    yield Number("relaxed", mean_of(float, lost[:, 1]))
    yield Number("early", mean_of(lambda mean: float(mean[0] / mean[1]), lost), {"time": times[1]})


def dispersion(evidence: Evidence) -> Numbers:
    """Index of dispersion of the relaxed contact, for each of `BOXES`; and that before creep, over it."""
    _, maps = _maps(evidence)
    for box in (max(2, maps.shape[-1] // part) for part in BOXES):
        before, relaxed = (np.array([clustering(each[at], box=box) for each in maps]) for at in (0, -1))
        yield Number("relaxed", mean_of(float, relaxed), {"box": box})
    both = np.stack([before, relaxed], axis=1)
    yield Number("gathered", mean_of(lambda mean: float(mean[0] / mean[1]), both), {"box": box})


def _maps(evidence: Evidence) -> tuple[Field, Mask]:
    """Recorded times; and maps at the first three of them and relaxed, shape (seeds, 4, rows, columns)."""
    runs = [evidence.fields("maps", seed=int(seed)) for seed in evidence["maps"]["seed"].values]
    maps = [[*run["in_contact"].values[:3], run["in_contact_relaxed"].values] for run in runs]
    return runs[0]["field_time"].values, np.array(maps)


CLAIMS = (
    Claim("spots-grow", sites_gained, {"attached": (0.05, 0.95)}),
    Claim("spots-detach", sites_lost, {"relaxed": (0.005, 1.0), "early": (-inf, 0.5)}),
    Claim("spots-scattered", dispersion, {"relaxed": (-inf, 2.0), "gathered": (2.0, inf)}),
)
