"""From a measured curve to what it determines: the posterior of a model, and a verdict on each parameter."""

from __future__ import annotations

import functools
import math
import pickle
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.stats import chi2

from asperity.base import checks, units, views
from asperity.base.checks import Floats
from asperity.base.files import expanded
from asperity.base.words import counted
from asperity.errors import LARGEST, InputError
from asperity.fits.comparison import lack_of, price_of
from asperity.fits.curve import Series, refuse_decline
from asperity.fits.result import rms, student
from asperity.friction import Record, hold_peaks
from asperity.inference.models import MOST_BRANCHES, Model, of_name
from asperity.inference.priors import Given
from asperity.inference.sampling import Draws, Problem, libraries, sample
from asperity.inference.verdicts import WORDS, Candidate, Combination, Posterior, Verdict, told_apart
from asperity.progress import Progress, listener

if TYPE_CHECKING:
    import arviz as az

_STARTS, _TRIED = 3, 2000
_MISFIT, _MUCH_BETTER = 1e-3, 50.0
"""Chance of a misfit below which the model is doubted; gain in chi-squared that shows the priors at fault."""

_MOST_POINTS = 1000
"""Points of a curve that are used, for each of which thousands of walkers have a number."""

_FALLS = 2.0
"""Fall of AICc at the most branches tried from which on there may be more."""

_LEAST_ERROR = 1e-9
"""Relative errors that data have at least: those of rounding."""

_TELLS = 0.5
"""Expected width over the present one below which an experiment is said to tell of a parameter."""

_NUMBERED = re.compile(f"(share|time)_[1-{MOST_BRANCHES}]")
"""Parameters that say how many branches there are at least."""

_OF_SOLID = 100
"""Draws of a solid that are written for the band of a prediction."""


@dataclass(frozen=True, eq=False, repr=False)
class Inference(views.Brief):
    """What a curve determines.

    Attributes
    ----------
    time, value, error
        The data, and their standard errors as taken, shape (n,).
    model
        The model with its priors.
    verdicts
        A `Verdict` for each parameter, by name.
    combinations
        Products, ratios and sums that are known better than their members, the best first.
    candidates
        Experiments that could be done next, and how far they would narrow what is not determined.
    profiles
        Of each parameter that the curve contains: values, and -2 ln of the profile likelihood over its peak.
    draws
        Draws of the posterior; R-hat and the effective number of draws.
    chi_squared
        Of the best draw.
    remarks
        What was decided, and what the reader should know.
    """

    time: Floats
    value: Floats
    error: Floats
    model: Model
    verdicts: Mapping[str, Verdict]
    combinations: tuple[Combination, ...]
    candidates: tuple[Candidate, ...]
    profiles: Mapping[str, tuple[Floats, Floats]]
    draws: Draws
    chi_squared: float
    remarks: tuple[str, ...] = ()

    @property
    def problem(self) -> Problem:
        """Data and model."""
        return Problem(self.time, self.value, self.error, self.model)

    @functools.cached_property
    def values(self) -> dict[str, Floats]:
        """Draws of each parameter, shape (ensembles, draws)."""
        flat = self.problem.values(self.draws.flat)
        return {name: column.reshape(self.draws.z.shape[:-1]) for name, column in flat.items()}

    @property
    def table(self) -> pd.DataFrame:
        """The verdicts, a row for each parameter."""
        rows = [
            (one.parameter, one.verdict, one.low, one.high, one.median, one.unit, *one.profile)
            for one in self.verdicts.values()
        ]
        names = ["parameter", "verdict", "low", "high", "median", "unit", "profile_low", "profile_high"]
        return pd.DataFrame(rows, columns=names)

    @property
    def findings(self) -> list[tuple[str, str]]:
        """What is determined, bounded, or not identified: verdicts with their parameters, in words."""
        said: dict[str, list[str]] = {word: [] for word in WORDS}
        for name, one in self.verdicts.items():
            known = " (as its prior)" * (not self.model.priors[name].bounded)
            said[one.verdict].append(one.words if one.verdict != "not identified" else f"{name}{known}")
        return [(word, ", ".join(names)) for word, names in said.items() if names]

    @property
    def sentences(self) -> tuple[str, ...]:
        """The findings, what is known together, and what would tell more."""
        said = [f"{word[:1].upper()}{word[1:]}: {of}" for word, of in self.findings]
        for one in self.combinations:
            low, high = told_apart(one.low, one.high)
            said.append(
                f"{one.name} lies between {low} and {high}, {one.tighter:.2g} times better known than any of "
                "these alone"
            )
        useless = []
        for experiment in self.candidates:
            told = {name: width for name, width in experiment.widths.items() if width < _TELLS}
            of = ", ".join(f"{name} to {100 * width:.2g} %" for name, width in told.items())
            if told:
                said.append(f"Measuring {experiment.name} would narrow {of} of its present width, or further")
            else:
                useless.append(experiment.name)
        if useless:
            said.append(f"Little is promised by measuring {', or '.join(useless)}")
        return tuple(said)

    def predicted(self, time: ArrayLike) -> Floats:
        """The curve at any times: 2.5, 50 and 97.5 % quantiles of the posterior, shape (3, n)."""
        at = checks.not_negative("time", time)
        curves = self.model.curve(at, self.problem.values(self.draws.flat))
        return np.asarray(np.quantile(curves, (0.025, 0.5, 0.975), axis=0))

    def solid(self) -> dict[str, object]:
        """Section ``[solid]`` of a configuration, of the likeliest draw, and other draws of its branches.

        `InputError` for a model of which no solid follows.
        """
        if self.model.solid is None:
            raise InputError("solid", expected="a model of a solid", got=f"model {self.model.name!r}")
        problem, z = self.problem, self.draws.flat
        values = problem.values(z)
        best = int(np.argmax(problem.posterior(z[:, problem.used])))
        chosen = np.linspace(0, len(z) - 1, _OF_SOLID).astype(int)
        medians = {name: one.median for name, one in self.verdicts.items()}
        made, *others = (
            self.model.solid(medians | {name: float(values[name][place]) for name in self.profiles})
            for place in (best, *chosen)
        )
        return made | {"draws": [one["branches"] for one in others]} if "branches" in made else made

    def to_inference_data(self) -> az.InferenceData:
        """Posterior, prior and data as InferenceData of ArviZ."""
        problem, shape = self.problem, self.draws.z.shape
        prior = problem.values(problem.of_prior(np.random.default_rng(0), shape[0] * shape[1]))
        made: az.InferenceData = libraries()[1].from_dict(
            posterior=self.values,
            prior={name: column.reshape(shape[:-1]) for name, column in prior.items()},
            observed_data={"value": self.value, "error": self.error},
            constant_data={"time": self.time},
        )
        return made


