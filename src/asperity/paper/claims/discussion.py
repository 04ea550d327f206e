"""Sections 2 and 6 of the paper: the model, and what it says about B, temperature and other geometries."""

from __future__ import annotations

import numpy as np

from asperity.fits.resampling import jackknife
from asperity.lattice import Field
from asperity.paper.claims.measures import between, exponent, growth_slope, mean_of, slope
from asperity.paper.evidence import Evidence
from asperity.paper.ledger import Finding, Measurement, exact
from asperity.paper.wording import AREA, K0, K1, K_EFF, LOAD, REDUCED_TIME, TIME, VISCOUS, ratio
from asperity.theory import compliance, displacement, site_stiffness

PLACE = "Section 6"
B = "<i>B</i>"


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """All claims of the section."""
    return (
        forces_even_out(evidence),
        mean_is_kept(evidence),
        dip_decays_exponentially(),
        line_contact(evidence),
        mobility_sets_the_clock(evidence),
        stiffness_ratio_sets_b(evidence),
        viscous_creep_doubles_b(evidence),
        viscous_slope_has_two_values(),
        viscous_creep_kills_the_load(evidence),
    )


def forces_even_out(evidence: Evidence) -> Finding:
    """The vertical springs carry equal forces in the end."""
    spread = []
    for seed in evidence["maps"]["seed"].values:
        fields = evidence.fields("maps", seed=int(seed))
        stretch = (fields["u"] - fields["u0"]).values
        spread.append([float(state.std() / abs(state.mean())) for state in (stretch[0], stretch[-1])])
    return Finding(
        key="even-forces",
        place="Section 2, below Eq. (u0s)",
        claim="Relaxation makes the forces of the vertical springs tend to a uniform value.",
        measured=(
            Measurement(
                f"spread of these forces at the last time over that at {TIME} = 0 (rms over mean, "
                "self-affine surface)",
                mean_of(lambda mean: float(mean[1] / mean[0]), np.array(spread)),
                high=0.2,
            ),
        ),
    )


def mean_is_kept(evidence: Evidence) -> Finding:
    """Conserving creep does not change mean(u0)."""
    separation = evidence["separation"]["separation"].sel(R_viscous=0.0)
    moved = float((separation - separation.isel(time=0)).__abs__().max())
    return Finding(
        key="mean-u0",
        place="Section 2",
        claim="The mean of <i>u</i><sup>0</sup> is not modified by the time evolution.",
        measured=(
            Measurement(
                "largest change of the separation in units of the rms height, the body held, <i>R̃</i> = 0",
                exact(moved),
                high=1e-9,
            ),
        ),
        note="With <i>R̃</i> > 0 it does change: see the corrections.",
    )


def dip_decays_exponentially() -> Finding:
    """A point force makes a dip that decays exponentially with distance."""
    measured = []
    distance = np.arange(4, 15)
    offsets = np.stack([distance, np.zeros_like(distance)], axis=1)
    for x1 in (1.0, 3.0):
        depth = displacement(offsets, x1, 0.0) * np.sqrt(distance)
        rate = -slope(distance.astype(float), np.log(depth))
        # exp(-kappa n) solves the lattice equation along an axis where lam(i kappa, 0) = -x1.
        kappa = float(np.arccosh(1 + x1 / 2))
        measured.append(
            Measurement(
                f"decay rate along an axis over its closed form arcosh(1 + {K1}/2{K0}), {ratio(x1)}",
                exact(rate / kappa),
                0.9,
                1.1,
            )
        )
    return Finding(
        key="exponential-dip",
        place="Section 2",
        claim="A force at one point makes a distortion that decays exponentially with distance.",
        measured=tuple(measured),
        note="Before creep. As the contact ages the dip widens as <i>t</i><sup>1/4</sup>, and in the "
        "relaxed state it is a logarithm without a length of its own.",
    )


