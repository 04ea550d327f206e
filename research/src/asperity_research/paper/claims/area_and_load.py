"""Section 3 of the paper, independent heights: area against load, before creep and relaxed."""

from __future__ import annotations

from math import inf

import numpy as np
import xarray as xr

from asperity.fits import jackknife
from asperity.surfaces import gaussian
from asperity.theory import (
    GaussianHeights,
    dilute_area,
    full_contact_load,
    full_contact_load_relaxed,
    site_stiffness,
    winkler_area,
)
from asperity_research.arrays import Field
from asperity_research.paper.claims.claim import Claim, Number, Numbers
from asperity_research.paper.claims.measures import between, crossing, exponent, mean_of
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import exact

LIGHT = (1e-3, 3e-2)
"""Contact fractions called light, before creep."""
LOW = (1e-3, 1e-1)
"""Contact fractions of relaxed states called low."""


def proportional_to_load(evidence: Evidence, k1: float) -> Numbers:
    """Slope d ln A / d ln F at low load; where k1 >= k0, beside that of independent asperities."""
    area, sites = evidence.samples("load", "initial_area", k1=k1), evidence.sites("load")
    light = between(area.mean(axis=0) / sites, *LIGHT)
    load, area = np.array(evidence.values("load", "load"))[light], area[:, light]
    theory = exponent(load, dilute_area(load / sites, float(1 / site_stiffness(k1)), GaussianHeights()))
    yield Number("slope", mean_of(lambda mean: exponent(load, mean), area))
    if k1 >= 1:
        over = mean_of(lambda mean: exponent(load, mean) / theory, area)
        yield Number("over_theory", over, {"theory": theory})


def load_of_half_contact(evidence: Evidence) -> Numbers:
    """The load of half contact where k0 dominates, for two k1; and where k1 dominates, beside k0 = 0."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    area, (softer, soft, *_, stiff) = evidence.samples("load", "initial_area"), evidence.values("load", "k1")
    alone = float(GaussianHeights().mean_excess(0.0)) * stiff  # half of the sites lie above the mean

    def half(mean: Field) -> float:
        return crossing(load / sites, mean / sites, 0.5)

    over = mean_of(lambda mean: half(mean[0]) / half(mean[1]), area)
    decades = np.log10(load[-1] / load[0])
    yield Number("soft", over, {"softer": softer, "soft": soft, "a_decade": round((load.size - 1) / decades)})
    over = mean_of(lambda mean: half(mean[-1]) / alone, area)
    yield Number("stiff", over, {"stiff": stiff, "alone": alone / stiff})


def independent_springs(evidence: Evidence) -> Numbers:
    """Load of full contact a spring, over k1 sigma; and the area beside that for k0 = 0; for k1 >> k0."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    stiff = evidence.values("load", "k1")[-1]
    springs = winkler_area(load / sites, stiff, GaussianHeights())
    partial = between(springs, 0.1, 0.99)
    full = [full_contact_load(heights, k0=1.0, k1=stiff) / (sites * stiff) for heights in _surfaces(evidence)]
    yield Number("full", mean_of(float, np.array(full)), {"stiff": stiff})
    area = evidence.samples("load", "initial_area", k1=stiff)
    yield Number("area", mean_of(lambda mean: float(np.mean(mean[partial] / sites / springs[partial])), area))


def contacts_that_shrink(evidence: Evidence) -> Numbers:
    """Number of contacts with A(infinity) < A(0) at the same load, among those not full."""
    for study in ("load", "self_affine_load"):
        data = evidence[study]
        before, after = xr.broadcast(data["initial_area"], data["relaxed_area"])
        partial = before < data["sites"]
        counts = {"partial": int(partial.sum()), "ties": int(((after == before) & partial).sum())}
        yield Number(study, exact(float((after < before).sum())), counts)


def late_over_relaxed_area(evidence: Evidence, k1: float) -> Numbers:
    """A at the last time over A(infinity), which is computed without k1."""
    last = float(evidence["aging"]["time"][-1])

    def reached(late: Field, limit: Field) -> float:
        return float(np.mean(late.mean(axis=0) / limit.mean(axis=0)))

    late = evidence.samples("aging", "area", k1=k1, time=last)
    limit = evidence.samples("aging", "relaxed_area", k1=k1)
    yield Number("reached", jackknife(reached, (late, limit)), {"last": last})


def relaxed_full_contact(evidence: Evidence) -> Numbers:
    """Number of relaxed contacts that are full below, or not above, the load known for each surface."""
    data, sites = evidence["load"], evidence.sites("load")
    wrong = 0
    for seed, heights in zip(data["seed"].values, _surfaces(evidence), strict=True):
        enough = data["load"].values >= full_contact_load_relaxed(heights, k0=1.0)
        full = data["relaxed_area"].sel(seed=seed).transpose("load", ...).values == sites
        wrong += int((full != enough[:, None]).sum())
    yield Number("wrong", exact(float(wrong)))


def no_lateral_spring(evidence: Evidence) -> Numbers:
    """Smallest contact fraction as t -> infinity with k0 = 0, and that before creep."""
    sites, lightest = evidence.sites("no_lateral"), evidence.values("no_lateral", "load")[0]
    late, last = evidence.samples("no_lateral", "area")[..., -1], evidence["no_lateral"]["time"].values[-1]
    yield Number("late", exact(float(late.min() / sites)), {"last": last})
    first = evidence.samples("no_lateral", "initial_area", load=lightest)
    yield Number("first", mean_of(lambda mean: mean / sites, first), {"load": lightest / sites})


def relaxed_exponent(evidence: Evidence) -> Numbers:
    """Exponent p of A(infinity) ~ F^p, and how it drifts."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    area = evidence.samples("load", "relaxed_area", k1=evidence.values("load", "k1")[0])
    low = np.flatnonzero(between(area.mean(axis=0) / sites, *LOW))
    lower, upper = low[: (low.size + 1) // 2], low[low.size // 2 :]

    def drift(mean: Field) -> float:
        return exponent(load[lower], mean[lower]) - exponent(load[upper], mean[upper])

    yield Number("one", mean_of(lambda mean: exponent(load[low], mean[low]), area))
    yield Number("drift", mean_of(drift, area))


def _surfaces(evidence: Evidence) -> list[Field]:
    """Rough surfaces of the study, one a seed, made again."""
    side = round(evidence.sites("load") ** 0.5)
    return [gaussian((side, side), seed=int(seed)) for seed in evidence["load"]["seed"].values]


CLAIMS = (
    Claim(
        "slope-1", proportional_to_load, {"slope": (0.9, 1.1), "over_theory": (0.95, 1.05)}, each="load.k1"
    ),
    Claim("crossover", load_of_half_contact, {"soft": (0.9, 1.1), "stiff": (0.9, 1.1)}),
    Claim("winkler", independent_springs, {"full": (1, 10), "area": (0.9, 1.1)}),
    Claim("relaxed-larger", contacts_that_shrink, {"load": (0, 0), "self_affine_load": (0, 0)}),
    Claim("relaxed-k1", late_over_relaxed_area, {"reached": (0.99, 1.01)}, each="aging.k1"),
    Claim("relaxed-full", relaxed_full_contact, {"wrong": (0, 0)}),
    Claim("no-lateral", no_lateral_spring, {"late": (1, 1), "first": (-inf, 0.5)}),
    Claim("relaxed-0.8", relaxed_exponent, {"one": (0.75, 0.85), "drift": (-0.03, 0.03)}),
)