def infer(
    time: ArrayLike | Record,
    area: ArrayLike | None = None,
    error: ArrayLike | None = None,
    *,
    model: str | Callable[..., ArrayLike] = "relaxation",
    priors: Mapping[str, Given] | None = None,
    branches: int | None = None,
    absolute: bool = False,
    ramp: float | str = 0.0,
    seed: int = 0,
    rng: int | np.random.Generator | None = None,
    walkers: int = 1000,
    effective: int = 1000,
    workers: int = 1,
    progress: Progress | bool | None = None,
    checkpoint: str | Path | None = None,
) -> Inference:
    """Infer the parameters of a model from a curve of area or friction, and say which of them it determines.

    Parameters
    ----------
    time
        Times that do not fall, s, shape (n,); or a record of sliding with holds, for the model
        ``"healing"``.
    area
        Areas, or static friction, above 0, shape (n,): in any unit, such as A(t)/A(0), unless they are
        `absolute`.
    error
        Standard errors, one or shape (n,). By default they are found from the scatter about the best fit,
        widened by as much as neighbors may correlate, see `Problem.scatter`.
    model
        ``"relaxation"``, ``"power"``, ``"lattice"``, ``"eyring"`` or ``"healing"``, see
        `asperity.inference.models`; or a function of the times, and of parameters by name.
    priors
        Of any parameters: a pair of ends, between which ln is uniform, a table such as ``{"kind": "normal",
        "mean": "100 N", "deviation": "1 N"}``, or a `Prior`. Others are broad; `Inference.model` has all.
    branches
        How many relaxation times, 1 to 3; by default as many as Akaike's criterion asks for.
    absolute
        Areas are in m^2 (of a lattice, over the nominal one): then load, modulus and roughness count.
    ramp
        Time, s, within which the load was put on in proportion to time; times count from its beginning.
    seed, rng
        Seed of the random numbers; or a numpy generator, which draws one, or its seed.
    walkers
        In each of four ensembles.
    effective
        Effective draws that are enough.
    workers
        Processes that share the ensembles.
    progress
        True for a line for each stage; or who is told.
    checkpoint
        File in which the ensembles are kept after each stage; the same call goes on from it.

    Returns
    -------
    Inference

    Raises
    ------
    AsperityError
        Something given is wrong; the priors exclude the data; the ensembles do not agree.
    """
    libraries()
    if isinstance(time, Record):
        if model != "healing":
            raise InputError("model", expected="'healing' for a record of sliding", got=checks.shown(model))
        peaks = hold_peaks(time)
        order = np.argsort(peaks.duration)
        time, area = peaks.duration[order], peaks.peak[order]
    loading = float(units.number("ramp", ramp, "s", least=0))
    t, v, errors = _checked(time, area, error, "friction" if model == "healing" else "area")
    many, chosen = t.size, _chosen(t)
    t, v, errors = t[chosen], v[chosen], None if errors is None else errors[chosen]
    if t[0] < loading:
        raise InputError("time", expected=f"times after the ramp, from {loading:g} s on", got=float(t[0]))
    seed = checks.seed(seed, rng)
    checks.integer("walkers", walkers, least=50)
    checks.integer("effective", effective, least=1)
    if branches is not None:
        checks.integer("branches", branches, least=1, most=MOST_BRANCHES)
        if model != "relaxation":
            raise InputError("branches", expected="model 'relaxation' beside it", got=checks.shown(model))
    if callable(model) and workers > 1:
        try:
            pickle.dumps(model)
        except (pickle.PicklingError, AttributeError, TypeError):
            expected = "a function of a module, which other processes can import"
            got = checks.shown(model)
            raise InputError("model", expected=expected, got=got, advice="workers=1") from None
    own = checks.instance("priors", {} if priors is None else priors, dict, "{'time_1': (1, 1e6)}")
    made = functools.partial(of_name, model, t, v, absolute=absolute, ramp=loading)
    least = max([branches or 1, *(int(key[-1]) for key in own if _NUMBERED.fullmatch(key))])
    made(branches=least, priors=own)  # mistakes in priors first
    most = MOST_BRANCHES if branches is None and model == "relaxation" else least
    with listener(progress) as listening:
        listening.stage("looking for the best fit")
        problem, remarks = _problem(t, v, errors, made, own, range(least, most + 1))
        if t.size < many:
            said = f"took {t.size:,} of {many:,} points, at even distances in ln t"
            remarks.append(f"{said}: means of the others over short times would narrow the intervals")
        listening.stage(f"sampling {len(problem.used)} parameters, {4 * walkers:,} walkers")
        draws = sample(
            problem,
            seed=seed,
            walkers=walkers,
            effective=effective,
            workers=workers,
            checkpoint=None if checkpoint is None else expanded(checkpoint),
            told=listening.stage,
        )
        listening.stage("judging each parameter")
        prior = problem.values(problem.of_prior(np.random.default_rng([seed, 1]), 20_000))
        posterior = Posterior(problem, draws.flat, prior)
        verdicts = posterior.verdicts()
        undetermined = [name for name, one in verdicts.items() if one.verdict != "determined"]
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
            -2 * float(posterior.log_likelihood.max()),
            tuple(remarks),
        )


