"""Sections 5, 6 and 2 of the paper: few contacts, the response to a force at one point, and the model."""

import math
from math import inf, pi

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
    displacement,
    exponential_growth,
    exponential_growth_paper,
    late_slope,
    late_slope_paper,
    site_stiffness,
    torus_compliance,
)
from asperity_research.arrays import Field
from asperity_research.paper.claims.claim import claim
from asperity_research.paper.claims.measures import (
    LOGARITHMIC,
    ROUGHLY,
    Number,
    Numbers,
    exponent,
    growth_slope,
    slope,
    stiffened,
)
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import exact
from asperity_research.studies.numbers import mean_of, ratio, within

DILUTE = (10.0, 1e3)
"""Reduced times, under conserving creep, when growth is late but the dips around contacts have not met."""
WITHIN = (0.8, 1.25)  # Contacts and slopes over those of the theory
RATIOS = (0.3, 1.0, 3.0, 10.0)  # Stiffness ratios of the closed forms


@claim("a0", slope=(0.035, 0.045))
def late_slope_of_compliance(_: Evidence) -> Numbers:
    """a0 for several x1."""
    late = np.geomspace(1e8, 1e12, 9)
    for x1 in RATIOS:
        slope_of_logarithm = exact(slope(np.log(late), compliance(x1, late)))
        yield Number("slope", slope_of_logarithm, {"x1": x1, "closed": LATE_SLOPE})


@claim("a1", intercept=(0.25, 0.35))
def late_intercept_of_compliance(_: Evidence) -> Numbers:
    """a1 for several x1; and with q² in place of the eigenvalues of the lattice."""
    square = float(compliance(1.0, 1e8, dispersion="continuum")) - LATE_SLOPE * math.log(1e8)
    for x1 in RATIOS:
        intercept = exact(float(compliance(x1, 1e12)) - LATE_SLOPE * math.log(1e12))
        yield Number("intercept", intercept, {"x1": x1, "closed": LATE_INTERCEPT, "square": square})


@claim("compliance-engine", worst=(-inf, 5e-3))
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


@claim("n-start", each="exponential.k1", printed=WITHIN, true=WITHIN)
def number_at_start(evidence: Evidence, k1: float) -> Numbers:
    """N(0) over gamma f0 / k1 as printed, and over 1 + gamma f0 / k_eff."""
    load = float(evidence["exponential"]["held"].max())
    area = evidence.samples("exponential", "initial_area", k1=k1, R_viscous=0.0)
    printed = float(contacts_at_start_paper(load, 1.0, k1, k0=1.0))
    true = 1 + float(contacts_at_start(load, 1.0, k1, k0=1.0))
    yield Number("printed", mean_of(lambda mean: float(mean) / printed, area))
    yield Number("true", mean_of(lambda mean: float(mean) / true, area))


@claim("n-growth", each="exponential.k1", printed=(0.85, 1.15), true=(0.85, 1.15))
def growth_of_contacts(evidence: Evidence, k1: float) -> Numbers:
    """N(t)/N(0) over Eq. (ndet), and over G(t)/G(0)."""
    time = evidence["exponential"]["time"].values
    window = within(time, 1.0, 100.0)

    def over(growth: Field) -> Estimate:
        def statistic(mean: Field) -> float:
            others = mean - 1  # all but the one contact that touches at no load
            return float(np.mean(others[window] / others[0] / growth)) if others[0] > 0 else math.nan

        return mean_of(statistic, evidence.samples("exponential", "area", k1=k1, R_viscous=0.0))

    yield Number("printed", over(exponential_growth_paper(k1, time[window])))
    yield Number("true", over(exponential_growth(k1, time[window])))


@claim("n-slope", each="exponential.k1", printed=WITHIN, true=WITHIN)
def late_slope_of_area(evidence: Evidence, k1: float) -> Numbers:
    """dN/N(0)/d ln t over a0 k1/k0 as printed, and over k_eff/(8 pi k0)."""
    time = evidence["exponential"]["time"].values
    area = evidence.samples("exponential", "area", k1=k1, R_viscous=0.0)
    for name, theory in (("printed", float(late_slope_paper(k1))), ("true", float(late_slope(k1)))):
        # All but the one contact that touches at no load.
        over = mean_of(lambda mean, by=theory: growth_slope(time, mean - 1, *DILUTE) / by, area)
        yield Number(name, over, {"theory": theory})


@claim("gaussian-exponential", closed=(0.9, 1.1), simulated=(0.85, 1.15))
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
    growth = mean_of(lambda mean: float(mean[at] / mean[0] * start / end), area)
    return Number("simulated", growth, {"k1": k1, "load": load, "sites": sites, "until": until})


@claim("even-forces", spread=(-inf, 0.2))
def spread_of_forces(evidence: Evidence) -> Numbers:
    """Spread of the forces of the vertical springs, late over first."""
    runs = [evidence.fields("maps", seed=int(seed)) for seed in evidence["maps"]["seed"].values]
    stretches = [(run["u"] - run["u0"]).values for run in runs]
    late, first = (
        np.array([float(each[at].std() / abs(each[at].mean())) for each in stretches]) for at in (-1, 0)
    )
    yield Number("spread", ratio(late, first))


