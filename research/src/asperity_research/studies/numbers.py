"""What studies compute of their runs, as columns of tables: means, powers, slopes and times of extremes."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from asperity.fits import Estimate, jackknife
from asperity_research.arrays import Field, Mask


def mean(sample: Field) -> Estimate:
    """Return the mean over surfaces, the first axis of a sample."""
    return mean_of(lambda some: some, sample)


def mean_of(statistic: Callable[..., float | Field], *samples: Field) -> Estimate:
    """Estimate a statistic of means over surfaces, the first axis of each sample."""
    return jackknife(lambda *some: statistic(*(one.mean(axis=0) for one in some)), samples)


def ratio(one: Field, other: Field) -> Estimate:
    """Estimate the ratio of two means over surfaces."""
    return mean_of(lambda a, b: a / b, one, other)


def columns(name: str, found: Estimate | None, *, shared: bool = False) -> dict[str, Any]:
    """Return the columns of a number and the ends of its interval: NAME, NAME_low, NAME_high; NaN for none.

    The ends are low and high where they are shared: no other number of the table has an interval.
    """
    head = "" if shared else f"{name}_"
    ends = (found.value, found.low, found.high) if found is not None else (math.nan,) * 3
    return dict(zip((name, f"{head}low", f"{head}high"), ends, strict=True))


def all_columns(**found: Estimate | None) -> dict[str, Any]:
    """Return the columns of several numbers."""
    return {key: end for name, one in found.items() for key, end in columns(name, one).items()}


def within(time: Field, first: float, last: float) -> Mask:
    """Which times are between two, which both count in spite of rounding."""
    return np.asarray((time >= first * (1 - 1e-9)) & (time <= last * (1 + 1e-9)))


def slope(time: Field, values: Field, first: float = 0.0, last: float = math.inf) -> float:
    """Slope against ln t, shape (n,), between two times."""
    chosen = within(time, first, last)
    return float(np.polyfit(np.log(time[chosen]), values[chosen], 1)[0])


def power(at: Field, values: Field) -> float:
    """Slope of ln(values) against ln(at), shape (n,)."""
    return slope(at, np.log(values))


def vertex(time: Field, values: Field, at: int) -> float:
    """Time of the vertex of the parabola in ln t through a value, greatest or smallest, and its neighbors."""
    near = slice(at - 1, at + 2)
    scaled = (values[near] - values[at]) / np.ptp(values[near])
    square, linear, _ = np.polyfit(np.log(time[near] / time[at]), scaled, 2)
    return float(time[at] * math.exp(-linear / (2 * square)))


def crossing(time: Field, values: Field, at: int, level: float) -> tuple[float, float]:
    """Time, by ln t, at which values cross a level in the step that ends at an index; part of the step."""
    part = (level - values[at - 1]) / (values[at] - values[at - 1])
    return float(time[at - 1] * (time[at] / time[at - 1]) ** part), float(part)
