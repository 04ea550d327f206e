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

_STEP, _ROUNDED = 1e-4, 1e-14
"""Relative step of a difference quotient, and part of a velocity that rounding may change."""


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
        self._check_at(1.0)

    def check_stress(self, greatest: float) -> None:
        """See `LocalCreep`; the derivative is checked up to that stress too."""
        super().check_stress(greatest)
        if greatest > 0:
            self._check_at(greatest)

    def _check_at(self, scale: float) -> None:
        """Check both functions at stresses over six decades up to a scale."""
        half = scale * np.logspace(-6, 0, 49)
        probe = np.concatenate([-half[::-1], [0.0], half])
        value, slope = self.velocity(probe)
        advice = "CreepLaw(lambda s: s**3, lambda s: 3 * s**2)"
        if not (value[49] == 0 and (np.diff(value) >= 0).all() and (slope >= 0).all()):
            expected = "a function that is 0 at 0 and falls nowhere, with its derivative"
            raise InputError("rate", expected=expected, got="another one", advice=advice)
        step = _STEP * np.where(probe == 0, scale, probe)
        quotient = (self.velocity(probe + step)[0] - self.velocity(probe - step)[0]) / (2 * step)
        lost = _ROUNDED * np.abs(value / step)  # to rounding, in the difference
        off = (np.abs(quotient - slope) > 0.1 * np.maximum(quotient, slope) + lost) & (probe != 0)
        if np.count_nonzero(off) > 2:  # one may be a kink on either side
            worst = np.flatnonzero(off)[-1]
            expected = f"the derivative of the rate, {quotient[worst]:.3g} at the stress {probe[worst]:.3g}"
            raise InputError("derivative", expected=expected, got=f"{slope[worst]:.3g}", advice=advice)

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