def line_contact(evidence: Evidence) -> Finding:
    """On a line the indentation grows as t^(1/4)."""
    time = evidence["line_point"]["time"].values
    measured = []
    late = np.geomspace(1e12, 1e15, 7)
    for k1 in evidence.values("line_point", "k1"):
        depth = evidence["line_point"]["approach"].sel(k1=k1).values
        first = float(1 / site_stiffness(k1, dimension=1))
        here = between(time, 1e4, time[-1])
        measured += [
            Measurement(
                f"exponent of the simulated depth, {REDUCED_TIME} from 10<sup>4</sup> to {time[-1]:g}, "
                f"{ratio(k1)}",
                exact(exponent(time[here], first + depth[here])),
                0.24,
                0.26,
            ),
            Measurement(
                f"exponent of the closed form from 10<sup>12</sup> to 10<sup>15</sup>, {ratio(k1)}",
                exact(exponent(late, compliance(k1, late, dimension=1))),
                0.249,
                0.251,
            ),
        ]
    return Finding(
        key="line",
        place=PLACE,
        claim="On a line, the edge of a half-plane, the displacement under a constant force grows as "
        "<i>t</i><sup>1/4</sup>.",
        measured=tuple(measured),
    )


def mobility_sets_the_clock(evidence: Evidence) -> Finding:
    """B does not depend on R."""
    time = evidence["mobility"]["time"].values
    mobilities = evidence.values("mobility", "R")
    area = np.asarray(evidence["mobility"]["area"].transpose("seed", "R", "time"), dtype=np.float64)

    def compared(mean: Field, number: int) -> float:
        here, there = (
            growth_slope(time, mean[at], 1.0 / mobilities[at], 100.0 / mobilities[at])
            for at in (number, mobilities.index(1.0))
        )
        return here / there if there else float("nan")

    return Finding(
        key="b-mobility",
        place=PLACE,
        claim=f"{B} = d({AREA}/{AREA}(0))/d ln {TIME} does not depend on the mobility <i>R</i>, which only "
        "sets the clock.",
        measured=tuple(
            Measurement(
                f"{B} at <i>R</i> = {mobility:g} over {B} at <i>R</i> = 1, {REDUCED_TIME} from 1 to 100",
                mean_of(lambda mean, number=number: compared(mean, number), area),
                0.99,
                1.01,
            )
            for number, mobility in enumerate(mobilities)
            if mobility != 1
        ),
        note=f"Exact in the model, where <i>R</i> multiplies {TIME} and stands nowhere else; what is tested "
        f"is the simulation. At equal {TIME} in place of equal {REDUCED_TIME} it holds where growth is that "
        "of a logarithm.",
    )


def stiffness_ratio_sets_b(evidence: Evidence) -> Finding:
    """B grows with k1/k0."""
    time = evidence["aging"]["time"].values
    soft, *_, stiff = evidence.values("aging", "k1")
    load = evidence.values("aging", "load")[1]
    both = np.stack([evidence.samples("aging", "area", k1=k1, load=load) for k1 in (soft, stiff)], axis=1)

    def gain(mean: Field) -> float:
        low, high = (growth_slope(time, area, 1.0, 1e3) for area in mean)
        return high / low

    gained = mean_of(gain, both)
    true = float(site_stiffness(stiff) / site_stiffness(soft))
    return Finding(
        key="b-stiffness",
        place="Sections 5 and 6; Eq. (ndet2); Fig. 3",
        claim=f"The prefactor of the logarithm, and so {B}, is set by {K1}/{K0}: it is proportional to it.",
        measured=(
            Measurement(
                f"{B} at {ratio(stiff)} over {B} at {ratio(soft)}; {stiff / soft:.3g} if proportional",
                gained,
                0.75 * stiff / soft,
                1.25 * stiff / soft,
            ),
        ),
        corrected=(
            Measurement(
                f"the same; {true:.3g} if proportional to {K_EFF}/{K0}", gained, 0.75 * true, 1.25 * true
            ),
        ),
        correction=f"it is proportional to the stiffness of a site, {K_EFF}/{K0}",
        note=f"Gaussian heights at a light load, {REDUCED_TIME} from 1 to 1000.",
    )


