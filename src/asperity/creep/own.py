"""A law of creep of two functions."""

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
    """A law of creep from its velocity and derivative.

    Parameters
    ----------
    rate
        v: stresses -> velocities, arrays; 0 at 0, and nowhere falling.
    derivative
        v': stresses -> derivatives >= 0, arrays.

    A class derived from `LocalCreep` has both in one method, ``velocity``.

    Raises
    ------
    InputError
        The functions are wrong at stresses up to 1; or, in use, up to the greatest one of the contact.
    """

    rate: Callable[[Floats], Floats]
    derivative: Callable[[Floats], Floats]

    def __post_init__(self) -> None:
        self.check_at(1.0)

    def fingerprint(self) -> str:
        """Its values at many stresses."""
        stresses = np.concatenate([-np.logspace(6, -6, 97), np.logspace(-6, 6, 97)])
        with np.errstate(all="ignore"):
            values = np.concatenate([self.rate(stresses), self.derivative(stresses)])
        return hashlib.sha256(values.tobytes()).hexdigest()

    def velocity(self, stress: Floats) -> tuple[Floats, Floats]:
        """See `LocalCreep`."""
        velocity, slope = checks.floats("rate", self.rate(stress)), self.derivative(stress)
        slope = checks.floats("derivative", slope)
        for name, values in (("rate", velocity), ("derivative", slope)):
            if values.shape != stress.shape:
                raise InputError(name, expected=f"an array of shape {stress.shape}", got=values.shape)
        return velocity, slope
