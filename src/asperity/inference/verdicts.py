"""What data determine of each parameter, which combinations they know better, and what would tell more."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.stats import chi2

from asperity.base.checks import Floats
from asperity.inference.models import Model
from asperity.inference.priors import Prior
from asperity.inference.sampling import Problem

Word = Literal["determined", "bounded above", "bounded below", "not identified"]

LEVEL = 0.95
_EXCLUDED = float(np.exp(-chi2.ppf(LEVEL, 1) / 2))
"""Density of the posterior over the prior's, over its peak, below which an end of the prior is excluded."""

_TIGHTER = 3.0
"""How many times better than each of its members a combination must be known to be named."""

_PROFILE, _OUTER = 13, 4
"""Points of a profile about the posterior, and on either side of it."""
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
        return f"{self.parameter} = {self.median:.3g} [{self.low:.3g}, {self.high:.3g}]{unit}"


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
        Of each parameter that is not determined now: expected width of its interval over the present one.
    """

    name: str
    widths: Mapping[str, float]


def verdict_of(
    name: str, unit: str, prior: Floats, posterior: Floats, profile: tuple[float, float]
) -> Verdict:
    """Judge one parameter by draws of its prior and of its posterior, shape (n,) each."""
    share = np.searchsorted(np.sort(prior), posterior) / prior.size  # uniform where the data say nothing
    low, high = np.quantile(share, ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    width = max((high - low) / 20, 1 / prior.size)
    counts = np.histogram(share, np.arange(0, 1 + width, width))[0]
    at_low, at_high = (
        np.count_nonzero(part <= width) < _EXCLUDED * counts.max() for part in (share, 1 - share)
    )
    word: Word = "determined" if at_low and at_high else "bounded below" if at_low else "not identified"
    ends = np.quantile(posterior, ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    if at_high and not at_low:
        word, ends = "bounded above", np.array([prior.min(), np.quantile(posterior, LEVEL)])
    elif word == "bounded below":
        ends = np.array([np.quantile(posterior, 1 - LEVEL), prior.max()])
    return Verdict(name, unit, word, float(ends[0]), float(ends[1]), float(np.median(posterior)), profile)


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
    low, high = np.quantile(made, ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    tighter = min(spread[one] for one in members) / max(_spread(made), 1e-12)
    return Combination(name, members, float(low), float(high), tighter)


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
    squares = []
    for at in grid:
        near = np.argsort(np.abs(z[:, place] - at))[: len(z) // _PROFILE]
        starts = z[near[np.argsort(found[near])[-2:]]]
        starts[:, place] = at
        squares.append(min(problem.improved(start, others)[0] for start in starts))
    return prior.at(grid), np.array(squares) - min(squares)


def interval_of(values: Floats, deviance: Floats) -> tuple[float, float]:
    """Where a profile is below its 95 % level; infinite on a side on which it stays so."""
    limit, best = float(chi2.ppf(LEVEL, 1)), int(np.argmin(deviance))
    ends = []
    for side, none in ((slice(best, None, -1), -np.inf), (slice(best, None), np.inf)):
        rising = np.maximum.accumulate(deviance[side])
        ends.append(float(np.interp(limit, rising, values[side])) if rising[-1] > limit else none)
    return ends[0], ends[1]


def only_together(
    verdicts: dict[str, Verdict], combinations: Sequence[Combination], priors: Mapping[str, Prior]
) -> dict[str, Verdict]:
    """Take back what is known of a parameter only by the range, of a decade or more, of another's prior."""
    made = dict(verdicts)
    wide = {name for name, one in priors.items() if one.kind == "log_uniform" and one.second > 10 * one.first}
    for one in combinations:
        unknown = (name for name in one.members if verdicts[name].verdict == "not identified")
        if "+" not in one.name and wide.intersection(unknown):
            made |= {name: replace(verdicts[name], verdict="not identified") for name in one.members}
    return made


def candidates_of(problem: Problem, z: Floats, undetermined: Sequence[str]) -> tuple[Candidate, ...]:
    """Weigh experiments: by how much each would narrow what is not determined, if errors are as now.

    The variance that is left of a parameter is that about its best linear estimate from the logarithms of the
    data, over the posterior (M. Goldstein, D. Wooff, Bayes Linear Statistics, Wiley 2007).
    """
    time, model, values = problem.time[problem.time > 0], problem.model, problem.values(z)
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
            loads = np.log(values["load"])[:, None]
            planned["two known loads, with areas in m²"] = np.hstack([areas, areas + np.log(2), loads])
    made = []
    for name, curves in planned.items():
        fine = np.isfinite(curves).all(1)
        if np.count_nonzero(fine) > 2 * curves.shape[1]:
            logarithmic = {one: model.priors[one].kind.startswith("log") for one in undetermined}
            known = {one: np.log(values[one]) if log else values[one] for one, log in logarithmic.items()}
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
