"""Section 3 of the paper: independent Gaussian heights."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asperity.fits import saturation
from asperity.fits.resampling import Estimate
from asperity.lattice import Field, Mask
from asperity.paper.claims.measures import between, crossing, exponent, growth_slope, mean_of
from asperity.paper.claims.wording import AREA, K0, K1, LOAD, REDUCED_TIME, TIME, per_site, ratio
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding, Measurement, exact
from asperity.surfaces import gaussian
from asperity.theory import GaussianHeights, full_contact_load_relaxed, winkler_area

PLACE = "Section 3"
LIGHT = (1e-3, 3e-2)
"""Contact fractions called light, before creep."""
LOW = (1e-3, 1e-1)
"""Contact fractions of relaxed states called low."""
ENOUGH = 5e-3
"""Contact fraction before creep below which an ensemble has too few contacts to fit the law to."""
REACH = 1e4
"""Reduced time up to which the paper's scheme may have followed its contacts."""


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """All claims of the section."""
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
        load_drifts(evidence),
        saturation_law(evidence),
        saturation_limit(evidence),
        exponent_of_q(evidence),
        exponent_of_q_in_time(evidence),
        finite_slope(evidence),
        logarithm_at_light_load(evidence),
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
                0,
                0.5,
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


def load_drifts(evidence: Evidence) -> Finding:
    """F changes at constant separation."""
    share = _last_load(evidence, 0.0)
    return Finding(
        key="load-drift",
        place=PLACE,
        claim=f"At constant separation the load {LOAD} changes in time.",
        measured=(Measurement(f"late {LOAD} over the first, without viscous creep", share, 0.01, 0.9),),
        note="It falls, to a limit above zero.",
    )


def saturation_law(evidence: Evidence) -> Finding:
    """Eq. (a) describes A(t)."""
    measured = []
    time = evidence["aging"]["time"].values
    for k1 in evidence.values("aging", "k1"):
        for load in _ends(evidence):
            area = evidence.samples("aging", "area", k1=k1, load=load)
            measured.append(
                Measurement(
                    f"rms misfit over {AREA}, {ratio(k1)}, {per_site(load, evidence, 'aging')}",
                    mean_of(lambda mean: saturation(time, mean).rms_residual, area),
                    0,
                    0.05,
                )
            )
    return Finding(
        key="saturation",
        place=f"{PLACE}, Eq. (a); Fig. 3",
        claim=f"{AREA}({TIME})/{AREA}(0) = <i>a</i> − (<i>a</i> − 1)/({TIME}/{TIME}<sub>0</sub> + "
        "1)<sup><i>q</i></sup> "
        "describes all curves very well.",
        measured=tuple(measured),
        note="Lightest and heaviest load; fits to the mean of the ensemble, all nine decades with one "
        "weight. "
        "5 % is about the size of a symbol on the paper's figure; the next line asks for more.",
    )


def saturation_limit(evidence: Evidence) -> Finding:
    """The a of Eq. (a) is A(infinity)/A(0)."""
    measured = []
    time = evidence["aging"]["time"].values
    for k1 in evidence.values("aging", "k1"):
        for load in _ends(evidence):
            area = evidence.samples("aging", "area", k1=k1, load=load)
            limit = evidence.samples("aging", "relaxed_area", k1=k1, load=load)
            both = np.column_stack([area, limit])
            measured.append(
                Measurement(
                    f"fitted <i>a</i> over {AREA}(∞)/{AREA}(0), {ratio(k1)}, "
                    f"{per_site(load, evidence, 'aging')}",
                    mean_of(lambda mean: saturation(time, mean[:-1]).a * mean[0] / mean[-1], both),
                    0.95,
                    1.05,
                )
            )
    return Finding(
        key="saturation-limit",
        place=f"{PLACE}, Eq. (a)",
        claim="The area saturates toward its asymptotic value in the form of this power law.",
        measured=tuple(measured),
        note=f"{AREA}(∞) is computed directly, not extrapolated. At light loads the true curve leaves the "
        "logarithm more "
        "sharply than the law: it ends when the dips around the contacts meet.",
    )


def exponent_of_q(evidence: Evidence) -> Finding:
    """Q ~ F^beta."""
    return Finding(
        key="q-beta",
        place=f"{PLACE}; Fig. 3, inset; abstract",
        claim=f"The exponent goes to zero with the load as <i>q</i> ~ {LOAD}<sup>β</sup>, β close to 0.5.",
        measured=tuple(
            Measurement(
                f"β from fits up to {REDUCED_TIME} = {REACH:g}, {ratio(k1)}",
                _law_exponent(evidence, k1, "q", REACH),
                0.4,
                0.6,
            )
            for k1 in evidence.values("aging", "k1")
        ),
        note=f"Fits to the mean of the ensemble, loads with a contact fraction above {ENOUGH:g} before "
        f"creep. {REDUCED_TIME} = {REACH:g} is about what the paper's explicit "
        f"scheme reaches in 10<sup>5</sup> steps, each less than 0.11/({K0}<i>R</i>) for its stability. See "
        "the next line.",
    )