def _chosen(t: Floats) -> NDArray[np.intp]:
    """Places of the points that are used: all, or of very many some at even distances in ln t."""
    if t.size <= _MOST_POINTS:
        return np.arange(t.size)
    begin = int(np.searchsorted(t, 0.0, side="right"))
    places = np.searchsorted(t, np.geomspace(t[begin], t[-1], _MOST_POINTS))
    return np.unique([*range(min(begin, 1)), *np.minimum(places, t.size - 1)])


def _checked(
    time: ArrayLike, area: ArrayLike | None, error: ArrayLike | None, name: str
) -> tuple[Floats, Floats, Floats | None]:
    """Times, values and errors, shape (n,)."""
    t = checks.not_negative("time", checks.line("time", time))
    v = checks.positive(name, checks.line(name, area))
    if v.shape != t.shape:
        raise InputError(name, expected=f"one for each of {t.size} times", got=f"{v.size} values")
    if t.size < 2 or not t.any():
        raise InputError("time", expected="two times or more, above 0", got=checks.shown(t.tolist()))
    if (falls := np.diff(t) < 0).any():
        at = int(np.argmax(falls))
        got = f"{t[at]:g} before {t[at + 1]:g}"
        advice = "order = np.argsort(time)"
        raise InputError("time", expected="times that do not fall", got=got, advice=advice)
    if t[-1] > LARGEST:
        raise InputError("time", expected=f"times up to {LARGEST:g} s", got=float(t[-1]))
    if error is None:
        return t, v, None
    given = checks.positive("error", error)
    if given.shape not in ((), t.shape):
        raise InputError("error", expected=f"one, or one for each of {t.size} values", got=f"{given.size}")
    return t, v, np.broadcast_to(given, t.shape).copy()


