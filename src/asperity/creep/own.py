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

    A class derived from `LocalCreep` says both in one method, ``velocity``.

    Raises
    ------
    InputError
        The functions give something else at stresses up to 1; or, when it is used, up to those of a contact.
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
        found = []
        for name, function in (("rate", self.rate), ("derivative", self.derivative)):
            values = checks.floats(name, function(stress))
            if values.shape != stress.shape:
                raise InputError(name, expected=f"an array of shape {stress.shape}", got=values.shape)
            found.append(values)
        return found[0], found[1]
