r"""A solid is three spectra: permanent stiffness H, creeping stiffness C, mobility M.

    E = 1/2 sum_q [ H |u|^2 + C |u - u0|^2 ],        d u0/dt = M C (u - u0)

where u is the height of the elastic surface and u0 its slow, creeping shape (Jagla, Eqs. e and
dosrs). H vanishes at wave vector 0: a rigid translation of u costs nothing, so the whole normal
load passes through C. On a half-space C vanishes there too, and the load is applied from afar, evenly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields

import numpy as np

import asperity.checks as checks
from asperity.errors import LARGEST, InputError
from asperity.lattice import Lattice, Spectrum

__all__ = [
    "CreepBranch",
    "FixedRate",
    "LaplacianSpectrum",
    "Solid",
    "Spectra",
    "SpringConstants",
    "WaveNumberSpectrum",
    "half_space",
    "spring_lattice",
]

SpectrumOf = Callable[[Lattice], Spectrum]


def __dir__() -> list[str]:
    """List the public names."""
    return __all__


class _Numbers:
    """A dataclass whose fields that are called numbers become Python floats."""

    def __post_init__(self) -> None:
        for field_ in fields(self):  # type: ignore[arg-type]
            if field_.type == "float":
                value = checks.number(field_.name, getattr(self, field_.name))
                object.__setattr__(self, field_.name, value)


@dataclass(frozen=True)
class LaplacianSpectrum(_Numbers):
    """The spectrum ``laplacian * lam(q) + uniform``: springs to the neighbors and to the bulk."""

    laplacian: float = 0.0
    uniform: float = 0.0

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice."""
        return self.laplacian * lattice.lam + self.uniform


@dataclass(frozen=True)
class WaveNumberSpectrum(_Numbers):
    """The spectrum ``slope * abs(q)``: a half-space under normal load."""

    slope: float

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice."""
        return np.asarray(self.slope * np.sqrt(sum(q**2 for q in lattice.wave_numbers)))


@dataclass(frozen=True)
class FixedRate(_Numbers):
    """The mobility with which a branch relaxes at one rate at every wave vector: ``rate / C``, or 0."""

    rate: float
    stiffness: SpectrumOf

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice."""
        stiffness = self.stiffness(lattice)
        return np.divide(self.rate, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0)


@dataclass(frozen=True)
class CreepBranch:
    """One creeping branch: a stiffness C in series with a creeping element of mobility M.

    Parameters
    ----------
    stiffness
        C: lattice -> spectrum, force per length.
    mobility
        M: lattice -> spectrum, velocity per force.
    """

    stiffness: SpectrumOf
    mobility: SpectrumOf


@dataclass(frozen=True)
class Spectra:
    """The spectra of a solid on one lattice, each of shape `Lattice.spectral_shape`."""

    permanent: Spectrum
    creeping: Spectrum
    mobility: Spectrum


@dataclass(frozen=True)
class SpringConstants(_Numbers):
    """The lattice of springs: H = k0 lam, C = k1, M = R lam + R_viscous."""

    k0: float
    k1: float
    R: float
    R_viscous: float

    @property
    def creep(self) -> bool:
        """Whether anything creeps."""
        return self.R > 0 or self.R_viscous > 0


@dataclass(frozen=True)
class Solid:
    """An elastic solid whose surface creeps; see the module for the equations.

    Parameters
    ----------
    permanent
        H: lattice -> spectrum, force per length; zero at wave vector 0.
    branches
        The creeping branches. Exactly one, for now; a generalized Maxwell solid will have several.
    parameters
        Numbers to record with every result.
    loaded_from_afar
        Whether the normal load is applied evenly from far away rather than through C at wave vector 0,
        which may then vanish.
    kind
        Name of the function that built it.
    """

    permanent: SpectrumOf
    branches: tuple[CreepBranch, ...]
    parameters: Mapping[str, float] = field(default_factory=dict, hash=False)
    loaded_from_afar: bool = False
    kind: str = field(default="of own spectra", compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "branches", tuple(self.branches))
        parameters = {name: checks.number(name, value) for name, value in self.parameters.items()}
        object.__setattr__(self, "parameters", parameters)
        if len(self.branches) != 1:
            raise InputError(
                "branches", expected="exactly one creeping branch", got=f"{len(self.branches)} branches"
            )

    def __repr__(self) -> str:
        parameters = ", ".join(f"{name} {value:g}" for name, value in self.parameters.items())
        return f"<Solid: {self.kind}{', ' * bool(parameters)}{parameters}>"

    @property
    def springs(self) -> SpringConstants | None:
        """The spring constants, if this is Jagla's lattice of springs and nothing else."""
        (branch,) = self.branches
        H, C, M = self.permanent, branch.stiffness, branch.mobility
        if not (
            isinstance(H, LaplacianSpectrum)
            and isinstance(C, LaplacianSpectrum)
            and isinstance(M, LaplacianSpectrum)
            and H.uniform == C.laplacian == 0
        ):
            return None
        return SpringConstants(H.laplacian, C.uniform, M.laplacian, M.uniform)

    def on(self, lattice: Lattice) -> Spectra:
        """Evaluate the spectra on a lattice.

        Raises
        ------
        InputError
            A spectrum is negative or not finite, H does not vanish at wave vector 0, C does (then no
            load can be carried, unless from afar), or H + C vanishes elsewhere.
        """
        (branch,) = self.branches
        laws = {
            "permanent stiffness": self.permanent,
            "creeping stiffness": branch.stiffness,
            "mobility": branch.mobility,
        }
        spectra = {
            name: checks.floats(name, law(lattice), expected="a finite spectrum >= 0")
            for name, law in laws.items()
        }
        for name, values in spectra.items():
            if values.shape != lattice.spectral_shape:
                raise InputError(name, expected=f"shape {lattice.spectral_shape}", got=values.shape)
            if not (np.isfinite(values).all() and (values >= 0).all()):
                raise InputError(name, expected="a finite spectrum >= 0", got=f"minimum {values.min()}")
        H, C, M = spectra.values()
        if H.flat[0] != 0:
            raise InputError(
                "permanent stiffness", expected="0 at wave vector 0 (translations are free)", got=H.flat[0]
            )
        if C.flat[0] == 0 and not self.loaded_from_afar:
            raise InputError(
                "creeping stiffness",
                expected="more than 0 at wave vector 0: the normal load passes through it",
                got="0, so no load can be carried",
                advice="k1 > 0",
            )
        if not (H + C).flat[1:].all():
            raise InputError("stiffness", expected="H + C > 0 at every wave vector but 0", got="0 at some")
        return Spectra(H, C, M)


