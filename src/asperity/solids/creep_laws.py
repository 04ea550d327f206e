r"""Laws of creep that are local and not linear: the velocity of the creeping shape under the stress there.

    d u0/dt = v(s),      v(0) = 0,      v does not fall as s grows

s is the force of the creeping springs at a site on the lattice of springs, and that force over the area of
a site on a continuum. Small stresses creep with the mobility v'(0), as with ``R_viscous``.
"""

from __future__ import annotations

import hashlib
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from asperity.base import checks, units
from asperity.errors import InputError
from asperity.lattice import Field

BOLTZMANN = 1.380649e-23
"""Boltzmann's constant, J/K (exact in the SI)."""

_AVOGADRO = 6.02214076e23
"""Avogadro's constant, 1/mol (exact in the SI)."""

LARGEST_EXPONENT = 600.0
"""Largest s/s0 that Eyring's law takes: sinh overflows at 710, and velocities are multiplied by times."""

_BLOCK = 2**13
"""Stresses taken at a time, which stay in the cache."""

_SMALLEST_RATE = 1e-290
"""Rate below which double precision loses digits."""


class LocalCreep(ABC):
    """A local law of creep."""

    greatest_stress: float = math.inf
    """Largest magnitude of the stress that the law takes."""

    smooth: bool = False
    """Whether `bend` bounds how fast the derivative changes: then it tells the error of a tangent."""

    @property
    @abstractmethod
    def parameters(self) -> Mapping[str, float]:
        """Numbers to record with every result."""

    @abstractmethod
    def velocity(self, stress: Field) -> tuple[Field, Field]:
        """Velocity v(s) and its derivative v'(s) >= 0 with respect to the stress."""

    def bend(self, stress: Field) -> Field | float:
        """Change of the stress over which the derivative changes by about its own size."""
        return 0.1 * np.abs(stress)

    def check_stress(self, greatest: float) -> None:
        """Refuse a stress beyond belief.

        Raises
        ------
        InputError
            ``greatest`` is more than the law takes, or its velocity there is not finite.
        """
        limit = self.greatest_stress
        with np.errstate(over="ignore", invalid="ignore"):
            known = greatest <= limit and np.isfinite(self.velocity(np.array([greatest]))).all()
        if not known:
            most = f"of at most {limit:.3g}" if math.isfinite(limit) else "at which its velocity is finite"
            raise InputError(
                "creep",
                expected=f"stresses {most}, for its velocities leave the range of numbers beyond",
                got=f"{greatest:.3g}",
                advice="a hardness, a larger stress in the law (a smaller volume), or less load",
            )


