"""Section 3 of the paper, independent heights: how the area grows, and how the load drifts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asperity.fits import saturation
from asperity.fits.resampling import Estimate
from asperity.lattice import Field
from asperity.paper.claims.measures import between, exponent, growth_slope, mean_of
from asperity.paper.claims.wording import AREA, K0, LOAD, REDUCED_TIME, TIME, per_site, ratio
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding, Measurement

PLACE = "Section 3"
ENOUGH = 5e-3
"""Contact fraction before creep below which an ensemble has too few contacts to fit the law to."""
REACH = 1e4
"""Reduced time up to which the paper's scheme may have followed its contacts."""


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """All claims on growth."""
    return (
        load_drifts(evidence),
        saturation_law(evidence),
        saturation_limit(evidence),
        exponent_of_q(evidence),
        exponent_of_q_in_time(evidence),
        finite_slope(evidence),
        logarithm_at_light_load(evidence),
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
                    high=0.05,
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