@claim("mean-u0", moved=(-inf, 1e-9))
def change_of_mean(evidence: Evidence) -> Numbers:
    """Largest change of the separation at R_viscous = 0, which is that of mean(u0)."""
    separation = evidence["separation"]["separation"].sel(R_viscous=0.0)
    yield Number("moved", exact(float(abs(separation - separation.isel(time=0)).max())))


@claim("exponential-dip", rate=(0.9, 1.1))
def decay_of_dip(_: Evidence) -> Numbers:
    """Rate at which the dip around a point force decays with distance, over its closed form."""
    distance = np.arange(4, 15)
    offsets = np.stack([distance, np.zeros_like(distance)], axis=1)
    for x1 in (1.0, 3.0):
        depth = displacement(offsets, x1, 0.0) * np.sqrt(distance)
        rate = -slope(distance.astype(float), np.log(depth))
        # exp(-kappa n) solves the lattice equation along an axis where lam(i kappa, 0) = -x1.
        kappa = float(np.arccosh(1 + x1 / 2))
        yield Number("rate", exact(rate / kappa), {"x1": x1})


@claim("line", each="line_point.k1", simulated=(0.24, 0.26), closed=(0.249, 0.251))
def line_contact(evidence: Evidence, k1: float) -> Numbers:
    """Exponent of time in the indentation of a line, simulated and in the closed form."""
    time, late = evidence["line_point"]["time"].values, np.geomspace(1e12, 1e15, 7)
    depth = evidence["line_point"]["approach"].sel(k1=k1).values
    first = float(1 / site_stiffness(k1, dimension=1))
    window = within(time, 1e4, time[-1])
    yield Number("simulated", exact(exponent(time[window], first + depth[window])), {"last": time[-1]})
    yield Number("closed", exact(exponent(late, compliance(k1, late, dimension=1))))


@claim("b-mobility", each="mobility.R", compared=(0.99, 1.01))
def slope_and_mobility(evidence: Evidence, R: float) -> Numbers:
    """B over that at R = 1, in the same reduced times."""
    if R == 1:
        return
    time = evidence["mobility"]["time"].values

    def compared(at_r: Field, at_one: Field) -> float:
        of_r, of_one = growth_slope(time, at_r, 1.0 / R, 100.0 / R), growth_slope(time, at_one, 1.0, 100.0)
        return of_r / of_one if of_one else math.nan

    both = (evidence.samples("mobility", "area", R=each) for each in (R, 1.0))
    yield Number("compared", mean_of(compared, *both))


@claim("b-stiffness", printed=ROUGHLY, by_site=ROUGHLY)
def slope_and_stiffness(evidence: Evidence) -> Numbers:
    """B at the largest over B at the smallest k1."""
    time, load = evidence["aging"]["time"].values, evidence.values("aging", "load")[1]
    soft, *_, stiff = evidence.values("aging", "k1")
    both = (evidence.samples("aging", "area", k1=k1, load=load) for k1 in (stiff, soft))

    def gain(*areas: Field) -> float:
        high, low = (growth_slope(time, area, *LOGARITHMIC) for area in areas)
        return high / low

    yield from stiffened(mean_of(gain, *both), soft, stiff)


@claim("b-viscous", closed=(1.99, 2.01), simulated=(1.6, 2.4))
def slope_and_viscous_creep(evidence: Evidence) -> Numbers:
    """B with viscous creep over B without: of the indentation, closed form, and of simulated contacts."""
    time, viscous = evidence["exponential"]["time"].values, evidence.values("exponential", "R_viscous")[-1]

    def gain(mean: Field) -> float:
        # All but the one contact that touches at no load; from late growth to where dips meet.
        creeping, flowing = (
            sum(growth_slope(time, curves[at] - 1, 10.0, 10**1.75) for curves in mean) for at in (0, -1)
        )
        return flowing / creeping

    yield Number("closed", exact(_late_slope(10.0) / _late_slope(0.0)))
    gained = mean_of(gain, evidence.samples("exponential", "area"))
    yield Number("simulated", gained, {"viscous": viscous, "k1": evidence.values("exponential", "k1")})


@claim("viscous-slope", increase=(1.1, inf), values=(0.999, 1.001))
def late_slope_and_viscous_creep(_: Evidence) -> Numbers:
    """Late slope of the indentation, with much over with little viscous creep; and over its two values."""
    few, many = 0.01, 10.0
    yield Number("increase", exact(_late_slope(many) / _late_slope(few)), {"few": few, "many": many})
    for viscous, inverse in ((0.0, 8), (few, 4), (many, 4)):
        ratio = exact(_late_slope(viscous) / (1 / (inverse * pi)))
        yield Number("values", ratio, {"viscous": viscous, "inverse": inverse})


@claim("viscous-load", each="separation.R_viscous", finite=(0.98, 1.02), vanishing=(-1e-2, 1e-2))
def late_load(evidence: Evidence, R_viscous: float) -> Numbers:
    """F late at constant separation: over its limit, and with viscous creep over the first."""
    load = evidence.samples("separation", "load", R_viscous=R_viscous)
    limit = evidence.samples("separation", "relaxed_load", R_viscous=0.0)
    name, whole = ("vanishing", load[:, 0]) if R_viscous else ("finite", limit)
    yield Number(name, ratio(load[:, -1], whole))


def _late_slope(viscous: float) -> float:
    late = np.geomspace(1e10, 1e14, 9)
    return slope(np.log(late), compliance(3.0, late, viscous=viscous))
