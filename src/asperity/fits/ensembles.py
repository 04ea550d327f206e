"""A law fitted to the mean of many runs, with the errors that the scatter of the runs implies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import views
from asperity.base.checks import Floats, floats, line
from asperity.errors import InputError
from asperity.fits.resampling import Estimate, jackknife
from asperity.fits.result import parameters_of

Fit = TypeVar("Fit")


@dataclass(frozen=True, eq=False, repr=False)
class EnsembleFit(views.Brief, Generic[Fit]):
    """A fit of the mean of several runs.

    Attributes
    ----------
    mean
        The fit of the mean curve. Its own standard errors take the errors of the points for independent,
        which along a run they are not: those of `parameters` are right.
    parameters
        By name, each parameter of the fit with its standard error and 95 % interval, from the jackknife over
        runs.
    runs
        Number of runs.
    """

    mean: Fit
    parameters: Mapping[str, Estimate]
    runs: int


def ensemble(fit: Callable[[Floats, Floats], Fit], time: ArrayLike, areas: ArrayLike) -> EnsembleFit[Fit]:
    """Fit the mean of several runs.

    Parameters
    ----------
    fit
        Takes times and areas and gives a dataclass of which some fields have a ``..._stderr`` beside them,
        the parameters: `saturation`, `logarithm`, `growth_rate`, `power_law`, or a function of your own,
        such as ``lambda t, A: growth_rate(t, A, first=1.0, last=1e3)``.
    time
        Times of all runs, shape (times,).
    areas
        Areas, shape (runs, times). The fit sees their mean over runs.

    Returns
    -------
    EnsembleFit
        With one run the errors are NaN.

    Raises
    ------
    InputError
        The shapes do not match, `fit` has no parameters, or it refuses the mean or one of all runs but one.
    ConvergenceError
        If `fit` does not find a minimum.
    """
    times, runs = line("time", time), floats("areas", areas)
    if runs.ndim != 2 or runs.shape[0] == 0 or runs.shape[1] != times.size:
        raise InputError("areas", expected=f"shape (runs, {times.size})", got=f"shape {runs.shape}")
    mean = fit(times, runs.mean(axis=0))
    names = parameters_of(mean)
    if not names:
        raise InputError("fit", expected="one with standard errors", got=type(mean).__name__)

    def parameters(sample: Floats) -> Floats:
        result = fit(times, sample.mean(axis=0))
        return np.array([float(getattr(result, name)) for name in names])

    found = jackknife(parameters, runs)
    estimates = {name: found.part(i) for i, name in enumerate(names)}
    return EnsembleFit(mean, estimates, found.runs)
