"""Section 3 of the paper, independent heights: area against load, before creep and relaxed."""

from __future__ import annotations

import numpy as np

from asperity.lattice import Field, Mask
from asperity.paper.claims.measures import between, crossing, exponent, mean_of
from asperity.paper.claims.wording import AREA, K0, K1, LOAD, TIME, ratio
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding, Measurement, exact
from asperity.surfaces import gaussian
from asperity.theory import GaussianHeights, full_contact_load_relaxed, winkler_area

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
        relaxed_power_law(evidence),
    )


def proportional_to_load(evidence: Evidence) -> Finding:
    """A ~ F at low load."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    measured = {}
    for k1 in evidence.values("load", "k1"):
        area = evidence.samples("load", "initial_area", k1=k1)
        light = between(area.mean(axis=0) / sites, *LIGHT)
        measured[k1] = Measurement(
            f"d ln {AREA} / d ln {LOAD} at {ratio(k1)}",
            mean_of(lambda mean, light=light: exponent(load[light], mean[light]), area),
            0.85,
            1.15,
        )
    softest = next(iter(measured))
    return Finding(
        key="slope-1",
        place=f"{PLACE}; Fig. 2",
        claim="At low load the contact area is essentially proportional to the load.",
        measured=tuple(one for k1, one in measured.items() if k1 >= 1),
        note=f"Contact fractions from {LIGHT[0]:g} to {LIGHT[1]:g}, {K1} ≥ {K0}; within the range, area "
        "over load "
        "changes by less than 40 % in a decade of load. Gaussian heights give proportionality only up to a "
        "logarithm. Softer springs to the bulk bring the instantaneous contact close to the relaxed one, "
        "and "
        f"the exponent with it: {float(measured[softest].estimate.value):.2f} at {ratio(softest)}.",
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
        "proportional "
        "to that one.",
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
    )


def independent_springs(evidence: Evidence) -> Finding:
    """Full contact at a load per spring of order k1 sigma, for k1 >> k0."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    stiff = evidence.values("load", "k1")[-1]
    area = evidence.samples("load", "initial_area", k1=stiff)
    exact_area = winkler_area(load / sites, stiff, GaussianHeights())
    partial = between(exact_area, 0.1, 0.99)
    return Finding(
        key="winkler",
        place=f"{PLACE}; Fig. 2",
        claim=f"Where {K0} is negligible the surface is a set of independent springs, with full contact at "
        "a load of order "
        f"{K1} σ a spring.",
        measured=(
            Measurement(
                f"load a site over {K1} σ at which 97.7 % touch, {ratio(stiff)}",
                mean_of(lambda mean: crossing(load / sites, mean / sites, 0.977) / stiff, area),
                1.0,
                4.0,
            ),
            Measurement(
                f"area over the closed form for {K0} = 0, mean over contact fractions from 0.1 to 0.99",
                mean_of(lambda mean: float(np.mean(mean[partial] / sites / exact_area[partial])), area),
                0.9,
                1.1,
            ),
        ),
        note="Independent springs have 97.7 % of the sites of Gaussian heights in contact at 2 σ below the "
        "mean, under "
        f"2.01 {K1} σ a spring. Full contact of every site depends on the single lowest one and grows "
        "without bound with "
        "the size of the system.",
    )


def relaxed_is_larger(evidence: Evidence) -> Finding:
    """A(infinity) >= A(0) at the same load."""
    data = evidence["load"]
    before, after = data["initial_area"].values, data["relaxed_area"].values
    partial = before < evidence.sites("load")
    return Finding(
        key="relaxed-larger",
        place=f"{PLACE}; caption of Fig. 2",
        claim="The fully relaxed area is always larger than the instantaneous one at the same load.",
        measured=(
            Measurement(
                f"of {int(partial.sum())} contacts that were not full, those whose area did not grow",
                exact(float((after <= before)[partial].sum())),
                0,
                0,
            ),
        ),
        note="Every surface, load and stiffness ratio of the study is one contact. Contacts so light that "
        "one asperity "
        "carries them, and nearly full ones, are the ones that may tie.",
    )


