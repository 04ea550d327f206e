"""What is misprinted or inexact in the paper: what it should be, why, and numbers that show it.

The words are in ``corrections.toml``, the numbers are computed here by `asperity.theory`, and docs/paper.md
has each proof in full. Source: E. A. Jagla, *Towards a modeling of the time dependence of contact area
between solid bodies*, J. Stat. Mech. P06006 (2010), doi:10.1088/1742-5468/2010/06/P06006.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from asperity.paper.wording import sentences, spelled
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
    numbers: tuple[Number, ...]

    @property
    def title(self) -> str:
        """The key, in words."""
        return self.key.replace("-", " ").capitalize()


def corrections() -> tuple[Correction, ...]:
    """Return all of them, in the order of the paper, their numbers computed."""
    return tuple(_correction(key, **words) for key, words in sentences("corrections.toml").items())


def _correction(key: str, *, numbers: Sequence[str] = (), **words: str) -> Correction:
    shown = zip(numbers, _NUMBERS[key]() if numbers else (), strict=True)
    return Correction(
        key=key,
        numbers=tuple(Number(spelled(what), value) for what, value in shown),
        **{name: spelled(text) for name, text in words.items()},
    )


_LATE = 1e6
"""A late time, in units of 1/(k0 R)."""


def _falling_energy() -> list[float]:
    before, after = (float(torus_compliance(3.0, x2, (64, 64))) for x2 in (0.0, math.inf))
    return [after / before]


def _three_exponents() -> list[float]:
    of_start, of_end, of_q = 1.0, 0.8, 0.5
    return [of_end - of_start + of_q]


def _laplacian() -> list[float]:
    late = 1e12
    square = float(compliance(3.0, late, dispersion="continuum")) - LATE_SLOPE * math.log(late)
    return [LATE_INTERCEPT, square]


def _late_constants() -> list[float]:
    late = 1e12
    rest = float(compliance(3.0, late)) - LATE_SLOPE * math.log(late) - LATE_INTERCEPT
    return [LATE_SLOPE, LATE_INTERCEPT, rest]


def _instantaneous_response() -> list[float]:
    return [float(compliance(3.0, 0.0))]


def _lost_sign() -> list[float]:
    law, load = GaussianHeights(), 1e-3
    before, after = (float(law.separation_for(load * compliance(3.0, x2))) for x2 in (0.0, 1e4))
    return [after - before]


def _load_and_force() -> list[float]:
    sites, loads, law = 200 * 200, (80.0, 160.0), ExponentialHeights()
    counts = [sites * float(dilute_area(load / sites, compliance(3.0, 0.0), law)) for load in loads]
    return [shown for load, count in zip(loads, counts, strict=True) for shown in (count, load / count)]


def _gaussian_integral() -> list[float]:
    return [float(dilute_area(1e-3, compliance(3.0, 1e4), GaussianHeights()))]


def _dimensions() -> list[float]:
    return [float(law(1.0, _LATE)) for law in (exponential_growth, exponential_growth_paper)]


def _contact_stiffness() -> list[float]:
    return [float(site_stiffness(x1)) / x1 for x1 in (1.0, 3.0, 10.0)]


def _late_growth() -> list[float]:
    printed, grown = float(late_slope_paper(1.0)), float(exponential_growth(1.0, _LATE))
    return [printed * math.log(_LATE), grown, math.exp(1 / printed), printed, float(late_slope(1.0))]


def _gaussian_growth() -> list[float]:
    start, later, law = compliance(3.0, 0.0), compliance(3.0, 1e4), GaussianHeights()
    light = [float(dilute_area(load, later, law) / dilute_area(load, start, law)) for load in (1e-3, 1e-6)]
    return [float(later / start), *light]


def _how_late() -> list[float]:
    return [float(dilute_horizon(0.01))]


def _aging_rate() -> list[float]:
    rates = []
    for x1 in (1.0, 10.0):
        slope = float(site_stiffness(x1) * _LATE * compliance_rate(x1, _LATE))
        rates += [slope, slope / float(exponential_growth(x1, _LATE))]
    return rates


def _viscous_slope() -> list[float]:
    slopes = [8 * math.pi * time * float(compliance_rate(3.0, time, 0.01)) for time in (1e2, 1e4, 1e8)]
    without, viscous = (
        _LATE * float(compliance_rate(3.0, _LATE, viscous) / compliance(3.0, _LATE, viscous))
        for viscous in (0.0, 1.0)
    )
    return [*slopes, viscous / without]


_NUMBERS: dict[str, Callable[[], list[float]]] = {
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
