"""Curves for a fit: values against time or another variable, checked, sorted and scaled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import spearmanr

from asperity.base.checks import Floats, kind_of, line
from asperity.errors import LARGEST, InputError

MANY = 2000
"""Points above which a search for starting points works on means over bins."""

BINS = 300
"""Number of these bins, of equal width in ln x."""


@dataclass(frozen=True, eq=False)
class Series:
    """Values y against x, which does not fall, shape (n,); without standard errors all have one weight."""

    x: Floats
    y: Floats
    stderr: Floats | None

    @classmethod
    def checked(
        cls,
        x: ArrayLike,
        y: ArrayLike | None,
        stderr: ArrayLike | None,
        names: Sequence[str] = ("time", "area", "stderr"),
    ) -> Series:
        """Check and sort; x not below 0, y and stderr above 0. The names are for messages."""
        of_x, of_y, of_errors = names
        xs, ys = line(of_x, x), line(of_y, y)
        sigmas = None if stderr is None else line(of_errors, stderr)
        for name, values in ((of_y, ys), (of_errors, sigmas)):
            if values is None:
                continue
            if values.size != xs.size:
                expected = f"one for each of the {xs.size} values of {of_x}"
                raise InputError(name, expected=expected, got=values.size)
            if (values <= 0).any():
                raise InputError(name, expected=f"values of {name} above 0", got=float(values.min()))
        if xs.size == 0 or xs.min() < 0:
            raise InputError(of_x, expected=f"values of {of_x} not below 0", got=sketch(np.sort(xs)))
        order = np.argsort(xs, kind="stable")
        return cls(xs[order], ys[order], None if sigmas is None else sigmas[order])

    def where(self, chosen: NDArray[np.bool_ | np.intp]) -> Series:
        """Some of the points."""
        return Series(self.x[chosen], self.y[chosen], None if self.stderr is None else self.stderr[chosen])

    def binned(self, bins: int = BINS) -> Series:
        """Weighted means over bins of equal width in ln x; points at x = 0 are another bin.

        Without standard errors, those of the means are in units of the common one of the values.
        """
        weight = np.ones_like(self.y) if self.stderr is None else self.stderr**-2
        zeros = int(np.searchsorted(self.x, 0.0, side="right"))
        bin_of, logs = np.zeros(self.x.size, dtype=np.intp), np.zeros_like(self.x)
        logs[zeros:] = np.log(self.x[zeros:])
        edges = np.linspace(logs[zeros], logs[-1], bins + 1)[1:-1]
        bin_of[zeros:] = 1 + np.searchsorted(edges, logs[zeros:], side="right")
        total = np.bincount(bin_of, weight)
        filled = total > 0
        x, y = (np.bincount(bin_of, weight * values)[filled] / total[filled] for values in (logs, self.y))
        x = np.exp(x)
        if zeros:
            x[0] = 0.0
        return Series(x, y, np.asarray(total[filled] ** -0.5, dtype=np.float64))


@dataclass(frozen=True, eq=False)
class Curve:
    """Points of a fit in units of the first time above 0 and of A(0), or else of the first area.

    If A(0) is known, it is 1 and no point. Else it is a parameter, and areas at time 0 are points.
    """

    points: Series
    time_unit: float
    area_unit: float
    initial_known: bool

    @classmethod
    def checked(
        cls, time: ArrayLike, area: ArrayLike | None, stderr: ArrayLike | None, parameters: int
    ) -> Curve:
        """Check areas and times, or one DataArray with both; `parameters` does not count A(0)."""
        if area is None:
            area, labels = time, getattr(time, "coords", {})
            if "time" not in labels or getattr(area, "name", "") == "time":
                expected, alone = "areas beside the times, or one DataArray of areas over time", kind_of(area)
                raise InputError("area", expected=expected, got=f"{alone} alone", advice="history.area")
            time = labels["time"]
        series = Series.checked(time, area, stderr)
        for name, values in (("time", series.x), ("area", series.y), ("stderr", series.stderr)):
            # Squares and ratios must not overflow.
            numbers = np.zeros(0) if values is None else values
            beyond = numbers[(numbers > LARGEST) | ((numbers > 0) & (numbers < 1 / LARGEST))]
            if len(beyond):
                expected = f"numbers up to {LARGEST:g} (0, or from {1 / LARGEST:g})"
                raise InputError(name, expected=expected, got=float(beyond[0]))
        zeros = int(np.searchsorted(series.x, 0.0, side="right"))
        exact_start = zeros == 1 and stderr is None
        parameters += not exact_start
        fitted = series.where(np.arange(series.x.size) >= exact_start)
        if fitted.x.size <= parameters:
            expected = f"at least {parameters + 1} values to fit, one more than there are parameters"
            got = f"{fitted.x.size} besides the one at time 0" if exact_start else fitted.x.size
            raise InputError("time", expected=expected, got=got, advice="a curve of more points")
        different = np.unique(fitted.x).size
        if different < parameters:
            expected = f"at least {parameters} different times, as many as there are parameters"
            raise InputError("time", expected=expected, got=different)
        refuse_decline(series)
        time_unit, area_unit = float(series.x[zeros]), float(series.y[: max(zeros, 1)].mean())
        sigma = None if fitted.stderr is None else fitted.stderr / area_unit
        points = Series(fitted.x / time_unit, fitted.y / area_unit, sigma)
        return cls(points, time_unit, area_unit, exact_start)

    def time_scales(self) -> Floats:
        """Starting values of t0."""
        return np.geomspace(0.1, 10 * self.points.x[-1], 20)


def refuse_decline(series: Series, name: str = "area", *, falls: bool = False) -> None:
    """Raise `InputError` unless values grow with time, or fall, by their rank correlation."""
    constant = bool((series.y == series.y[0]).all())
    rank = 0.0 if constant or not np.ptp(series.x) else float(spearmanr(series.x, series.y).statistic)
    if not (-rank if falls else rank) > 0:
        got = f"{series.y[0]:g} at every time" if constant else f"{sketch(series.y)}"
        detail = "" if constant else f" (rank correlation with time {rank:.2f})"
        kind = "values that fall" if falls else "an area that grows" if name == "area" else "values that grow"
        raise InputError(name, expected=f"{kind} with time", got=f"{got}{detail}")


def sketch(values: Floats) -> str:
    """First and last number, for messages."""
    return f"{values[0]:g} ... {values[-1]:g}" if values.size else "none"
