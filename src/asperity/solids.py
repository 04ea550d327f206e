r"""A solid is three spectra: permanent stiffness H, creeping stiffness C, mobility M.

    E = 1/2 sum_q [ H |u|^2 + C |u - u0|^2 ],        d u0/dt = M C (u - u0)

where u is the height of the elastic surface and u0 its slow, creeping shape (Jagla, Eqs. e and
dosrs). H vanishes at wave vector 0: a rigid translation of u costs nothing, so the whole normal
load passes through C.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from asperity.errors import InputError, is_finite_number
from asperity.lattice import Lattice, Spectrum

SpectrumOf = Callable[[Lattice], Spectrum]


@dataclass(frozen=True)
class LaplacianSpectrum:
    """The spectrum ``laplacian * lam(q) + uniform``: springs to the neighbors and to the bulk."""

    laplacian: float = 0.0
    uniform: float = 0.0

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice."""
        return self.laplacian * lattice.lam + self.uniform


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
    """

    permanent: SpectrumOf
    branches: tuple[CreepBranch, ...]
    parameters: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if len(self.branches) != 1:
            raise InputError(
                "branches", expected="exactly one creeping branch", got=f"{len(self.branches)} branches"
            )

    def on(self, lattice: Lattice) -> Spectra:
        """Evaluate the spectra on a lattice.

        Raises
        ------
        InputError
            A spectrum is negative or not finite, H does not vanish at wave vector 0, C does (then no
            load can be carried), or H + C vanishes somewhere.
        """
        (branch,) = self.branches
        spectra = {
            "permanent stiffness": self.permanent(lattice),
            "creeping stiffness": branch.stiffness(lattice),
            "mobility": branch.mobility(lattice),
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
        if C.flat[0] == 0:
            raise InputError(
                "creeping stiffness",
                expected="more than 0 at wave vector 0: the normal load passes through it",
                got="0, so no load can be carried",
                advice="k1 > 0",
            )
        if not (H + C > 0).all():
            raise InputError("stiffness", expected="H + C > 0 at every wave vector", got="0 at some")
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
    parameters = {"k0": k0, "k1": k1, "R": R, "R_viscous": R_viscous}
    for name, value in parameters.items():
        if not (is_finite_number(value) and value >= 0):
            raise InputError(name, expected="a finite number >= 0", got=repr(value))
    if k0 == 0 and k1 == 0:
        raise InputError("k0 and k1", expected="a stiffness above 0", got="both 0", advice="k0=1.0, k1=3.0")
    return Solid(
        permanent=LaplacianSpectrum(laplacian=float(k0)),
        branches=(
            CreepBranch(
                stiffness=LaplacianSpectrum(uniform=float(k1)),
                mobility=LaplacianSpectrum(laplacian=float(R), uniform=float(R_viscous)),
            ),
        ),
        parameters={name: float(value) for name, value in parameters.items()},
    )
