"""Comparison of models: their fits, their predictions of the last points, and their extrapolations."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from asperity.base import views
from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.fits.comparison import UNLIKELY, independent, lack_of, price_of
from asperity.fits.result import rms
from asperity.inference.leastsquares import best_fit
from asperity.inference.models import Curve
from asperity.inference.problem import Problem

ACCEPTED = -2 * math.log(UNLIKELY)
"""AICc over the least, below which a model is acceptable: it is at least 0.05 times as likely as the best."""

_HELD, _OF = 3, 5
"""Least number of last points that are held out; all points over the held-out ones."""

LEAST_ERROR = 1e-9
"""Least relative error of data: that of rounding."""

_MISFIT = 1e-3
"""Probability of a misfit below which a model misses data of known errors."""

CORRELATED = 0.7
"""Largest correlation of neighboring misfits that is scatter."""

_FACTORS = 10, 100, 1000
"""Times over the last one at which models are compared."""

_STEADY = 0.8
"""Least ratio of the last third's growth to the second's for which a growth is steady."""

_APART = 3.0
"""Difference, in standard errors, that distinguishes two models."""


@dataclass(frozen=True, eq=False, repr=False)
class Rival(views.Brief):
    """A model in a comparison.

    Attributes
    ----------
    aicc, missed
        AICc less the least of all models. Rms misfit, in standard errors, of the last fifth of the points,
        three at least, by a fit to the others; NaN if these are too few.
    problem, at, misfit
        Data and model; coordinates of the best fit; its misfit in standard errors, shape (n,).
    z
        Draws of the posterior, shape (draws, parameters); None for a model that is not acceptable.
    """

    aicc: float
    missed: float
    problem: Problem
    at: Floats
    misfit: Floats
    z: Floats | None = None

    @property
    def name(self) -> str:
        """Its number of relaxation times, or its name."""
        return self.problem.model.words

    @property
    def times(self) -> int:
        """The number of its relaxation times, 0 for another creep."""
        return self.problem.model.times

    @classmethod
    def fitted(cls, problem: Problem) -> Rival | None:
        """Fit a model; None for too few points."""
        n, needed = problem.time.size, problem.rank + (not problem.informed)  # the scatter is a parameter
        if n < needed:
            return None
        _, at = best_fit(problem)
        missed = math.nan
        kept = n - max(_HELD, n // _OF)
        if kept > needed:
            early = {column: getattr(problem, column)[:kept] for column in ("time", "value", "error")}
            _, place = best_fit(replace(problem, **early))
            missed = rms(problem.misfit(place[np.newaxis])[0, kept:])
        return cls(math.inf, missed, problem, at, problem.misfit(at[np.newaxis])[0])

    @functools.cached_property
    def scatter(self) -> tuple[float, float]:
        """Standard error over the stated one, and correlation of neighbors; 1 and 0 of known errors."""
        return (1.0, 0.0) if self.problem.informed else self.problem.scatter(self.at)

    @property
    def misses(self) -> bool:
        """Whether the misfit is more than scatter: by chi-squared, or by the correlation of neighbors."""
        if not self.problem.informed:
            return independent(self.misfit)[1] < 1 and self.scatter[1] > CORRELATED
        free = max(self.misfit.size - self.problem.rank, 1)
        return bool(chi2.sf(self.misfit @ self.misfit, free) < _MISFIT)

    def score(self, share: float) -> float:
        """AICc, of the share of rows that are independent; infinite for too few."""
        n, needed = self.misfit.size, self.problem.rank + (not self.problem.informed)
        if n <= needed + 1:
            return math.inf
        lack = lack_of(self.misfit, weighted=self.problem.informed, rounding=LEAST_ERROR)
        return n * share * lack + price_of(n, needed)

    def band(self, time: Floats) -> Floats:
        """2.5, 50 and 97.5 % quantiles of the curve over the draws, or the best fit: shape (3, n)."""
        z = self.at[np.newaxis] if self.z is None else self.z
        curves = self.problem.model.curve(time, self.problem.values(z))
        return np.asarray(np.quantile(curves, (0.025, 0.5, 0.975), axis=0))

    def solids(self, many: int) -> list[dict[str, object]]:
        """Sections ``[solid]`` of so many draws."""
        if self.z is None or (solid := self.problem.model.solid) is None:
            return []
        some = self.z[np.linspace(0, len(self.z) - 1, many).astype(int)]
        return [solid(self.problem.numbers(z)) for z in some]


def side_by_side(family: Sequence[Problem], others: Sequence[Problem]) -> list[Rival]:
    """Fit a family of models, of which AICc chooses the first, and others for comparison.

    Rows whose misfits correlate count less. `InputError` for too few points.
    """
    for problem in family:
        if not problem.used:
            expected = "a curve that depends on its parameters"
            raise InputError("model", expected=expected, got=problem.model.name)
    members = [*filter(None, map(Rival.fitted, family))]
    if not members:
        problem = family[0]
        needed = f"at least {problem.rank + (not problem.informed)} points, for {problem.rank} parameters"
        expected = needed + " and the scatter" * (not problem.informed)
        advice = "more points, or fewer parameters"
        raise InputError("time", expected=expected, got=problem.time.size, advice=advice)
    every = [*members, *filter(None, map(Rival.fitted, others))]
    closest = min(every, key=lambda rival: rms(rival.misfit))
    rho = min(closest.scatter[1], CORRELATED)
    scores = [rival.score(min(1.0, (1 - rho) / (1 + rho))) for rival in every]
    first, lowest = int(np.argmin(scores[: len(members)])), min(scores)
    order = [first, *(n for n in range(len(every)) if n != first)]
    return [replace(every[n], aicc=scores[n] - lowest if scores[n] < math.inf else math.inf) for n in order]


def with_draws(
    rivals: Sequence[Rival], first: Rival, drawn_of: Callable[[Problem, Floats], Floats | None]
) -> list[Rival]:
    """The rivals with the errors of the first, which has draws; acceptable ones get draws.

    Acceptable models fit nearly as well as the best, or predict the held-out points best. Of several numbers
    of relaxation times only that with the least AICc is acceptable.
    """
    scale = rivals[0].problem.error / first.problem.error
    errors = {name: getattr(first.problem, name) for name in ("error", "rho", "counted", "informed")}
    best = min((rival.aicc for rival in rivals if rival.times), default=0.0)
    least_missed = min((rival.missed for rival in rivals if math.isfinite(rival.missed)), default=-math.inf)
    drawn = []
    for n, rival in enumerate(rivals):
        near = rival.aicc < ACCEPTED or rival.missed == least_missed
        counts = n > 0 and near and (not rival.times or rival.aicc == best)
        problem = replace(rival.problem, **errors)
        missed = rival.missed * float(np.median(scale))
        z = drawn_of(problem, rival.at) if counts else None
        drawn.append(replace(rival, misfit=rival.misfit * scale, missed=missed, problem=problem, z=z))
    return [replace(drawn[0], problem=first.problem, at=first.at, z=first.z), *drawn[1:]]


def drift_in(first: Rival, last: float, curve: Curve, size: float = 1.0) -> list[str]:
    """A remark if a curve rises steadily until the last time, as by a drift of the instrument.

    The size is that of the data for a curve of 1.
    """
    problem = first.problem
    with np.errstate(all="ignore"):  # within a ramp, a power has no value at time 0
        times, values = last * np.arange(4) / 3, problem.values(first.at[np.newaxis])
        start, begin, middle, end = curve(times, values)[0]
    start = start if math.isfinite(start) else begin
    error = float(np.median(problem.error)) / size / math.sqrt(max(problem.time.size / 3, 1))
    steady = end - begin > _APART * error and end - middle > _STEADY * (middle - begin)
    if not (steady and math.isfinite(end)):
        return []
    rate = 300 * (end - middle) / (last * start)
    return [
        f"the creep is still steady at its end, at {rate:.2g} % of the first value per s: a drift of the "
        "instrument and a solid that flows cannot be told apart, unless the drift is measured on a stiff "
        "solid and subtracted, or a second load shows that the rate depends on it"
    ]


def parting(rivals: Sequence[Rival]) -> list[str]:
    """State the range of the data, the extrapolations of acceptable models, and how to distinguish these."""
    first, problem = rivals[0], rivals[0].problem
    time, last = problem.time[problem.time > 0], float(problem.time[-1])
    sentences = [
        f"The data go from {time[0]:g} to {last:g} s, and the model of {first.name} tells nothing beyond"
    ]
    others = [rival for rival in rivals[1:] if rival.z is not None]
    later = last * np.array(_FACTORS, dtype=np.float64)
    differ = np.array([rival.band(later)[1] / first.band(later)[1] - 1 for rival in others])
    for rival, (near, _, far) in zip(others, 100 * differ, strict=True):
        fits = "fits better" if rival.aicc < first.aicc else "is acceptable, too"
        at = f"{near:+.2g} % at {_FACTORS[0]} times the last time, {far:+.2g} % at {_FACTORS[-1]} times"
        sentences.append(f"{rival.name} {fits} (AICc {rival.aicc - first.aicc:+.2g}), but predicts {at}")
    if others:
        most, error = np.abs(differ).max(axis=0), float(np.median(problem.error / problem.value))
        n = int(np.argmax(most > _APART * error)) if most[-1] > _APART * error else len(_FACTORS) - 1
        would = "would" if most[n] > _APART * error else "would hardly"
        sentences.append(
            f"Measuring to {_FACTORS[n]} times the last time {would} tell them apart: "
            f"there they differ by {100 * most[n]:.2g} %, {most[n] / error:.2g} errors"
        )
    unlike = [rival for rival in rivals[1:] if not (first.times and rival.times)]
    if not others and unlike and math.isfinite(first.aicc):
        near = min(unlike, key=lambda rival: rival.aicc)
        sentences.append(
            f"No other creep that was tried is acceptable; the next is {near.name}, AICc {near.aicc:+.3g}"
        )
    return sentences
