"""The generalized Maxwell solid of measured data, by non-negative least squares of relative deviations."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

import asperity.checks as checks
import asperity.views as views
from asperity.checks import Floats
from asperity.errors import LARGEST, InputError
from asperity.relaxation.data import Measured, scales
from asperity.relaxation.positive_sums import log_times
from asperity.relaxation.series import PronySeries


@dataclass(frozen=True, eq=False)
class Fit(views.InNotebooks):
    """A generalized Maxwell solid fitted to data.

    Attributes
    ----------
    series
        The solid; its `span` is that of the data, its `error` the largest relative deviation.
    rms
        Root mean square of the relative deviations.
    data
        What was fitted.
    per_decade
        Relaxation times in each decade that were allowed.
    """

    series: PronySeries
    rms: float
    data: Measured
    per_decade: float = 1.0

    def __repr__(self) -> str:
        first, last = self.series.span
        over = f"{self.decades:.1f} decades from {first:.3g} to {last:.3g} s"
        said = f"deviations {100 * self.rms:.2g} % rms, {100 * self.series.error:.2g} % at most"
        return f"<Fit: {len(self.series.branches)} branches, {over}, {said}>"

    @property
    def decades(self) -> float:
        """Decades of time that the data span."""
        first, last = self.series.span
        return math.log10(last / first)

    def residuals(self) -> tuple[Floats, ...]:
        """Relative deviations (data - fit) / data of each of the quantities, shape (n,)."""
        x, values = self.data.columns
        predicted = self.data.predicted(self.series, x)
        relative_to = scales(self.data)
        return tuple((v - p) / s for v, p, s in zip(values, predicted, relative_to, strict=True))

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
                advice="fewer times, or data of another temperature, shifted",
            )


def fit(data: Measured, *, per_decade: float = 1.0, over: tuple[float, float] | None = None) -> Fit:
    """Fit a generalized Maxwell solid to measured data by non-negative least squares.

    Relaxation times (of creep data: retardation times) are log-spaced over the times of the data; those that
    the data do not need get no branch. What has not relaxed at the last time is permanent.

    Parameters
    ----------
    data
        A `Relaxation`, `Creep` or `Dynamic`; `read` makes one of a file.
    per_decade
        Times per decade, from 0.2 to 10. More of them follow the noise of the data.
    over
        First and last time, s, that the fit will be used for; refused where the data do not reach.

    Raises
    ------
    InputError
        It is no data, `per_decade` is out of its range, or the data do not span the times in `over`.
    """
    data = _measured(data)
    density = checks.number("per_decade", per_decade, least=0.2, most=10)
    first, last = data.span
    steps = max(1, round(density * math.log10(last / first)))
    times = log_times(first, last, steps / math.log10(last / first), first)
    series = replace(data.series(times), span=data.span)
    found = Fit(series, 0.0, data, density)
    deviations = np.concatenate(found.residuals())
    largest, rms = float(np.abs(deviations).max()), float(np.sqrt(np.mean(deviations**2)))
    found = Fit(replace(series, error=largest), rms, data, density)
    if over is not None:
        try:
            start, end = over
        except (TypeError, ValueError) as error:
            raise InputError("over", expected="a first and a last time", got=checks.shown(over)) from error
        found.require(start, end)
    return found


def _measured(data: object) -> Measured:
    if not isinstance(data, Measured):
        expected = "a Relaxation, Creep or Dynamic"
        raise InputError("data", expected=expected, got=checks.kind_of(data), advice="relaxation.read(path)")
    return data
