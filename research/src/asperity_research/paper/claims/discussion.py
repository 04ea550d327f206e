"""Sections 2 and 6 of the paper: the model, and what it says about B, temperature and other geometries."""

from __future__ import annotations

from math import inf, nan, pi

import numpy as np

from asperity.fits import jackknife
from asperity.theory import compliance, displacement, site_stiffness
from asperity_research.arrays import Field
from asperity_research.paper.claims.claim import Claim, Number, Numbers
from asperity_research.paper.claims.measures import (
    LOGARITHMIC,
    ROUGHLY,
    between,
    exponent,
    growth_slope,
    mean_of,
    slope,
)
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import exact


def spread_of_forces(evidence: Evidence) -> Numbers:
    """Spread of the forces of the vertical springs, late over first."""
    spread = []
    for seed in evidence["maps"]["seed"].values:
        fields = evidence.fields("maps", seed=int(seed))
        stretch = (fields["u"] - fields["u0"]).values
        spread.append([float(state.std() / abs(state.mean())) for state in (stretch[0], stretch[-1])])
    yield Number("spread", mean_of(lambda mean: float(mean[1] / mean[0]), np.array(spread)))


def change_of_mean(evidence: Evidence) -> Numbers:
    """Largest change of the separation at R_viscous = 0, which is that of mean(u0)."""
    separation = evidence["separation"]["separation"].sel(R_viscous=0.0)
    yield Number("moved", exact(float(abs(separation - separation.isel(time=0)).max())))


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


def line_contact(evidence: Evidence, k1: float) -> Numbers:
    """Exponent of time in the indentation of a line, simulated and in the closed form."""
    time, late = evidence["line_point"]["time"].values, np.geomspace(1e12, 1e15, 7)
    depth = evidence["line_point"]["approach"].sel(k1=k1).values
    first = float(1 / site_stiffness(k1, dimension=1))
    here = between(time, 1e4, time[-1])
    yield Number("simulated", exact(exponent(time[here], first + depth[here])), {"last": time[-1]})
    yield Number("closed", exact(exponent(late, compliance(k1, late, dimension=1))))


def slope_and_mobility(evidence: Evidence, R: float) -> Numbers:
    """B over that at R = 1, in the same reduced times."""
    if R == 1:
        return
    time = evidence["mobility"]["time"].values

    def compared(at_r: Field, at_one: Field) -> float:
        here = growth_slope(time, at_r.mean(axis=0), 1.0 / R, 100.0 / R)
        there = growth_slope(time, at_one.mean(axis=0), 1.0, 100.0)
        return here / there if there else nan

    both = tuple(evidence.samples("mobility", "area", R=each) for each in (R, 1.0))
    yield Number("compared", jackknife(compared, both))


def slope_and_stiffness(evidence: Evidence) -> Numbers:
    """B at the largest over B at the smallest k1."""
    time, load = evidence["aging"]["time"].values, evidence.values("aging", "load")[1]
    soft, *_, stiff = evidence.values("aging", "k1")
    both = tuple(evidence.samples("aging", "area", k1=k1, load=load) for k1 in (soft, stiff))

    def gain(*areas: Field) -> float:
        low, high = (growth_slope(time, area.mean(axis=0), *LOGARITHMIC) for area in areas)
        return high / low

    gained, by_site = jackknife(gain, both), float(site_stiffness(stiff) / site_stiffness(soft))
    for name, expected in (("printed", stiff / soft), ("by_site", by_site)):
        yield Number(name, gained, {"soft": soft, "stiff": stiff, "expected": expected}, of=expected)


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
    found = mean_of(gain, evidence.samples("exponential", "area"))
    yield Number("simulated", found, {"viscous": viscous, "k1": evidence.values("exponential", "k1")})


def late_slope_and_viscous_creep(_: Evidence) -> Numbers:
    """Late slope of the indentation, with much over with little viscous creep; and over its two values."""
    few, many = 0.01, 10.0
    yield Number("increase", exact(_late_slope(many) / _late_slope(few)), {"few": few, "many": many})
    for viscous, inverse in ((0.0, 8), (few, 4), (many, 4)):
        found = exact(_late_slope(viscous) / (1 / (inverse * pi)))
        yield Number("values", found, {"viscous": viscous, "inverse": inverse})


def _late_slope(viscous: float) -> float:
    late = np.geomspace(1e10, 1e14, 9)
    return slope(np.log(late), compliance(3.0, late, viscous=viscous))


def late_load(evidence: Evidence, R_viscous: float) -> Numbers:
    """F late at constant separation: over its limit, and with viscous creep over the first."""
    load = evidence.samples("separation", "load", R_viscous=R_viscous)
    limit = evidence.samples("separation", "relaxed_load", R_viscous=0.0)
    name, whole = ("vanishing", load[:, 0]) if R_viscous else ("finite", limit)
    yield Number(name, jackknife(lambda late, whole: float(late.mean() / whole.mean()), (load[:, -1], whole)))


CLAIMS = (
    Claim("even-forces", spread_of_forces, {"spread": (-inf, 0.2)}),
    Claim("mean-u0", change_of_mean, {"moved": (-inf, 1e-9)}),
    Claim("exponential-dip", decay_of_dip, {"rate": (0.9, 1.1)}),
    Claim("line", line_contact, {"simulated": (0.24, 0.26), "closed": (0.249, 0.251)}, each="line_point.k1"),
    Claim("b-mobility", slope_and_mobility, {"compared": (0.99, 1.01)}, each="mobility.R"),
    Claim("b-stiffness", slope_and_stiffness, {"printed": ROUGHLY, "by_site": ROUGHLY}),
    Claim("b-viscous", slope_and_viscous_creep, {"closed": (1.99, 2.01), "simulated": (1.6, 2.4)}),
    Claim("viscous-slope", late_slope_and_viscous_creep, {"increase": (1.1, inf), "values": (0.999, 1.001)}),
    Claim(
        "viscous-load",
        late_load,
        {"finite": (0.98, 1.02), "vanishing": (-1e-2, 1e-2)},
        each="separation.R_viscous",
    ),
)
