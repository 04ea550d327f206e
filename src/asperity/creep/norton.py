"""Creep by a power of the stress."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from annotated_types import Ge, Le

from asperity.base.checks import Floats
from asperity.base.parameters import Quantity
from asperity.creep.law import LocalCreep, Rate, Stress

Exponent = Annotated[float, Ge(1), Le(100), Quantity("exponent", symbol="n")]


@dataclass(frozen=True)
class Norton(LocalCreep):
    r"""A power law: v(s) = v0 sign(s) (abs(s)/s0)^n.

    Parameters
    ----------
    rate
        v0, velocity > 0, under the stress s0; on a continuum in m/s, or a text with a unit.
    stress
        s0 > 0: a force on the lattice of springs, a pressure on a continuum.
    exponent
        n, from 1 to 100.

    Raises
    ------
    InputError
        A number is out of its range.

    References
    ----------
    F. H. Norton, *The Creep of Steel at High Temperatures* (McGraw-Hill 1929).
    """

    rate: Rate
    stress: Stress
    exponent: Exponent

    formula = "v0 (s/s0)^n"

    if TYPE_CHECKING:

        def __init__(self, rate: float | str, stress: float | str, exponent: float) -> None: ...

    def bend(self, stress: Floats) -> Floats:
        """See `LocalCreep`."""
        return np.abs(stress) / max(self.exponent - 1.0, 0.1)

    def velocity(self, stress: Floats) -> tuple[Floats, Floats]:
        """See `LocalCreep`."""
        x = np.abs(stress) / self.stress
        power = x ** (self.exponent - 1.0)
        slope = self.rate * self.exponent / self.stress * power
        return np.copysign(x * power * self.rate, stress), slope
