"""The posterior of a model given a measured curve, and a verdict on each parameter."""

from __future__ import annotations

import functools
import math
import pickle
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.stats import chi2

from asperity.base import checks, units, views
from asperity.base.calls import remark
from asperity.base.checks import Floats
from asperity.base.rows import Row, table_rows
from asperity.base.words import counted, to_digits
from asperity.errors import LARGEST, InputError
from asperity.fits.comparison import neighbors
from asperity.fits.curve import Series, refuse_decline
from asperity.fits.result import rms, student
from asperity.friction import Record, hold_peaks
from asperity.inference.models import MOST_BRANCHES, OF_BALL, Model, of_name
from asperity.inference.priors import Given
from asperity.inference.rivals import (
    ACCEPTED,
    LEAST_ERROR,
    Rival,
    best_fit,
    parting,
    side_by_side,
    with_draws,
)
from asperity.inference.sampling import Draws, Problem, libraries, sample
from asperity.inference.verdicts import WORDS, Candidate, Combination, Posterior, Verdict, distinguishable
from asperity.progress import Progress, listener
from asperity.results import Checkpoint

_MISFIT, _MUCH_BETTER = 1e-3, 50.0
"""Probability of a misfit below which it is remarked; gain in chi-squared above which priors are refused."""

_MOST_POINTS = 1000
"""Largest number of points, which thousands of walkers predict."""

_FALLS = 2.0
"""Least fall of AICc at the most branches for which more are likely."""

_CORRELATED = 0.7
"""Largest correlation of neighboring misfits that is scatter."""

_TELLS = 0.5
"""Largest expected width, over the present one, for which an experiment is recommended."""

_NUMBERED = re.compile(f"(share|time)_[1-{MOST_BRANCHES}]")
"""Parameters whose number is the least number of branches."""

_OF_SOLIDS = ("modulus", "k0", "x1", "rate", "stress")
"""Parameters of solids that a section has only if they are identified."""

_FAR = 10.0
"""Times of the last measured time up to which the report compares models and figures show the band."""

_OF_SOLID = 100
"""Number of draws of a solid for the band of a prediction."""


