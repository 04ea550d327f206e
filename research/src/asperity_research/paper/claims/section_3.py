"""Section 3 of the paper, independent heights: area against load, its growth, and how the load drifts."""

from math import inf

import numpy as np
import xarray as xr

from asperity.fits import saturation
from asperity.surfaces import gaussian
from asperity.theory import (
    GaussianHeights,
    compliance,
    dilute_area,
    full_contact_load,
    full_contact_load_relaxed,
    late_slope,
    site_stiffness,
    winkler_area,
)
from asperity_research.arrays import Field
from asperity_research.paper.claims.claim import claim
from asperity_research.paper.claims.measures import (
    EVEN,
    Number,
    Numbers,
    crossing,
    evenness,
    exponent,
    growth_slope,
)
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import exact
from asperity_research.studies.numbers import mean, mean_of, within

LIGHT = (1e-3, 3e-2)  # Contact fractions called light, before creep
LOW = (1e-3, 1e-1)  # Contact fractions of relaxed states called low
EARLY = (1.0, 100.0)
"""Reduced times when growth is late for one contact, and contacts do not feel each other yet."""


@claim("slope-1", each="load.k1", slope=(0.9, 1.1), over_theory=(0.95, 1.05))
def proportional_to_load(evidence: Evidence, k1: float) -> Numbers:
    """Slope d ln A / d ln F at low load; where k1 >= k0, beside that of independent asperities."""
    area, sites = evidence.samples("load", "initial_area", k1=k1), evidence.sites("load")
    light = within(area.mean(axis=0) / sites, *LIGHT)
    load, area = evidence["load"]["load"].values[light], area[:, light]
    theory = exponent(load, dilute_area(load / sites, float(1 / site_stiffness(k1)), GaussianHeights()))
    yield Number("slope", mean_of(lambda mean: exponent(load, mean), area))
    if k1 >= 1:
        over = mean_of(lambda mean: exponent(load, mean) / theory, area)
        yield Number("over_theory", over, {"theory": theory})


@claim("crossover", soft=(0.9, 1.1), stiff=(0.9, 1.1))
def load_of_half_contact(evidence: Evidence) -> Numbers:
    """The load of half contact where k0 dominates, for two k1; and where k1 dominates, beside k0 = 0."""
    load, sites = evidence["load"]["load"].values, evidence.sites("load")
    area, (softer, soft, *_, stiff) = evidence.samples("load", "initial_area"), evidence.values("load", "k1")
    alone = float(GaussianHeights().mean_excess(0.0)) * stiff  # half of the sites lie above the mean

    def half(mean: Field) -> float:
        return crossing(load / sites, mean / sites, 0.5)

    over = mean_of(lambda mean: half(mean[0]) / half(mean[1]), area)
    decades = np.log10(load[-1] / load[0])
    yield Number("soft", over, {"softer": softer, "soft": soft, "a_decade": round((load.size - 1) / decades)})
    over = mean_of(lambda mean: half(mean[-1]) / alone, area)
    yield Number("stiff", over, {"stiff": stiff, "alone": alone / stiff})


@claim("winkler", full=(1, 10), area=(0.9, 1.1))
def independent_springs(evidence: Evidence) -> Numbers:
    """Load of full contact a spring, over k1 sigma; and the area beside that for k0 = 0; for k1 >> k0."""
    load, sites = evidence["load"]["load"].values, evidence.sites("load")
    stiff = evidence.values("load", "k1")[-1]
    springs = winkler_area(load / sites, stiff, GaussianHeights())
    partial = within(springs, 0.1, 0.99)
    full = [full_contact_load(heights, k0=1.0, k1=stiff) / (sites * stiff) for heights in _surfaces(evidence)]
    yield Number("full", mean(np.array(full)), {"stiff": stiff})
    area = evidence.samples("load", "initial_area", k1=stiff)
    yield Number("area", mean_of(lambda mean: float(np.mean(mean[partial] / sites / springs[partial])), area))


