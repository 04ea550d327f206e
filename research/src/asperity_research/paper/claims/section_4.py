"""Section 4 of the paper, self-affine surfaces: area and load, growth, and what becomes of the spots."""

from math import inf

import numpy as np

from asperity.analysis import clustering, turnover
from asperity_research.arrays import Field, Mask
from asperity_research.paper.claims.claim import claim
from asperity_research.paper.claims.measures import (
    EVEN,
    LOGARITHMIC,
    ROUGHLY,
    Number,
    Numbers,
    evenness,
    exponent,
    growth_slope,
    stiffened,
)
from asperity_research.paper.studies import MAP_BOXES
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import mean, mean_of, ratio, within

PARTIAL = (1e-4, 5e-2)  # Contact fractions away from full contact, before creep
BOXES = (64, 16, MAP_BOXES)
"""Boxes along a side of the lattice in which contacts are counted; the last is that of Figure 7."""


@claim("self-affine-0.8", each="self_affine_load.size", slope=(0.7, 0.9))
def load_exponent(evidence: Evidence, size: float) -> Numbers:
    """Slope d ln A / d ln F before creep."""
    area = evidence.samples("self_affine_load", "initial_area", size=size)
    partial = within(area.mean(axis=0) / size**2, *PARTIAL)
    load = evidence["self_affine_load"]["load"].values[partial]
    yield Number("slope", mean_of(lambda mean: exponent(load, mean), area[:, partial]))


@claim("self-affine-size", grown=(0.8, 1.25))
def area_and_size(evidence: Evidence) -> Numbers:
    """A at the same load on larger systems, over that on the smallest, mean over loads."""
    smallest, *larger = evidence.values("self_affine_load", "size")
    area = evidence.samples("self_affine_load", "initial_area")
    partial = within(area.mean(axis=0)[0] / smallest**2, *PARTIAL)

    def grown(small: Field, large: Field) -> float:
        return float(np.exp(np.mean(np.log(large / small))))

    for number, size in enumerate(larger, start=1):
        growth = mean_of(grown, area[:, 0, partial], area[:, number, partial])
        yield Number("grown", growth, {"size": size, "smallest": smallest})


@claim("slope-load", each="self_affine_aging.k1", drift=(-0.1, 0.1), even=EVEN)
def slope_and_load(evidence: Evidence, k1: float) -> Numbers:
    """Slope d ln B / d ln F, and late over early growth."""
    time, load = (evidence["self_affine_aging"][name].values for name in ("time", "load"))
    area = _largest(evidence, k1)
    yield Number("drift", mean_of(lambda mean: exponent(load, _slopes(time, mean)), area))
    yield Number("even", mean_of(lambda mean: evenness(time, _scaled(mean)), area))


@claim("slope-stiffness", printed=ROUGHLY, by_site=ROUGHLY)
def slope_and_stiffness(evidence: Evidence) -> Numbers:
    """B at the largest over B at the smallest k1."""
    time, (soft, *_, stiff) = (evidence["self_affine_aging"][name].values for name in ("time", "k1"))

    def gain(soft: Field, stiff: Field) -> float:
        return float(_slopes(time, stiff).sum() / _slopes(time, soft).sum())

    yield from stiffened(mean_of(gain, _largest(evidence, soft), _largest(evidence, stiff)), soft, stiff)


@claim("hurst", each="hurst.hurst", slope=(0.7, 1.0), even=EVEN)
def other_hurst_exponents(evidence: Evidence, hurst: float) -> Numbers:
    """Slope d ln A / d ln F before creep, and late over early growth."""
    time, load = (evidence["hurst"][name].values for name in ("time", "load"))
    area = evidence.samples("hurst", "area", hurst=hurst)
    yield Number("slope", mean_of(lambda mean: exponent(load, mean[:, 0]), area))
    yield Number("even", mean_of(lambda mean: evenness(time, _scaled(mean)), area))


@claim("spots-grow", attached=(0.05, 0.95))
def sites_gained(evidence: Evidence) -> Numbers:
    """Of the sites gained by the second map after t = 0, the share in spots of t = 0."""
    times, maps = _maps(evidence)
    grown = [turnover(first, middle) for first, _, middle, _ in maps]
    share = mean(np.array([one.gained_attached / one.gained for one in grown]))
    yield Number("attached", share, {"time": times[2]})


@claim("spots-detach", relaxed=(0.005, 1.0), early=(-inf, 0.5))
def sites_lost(evidence: Evidence) -> Numbers:
    """Of the sites of t = 0, the share free in the relaxed state; and that at the next map over it."""
    times, maps = _maps(evidence)
    early, relaxed = (
        np.array([turnover(each[0], each[at]).lost / each[0].sum() for each in maps]) for at in (1, -1)
    )
    yield Number("relaxed", mean(relaxed))
    yield Number("early", ratio(early, relaxed), {"time": times[1]})


@claim("spots-scattered", relaxed=(-inf, 2.0), gathered=(2.0, inf))
def dispersion(evidence: Evidence) -> Numbers:
    """Index of dispersion of the relaxed contact, for each of `BOXES`; and that before creep, over it."""
    _, maps = _maps(evidence)
    for box in (max(2, maps.shape[-1] // part) for part in BOXES):
        before, relaxed = (np.array([clustering(each[at], box=box) for each in maps]) for at in (0, -1))
        yield Number("relaxed", mean(relaxed), {"box": box})
    yield Number("gathered", ratio(before, relaxed), {"box": box})


def _largest(evidence: Evidence, k1: float) -> Field:
    """Aging curves on the largest system, shape (seeds, loads, times)."""
    size = evidence.values("self_affine_aging", "size")[-1]
    return evidence.samples("self_affine_aging", "area", size=size, k1=k1)


def _slopes(time: Field, areas: Field) -> Field:
    """B of several curves of A(t), shape (loads, times)."""
    return np.array([growth_slope(time, area, *LOGARITHMIC) for area in areas])


def _scaled(areas: Field) -> Field:
    """Sum of curves A(t)/A(0), shape (loads, times)."""
    return np.asarray((areas / areas[:, :1]).sum(axis=0))


def _maps(evidence: Evidence) -> tuple[Field, Mask]:
    """Recorded times; and maps at the first three of them and relaxed, shape (seeds, 4, rows, columns)."""
    runs = [evidence.fields("maps", seed=int(seed)) for seed in evidence["maps"]["seed"].values]
    maps = [[*run["in_contact"].values[:3], run["in_contact_relaxed"].values] for run in runs]
    return runs[0]["field_time"].values, np.array(maps)
