"""What a number of a claim is, and those that several claims ask for: exponents, slopes and crossovers."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.special import ndtri

from asperity.fits import Estimate, growth_rate
from asperity.theory import site_stiffness
from asperity_research.arrays import Field

LOGARITHMIC = (1.0, 1e3)  # Reduced times between which growth at light load is nearly that of a logarithm
EVEN = (2 / 3, 3 / 2)
"""Late over early growth in that time that still counts as a logarithm; a power law t^(1/4) has 2.4."""

ROUGHLY = (0.75, 1.25)  # Over what is expected: what counts as roughly proportional


@dataclass(frozen=True)
class Number:
    """A number that decides a claim, by name: several may share a range and a sentence, which may need facts.

    The ends of the range are multiples of ``of``.
    """

    name: str
    estimate: Estimate
    facts: Mapping[str, object] = field(default_factory=dict)
    of: float = 1.0


Numbers = Iterator[Number]


def exponent(x: Field, y: Field) -> float:
    """Slope of ln y against ln x, by least squares; NaN where y is not above 0."""
    return float("nan") if y.min(initial=1.0) <= 0 else slope(np.log(x), np.log(y))


def slope(x: Field, y: Field) -> float:
    """Slope of y against x, by least squares; NaN for a single point."""
    if x.size < 2:
        return float("nan")
    away = x - x.mean()
    return float(away @ y / (away @ away))


def growth_slope(time: Field, area: Field, first: float, last: float) -> float:
    """d(A/A(0))/d ln t between two times, the B of the paper; NaN without any area at first."""
    return growth_rate(time, area, first, last).B if area.min() > 0 else float("nan")


def evenness(time: Field, area: Field) -> float:
    """Growth in the later half of the logarithmic time over that in the earlier half; 1 for a logarithm."""
    first, last = LOGARITHMIC
    middle = math.sqrt(first * last)
    return growth_slope(time, area, middle, last) / growth_slope(time, area, first, middle)


def stiffened(gained: Estimate, soft: float, stiff: float) -> Numbers:
    """A gain in B from a soft to a stiff k1, over that of k1 as printed, and over that of a site."""
    by_site = float(site_stiffness(stiff) / site_stiffness(soft))
    for name, expected in (("printed", stiff / soft), ("by_site", by_site)):
        yield Number(name, gained, {"soft": soft, "stiff": stiff, "expected": expected}, of=expected)


def crossing(load: Field, fraction: Field, level: float) -> float:
    """Load at which a contact fraction that rises with it crosses a level; NaN where it does not.

    Interpolated, by a monotone cubic, between load and normal quantile of the fraction: on springs under
    Gaussian heights the two are nearly proportional from half contact on. With two loads a decade it is right
    to 1 % at half contact and to 4 % near full contact; with four, to 0.3 %.
    """
    rising = np.diff(np.maximum.accumulate(fraction), prepend=0.0) > 0
    partial = rising & (fraction < 1)
    quantile = ndtri(fraction[partial])
    if not (quantile.size > 1 and quantile[0] < ndtri(level) < quantile[-1]):
        return float("nan")
    return float(PchipInterpolator(quantile, load[partial])(ndtri(level)))
