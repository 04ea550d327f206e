"""Infer the parameters of a model from a measured curve."""

from __future__ import annotations

import functools
import pickle
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks, units
from asperity.base.checks import Floats
from asperity.errors import LARGEST, InputError
from asperity.fits.curve import Series, refuse_decline
from asperity.friction import Record, hold_peaks
from asperity.inference.concluding import conclude
from asperity.inference.found import Inference
from asperity.inference.indented import of_record
from asperity.inference.indenting import Indentation
from asperity.inference.models import CREEP, MOST_BRANCHES, OF_BALL, OF_BRANCHES, of_name
from asperity.inference.priors import Given
from asperity.inference.problem import Problem
from asperity.inference.rivals import drift_in
from asperity.inference.sampling import libraries
from asperity.progress import Progress, listener
from asperity.results import Checkpoint

_MOST_POINTS, _MOST_SAMPLED = 5000, 1000
"""Largest number of points for least squares, and for samples, whose thousands of walkers predict each."""

_NUMBERED = re.compile(f"(share|time)_[1-{MOST_BRANCHES}]")
"""Parameters whose number is the least number of branches."""

_OF_INDENTERS = ("radius", "angle", "poisson", "contact", "drift")


def infer(
    time: ArrayLike | Record | Indentation,
    area: ArrayLike | None = None,
    error: ArrayLike | str | None = None,
    *,
    force: ArrayLike | None = None,
    model: str | Callable[..., ArrayLike] = "relaxation",
    quantity: Literal["depth", "radius", "area"] | None = None,
    priors: Mapping[str, Given] | None = None,
    branches: int | None = None,
    absolute: bool = False,
    ramp: float | str = 0.0,
    radius: float | str | None = None,
    angle: float | str | None = None,
    poisson: float | None = None,
    contact: float | str = 0.0,
    drift: float | str = 0.0,
    sample: bool = False,
    seed: int = 0,
    rng: int | np.random.Generator | None = None,
    walkers: int = 1000,
    effective: int = 1000,
    workers: int = 1,
    progress: Progress | bool | None = None,
    checkpoint: str | Path | Checkpoint | None = None,
) -> Inference:
    """Infer the parameters of a model from a curve of area, friction or force, with a verdict on each.

    Parameters
    ----------
    time
        Times not below 0, s, shape (n,), in any order; or a record of sliding with holds, for the model
        ``"healing"``; or an `Indentation`, the record of an indenter.
    area
        Areas, static friction or forces above 0, shape (n,), in any unit, such as A(t)/A(0), unless they
        are `absolute`. With a `force`, depths of an indenter, m, of any sign.
    error
        Standard errors, one or shape (n,), or their part of the values, such as ``"1%"``. By default the
        scatter about the best fit, whose neighbors may correlate; see `asperity.inference.problem`.
    force
        Forces on an indenter, N, shape (n,): its approach and hold make the solid, an `IndentedSolid`, and
        its retraction is predicted.
    model
        ``"relaxation"``, ``"power"``, ``"logarithm"``, ``"lattice"``, ``"eyring"``, ``"healing"``,
        ``"ball"`` or ``"held"``, see `asperity.inference.models`; or a function of the times, and of
        parameters by name. With a `force`, ``"ball"``, ``"cone"`` or ``"punch"``.
    quantity
        For a ball, the measured quantity: its depth, or the radius or area of its contact.
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
    radius, angle, poisson
        With a `force`: radius of the ball or punch, m; half-angle of the cone, degrees; Poisson's ratio, for
        Young's modulus.
    contact, drift
        With a `force`: depth of the first contact, m, or ``"fit"``; and drift of the depth, m/s.
    sample
        Sample the posterior (minutes), in place of least squares with intervals by profile likelihoods. Needs
        the extra ``inference``.
    seed, rng
        Seed of the random numbers; or a numpy generator, which draws one, or its seed.
    walkers, effective, workers
        Of samples: walkers in each of four ensembles, required effective number, processes.
    progress
        True for a line for each stage; or an `asperity.progress.Progress`.
    checkpoint
        File with the ensembles of samples after each stage, from which the same call goes on.

    Raises
    ------
    InputError, ConvergenceError
        The priors exclude the data; the ensembles do not agree.
    """
    many = {"walkers": checks.integer("walkers", walkers, least=50)}
    many["effective"] = checks.integer("effective", effective, least=1)
    if branches is not None:
        checks.integer("branches", branches, least=1, most=MOST_BRANCHES)
    ranges = checks.instance("priors", {} if priors is None else priors, dict, "{'time_1': (1, 1e6)}")
    seed = checks.seed(seed, rng)
    sampling = {**many, "workers": workers, "checkpoint": checkpoint} if sample else None
    if sampling:
        libraries()
    if force is not None or isinstance(time, Indentation):
        _check_none(error=error, quantity=quantity, absolute=absolute, ramp=ramp)
        if isinstance(time, Indentation):
            _check_none(area=area, force=force, contact=contact, drift=drift)
        else:
            time = Indentation.of(time, area, force, contact=contact, drift=drift)  # type: ignore[arg-type]
        tip: dict[str, Any] = {"tip": model, "radius": radius, "angle": angle, "poisson": poisson}
        tip |= {"priors": ranges, "branches": branches, "sampling": sampling, "seed": seed}
        return of_record(time, **tip, progress=progress)
    _check_none(radius=radius, angle=angle, poisson=poisson, contact=contact, drift=drift)
    loading = float(units.number("ramp", ramp, "s", least=0))
    series, measured = _data(time, area, error, model, quantity, loading)
    series, remarks = _some(series, _MOST_SAMPLED if sample else _MOST_POINTS)
    t, v, errors = series.x, series.y, series.stderr
    noise = _per_time(t, v) if model == "held" else v
    if branches is not None and model not in OF_BRANCHES:
        expected = "model 'relaxation', 'ball' or 'held' beside it"
        raise InputError("branches", expected=expected, got=checks.shown(model))
    if callable(model) and workers > 1:
        _check_importable(model)
    model_of = functools.partial(of_name, time=t, value=v, ramp=loading, quantity=quantity)
    least = max([branches or 1, *(int(key[-1]) for key in ranges if _NUMBERED.fullmatch(key))])
    most = MOST_BRANCHES if branches is None and model in OF_BRANCHES else least
    model_of(model, priors=ranges, absolute=absolute, branches=least)  # mistakes in priors first

    def plan(name: object, branches: int, *, chosen: bool) -> Problem:
        """A model with default priors, for errors and comparisons without those of the user."""
        kept = ranges if chosen and callable(model) else None
        made = model_of(name, branches=branches, priors=kept, absolute=absolute and chosen)
        return Problem(t, v, noise if errors is None else errors, made, informed=errors is not None)

    family = [plan(model, n, chosen=True) for n in range(least, most + 1)]
    tried = [("relaxation", n) for n in range(1, MOST_BRANCHES + 1)] + [(name, 1) for name in CREEP[1:]]
    taken = [("relaxation" if model == "ball" else model, n) for n in range(least, most + 1)]
    taken += [("logarithm", 1)] if model == "healing" else []  # the same curve
    creeps = not callable(model) and model != "held"
    others = [plan(*key, chosen=False) for key in tried if creeps and key not in taken]
    with listener(progress) as listening:
        how: Any = {"seed": seed, "quantity": measured, "listening": listening}
        how["priors"] = None if callable(model) else ranges
        found = conclude(family, others, sampling=sampling, **how)
    remarks += drift_in(found.rivals[0], float(t[-1]), found.model.curve) if creeps else []
    return replace(found, remarks=(*remarks, *found.remarks))


