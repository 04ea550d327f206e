"""A law of creep that is given by functions."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.creep.law import LocalCreep
from asperity.errors import InputError


@dataclass(frozen=True)
class CreepLaw(LocalCreep):
    """A law of your own.

    Parameters
    ----------
    rate
        v: stresses -> velocities, arrays; 0 at 0, and nowhere falling.
    derivative
        v': stresses -> derivatives >= 0, arrays.

    Raises
    ------
    InputError
        The functions give something else at a few stresses about 0.
    """

    rate: Callable[[Floats], Floats]
    derivative: Callable[[Floats], Floats]

    def __post_init__(self) -> None:
        probe = np.concatenate([-np.logspace(0, -6, 7), [0.0], np.logspace(-6, 0, 7)])
        value, slope = self.velocity(probe)
        if not (value[7] == 0 and (np.diff(value) >= 0).all() and (slope >= 0).all()):
            raise InputError(
                "rate",
                expected="a function that is 0 at 0 and falls nowhere, with its derivative",
                got="another one",
                advice="CreepLaw(lambda s: s**3, lambda s: 3 * s**2)",
            )

    def fingerprint(self) -> str:
        """Its values at many stresses."""
        stresses = np.concatenate([-np.logspace(6, -6, 97), np.logspace(-6, 6, 97)])
        with np.errstate(all="ignore"):
            values = np.concatenate([self.rate(stresses), self.derivative(stresses)])
        return hashlib.sha256(values.tobytes()).hexdigest()

    def velocity(self, stress: Floats) -> tuple[Floats, Floats]:
        """See `LocalCreep`."""
        found = []
        for name, function in (("rate", self.rate), ("derivative", self.derivative)):
            values = checks.floats(name, function(stress))
            if values.shape != stress.shape:
                raise InputError(name, expected=f"an array of shape {stress.shape}", got=values.shape)
            found.append(values)
        return found[0], found[1]
