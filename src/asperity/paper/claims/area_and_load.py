"""Section 3 of the paper, independent heights: area against load, before creep and relaxed."""

from __future__ import annotations

import numpy as np
import xarray as xr

from asperity.fits.resampling import jackknife
from asperity.lattice import Field
from asperity.paper.claims.measures import between, crossing, exponent, mean_of
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding, Measurement, exact
from asperity.paper.wording import AREA, K0, K1, LOAD, REDUCED_TIME, SITES, TIME, ratio
from asperity.surfaces import gaussian
from asperity.theory import (
    GaussianHeights,
    dilute_area,
    full_contact_load,
    full_contact_load_relaxed,
    site_stiffness,
    winkler_area,
)

PLACE = "Section 3"
LIGHT = (1e-3, 3e-2)
"""Contact fractions called light, before creep."""
LOW = (1e-3, 1e-1)
"""Contact fractions of relaxed states called low."""


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """All claims on area against load."""
    return (
        proportional_to_load(evidence),
        stiffer_spring_sets_crossover(evidence),
        independent_springs(evidence),
        relaxed_is_larger(evidence),
        relaxed_forgets_k1(evidence),
        relaxed_full_contact(evidence),
        no_lateral_spring(evidence),
        relaxed_exponent(evidence),
    )


def proportional_to_load(evidence: Evidence) -> Finding:
    """A ~ F at low load."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    plain, beside_theory = [], []
    for k1 in evidence.values("load", "k1"):
        area = evidence.samples("load", "initial_area", k1=k1)
        light = between(area.mean(axis=0) / sites, *LIGHT)
        compliance = float(1 / site_stiffness(k1))
        theory = exponent(load[light], dilute_area(load[light] / sites, compliance, GaussianHeights()))
        slope_of = f"d ln {AREA} / d ln {LOAD} at {ratio(k1)}"
        found = mean_of(lambda mean, light=light: exponent(load[light], mean[light]), area)
        plain.append(Measurement(slope_of, found, 0.9, 1.1))
        if k1 >= 1:
            over = mean_of(
                lambda mean, light=light, theory=theory: exponent(load[light], mean[light]) / theory, area
            )
            beside_theory.append(
                Measurement(f"{slope_of}, over {theory:.3f} of independent asperities", over, 0.95, 1.05)
            )
    return Finding(
        key="slope-1",
        place=f"{PLACE}; Fig. 2",
        claim="At low load the contact area is essentially proportional to the load.",
        measured=tuple(plain),
        corrected=tuple(beside_theory),
        correction=f"where the springs to the bulk are not the softer ones ({K1} ≥ {K0}), the exponent is "
        "that of independent asperities of Gaussian heights, which tends to 1 like an inverse logarithm of "
        "the load",
        note=f"Contact fractions from {LIGHT[0]:g} to {LIGHT[1]:g}. The range keeps 1 apart from the 0.8 of "
        "relaxed and of self-affine contacts. Springs to the bulk that are much softer than those between "
        "neighbors bring the instantaneous contact close to the relaxed one.",
    )


def stiffer_spring_sets_crossover(evidence: Evidence) -> Finding:
    """The load of half contact follows the larger of k0 and k1."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    stiffness = evidence.values("load", "k1")
    area = np.asarray(evidence["load"]["initial_area"].transpose("seed", "k1", "load"), dtype=np.float64)
    law = GaussianHeights()

    def half(mean: Field, k1: float) -> float:
        return crossing(load / sites, mean[stiffness.index(k1)] / sites, 0.5)

    soft, softer, stiff = stiffness[1], stiffness[0], stiffness[-1]
    alone = float(law.mean_excess(0.0)) * stiff  # half of the sites lie above the mean
    return Finding(
        key="crossover",
        place=f"{PLACE}; Fig. 2",
        claim="Where one spring constant dominates, the load that separates partial from full contact is "
        "proportional to that one.",
        measured=(
            Measurement(
                f"load of half contact at {ratio(softer)} over that at {ratio(soft)}: {K0} dominates, {K1} "
                "must not matter",
                mean_of(lambda mean: half(mean, softer) / half(mean, soft), area),
                0.9,
                1.1,
            ),
            Measurement(
                f"load of half contact at {ratio(stiff)} over that of independent springs, "
                f"{alone / stiff:.3f} {K1} σ a site",
                mean_of(lambda mean: half(mean, stiff) / alone, area),
                0.9,
                1.1,
            ),
        ),
        note="Half contact stands for the crossover: full contact of every site hangs on the single lowest "
        "one.",
    )


