"""Verdicts on parameters, combinations that data determine better, and the best next measurement."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from scipy.stats import chi2

from asperity.base.checks import Floats
from asperity.inference.models import Curve
from asperity.inference.sampling import Problem

Word = Literal["determined", "bounded", "bounded above", "bounded below", "not identified"]
WORD: dict[tuple[bool, bool], Word] = {
    (True, True): "bounded",
    (False, True): "bounded above",
    (True, False): "bounded below",
    (False, False): "not identified",
}
"""Verdicts by whether the low and the high end of the prior are excluded."""
WORDS: tuple[Word, ...] = ("determined", *WORD.values())

FACTOR = 3.0
"""Ratio of the ends of its interval below which a parameter between excluded ends is determined."""

LEVEL = 0.95
_LIMIT = float(chi2.ppf(LEVEL, 1))
EXCLUDED = float(np.exp(-_LIMIT / 2))
"""Density of the posterior over that of the prior, relative to its peak, below which an end is excluded."""

_TIGHTER = 3.0
"""Least ratio of the spread of the best known member of a combination to that of the combination."""

_PROFILE, _OUTER, _HALVED = 9, 3, 8
"""Points of a profile within the posterior and on either side of it, and halvings towards its 95 % level."""
_STEPS = 7
"""Steps to a value beyond an end."""
_EARLIER = 100.0


@dataclass(frozen=True)
class Verdict:
    """Verdict of the data on one parameter.

    Attributes
    ----------
    parameter, unit
        Its name and unit.
    verdict
        ``"bounded"`` if the data exclude both ends of its prior, ``"determined"`` if also the ends of its
        95 % interval differ by less than a factor of three; ``"bounded above"`` or ``"bounded below"`` if the
        data exclude only the high or the low end; else ``"not identified"``. An end is excluded if the
        posterior over the prior is below 0.15 of its peak, as a likelihood is outside of a 95 % interval. A
        parameter that is only known together with an unidentified one is not identified; see `Combination`.
    low, high
        95 % interval: the middle of the posterior; for a one-sided bound it begins or ends with the prior.
    median
        Median of the posterior.
    profile
        The 95 % interval by the profile likelihood, infinite on a side without a limit.
    """

    parameter: str
    unit: str
    verdict: Word
    low: float
    high: float
    median: float
    profile: tuple[float, float]

    def __str__(self) -> str:
        return self.verdict

    @property
    def words(self) -> str:
        """The parameter with its interval or its bound."""
        unit = f" {self.unit}" if self.unit else ""
        if self.verdict.startswith("bounded "):
            sign, end = ("<", self.high) if self.verdict == "bounded above" else (">", self.low)
            return f"{self.parameter} {sign} {end:.3g}{unit}"
        low, median, high = distinguishable(self.low, self.median, self.high)
        wide = self.verdict == "bounded" and math.isfinite(self.factor)
        within = f" within a factor of {_plain(self.factor, 2)}" if wide else ""
        return f"{self.parameter} = {median} [{low}, {high}]{unit}{within}"

    @property
    def factor(self) -> float:
        """Ratio of the ends of the interval, 1 or more; infinite where it contains 0."""
        ends = sorted((abs(self.low), abs(self.high)))
        return ends[1] / ends[0] if self.low * self.high > 0 else math.inf


@dataclass(frozen=True)
class Combination:
    """A combination of parameters, such as ``"load / modulus"``, that the data determine better than these.

    `low` and `high` are its 95 % interval. The spread of its logarithm is `tighter` times smaller than that
    of the best known member.
    """

    name: str
    members: tuple[str, ...]
    low: float
    high: float
    tighter: float


@dataclass(frozen=True)
class Candidate:
    """A possible next measurement, which would narrow undetermined parameters.

    `widths` are, by parameter, the largest expected widths of intervals over the present ones.
    """

    name: str
    widths: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Posterior:
    """Coordinates z of draws of the posterior, shape (n, parameters), and values of draws of the prior."""

    problem: Problem
    z: Floats
    prior: Mapping[str, Floats]

    @cached_property
    def values(self) -> dict[str, Floats]:
        """Draws of each parameter."""
        return self.problem.values(self.z)

    @cached_property
    def log_likelihood(self) -> Floats:
        """Logarithm of the likelihood of each draw."""
        return self.problem.log_likelihood(self.z)

    @cached_property
    def profiles(self) -> dict[str, tuple[Floats, Floats]]:
        """Profile likelihoods: values, and -2 ln of the likelihood over its largest."""
        names = list(self.problem.model.priors)
        return {names[place]: self._profile(place) for place in self.problem.used}

    def verdicts(self) -> dict[str, Verdict]:
        """Judge each parameter."""
        least, _ = self.problem.improved(self._likeliest, self.problem.used)
        verdicts = {}
        for place, (name, prior) in enumerate(self.problem.model.priors.items()):
            draws = self.prior[name], self.values[name]
            excluded, profile = excluded_ends(*draws), (-math.inf, math.inf)
            if name in self.profiles:
                excluded = self._by_data_alone(place, excluded, least + _LIMIT)
                profile = interval_of(*self.profiles[name])
            low, high = interval_within(excluded, *draws)
            median = float(np.median(self.values[name]))
            verdict = Verdict(name, prior.unit, WORD[excluded], low, high, median, profile)
            if verdict.verdict == "bounded" and verdict.factor < FACTOR:
                verdict = replace(verdict, verdict="determined")
            verdicts[name] = verdict
        return verdicts

    def combinations(self) -> tuple[Combination, ...]:
        """Find products, ratios and sums that the data determine better than their members; best first."""
        values = {name: self.values[name] for name in self.profiles}
        combinations: list[Combination] = []
        for size in (2, 3):
            for members in itertools.combinations(values, size):
                if any((values[name] <= 0).any() for name in members):
                    continue
                logs = [np.log(values[name]) for name in members]
                least = min(_spread(values[name]) for name in members)
                exponents = {}
                for signs in itertools.product((1, -1), repeat=size - 1):
                    pairs = zip(signs, members[1:], strict=True)
                    words = (f" {'*' if sign > 0 else '/'} {name}" for sign, name in pairs)
                    product = sum(sign * log for sign, log in zip((1, *signs), logs, strict=True))
                    exponents[members[0] + "".join(words)] = np.exp(product)
                if size == 2 and len({self.problem.model.priors[name].unit for name in members}) == 1:
                    exponents[" + ".join(members)] = values[members[0]] + values[members[1]]
                for name, draws in exponents.items():
                    tighter = least / max(_spread(draws), 1e-12)
                    combinations.append(Combination(name, members, *_middle(draws), tighter))
        combinations.sort(key=lambda candidate: (len(candidate.members), -candidate.tighter))
        kept: list[Combination] = []
        for candidate in combinations:
            # Three parameters must be twice as well known as any two of them.
            beaten = [other for other in kept if set(other.members) < set(candidate.members)]
            enough = max([_TIGHTER, *(2 * other.tighter for other in beaten)])
            if candidate.tighter > enough and all(other.members != candidate.members for other in kept):
                kept.append(candidate)
        return tuple(sorted(kept, key=lambda candidate: -candidate.tighter))

    @property
    def _likeliest(self) -> Floats:
        return np.asarray(self.z[np.argmax(self.log_likelihood)])

    def _nearest(self, place: int, at: float, count: int) -> Floats:
        """A copy of the likeliest draws near a coordinate, the best last."""
        near = np.argsort(np.abs(self.z[:, place] - at))[: len(self.z) // _PROFILE]
        return np.asarray(self.z[near[np.argsort(self.log_likelihood[near])[-count:]]])

    def _profile(self, place: int) -> tuple[Floats, Floats]:
        """Profile of one parameter, by searches from draws and from the next point."""
        prior = list(self.problem.model.priors.values())[place]
        first, last = prior.reach
        others = [other for other in self.problem.used if other != place]
        low, high = np.quantile(self.z[:, place], (0.005, 0.995))
        reach, best = max(high - low, 1e-6), float(self._likeliest[place])
        inner = np.clip(np.linspace(low - reach / 3, high + reach / 3, _PROFILE), first, last)
        outer = np.linspace([first, inner[-1]], [inner[0], last], _OUTER).ravel()
        computed: dict[float, tuple[float, Floats]] = {}

        def solve(at: float) -> None:
            starts = [*self._nearest(place, at, 2)]
            if computed:
                starts.append(computed[min(computed, key=lambda other: abs(other - at))][1].copy())
            for start in starts:
                start[place] = at
            tried = [self.problem.improved(start, others) for start in starts]
            computed[at] = min(tried, key=lambda minimum: minimum[0])

        def profile() -> tuple[Floats, Floats]:
            at = np.array(sorted(computed))
            squares = np.array([computed[other][0] for other in at])
            return at, squares - squares.min()

        for at in sorted(np.unique([*inner, *outer, best]), key=lambda at: abs(at - best)):
            solve(float(at))
        for _ in range(_HALVED):
            points, deviance = profile()
            for crossing in np.flatnonzero(np.diff(deviance > _LIMIT)):
                solve(float(points[crossing : crossing + 2].mean()))
        points, deviance = profile()
        return prior.at(points), deviance

    def _by_data_alone(self, place: int, excluded: tuple[bool, bool], most: float) -> tuple[bool, bool]:
        """Drop ends that follow from the ranges, of a decade or more, of other priors.

        An end follows from the data if these exclude a value one interval beyond it while the ranges of the
        other priors are five times as wide.
        """
        priors = list(self.problem.model.priors.values())
        others = [other for other in self.problem.used if other != place]
        wide = [prior.kind == "log_uniform" and prior.second > 10 * prior.first for prior in priors]
        beyond = [other for other in others if wide[other]]
        low, high = _middle(self.z[:, place])
        still = []
        for is_excluded, at in zip(excluded, (2 * low - high, 2 * high - low), strict=True):
            squares = -math.inf
            if is_excluded:
                (point,) = self._nearest(place, at, 1)
                for step in np.linspace(point[place], np.clip(at, *priors[place].reach), _STEPS):
                    point[place] = step  # the others follow in small steps
                    squares, point = self.problem.improved(point, others, beyond=beyond)
            still.append(squares >= most)
        return still[0], still[1]

    def candidates(self, undetermined: Sequence[str]) -> tuple[Candidate, ...]:
        """Weigh experiments by how much each would narrow undetermined parameters, with the present errors.

        The remaining variance of a parameter is at most that about its best linear estimate from the
        logarithms of the data, over the posterior (M. Goldstein, D. Wooff, Bayes Linear Statistics, Wiley
        2007).
        """
        model, values = self.problem.model, self.values
        time = self.problem.time[self.problem.time > 0]
        unit = "over the nominal one" if model.name == "lattice" else "in m²"
        loads = f"two known loads, with {'lengths in m' if model.power != 1 else f'areas {unit}'}"
        relative = float(np.median(self.problem.error / self.problem.value))
        planned: dict[str, tuple[Curve, Floats]] = {}
        if model.held is not None:
            planned["the load at a held displacement"] = model.held, time
        else:
            earlier = np.geomspace(time[0] / _EARLIER, time[0], time.size)
            planned["earlier times (from a hundredth of the first)"] = model.curve, earlier
        with np.errstate(all="ignore"):
            logs = {name: np.log(curve(at, values)) for name, (curve, at) in planned.items()}
            if model.size is not None:  # depends on the load, which is measured, too
                unscaled = replace(model, scaled=False)
                several = [unscaled.curve(time, values | {"load": k * values["load"]}) for k in (1.0, 2.0)]
                logs[loads] = np.log(np.hstack([*several, values["load"][:, None]]))
        targets = {
            name: np.log(values[name]) if model.priors[name].logarithmic else values[name]
            for name in undetermined
        }
        candidates = []
        for name, curves in logs.items():
            fine = np.isfinite(curves).all(1)
            if np.count_nonzero(fine) > 2 * curves.shape[1]:
                remaining = {key: _left(curves[fine], x[fine], relative) for key, x in targets.items()}
                if name == loads:
                    remaining.pop("load", None)  # it is measured
                candidates.append(Candidate(name, remaining))
        return tuple(candidates)


def excluded_ends(prior: Floats, posterior: Floats) -> tuple[bool, bool]:
    """Whether posterior draws of a parameter exclude the low and the high end of its prior; shapes (n,)."""
    share = np.searchsorted(np.sort(prior), posterior) / prior.size  # uniform where the data say nothing
    low, high = _middle(share)
    width = max((high - low) / 20, 1 / prior.size)
    most = np.histogram(share, np.arange(0, 1 + width, width))[0].max()
    low_end, high_end = (np.count_nonzero(part <= width) for part in (share, 1 - share))
    return low_end < EXCLUDED * most, high_end < EXCLUDED * most


def interval_within(excluded: tuple[bool, bool], prior: Floats, posterior: Floats) -> tuple[float, float]:
    """The 95 % interval; with one excluded end it extends to the other end of the prior."""
    if excluded == (False, True):
        return float(prior.min()), float(np.quantile(posterior, LEVEL))
    if excluded == (True, False):
        return float(np.quantile(posterior, 1 - LEVEL)), float(prior.max())
    return _middle(posterior)


def _middle(values: Floats) -> tuple[float, float]:
    low, high = np.quantile(values, ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    return float(low), float(high)


def interval_of(values: Floats, deviance: Floats) -> tuple[float, float]:
    """Interval in which a profile is below its 95 % level, infinite on a side on which it stays so."""
    best = int(np.argmin(deviance))
    ends = []
    for side, none in ((slice(best, None, -1), -np.inf), (slice(best, None), np.inf)):
        rising = np.maximum.accumulate(deviance[side])
        ends.append(float(np.interp(_LIMIT, rising, values[side])) if rising[-1] > _LIMIT else none)
    return ends[0], ends[1]


def distinguishable(*values: float) -> list[str]:
    """Write rising numbers with three digits or more, such that their difference has two."""
    size = max(abs(values[0]), abs(values[-1]))
    digits = 2 - math.floor(math.log10((values[-1] - values[0]) / size)) if values[-1] > values[0] else 3
    return [_plain(value, min(max(digits, 3), 8)) for value in values]


def _plain(value: float, digits: int) -> str:
    """Write a number with so many digits, below 1e8 without an exponent: 1620."""
    return f"{float(f'{value:.{digits}g}'):.8g}"


def _spread(values: Floats) -> float:
    """Half of the width, in ln, of the middle 68 % of the values."""
    low, high = np.quantile(values, (0.16, 0.84))
    return float(np.log(high / low) / 2) if low > 0 else np.inf


def _left(curves: Floats, parameter: Floats, relative: float) -> float:
    """Standard deviation of a parameter with data of this relative error, over the present one."""
    centered, target = curves - curves.mean(0), parameter - parameter.mean()
    covariance = centered.T @ centered / len(target) + relative**2 * np.eye(curves.shape[1])
    along = centered.T @ target / len(target)
    explained = along @ np.linalg.lstsq(covariance, along, rcond=None)[0] / target.var()
    return float(np.sqrt(max(1 - explained, 0.0)))
