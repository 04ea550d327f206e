"""The generalized Maxwell solid of measured data, by non-negative least squares of relative deviations.

Relaxation times are few and free if these suffice, else log-spaced. Least squares find the logarithms of free
times; at every step the weights are the best for them (variable projection: G. H. Golub, V. Pereyra, SIAM J.
Numer. Anal. 10, 413 (1973), DOI 10.1137/0710036).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import numpy as np
import scipy

from asperity.base import checks, views
from asperity.base.checks import Floats
from asperity.base.positive_sums import log_times
from asperity.errors import InputError
from asperity.relaxation.data import Dynamic, Extrapolate, Measured, scales
from asperity.relaxation.series import PronySeries

MOST_FREE = 5
"""Largest number of free relaxation times by default."""

_DRAWS = 200
_GRIDS = ((1.0, 0), (1.0, 1), (2.0, 0), (2.0, 1))
"""Times a decade, and decades beyond the data, in the order in which they are tried."""
_FEW_RUNS = -2.326  # least excess of runs of one sign, in standard deviations: 1 % of random series has less
_CLOSE = 1.25  # largest misfit of free times over that of log-spaced times
_SEEN = 0.01  # least relative change of J by relaxation before the first time for which that is assumed
_DIGITS, _ROUNDING = 1e-5, 1e-9  # rms misfits by digits of a table, and by rounding


@dataclass(frozen=True, eq=False)
class Fit(views.InNotebooks, views.Pictured):
    """A generalized Maxwell solid fitted to data.

    Attributes
    ----------
    series
        The solid; its `span` is that of the data, or without an end with a plateau, and its `error` the
        largest relative deviation from both.
    rms
        Root mean square of the relative deviations.
    data
        The data.
    times
        Relaxation times (of creep data: retardation times) of the fit, s, shape (n,).
    per_decade
        Number of them in a decade; None if they are free.
    beyond
        Decades that they may lie beyond the data.
    """

    series: PronySeries
    rms: float
    data: Measured
    times: Floats
    per_decade: float | None = None
    beyond: int = 0

    def __repr__(self) -> str:
        first, last = self.data.span
        over = f"{self.decades:.1f} decades from {first:.3g} to {last:.3g} s"
        deviations = f"deviations {100 * self.rms:.2g} % rms, {100 * self.series.error:.2g} % at most"
        return f"<Fit: {len(self.series.branches)} branches, {over}, {deviations}>"

    @property
    def decades(self) -> float:
        """Decades of time that the data span."""
        first, last = self.data.span
        return math.log10(last / first)

    @property
    def assumed(self) -> str:
        """Assumptions beyond the data; empty without any."""
        first, last = self.data.span
        after = f"the modulus is assumed to stay after the last time of the table, {last:.4g} s"
        assumptions = [after] if self.data.extrapolate else []
        if self.series.branches != self._fitted.branches:
            assumptions.append(
                f"before the first time of the table, {first:.4g} s, relaxation is assumed to have the slope "
                f"there, which changes J({first:.4g} s) by {100 * self.unseen:.2g} % and later values by "
                "less; the band covers zero to twice this relaxation"
            )
        return "; ".join(assumptions)

    @functools.cached_property
    def _fitted(self) -> PronySeries:
        return self.data.fitted.series(self.times)

    @functools.cached_property
    def unseen(self) -> float:
        """Relative change of J at the first time by relaxation before it, with the slope there."""
        longer = self.data.continued(self._fitted)
        return float(
            np.divide(*(each.compliance_at(self.data.span[0]) for each in (longer, self._fitted))) - 1
        )

    @functools.cached_property
    def alternatives(self) -> tuple[PronySeries, ...]:
        """Samples of possible series: `resampled`, or copies of this one.

        Each has 0 to 2 times the relaxation before the first time that its slope there predicts.
        """
        drawn = self.resampled or (self,) * _DRAWS
        parts = 2 * np.random.default_rng(1).random(len(drawn))
        return tuple(each.data.continued(each._fitted, part) for each, part in zip(drawn, parts, strict=True))

    def residuals(self) -> tuple[Floats, ...]:
        """Relative deviations (data - fit) / data of each of the quantities, shape (n,)."""
        return _residuals(self.data, self.series)

    @functools.cached_property
    def systematic(self) -> bool:
        """Whether the deviations are waves rather than noise, or there is a `finer` fit.

        Waves have too few runs of one sign, at 1 % (A. Wald, J. Wolfowitz, Ann. Math. Stat. 11, 147 (1940),
        DOI 10.1214/aoms/1177731909).
        """
        if self.rms < _ROUNDING:
            return False
        if self.finer is not None:
            return True
        excess, variance = 0.0, 0.0
        for deviation in self.residuals():
            above = deviation > 0
            n, pairs = above.size, 2.0 * above.sum() * (~above).sum()
            excess += 1 + np.count_nonzero(np.diff(above)) - (1 + pairs / n)
            variance += pairs * (pairs - n) / (n**2 * (n - 1))
        return bool(variance <= 0 or excess < _FEW_RUNS * math.sqrt(variance))

    @functools.cached_property
    def finer(self) -> float | None:
        """Twice the times a decade, if these more than halve the misfit; else None."""
        if self.per_decade is None or sum(part.size for part in self.data.columns[1]) < 3 * len(self.times):
            return None
        density = 2 * self.per_decade
        return density if _log_spaced(self.data, density, self.beyond).rms < self.rms / 2 else None

    @functools.cached_property
    def resampled(self) -> tuple[Fit, ...]:
        """Fits of about 200 tables with other noise: a bootstrap; empty without noise.

        Deviations are drawn from those of this fit with replacement (B. Efron, Ann. Stat. 7, 1 (1979), DOI
        10.1214/aos/1176344552), and widened for the degrees of freedom, also by Student's t.
        """
        if self.systematic or self.rms < _DIGITS:
            return ()
        random, (x, _) = np.random.default_rng(0), self.data.columns
        predicted, deviations = self.data.predicted(self.series, x), self.residuals()
        freedom = len(self.series.branches) * (2 if self.per_decade is None else 1) + 1
        free = max(x.size - freedom, 1)
        wider = math.sqrt(x.size / free) * scipy.special.stdtrit(free, 0.975) / scipy.special.ndtri(0.975)
        drawn = []
        for _ in range(_DRAWS):
            chosen = random.integers(0, x.size, x.size)
            columns = [
                np.maximum(p + wider * r[chosen] * s, 0.0)
                for p, r, s in zip(predicted, deviations, scales(self.data), strict=True)
            ]
            # With large deviations a draw may be no relaxation.
            with suppress(InputError):
                numbers: dict[str, Any] = dict(zip(self.data.names()[1:], columns, strict=True))
                table = replace(self.data, **numbers, noise=0.99)
                times = self.times if self.per_decade else _improved(table, self.times, self.beyond)
                drawn.append(_with(table, times, self.per_decade, self.beyond))
        return tuple(drawn)

    @property
    def intervals(self) -> Floats | None:
        """95 % intervals of shares and times of free branches, shape (branches, 2, 2); None if unknown."""
        shape = np.shape(self.series.branches)
        alike = [each.series.branches for each in self.resampled if np.shape(each.series.branches) == shape]
        if self.per_decade is not None or not shape[0] or len(alike) < _DRAWS // 2:
            return None
        ends = np.quantile(np.array(alike), (0.025, 0.975), axis=0, method="weibull")  # unbiased for few
        return np.asarray(np.moveaxis(ends, 0, -1))

    def curve(self, points: int = 200) -> tuple[Floats, tuple[Floats, ...]]:
        """Evaluate the fit at log-spaced times between the first and the last of the data."""
        points = checks.integer("points", points, least=2)
        x = self.data.columns[0]
        x = np.geomspace(x[x > 0][0], x[-1], points)
        return x, self.data.predicted(self.series, x)


def fit(
    data: Measured,
    *,
    per_decade: float | None = None,
    branches: int | None = None,
    extrapolate: Extrapolate | None = None,
) -> Fit:
    """Fit a generalized Maxwell solid to measured data by non-negative least squares.

    By default it takes the smallest number of free relaxation times, five at most, whose deviations look like
    noise: they are not `Fit.systematic`, and their rms is at most a quarter above that of log-spaced times.
    Otherwise, as for broad spectra, it takes log-spaced times: one or two a decade, within the times of the
    data or up to a decade beyond, by Akaike's criterion, AICc.

    Only losses, or a value at time 0, measure relaxation before the first time. If such relaxation, with the
    slope of the first decade, would change J(first) by 1 % or more, it is added as one branch. See
    `Fit.alternatives`.

    Parameters
    ----------
    data
        A `Relaxation`, `Creep` or `Dynamic`; `read` makes one of a file.
    per_decade
        Log-spaced times per decade, from 0.2 to 10; those that the data do not need get no branch. Many of
        them follow the noise of the data.
    branches
        Number of free relaxation times, in place of `per_decade`.
    extrapolate
        "plateau": assume that the last modulus, or compliance, stays after the last time. Two decades of it
        are fitted by as many points as the data have.

    Raises
    ------
    InputError
        The data are of another class, a number is out of range, or a plateau is asked of a `Dynamic`.
    """
    expected, advice = "a Relaxation, Creep or Dynamic", "relaxation.read(path)"
    if not isinstance(data, Measured):
        raise InputError("data", expected=expected, got=checks.kind_of(data), advice=advice)
    if extrapolate is not None:
        if isinstance(data, Dynamic):
            expected = "none beside storage and loss moduli, which have no last modulus"
            raise InputError("extrapolate", expected=expected, got=checks.shown(extrapolate))
        data = replace(data, extrapolate=extrapolate)
    alone = data if data.extrapolate is None else replace(data, extrapolate=None)
    best = _found(alone, per_decade, branches)
    if data.extrapolate is None:
        return best
    # The plateau does not count in the choice of the number of times.
    times = best.times if best.per_decade else _improved(data, best.times, best.beyond)
    return _with(data, times, best.per_decade, best.beyond)


def _found(data: Measured, per_decade: float | None, branches: int | None) -> Fit:
    if branches is not None:
        if per_decade is not None:
            expected = "none beside a number per decade"
            raise InputError("branches", expected=expected, got=checks.shown(branches))
        most = (data.columns[0].size - 1) // 2
        count = checks.integer("branches", branches, least=1, most=most)
        return _with(data, next(islice(_free_times(data, 0), count - 1, None)))
    if per_decade is not None:
        density = checks.number("per_decade", per_decade, least=0.2, most=10)
        return _broad(data, [(density, 0), (density, 1)])
    broad = _broad(data, _GRIDS)
    return _with_few_times(data, broad) or broad


def _broad(data: Measured, grids: Sequence[tuple[float, int]]) -> Fit:
    """Fit log-spaced times, as many as AICc prefers."""
    values = sum(part.size for part in data.columns[1])

    def score(trial: Fit) -> float:
        numbers = len(trial.series.branches) + 1
        freedom = values - numbers - 1
        penalty = numbers / freedom if freedom > 0 else math.inf
        return values * (math.log(max(trial.rms, _ROUNDING)) + penalty)

    tried = [_log_spaced(data, *grids[0])]
    for density, beyond in grids[1:]:
        with suppress(InputError):  # creep of some times has no elastic strain
            tried.append(_log_spaced(data, density, beyond))
    return min((trial for trial in tried if trial is tried[0] or 2 * len(trial.times) <= values), key=score)


def _log_spaced(data: Measured, density: float, beyond: int) -> Fit:
    first, last = data.span
    decades = math.log10(last / first)
    density_used = max(1, round(density * decades)) / decades
    return _with(data, log_times(*data.reach(beyond), density_used, first), density, beyond)


def _with_few_times(data: Measured, broad: Fit) -> Fit | None:
    """The smallest number of free times that fit as well, and leave noise; None without one.

    As many times as decades mean a broad spectrum: refused if relaxation before the data matters.
    """
    points = sum(values.size for values in data.columns[1])
    most = min(MOST_FREE, (points // 2 - 1) // 2)  # two points or more for each number
    for times in islice(_free_times(data, broad.beyond), most):
        with suppress(InputError):  # creep of few times may have no elastic strain
            reduced = _with(data, times, beyond=broad.beyond)
            close = reduced.rms < max(_CLOSE * broad.rms, _ROUNDING) and not reduced.systematic
            few = len(times) < reduced.decades
            if close and (few or abs(reduced.unseen) < max(_SEEN, reduced.rms)):
                return reduced
    return None


def _free_times(data: Measured, beyond: int) -> Iterator[Floats]:
    """One free time, two, and so on; each search starts from those before and the best further one."""
    first, last = data.reach(beyond)
    places = np.geomspace(first, last, 2 * max(1, round(math.log10(last / first))) + 1)
    times = np.empty(0)
    while True:
        longer = [np.append(times, place) for place in places]
        missed = [np.linalg.norm(_deviations(data, np.log(tried))) for tried in longer]
        times = _improved(data, longer[int(np.argmin(missed))], beyond)
        yield times


def _improved(data: Measured, times: Floats, beyond: int) -> Floats:
    low, high = np.log(data.reach(beyond))
    minimum = scipy.optimize.least_squares(
        functools.partial(_deviations, data),
        np.clip(np.log(times), low, high),
        bounds=(low, high),
        method="dogbox",
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-15,  # exact data end by this one
    )
    return np.asarray(np.sort(np.exp(minimum.x)))


def _deviations(data: Measured, logarithms: Floats) -> Floats:
    """Deviations from a fit of times of these logarithms; 1 if it fails."""
    fitted = data.fitted
    try:
        return np.concatenate(_residuals(fitted, fitted.series(np.exp(logarithms))))
    except InputError:  # creep without an elastic strain
        return np.ones(sum(values.size for values in fitted.columns[1]))


def _residuals(data: Measured, series: PronySeries) -> tuple[Floats, ...]:
    x, values = data.columns
    predicted = data.predicted(series, x)
    return tuple((v - p) / s for v, p, s in zip(values, predicted, scales(data), strict=True))


def _with(data: Measured, times: Floats, per_decade: float | None = None, beyond: int = 0) -> Fit:
    """Fit branches of these times; log-spaced ones continue before the first time of the data."""
    fitted = data.fitted
    series, (first, last) = fitted.series(times), data.span
    of_data, of_all = (np.concatenate(_residuals(measured, series)) for measured in (data, fitted))
    span = (first, math.inf if data.extrapolate else last)
    series = replace(series, span=span, error=float(np.abs(of_all).max()))
    result = Fit(series, float(np.sqrt(np.mean(of_data**2))), data, times, per_decade, beyond)
    if per_decade is None or abs(result.unseen) < _SEEN:
        return result
    return replace(result, series=replace(data.continued(series), span=span, error=series.error))
