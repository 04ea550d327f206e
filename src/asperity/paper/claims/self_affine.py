"""Section 4 of the paper: self-affine surfaces."""

from __future__ import annotations

import numpy as np

from asperity.lattice import Field
from asperity.paper.claims.measures import (
    EVEN,
    LOGARITHMIC,
    between,
    evenness,
    evenness_in_words,
    exponent,
    growth_slope,
    mean_of,
)
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding, Measurement
from asperity.paper.wording import AREA, K0, K1, K_EFF, LOAD, REDUCED_TIME, TIME, ratio
from asperity.theory import site_stiffness

PLACE = "Section 4"
PARTIAL = (1e-4, 5e-2)
"""Contact fractions away from full contact, before creep."""


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """All claims of the section."""
    return (
        load_exponent(evidence),
        size_independence(evidence),
        slope_and_load(evidence),
        slope_and_stiffness(evidence),
        other_hurst_exponents(evidence),
    )


def load_exponent(evidence: Evidence) -> Finding:
    """A ~ F^0.8 before creep."""
    load = np.array(evidence.values("self_affine_load", "load"))
    measured = []
    for size in evidence.values("self_affine_load", "size"):
        area = evidence.samples("self_affine_load", "initial_area", size=size)
        here = between(area.mean(axis=0) / size**2, *PARTIAL)
        measured.append(
            Measurement(
                f"d ln {AREA} / d ln {LOAD}, {size:g} × {size:g} sites",
                mean_of(lambda mean, here=here: exponent(load[here], mean[here]), area),
                0.7,
                0.9,
            )
        )
    return Finding(
        key="self-affine-0.8",
        place=f"{PLACE}; Fig. 5",
        claim=f"Without relaxation the area of a self-affine surface follows {AREA} ~ {LOAD}<sup>0.8</sup>.",
        measured=tuple(measured),
        note="The range keeps 0.8 apart from 1, the proportionality that the paper sets it against. Contact "
        f"fractions from {PARTIAL[0]:g} to {PARTIAL[1]:g}.",
    )


def size_independence(evidence: Evidence) -> Finding:
    """A(F) does not depend on the size of the system."""
    sizes = evidence.values("self_affine_load", "size")
    area = np.asarray(
        evidence["self_affine_load"]["initial_area"].transpose("seed", "size", "load"), dtype=np.float64
    )
    partial = between(area.mean(axis=0)[0] / sizes[0] ** 2, *PARTIAL)

    def grown(mean: Field, number: int) -> float:
        return float(np.exp(np.mean(np.log(mean[number, partial] / mean[0, partial]))))

    return Finding(
        key="self-affine-size",
        place=f"{PLACE}; Fig. 5",
        claim="Away from full contact the area does not depend on the size of the system, at the same total "
        "load.",
        measured=tuple(
            Measurement(
                f"{AREA} on {size:g} × {size:g} sites over {AREA} on {sizes[0]:g} × {sizes[0]:g}, mean over "
                "loads",
                mean_of(lambda mean, number=number: grown(mean, number), area),
                0.8,
                1.25,
            )
            for number, size in enumerate(sizes[1:], start=1)
        ),
        note="In terms of the total load, not the load a site: the surface touches around its highest peak.",
    )


def slope_and_load(evidence: Evidence) -> Finding:
    """A/A(0) grows like a logarithm, with a slope that does not depend on the load."""
    time = evidence["self_affine_aging"]["time"].values
    load = np.array(evidence.values("self_affine_aging", "load"))
    measured = []
    for k1 in evidence.values("self_affine_aging", "k1"):
        samples = _largest(evidence, k1)
        measured += [
            Measurement(
                f"d ln <i>B</i> / d ln {LOAD}, {ratio(k1)}",
                mean_of(lambda mean: exponent(load, _slopes(time, mean)), samples),
                -0.1,
                0.1,
            ),
            Measurement(
                f"{evenness_in_words()}, {ratio(k1)}, sum over loads",
                mean_of(lambda mean: evenness(time, _scaled(mean)), samples),
                *EVEN,
            ),
        ]
    return Finding(
        key="slope-load",
        place=f"{PLACE}; Fig. 6b",
        claim=f"Normalized curves {AREA}({TIME})/{AREA}(0) grow like a logarithm with a slope that does not "
        "depend on the load.",
        measured=tuple(measured),
        note=f"<i>B</i> is the slope in ln {TIME} for {REDUCED_TIME} from {LOGARITHMIC[0]:g} to "
        f"{LOGARITHMIC[1]:g}, on the larger system; a change of less than 26 % for a load ten times as large "
        "passes.",
    )