def independent_springs(evidence: Evidence) -> Finding:
    """Full contact at a load per spring of order k1 sigma, for k1 >> k0."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    stiff = evidence.values("load", "k1")[-1]
    area = evidence.samples("load", "initial_area", k1=stiff)
    springs = winkler_area(load / sites, stiff, GaussianHeights())
    partial = between(springs, 0.1, 0.99)
    full = [full_contact_load(heights, k0=1.0, k1=stiff) / (sites * stiff) for heights in _surfaces(evidence)]
    return Finding(
        key="winkler",
        place=f"{PLACE}; Fig. 2",
        claim=f"Where {K0} is negligible the surface is a set of independent springs, with full contact at a "
        f"load of order {K1} σ a spring.",
        measured=(
            Measurement(
                f"load a spring over {K1} σ from which on every site touches, closed form for each surface, "
                f"{ratio(stiff)}",
                mean_of(float, np.array(full)),
                1.0,
                10.0,
            ),
            Measurement(
                f"area over the closed form for {K0} = 0, mean over contact fractions from 0.1 to 0.99",
                mean_of(lambda mean: float(np.mean(mean[partial] / sites / springs[partial])), area),
                0.9,
                1.1,
            ),
        ),
        note="Full contact hangs on the lowest site alone; its load grows without bound with the size of "
        "the system, though slowly.",
    )


def relaxed_is_larger(evidence: Evidence) -> Finding:
    """A(infinity) > A(0) at the same load."""
    measured, ties = [], 0
    for study, surfaces in (("load", "independent heights"), ("self_affine_load", "self-affine surfaces")):
        data = evidence[study]
        before, after = xr.broadcast(data["initial_area"], data["relaxed_area"])
        partial = before < data["sites"]
        ties += int(((after == before) & partial).sum())
        measured.append(
            Measurement(
                f"of {int(partial.sum())} contacts that were not full, those whose area shrank: {surfaces}",
                exact(float((after < before).sum())),
                0,
                0,
            )
        )
    return Finding(
        key="relaxed-larger",
        place=f"{PLACE}; captions of Figs. 2 and 5",
        claim="The fully relaxed area is always larger than the instantaneous one at the same load.",
        measured=tuple(measured),
        note=f"Every surface, load and stiffness ratio is one contact. {ties} of them tie, as may happen "
        "where one asperity carries the load, or a few sites are missing to full contact.",
    )


def relaxed_forgets_k1(evidence: Evidence) -> Finding:
    """A(infinity) depends on F/k0 alone."""
    last = float(evidence["aging"]["time"][-1])

    def reached(late: Field, limit: Field) -> float:
        return float(np.mean(late.mean(axis=0) / limit.mean(axis=0)))

    measured = []
    for k1 in evidence.values("aging", "k1"):
        late = evidence.samples("aging", "area", k1=k1, time=last)
        limit = evidence.samples("aging", "relaxed_area", k1=k1)
        measured.append(
            Measurement(
                f"{AREA} at {REDUCED_TIME} = {last:g} over the relaxed area, which is computed without {K1}, "
                f"mean over loads, {ratio(k1)}",
                jackknife(reached, (late, limit)),
                0.99,
                1.01,
            )
        )
    return Finding(
        key="relaxed-k1",
        place=f"{PLACE}; Fig. 2",
        claim=f"The relaxed area is a function of {LOAD}/{K0}: {K1} is irrelevant.",
        measured=tuple(measured),
        note=f"In the state in which all springs to the bulk carry the same force {K1} drops out of the "
        f"equations; what is tested is that contacts of any {K1} creep to that state.",
    )


def relaxed_full_contact(evidence: Evidence) -> Finding:
    """Full contact in the relaxed state above a load that is proportional to k0, known for each surface."""
    data = evidence["load"]
    sites = evidence.sites("load")
    wrong = 0
    for seed, heights in zip(data["seed"].values, _surfaces(evidence), strict=True):
        enough = data["load"].values >= full_contact_load_relaxed(heights, k0=1.0)
        full = data["relaxed_area"].sel(seed=seed).transpose("load", ...).values == sites
        wrong += int((full != enough[:, None]).sum())
    return Finding(
        key="relaxed-full",
        place=PLACE,
        claim=f"The relaxed contact is not full unless the load exceeds a crossover proportional to {K0}.",
        measured=(
            Measurement(
                f"relaxed contacts that contradict the exact condition {LOAD} ≥ {SITES}{K0} max ∇²ξ for full "
                "contact",
                exact(float(wrong)),
                0,
                0,
            ),
        ),
        note=f"The condition is a closed form for each given surface; it is linear in {K0} and does not "
        f"contain {K1}.",
    )


def no_lateral_spring(evidence: Evidence) -> Finding:
    """Full contact as t -> infinity when k0 = 0."""
    data = evidence["no_lateral"]
    sites = evidence.sites("no_lateral")
    late = np.asarray(data["area"].isel(time=-1).transpose("seed", "load"), dtype=np.float64)
    lightest = evidence.values("no_lateral", "load")[0]
    return Finding(
        key="no-lateral",
        place=PLACE,
        claim=f"Without lateral springs, {K0} = 0, the area tends to the nominal one as time goes to "
        "infinity.",
        measured=(
            Measurement(
                f"smallest contact fraction reached by {TIME} = {float(data['time'][-1]):g} / ({K1} "
                "<i>R</i>), over all loads",
                exact(float(late.min() / sites)),
                1,
                1,
            ),
            Measurement(
                f"contact fraction before creep at the lightest load, {lightest / sites:.2g} {K1} σ a site",
                mean_of(
                    lambda mean: mean / sites, evidence.samples("no_lateral", "initial_area", load=lightest)
                ),
                high=0.5,
            ),
        ),
        note="Followed through time, not solved for the limit.",
    )


def relaxed_exponent(evidence: Evidence) -> Finding:
    """A(infinity) ~ F^0.8, and how the exponent drifts."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    area = evidence.samples("load", "relaxed_area", k1=evidence.values("load", "k1")[0])
    low = np.flatnonzero(between(area.mean(axis=0) / sites, *LOW))
    lower, upper = low[: (low.size + 1) // 2], low[low.size // 2 :]

    def drift(mean: Field) -> float:
        return exponent(load[lower], mean[lower]) - exponent(load[upper], mean[upper])

    one = Measurement(
        "<i>p</i>, one exponent for all low loads",
        mean_of(lambda mean: exponent(load[low], mean[low]), area),
        0.75,
        0.85,
    )
    bends = Measurement(
        "<i>p</i> of the lower half of these loads less <i>p</i> of the upper half; 0 for a power law",
        mean_of(drift, area),
        -0.03,
        0.03,
    )
    return Finding(
        key="relaxed-0.8",
        place=PLACE,
        claim=f"At low loads the relaxed area follows a power law {AREA}(∞) ~ {LOAD}<sup><i>p</i></sup> with "
        "<i>p</i> about 0.8.",
        measured=(one, bends),
        corrected=(one,),
        correction="about 0.8 is the mean exponent of these loads; it drifts",
        note=f"Contact fractions from {LOW[0]:g} to {LOW[1]:g}. Another choice of loads gives another "
        "exponent, as far as it drifts.",
    )


def _surfaces(evidence: Evidence) -> list[Field]:
    """Rough surfaces of the study, one a seed, made again."""
    side = round(evidence.sites("load") ** 0.5)
    return [gaussian((side, side), seed=int(seed)) for seed in evidence["load"]["seed"].values]
