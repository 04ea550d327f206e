"""Section 3 of the paper, independent heights: how the area grows, and how the load drifts."""

from __future__ import annotations

import numpy as np

from asperity.fits import saturation
from asperity.fits.resampling import Estimate
from asperity.lattice import Field
from asperity.paper.claims.measures import (
    EVEN,
    between,
    evenness,
    evenness_in_words,
    exponent,
    growth_slope,
    mean_of,
)
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding, Measurement
from asperity.paper.wording import AREA, K0, K_EFF, LOAD, REDUCED_TIME, TIME, per_site, ratio
from asperity.theory import GaussianHeights, compliance, dilute_area, late_slope

PLACE = "Section 3"
EARLY = (1.0, 100.0)
"""Reduced times when growth is late for one contact, and contacts do not feel each other yet."""


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """All claims on growth."""
    return (
        load_drifts(evidence),
        saturation_law(evidence),
        saturation_limit(evidence),
        exponent_of_q(evidence),
        finite_slope(evidence),
        logarithm_at_light_load(evidence),
        slope_and_load(evidence),
    )


def load_drifts(evidence: Evidence) -> Finding:
    """F changes at constant separation."""
    series = evidence.samples("separation", "load", R_viscous=0.0)
    return Finding(
        key="load-drift",
        place=PLACE,
        claim=f"At constant separation the load {LOAD} changes in time.",
        measured=(
            Measurement(
                f"late {LOAD} over the first, without viscous creep",
                mean_of(lambda mean: float(mean[-1] / mean[0]), series),
                0.01,
                0.9,
            ),
        ),
    )


def saturation_law(evidence: Evidence) -> Finding:
    """Eq. (a) describes A(t)."""
    time = evidence["aging"]["time"].values

    def worst(mean: Field) -> float:
        return max(saturation(time, area).rms_residual for area in mean)

    return Finding(
        key="saturation",
        place=f"{PLACE}, Eq. (a); Fig. 3",
        claim=f"{AREA}({TIME})/{AREA}(0) = <i>a</i> − (<i>a</i> − 1)/({TIME}/{TIME}<sub>0</sub> + "
        "1)<sup><i>q</i></sup> describes all curves very well.",
        measured=tuple(
            Measurement(
                f"rms misfit over {AREA} of the load that is fitted worst, {ratio(k1)}",
                mean_of(worst, evidence.samples("aging", "area", k1=k1)),
                high=0.05,
            )
            for k1 in evidence.values("aging", "k1")
        ),
        note="Fits to the mean of the ensemble, all nine decades with one weight. The next line asks for "
        "more.",
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
        "logarithm more sharply than the law: it ends when the dips around the contacts meet.",
    )


def exponent_of_q(evidence: Evidence) -> Finding:
    """Q ~ F^beta."""
    reaches = (1e3, 1e4, 1e5)
    seen = "; ".join(
        f"{ratio(k1)}: "
        + ", ".join(f"{float(_law_exponent(evidence, k1, 'q', last).value):.2f}" for last in reaches)
        for k1 in evidence.values("aging", "k1")
    )
    return Finding(
        key="q-beta",
        place=f"{PLACE}; Fig. 3, inset; abstract",
        claim=f"The exponent goes to zero with the load as <i>q</i> ~ {LOAD}<sup>β</sup>, β close to 0.5.",
        measured=tuple(
            Measurement(f"β, {ratio(k1)}", _law_exponent(evidence, k1, "q", np.inf), 0.4, 0.6)
            for k1 in evidence.values("aging", "k1")
        ),
        note="Fits to the mean of the ensemble, all loads of Figure 3, all nine decades of time. β depends "
        "on how long contacts are followed, which the paper does not say: from fits that end at "
        f"{REDUCED_TIME} = 10<sup>3</sup>, 10<sup>4</sup> and 10<sup>5</sup> it is, at {seen}. A fit that "
        "does not see a light contact saturate takes too small a <i>q</i>.",
    )


