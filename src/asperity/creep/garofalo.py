"""Creep by a power of the hyperbolic sine of the stress."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from asperity.base.checks import Floats
from asperity.creep.law import LARGEST_EXPONENT, LocalCreep, Rate, Stress
from asperity.creep.norton import Exponent


@dataclass(frozen=True)
class Garofalo(LocalCreep):
    r"""From a power law at small stresses to an exponential: v(s) = v0 sign(s) sinh(abs(s)/s0)^n.

    Parameters
    ----------
    rate
        v0, velocity > 0; on a continuum in m/s, or a text with a unit.
    stress
        s0 > 0: a force on the lattice of springs, a pressure on a continuum.
    exponent
        n, from 1 to 100.

    Raises
    ------
    InputError
        A number is out of its range.

    Notes
    -----
    It is `Norton` while s << s0, and with n = 1 `Eyring`.

    References
    ----------
    F. Garofalo, Trans. Metall. Soc. AIME 227, 351 (1963).
    """

    rate: Rate
    stress: Stress
    exponent: Exponent

    formula = "v0 sinh(s/s0)^n"

    if TYPE_CHECKING:

        def __init__(self, rate: float | str, stress: float | str, exponent: float) -> None: ...

    @property
    def greatest_stress(self) -> float:  # type: ignore[override]
        """See `LocalCreep`."""
        return LARGEST_EXPONENT / self.exponent * self.stress

    def bend(self, stress: Floats) -> Floats:
        """See `LocalCreep`."""
        rise = np.maximum(np.tanh(np.abs(stress) / self.stress), 1e-300)
        return np.asarray(self.stress * rise / (self.exponent - 1.0 + rise))

    def velocity(self, stress: Floats) -> tuple[Floats, Floats]:
        """See `LocalCreep`; constant beyond `greatest_stress`, which is refused."""
        x = np.minimum(np.abs(stress) / self.stress, LARGEST_EXPONENT / self.exponent)
        sine = np.sinh(x)
        power = sine ** (self.exponent - 1.0)
        slope = self.rate * self.exponent / self.stress * power * np.cosh(x)
        return np.copysign(self.rate * power * sine, stress), slope
