"""What is misprinted or inexact in the paper: what it should be, why, and numbers that show it.

The words are in ``corrections.toml``, the numbers are computed here by `asperity.theory`, and docs/paper.md
has each proof in full. Source: E. A. Jagla, *Towards a modeling of the time dependence of contact area
between solid bodies*, J. Stat. Mech. P06006 (2010), doi:10.1088/1742-5468/2010/06/P06006.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

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
from asperity_research.arrays import Field
from asperity_research.paper.wording import sentences, spelled


@dataclass(frozen=True)
class Correction:
    """One misprint or inexactness: its place, what is printed, what should be, why, and numbers that show it.

    The key, words joined by hyphens, is the heading of the proof in docs/paper.md. Equations are named by
    their labels in the paper's source. Texts are plain with the tags i, sub and sup of HTML.
    """

    key: str
    place: str
    printed: str
    correct: str
    why: str
    numbers: tuple[tuple[str, float], ...]

    @property
    def title(self) -> str:
        """The key, in words."""
        return self.key.replace("-", " ").capitalize()


def corrections() -> tuple[Correction, ...]:
    """Return all of them, in the order of the paper, their numbers computed."""
    values, rows = _numbers(), []
    for key, words in sentences("corrections.toml").items():
        names = (spelled(number) for number in words.get("numbers", ()))
        numbers = tuple(zip(names, map(float, values.get(key, ())), strict=True))
        texts = {part: spelled(words[part]) for part in ("place", "printed", "correct", "why")}
        rows.append(Correction(key, numbers=numbers, **texts))
    return tuple(rows)


def _numbers() -> dict[str, Sequence[Field | float]]:
    """Numbers of the corrections that have any, in the order of their sentences."""
    gaussian, sites, late, very_late = GaussianHeights(), 200 * 200, 1e6, 1e12
    start, later, a0, a1 = compliance(3.0, 0.0), compliance(3.0, 1e4), LATE_SLOPE, LATE_INTERCEPT
    logarithm = a0 * math.log(very_late)
    square = compliance(3.0, very_late, dispersion="continuum") - logarithm
    lone, lone_relaxed = (torus_compliance(3.0, x2, (64, 64)) for x2 in (0.0, math.inf))
    light, heavier = (sites * dilute_area(load / sites, start, ExponentialHeights()) for load in (80, 160))
    printed, grown = late_slope_paper(1.0), exponential_growth(1.0, late)
    slope, slope_10 = (site_stiffness(x1) * late * compliance_rate(x1, late) for x1 in (1.0, 10.0))
    without, viscous = (
        late * compliance_rate(3.0, late, mobility) / compliance(3.0, late, mobility)
        for mobility in (0.0, 1.0)
    )
    return {
        "falling-energy": [lone_relaxed / lone],
        "three-exponents": [0.8 - 1.0 + 0.5],  # of A(infinity), A(0) and q
        "laplacian": [a1, square],
        "late-constants": [a0, a1, compliance(3.0, very_late) - logarithm - a1],
        "instantaneous-response": [start],
        "lost-sign": [gaussian.separation_for(1e-3 * later) - gaussian.separation_for(1e-3 * start)],
        "load-and-force": [light, 80 / light, heavier, 160 / heavier],
        "gaussian-integral": [dilute_area(1e-3, later, gaussian)],
        "dimensions": [grown, exponential_growth_paper(1.0, late)],
        "contact-stiffness": [site_stiffness(x1) / x1 for x1 in (1.0, 3.0, 10.0)],
        "late-growth": [printed * math.log(late), grown, math.exp(1 / printed), printed, late_slope(1.0)],
        "gaussian-growth": [
            later / start,
            *(
                dilute_area(load, later, gaussian) / dilute_area(load, start, gaussian)
                for load in (1e-3, 1e-6)
            ),
        ],
        "how-late": [dilute_horizon(0.01)],
        "aging-rate": [slope, slope / grown, slope_10, slope_10 / exponential_growth(10.0, late)],
        "viscous-slope": [
            *(8 * math.pi * time * compliance_rate(3.0, time, 0.01) for time in (1e2, 1e4, 1e8)),
            viscous / without,
        ],
    }