def finite_slope(evidence: Evidence) -> Finding:
    """C = (a - 1) q stays finite."""
    time, lightest = evidence["aging"]["time"].values, evidence.values("aging", "load")[0]
    beside = []
    for k1 in evidence.values("aging", "k1"):
        area = evidence.samples("aging", "area", k1=k1, load=lightest).mean(axis=0)
        beside.append(f"{saturation(time, area).C:.2f} and {float(late_slope(k1)):.2f} at {ratio(k1)}")
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
        note="All loads of Figure 3. The range keeps 0, a finite limit, apart from the exponent of "
        f"<i>q</i>. <i>C</i> is the steepest slope of the law, not the late slope {K_EFF}/(8π{K0}) of few "
        f"contacts: they are, at the lightest load, {'; '.join(beside)}.",
    )


def logarithm_at_light_load(evidence: Evidence) -> Finding:
    """Equal growth in equal ratios of time."""
    time = evidence["aging"]["time"].values
    light = evidence.values("aging", "load")[1]
    return Finding(
        key="logarithm",
        place=f"{PLACE}, Eq. (log); abstract",
        claim="At light load the area grows like the logarithm of time.",
        measured=tuple(
            Measurement(
                f"{evenness_in_words()}, {ratio(k1)}, {per_site(light, evidence, 'aging')}",
                mean_of(
                    lambda mean: evenness(time, mean), evidence.samples("aging", "area", k1=k1, load=light)
                ),
                *EVEN,
            )
            for k1 in evidence.values("aging", "k1")
        ),
        note="For a logarithm the two are equal; for a power law <i>t</i><sup>1/4</sup> their ratio would "
        "be about 2.4.",
    )


def slope_and_load(evidence: Evidence) -> Finding:
    """Scaled with A(0), growth at light load does not depend on the load."""
    time, load = evidence["aging"]["time"].values, np.array(evidence.values("aging", "load"))[:3]

    def drift(mean: Field) -> float:
        return exponent(load, np.array([growth_slope(time, area, *EARLY) for area in mean[:3]]))

    def of_few(k1: float) -> float:
        compliances, a_site = compliance(k1, time), load / evidence.sites("aging")
        return drift(np.array([dilute_area(p, compliances, GaussianHeights()) for p in a_site]))

    few = ", ".join(f"{of_few(k1):.2f} at {ratio(k1)}" for k1 in evidence.values("aging", "k1"))
    return Finding(
        key="b-load",
        place="Section 5, end",
        claim=f"For small loads {AREA}({TIME})/{AREA}(0) does not depend on the load.",
        measured=tuple(
            Measurement(
                f"d ln <i>B</i> / d ln {LOAD}, {ratio(k1)}",
                mean_of(drift, evidence.samples("aging", "area", k1=k1)),
                -0.1,
                0.1,
            )
            for k1 in evidence.values("aging", "k1")
        ),
        note=f"The three lightest loads of Figure 3; <i>B</i> is the slope of {AREA}/{AREA}(0) in ln {TIME} "
        f"for {REDUCED_TIME} from {EARLY[0]:g} to {EARLY[1]:g}, before the dips around contacts meet, from "
        "when on growth does depend on the load. The theory of few contacts for Gaussian heights, in which "
        f"contacts do not feel each other at all, has {few}; it tends to 0 like an inverse logarithm of the "
        "load.",
    )


def _ends(evidence: Evidence) -> tuple[float, float]:
    """Lightest and heaviest load of the aging curves."""
    chosen = evidence.values("aging", "load")
    return chosen[0], chosen[-1]


def _law_exponent(evidence: Evidence, k1: float, parameter: str, last: float) -> Estimate:
    """Exponent, in the load, of a parameter of the saturation law fitted up to a last time."""
    time, load = evidence["aging"]["time"].values, np.array(evidence.values("aging", "load"))
    here = between(time, 0.0, last)

    def statistic(mean: Field) -> float:
        fitted = [getattr(saturation(time[here], area[here]), parameter) for area in mean]
        return exponent(load, np.array(fitted))

    return mean_of(statistic, evidence.samples("aging", "area", k1=k1))