def spring_lattice(*, k0: float, k1: float, R: float = 1.0, R_viscous: float = 0.0) -> Solid:
    r"""Build Jagla's lattice of springs (Eqs. e and dosrs).

    Parameters
    ----------
    k0
        Stiffness of the springs between nearest neighbors, force per length; H = k0 lam(q). With
        ``k0=0`` the surface is a bed of independent springs.
    k1
        Stiffness of the springs to the bulk, force per length; C = k1. With ``k1=0`` there is nothing
        through which to press: `asperity.press` refuses.
    R
        Mobility of creep that conserves the mean of u0, velocity per force; M = R lam(q) + R_viscous.
    R_viscous
        Mobility of viscous creep, the paper's :math:`\tilde R`, velocity per force.

    Returns
    -------
    Solid

    Raises
    ------
    InputError
        A value is negative or not finite, or both stiffnesses are zero.

    References
    ----------
    E. A. Jagla, "Towards a modeling of the time dependence of contact area between solid bodies".
    """
    parameters = {
        name: checks.number(name, value, least=0)
        for name, value in {"k0": k0, "k1": k1, "R": R, "R_viscous": R_viscous}.items()
    }
    k0, k1, R, R_viscous = parameters.values()
    if k0 == 0 and k1 == 0:
        raise InputError("k0 and k1", expected="a stiffness above 0", got="both 0", advice="k0=1.0, k1=3.0")
    return Solid(
        permanent=LaplacianSpectrum(laplacian=k0),
        branches=(
            CreepBranch(
                stiffness=LaplacianSpectrum(uniform=k1),
                mobility=LaplacianSpectrum(laplacian=R, uniform=R_viscous),
            ),
        ),
        parameters=parameters,
        kind="spring_lattice",
    )


def half_space(*, modulus: float, creeping: float = 0.0, relaxation_time: float = 1.0) -> Solid:
    r"""Build an elastic half-space, part of which may creep; sites have spacing 1.

    A periodic pressure of wave vector q on a half-space displaces its surface by 2 / (E* abs(q)) of it, so
    the stiffness is E* abs(q) / 2. Of this the share ``creeping`` relaxes, at every wave vector with the
    same time, and the rest is permanent: a standard linear (Zener) solid.

        H = (1 - creeping) E* abs(q) / 2,    C = creeping E* abs(q) / 2,    M = 1 / (relaxation_time C)

    Nothing holds the mean of the surface: the load is held, not the separation, and u0 has the mean of u.

    Parameters
    ----------
    modulus
        Contact modulus E*, force per area: E / (1 - nu**2) if the other body is rigid.
    creeping
        Share of the stiffness that relaxes, from 0 to 1.
    relaxation_time
        Time in which it relaxes at constant deformation.

    Returns
    -------
    Solid

    Raises
    ------
    InputError
        The modulus or the time is not positive and finite, or the share is not between 0 and 1.

    References
    ----------
    K. L. Johnson, *Contact Mechanics* (Cambridge 1985), section 13.2, DOI 10.1017/CBO9781139171731.
    """
    modulus = checks.number("modulus", modulus, above=0)
    creeping = checks.number("creeping", creeping, least=0, most=1, expected="a number from 0 to 1")
    relaxation_time = checks.number(
        "relaxation_time", relaxation_time, least=1 / LARGEST, expected="a finite number > 0"
    )
    stiffness = WaveNumberSpectrum(creeping * modulus / 2)
    return Solid(
        permanent=WaveNumberSpectrum((1 - creeping) * modulus / 2),
        branches=(CreepBranch(stiffness=stiffness, mobility=FixedRate(1 / relaxation_time, stiffness)),),
        parameters={"modulus": modulus, "creeping": creeping, "relaxation_time": relaxation_time},
        loaded_from_afar=True,
        kind="half_space",
    )
