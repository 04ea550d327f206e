"""Comparison of models: their fits, their predictions of the last points, and their extrapolations."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity.base import views
from asperity.base.checks import Floats
from asperity.base.words import counted
from asperity.errors import ConvergenceError, InputError
from asperity.fits.comparison import UNLIKELY, lack_of, price_of
from asperity.fits.result import rms
from asperity.inference.models import CREEP, MOST_BRANCHES, Model
from asperity.inference.sampling import Problem, sample

ACCEPTED = -2 * math.log(UNLIKELY)
"""AICc over the least, below which a model is acceptable: it is at least 0.05 times as likely as the best."""

_STARTS, _TRIED = 3, 2000
_HELD, _OF = 3, 5
"""Least number of last points that are held out; all points over the held-out ones."""

LEAST_ERROR = 1e-9
"""Least relative error of data: that of rounding."""

_FACTORS = 10, 100, 1000
"""Times over the last one at which models are compared."""

_APART = 3.0
"""Difference, in standard errors, that distinguishes two models."""


@dataclass(frozen=True, eq=False, repr=False)
class Rival(views.Brief):
    """A model in a comparison.

    Attributes
    ----------
    name, times
        Its name, and the number of its relaxation times, 0 for another creep.
    aicc, missed
        AICc less the least of all models. Rms misfit, in standard errors, of the last fifth of the points,
        three at least, by a fit to the others; NaN if these are too few.
    problem, at, misfit
        Data and model; coordinates of the best fit; its misfit in standard errors, shape (n,).
    z
        Draws of the posterior, shape (draws, parameters); None for a model that is not acceptable.
    """

    name: str
    aicc: float
    missed: float
    problem: Problem
    at: Floats
    misfit: Floats
    times: int = 0
    z: Floats | None = None

    @classmethod
    def fitted(cls, name: str, times: int, problem: Problem, *, informed: bool) -> Rival | None:
        """Fit a model to data with errors (the values unless ``informed``); None for too few points."""
        n, needed = problem.time.size, problem.rank + (not informed)  # the scatter is a parameter
        if n < needed:
            return None
        at, misfit = best_fit(problem, informed=informed)
        score, missed = math.inf, math.nan
        if n > needed + 1:
            lack = lack_of(misfit, weighted=informed, rounding=LEAST_ERROR)
            score = n * lack + price_of(n, needed)
        kept = n - max(_HELD, n // _OF)
        if kept > needed:
            early = {column: getattr(problem, column)[:kept] for column in ("time", "value", "error")}
            place, _ = best_fit(replace(problem, **early), informed=informed)
            missed = rms(problem.misfit(place[np.newaxis])[0, kept:])
        return cls(name, score, missed, problem, at, misfit, times)

    def sampled(self, seed: int) -> Rival:
        """The model with draws of its posterior, or without if ensembles do not agree."""
        how: Any = {"walkers": 200, "effective": 200, "agreement": 1.05, "steps": 20, "draws": 250}
        try:
            return replace(self, z=sample(self.problem, seed=seed, **how).flat)
        except ConvergenceError:
            return self

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


def best_fit(problem: Problem, *, informed: bool = True) -> tuple[Floats, Floats]:
    """Coordinates of the least squares, and the misfit; searches start from the best draws of the prior."""
    z = problem.of_prior(np.random.default_rng(0), _TRIED)
    best = z[np.argsort(problem.log_likelihood(z))[: -_STARTS - 1 : -1]]
    improved = [problem.improved(start, problem.used, informed=informed) for start in best]
    _, at = min(improved, key=lambda minimum: minimum[0])
    return at, problem.misfit(at[np.newaxis])[0]


def side_by_side(
    chosen: object,
    branches: Sequence[int],
    model_of: Callable[..., Model],
    data: Mapping[str, Floats],
    *,
    informed: bool,
) -> list[Rival]:
    """Fit the chosen model, which comes first, and all models of creep unless it is a user's function.

    `model_of` makes a model of its name, a number of branches, and whether it is the chosen one. AICc chooses
    one of several numbers. `InputError` if the points are too few for the chosen model.
    """
    family = "relaxation" if chosen == "ball" else chosen
    plans = [(family, n) for n in branches]
    if not callable(chosen):
        plans += [("relaxation", n) for n in range(1, MOST_BRANCHES + 1)] + [(name, 1) for name in CREEP[1:]]
    tried: dict[tuple[object, int], Rival] = {}
    for name, n in dict.fromkeys(plans):
        if chosen == "healing" and name == "logarithm":
            continue  # the same curve
        model = model_of(chosen if name == family else name, branches=n, chosen=name == family)
        problem = Problem(**data, model=model)
        if not problem.used:
            raise InputError("model", expected="a curve that depends on its parameters", got=model.name)
        words, times = (counted(n, "relaxation time"), n) if name == "relaxation" else (model.name, 0)
        if (rival := Rival.fitted(words, times, problem, informed=informed)) is not None:
            tried[name, n] = rival
        elif name == family and n == branches[0]:
            scatter = " and the scatter" * (not informed)
            expected = (
                f"at least {problem.rank + (not informed)} points, for {problem.rank} parameters{scatter}"
            )
            advice = "more points, or fewer parameters"
            raise InputError("time", expected=expected, got=problem.time.size, advice=advice)
    family_members = [(family, n) for n in branches if (family, n) in tried]
    first = min(family_members, key=lambda key: tried[key].aicc)
    least = min(rival.aicc for rival in tried.values())
    every = [tried.pop(first), *tried.values()]
    return [replace(rival, aicc=rival.aicc - least if rival.aicc < math.inf else math.inf) for rival in every]


def with_draws(rivals: Sequence[Rival], problem: Problem, z: Floats, seed: int) -> list[Rival]:
    """The rivals with the errors of the problem; the first with draws z, acceptable ones with draws.

    Acceptable models fit nearly as well as the best, or predict the held-out points best. Of several numbers
    of relaxation times only that with the least AICc is acceptable.
    """
    scale = rivals[0].problem.error / problem.error
    best = min((rival.aicc for rival in rivals if rival.times), default=0.0)
    least_missed = min((rival.missed for rival in rivals if math.isfinite(rival.missed)), default=-math.inf)
    drawn = []
    for n, rival in enumerate(rivals):
        near = rival.aicc < ACCEPTED or rival.missed == least_missed
        counts = n > 0 and near and (not rival.times or rival.aicc == best)
        changed = replace(rival, misfit=rival.misfit * scale, missed=rival.missed * float(np.median(scale)))
        if n == 0:
            drawn.append(replace(changed, problem=problem, z=z))
        else:
            changed = replace(changed, problem=replace(rival.problem, error=problem.error))
            drawn.append(changed.sampled(seed) if counts else changed)
    return drawn


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
    elif len(rivals) > 1 and math.isfinite(first.aicc):
        near = min(rivals[1:], key=lambda rival: rival.aicc)
        sentences.append(
            f"No other model that was tried is acceptable; the next is {near.name}, AICc {near.aicc:+.3g}"
        )
    return sentences
