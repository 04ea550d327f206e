"""Aging law against slip law on the same records, of one surface or of several.

Both laws have as many parameters, so AICc differs by n ln(squares of one / squares of the other), with n
effective values. For several surfaces the interval of this logarithm is from the jackknife.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from asperity.base import checks, views
from asperity.base.checks import Floats
from asperity.base.rows import Row
from asperity.errors import InputError
from asperity.fits import Estimate, jackknife
from asperity.fits.comparison import ROUNDING, UNLIKELY, lack_of
from asperity.friction.events import Events, HoldPeaks, hold_peaks
from asperity.friction.fitting import rate_and_state
from asperity.friction.laws import STATE_LAWS, StateLaw
from asperity.friction.parameters import MISSES, MachineFit, RateAndStateFit
from asperity.friction.pulling import stiffness_of
from asperity.friction.records import Record

PARAMETERS = ("mu_0", "a", "b", "D_c", "a_minus_b")
"""Numbers that are estimated."""

_SUITS = 1.5
"""Misfit of a fit over the least, up to which it is possible."""

_OPEN = 100.0
"""Relative standard error above which a parameter is not determined."""

_SAME = 1e-9
"""Largest relative difference of the same times and velocities."""


@dataclass(frozen=True, eq=False, repr=False)
class StateLaws(views.Brief, views.Pictured):
    """Comparison of the two laws of the state.

    Attributes
    ----------
    verdict
        The law that the data prefer; or ``"undecided"``. For one record, the relative likelihood of the other
        law is below 0.05, and there is no `doubt`. For several surfaces, the 95 % interval of `log_ratio`
        excludes 0.
    doubt
        Why the law that fits better is not preferred: it misses the record by more than the noise, or with a
        fitted stiffness the other one fits better. Empty without reason.
    fits, record, runs
        Fit of each law to the record, or to the mean of the records; number of surfaces.
    estimates
        By law and parameter (mu_0, a, b, D_c, a_minus_b), value, standard error and 95 % interval: from the
        residuals of one record, or from the jackknife over surfaces (in ln D_c) if the mean determines D_c.
    log_ratio
        ln(squares of the aging law / squares of the slip law), below 0 if the aging law fits better; its
        interval is NaN for one record.
    delta_aicc, relative_likelihood
        AICc of the aging law less that of the slip law with `effective_points`, and exp(-abs(delta_aicc)/2),
        of one record; NaN for several.
    effective_points
        Number of independent values of one record, by the residuals of the better law.
    free
        With a given stiffness, the fits that fit it instead.
    """

    verdict: Literal["aging", "slip", "undecided"]
    fits: Mapping[StateLaw, RateAndStateFit]
    estimates: Mapping[StateLaw, Mapping[str, Estimate]]
    record: Record
    runs: int
    log_ratio: Estimate
    delta_aicc: float
    effective_points: float
    relative_likelihood: float
    doubt: str = ""
    free: Mapping[StateLaw, RateAndStateFit] = field(default_factory=dict)

    @views.later
    def rows(self, /, first: str = "") -> list[Row]:
        """Rows of a summary: the record, named by the first of several, both laws, and the verdict."""
        raise NotImplementedError

    @property
    def every(self) -> list[RateAndStateFit]:
        """All fits, the preferred law first, with a given stiffness before a fitted one."""
        laws = sorted(STATE_LAWS, key=lambda law: law != self.preferred)
        return [fits[law] for law in laws for fits in (self.fits, self.free) if law in fits]

    @property
    def suiting(self) -> list[RateAndStateFit]:
        """The fits whose misfit is near the least."""
        least = min(fit.rms_residual for fit in self.every)
        return [fit for fit in self.every if fit.rms_residual < _SUITS * least]

    def range_of(self, name: str) -> tuple[float, float, bool | None]:
        """Least and largest value among the suiting fits, and whether their 95 % intervals are narrower.

        The last is None if the standard error of a fit is above its value.
        """
        estimates = [fit.estimates[name] for fit in self.suiting]
        values = [float(estimate.value) for estimate in estimates]
        widest = max(float(estimate.high - estimate.low) for estimate in estimates)
        undetermined = any(estimate.stderr > abs(estimate.value) for estimate in estimates)
        return min(values), max(values), None if undetermined else max(values) - min(values) > widest

    def is_open(self, law: StateLaw, name: str) -> bool:
        """Whether the record does not determine a parameter of a law."""
        estimate, needs_D_c = self.estimates[law][name], name in ("D_c", "alpha")
        undetermined = needs_D_c and not self.fits[law].determined
        return bool(undetermined or estimate.stderr > _OPEN * np.abs(estimate.value))

    @property
    def preferred(self) -> StateLaw:
        """The law of the verdict; if that is undecided, the one that fits better."""
        if self.verdict != "undecided":
            return self.verdict
        return "aging" if float(self.log_ratio.value) <= 0 else "slip"

    def peaks(self, law: StateLaw | None = None) -> HoldPeaks:
        """Static friction against hold time: of the record, or of a law at the same times."""
        if law is None:
            return hold_peaks(self.record)
        friction = self.fits[law].predict(self.record)
        friction = np.where(np.isnan(friction), self.record.friction, friction)  # before the steady start
        return hold_peaks(replace(self.record, friction=friction))


def compare_state_laws(
    records: Record | Sequence[Record],
    *,
    a: float | Literal["fitted"] | None = None,
    V_0: float | str | None = None,
    events: Events = "all",
    stiffness: float | str | None = None,
) -> StateLaws:
    """Fit the aging and the slip law, and say which the data prefer.

    Several records, of different surfaces with the same times and velocities, are averaged, and uncertainties
    follow from their scatter. Other arguments and errors are those of `rate_and_state`. A stiffness is for
    one record; `StateLaws.free` then has fits without it.
    """
    several = list(records) if isinstance(records, Sequence) else [records]
    if not several:
        raise InputError("records", expected="a record, or several", got="none")
    first = checks.instance("records", several[0], Record, "asperity.friction.record_of(history)")
    for record in several[1:]:
        _check_same(first, checks.instance("records", record, Record, "records of one kind"))
    if len(several) > 1 and (first.drive is not None or stiffness is not None):
        advice = "a call for each, or the mean of their numbers"
        raise InputError("records", expected="one record of a machine", got=len(several), advice=advice)
    friction = np.array([record.friction for record in several])

    def fitted(mean: Floats, k: float | str | None = stiffness) -> dict[StateLaw, RateAndStateFit]:
        how: Any = {"a": a, "V_0": V_0, "events": events, "stiffness": k}
        return {law: rate_and_state(replace(first, friction=mean), law=law, **how) for law in STATE_LAWS}

    def statistics(sample: Floats) -> Floats:
        fits = fitted(sample.mean(axis=0))
        return np.array([*_numbers(fits["aging"]), *_numbers(fits["slip"]), _log_ratio(fits)])

    mean = replace(first, friction=friction.mean(axis=0))
    fits = fitted(mean.friction)
    estimates = {law: fit.estimates for law, fit in fits.items()}
    k = stiffness_of(first, stiffness)
    is_given = k is not None and (k < math.inf or first.drive is not None)
    free = fitted(mean.friction, "fit") if is_given else {}
    doubt = _doubt(fits, free)
    if len(several) == 1:
        better = min(fits.values(), key=_lack)
        ratio, unknown = np.array(_log_ratio(fits)), np.array(math.nan)
        log_ratio, worth = Estimate(ratio, unknown, unknown, unknown, 1), better.effective_points
        delta = worth * float(log_ratio.value)
        likelihood = math.exp(-abs(delta) / 2)
        decided = likelihood < UNLIKELY and not doubt
    else:
        jackknifed = jackknife(statistics, friction)
        log_ratio = jackknifed.part(-1)
        decided = float(log_ratio.low) > 0 or float(log_ratio.high) < 0
        for n, law in enumerate(STATE_LAWS):
            if fits[law].determined:
                places = enumerate(PARAMETERS, n * len(PARAMETERS))
                estimates[law] = {name: jackknifed.part(at, scale=name == "D_c") for at, name in places}
        delta = likelihood = math.nan
        worth = min(fit.effective_points for fit in fits.values())
    return StateLaws(
        verdict="undecided" if not decided else "aging" if float(log_ratio.value) < 0 else "slip",
        fits=fits,
        estimates=estimates,
        record=mean,
        runs=len(several),
        log_ratio=log_ratio,
        delta_aicc=delta,
        effective_points=worth,
        relative_likelihood=likelihood,
        doubt=doubt,
        free=free,
    )


def _doubt(fits: Mapping[StateLaw, RateAndStateFit], free: Mapping[StateLaw, RateAndStateFit]) -> str:
    better, *others = (min(each, key=lambda law: _lack(each[law])) for each in (fits, free) if each)
    fit = fits[better]
    if isinstance(fit, MachineFit) and fit.misfit >= MISSES:
        return "neither law describes the record to its noise"
    return "with a fitted stiffness the other law fits better" if others not in ([], [better]) else ""


def _check_same(first: Record, other: Record) -> None:
    for name in ("time", "velocity"):
        mine, theirs = getattr(first, name), getattr(other, name)
        as_many, off = mine.size == theirs.size, _SAME * np.abs(mine).max()
        if not (as_many and np.allclose(mine, theirs, rtol=_SAME, atol=off)):
            got = f"another {name}" if as_many else f"{theirs.size} and {mine.size} times"
            expected = "records of one protocol, at the same times and velocities"
            raise InputError("records", expected=expected, got=got, advice="a call for each record")


def _lack(fit: RateAndStateFit) -> float:
    return lack_of(fit.residual, weighted=False, rounding=ROUNDING * fit.mu_0)


def _log_ratio(fits: Mapping[StateLaw, RateAndStateFit]) -> float:
    return _lack(fits["aging"]) - _lack(fits["slip"])


def _numbers(fit: RateAndStateFit) -> list[float]:
    """The parameters in order, D_c as its logarithm."""
    return [math.log(fit.D_c) if name == "D_c" else float(getattr(fit, name)) for name in PARAMETERS]
