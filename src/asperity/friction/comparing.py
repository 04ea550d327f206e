"""Aging law against slip law on the same records, of one surface or of several.

Both laws have as many parameters, so AICc differs by n ln(squares of one / squares of the other), with n
effective values. Of several surfaces, the jackknife says how sure the logarithm of this ratio is.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from asperity.base import checks, views
from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.fits import Estimate, jackknife
from asperity.fits.comparison import ROUNDING, UNLIKELY, lack_of
from asperity.friction.events import Events, HoldPeaks, hold_peaks
from asperity.friction.fitting import rate_and_state
from asperity.friction.laws import STATE_LAWS, StateLaw
from asperity.friction.parameters import MachineFit, RateAndStateFit
from asperity.friction.records import Record

PARAMETERS = ("mu_0", "a", "b", "D_c", "a_minus_b")
"""What is estimated."""

_SUITS = 1.5
"""Misfit over the least up to which a law with a stiffness is possible."""

_SAME = 1e-9
"""Relative difference of times and velocities that are meant to be the same."""


@dataclass(frozen=True, eq=False, repr=False)
class StateLaws(views.Brief, views.Pictured):
    """The two laws of the state beside each other.

    Attributes
    ----------
    verdict
        The law that the data prefer; or ``"undecided"``. Of one record: the other's relative likelihood is
        below 0.05. Of several surfaces: the 95 % interval of `log_ratio` does not contain 0.
    fits, record, runs
        Fit of each law to the record, or to the mean of the records of so many surfaces.
    estimates
        By law and parameter (mu_0, a, b, D_c, a_minus_b), value, standard error and 95 % interval: from the
        residuals of one record, or from the jackknife over surfaces (in ln D_c), unless the mean leaves D_c
        open.
    log_ratio
        ln(squares of the aging law / squares of the slip law), below 0 where the aging law fits better; its
        interval is NaN for one record.
    delta_aicc, relative_likelihood
        AICc of the aging law less that of the slip law with `effective_points`, and exp(-abs(delta_aicc)/2),
        of one record; NaN for several.
    effective_points
        Number of independent values that one record is worth, by the residuals of the better law.
    free
        Where the stiffness was given, the fits that find it.
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
    free: Mapping[StateLaw, RateAndStateFit] = field(default_factory=dict)

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
        """Least and largest value among the fits that suit, and whether the 95 % intervals are narrower.

        None where a fit leaves it open, as its error is above its value.
        """
        estimates = [fit.estimates[name] for fit in self.suiting]
        values = [float(one.value) for one in estimates]
        moves = max(values) - min(values) > max(float(one.high - one.low) for one in estimates)
        is_open = any(one.stderr > abs(one.value) for one in estimates)
        return min(values), max(values), None if is_open else moves

    @property
    def preferred(self) -> StateLaw:
        """The law of the verdict; where it is undecided, the one that fits better."""
        if self.verdict != "undecided":
            return self.verdict
        return "aging" if float(self.log_ratio.value) <= 0 else "slip"

    def peaks(self, law: StateLaw | None = None) -> HoldPeaks:
        """Static friction against hold time: of the record, or as a law has it at the same times."""
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

    The friction of several records, of different surfaces with the same times and velocities, is averaged,
    and uncertainties follow from their scatter. Other arguments and errors are those of `rate_and_state`; a
    stiffness is for one record, and where it is given it is fitted as well.
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
    is_given = all(isinstance(fit, MachineFit) and fit.stiffness_stderr == 0 for fit in fits.values())
    if len(several) == 1:
        better = min(fits.values(), key=_lack)
        ratio, unknown = np.array(_log_ratio(fits)), np.array(math.nan)
        log_ratio, worth = Estimate(ratio, unknown, unknown, unknown, 1), better.effective_points
        delta = worth * float(log_ratio.value)
        likelihood = math.exp(-abs(delta) / 2)
        decided = likelihood < UNLIKELY
    else:
        found = jackknife(statistics, friction)
        log_ratio = found.part(-1)
        decided = float(log_ratio.low) > 0 or float(log_ratio.high) < 0
        for n, law in enumerate(STATE_LAWS):
            if fits[law].determined:
                estimates[law] = {
                    name: found.part(at, scale=name == "D_c")
                    for at, name in enumerate(PARAMETERS, n * len(PARAMETERS))
                }
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
        free=fitted(mean.friction, "fit") if is_given else {},
    )


def _check_same(first: Record, other: Record) -> None:
    for name in ("time", "velocity"):
        mine, theirs = getattr(first, name), getattr(other, name)
        if mine.size != theirs.size or not np.allclose(
            mine, theirs, rtol=_SAME, atol=_SAME * np.abs(mine).max()
        ):
            got = f"{theirs.size} and {mine.size} times" if mine.size != theirs.size else f"another {name}"
            raise InputError(
                "records",
                expected="records of one protocol, at the same times and velocities",
                got=got,
                advice="a call for each record",
            )


def _lack(fit: RateAndStateFit) -> float:
    return lack_of(fit.residual, given=False, rounding=ROUNDING * fit.mu_0)


def _log_ratio(fits: Mapping[StateLaw, RateAndStateFit]) -> float:
    return _lack(fits["aging"]) - _lack(fits["slip"])


def _numbers(fit: RateAndStateFit) -> list[float]:
    """The parameters in order, D_c as its logarithm."""
    return [math.log(fit.D_c) if name == "D_c" else float(getattr(fit, name)) for name in PARAMETERS]
