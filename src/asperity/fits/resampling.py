r"""Standard errors from a sample of runs: the jackknife.

With theta the statistic of all n runs and theta_i that of all but run i,

    stderr² = (n - 1)/n \sum_i (theta_i - mean theta_i)²,

and the 95 % interval is theta ± t stderr, t from Student's distribution with n - 1 degrees of freedom. It is
the usual standard error of a mean, right to leading order in 1/n for smooth functions of means, and wrong for
medians and extremes. Source: B. Efron and C. Stein, *The jackknife estimate of variance*, Ann. Statist. 9,
586 (1981), doi:10.1214/aos/1176345462.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.base import views
from asperity.base.checks import Floats, floats, line
from asperity.errors import InputError
from asperity.fits.result import parameters_of, student

Fit = TypeVar("Fit")


@dataclass(frozen=True, eq=False, repr=False)
class Estimate(views.Brief):
    """A statistic of several independent runs.

    Attributes
    ----------
    value
        Value of all runs; a float, or an array of any shape.
    stderr, low, high
        Standard error and ends of the two-sided 95 % interval, of the same shape; NaN for one run.
    """

    value: Floats
    stderr: Floats
    low: Floats
    high: Floats
    runs: int

    def part(self, at: int, *, scale: bool = False) -> Estimate:
        """Return one of several estimates; with `scale` take the exponential of an estimated logarithm."""
        value, stderr, low, high = (part[at] for part in (self.value, self.stderr, self.low, self.high))
        if scale:
            value, low, high = np.exp(value), np.exp(low), np.exp(high)
            stderr = value * stderr
        return Estimate(value, stderr, low, high, self.runs)


def jackknife(
    statistic: Callable[..., ArrayLike], samples: ArrayLike | tuple[NDArray[np.generic], ...]
) -> Estimate:
    """Estimate a statistic of runs, with standard error and 95 % interval by the jackknife.

    Parameters
    ----------
    statistic
        Function of one array for each of `samples`, with any number of runs, that returns a float or an
        array: a smooth function of means over runs, such as ``lambda areas: fit(areas.mean(axis=0)).C``.
    samples
        One array of shape (runs, ...), or a tuple of such arrays for the same runs.
    """
    arrays = tuple(np.asarray(array) for array in (samples if isinstance(samples, tuple) else (samples,)))
    counts = [array.shape[0] if array.ndim else 0 for array in arrays]
    if not counts or min(counts) == 0 or len(set(counts)) > 1:
        got = " and ".join(str(array.shape) for array in arrays) or "none"
        raise InputError("samples", expected="arrays with one entry for each run", got=f"shapes {got}")

    def of(*samples: NDArray[np.generic]) -> Floats:
        return np.asarray(statistic(*samples), dtype=np.float64)

    runs, value = counts[0], of(*arrays)
    if runs == 1:
        unknown = np.full_like(value, np.nan)[()]
        return Estimate(value[()], unknown, unknown, unknown, runs)
    without = np.stack([of(*(np.delete(array, run, axis=0) for array in arrays)) for run in range(runs)])
    with np.errstate(invalid="ignore"):  # an infinite statistic has no spread: NaN
        stderr = np.sqrt((runs - 1) * np.var(without, axis=0))
    reach = student(runs - 1) * stderr
    return Estimate(value[()], stderr[()], (value - reach)[()], (value + reach)[()], runs)


@dataclass(frozen=True, eq=False, repr=False)
class EnsembleFit(views.Brief, Generic[Fit]):
    """A fit of the mean of several runs.

    The standard errors of `mean` assume independent errors of the points, which along a run are correlated.
    Use those of `parameters`, with their 95 % intervals, from the jackknife over runs.
    """

    mean: Fit
    parameters: Mapping[str, Estimate]
    runs: int


def ensemble(fit: Callable[[Floats, Floats], Fit], time: ArrayLike, areas: ArrayLike) -> EnsembleFit[Fit]:
    """Fit the mean of several runs.

    Parameters
    ----------
    fit
        Function of times and areas that returns a dataclass; its fields with a ``..._stderr`` beside them
        are the parameters: `saturation`, `logarithm`, `growth_rate`, `power_law`, or another one, such as
        ``lambda t, A: growth_rate(t, A, first=1.0, last=1e3)``.
    time, areas
        Times of all runs, shape (times,); areas, shape (runs, times). The fit takes their mean.

    With one run the standard errors are NaN. Errors are those of `fit`.
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

    estimate = jackknife(parameters, runs)
    estimates = {name: estimate.part(i) for i, name in enumerate(names)}
    return EnsembleFit(mean, estimates, estimate.runs)
