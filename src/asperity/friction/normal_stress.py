"""A measured normal stress, as straight lines between few times."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asperity.base.checks import Floats
from asperity.friction.loading import variance

_CONSTANT = 0.02
"""Largest change of a constant normal stress over its mean."""

_BEYOND, _FLAT = 6.0, 1e-3
"""Distance of a normal stress from a line, over its noise or its mean, that is a change."""

_TOGETHER = 1e-9
"""Distance of times over the whole within which they are one."""


@dataclass(frozen=True, eq=False)
class NormalStress:
    """A normal stress over its mean, straight between few times, and steady friction at the first.

    Each time lies anywhere between the middles of two rows: it has the standard error `error`, 0 at the ends.
    """

    time: Floats
    value: Floats
    friction: float
    error: Floats | float = 0.0

    @classmethod
    def of(cls, time: Floats, values: Floats, friction: Floats, kinks: Floats) -> NormalStress:
        """Lines of least squares between rows, chosen until none is off by more than the noise.

        Friction is steady before the first of them ends, and the first of the `kinks` of the load point.
        """
        allowed = max(_BEYOND * math.sqrt(variance(time, values)), _FLAT)
        nodes, open_ = {0, time.size - 1}, [(0, time.size - 1)]
        while open_:
            first, last = open_.pop()
            ends, rows = [first, last], slice(first, last + 1)
            off = np.abs(values[rows] - np.interp(time[rows], time[ends], values[ends]))
            if off.max() > allowed:
                at = first + int(off.argmax())
                nodes.add(at)
                open_ += [(first, at), (at, last)]
        places = time[sorted(nodes)]
        hats = np.column_stack([np.interp(time, places, hat) for hat in np.eye(places.size)])
        steady = friction[time <= np.append(kinks, places[1]).min()]
        value = np.asarray(np.linalg.lstsq(hats, values)[0], float)
        # Anywhere between the middles of two rows: the standard deviation of an even distribution.
        gaps = np.gradient(time)[sorted(nodes)]
        gaps[[0, -1]] = 0.0
        return cls(places, value, float(steady.mean()), gaps / math.sqrt(12))

    def at(self, time: Floats) -> Floats:
        """Value at each time, shape (n,)."""
        last = np.clip(np.searchsorted(self.time.real, time.real, "right") - 1, 0, self.time.size - 2)
        slope = np.diff(self.value) / np.diff(self.time)
        return np.asarray(self.value[last] + slope[last] * (time - self.time[last]))

    def edges(self, others: Floats) -> Floats:
        """Times at which it turns, and others, which stay."""
        apart = np.abs(self.kinks[:, None] - others).min(axis=1) > _TOGETHER * (others[-1] - others[0])
        return np.union1d(others, self.kinks[apart])

    @property
    def kinks(self) -> Floats:
        """Times at which it turns."""
        return self.time[1:-1]


def changes(time: Floats, normal: Floats) -> bool:
    """Whether a normal stress changes by more than its noise, and 2 % of its mean."""
    low, high = np.quantile(normal, [0.01, 0.99])
    return bool(high - low > max(_CONSTANT * normal.mean(), _BEYOND * math.sqrt(variance(time, normal))))
