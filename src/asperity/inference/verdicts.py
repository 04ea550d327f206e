"""Verdicts on parameters, combinations that data determine better, and the best next measurement."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from asperity.base.checks import Floats
from asperity.fits.result import SURE as LEVEL
from asperity.inference.leastsquares import LIMIT, ONE_SIDED, Profile, least
from asperity.inference.models import Curve
from asperity.inference.priors import Prior
from asperity.inference.problem import Problem

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

_NORMAL = math.sqrt(LIMIT)
"""Half width of the 95 % interval of a normal distribution, in standard deviations."""

_TIGHTER = 3.0
"""Least ratio of the spread of the best known member of a combination to that of the combination."""

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
        profile likelihood is below 0.15 of its peak there, as it is outside of a 95 % interval. A
        parameter that is only known together with an unidentified one is not identified; see `Combination`.
    low, high
        95 % interval, by the profile likelihood, or the middle of the posterior if it was sampled; for a
        one-sided bound it begins or ends with the prior.
    value
        Most likely value, or the median of the posterior if it was sampled.
    profile
        The 95 % interval by the profile likelihood, infinite on a side without a limit.
    """

    parameter: str
    unit: str
    verdict: Word
    low: float
    high: float
    value: float
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
        low, value, high = distinguishable(self.low, self.value, self.high)
        wide = self.verdict == "bounded" and math.isfinite(self.factor)
        within = f" within a factor of {_plain(self.factor, 2)}" if wide else ""
        return f"{self.parameter} = {value} [{low}, {high}]{unit}{within}"

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
    """Coordinates z of draws of the posterior, shape (n, parameters), best fit, and profiles by place.

    Intervals are those of the draws if they are ``sampled``, else of the profiles.
    """

    problem: Problem
    z: Floats
    best: Floats
    followed: Mapping[int, Profile]
    sampled: bool

    @cached_property
    def values(self) -> dict[str, Floats]:
        """Draws of each parameter."""
        return self.problem.values(self.z)

    @cached_property
    def profiles(self) -> dict[str, tuple[Floats, Floats]]:
        """Profile likelihoods: values, and -2 ln of the likelihood over its largest."""
        named = list(self.problem.model.priors.items())
        return {
            named[place][0]: (named[place][1].at(one.at), one.deviance)
            for place, one in self.followed.items()
        }

    def verdicts(self) -> dict[str, Verdict]:
        """Judge each parameter."""
        excluded = self._excluded()
        verdicts = {}
        for place, (name, prior) in enumerate(self.problem.model.priors.items()):
            ends = excluded.get(place, (False, False))
            value = np.median(self.z[:, place]) if self.sampled else self.best[place]
            low, value, high = prior.at(np.insert(self._interval(place, prior, ends), 1, value)).tolist()
            both = self.followed[place].ends() if place in self.followed else np.array([-math.inf, math.inf])
            profile = np.where(np.isfinite(both), prior.at(np.where(np.isfinite(both), both, 0.0)), both)
            verdict = Verdict(name, prior.unit, WORD[ends], low, high, value, (*profile.tolist(),))
            if verdict.verdict == "bounded" and verdict.factor < FACTOR:
                verdict = replace(verdict, verdict="determined")
            verdicts[name] = verdict
        return verdicts

    def _interval(self, place: int, prior: Prior, excluded: tuple[bool, bool]) -> Floats:
        """Coordinates of the ends of the 95 % interval; it goes to an end of a range that is not excluded."""
        lone, bounds = excluded[0] != excluded[1], prior.reach if prior.bounded else (-_NORMAL, _NORMAL)
        if self.sampled:
            tail = (1 - LEVEL) / (1 if lone else 2)
            ends = np.quantile(self.z[:, place], (tail, 1 - tail))
        elif place in self.followed:
            ends = self.followed[place].ends(ONE_SIDED if lone else LIMIT)
        else:
            ends = np.array(bounds)
        return np.where(np.array(excluded) | (not prior.bounded), ends, bounds)

    def _excluded(self) -> dict[int, tuple[bool, bool]]:
        """Which ends of each prior the data exclude, without those that follow from ranges of other priors.

        An end follows from the data if these exclude a value one interval beyond it while the ranges, of a
        decade or more, of the other priors are five times as wide. If it lies beyond the range, all values
        from half the way to the end of the range must be excluded.
        """
        priors, reach = list(self.problem.model.priors.values()), self.problem.reach
        wide = np.array([prior.kind == "log_uniform" and prior.second > 10 * prior.first for prior in priors])
        found = {place: one.excluded(not priors[place].bounded) for place, one in self.followed.items()}
        tasks = [(place, side) for place, ends in found.items() for side in (-1, 1) if ends[int(side > 0)]]
        if not tasks:
            return found
        begin, aims, cut = [], [], []
        for place, side in tasks:
            one = self.followed[place]
            low, high = np.clip(one.ends(), *reach[place])
            begin.append(one.z[np.argmin(np.abs(one.at - (high if side > 0 else low)))])
            aim = 2 * high - low if side > 0 else 2 * low - high
            aims.append(np.clip(aim, *reach[place]))
            cut.append(aims[-1] != aim)
        z, places = np.array(begin), np.array([place for place, _ in tasks])
        rows, first = np.arange(len(tasks)), z[np.arange(len(tasks)), places].copy()
        held = np.arange(z.shape[1]) == places[:, None]
        squares = np.full(len(tasks), np.inf)
        for share in np.linspace(0, 1, _STEPS)[1:]:  # the others follow in small steps
            z[rows, places] = first + share * (np.array(aims) - first)
            there, z = least(self.problem, z, held=held, beyond=wide & ~held)
            on_the_way = np.array(cut) & (share >= 0.5)
            squares = np.where(on_the_way, np.minimum(squares, there), there)
        (lowest,), _ = least(self.problem, self.best[np.newaxis])
        alone = {task for task, far in zip(tasks, squares >= lowest + LIMIT, strict=True) if far}
        return {place: ((place, -1) in alone, (place, 1) in alone) for place in found}

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
                    low, high = np.quantile(draws, ((1 - LEVEL) / 2, (1 + LEVEL) / 2)).tolist()
                    combinations.append(Combination(name, members, low, high, tighter))
        combinations.sort(key=lambda candidate: (len(candidate.members), -candidate.tighter))
        kept: list[Combination] = []
        for candidate in combinations:
            # Three parameters must be twice as well known as any two of them.
            beaten = [other for other in kept if set(other.members) < set(candidate.members)]
            enough = max([_TIGHTER, *(2 * other.tighter for other in beaten)])
            if candidate.tighter > enough and all(other.members != candidate.members for other in kept):
                kept.append(candidate)
        return tuple(sorted(kept, key=lambda candidate: -candidate.tighter))

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
        with np.errstate(divide="ignore"):
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
