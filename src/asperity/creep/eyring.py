"""Thermally activated creep."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from annotated_types import Gt

from asperity.base import units
from asperity.base.checks import Floats
from asperity.base.parameters import Quantity
from asperity.creep.law import LARGEST_EXPONENT, LocalCreep, Rate, Stress
from asperity.errors import InputError

_BOLTZMANN = 1.380649e-23
"""J/K, exact in the SI; without scipy, whose import would delay the help of commands."""

_SMALLEST_RATE = 1e-290
"""Rate below which double precision loses digits."""


_Positive = Annotated[float | str, Gt(0)]


@dataclass(frozen=True)
class Eyring(LocalCreep):
    r"""Thermally activated creep: v(s) = v0 sinh(s/s0).

    Parameters
    ----------
    rate
        v0, velocity > 0; on a continuum in m/s, or a text with a unit.
    stress
        s0 > 0: a force on the lattice of springs; on a continuum a pressure, in Pa or a text with a unit.

    Raises
    ------
    InputError
        A number is not positive and finite.

    Notes
    -----
    Small stresses s << s0 creep with the mobility v0/s0, as with ``R_viscous=v0/s0``.

    References
    ----------
    H. Eyring, J. Chem. Phys. 4, 283 (1936), DOI 10.1063/1.1749836.
    """

    rate: Rate
    stress: Stress

    formula = "v0 sinh(s/s0)"

    if TYPE_CHECKING:

        def __init__(self, rate: float | str, stress: float | str) -> None: ...

    @classmethod
    def activated(
        cls,
        *,
        energy: Annotated[
            _Positive,
            Quantity(
                "energy of activation Q; with the next three keys v0 = prefactor exp(-Q/kT) and "
                "s0 = kT/volume.",
                "J",
            ),
        ],
        volume: Annotated[_Positive, Quantity("volume of activation", "m^3")],
        temperature: Annotated[_Positive, Quantity("temperature of thermally activated creep.", "K")],
        prefactor: Annotated[
            _Positive, Quantity("velocity of creep at infinite temperature, v0 far above Q = kT.", "m/s")
        ],
    ) -> Eyring:
        r"""From activation energy Q and volume Omega: v0 = prefactor exp(-Q/kT), s0 = kT/Omega.

        Parameters
        ----------
        energy
            Q without stress, J; a text may have another unit: ``"1 eV"``, ``"96 kJ/mol"``.
        volume
            Omega, m^3, or a text: ``"0.1 nm^3"``. s0 = kT/Omega, so the stress s does the work s Omega.
        temperature
            T, K, or a text: ``"20 degC"``.
        prefactor
            v0 where kT is far above Q, m/s: twice an attempt frequency times the length of a jump.

        Raises
        ------
        InputError
            A number is out of its range, or v0 is too small for a number in double precision.
        """
        thermal = _BOLTZMANN * units.number("temperature", temperature, "K", above=0)
        omega = units.number("volume", volume, "m^3", above=0)
        before = units.number("prefactor", prefactor, "m/s", above=0)
        barrier = units.number("energy", energy, "J", above=0)
        rate = before * math.exp(-barrier / thermal)
        if rate < _SMALLEST_RATE:
            expected, got = "an activation energy of at most some hundred kT", f"{barrier / thermal:.0f} kT"
            raise InputError("energy", expected=expected, got=got, advice="a higher temperature")
        return cls(rate, thermal / omega)

    @property
    def greatest_stress(self) -> float:  # type: ignore[override]
        """See `LocalCreep`."""
        return LARGEST_EXPONENT * self.stress

    def bend(self, stress: Floats) -> float:
        """See `LocalCreep`."""
        del stress
        return self.stress

    def velocity(self, stress: Floats) -> tuple[Floats, Floats]:
        """See `LocalCreep`; constant beyond `greatest_stress`, which is refused."""
        x = np.clip(stress / self.stress, -LARGEST_EXPONENT, LARGEST_EXPONENT)
        return self.rate * np.sinh(x), self.rate / self.stress * np.cosh(x)
