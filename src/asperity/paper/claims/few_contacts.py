"""Section 5 of the paper: few contacts, far apart, and the response to a force at one point."""

from __future__ import annotations

import math

import numpy as np

from asperity.lattice import Field
from asperity.paper.claims.measures import between, growth_slope, mean_of, slope
from asperity.paper.claims.wording import AREA, K0, K1, K_EFF, LOAD, REDUCED_TIME, ratio
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding, Measurement, exact
from asperity.theory import (
    LATE_INTERCEPT,
    LATE_SLOPE,
    GaussianHeights,
    compliance,
    dilute_area,
    exponential_growth,
    exponential_growth_paper,
    site_stiffness,
    torus_compliance,
)

PLACE = "Section 5"
G = "<i>G</i>"
X1 = "<i>x</i><sub>1</sub>"
X2 = "<i>x</i><sub>2</sub>"
DILUTE = (10.0, 1e3)
"""Reduced times, under conserving creep, when growth is late but the dips around contacts have not met."""
_LATE = np.geomspace(1e8, 1e12, 9)
_RATIOS = (0.3, 1.0, 3.0, 10.0)


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """All claims of the section."""
    return (
        late_slope_of_compliance(),
        late_intercept_of_compliance(),
        compliance_in_the_engine(evidence),
        contacts_at_start(evidence),
        growth_of_contacts(evidence),
        late_slope_of_area(evidence),
        gaussian_like_exponential(),
    )


def late_slope_of_compliance() -> Finding:
    """a0 = 0.04, for every x1."""
    return Finding(
        key="a0",
        place=f"{PLACE}; Fig. 8",
        claim=f"{G}({X1}, {X2}) grows as <i>a</i><sub>0</sub> ln {X2} at late times, <i>a</i><sub>0</sub> = "
        f"0.04 whatever {X1}.",
        measured=tuple(
            Measurement(
                f"d{G}/d ln {X2} at {X2} from 10<sup>8</sup> to 10<sup>12</sup>, {X1} = {x1:g}",
                exact(slope(np.log(_LATE), compliance(x1, _LATE))),
                0.035,
                0.045,
            )
            for x1 in _RATIOS
        ),
        note=f"The closed form is 1/(8π) = {LATE_SLOPE:.7f}.",
    )


def late_intercept_of_compliance() -> Finding:
    """a1 = 0.3."""
    return Finding(
        key="a1",
        place="Caption of Fig. 8",
        claim=f"Late, {G} is <i>a</i><sub>0</sub> ln {X2} + <i>a</i><sub>1</sub> with <i>a</i><sub>1</sub> "
        "= 0.3.",
        measured=tuple(
            Measurement(
                f"{G} − ln({X2})/(8π) at {X2} = 10<sup>12</sup>, {X1} = {x1:g}",
                exact(float(compliance(x1, 1e12)) - LATE_SLOPE * math.log(1e12)),
                0.25,
                0.35,
            )
            for x1 in _RATIOS
        ),
        note=f"The closed form is (10 ln 2 + γ)/(8π) = {LATE_INTERCEPT:.7f} with the eigenvalues of the "
        "square lattice; with "
        "<i>q</i>² in their place, as the paper writes, it would be 0.2227.",
    )


def compliance_in_the_engine(evidence: Evidence) -> Finding:
    """The simulated indentation is f0 G / k0."""
    data = evidence["point"]
    side = round(evidence.sites("point") ** 0.5)
    time = data["time"].values
    worst = 0.0
    for k1 in evidence.values("point", "k1"):
        depth = data["approach"].sel(k1=k1, R_viscous=0.0).values
        # From the first contact on; the mode q = 0 adds 1/(k1 N) at all times and cancels.
        theory = torus_compliance(k1, time, (side, side)) - torus_compliance(k1, 0.0, (side, side))
        late = theory > 1e-3 * theory[-1]
        worst = max(worst, float(np.max(np.abs(depth[late] / theory[late] - 1))))
    return Finding(
        key="compliance-engine",
        place=f"{PLACE}, Eqs. (uq), (u); Fig. 8",
        claim=f"Under a constant force {LOAD} at one site the surface sinks by {LOAD}{G}({K1}/{K0}, "
        f"{REDUCED_TIME})/{K0}.",
        measured=(
            Measurement(
                "largest relative deviation of the simulated creep depth from the closed form on the same "
                "finite lattice",
                exact(worst),
                high=5e-3,
            ),
        ),
        note="The simulation knows nothing of the closed form: this checks the engine as much as the paper.",
    )


def contacts_at_start(evidence: Evidence) -> Finding:
    """N(0) = gamma f0 / k1, or rather k_eff."""
    load = float(evidence["exponential"]["held"].max())
    letter, corrected = [], []
    for k1 in evidence.values("exponential", "k1"):
        area = evidence.samples("exponential", "initial_area", k1=k1, R_viscous=0.0)
        stiffness = float(site_stiffness(k1))
        letter.append(
            Measurement(
                f"{AREA}(0) over γ{LOAD}/{K1}, {ratio(k1)}",
                mean_of(lambda mean, k1=k1: float(mean) * k1 / load, area),
                0.8,
                1.25,
            )
        )
        corrected.append(
            Measurement(
                f"{AREA}(0) over 1 + γ{LOAD}/{K_EFF}, {ratio(k1)}",
                mean_of(lambda mean, k=stiffness: float(mean) / (1 + load / k), area),
                0.8,
                1.25,
            )
        )
    return Finding(
        key="n-start",
        place=f"{PLACE}, below Eq. (ndet)",
        claim=f"Heights with an exponential law of decay γ give <i>N</i>(0) = γ{LOAD}/{K1} contacts before "
        "creep.",
        measured=tuple(letter),
        corrected=tuple(corrected),
        correction=f"a contact is as stiff as a site, {K_EFF} = {K0}/{G}({K1}/{K0}, 0), and the first one "
        "touches at no load: "
        f"1 + γ{LOAD}/{K_EFF}",
        note="The gaps between the highest of independent exponential heights are independent too, from "
        "which the number of contacts is 1 "
        f"plus a Poisson number of mean γ{LOAD}/{K_EFF} as long as contacts do not feel each other.",
    )