@dataclass(frozen=True, eq=False, repr=False)
class Inference(views.Brief, views.Pictured):
    """Posterior of a model, with a verdict on each parameter.

    Attributes
    ----------
    time, value, error
        The data in order of time, and their standard errors, shape (n,).
    verdicts, combinations, candidates
        A `Verdict` by parameter; each `Combination`, the best first; a `Candidate` for each experiment.
    profiles
        For each parameter of the curve, values, and -2 ln of the profile likelihood over its peak.
    draws, chi_squared
        Draws of the posterior, and chi-squared of the best.
    rivals
        The model, and models of creep for comparison, see `Rival`.
    remarks
        Decisions and warnings.
    quantity, unit
        The measured quantity, and its unit, "" if unknown.
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
    rivals: tuple[Rival, ...]
    remarks: tuple[str, ...] = ()
    quantity: str = "area"
    unit: str = ""

    def rows(self) -> list[Row]:
        """Rows of a summary: the data, the models, the findings, and the agreement of the samples."""
        rows = [Row("data", counted(self.time.size, "point")), Row("model", self.model.name)]
        compared = self.models.itertuples(index=False)
        cells = [[str(name), *(to_digits(value, 3) for value in values)] for name, *values in compared]
        rows += table_rows("models", [[*self.models.columns], *cells])
        findings = {f"{word[:1].upper()}{word[1:]}: {of}" for word, of in self.findings}
        rows += [Row("", sentence) for sentence in self.sentences if sentence not in findings]
        rows += [Row(*finding) for finding in self.findings]
        samples = f"R-hat {self.draws.r_hat:.4f}, {self.draws.effective:.0f} effective samples"
        return [*rows, Row("agreement", samples)]

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
        names = ["parameter", "verdict", "low", "high", "median", "unit"]
        rows = [
            (*(getattr(verdict, name) for name in names), *verdict.profile)
            for verdict in self.verdicts.values()
        ]
        return pd.DataFrame(rows, columns=[*names, "profile_low", "profile_high"])

    @property
    def models(self) -> pd.DataFrame:
        """Models side by side: AICc less the least, misfit of held-out points, growth beyond the last one.

        NaN where the points are too few.
        """
        last = self.time[-1] * np.array([1.0, 10.0, 1000.0])
        rows = []
        for rival in self.rivals:
            now, *later = rival.band(last)[1]
            score = rival.aicc if math.isfinite(rival.aicc) else math.nan
            rows.append((rival.name, score, rival.missed, *(at / now for at in later)))
        names = ["model", "AICc", "held-out points (errors)", "at 10 x last time", "at 1000 x last time"]
        return pd.DataFrame(rows, columns=names)

    @property
    def findings(self) -> list[tuple[str, str]]:
        """Verdicts (determined, bounded, not identified) with their parameters, in words."""
        by_verdict: dict[str, list[str]] = {word: [] for word in WORDS}
        for name, verdict in self.verdicts.items():
            as_prior = " (as its prior)" * (not self.model.priors[name].bounded)
            by_verdict[verdict.verdict].append(
                verdict.words if verdict.verdict != "not identified" else f"{name}{as_prior}"
            )
        return [(word, ", ".join(names)) for word, names in by_verdict.items() if names]

    @property
    def sentences(self) -> tuple[str, ...]:
        """Range of the model, findings, combinations, and recommended experiments."""
        lines = parting(self.rivals)
        lines += [f"{word[:1].upper()}{word[1:]}: {of}" for word, of in self.findings]
        for combination in self.combinations:
            low, high = distinguishable(combination.low, combination.high)
            better = f"{combination.tighter:.2g} times better known than any of these alone"
            lines.append(f"{combination.name} lies between {low} and {high}, {better}")
        useless = []
        for experiment in self.candidates:
            narrowed = {name: width for name, width in experiment.widths.items() if width < _TELLS}
            of = ", ".join(f"{name} to {100 * width:.2g} %" for name, width in narrowed.items())
            if narrowed:
                lines.append(
                    f"Measuring {experiment.name} would narrow {of} of its present width, or further"
                )
            else:
                useless.append(experiment.name)
        if useless:
            lines.append(f"Measuring {', or '.join(useless)} would hardly help")
        return tuple(lines)

    def predicted(self, time: ArrayLike) -> Floats:
        """The curve at any times: a 95 % band over all acceptable models, and the median of the first one.

        Shape (3, n): the least 2.5 % quantile of the posteriors, the median, and the largest 97.5 % quantile.
        A remark says if times are far beyond the data: the band knows no slower process.
        """
        at = checks.not_negative("time", time)
        if (beyond := float(at.max(initial=0.0) / self.time[-1])) > 1.001 * _FAR:
            remark(
                f"{at.max():.3g} is {beyond:.3g} times the last measured time: "
                "the band covers the models that were tried, and no process slower than the data"
            )
        bands = np.array([rival.band(at) for rival in self.acceptable])
        return np.array([bands[:, 0].min(axis=0), bands[0, 1], bands[:, 2].max(axis=0)])

    @property
    def acceptable(self) -> list[Rival]:
        """The model, and others that fit nearly as well as the best, or predict held-out points best."""
        return [rival for rival in self.rivals if rival.z is not None]

    def solid(self) -> dict[str, object]:
        """Section ``[solid]`` of a configuration, of the likeliest draw, with draws of its branches.

        Draws are from all acceptable models in equal parts. `unknown` parameters are left out. `InputError`
        for a model without a solid.
        """
        if self.model.solid is None:
            raise InputError("solid", expected="a model of a solid", got=f"model {self.model.name!r}")
        problem, z = self.problem, self.draws.flat
        best = int(np.argmax(problem.posterior(z[:, problem.used])))
        identified = {name: x for name, x in problem.numbers(z[best]).items() if name not in self.unknown}
        keys = self.model.solid(identified)
        if "branches" not in keys:
            return keys
        many = -(-_OF_SOLID // len(self.acceptable))
        keys |= {"data_first": f"{self.time[self.time > 0][0]:.6g} s", "data_last": f"{self.time[-1]:.6g} s"}
        draws = [solid["branches"] for rival in self.acceptable for solid in rival.solids(many)]
        return keys | {"draws": draws}

    @property
    def unknown(self) -> list[str]:
        """Parameters of the solid that the data do not identify."""
        return [
            name for name in _OF_SOLIDS if name in self.verdicts and self.verdicts[name].verdict == WORDS[-1]
        ]

    def to_datatree(self) -> xr.DataTree:
        """Posterior, prior and data in the groups that ArviZ reads."""
        problem, shape = self.problem, self.draws.z.shape[:-1]
        prior = problem.values(problem.of_prior(np.random.default_rng(0), math.prod(shape)))
        draws = {"posterior": self.values, "prior": {name: x.reshape(shape) for name, x in prior.items()}}
        observed = {"value": self.value, "error": self.error}
        data = {"observed_data": observed, "constant_data": {"time": self.time}}
        groups = {
            name: xr.Dataset({key: (dims, x) for key, x in of.items()})
            for dims, part in ((("chain", "draw"), draws), (("point",), data))
            for name, of in part.items()
        }
        return xr.DataTree.from_dict(groups)


def infer(
    time: ArrayLike | Record,
    area: ArrayLike | None = None,
    error: ArrayLike | None = None,
    *,
    model: str | Callable[..., ArrayLike] = "relaxation",
    quantity: Literal["depth", "radius"] | None = None,
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
    checkpoint: str | Path | Checkpoint | None = None,
) -> Inference:
    """Infer the parameters of a model from a curve of area or friction, with a verdict on each.

    Parameters
    ----------
    time
        Times not below 0, s, shape (n,), in any order; or a record of sliding with holds, for the model
        ``"healing"``.
    area
        Areas, or static friction, above 0, shape (n,): in any unit, such as A(t)/A(0), unless they are
        `absolute`.
    error
        Standard errors, one or shape (n,). By default the scatter about the best fit, larger for correlated
        neighbors; see `Problem.scatter`.
    model
        ``"relaxation"``, ``"power"``, ``"logarithm"``, ``"lattice"``, ``"eyring"``, ``"healing"`` or
        ``"ball"``, see `asperity.inference.models`; or a function of the times, and of parameters by name.
    quantity
        For a ball, the measured quantity: its depth, or the radius of its contact.
    priors
        Priors by parameter: the ends of a range, uniform in ln, a table such as ``{"kind": "normal", "mean":
        "100 N", "deviation": "1 N"}``, or a `Prior`. Other parameters have broad ones; see `Inference.model`.
    branches
        Number of relaxation times, 1 to 3; by default that with the least AICc.
    absolute
        Whether areas are in m^2 (of a lattice, over the nominal one; of a ball, lengths in m). Load, modulus
        and roughness, or the radius of the ball, are parameters then.
    ramp
        Time, s, of a linear ramp of the load; times count from its beginning.
    seed, rng
        Seed of the random numbers; or a numpy generator, which draws one, or its seed.
    walkers, effective, workers
        Walkers in each of four ensembles; required effective samples; processes for the ensembles.
    progress
        True for a line for each stage; or an `asperity.progress.Progress`.
    checkpoint
        File with the ensembles after each stage, from which the same call goes on.

    Raises
    ------
    InputError, ConvergenceError
        The priors exclude the data; the ensembles do not agree.
    """
    libraries()
    loading = float(units.number("ramp", ramp, "s", least=0))
    series, measured, remarks = _data(time, area, error, model, quantity)
    t, v, errors = series.x, series.y, series.stderr
    if t[0] < loading:
        raise InputError("time", expected=f"times after the ramp, from {loading:g} s on", got=float(t[0]))
    seed = checks.seed(seed, rng)
    checks.integer("walkers", walkers, least=50)
    checks.integer("effective", effective, least=1)
    if branches is not None:
        checks.integer("branches", branches, least=1, most=MOST_BRANCHES)
        if model not in ("relaxation", "ball"):
            expected = "model 'relaxation' or 'ball' beside it"
            raise InputError("branches", expected=expected, got=checks.shown(model))
    if callable(model) and workers > 1:
        _check_importable(model)
    ranges = checks.instance("priors", {} if priors is None else priors, dict, "{'time_1': (1, 1e6)}")
    model_of = functools.partial(of_name, time=t, value=v, ramp=loading, quantity=measured)
    model_with_priors = functools.partial(model_of, model, priors=ranges, absolute=absolute)
    least = max([branches or 1, *(int(key[-1]) for key in ranges if _NUMBERED.fullmatch(key))])
    most = MOST_BRANCHES if branches is None and model in ("relaxation", "ball") else least
    model_with_priors(branches=least)  # mistakes in priors first

    def usual(name: object, branches: int, *, chosen: bool) -> Model:
        """A model with default priors, for errors and comparisons without those of the user."""
        kept = ranges if chosen and callable(model) else None
        return model_of(name, branches=branches, priors=kept, absolute=absolute and chosen)

    with listener(progress) as listening:
        listening.stage("fitting models side by side")
        data = {"time": t, "value": v, "error": v if errors is None else errors}
        rivals = side_by_side(model, range(least, most + 1), usual, data, informed=errors is not None)
        stated = (
            model_with_priors(branches=rivals[0].times or least) if ranges and not callable(model) else None
        )
        problem, judged = _judged(rivals, stated, informed=errors is not None)
        listening.stage(
            f"sampling {len(problem.used)} parameters of {rivals[0].name}, {4 * walkers:,} walkers"
        )
        draws = sample(
            problem,
            seed=seed,
            walkers=walkers,
            effective=effective,
            workers=workers,
            checkpoint=checkpoint,
            report=listening.stage,
        )
        listening.stage("sampling the other acceptable models")
        rivals = with_draws(rivals, problem, draws.flat, seed)
        listening.stage("judging each parameter")
        prior = problem.values(problem.of_prior(np.random.default_rng([seed, 1]), 20_000))
        posterior = Posterior(problem, draws.flat, prior)
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
            -2 * float(posterior.log_likelihood.max()),
            tuple(rivals),
            (*remarks, *judged),
            measured,
        )


def _data(
    time: ArrayLike | Record, area: ArrayLike | None, error: ArrayLike | None, model: object, quantity: object
) -> tuple[Series, str, list[str]]:
    """Values and errors to use, in order of time, the measured quantity, and a remark on omitted points."""
    if isinstance(time, Record):
        if model != "healing":
            raise InputError("model", expected="'healing' for a record of sliding", got=checks.shown(model))
        peaks = hold_peaks(time)
        time, area = peaks.duration, peaks.peak
    if (quantity in OF_BALL) != (model == "ball") or (quantity is not None and model != "ball"):
        expected = "depth or radius for the model 'ball', and none for others"
        raise InputError("quantity", expected=expected, got=checks.shown(quantity))
    measured = str(quantity or ("friction" if model == "healing" else "area"))
    if error is not None and (errors := checks.positive("error", error)).ndim == 0:
        error = np.full(np.shape(area), errors)  # type: ignore[arg-type]
    series = Series.checked(time, area, error, ("time", measured, "error"))
    t = series.x
    if t.size < 2 or not t.any():
        raise InputError("time", expected="two times or more, above 0", got=checks.shown(t.tolist()))
    if t[-1] > LARGEST:
        raise InputError("time", expected=f"times up to {LARGEST:g} s", got=float(t[-1]))
    if not callable(model):
        refuse_decline(series, measured)
    if (many := t.size) <= _MOST_POINTS:
        return series, measured, []
    chosen = _chosen(t)
    remark = f"took {chosen.size:,} of {many:,} points, at even distances in ln t: means of the others over "
    return series.where(chosen), measured, [f"{remark}short times would narrow the intervals"]


def _check_importable(model: object) -> None:
    try:
        pickle.dumps(model)
    except (pickle.PicklingError, AttributeError, TypeError):
        expected = "a function of a module, which other processes can import"
        raise InputError("model", expected=expected, got=checks.shown(model), advice="workers=1") from None


def _judged(rivals: list[Rival], stated: Model | None, *, informed: bool) -> tuple[Problem, list[str]]:
    """The chosen problem, with errors and with the priors of the user, if there are any; remarks."""
    first, remarks = rivals[0], list[str]()
    problem, misfit, n = first.problem, first.misfit, first.misfit.size
    free = max(n - problem.rank, 1)
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
    if not informed:
        scatter, rho = problem.scatter(first.at)
        # For few points Student's t widens the intervals.
        scatter *= student(free) / student(math.inf)
        problem = replace(problem, error=max(scatter, LEAST_ERROR) * problem.value)
        misfit = misfit * problem.value / problem.error
        origin = f"{100 * scatter:.2g} % of each value, from the scatter about the best fit"
        origin += f", whose neighbors correlate by {rho:.2f}"
        remarks.append(f"no errors were given: they are taken as {origin}")
    if stated is not None:
        before, problem = misfit, replace(problem, model=stated)
        at, misfit = best_fit(problem)
        if problem.improved(at, ())[0] - before @ before > _MUCH_BETTER:
            got = f"a best fit that misses by {rms(misfit):.3g} standard errors, rms"
            every = range(len(at))
            tight = min(every, key=lambda place: problem.improved(at, every, beyond=(place,))[0])
            name, prior = [*stated.priors.items()][tight]
            advice = f"a wider one of {name} than {prior} (default ones miss by {rms(before):.3g})"
            raise InputError("priors", expected="some that allow the data", got=got, advice=advice)

    def fails(misfit: Floats) -> bool:
        if informed:
            return bool(chi2.sf(misfit @ misfit, free) < _MISFIT)
        return neighbors(misfit)[0] > max(_CORRELATED, 2 / math.sqrt(n))

    if fails(misfit):
        how = f"by {rms(misfit):.3g} standard errors, rms" if informed else "by more than a scatter"
        others = ", and so does every model that was tried" if fails(best.misfit) else ""
        remarks.append(f"the model misses the data {how}{others}: the verdicts hold for this model only")
    return problem, remarks


def _chosen(t: Floats) -> NDArray[np.intp]:
    """Indices of points at even distances in ln t."""
    begin = int(np.searchsorted(t, 0.0, side="right"))
    places = np.searchsorted(t, np.geomspace(t[begin], t[-1], _MOST_POINTS))
    return np.unique([*range(min(begin, 1)), *np.minimum(places, t.size - 1)])
