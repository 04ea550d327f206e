"""What data determine of each parameter, which combinations they know better, and what would tell more."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from asperity.base.checks import Floats
from asperity.inference.models import Model
from asperity.inference.sampling import Problem

Word = Literal["determined", "bounded above", "bounded below", "not identified"]
_WORD: dict[tuple[bool, bool], Word] = {
    (True, True): "determined",
    (False, True): "bounded above",
    (True, False): "bounded below",
    (False, False): "not identified",
}
"""Verdicts by whether the low and the high end of the prior are excluded."""
WORDS = tuple(_WORD.values())

LEVEL = 0.95
_LIMIT = float(chi2.ppf(LEVEL, 1))
EXCLUDED = float(np.exp(-_LIMIT / 2))
"""Density of the posterior over the prior's, over its peak, below which an end of the prior is excluded."""

_TIGHTER = 3.0
"""How many times better than each of its members a combination must be known to be named."""

_PROFILE, _OUTER, _HALVED = 9, 3, 8
"""Points of a profile about the posterior, on either side of it, and halvings to where it is at its level."""
_STEPS = 7
"""Points on the way to what is beyond an end."""
_LATER = 100.0


@dataclass(frozen=True)
class Verdict:
    """What the data say of one parameter.

    Attributes
    ----------
    parameter, unit
        Its name and unit.
    verdict
        ``"determined"`` if the data exclude both ends of its prior; ``"bounded above"`` or
        ``"bounded below"`` if they exclude the high, or the low end only; else ``"not identified"``. An end
        is excluded if the posterior there, over the prior, is below 0.15 of its peak, as a likelihood is
        beyond a 95 % interval. A parameter that the data know only together with one that they do not
        identify is not identified either, see `Combination`.
    low, high
        95 % interval: the middle of the posterior; of a bounded parameter from, or to, the end of the prior.
    median
        Of the posterior.
    profile
        The 95 % interval by the profile likelihood: infinite on a side on which it never falls far enough.
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
        """The parameter with its interval, or the bound."""
        unit = f" {self.unit}" if self.unit else ""
        if self.verdict.startswith("bounded"):
            sign, end = ("<", self.high) if self.verdict == "bounded above" else (">", self.low)
            return f"{self.parameter} {sign} {end:.3g}{unit}"
        low, median, high = told_apart(self.low, self.median, self.high)
        return f"{self.parameter} = {median} [{low}, {high}]{unit}"


@dataclass(frozen=True)
class Combination:
    """A combination of parameters that the data know better than its members.

    Attributes
    ----------
    name
        Such as ``"load / modulus / rms_slope"``.
    members
        The parameters.
    low, high
        95 % interval.
    tighter
        How many times smaller its spread, of the logarithm, is than that of the member known best.
    """

    name: str
    members: tuple[str, ...]
    low: float
    high: float
    tighter: float


@dataclass(frozen=True)
class Candidate:
    """An experiment that could be done next.

    Attributes
    ----------
    name
        What would be measured.
    widths
        Of parameters that are not determined now: width of the interval that is expected at most, over the
        present one.
    """

    name: str
    widths: Mapping[str, float]


def verdicts_of(
    problem: Problem,
    prior: Mapping[str, Floats],
    z: Floats,
    found: Floats,
    profiles: Mapping[str, tuple[Floats, Floats]],
) -> dict[str, Verdict]:
    """Judge each parameter, by draws of its prior and of the posterior, and the logarithms of likelihoods."""
    least, _ = problem.improved(z[np.argmax(found)], problem.used)
    values, made = problem.values(z), {}
    for place, (name, one) in enumerate(problem.model.priors.items()):
        excluded, profile = excluded_ends(prior[name], values[name]), (-math.inf, math.inf)
        if name in profiles:
            excluded = _by_data_alone(problem, place, excluded, z, found, least + _LIMIT)
            profile = interval_of(*profiles[name])
        made[name] = verdict_of(name, one.unit, excluded, prior[name], values[name], profile)
    return made


def excluded_ends(prior: Floats, posterior: Floats) -> tuple[bool, bool]:
    """Which ends of its prior draws of one parameter exclude, shape (n,) each."""
    share = np.searchsorted(np.sort(prior), posterior) / prior.size  # uniform where the data say nothing
    low, high = _middle(share)
    width = max((high - low) / 20, 1 / prior.size)
    most = np.histogram(share, np.arange(0, 1 + width, width))[0].max()
    low_end, high_end = (np.count_nonzero(part <= width) for part in (share, 1 - share))
    return low_end < EXCLUDED * most, high_end < EXCLUDED * most


def verdict_of(
    name: str,
    unit: str,
    excluded: tuple[bool, bool],
    prior: Floats,
    posterior: Floats,
    profile: tuple[float, float],
) -> Verdict:
    """The verdict where these ends are excluded; a bounded parameter lies from, or to, the other end."""
    low, high = _middle(posterior)
    if excluded == (False, True):
        low, high = float(prior.min()), float(np.quantile(posterior, LEVEL))
    elif excluded == (True, False):
        low, high = float(np.quantile(posterior, 1 - LEVEL)), float(prior.max())
    return Verdict(name, unit, _WORD[excluded], low, high, float(np.median(posterior)), profile)


def _middle(values: Floats) -> tuple[float, float]:
    """Ends of the middle 95 %."""
    low, high = np.quantile(values, ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    return float(low), float(high)


def told_apart(*values: float) -> list[str]:
    """Rising numbers in so many digits, three or more, that their distance has two."""
    size = max(abs(values[0]), abs(values[-1]))
    digits = 2 - math.floor(math.log10((values[-1] - values[0]) / size)) if values[-1] > values[0] else 3
    return [f"{value:.{min(max(digits, 3), 8)}g}" for value in values]


def combinations_of(
    values: Mapping[str, Floats], model: Model, used: Sequence[str]
) -> tuple[Combination, ...]:
    """Find products, ratios and sums that the data know better than their members; the best first."""
    spread = {name: _spread(values[name]) for name in used}
    found: list[Combination] = []
    for size in (2, 3):
        for members in itertools.combinations(used, size):
            if any((values[name] <= 0).any() for name in members):
                continue
            logs = [np.log(values[name]) for name in members]
            for signs in itertools.product((1, -1), repeat=size - 1):
                made = np.exp(sum(sign * log for sign, log in zip((1, *signs), logs, strict=True)))
                words = (
                    f" {'*' if sign > 0 else '/'} {name}"
                    for sign, name in zip(signs, members[1:], strict=True)
                )
                found.append(_combined(members[0] + "".join(words), members, made, spread))
            if size == 2 and len({model.priors[name].unit for name in members}) == 1:
                total = values[members[0]] + values[members[1]]
                found.append(_combined(" + ".join(members), members, total, spread))
    kept: list[Combination] = []
    for one in sorted(found, key=lambda one: (len(one.members), -one.tighter)):
        # Of three, no more is said than of the two that are among them.
        beaten = [other for other in kept if set(other.members) < set(one.members)]
        enough = max([_TIGHTER, *(2 * other.tighter for other in beaten)])
        if one.tighter > enough and all(other.members != one.members for other in kept):
            kept.append(one)
    return tuple(sorted(kept, key=lambda one: -one.tighter))


def _spread(values: Floats) -> float:
    """Half of the width, in ln, that holds 68 % of the values."""
    low, high = np.quantile(values, (0.16, 0.84))
    return float(np.log(high / low) / 2) if low > 0 else np.inf


def _combined(name: str, members: tuple[str, ...], made: Floats, spread: Mapping[str, float]) -> Combination:
    tighter = min(spread[one] for one in members) / max(_spread(made), 1e-12)
    return Combination(name, members, *_middle(made), tighter)


def profile_of(problem: Problem, place: int, z: Floats, found: Floats) -> tuple[Floats, Floats]:
    """Profile likelihood of one parameter: values, and -2 ln of the likelihood over its largest.

    Draws of the posterior z, shape (n, parameters), with the logarithms of their likelihoods, are where each
    search begins; see `Problem.improved`.
    """
    prior = list(problem.model.priors.values())[place]
    first, last = prior.reach
    others = [one for one in problem.used if one != place]
    low, high = np.quantile(z[:, place], (0.005, 0.995))
    reach = max(high - low, 1e-6)
    inner = np.clip(np.linspace(low - reach / 3, high + reach / 3, _PROFILE), first, last)
    outer = np.linspace([first, inner[-1]], [inner[0], last], _OUTER).ravel()
    grid = np.unique(np.concatenate([inner, outer, z[np.argmax(found), place : place + 1]]))
    known: dict[float, tuple[float, Floats]] = {}

    def solve(at: float) -> None:
        starts = [*z[_nearest(z, place, at, found)[-2:]]]
        starts += [known[one][1].copy() for one in sorted(known, key=lambda one: abs(one - at))[:1]]
        for start in starts:
            start[place] = at
        known[at] = min((problem.improved(start, others) for start in starts), key=lambda one: one[0])

    def profile() -> tuple[Floats, Floats]:
        at = np.array(sorted(known))
        squares = np.array([known[one][0] for one in at])
        return at, squares - squares.min()

    for at in sorted(grid, key=lambda at: abs(at - z[np.argmax(found), place])):
        solve(float(at))
    for _ in range(_HALVED):
        points, deviance = profile()
        for crossing in np.flatnonzero(np.diff(deviance > _LIMIT)):
            solve(float(points[crossing : crossing + 2].mean()))
    points, deviance = profile()
    return prior.at(points), deviance


def interval_of(values: Floats, deviance: Floats) -> tuple[float, float]:
    """Where a profile is below its 95 % level; infinite on a side on which it stays so."""
    best = int(np.argmin(deviance))
    ends = []
    for side, none in ((slice(best, None, -1), -np.inf), (slice(best, None), np.inf)):
        rising = np.maximum.accumulate(deviance[side])
        ends.append(float(np.interp(_LIMIT, rising, values[side])) if rising[-1] > _LIMIT else none)
    return ends[0], ends[1]


def _by_data_alone(
    problem: Problem, place: int, excluded: tuple[bool, bool], z: Floats, found: Floats, most: float
) -> tuple[bool, bool]:
    """Take back the ends that follow from the ranges, of a decade or more, of the priors of others.

    The data exclude an end if they exclude what is a whole interval beyond it, too, where the ranges of the
    others are five times as wide.
    """
    priors, others = list(problem.model.priors.values()), [one for one in problem.used if one != place]
    wide = [one.kind == "log_uniform" and one.second > 10 * one.first for one in priors]
    beyond = [one for one in others if wide[one]]
    low, high = _middle(z[:, place])
    still = []
    for is_excluded, at in zip(excluded, (2 * low - high, 2 * high - low), strict=True):
        squares = -math.inf
        if is_excluded:
            there = z[_nearest(z, place, at, found)[-1]].copy()
            for step in np.linspace(there[place], np.clip(at, *priors[place].reach), _STEPS):
                there[place] = step  # the others follow in small steps
                squares, there = problem.improved(there, others, beyond=beyond)
        still.append(squares >= most)
    return still[0], still[1]


def _nearest(z: Floats, place: int, at: float, found: Floats) -> NDArray[np.intp]:
    """Draws near a coordinate, the likeliest last."""
    near = np.argsort(np.abs(z[:, place] - at))[: len(z) // _PROFILE]
    return np.asarray(near[np.argsort(found[near])])


def candidates_of(problem: Problem, z: Floats, undetermined: Sequence[str]) -> tuple[Candidate, ...]:
    """Weigh experiments: by how much each would narrow what is not determined, if errors are as now.

    The variance that is left of a parameter is at most that about its best linear estimate from the
    logarithms of the data, over the posterior (M. Goldstein, D. Wooff, Bayes Linear Statistics, Wiley 2007).
    """
    time, model, values = problem.time[problem.time > 0], problem.model, problem.values(z)
    loads = f"two known loads, with areas {'over the nominal one' if model.name == 'lattice' else 'in m²'}"
    relative = float(np.median(problem.error / problem.value))
    later = np.geomspace(time[-1], _LATER * time[-1], time.size)
    earlier = np.geomspace(time[0] / _LATER, time[0], time.size)
    with np.errstate(all="ignore"):
        planned = {"longer times (to 100 times the last)": np.log(model.curve(later, values))}
        if model.held is not None:
            planned["the load at a held displacement"] = np.log(model.held(time, values))
        else:
            planned["earlier times (from a hundredth of the first)"] = np.log(model.curve(earlier, values))
        if model.size is not None:  # areas are in proportion to the load, which is measured, too
            areas = np.log(model.size(values)[:, None] * model.growth(time, values))
            measured = np.log(values["load"])[:, None]
            planned[loads] = np.hstack([areas, areas + np.log(2), measured])
    made = []
    for name, curves in planned.items():
        fine = np.isfinite(curves).all(1)
        if np.count_nonzero(fine) > 2 * curves.shape[1]:
            known = {
                one: np.log(values[one]) if model.priors[one].logarithmic else values[one]
                for one in undetermined
                if (name, one) != (loads, "load")  # which is measured
            }
            widths = {one: _left(curves[fine], known[one][fine], relative) for one in known}
            made.append(Candidate(name, widths))
    return tuple(made)


def _left(curves: Floats, parameter: Floats, relative: float) -> float:
    """Deviation of a parameter that data of this relative error leave, over the present one."""
    centered, target = curves - curves.mean(0), parameter - parameter.mean()
    covariance = centered.T @ centered / len(target) + relative**2 * np.eye(curves.shape[1])
    along = centered.T @ target / len(target)
    told = along @ np.linalg.solve(covariance, along) / target.var()
    return float(np.sqrt(max(1 - told, 0.0)))