def _data(
    time: ArrayLike | Record,
    area: ArrayLike | None,
    error: ArrayLike | str | None,
    model: object,
    quantity: object,
    ramp: float = 0.0,
) -> tuple[Series, str]:
    """Values and errors in order of time, and the measured quantity."""
    if isinstance(time, Record):
        if model != "healing":
            raise InputError("model", expected="'healing' for a record of sliding", got=checks.shown(model))
        peaks = hold_peaks(time)
        time, area = peaks.duration, peaks.peak
    if (quantity in OF_BALL) != (model == "ball") or (quantity is not None and model != "ball"):
        expected = "depth, radius or area for the model 'ball', and none for others"
        raise InputError("quantity", expected=expected, got=checks.shown(quantity))
    of_models = {"healing": "friction", "held": "force"}
    measured = str(quantity or of_models.get(str(model), "area"))
    if isinstance(error, str):
        error = units.number("error", error, "1", above=0) * checks.positive(measured, area)
    if error is not None and (errors := checks.positive("error", error)).ndim == 0:
        error = np.full(np.shape(area), errors)  # type: ignore[arg-type]
    series = Series.checked(time, area, error, ("time", measured, "error"))
    t = series.x
    if t.size < 2 or not t.any():
        raise InputError("time", expected="two times or more, above 0", got=checks.shown(t.tolist()))
    if t[0] < ramp:
        raise InputError("time", expected=f"times after the ramp, from {ramp:g} s on", got=float(t[0]))
    if t[-1] > LARGEST:
        raise InputError("time", expected=f"times up to {LARGEST:g} s", got=float(t[-1]))
    if not callable(model):
        refuse_decline(series, measured, falls=model == "held")
    return series, measured


def _some(series: Series, most: int) -> tuple[Series, list[str]]:
    """The points, or some of too many at even distances in ln t, with a remark."""
    t, many = series.x, series.x.size
    if many <= most:
        return series, []
    begin = int(np.searchsorted(t, 0.0, side="right"))
    places = np.searchsorted(t, np.geomspace(t[begin], t[-1], most))
    chosen = np.unique([*range(min(begin, 1)), *np.minimum(places, many - 1)])
    remark = f"took {chosen.size:,} of {many:,} points, at even distances in ln t: means of the others over "
    return series.where(chosen), [f"{remark}short times would narrow the intervals"]


def _per_time(t: Floats, v: Floats) -> Floats:
    """Shape of the noise of a force: a row is the mean over the time around it."""
    width = np.gradient(t) / np.ptp(t)
    return np.asarray(v.mean() / np.sqrt(np.maximum(width, 1e-3 * width.mean())))


def _check_none(**facts: object) -> None:
    """Refuse facts about a force on an indenter without one, or about a curve with one."""
    for name, fact in facts.items():
        if fact not in (None, 0.0, "0", False):
            beside = f"{'without' if name in _OF_INDENTERS else 'with'} a force on an indenter"
            raise InputError(name, expected=f"none {beside}", got=checks.shown(fact))


def _check_importable(model: object) -> None:
    try:
        pickle.dumps(model)
    except (pickle.PicklingError, AttributeError, TypeError):
        expected = "a function of a module, which other processes can import"
        raise InputError("model", expected=expected, got=checks.shown(model), advice="workers=1") from None