@dataclass(frozen=True, init=False)
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

    rate: float
    stress: float
    smooth = True

    def __init__(self, rate: float | str, stress: float | str) -> None:
        object.__setattr__(self, "rate", units.number("rate", rate, "m/s", above=0))
        object.__setattr__(self, "stress", units.number("stress", stress, "Pa", above=0))

    @classmethod
    def activated(
        cls,
        *,
        energy: float | str,
        volume: float | str,
        temperature: float | str,
        prefactor: float | str,
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
        thermal = BOLTZMANN * units.number("temperature", temperature, "K", above=0)
        omega = units.number("volume", volume, "m^3", above=0)
        before = units.number("prefactor", prefactor, "m/s", above=0)
        barrier = joules(energy)
        rate = before * math.exp(-barrier / thermal)
        if rate < _SMALLEST_RATE:
            raise InputError(
                "energy",
                expected="an activation energy of at most some hundred kT",
                got=f"{barrier / thermal:.0f} kT",
                advice="a higher temperature",
            )
        return cls(rate, thermal / omega)

    @property
    def greatest_stress(self) -> float:  # type: ignore[override]
        """See `LocalCreep`."""
        return LARGEST_EXPONENT * self.stress

    @property
    def parameters(self) -> Mapping[str, float]:
        """See `LocalCreep`."""
        return {"creep_rate": self.rate, "creep_stress": self.stress}

    def bend(self, stress: Field) -> float:
        """See `LocalCreep`."""
        del stress
        return self.stress

    def velocity(self, stress: Field) -> tuple[Field, Field]:
        """See `LocalCreep`. Beyond `LARGEST_EXPONENT`, which is refused, it is that at it."""
        stress = np.ascontiguousarray(stress)
        rate, slope = np.empty_like(stress), np.empty_like(stress)
        flat = [field.reshape(-1) for field in (stress, rate, slope)]
        for start in range(0, stress.size, _BLOCK):
            s, v, dv = (field[start : start + _BLOCK] for field in flat)
            x = np.clip(s / self.stress, -LARGEST_EXPONENT, LARGEST_EXPONENT)
            np.sinh(x, out=v)
            np.cosh(x, out=dv)
            v *= self.rate
            dv *= self.rate / self.stress
        return rate, slope


@dataclass(frozen=True, init=False)
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

    rate: float
    stress: float
    exponent: float

    def __init__(self, rate: float | str, stress: float | str, exponent: float) -> None:
        object.__setattr__(self, "rate", units.number("rate", rate, "m/s", above=0))
        object.__setattr__(self, "stress", units.number("stress", stress, "Pa", above=0))
        object.__setattr__(self, "exponent", checks.number("exponent", exponent, least=1, most=100))

    @property
    def parameters(self) -> Mapping[str, float]:
        """See `LocalCreep`."""
        facts = {"creep_rate": self.rate, "creep_stress": self.stress}
        return facts | {"creep_exponent": self.exponent}

    def bend(self, stress: Field) -> Field:
        """See `LocalCreep`."""
        return np.abs(stress) / max(self.exponent - 1.0, 0.1)

    def velocity(self, stress: Field) -> tuple[Field, Field]:
        """See `LocalCreep`."""
        rate = np.abs(np.asarray(stress, dtype=float))
        rate /= self.stress
        slope = rate ** (self.exponent - 1.0)
        rate *= slope
        rate *= self.rate
        slope *= self.rate * self.exponent / self.stress
        return np.copysign(rate, stress), slope


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

    rate: Callable[[Field], Field]
    derivative: Callable[[Field], Field]

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

    @property
    def parameters(self) -> Mapping[str, float]:
        """None that are known."""
        return {}

    def velocity(self, stress: Field) -> tuple[Field, Field]:
        """See `LocalCreep`."""
        found = []
        for name, function in (("rate", self.rate), ("derivative", self.derivative)):
            values = checks.floats(name, function(stress))
            if values.shape != stress.shape:
                raise InputError(name, expected=f"an array of shape {stress.shape}", got=values.shape)
            found.append(values)
        return found[0], found[1]


def checked_law(creep: LocalCreep) -> LocalCreep:
    """Take a local law of creep and nothing else."""
    if not isinstance(creep, LocalCreep):
        raise InputError(
            "creep",
            expected="a law of creep",
            got=checks.kind_of(creep),
            advice="asperity.solids.Eyring(rate=1.0, stress=1.0)",
        )
    return creep


def fingerprint_of_law(law: LocalCreep) -> str:
    """What tells one law from another: its numbers, or its values at many stresses."""
    if not isinstance(law, CreepLaw):
        return repr(law)
    stresses = np.concatenate([-np.logspace(6, -6, 97), np.logspace(-6, 6, 97)])
    with np.errstate(all="ignore"):
        values = np.concatenate([law.rate(stresses), law.derivative(stresses)])
    return hashlib.sha256(values.tobytes()).hexdigest()


def joules(energy: float | str) -> float:
    """An energy of activation in joules, from one for each mole where the text says so."""
    if isinstance(energy, str) and "mol" in energy:
        return units.number("energy", energy, "J/mol", above=0) / _AVOGADRO
    return units.number("energy", energy, "J", above=0)
