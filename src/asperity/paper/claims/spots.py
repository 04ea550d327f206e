"""Section 4 of the paper, self-affine surfaces: what becomes of the contact spots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.analysis.contact_patches import clustering, turnover
from asperity.lattice import Field
from asperity.paper.claims.measures import mean_of
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding, Measurement
from asperity.paper.studies import MAP_BOXES
from asperity.paper.wording import REDUCED_TIME, TIME

PLACE = "Section 4"
BOXES = (64, 16, MAP_BOXES)
"""Boxes along a side of the lattice in which contacts are counted; the last is that of Figure 7."""


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """All claims on spots: they grow, new ones appear, some detach, and the relaxed contact is scattered."""
    spots = [_Spots.of(evidence, int(seed)) for seed in evidence["maps"]["seed"].values]
    side = round(evidence.sites("maps") ** 0.5)
    boxes = _boxes(side)

    def over_seeds(name: str) -> Field:
        return np.array([getattr(one, name) for one in spots])

    times = evidence.fields("maps", seed=float(evidence["maps"]["seed"][0]))["field_time"].values
    later = f"{REDUCED_TIME} = {times[2]:g}"
    return (
        Finding(
            key="spots-grow",
            place=f"{PLACE}; Fig. 7",
            claim="The contact grows both by larger spots and by new ones.",
            measured=(
                Measurement(
                    f"share of the sites gained by {later} that belong to spots of {TIME} = 0",
                    mean_of(float, over_seeds("attached")),
                    0.05,
                    0.95,
                ),
            ),
            note="A spot is a connected patch of sites in contact, neighbors along the axes. The rest of "
            "the sites gained are in new spots.",
        ),
        Finding(
            key="spots-detach",
            place=f"{PLACE}; Fig. 7",
            claim="Sites that touched at first may become detached at very long times.",
            measured=(
                Measurement(
                    f"share of the sites of {TIME} = 0 that are free in the relaxed state",
                    mean_of(float, over_seeds("lost_relaxed")),
                    0.005,
                    1.0,
                ),
                Measurement(
                    f"the same at {REDUCED_TIME} = {times[1]:g}, over that of the relaxed state",
                    mean_of(lambda mean: float(mean[0] / mean[1]), over_seeds("lost_early_and_relaxed")),
                    high=0.5,
                ),
            ),
        ),
        Finding(
            key="spots-scattered",
            place=f"{PLACE}; Fig. 7",
            claim="The relaxed contact is a uniformly scattered distribution of points.",
            measured=tuple(
                Measurement(
                    f"index of dispersion in boxes of {box} × {box} sites, relaxed; 1 if scattered at random",
                    mean_of(lambda mean, at=at: float(mean[at]), over_seeds("clustering_relaxed")),
                    high=2.0,
                )
                for at, box in enumerate(boxes)
            ),
            corrected=(
                Measurement(
                    f"the same before creep over that of the relaxed state, boxes of {boxes[-1]} × "
                    f"{boxes[-1]} sites",
                    mean_of(
                        lambda mean: float(mean[0] / mean[1]), over_seeds("clustering_first_and_relaxed")
                    ),
                    low=2.0,
                ),
            ),
            correction="it is much more scattered than the contact before creep, and still clustered on all "
            "scales but the smallest",
            note="The index is the variance of the number of contacts in a box over that of as many "
            "contacts strewn at random. It grows with the box where there is clustering on the scale of the "
            "box.",
        ),
    )


@dataclass(frozen=True)
class _Spots:
    """What became of the contact of one surface.

    Attributes
    ----------
    attached
        Of the sites gained by the second map after t = 0, the share in spots of t = 0.
    lost_relaxed
        Of the sites of t = 0, the share that is free in the relaxed state.
    lost_early_and_relaxed
        The same at the first map after t = 0, and in the relaxed state.
    clustering_relaxed
        Index of dispersion of the relaxed contact, for each of `BOXES`.
    clustering_first_and_relaxed
        That of the largest box at t = 0, and relaxed.
    """

    attached: float
    lost_relaxed: float
    lost_early_and_relaxed: tuple[float, float]
    clustering_relaxed: tuple[float, ...]
    clustering_first_and_relaxed: tuple[float, float]

    @classmethod
    def of(cls, evidence: Evidence, seed: int) -> _Spots:
        fields = evidence.fields("maps", seed=seed)
        maps = fields["in_contact"].values
        first, early, middle, relaxed = maps[0], maps[1], maps[2], fields["in_contact_relaxed"].values
        grown = turnover(first, middle)
        lost = [turnover(first, later).lost / first.sum() for later in (early, relaxed)]
        boxes = _boxes(first.shape[0])
        scattered = tuple(clustering(relaxed, box=box) for box in boxes)
        return cls(
            attached=grown.gained_attached / grown.gained,
            lost_relaxed=lost[1],
            lost_early_and_relaxed=(lost[0], lost[1]),
            clustering_relaxed=scattered,
            clustering_first_and_relaxed=(clustering(first, box=boxes[-1]), scattered[-1]),
        )


def _boxes(side: int) -> list[int]:
    """Sides of the boxes, on a lattice of some side."""
    return [max(2, side // part) for part in BOXES]
