"""From models and data to an inference: fits, errors, profiles, draws and verdicts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from asperity.base.checks import Floats
from asperity.errors import ConvergenceError, InputError
from asperity.fits.result import rms, student
from asperity.inference.found import Inference
from asperity.inference.leastsquares import best_fit, drawn, least, profiles
from asperity.inference.models import MOST_BRANCHES
from asperity.inference.priors import Given
from asperity.inference.problem import Problem
from asperity.inference.rivals import ACCEPTED, CORRELATED, LEAST_ERROR, Rival, side_by_side, with_draws
from asperity.inference.sampling import ENSEMBLES, Draws, sample
from asperity.inference.verdicts import Posterior
from asperity.progress import Progress

_MUCH_BETTER = 50.0
"""Gain in chi-squared above which priors are refused."""

_FALLS = 2.0
"""Least fall of AICc at the most branches for which more are likely."""

_NOTHING = 1e-300
"""Least value over which an error is relative."""

_DRAWS, _FEW = 512, 50
"""Draws along profiles, and number that they are worth below which it is remarked."""


def conclude(
    family: Sequence[Problem],
    others: Sequence[Problem] = (),
    *,
    priors: Mapping[str, Given] | None = None,
    sampling: Mapping[str, Any] | None = None,
    seed: int = 0,
    quantity: str = "area",
    unit: str = "",
    listening: Progress | None = None,
) -> Inference:
    """Judge the parameters of a model that data determine, by least squares or from samples.

    Parameters
    ----------
    family
        Models to choose from by AICc, such as those of one to three relaxation times, all of the same data.
        What a model must give is said in `asperity.inference.problem`. With ``Problem(..., informed=False)``
        its errors are the shape of the noise, whose size and correlation are measured about the best fit.
    others
        Models for comparison.
    priors
        Those of the user by parameter of the chosen model; fits and comparisons have the default ones.
    sampling
        To sample the posterior: ``walkers`` and other arguments of `asperity.inference.sampling.sample`; by
        default profiles and curvature of least squares.
    seed
        Seed of the random numbers.
    quantity, unit
        The measured quantity, and its unit.
    listening
        Hears of the stages.

    Raises
    ------
    InputError, ConvergenceError
        The points are too few; the priors exclude the data; the ensembles do not agree.
    """
    say = (listening or Progress()).stage
    say("fitting models side by side")
    rivals = side_by_side(family, others)
    first, remarks = _judged(rivals, priors)
    say("following the profile of each parameter")
    best, followed = profiles(first.problem, first.at)
    if sampling is None:
        z, worth = drawn(first.problem, followed, _DRAWS, seed)
        draws = Draws(z[np.newaxis], math.nan, worth)
    else:
        count = f"{ENSEMBLES * sampling['walkers']:,} walkers"
        say(f"sampling {len(followed)} parameters of {first.problem.model.name}, {count}")
        draws = sample(first.problem, seed=seed, report=say, **sampling)
    first = replace(first, at=best, z=draws.flat)

    def drawn_of(problem: Problem, at: Floats) -> Floats | None:
        if sampling is None:
            return drawn(problem, profiles(problem, at)[1], _DRAWS, seed)[0]
        how: Any = {"walkers": 200, "effective": 200, "agreement": 1.05, "steps": 20, "draws": 250}
        try:
            return sample(problem, seed=seed, **how).flat
        except ConvergenceError:
            return None

    if draws.effective < _FEW:
        words = f"bands and combinations are rough: their draws are worth {draws.effective:.0f}"
        remarks.append(f"{words}; sampling the posterior (sample) is exact")
    rivals = with_draws(rivals, first, drawn_of)
    say("judging each parameter")
    problem = first.problem
    posterior = Posterior(problem, draws.flat, best, followed, sampling is not None)
    verdicts = posterior.verdicts()
    undetermined = [name for name, verdict in verdicts.items() if verdict.verdict != "determined"]
    return Inference(
        problem.time,
        problem.value,
        problem.error,
        problem.model,
        verdicts,
        posterior.combinations(),
        posterior.candidates(undetermined) if undetermined else (),
        posterior.profiles,
        draws,
        float((problem.misfit(best[np.newaxis]) ** 2).sum()),
        tuple(rivals),
        tuple(remarks),
        quantity,
        unit,
    )


def _judged(rivals: list[Rival], priors: Mapping[str, Given] | None) -> tuple[Rival, list[str]]:
    """The chosen model, with errors and with the priors of the user, if there are any; remarks."""
    first, remarks = rivals[0], list[str]()
    problem, at, n = first.problem, first.at, first.misfit.size
    error = problem.error
    best = min(rivals, key=lambda rival: rival.aicc)
    fewer = [rival for rival in rivals if rival.times == first.times - 1]
    if first.times == MOST_BRANCHES and fewer and first.aicc < fewer[0].aicc - _FALLS:
        remarks.append(
            f"AICc still falls at {first.times} relaxation times: there may be more, or a broad spectrum"
        )
    if first.aicc - best.aicc > ACCEPTED:
        advice = f"try the model {'relaxation' if best.times else best.name}"
        if problem.model.name == "ball":
            advice = "what lies beyond the data is open"
        remarks.append(f"{best.name} fits better, by {first.aicc - best.aicc:.3g} in AICc: {advice}")
    if not math.isfinite(first.missed):
        remarks.append(f"of {n} points three cannot be held out: no model was tested by prediction")
    if not math.isfinite(best.aicc):
        remarks.append(f"{n} points are too few for AICc: nothing chooses between the models")
    if not problem.informed:
        scatter, rho = first.scatter
        # For few points Student's t widens the intervals.
        scatter *= student(max(n - problem.rank, 1)) / student(math.inf)
        counted = max(1.0, n * min(1.0, (1 - rho) / (1 + rho)))
        # If the model misses, its errors are those of means.
        wide, rho_left = (math.sqrt((1 + rho) / (1 - rho)), 0.0) if rho > CORRELATED else (1.0, rho)
        error = max(scatter, LEAST_ERROR) * problem.error
        size = 100 * np.median(error / np.maximum(np.abs(problem.value), _NOTHING))
        remarks.append(
            f"no errors were given: they are taken as {size:.2g} % of the values, by the median, from the "
            f"scatter about the best fit, whose neighbors correlate by {rho:.2f}; so {n} points count as "
            f"{counted:.0f}"
        )
        problem = replace(problem, error=wide * error, rho=rho_left, counted=counted, informed=True)
    before, at = best_fit(problem, at[np.newaxis])
    if priors:
        stated = problem.model.with_priors(priors)
        problem = replace(problem, model=stated)
        after, at = best_fit(problem)
        misfit = problem.misfit(at[np.newaxis])[0]
        if after - before > _MUCH_BETTER:
            got = f"a best fit that misses by {rms(misfit):.3g} standard errors, rms"
            name, prior = [*stated.priors.items()][_tight(problem, at)]
            default = rms(first.misfit) * float(first.problem.error[0] / error[0])
            advice = f"a wider one of {name} than {prior} (default ones miss by {default:.3g})"
            raise InputError("priors", expected="some that allow the data", got=got, advice=advice)
        first = replace(first, problem=replace(first.problem, model=stated), at=at, misfit=misfit)
    if first.misses:
        how = f"by {rms(first.misfit):.3g} standard errors, rms" * first.problem.informed
        others = ", and so does every model that was tried" * best.misses
        how = how or "by more than a scatter"
        remarks.append(f"the model misses the data {how}{others}: the verdicts hold for this model only")
    return replace(first, problem=problem, at=at), remarks


def _tight(problem: Problem, at: Floats) -> int:
    """Place of the prior that misfits most: a wider one allows the best fit."""
    each = np.eye(at.size, dtype=bool)
    return int(np.argmin(least(problem, np.tile(at, (at.size, 1)), beyond=each)[0]))
