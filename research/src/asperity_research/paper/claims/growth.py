"""Section 3 of the paper, independent heights: how the area grows, and how the load drifts."""

from __future__ import annotations

from math import inf

import numpy as np

from asperity.fits import saturation
from asperity.theory import GaussianHeights, compliance, dilute_area, late_slope
from asperity_research.arrays import Field
from asperity_research.paper.claims.claim import Claim, Number, Numbers
from asperity_research.paper.claims.measures import EVEN, between, evenness, exponent, growth_slope, mean_of
from asperity_research.studies.evidence import Evidence

EARLY = (1.0, 100.0)
"""Reduced times when growth is late for one contact, and contacts do not feel each other yet."""


def load_drift(evidence: Evidence) -> Numbers:
    """Late F over the first, at constant separation."""
    load = evidence.samples("separation", "load", R_viscous=0.0)
    yield Number("drift", mean_of(lambda mean: float(mean[-1] / mean[0]), load))


def misfit(evidence: Evidence, k1: float) -> Numbers:
    """Misfit of Eq. (a) to A(t), of the load that is fitted worst."""
    time, area = evidence["aging"]["time"].values, evidence.samples("aging", "area", k1=k1)
    worst = mean_of(lambda mean: max(saturation(time, curve).rms_residual for curve in mean), area)
    yield Number("worst", worst, _loads(evidence))


def saturation_limit(evidence: Evidence, k1: float) -> Numbers:
    """The a of Eq. (a) over A(infinity)/A(0), at the lightest and the heaviest load."""
    time, loads = evidence["aging"]["time"].values, evidence.values("aging", "load")
    for load in (loads[0], loads[-1]):
        area = evidence.samples("aging", "area", k1=k1, load=load)
        both = np.column_stack([area, evidence.samples("aging", "relaxed_area", k1=k1, load=load)])
        over = mean_of(lambda mean: saturation(time, mean[:-1]).a * mean[0] / mean[-1], both)
        yield Number("limit", over, {"load": load, "sites": evidence.sites("aging")})


def exponent_of_q(evidence: Evidence, k1: float) -> Numbers:
    """Exponent of the load in q; also from fits that end early."""
    area = evidence.samples("aging", "area", k1=k1)
    seen = tuple(_law_exponent(evidence, area.mean(axis=0), "q", last) for last in (1e3, 1e4, 1e5))
    found = mean_of(lambda mean: _law_exponent(evidence, mean, "q"), area)
    yield Number("beta", found, {"seen": seen, **_loads(evidence)})


def exponent_of_c(evidence: Evidence, k1: float) -> Numbers:
    """Exponent of the load in C = (a - 1) q; C of the lightest load beside the slope of few contacts."""
    area = evidence.samples("aging", "area", k1=k1)
    lightest = saturation(evidence["aging"]["time"].values, area.mean(axis=0)[0]).C
    found = mean_of(lambda mean: _law_exponent(evidence, mean, "C"), area)
    yield Number("C", found, {"C": lightest, "few": float(late_slope(k1)), **_loads(evidence)})


def logarithm_at_light_load(evidence: Evidence, k1: float) -> Numbers:
    """Late over early growth at a light load, 1 for a logarithm."""
    time, light = evidence["aging"]["time"].values, evidence.values("aging", "load")[1]
    even = mean_of(lambda mean: evenness(time, mean), evidence.samples("aging", "area", k1=k1, load=light))
    yield Number("even", even, {"load": light, "sites": evidence.sites("aging")})


def slope_and_load(evidence: Evidence, k1: float) -> Numbers:
    """Slope d ln B / d ln F of light loads, beside that of contacts that do not feel each other."""
    time, load = evidence["aging"]["time"].values, np.array(evidence.values("aging", "load"))[:3]
    a_site = load / evidence.sites("aging")

    def drift(mean: Field) -> float:
        return exponent(load, np.array([growth_slope(time, curve, *EARLY) for curve in mean]))

    few = np.array([dilute_area(p, compliance(k1, time), GaussianHeights()) for p in a_site])
    found = mean_of(drift, evidence.samples("aging", "area", k1=k1)[:, :3])
    yield Number("drift", found, {"few": drift(few), **_loads(evidence, 3)})


def _loads(evidence: Evidence, count: int | None = None) -> dict[str, object]:
    """All loads, or the lightest ones, and the number of sites that share them."""
    return {"loads": evidence.values("aging", "load")[:count], "sites": evidence.sites("aging")}


def _law_exponent(evidence: Evidence, mean: Field, parameter: str, last: float = inf) -> float:
    """Exponent of the load in a parameter of the saturation law, fitted up to a last time."""
    time, load = evidence["aging"]["time"].values, np.array(evidence.values("aging", "load"))
    here = between(time, 0.0, last)
    fitted = [getattr(saturation(time[here], curve[here]), parameter) for curve in mean]
    return exponent(load, np.array(fitted))


CLAIMS = (
    Claim("load-drift", load_drift, {"drift": (0.01, 0.9)}),
    Claim("saturation", misfit, {"worst": (-inf, 0.05)}, each="aging.k1"),
    Claim("saturation-limit", saturation_limit, {"limit": (0.95, 1.05)}, each="aging.k1"),
    Claim("q-beta", exponent_of_q, {"beta": (0.4, 0.6)}, each="aging.k1"),
    Claim("c-finite", exponent_of_c, {"C": (-0.2, 0.2)}, each="aging.k1"),
    Claim("logarithm", logarithm_at_light_load, {"even": EVEN}, each="aging.k1"),
    Claim("b-load", slope_and_load, {"drift": (-0.1, 0.1)}, each="aging.k1"),
)