def exponent_of_q_in_time(evidence: Evidence) -> Finding:
    """Beta falls when contacts are followed for longer."""

    def drift(k1: float) -> Estimate:
        statistic, samples = _law_statistic(evidence, k1, "q")
        return mean_of(lambda mean: statistic(mean, last) - statistic(mean, REACH), samples)

    last = float(evidence["aging"]["time"][-1])
    return Finding(
        key="q-beta-time",
        place=f"{PLACE}; Fig. 3, inset",
        claim="β belongs to the curves, whichever part of them is fitted.",
        measured=tuple(
            Measurement(
                f"β from fits up to {REDUCED_TIME} = {last:g} less β from fits up to {REACH:g}, {ratio(k1)}",
                drift(k1),
                -0.05,
                0.05,
            )
            for k1 in evidence.values("aging", "k1")
        ),
        note="Implied where the law is said to describe all curves. At light loads <i>q</i> says how far "
        "the logarithm runs before the dips "
        "around the contacts meet, and a fit that does not see the end takes too small a value.",
    )


def finite_slope(evidence: Evidence) -> Finding:
    """C = (a - 1) q stays finite."""
    return Finding(
        key="c-finite",
        place=f"{PLACE}, Eq. (log)",
        claim=f"<i>C</i> = (<i>a</i> − 1) <i>q</i> is not singular as {LOAD} → 0.",
        measured=tuple(
            Measurement(
                f"d ln <i>C</i> / d ln {LOAD}, {ratio(k1)}",
                _law_exponent(evidence, k1, "C", np.inf),
                -0.2,
                0.2,
            )
            for k1 in evidence.values("aging", "k1")
        ),
        note="The range keeps 0, a finite limit, apart from the exponent of <i>q</i> itself.",
    )


def logarithm_at_light_load(evidence: Evidence) -> Finding:
    """Equal growth in equal ratios of time."""
    time = evidence["aging"]["time"].values
    light = evidence.values("aging", "load")[1]

    def evenness(mean: Field) -> float:
        return growth_slope(time, mean, 10**1.5, 1e3) / growth_slope(time, mean, 1.0, 10**1.5)

    return Finding(
        key="logarithm",
        place=f"{PLACE}, Eq. (log); abstract",
        claim="At light load the area grows like the logarithm of time.",
        measured=tuple(
            Measurement(
                f"growth from {REDUCED_TIME} = 32 to 1000 over that from 1 to 32, {ratio(k1)}, "
                f"{per_site(light, evidence, 'aging')}",
                mean_of(evenness, evidence.samples("aging", "area", k1=k1, load=light)),
                2 / 3,
                3 / 2,
            )
            for k1 in evidence.values("aging", "k1")
        ),
        note="For a logarithm the two are equal; for a power law <i>t</i><sup>1/4</sup> their ratio would "
        "be about 2.4.",
    )


def _relaxed(evidence: Evidence) -> tuple[Field, Field, Mask]:
    """Loads, relaxed areas (seeds first) and which of the loads are low."""
    load, sites = np.array(evidence.values("load", "load")), evidence.sites("load")
    area = evidence.samples("load", "relaxed_area", k1=evidence.values("load", "k1")[0])
    return load, area, between(area.mean(axis=0) / sites, *LOW)


def _last_load(evidence: Evidence, viscous: float) -> Estimate:
    series = evidence.samples("separation", "load", R_viscous=viscous)
    return mean_of(lambda mean: mean[-1] / mean[0], series)


def _ends(evidence: Evidence) -> tuple[float, float]:
    """Lightest and heaviest load of the aging curves."""
    chosen = evidence.values("aging", "load")
    return chosen[0], chosen[-1]


def _law_exponent(evidence: Evidence, k1: float, parameter: str, last: float) -> Estimate:
    """Exponent, in the load, of a parameter of the saturation law fitted up to a last time."""
    statistic, samples = _law_statistic(evidence, k1, parameter)
    return mean_of(lambda mean: statistic(mean, last), samples)


def _law_statistic(
    evidence: Evidence, k1: float, parameter: str
) -> tuple[Callable[[Field, float], float], Field]:
    """The same as a statistic of mean areas, shape (loads, times), with the areas of all seeds."""
    samples = evidence.samples("aging", "area", k1=k1)
    enough = samples[..., 0].mean(axis=0) / evidence.sites("aging") >= ENOUGH
    time, load = evidence["aging"]["time"].values, np.array(evidence.values("aging", "load"))[enough]

    def statistic(mean: Field, last: float) -> float:
        here = between(time, 0.0, last)
        fitted = [getattr(saturation(time[here], area[here]), parameter) for area in mean]
        return exponent(load, np.array(fitted))

    return statistic, samples[:, enough]
