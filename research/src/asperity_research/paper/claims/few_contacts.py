"""Section 5 of the paper: few contacts, far apart, and the response to a force at one point."""

from __future__ import annotations

import math

import numpy as np

from asperity.fits import Estimate
from asperity.theory import (
    LATE_INTERCEPT,
    LATE_SLOPE,
    GaussianHeights,
    compliance,
    contacts_at_start,
    contacts_at_start_paper,
    dilute_area,
    exponential_growth,
    exponential_growth_paper,
    late_slope,
    late_slope_paper,
    torus_compliance,
)
from asperity_research.arrays import Field
from asperity_research.paper.claims.claim import Claim, Number, Numbers
from asperity_research.paper.claims.measures import between, growth_slope, mean_of, slope
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import exact

DILUTE = (10.0, 1e3)
"""Reduced times, under conserving creep, when growth is late but the dips around contacts have not met."""
WITHIN = (0.8, 1.25)
"""Contacts and slopes over those of the theory."""
RATIOS = (0.3, 1.0, 3.0, 10.0)
"""Stiffness ratios of the closed forms."""


def late_slope_of_compliance(_: Evidence) -> Numbers:
    """a0 for several x1."""
    late = np.geomspace(1e8, 1e12, 9)
    for x1 in RATIOS:
        found = exact(slope(np.log(late), compliance(x1, late)))
        yield Number("slope", found, {"x1": x1, "closed": LATE_SLOPE})


def late_intercept_of_compliance(_: Evidence) -> Numbers:
    """a1 for several x1; and with q² in place of the eigenvalues of the lattice."""
    square = float(compliance(1.0, 1e8, dispersion="continuum")) - LATE_SLOPE * math.log(1e8)
    for x1 in RATIOS:
        found = exact(float(compliance(x1, 1e12)) - LATE_SLOPE * math.log(1e12))
        yield Number("intercept", found, {"x1": x1, "closed": LATE_INTERCEPT, "square": square})


def compliance_in_the_engine(evidence: Evidence) -> Numbers:
    """Largest deviation of the simulated indentation from f0 G / k0."""
    data, side = evidence["point"], round(evidence.sites("point") ** 0.5)
    time, worst = data["time"].values, 0.0
    for k1 in evidence.values("point", "k1"):
        depth = data["approach"].sel(k1=k1, R_viscous=0.0).values
        # From the first contact on; the mode q = 0 adds 1/(k1 N) at all times and cancels.
        theory = torus_compliance(k1, time, (side, side)) - torus_compliance(k1, 0.0, (side, side))
        worst = max(worst, float(np.max(np.abs(depth[1:] / theory[1:] - 1))))
    yield Number("worst", exact(worst))


def number_at_start(evidence: Evidence, k1: float) -> Numbers:
    """N(0) over gamma f0 / k1 as printed, and over 1 + gamma f0 / k_eff."""
    load = float(evidence["exponential"]["held"].max())
    area = evidence.samples("exponential", "initial_area", k1=k1, R_viscous=0.0)
    printed = float(contacts_at_start_paper(load, 1.0, k1, k0=1.0))
    true = 1 + float(contacts_at_start(load, 1.0, k1, k0=1.0))
    yield Number("printed", mean_of(lambda mean: float(mean) / printed, area))
    yield Number("true", mean_of(lambda mean: float(mean) / true, area))


def growth_of_contacts(evidence: Evidence, k1: float) -> Numbers:
    """N(t)/N(0) over Eq. (ndet), and over G(t)/G(0)."""
    here = between(evidence["exponential"]["time"].values, 1.0, 100.0)
    time = evidence["exponential"]["time"].values[here]

    def over(growth: Field) -> Estimate:
        def statistic(mean: Field) -> float:
            others = mean - 1  # all but the one contact that touches at no load
            return float(np.mean(others[here] / others[0] / growth)) if others[0] > 0 else math.nan

        return mean_of(statistic, evidence.samples("exponential", "area", k1=k1, R_viscous=0.0))

    yield Number("printed", over(exponential_growth_paper(k1, time)))
    yield Number("true", over(exponential_growth(k1, time)))


def late_slope_of_area(evidence: Evidence, k1: float) -> Numbers:
    """dN/N(0)/d ln t over a0 k1/k0 as printed, and over k_eff/(8 pi k0)."""
    time = evidence["exponential"]["time"].values
    area = evidence.samples("exponential", "area", k1=k1, R_viscous=0.0)
    printed, true = float(late_slope_paper(k1)), float(late_slope(k1))

    def late(mean: Field) -> float:
        return growth_slope(time, mean - 1, *DILUTE)  # all but the one contact that touches at no load

    yield Number("printed", mean_of(lambda mean: late(mean) / printed, area), {"theory": printed})
    yield Number("true", mean_of(lambda mean: late(mean) / true, area), {"theory": true})


def gaussian_like_exponential(evidence: Evidence) -> Numbers:
    """Late slope with Gaussian over that with exponential heights; and simulated growth over theory."""
    x2 = np.geomspace(*DILUTE, 9)
    for k1 in (1.0, 10.0):
        for load in (1e-6, 1e-2):
            area = dilute_area(load, compliance(k1, np.append(0.0, x2)), GaussianHeights())
            gaussian = slope(np.log(x2), area[1:] / area[0])
            same = slope(np.log(x2), exponential_growth(k1, x2))
            yield Number("closed", exact(gaussian / same), {"load": load, "k1": k1})
    for k1 in evidence.values("aging", "k1"):
        yield _gaussian_growth(evidence, k1)


def _gaussian_growth(evidence: Evidence, k1: float) -> Number:
    """Simulated growth of the lightest contacts of Gaussian heights over the theory of few contacts."""
    load, sites, until = evidence.values("aging", "load")[0], evidence.sites("aging"), 100.0
    start, end = dilute_area(load / sites, compliance(k1, np.array([0.0, until])), GaussianHeights())
    area = evidence.samples("aging", "area", k1=k1, load=load)
    at = int(np.argmin(np.abs(evidence["aging"]["time"].values - until)))
    found = mean_of(lambda mean: float(mean[at] / mean[0] * start / end), area)
    return Number("simulated", found, {"k1": k1, "load": load, "sites": sites, "until": until})


CLAIMS = (
    Claim("a0", late_slope_of_compliance, {"slope": (0.035, 0.045)}),
    Claim("a1", late_intercept_of_compliance, {"intercept": (0.25, 0.35)}),
    Claim("compliance-engine", compliance_in_the_engine, {"worst": (-math.inf, 5e-3)}),
    Claim("n-start", number_at_start, {"printed": WITHIN, "true": WITHIN}, each="exponential.k1"),
    Claim(
        "n-growth", growth_of_contacts, {"printed": (0.85, 1.15), "true": (0.85, 1.15)}, each="exponential.k1"
    ),
    Claim("n-slope", late_slope_of_area, {"printed": WITHIN, "true": WITHIN}, each="exponential.k1"),
    Claim(
        "gaussian-exponential", gaussian_like_exponential, {"closed": (0.9, 1.1), "simulated": (0.85, 1.15)}
    ),
)
