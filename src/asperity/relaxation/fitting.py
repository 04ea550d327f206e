"""The generalized Maxwell solid of measured data, by non-negative least squares of relative deviations.

Relaxation times are few and free where that is enough, else log-spaced. Free times are found by least squares
in their logarithms; the weights are the best for them at every step (variable projection: G. H. Golub, V.
Pereyra, SIAM J. Numer. Anal. 10, 413 (1973), DOI 10.1137/0710036).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from asperity.base import checks, views
from asperity.base.checks import Floats
from asperity.errors import LARGEST, InputError
from asperity.relaxation.data import Dynamic, Extrapolate, Measured, scales
from asperity.relaxation.positive_sums import log_times
from asperity.relaxation.series import PronySeries

MOST_FREE = 5
"""Most relaxation times that are free unless more are asked for."""

_DRAWS = 200
_FEW_RUNS = -2.326  # runs of one sign over what chance gives, standard deviations: 1 % of noise has less
_CLOSE = 1.25  # misfit of free times over that of one time a decade, up to which the fewer times are taken
_DIGITS, _ROUNDING = 1e-5, 1e-9  # misfits, rms, of the digits printed in a table, and of computing


@dataclass(frozen=True, eq=False)
class Fit(views.InNotebooks):
    """A generalized Maxwell solid fitted to data.

    Attributes
    ----------
    series
        The solid; its `span` is that of the data, without an end where a plateau is assumed, and its `error`
        the largest relative deviation from both.
    rms
        Root mean square of the relative deviations.
    data
        What was fitted.
    times
        Relaxation times (of creep data: retardation times) that were allowed, s, shape (n,).
    per_decade
        How many of them are in each decade; None where they were free.
    """

    series: PronySeries
    rms: float
    data: Measured
    times: Floats
    per_decade: float | None = None

    def __repr__(self) -> str:
        first, last = self.data.span
        over = f"{self.decades:.1f} decades from {first:.3g} to {last:.3g} s"
        said = f"deviations {100 * self.rms:.2g} % rms, {100 * self.series.error:.2g} % at most"
        return f"<Fit: {len(self.series.branches)} branches, {over}, {said}>"

    @property
    def decades(self) -> float:
        """Decades of time that the data span."""
        first, last = self.data.span
        return math.log10(last / first)

    @property
    def assumed(self) -> str:
        """What is assumed beyond the data; empty where nothing is."""
        if self.data.extrapolate is None:
            return ""
        last = self.data.span[1]
        return f"beyond the last time of the table, {last:.4g} s, the modulus is assumed to stay"

    def residuals(self) -> tuple[Floats, ...]:
        """Relative deviations (data - fit) / data of each of the quantities, shape (n,)."""
        return _residuals(self.data, self.series)

    @functools.cached_property
    def systematic(self) -> bool:
        """Whether the deviations are waves rather than noise.

        They keep their sign for too long, at 1 % (runs of one sign: A. Wald, J. Wolfowitz, Ann. Math. Stat.
        11, 147 (1940), DOI 10.1214/aoms/1177731909); or twice as many times in each decade would miss the
        data by less than half, if there are three points for each of the times or more.
        """
        if self.rms < _ROUNDING:
            return False
        finer = self.per_decade is not None and self.data.columns[0].size >= 3 * len(self.times)
        if finer and _log_spaced(self.data, 2 * (self.per_decade or 1.0)).rms < self.rms / 2:
            return True
        excess, variance = 0.0, 0.0
        for deviation in self.residuals():
            above = deviation > 0
            n, pairs = above.size, 2.0 * above.sum() * (~above).sum()
            excess += 1 + np.count_nonzero(np.diff(above)) - (1 + pairs / n)
            variance += pairs * (pairs - n) / (n**2 * (n - 1))
        return bool(variance <= 0 or excess < _FEW_RUNS * math.sqrt(variance))

    @functools.cached_property
    def resampled(self) -> tuple[Fit, ...]:
        """Fits of tables that the noise of this one would have given, 200 or a few less; of no noise none.

        Each has other deviations, drawn from those of this fit with replacement (B. Efron, Ann. Stat. 7, 1
        (1979), DOI 10.1214/aos/1176344552), which are widened by what the fit has taken of them.
        """
        if self.systematic or self.rms < _DIGITS:
            return ()
        random, (x, _) = np.random.default_rng(0), self.data.columns
        predicted, deviations = self.data.predicted(self.series, x), self.residuals()
        found = len(self.series.branches) * (2 if self.per_decade is None else 1) + 1
        wider = math.sqrt(x.size / max(x.size - found, 1))
        drawn = []
        for _ in range(_DRAWS):
            chosen = random.integers(0, x.size, x.size)
            columns = [
                np.maximum(p + wider * r[chosen] * s, 0.0)
                for p, r, s in zip(predicted, deviations, scales(self.data), strict=True)
            ]
            # A draw may be no relaxation where deviations are large.
            with suppress(InputError):
                numbers: dict[str, Any] = dict(zip(self.data.names()[1:], columns, strict=True))
                table = replace(self.data, **numbers, noise=0.99)
                times = self.times if self.per_decade else _improved(table, self.times)
                drawn.append(_with(table, times, self.per_decade))
        return tuple(drawn)

    @property
    def intervals(self) -> Floats | None:
        """95 % intervals of the shares and times of free branches, shape (branches, 2, 2); None if not known.

        The last axis has the lower and the upper end. They are those of `resampled`.
        """
        shape = np.shape(self.series.branches)
        alike = [one.series.branches for one in self.resampled if np.shape(one.series.branches) == shape]
        if self.per_decade is not None or not shape[0] or len(alike) < _DRAWS // 2:
            return None
        return np.asarray(np.moveaxis(np.quantile(np.array(alike), (0.025, 0.975), axis=0), 0, -1))

    def curve(self, points: int = 200) -> tuple[Floats, tuple[Floats, ...]]:
        """Evaluate the fit between the first and the last of the data: log-spaced times, and its values."""
        points = checks.integer("points", points, least=2)
        x = np.geomspace(self.data.columns[0][0], self.data.columns[0][-1], points)
        return x, self.data.predicted(self.series, x)

    def require(self, first: float, last: float) -> None:
        """Refuse to extrapolate: `InputError` unless the data span these times."""
        first = checks.number("first", first, least=1 / LARGEST, expected="a finite time > 0")
        last = checks.number("last", last, least=first, expected=f"a time not before the first, {first:g}")
        begin, end = self.series.span
        if first < begin * (1 - 1e-9) or last > end * (1 + 1e-9):
            raise InputError(
                "times",
                expected=f"times that the data span, {begin:.3g} to {end:.3g} s ({self.decades:.1f} decades)",
                got=f"{first:.3g} to {last:.3g} s ({math.log10(last / first):.1f} decades)",
                advice="fewer times, data of another temperature, shifted, or extrapolate='plateau'",
            )


def fit(
    data: Measured,
    *,
    per_decade: float | None = None,
    branches: int | None = None,
    over: tuple[float, float] | None = None,
    extrapolate: Extrapolate | None = None,
) -> Fit:
    """Fit a generalized Maxwell solid to measured data by non-negative least squares.

    Unless the number of branches or their density is given, the smallest number of free relaxation times is
    taken, five at most, whose deviations look like noise: they are not `Fit.systematic`, and their rms is at
    most a quarter more than that of one time in each decade. Where no number is so, as for broad spectra, one
    time in each decade is taken. All relaxation times (of creep data: retardation times) lie within the times
    of the data; what has not relaxed at the last time is permanent.

    Parameters
    ----------
    data
        A `Relaxation`, `Creep` or `Dynamic`; `read` makes one of a file.
    per_decade
        Times per decade, from 0.2 to 10, log-spaced; those that the data do not need get no branch. More of
        them follow the noise of the data.
    branches
        In its place: how many free relaxation times.
    over
        First and last time, s, that the fit will be used for; refused where the data do not reach.
    extrapolate
        "plateau": the last modulus, or compliance, is assumed to stay after the last time, and is fitted too,
        by as many points as there are over two decades. No time before the first is known all the same.

    Raises
    ------
    InputError
        It is no data, `per_decade` or `branches` is out of its range, the data do not span the times in
        `over`, or a plateau is asked of a `Dynamic`.
    """
    data = _measured(data)
    if extrapolate is not None:
        if isinstance(data, Dynamic):
            expected = "none beside storage and loss moduli, which have no last modulus"
            raise InputError("extrapolate", expected=expected, got=checks.shown(extrapolate))
        data = replace(data, extrapolate=extrapolate)
    alone = data if data.extrapolate is None else replace(data, extrapolate=None)
    found = _found(alone, per_decade, branches)
    if data.extrapolate is not None:  # the plateau has no say in how many times there are
        times = found.times if found.per_decade else _improved(data, found.times)
        found = _with(data, times, found.per_decade)
    if over is not None:
        try:
            start, end = over
        except (TypeError, ValueError) as error:
            raise InputError("over", expected="a first and a last time", got=checks.shown(over)) from error
        found.require(start, end)
    return found


def _found(data: Measured, per_decade: float | None, branches: int | None) -> Fit:
    """The fit of these data alone."""
    if branches is not None:
        if per_decade is not None:
            expected = "none beside a number per decade"
            raise InputError("branches", expected=expected, got=checks.shown(branches))
        most = (data.columns[0].size - 1) // 2
        expected = f"a number from 1 to {most}, for as many points as there are"
        count = checks.integer("branches", branches, least=1, most=most, expected=expected)
        return _with(data, next(islice(_free_times(data), count - 1, None)))
    density = 1.0 if per_decade is None else per_decade
    found = _log_spaced(data, checks.number("per_decade", density, least=0.2, most=10))
    return found if per_decade is not None else _with_few_times(data, found.rms) or found


def _log_spaced(data: Measured, density: float) -> Fit:
    """A fit of so many times in each decade."""
    first, last = data.span
    steps = max(1, round(density * math.log10(last / first)))
    return _with(data, log_times(first, last, steps / math.log10(last / first), first), density)


def _with_few_times(data: Measured, rms: float) -> Fit | None:
    """The smallest number of free times whose deviations look like noise; None without one."""
    points = sum(values.size for values in data.columns[1])
    most = min(MOST_FREE, (points // 2 - 1) // 2)  # two points or more for each number
    for times in islice(_free_times(data), most):
        with suppress(InputError):  # creep of few times may have no elastic strain
            found = _with(data, times)
            if found.rms < max(_CLOSE * rms, _ROUNDING) and not found.systematic:
                return found
    return None


def _free_times(data: Measured) -> Iterator[Floats]:
    """One free time, two, and so on, which begin with those before and the one that helps most."""
    first, last = data.span
    places = np.geomspace(first, last, 2 * max(1, round(math.log10(last / first))) + 1)
    times = np.empty(0)
    while True:
        longer = [np.append(times, place) for place in places]
        missed = [np.linalg.norm(_deviations(data, np.log(tried))) for tried in longer]
        times = _improved(data, longer[int(np.argmin(missed))])
        yield times


def _improved(data: Measured, times: Floats) -> Floats:
    """The times that fit best, from these on."""
    low, high = np.log(data.span)
    found = least_squares(
        functools.partial(_deviations, data),
        np.clip(np.log(times), low, high),
        bounds=(low, high),
        method="dogbox",
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-15,  # exact data end by this one
    )
    return np.asarray(np.sort(np.exp(found.x)))


def _deviations(data: Measured, logarithms: Floats) -> Floats:
    """Deviations from a fit of times of these logarithms; 1 where there is none."""
    fitted = data.fitted
    try:
        return np.concatenate(_residuals(fitted, fitted.series(np.exp(logarithms))))
    except InputError:  # creep without an elastic strain
        return np.ones(sum(values.size for values in fitted.columns[1]))


def _residuals(data: Measured, series: PronySeries) -> tuple[Floats, ...]:
    """Relative deviations of data from a series, of each of the quantities."""
    x, values = data.columns
    predicted = data.predicted(series, x)
    return tuple((v - p) / s for v, p, s in zip(values, predicted, scales(data), strict=True))


def _with(data: Measured, times: Floats, per_decade: float | None = None) -> Fit:
    """A fit of given times."""
    fitted = data.fitted
    series, (first, last) = fitted.series(times), data.span
    of_data, of_all = (np.concatenate(_residuals(one, series)) for one in (data, fitted))
    span = (first, math.inf if data.extrapolate else last)
    series = replace(series, span=span, error=float(np.abs(of_all).max()))
    return Fit(series, float(np.sqrt(np.mean(of_data**2))), data, times, per_decade)


def _measured(data: object) -> Measured:
    if not isinstance(data, Measured):
        expected = "a Relaxation, Creep or Dynamic"
        raise InputError("data", expected=expected, got=checks.kind_of(data), advice="relaxation.read(path)")
    return data