def growth_of_contacts(evidence: Evidence) -> Finding:
    """N(t)/N(0): Eq. (ndet), or rather G(t)/G(0)."""
    time = evidence["exponential"]["time"].values
    here = between(time, 1.0, 100.0)
    letter: list[Measurement] = []
    corrected: list[Measurement] = []
    for k1 in evidence.values("exponential", "k1"):
        area = evidence.samples("exponential", "area", k1=k1, R_viscous=0.0)
        for law, measured, name in (
            (exponential_growth_paper, letter, "Eq. (ndet)"),
            (exponential_growth, corrected, f"{G}(<i>t</i>)/{G}(0)"),
        ):
            growth = law(k1, time[here])

            def over_theory(mean: Field, growth: Field = growth) -> float:
                others = mean - 1  # all but the one contact that touches at no load
                return float(np.mean(others[here] / others[0] / growth)) if others[0] > 0 else float("nan")

            measured.append(
                Measurement(
                    f"simulated growth of the area over {name}, {REDUCED_TIME} from 1 to 100, {ratio(k1)}",
                    mean_of(over_theory, area),
                    0.85,
                    1.15,
                )
            )
    return Finding(
        key="n-growth",
        place=f"{PLACE}, Eq. (ndet)",
        claim="The number of contacts grows as <i>N</i>(<i>t</i>)/<i>N</i>(0) = 1 + <i>k</i><sub>1</sub> ∫ "
        "<i>v</i><sub>0</sub> d<i>t</i>.",
        measured=tuple(letter),
        corrected=tuple(corrected),
        correction=f"<i>N</i>(<i>t</i>)/<i>N</i>(0) = 1 + ({K_EFF}/<i>f</i><sub>0</sub>) ∫ "
        "<i>v</i><sub>0</sub> d<i>t</i> = "
        f"{G}({X1}, {X2})/{G}({X1}, 0)",
        note="As printed, the unit does not fit; the force was divided out to evaluate it. The one contact "
        "that costs no load is left out "
        "of both numbers of contacts.",
    )


def late_slope_of_area(evidence: Evidence) -> Finding:
    """dN/N(0)/d ln t = a0 k1/k0, or rather k_eff/(8 pi k0)."""
    time = evidence["exponential"]["time"].values
    letter, corrected = [], []
    for k1 in evidence.values("exponential", "k1"):
        area = evidence.samples("exponential", "area", k1=k1, R_viscous=0.0)

        def late(mean: Field, slope: float) -> float:
            # All but the one contact that touches at no load.
            return growth_slope(time, mean - 1, *DILUTE) / slope

        printed, true = 0.04 * k1, float(site_stiffness(k1)) * LATE_SLOPE
        letter.append(
            Measurement(
                f"simulated slope over <i>a</i><sub>0</sub>{K1}/{K0} = {printed:.3g}, {ratio(k1)}",
                mean_of(lambda mean, late=late, slope=printed: late(mean, slope), area),
                0.8,
                1.25,
            )
        )
        corrected.append(
            Measurement(
                f"simulated slope over {K_EFF}/(8π{K0}) = {true:.3g}, {ratio(k1)}",
                mean_of(lambda mean, late=late, slope=true: late(mean, slope), area),
                0.8,
                1.25,
            )
        )
    return Finding(
        key="n-slope",
        place=f"{PLACE}, Eq. (ndet2)",
        claim=f"Late, <i>N</i>(<i>t</i>)/<i>N</i>(0) grows as (<i>a</i><sub>0</sub>{K1}/{K0}) "
        f"ln({REDUCED_TIME}).",
        measured=tuple(letter),
        corrected=tuple(corrected),
        correction=f"the slope is {K_EFF}/(8π{K0})",
        note=f"Slope of the number of contacts in ln <i>t</i> for {REDUCED_TIME} from {DILUTE[0]:g} to "
        f"{DILUTE[1]:g}, over its value before creep.",
    )


def gaussian_like_exponential() -> Finding:
    """Gaussian heights give the same, for 1 << N << N0."""
    x2 = np.geomspace(*DILUTE, 9)
    load = np.array([1e-7, 1e-5, 1e-3])
    measured = []
    for p in load:
        area = dilute_area(p, compliance(3.0, np.append(0.0, x2)), GaussianHeights())
        gaussian = slope(np.log(x2), area[1:] / area[0])
        same = slope(np.log(x2), exponential_growth(3.0, x2))
        measured.append(
            Measurement(
                f"late slope with Gaussian over that with exponential heights, {LOAD}/(<i>N</i> {K0} σ) = "
                f"{p:g}, {ratio(3.0)}",
                exact(gaussian / same),
                0.8,
                1.25,
            )
        )
    return Finding(
        key="gaussian-exponential",
        place=PLACE,
        claim="Gaussian heights give the same growth as exponential ones where 1 ≪ <i>N</i> ≪ "
        "<i>N</i><sub>0</sub>.",
        measured=tuple(measured),
        note="From the theory of few contacts for both laws, without simulation. The difference vanishes "
        "only like the inverse of the "
        "logarithm of the load.",
    )
