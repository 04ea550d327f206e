"""Legs with the times at which they begin and end."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from asperity.errors import InputError
from asperity.protocols.legs import Leg

_SAME_TIME = 1e-9
"""Relative difference of a sum of durations and an equal time."""


@dataclass(frozen=True)
class Schedule:
    """Legs, repetitions written out, and the times at which they begin and end: one more, the first 0."""

    legs: tuple[Leg, ...]
    switches: tuple[float, ...]

    @classmethod
    def of(cls, protocol: Iterable[Leg], times: np.ndarray) -> Schedule:
        """Lay out legs; a switch that is one of the times but for rounding is that time.

        `InputError` if some time is after the end.
        """
        legs = tuple(protocol)
        switches = [0.0]
        for end in accumulate(leg.duration for leg in legs):
            near = times[np.searchsorted(times, end - _SAME_TIME * end) :][:1]
            switches.append(float(near[0]) if near.size and near[0] <= end + _SAME_TIME * end else end)
        if times.size and times[-1] > switches[-1]:
            expected = f"times up to {switches[-1]:g}, where the protocol ends"
            advice = "a longer last Hold, or fewer times"
            raise InputError("times", expected=expected, got=f"{times[-1]:g}", advice=advice)
        return cls(legs, tuple(switches))

    @property
    def holds_separation(self) -> bool:
        """Whether the rigid body is held or moved in some leg."""
        return any(leg.moves_the_body for leg in self.legs)

    @property
    def slides(self) -> bool:
        """Whether the rough surface slides in some leg."""
        return any(leg.speed for leg in self.legs)