def relaxed_forgets_k1(evidence: Evidence) -> Finding:
    """A(infinity) depends on F/k0 alone."""
    area = evidence["load"]["relaxed_area"]
    return Finding(
        key="relaxed-k1",
        place=f"{PLACE}; Fig. 2",
        claim=f"The relaxed area is a function of {LOAD}/{K0}: {K1} is irrelevant.",
        measured=(
            Measurement(
                "largest difference of the relaxed area between stiffness ratios, same surface and load, in "
                "sites",
                exact(float((area.max("k1") - area.min("k1")).max())),
                0,
                0,
            ),
        ),
    )


def relaxed_full_contact(evidence: Evidence) -> Finding:
    """Full contact in the relaxed state above a load that is proportional to k0, known for each surface."""
    data = evidence["load"]
    sites = evidence.sites("load")
    side = round(sites**0.5)
    wrong = 0
    for seed in data["seed"].values:
        heights = gaussian((side, side), seed=int(seed))
        enough = data["load"].values >= full_contact_load_relaxed(heights, k0=1.0)
        full = data["relaxed_area"].sel(seed=seed).transpose("load", ...).values == sites
        wrong += int((full != enough[:, None]).sum())
    return Finding(
        key="relaxed-full",
        place=PLACE,
        claim=f"The relaxed contact is not full unless the load exceeds a crossover proportional to {K0}.",
        measured=(
            Measurement(
                f"relaxed contacts that contradict the exact condition {LOAD} ≥ <i>N</i> {K0} max ∇²ξ for "
                "full contact",
                exact(float(wrong)),
                0,
                0,
            ),
        ),
        note="The condition is a closed form for each given surface; it is linear in "
        f"{K0} and does not contain {K1}.",
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
    """A(infinity) ~ F^0.8."""
    load, area, low = _relaxed(evidence)
    return Finding(
        key="relaxed-0.8",
        place=PLACE,
        claim=f"At low loads the relaxed area follows a power law {AREA}(∞) ~ {LOAD}<sup><i>p</i></sup> "
        "with <i>p</i> about 0.8.",
        measured=(
            Measurement(
                "<i>p</i>, one exponent for all low loads",
                mean_of(lambda mean: exponent(load[low], mean[low]), area),
                0.75,
                0.85,
            ),
        ),
        note=f"Contact fractions from {LOW[0]:g} to {LOW[1]:g}. The number depends on this choice: see the "
        "next line.",
    )


def relaxed_power_law(evidence: Evidence) -> Finding:
    """The exponent of A(infinity) drifts."""
    load, area, low = _relaxed(evidence)
    lower, upper = np.array_split(np.flatnonzero(low), 2)
    upper = np.concatenate([lower[-1:], upper])

    def drift(mean: Field) -> float:
        return exponent(load[lower], mean[lower]) - exponent(load[upper], mean[upper])

    return Finding(
        key="relaxed-drift",
        place=PLACE,
        claim=f"The relaxed area {AREA}(∞) is a power law of the load: one exponent serves all low loads.",
        measured=(
            Measurement(
                "<i>p</i> of the lower half of these loads less <i>p</i> of the upper half",
                mean_of(drift, area),
                -0.03,
                0.03,
            ),
        ),
        note="0.8 is what a line through a curve gives: log-log, the curve bends all the way from first "
        "contact to full contact.",
    )


def _relaxed(evidence: Evidence) -> tuple[Field, Field, Mask]:
    """Loads, relaxed areas (seeds first) and which of the loads are low."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    area = evidence.samples("load", "relaxed_area", k1=evidence.values("load", "k1")[0])
    return load, area, between(area.mean(axis=0) / sites, *LOW)