def slope_and_stiffness(evidence: Evidence) -> Finding:
    """The slope is proportional to k1/k0."""
    time = evidence["self_affine_aging"]["time"].values
    soft, *_, stiff = evidence.values("self_affine_aging", "k1")
    both = np.stack([_largest(evidence, k1) for k1 in (soft, stiff)], axis=1)

    def gain(mean: Field) -> float:
        return float(_slopes(time, mean[1]).sum() / _slopes(time, mean[0]).sum())

    gained = mean_of(gain, both)
    softer, stiffer = float(site_stiffness(soft)), float(site_stiffness(stiff))
    return Finding(
        key="slope-stiffness",
        place=f"{PLACE}; Fig. 6b",
        claim=f"The slope of the normalized curves is roughly proportional to {K1}/{K0}.",
        measured=(
            Measurement(
                f"<i>B</i> at {ratio(stiff)} over <i>B</i> at {ratio(soft)}; {stiff / soft:.3g} if "
                "proportional",
                gained,
                0.75 * stiff / soft,
                1.25 * stiff / soft,
            ),
        ),
        corrected=(
            Measurement(
                f"the same; {stiffer / softer:.3g} if proportional to {K_EFF}/{K0}",
                gained,
                0.75 * stiffer / softer,
                1.25 * stiffer / softer,
            ),
        ),
        correction=f"it is roughly proportional to the stiffness of a site, {K_EFF}, which counts the "
        "springs to the neighbors too",
        note="Both ranges are 25 % wide on either side, for the word “roughly”. Sums over loads.",
    )


def other_hurst_exponents(evidence: Evidence) -> Finding:
    """Other Hurst exponents show no qualitative difference."""
    load = np.array(evidence.values("hurst", "load"))
    time = evidence["hurst"]["time"].values
    measured = []
    for hurst in evidence.values("hurst", "hurst"):
        area = evidence.samples("hurst", "area", hurst=hurst)
        measured += [
            Measurement(
                f"d ln {AREA} / d ln {LOAD} before creep, <i>H</i> = {hurst:g}",
                mean_of(lambda mean: exponent(load, mean[:, 0]), area),
                0.7,
                1.0,
            ),
            Measurement(
                f"{evenness_in_words()}, <i>H</i> = {hurst:g}, sum over loads",
                mean_of(lambda mean: evenness(time, _scaled(mean)), area),
                *EVEN,
            ),
        ]
    return Finding(
        key="hurst",
        place=PLACE,
        claim="Other Hurst exponents show no qualitative difference.",
        measured=tuple(measured),
        note="Read as: area somewhat less than proportional to the load, and growth that is nearly that of "
        "a logarithm.",
    )


def _largest(evidence: Evidence, k1: float) -> Field:
    """Aging curves on the largest system, shape (seeds, loads, times)."""
    size = evidence.values("self_affine_aging", "size")[-1]
    return evidence.samples("self_affine_aging", "area", size=size, k1=k1)


def _slopes(time: Field, areas: Field) -> Field:
    """B of several curves of A(t), shape (loads, times)."""
    return np.array([growth_slope(time, area, *LOGARITHMIC) for area in areas])


def _scaled(areas: Field) -> Field:
    """Sum of curves A(t)/A(0), shape (loads, times)."""
    return np.asarray((areas / areas[:, :1]).sum(axis=0))
