"""A claim: a name, a statistic of the evidence, and the range in which its numbers bear the claim out.

What a claim says in sentences stands under its name in a text file beside the module of its statistic: the
place in the paper, the claim, what each number is (as the claim stands, or once corrected), the correction
and a note. The sentences may use the symbols and phrases of `wording`, the constants of this module and of
the statistic's, and the facts of the numbers: each sentence on a number its own, the others all, as
``numbers``. What several claims ask for is here too: exponents, slopes and crossovers.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, cast

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.special import ndtri

from asperity.fits import Estimate, growth_rate
from asperity.theory import site_stiffness
from asperity_research.arrays import Field
from asperity_research.paper.wording import sentences, spelled
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding, Measurement

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
Statistic = Callable[..., Numbers]


@dataclass(frozen=True)
class Claim:
    """A claim of the paper: a statistic that gives its numbers, and the range of each name of a number.

    With a swept parameter ``each``, as ``"aging.k1"``, the statistic is called for each of its values, its
    second argument, which is a fact of its numbers.
    """

    name: str
    statistic: Statistic
    ranges: Mapping[str, tuple[float, float]]
    each: str = ""

    @property
    def sentences(self) -> dict[str, Any]:
        """What the text file has on the claim: numbers by name, under `measured` and `corrected`."""
        group = self.statistic.__module__.rpartition(".")[2]
        return cast(dict[str, Any], sentences(f"claims/{group}.toml")[self.name])

    def judge(self, evidence: Evidence) -> Finding:
        """Compute the numbers, and put them into words beside their ranges."""
        numbers = [(one, *self.ranges[one.name]) for one in self._numbers(evidence)]
        known = globals() | self.statistic.__globals__
        shared = {name: known[name] for name in known if name.isupper()}
        shared["numbers"] = [one.facts for one, *_ in numbers]
        words = self.sentences

        def measured(part: str) -> tuple[Measurement, ...]:
            say = words.get(part, {})
            return tuple(
                Measurement(
                    spelled(say[one.name], {**shared, **one.facts}), one.estimate, one.of * low, one.of * high
                )
                for one, low, high in numbers
                if one.name in say
            )

        texts = ("place", "claim", "correction", "note")
        said = {text: spelled(words.get(text, ""), shared) for text in texts}
        return Finding(self.name, measured=measured("measured"), corrected=measured("corrected"), **said)

    def _numbers(self, evidence: Evidence) -> Numbers:
        if not self.each:
            yield from self.statistic(evidence)
            return
        study, parameter = self.each.split(".")
        for value in evidence.values(study, parameter):
            for one in self.statistic(evidence, value):
                yield replace(one, facts={parameter: value, **one.facts})


CLAIMS: dict[str, Claim] = {}  # All claims by name, in the order of the paper's sections


def claim(name: str, *, each: str = "", **ranges: tuple[float, float]) -> Callable[[Statistic], Statistic]:
    """Make the claim of a name with the statistic below."""

    def add(statistic: Statistic) -> Statistic:
        CLAIMS[name] = Claim(name, statistic, ranges, each)
        return statistic

    return add


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