@claim("relaxed-larger", load=(0, 0), self_affine_load=(0, 0))
def contacts_that_shrink(evidence: Evidence) -> Numbers:
    """Number of contacts with A(infinity) < A(0) at the same load, among those not full."""
    for study in ("load", "self_affine_load"):
        data = evidence[study]
        before, after = xr.broadcast(data["initial_area"], data["relaxed_area"])
        partial = before < data["sites"]
        counts = {"partial": int(partial.sum()), "ties": int(((after == before) & partial).sum())}
        yield Number(study, exact(float((after < before).sum())), counts)


@claim("relaxed-k1", each="aging.k1", reached=(0.99, 1.01))
def late_over_relaxed_area(evidence: Evidence, k1: float) -> Numbers:
    """A at the last time over A(infinity), which is computed without k1."""
    last = float(evidence["aging"]["time"][-1])
    late = evidence.samples("aging", "area", k1=k1, time=last)
    limit = evidence.samples("aging", "relaxed_area", k1=k1)
    reached = mean_of(lambda late, limit: float(np.mean(late / limit)), late, limit)
    yield Number("reached", reached, {"last": last})


@claim("relaxed-full", wrong=(0, 0))
def relaxed_full_contact(evidence: Evidence) -> Numbers:
    """Number of relaxed contacts that are full below, or not above, the load known for each surface."""
    load, sites = evidence["load"]["load"].values, evidence.sites("load")
    wrong = 0
    for heights, area in zip(_surfaces(evidence), evidence.samples("load", "relaxed_area"), strict=True):
        wrong += int(((area == sites) != (load >= full_contact_load_relaxed(heights, k0=1.0))).sum())
    yield Number("wrong", exact(float(wrong)))


@claim("no-lateral", late=(1, 1), first=(-inf, 0.5))
def no_lateral_spring(evidence: Evidence) -> Numbers:
    """Smallest contact fraction as t -> infinity with k0 = 0, and that before creep."""
    sites, lightest = evidence.sites("no_lateral"), evidence.values("no_lateral", "load")[0]
    late, last = evidence.samples("no_lateral", "area")[..., -1], evidence["no_lateral"]["time"].values[-1]
    yield Number("late", exact(float(late.min() / sites)), {"last": last})
    first = evidence.samples("no_lateral", "initial_area", load=lightest)
    yield Number("first", mean_of(lambda mean: mean / sites, first), {"load": lightest / sites})