def viscous_creep_doubles_b(evidence: Evidence) -> Finding:
    """B doubles as R_viscous/R goes from 0 to large values."""
    time = evidence["exponential"]["time"].values
    viscous = evidence.values("exponential", "R_viscous")[-1]
    stiffness = evidence.values("exponential", "k1")
    area = np.asarray(
        evidence["exponential"]["area"].transpose("seed", "k1", "R_viscous", "time"), dtype=np.float64
    )

    def gain(mean: Field) -> float:
        # All but the one contact that touches at no load; from late growth to where dips meet.
        creeping, flowing = (
            sum(growth_slope(time, curves[at] - 1, 10.0, 10**1.75) for curves in mean) for at in (0, -1)
        )
        return flowing / creeping

    return Finding(
        key="b-viscous",
        place=f"{PLACE}; Fig. 9",
        claim=f"{B} doubles as {VISCOUS}/<i>R</i> goes from 0 to large values.",
        measured=(
            Measurement(
                f"late slope of the indentation at {VISCOUS}/<i>R</i> = 10 over that at 0, closed form",
                exact(_late_slope(10.0) / _late_slope(0.0)),
                1.99,
                2.01,
            ),
            Measurement(
                f"{B} of simulated contacts at {VISCOUS}/<i>R</i> = {viscous:g} over {B} at 0, "
                f"{REDUCED_TIME} from 10 to 56, sum over {K1}/{K0} = "
                f"{', '.join(f'{k1:g}' for k1 in stiffness)}",
                mean_of(gain, area),
                1.6,
                2.4,
            ),
        ),
        note="Exponential heights at a light load, for as long as the dips around contacts have not met. "
        f"Here {B} is d({AREA}/{AREA}(0))/d ln {TIME}; see the corrections for d ln {AREA}/d ln {TIME}.",
    )


def viscous_slope_has_two_values() -> Finding:
    """The late slope does not go on to increase with R_viscous."""
    few, many = 0.01, 10.0
    return Finding(
        key="viscous-slope",
        place=f"{PLACE}; caption of Fig. 9",
        claim=f"The slope of the late logarithm increases as {VISCOUS}/<i>R</i> is increased.",
        measured=(
            Measurement(
                f"late slope of the indentation at {VISCOUS}/<i>R</i> = {many:g} over that at {few:g}, "
                "closed form",
                exact(_late_slope(many) / _late_slope(few)),
                low=1.1,
            ),
        ),
        corrected=tuple(
            Measurement(
                f"late slope at {VISCOUS}/<i>R</i> = {viscous:g} over {name}",
                exact(_late_slope(viscous) / value),
                0.999,
                1.001,
            )
            for viscous, value, name in (
                (0.0, 1 / (8 * np.pi), "1/(8π)"),
                (few, 1 / (4 * np.pi), "1/(4π)"),
                (many, 1 / (4 * np.pi), "1/(4π)"),
            )
        ),
        correction=f"it has two values, 1/(8π) for {VISCOUS} = 0 and 1/(4π) for any other; a small {VISCOUS} "
        f"only shows late, from {REDUCED_TIME} about (<i>R</i>/{VISCOUS})² on",
    )


def _late_slope(viscous: float) -> float:
    late = np.geomspace(1e10, 1e14, 9)
    return slope(np.log(late), compliance(3.0, late, viscous=viscous))


def viscous_creep_kills_the_load(evidence: Evidence) -> Finding:
    """F goes to zero at constant separation with R_viscous, and only then."""

    def last(viscous: float) -> Field:
        return evidence.samples("separation", "load", R_viscous=viscous)[:, -1]

    def share(late: Field, whole: Field) -> float:
        return float(late.mean() / whole.mean())

    measured = []
    for viscous in evidence.values("separation", "R_viscous"):
        if viscous == 0:
            limit = evidence.samples("separation", "relaxed_load", R_viscous=0.0)
            what, whole, low, high = "its limit, which is not zero", limit, 0.98, 1.02
        else:
            first = evidence.samples("separation", "load", R_viscous=viscous)[:, 0]
            what, whole, low, high = "the first", first, -1e-2, 1e-2
        measured.append(
            Measurement(
                f"late {LOAD} over {what}, {VISCOUS}/<i>R</i> = {viscous:g}",
                jackknife(share, (last(viscous), whole)),
                low,
                high,
            )
        )
    return Finding(
        key="viscous-load",
        place=PLACE,
        claim=f"With {VISCOUS} the load goes to zero at constant separation; with <i>R</i> alone it tends to "
        "a finite value.",
        measured=tuple(measured),
        note="Separation means that the rigid body is held in place: under viscous creep the mean of "
        "<i>u</i><sup>0</sup>, which the paper names, is not constant (see the corrections).",
    )
