"""What is misprinted or inexact in the paper: what it should be, why, and numbers that show it.

The words are in ``templates/corrections.toml``, the numbers are computed here by `asperity.theory`, and
docs/paper.md has each proof in full. Source: E. A. Jagla, *Towards a modeling of the time dependence of
contact area between solid bodies*, J. Stat. Mech. P06006 (2010), doi:10.1088/1742-5468/2010/06/P06006.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.resources import files

from asperity.paper.wording import K0, K1, LOAD, REDUCED_TIME, SITES
from asperity.theory import (
    LATE_INTERCEPT,
    LATE_SLOPE,
    ExponentialHeights,
    GaussianHeights,
    compliance,
    compliance_rate,
    dilute_area,
    dilute_horizon,
    exponential_growth,
    exponential_growth_paper,
    late_slope,
    late_slope_paper,
    site_stiffness,
    torus_compliance,
)


@dataclass(frozen=True)
class Number:
    """A number that shows a correction, and what it is."""

    what: str
    value: float


Numbers = tuple[Number, ...]


@dataclass(frozen=True)
class Correction:
    """One misprint or inexactness.

    Attributes
    ----------
    key
        A short name, words joined by hyphens; the heading of the proof in docs/paper.md.
    place
        Where it stands. Equations are named by their labels in the paper's source.
    printed
        What the paper has.
    correct
        What it should be.
    why
        The proof in a few sentences. Like all texts here, plain with the tags i, sub and sup of HTML.
    numbers
        What shows it; empty where words suffice.
    """

    key: str
    place: str
    printed: str
    correct: str
    why: str
    numbers: Numbers

    @property
    def title(self) -> str:
        """The key, in words."""
        return self.key.replace("-", " ").capitalize()


def corrections() -> tuple[Correction, ...]:
    """Return all of them, in the order of the paper, their numbers computed."""
    words = files("asperity.paper").joinpath("templates/corrections.toml").read_text(encoding="utf-8")
    return tuple(
        Correction(key=key, numbers=_NUMBERS[key]() if key in _NUMBERS else (), **entry)
        for key, entry in tomllib.loads(words).items()
    )


_RATIO = f"{K1}/{K0}"
_LOAD = f"{LOAD}/({SITES}{K0})"
_GROWN = "<i>A</i>(<i>t</i>)/<i>A</i>(0)"
_LATE = 1e6
"""A late time, in units of 1/(k0 R)."""


def _falling_energy() -> Numbers:
    before, after = (float(torus_compliance(3.0, x2, (64, 64))) for x2 in (0.0, math.inf))
    return (
        Number(f"<i>E</i>(∞)/<i>E</i>(0) of a lone contact on 64 × 64 sites, {_RATIO} = 3", after / before),
    )


def _three_exponents() -> Numbers:
    of_start, of_end, of_q = 1.0, 0.8, 0.5
    return (Number("exponent of the load in <i>C</i>, by those printed", of_end - of_start + of_q),)


def _laplacian() -> Numbers:
    late = 1e12
    square = float(compliance(3.0, late, dispersion="continuum")) - LATE_SLOPE * math.log(late)
    return (
        Number("<i>a</i><sub>1</sub> with <i>λ</i>", LATE_INTERCEPT),
        Number("<i>a</i><sub>1</sub> with <i>q</i>² on the square zone", square),
    )


def _late_constants() -> Numbers:
    late = 1e12
    rest = float(compliance(3.0, late)) - LATE_SLOPE * math.log(late) - LATE_INTERCEPT
    return (
        Number("<i>a</i><sub>0</sub>", LATE_SLOPE),
        Number("<i>a</i><sub>1</sub>", LATE_INTERCEPT),
        Number(
            "<i>G</i> − <i>a</i><sub>0</sub> ln <i>x</i><sub>2</sub> − <i>a</i><sub>1</sub> "
            "at <i>x</i><sub>1</sub> = 3, <i>x</i><sub>2</sub> = 10<sup>12</sup>",
            rest,
        ),
    )


def _instantaneous_response() -> Numbers:
    return (Number(f"<i>G</i>({_RATIO}, 0), {_RATIO} = 3", float(compliance(3.0, 0.0))),)


def _lost_sign() -> Numbers:
    law, load = GaussianHeights(), 1e-3
    before, after = (float(law.separation_for(load * compliance(3.0, x2))) for x2 in (0.0, 1e4))
    where = f"Gaussian heights, {_LOAD} = 10<sup>−3</sup>, {_RATIO} = 3"
    return (
        Number(
            f"change of mean <i>u</i><sup>0</sup> in rms heights until {REDUCED_TIME} = 10<sup>4</sup>: "
            f"{where}",
            after - before,
        ),
    )


def _load_and_force() -> Numbers:
    sites = 200 * 200
    touching = {
        load: sites * float(dilute_area(load / sites, compliance(3.0, 0.0), ExponentialHeights()))
        for load in (80.0, 160.0)
    }
    where = f"exponential heights, <i>γ</i> = 1, 200 × 200 sites, {_RATIO} = 3"
    return tuple(
        number
        for load, count in touching.items()
        for number in (
            Number(f"<i>N</i>(0) at {LOAD}/{K0} = {load:g}: {where}", count),
            Number("mean force on one contact, over <i>k</i><sub>0</sub>", load / count),
        )
    )


def _gaussian_integral() -> Numbers:
    return (
        Number(
            f"<i>A</i>/{SITES} at {_LOAD} = 10<sup>−3</sup>, {_RATIO} = 3, {REDUCED_TIME} = 10<sup>4</sup>",
            float(dilute_area(1e-3, compliance(3.0, 1e4), GaussianHeights())),
        ),
    )


def _dimensions() -> Numbers:
    where = f"<i>N</i>(<i>t</i>)/<i>N</i>(0) at {_RATIO} = 1, {REDUCED_TIME} = 10<sup>6</sup>"
    return (
        Number(where, float(exponential_growth(1.0, _LATE))),
        Number(
            f"with {LOAD} divided out, but <i>k</i><sub>1</sub> for <i>k</i><sub>eff</sub>",
            float(exponential_growth_paper(1.0, _LATE)),
        ),
    )


def _contact_stiffness() -> Numbers:
    return tuple(
        Number(
            f"<i>k</i><sub>eff</sub>/<i>k</i><sub>1</sub> at {_RATIO} = {x1:g}",
            float(site_stiffness(x1)) / x1,
        )
        for x1 in (1.0, 3.0, 10.0)
    )


def _late_growth() -> Numbers:
    printed = float(late_slope_paper(1.0))
    return (
        Number(
            f"<i>N</i>(<i>t</i>)/<i>N</i>(0) as printed, {_RATIO} = 1, {REDUCED_TIME} = 10<sup>6</sup>",
            printed * math.log(_LATE),
        ),
        Number("corrected", float(exponential_growth(1.0, _LATE))),
        Number(f"{REDUCED_TIME} at which the printed one reaches 1", math.exp(1 / printed)),
        Number("slope as printed", printed),
        Number("corrected", float(late_slope(1.0))),
    )


def _gaussian_growth() -> Numbers:
    start, later, law = compliance(3.0, 0.0), compliance(3.0, 1e4), GaussianHeights()
    return (
        Number(
            f"{_GROWN}, exponential heights, {_RATIO} = 3, {REDUCED_TIME} = 10<sup>4</sup>",
            float(later / start),
        ),
        *(
            Number(
                f"Gaussian heights, {_LOAD} = 10<sup>−{power}</sup>",
                float(dilute_area(10.0**-power, later, law) / dilute_area(10.0**-power, start, law)),
            )
            for power in (3, 6)
        ),
    )


def _how_late() -> Numbers:
    return (
        Number(
            f"{REDUCED_TIME} that ends the range, <i>A</i>/{SITES} = 0.01",
            float(dilute_horizon(0.01)),
        ),
    )


def _aging_rate() -> Numbers:
    slope = {x1: float(site_stiffness(x1) * _LATE * compliance_rate(x1, _LATE)) for x1 in (1.0, 10.0)}
    return tuple(
        number
        for x1, steep in slope.items()
        for number in (
            Number(
                f"d(<i>A</i>/<i>A</i>(0))/d ln <i>t</i> at {_RATIO} = {x1:g}, "
                f"{REDUCED_TIME} = 10<sup>6</sup>",
                steep,
            ),
            Number("d ln <i>A</i>/d ln <i>t</i>, same place", steep / float(exponential_growth(x1, _LATE))),
        )
    )


def _viscous_slope() -> Numbers:
    relative = [
        _LATE * float(compliance_rate(3.0, _LATE, viscous) / compliance(3.0, _LATE, viscous))
        for viscous in (0.0, 1.0)
    ]
    return (
        *(
            Number(
                f"8π d<i>G</i>/d ln <i>t</i> at <i>R̃</i>/<i>R</i> = 0.01, {_RATIO} = 3, "
                f"{REDUCED_TIME} = 10<sup>{power}</sup>",
                8 * math.pi * 10.0**power * float(compliance_rate(3.0, 10.0**power, 0.01)),
            )
            for power in (2, 4, 8)
        ),
        Number(
            "d ln <i>A</i>/d ln <i>t</i> with <i>R̃</i> = <i>R</i>, over that with <i>R̃</i> = 0, "
            f"{REDUCED_TIME} = 10<sup>6</sup>",
            relative[1] / relative[0],
        ),
    )


_NUMBERS: Mapping[str, Callable[[], Numbers]] = {
    "falling-energy": _falling_energy,
    "three-exponents": _three_exponents,
    "laplacian": _laplacian,
    "late-constants": _late_constants,
    "instantaneous-response": _instantaneous_response,
    "lost-sign": _lost_sign,
    "load-and-force": _load_and_force,
    "gaussian-integral": _gaussian_integral,
    "dimensions": _dimensions,
    "contact-stiffness": _contact_stiffness,
    "late-growth": _late_growth,
    "gaussian-growth": _gaussian_growth,
    "how-late": _how_late,
    "aging-rate": _aging_rate,
    "viscous-slope": _viscous_slope,
}