@claim("relaxed-0.8", one=(0.75, 0.85), drift=(-0.03, 0.03))
def relaxed_exponent(evidence: Evidence) -> Numbers:
    """Exponent p of A(infinity) ~ F^p, and how it drifts."""
    load, sites = evidence["load"]["load"].values, evidence.sites("load")
    area = evidence.samples("load", "relaxed_area", k1=evidence.values("load", "k1")[0])
    low = np.flatnonzero(within(area.mean(axis=0) / sites, *LOW))
    lower, upper = low[: (low.size + 1) // 2], low[low.size // 2 :]

    def drift(mean: Field) -> float:
        return exponent(load[lower], mean[lower]) - exponent(load[upper], mean[upper])

    yield Number("one", mean_of(lambda mean: exponent(load[low], mean[low]), area))
    yield Number("drift", mean_of(drift, area))


@claim("load-drift", drift=(0.01, 0.9))
def load_drift(evidence: Evidence) -> Numbers:
    """Late F over the first, at constant separation."""
    load = evidence.samples("separation", "load", R_viscous=0.0)
    yield Number("drift", mean_of(lambda mean: float(mean[-1] / mean[0]), load))


@claim("saturation", each="aging.k1", worst=(-inf, 0.05))
def misfit(evidence: Evidence, k1: float) -> Numbers:
    """Misfit of Eq. (a) to A(t), of the load that is fitted worst."""
    time, area = evidence["aging"]["time"].values, evidence.samples("aging", "area", k1=k1)
    worst = mean_of(lambda mean: max(saturation(time, curve).rms_residual for curve in mean), area)
    yield Number("worst", worst, _loads(evidence))


@claim("saturation-limit", each="aging.k1", limit=(0.95, 1.05))
def saturation_limit(evidence: Evidence, k1: float) -> Numbers:
    """The a of Eq. (a) over A(infinity)/A(0), at the lightest and the heaviest load."""
    time, (lightest, *_, heaviest) = evidence["aging"]["time"].values, evidence.values("aging", "load")
    for load in (lightest, heaviest):
        both = (evidence.samples("aging", name, k1=k1, load=load) for name in ("area", "relaxed_area"))
        over = mean_of(lambda area, limit: saturation(time, area).a * area[0] / limit, *both)
        yield Number("limit", over, {"load": load, "sites": evidence.sites("aging")})


@claim("q-beta", each="aging.k1", beta=(0.4, 0.6))
def exponent_of_q(evidence: Evidence, k1: float) -> Numbers:
    """Exponent of the load in q; also from fits that end early."""
    area = evidence.samples("aging", "area", k1=k1)
    seen = tuple(_law_exponent(evidence, area.mean(axis=0), "q", last) for last in (1e3, 1e4, 1e5))
    exponent = mean_of(lambda mean: _law_exponent(evidence, mean, "q"), area)
    yield Number("beta", exponent, {"seen": seen, **_loads(evidence)})


@claim("c-finite", each="aging.k1", C=(-0.2, 0.2))
def exponent_of_c(evidence: Evidence, k1: float) -> Numbers:
    """Exponent of the load in C = (a - 1) q; C of the lightest load beside the slope of few contacts."""
    area = evidence.samples("aging", "area", k1=k1)
    lightest = saturation(evidence["aging"]["time"].values, area.mean(axis=0)[0]).C
    exponent = mean_of(lambda mean: _law_exponent(evidence, mean, "C"), area)
    yield Number("C", exponent, {"C": lightest, "few": float(late_slope(k1)), **_loads(evidence)})


@claim("logarithm", each="aging.k1", even=EVEN)
def logarithm_at_light_load(evidence: Evidence, k1: float) -> Numbers:
    """Late over early growth at a light load, 1 for a logarithm."""
    time, light = evidence["aging"]["time"].values, evidence.values("aging", "load")[1]
    even = mean_of(lambda mean: evenness(time, mean), evidence.samples("aging", "area", k1=k1, load=light))
    yield Number("even", even, {"load": light, "sites": evidence.sites("aging")})


@claim("b-load", each="aging.k1", drift=(-0.1, 0.1))
def slope_and_load(evidence: Evidence, k1: float) -> Numbers:
    """Slope d ln B / d ln F of light loads, beside that of contacts that do not feel each other."""
    time, load = evidence["aging"]["time"].values, evidence["aging"]["load"].values[:3]

    def drift(mean: Field) -> float:
        return exponent(load, np.array([growth_slope(time, curve, *EARLY) for curve in mean]))

    a_site = load / evidence.sites("aging")
    few = np.array([dilute_area(p, compliance(k1, time), GaussianHeights()) for p in a_site])
    slopes = mean_of(drift, evidence.samples("aging", "area", k1=k1)[:, :3])
    yield Number("drift", slopes, {"few": drift(few), **_loads(evidence, 3)})


def _surfaces(evidence: Evidence) -> list[Field]:
    """Rough surfaces of the study, one a seed, made again."""
    side = round(evidence.sites("load") ** 0.5)
    return [gaussian((side, side), seed=int(seed)) for seed in evidence["load"]["seed"].values]


def _loads(evidence: Evidence, count: int | None = None) -> dict[str, object]:
    """All loads, or the lightest ones, and the number of sites that share them."""
    return {"loads": evidence.values("aging", "load")[:count], "sites": evidence.sites("aging")}


def _law_exponent(evidence: Evidence, mean: Field, parameter: str, last: float = inf) -> float:
    """Exponent of the load in a parameter of the saturation law, fitted up to a last time."""
    time, load = (evidence["aging"][name].values for name in ("time", "load"))
    fitted_range = within(time, 0.0, last)
    fitted = [getattr(saturation(time[fitted_range], curve[fitted_range]), parameter) for curve in mean]
    return exponent(load, np.array(fitted))
