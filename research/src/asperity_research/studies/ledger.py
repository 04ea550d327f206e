"""The ledger: what is claimed, what was measured, and what follows.

A verdict is never typed in. A claim states the range in which a number would bear it out, the number is
computed from the simulations with a 95 % interval, and the two are compared: inside, outside, or undecided.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import binomtest

from asperity.base.rows import Row
from asperity.fits import Estimate
from asperity_research.studies.typeset import interval, plain

MOST_SEEDS = 1000  # Seeds beyond which more seeds are no advice: the number lies on the edge of its range


class Verdict(StrEnum):
    """What a measurement says about a claim."""

    AGREES = "agrees"
    CORRECTED = "agrees once corrected"
    DIFFERS = "differs"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Measurement:
    """One number of a claim, and the range in which it bears the claim out.

    What was measured, in plain text with the tags i, sub and sup of HTML; the number with its 95 % interval,
    or without one (`exact`) where nothing is random; and the range, infinite where it has one side only.
    """

    what: str
    estimate: Estimate
    low: float = -math.inf
    high: float = math.inf

    @property
    def verdict(self) -> Verdict:
        """Inside the range, outside, or undecided."""
        low, high = self.estimate.low, self.estimate.high
        if not (math.isfinite(low) and math.isfinite(high)):
            return Verdict.UNDECIDED
        if self.low <= low and high <= self.high:
            return Verdict.AGREES
        if high < self.low or low > self.high:
            return Verdict.DIFFERS
        return Verdict.UNDECIDED

    @property
    def needs(self) -> str:
        """What would decide it: seeds with which the interval would about clear the end of the range."""
        measured = self.estimate
        if np.isnan(measured.value):
            return "data from which the number can be computed"
        half = max(measured.high - measured.value, measured.value - measured.low)
        if not math.isfinite(half):
            return "more than one seed"
        if measured.runs == 1:
            return "a narrower interval"
        distance = min(abs(measured.value - self.low), abs(measured.value - self.high))
        seeds = math.ceil(measured.runs * (half / distance) ** 2) if distance > 0 else MOST_SEEDS + 1
        if seeds > MOST_SEEDS:
            return "a number lies on the end of its range, where no ensemble decides"
        return f"about {seeds} seeds in place of {measured.runs}"

    def columns(self, ends: str = "range") -> dict[str, object]:
        """The number, its interval, and the ends of the range that bears a claim out, in full precision."""
        of_interval = {end: float(getattr(self.estimate, end)) for end in ("value", "low", "high")}
        return {"what": plain(self.what), **of_interval, f"{ends}_low": self.low, f"{ends}_high": self.high}


@dataclass(frozen=True)
class Finding:
    """A line of the ledger: a claim, in our words, and where in the literature it stands.

    The numbers that decide it as it stands and, if it has to be corrected, once it is; what the correction
    is; and what a reader should know to judge the verdict, true whichever it is.
    """

    key: str
    place: str
    claim: str
    measured: tuple[Measurement, ...]
    corrected: tuple[Measurement, ...] = ()
    correction: str = ""
    note: str = ""

    @property
    def verdict(self) -> Verdict:
        """The claim's: as it stands, or, if it differs and has a correction, once corrected."""
        plain = together(self.measured)
        if plain is not Verdict.DIFFERS or not self.corrected:
            return plain
        once_corrected = together(self.corrected)
        return Verdict.CORRECTED if once_corrected is Verdict.AGREES else once_corrected

    @property
    def needs(self) -> str:
        """What it would take to decide an undecided claim, or its undecided correction if it differs."""
        if self.verdict is not Verdict.UNDECIDED:
            return ""
        deciding = self.corrected if self.waits_for_correction else self.measured
        return "; ".join(dict.fromkeys(m.needs for m in deciding if m.verdict is Verdict.UNDECIDED))

    @property
    def waits_for_correction(self) -> bool:
        """Whether it differs as it stands, and its correction is what is undecided."""
        return self.verdict is Verdict.UNDECIDED and together(self.measured) is Verdict.DIFFERS

    def rows(self) -> list[Row]:
        """The verdict with the claim, and each number as it stands, in plain text."""
        numbers = [Row(plain(one.what), plain(str(interval(one.estimate)))) for one in self.measured]
        return [Row(self.verdict.value, plain(self.claim)), *numbers]


@dataclass(frozen=True, eq=False)
class Outcome:
    """What was found; and the numbers behind the figure, by name, one row a point."""

    findings: tuple[Finding, ...]
    tables: Mapping[str, pd.DataFrame] = field(default_factory=dict)

    def rows(self) -> list[Row]:
        """Those of all findings."""
        return [row for finding in self.findings for row in finding.rows()]

    def tally(self) -> list[Row]:
        """How many claims there are, and how many have each verdict."""
        counts = Counter(finding.verdict for finding in self.findings)
        return [Row("claims", str(counts.total())), *(Row(one.value, str(counts[one])) for one in Verdict)]

    def table(self) -> pd.DataFrame:
        """The ledger, with one row a measurement."""
        return pd.DataFrame(
            {
                "key": finding.key,
                "place": plain(finding.place),
                "claim": plain(finding.claim),
                "verdict": finding.verdict.value,
                "judged": judged,
                **one.columns(),
                "runs": one.estimate.runs,
                "correction": plain(finding.correction),
                "note": plain(finding.note),
                "needs": finding.needs,
            }
            for finding in self.findings
            for judged, part in (("as it stands", finding.measured), ("corrected", finding.corrected))
            for one in part
        )

    def verdicts(self) -> pd.DataFrame:
        """Of each number as it stands: the claim, interval, expected range, and verdict."""
        return pd.DataFrame(
            {"claim": plain(finding.claim), **one.columns("expected"), "verdict": one.verdict.value}
            for finding in self.findings
            for one in finding.measured
        )


def together(measured: Sequence[Measurement]) -> Verdict:
    """All must agree; one that differs decides; otherwise it is open."""
    verdicts = {m.verdict for m in measured}
    open_or_worse = (one for one in (Verdict.DIFFERS, Verdict.UNDECIDED) if one in verdicts)
    return next(open_or_worse, Verdict.AGREES)


def exact(value: float) -> Estimate:
    """Return a number in which nothing is random, as an estimate."""
    return estimate(value, 0.0, value, value, runs=1)


def proportion(count: int, runs: int) -> Estimate:
    """Return the share of runs that have a property, with its exact 95 % interval (Clopper and Pearson)."""
    test = binomtest(count, runs)
    ends = test.proportion_ci(0.95, method="exact")
    share = test.statistic
    return estimate(share, math.sqrt(share * (1 - share) / runs), ends.low, ends.high, runs)


def estimate(value: float, stderr: float, low: float, high: float, runs: int) -> Estimate:
    """Return an estimate of these numbers."""
    number: Any = np.float64
    return Estimate(number(value), number(stderr), number(low), number(high), runs)