def _problem(
    t: Floats,
    v: Floats,
    error: Floats | None,
    made: functools.partial[Model],
    priors: dict[str, Given],
    counts: range,
) -> tuple[Problem, list[str]]:
    """The data with errors, and the model, with so many branches as the data ask for.

    Both are judged by the default priors, so that what the user knows of parameters makes no errors.
    """
    remarks: list[str] = []
    own, scatters = callable(made.args[0]), error is None
    tried: list[tuple[float, int, Problem, Floats, Floats]] = []
    for count in counts:
        usual = made(branches=count, priors=priors if own else None)
        if not own:
            refuse_decline(Series(t, v, None), "friction" if usual.name == "healing" else "area")
        problem = Problem(t, v, v if error is None else error, usual)
        if not problem.used:
            raise InputError("model", expected="a curve that depends on its parameters", got=usual.name)
        needed = problem.rank + scatters  # the scatter is a parameter
        if t.size < needed and tried:
            break
        if t.size < needed:
            expected = (
                f"at least {needed} points, for {problem.rank} parameters{' and the scatter' * scatters}"
            )
            raise InputError("time", expected=expected, got=t.size, advice="more points, or fewer parameters")
        at, misfit = _best(problem, informed=not scatters)
        score = math.inf
        if t.size > needed + 1:
            lack = lack_of(misfit, given=not scatters, rounding=_LEAST_ERROR)
            score = t.size * lack + price_of(t.size, needed)
        tried.append((score, count, problem, at, misfit))
    score, count, problem, at, misfit = min(tried, key=lambda one: one[0])
    if len(tried) > 1:
        others = ", ".join(f"{one[0] - score:+.3g} with {one[1]}" for one in tried if one[1] != count)
        remarks.append(f"{counted(count, 'relaxation time')} by Akaike's criterion, AICc ({others})")
        if count == tried[-1][1] and score < tried[-2][0] - _FALLS:
            remarks.append(
                f"{count} relaxation times are the most that were tried, and AICc still falls: there may be "
                "more, or a broad spectrum (try the model power); the verdicts hold for this model only"
            )
    free = max(t.size - problem.rank, 1)
    if scatters:
        scatter, rho = problem.scatter(at)
        # Few points know it badly: by Student's t intervals are as wide as if it were known.
        scatter *= student(free) / student(math.inf)
        problem = replace(problem, error=max(scatter, _LEAST_ERROR) * v)
        misfit = misfit * v / problem.error
        found = f"{100 * scatter:.2g} % of each value, from the scatter about the best fit"
        found += f", whose neighbors correlate by {rho:.2f}"
        remarks.append(f"no errors were given: they are taken as {found}")
    if priors and not own:
        before, problem = misfit, replace(problem, model=made(branches=count, priors=priors))
        at, misfit = _best(problem)
        if problem.improved(at, ())[0] - before @ before > _MUCH_BETTER:
            got = f"a best fit that misses by {rms(misfit):.3g} standard errors, rms"
            advice = f"wider ones (by the default ones it misses by {rms(before):.3g})"
            raise InputError("priors", expected="some that allow the data", got=got, advice=advice)
    chance = float(chi2.sf(misfit @ misfit, free))
    if not scatters and chance < _MISFIT:
        remarks.append(
            f"the model misses the data by {rms(misfit):.3g} standard errors, rms (chance {chance:.1g}): "
            "try another model, or larger errors; the verdicts hold for this model only"
        )
    return problem, remarks


def _best(problem: Problem, *, informed: bool = True) -> tuple[Floats, Floats]:
    """Coordinates of least squares, and the misfit, by searches from the best of draws of the prior."""
    z = problem.of_prior(np.random.default_rng(0), _TRIED)
    best = z[np.argsort(problem.log_likelihood(z))[: -_STARTS - 1 : -1]]
    found = [problem.improved(start, problem.used, informed=informed) for start in best]
    _, at = min(found, key=lambda one: one[0])
    return at, problem.misfit(at[np.newaxis])[0]
