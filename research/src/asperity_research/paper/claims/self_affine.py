"""Section 4 of the paper: self-affine surfaces."""

from __future__ import annotations

import numpy as np

from asperity.theory import site_stiffness
from asperity_research.arrays import Field
from asperity_research.paper.claims.claim import Claim, Number, Numbers
from asperity_research.paper.claims.measures import (
    EVEN,
    LOGARITHMIC,
    ROUGHLY,
    between,
    evenness,
    exponent,
    growth_slope,
    mean_of,
)
from asperity_research.studies.evidence import Evidence

PARTIAL = (1e-4, 5e-2)
"""Contact fractions away from full contact, before creep."""


def load_exponent(evidence: Evidence, size: float) -> Numbers:
    """Slope d ln A / d ln F before creep."""
    area = evidence.samples("self_affine_load", "initial_area", size=size)
    here = between(area.mean(axis=0) / size**2, *PARTIAL)
    load = np.array(evidence.values("self_affine_load", "load"))[here]
    yield Number("slope", mean_of(lambda mean: exponent(load, mean), area[:, here]))


def area_and_size(evidence: Evidence) -> Numbers:
    """A at the same load on larger systems, over that on the smallest, mean over loads."""
    smallest, *larger = evidence.values("self_affine_load", "size")
    area = evidence.samples("self_affine_load", "initial_area")
    partial = between(area.mean(axis=0)[0] / smallest**2, *PARTIAL)

    def grown(mean: Field) -> float:
        return float(np.exp(np.mean(np.log(mean[1] / mean[0]))))

    for number, size in enumerate(larger, start=1):
        pair = area[:, [0, number]][..., partial]
        yield Number("grown", mean_of(grown, pair), {"size": size, "smallest": smallest})


def slope_and_load(evidence: Evidence, k1: float) -> Numbers:
    """Slope d ln B / d ln F, and late over early growth."""
    time, load = (evidence["self_affine_aging"][name].values for name in ("time", "load"))
    area = _largest(evidence, k1)
    yield Number("drift", mean_of(lambda mean: exponent(load, _slopes(time, mean)), area))
    yield Number("even", mean_of(lambda mean: evenness(time, _scaled(mean)), area))


def slope_and_stiffness(evidence: Evidence) -> Numbers:
    """B at the largest over B at the smallest k1."""
    time = evidence["self_affine_aging"]["time"].values
    soft, *_, stiff = evidence.values("self_affine_aging", "k1")
    both = np.stack([_largest(evidence, k1) for k1 in (soft, stiff)], axis=1)

    def gain(mean: Field) -> float:
        return float(_slopes(time, mean[1]).sum() / _slopes(time, mean[0]).sum())

    gained, by_site = mean_of(gain, both), float(site_stiffness(stiff) / site_stiffness(soft))
    for name, expected in (("printed", stiff / soft), ("by_site", by_site)):
        yield Number(name, gained, {"soft": soft, "stiff": stiff, "expected": expected}, of=expected)


def other_hurst_exponents(evidence: Evidence, hurst: float) -> Numbers:
    """Slope d ln A / d ln F before creep, and late over early growth."""
    time, load = (evidence["hurst"][name].values for name in ("time", "load"))
    area = evidence.samples("hurst", "area", hurst=hurst)
    yield Number("slope", mean_of(lambda mean: exponent(load, mean[:, 0]), area))
    yield Number("even", mean_of(lambda mean: evenness(time, _scaled(mean)), area))


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


CLAIMS = (
    Claim("self-affine-0.8", load_exponent, {"slope": (0.7, 0.9)}, each="self_affine_load.size"),
    Claim("self-affine-size", area_and_size, {"grown": (0.8, 1.25)}),
    Claim("slope-load", slope_and_load, {"drift": (-0.1, 0.1), "even": EVEN}, each="self_affine_aging.k1"),
    Claim("slope-stiffness", slope_and_stiffness, {"printed": ROUGHLY, "by_site": ROUGHLY}),
    Claim("hurst", other_hurst_exponents, {"slope": (0.7, 1.0), "even": EVEN}, each="hurst.hurst"),
)
