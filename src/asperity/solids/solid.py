r"""A solid is a permanent stiffness H and branches, each of a creeping stiffness C_b and a mobility M_b.

    r = H u + sum_b C_b (u - u_b),        d u_b/dt = M_b C_b (u - u_b)

where u is the height of the elastic surface, r the force on it, and u_b the slow, creeping shape of branch
b (Jagla, Eqs. e and dosrs, has one). All are spectra. At wave vector 0 the surface hangs on the rigid body,
by H and C_b there; where they vanish, as on a half-space, the load is applied from afar, evenly.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from asperity.base import checks, units, views
from asperity.base.words import InUnits
from asperity.creep import LocalCreep
from asperity.errors import InputError
from asperity.lattice import Lattice, Spectrum
from asperity.solids.laws import FixedRate, LaplacianSpectrum, Scaled, SpectrumOf, WithApparatus

Parameters = Mapping[str, float | tuple[float, ...] | tuple[tuple[float, float], ...]]


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
    """The spectra of a solid on one lattice; branches are the first axis.

    Attributes
    ----------
    permanent
        H, of shape `Lattice.spectral_shape`.
    creeping
        C_b, shape ``(branches, *spectral_shape)``.
    rate
        M_b C_b, the rate at which a mode of branch b creeps at a given u; the same shape.
    mean_mobility
        M_b at wave vector 0, shape (branches,).
    """

    permanent: Spectrum
    creeping: Spectrum
    rate: Spectrum
    mean_mobility: NDArray[np.float64]


@dataclass(frozen=True)
class Springs:
    """The lattice of springs: a force k0 L u + k1 w, and a creep of u - w at the rate spread L w + drag w.

    L is minus the Laplacian, and w the stretch of the springs to the bulk. In terms of the mobilities,
    ``spread`` is k1 R and ``drag`` k1 R_viscous: rates, or of an implicit step that times its duration.
    """

    k0: float
    k1: float
    spread: float = 0.0
    drag: float = 0.0

    @property
    def creep(self) -> bool:
        """Whether anything creeps."""
        return self.spread > 0 or self.drag > 0

    @property
    def relaxed(self) -> bool:
        """Whether the springs to the bulk have relaxed altogether, in an infinite step."""
        return math.isinf(max(self.spread, self.drag))

    def step(self, tau: float) -> Springs:
        """What an implicit step of duration tau makes of rates; it may be infinite."""
        spread, drag = (tau * rate if rate > 0 else 0.0 for rate in (self.spread, self.drag))
        return Springs(self.k0, self.k1, spread, drag)


@dataclass(frozen=True)
class Solid(views.InNotebooks):
    """An elastic solid whose surface creeps; see the module for the equations.

    Parameters
    ----------
    permanent
        H: lattice -> spectrum, force per length.
    branches
        The creeping branches; none where nothing creeps.
    parameters
        Numbers to record with every result.
    loaded_from_afar
        Whether the normal load is applied evenly from far away where nothing hangs on the rigid body:
        H and all C vanish at wave vector 0.
    in_lengths
        Whether the spectra depend on the spacing of the sites: a continuum, which takes surfaces with units
        in metres. Else the solid is defined on sites, whose spacing is 1.
    creep
        A local law of creep of the only branch, beside its mobility; see `asperity.creep.law`.
    hardness
        Pressure that contacts do not exceed, for they yield under it; on a solid that is defined on sites,
        the force of a site. See `Solid.with_hardness`.
    kind
        Name of the function that built it.
    """

    permanent: SpectrumOf
    branches: tuple[CreepBranch, ...] = ()
    parameters: Parameters = field(default_factory=dict, hash=False)
    loaded_from_afar: bool = False
    in_lengths: bool = False
    creep: LocalCreep | None = None
    hardness: float = math.inf
    kind: str = field(default="of own spectra", compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "branches", tuple(self.branches))
        object.__setattr__(self, "parameters", dict(self.parameters))
        if self.creep is not None and len(self.branches) != 1:
            raise InputError("creep", expected="a solid of one branch", got=f"{len(self.branches)} branches")

    def with_hardness(self, hardness: float | str | None = None) -> Solid:
        """Return the solid that yields plastically under a pressure.

        Where the pressure reaches the hardness the rough surface is lowered for good, each site for itself:
        matter is neither piled up beside it nor kept.

        Parameters
        ----------
        hardness
            A pressure > 0, in Pa or with a unit under a surface with units: ``"0.3 GPa"``; on the lattice of
            springs the force of a site. None returns the solid as it is.

        Raises
        ------
        InputError
            It is not positive and finite.

        References
        ----------
        A. Almqvist, F. Sahlin, R. Larsson, S. Glavatskih, Tribol. Int. 40, 574 (2007),
        DOI 10.1016/j.triboint.2005.11.008.
        """
        if hardness is None:
            return self
        hardness = units.number("hardness", hardness, "Pa", above=0)
        return replace(self, hardness=hardness, parameters={**self.parameters, "hardness": hardness})

    def __repr__(self) -> str:
        parameters = ", ".join(_shown(name, value) for name, value in self.parameters.items())
        return f"<Solid: {self.kind}{', ' * bool(parameters)}{parameters}>"

    @property
    def yields(self) -> bool:
        """Whether pressures have a bound."""
        return math.isfinite(self.hardness)

    @property
    def springs(self) -> Springs | None:
        """The spring constants, if this is Jagla's lattice of springs and nothing else."""
        match self.permanent, *self.branches:
            case LaplacianSpectrum(k0, 0), CreepBranch(
                LaplacianSpectrum(0, k1), LaplacianSpectrum(R, viscous)
            ):
                return Springs(k0, k1, k1 * R, k1 * viscous)
        return None

    @property
    def separable(self) -> bool:
        """Whether relaxation does not depend on the wavelength, as far as the laws show.

        All stiffnesses are then multiples of one law, and each branch relaxes at one rate. Under a load that
        never falls the contact is that of an elastic solid at another load (E. H. Lee, J. R. M. Radok,
        J. Appl. Mech. 27, 438 (1960), DOI 10.1115/1.3644020; T. C. T. Ting, J. Appl. Mech. 33, 845 (1966),
        DOI 10.1115/1.3625192), and no site loses contact after the load has fallen.
        """
        if self.creep is not None or self.yields:
            return False
        permanent = self.permanent.law if isinstance(self.permanent, WithApparatus) else self.permanent
        laws = [permanent, *(branch.stiffness for branch in self.branches)]
        one = {law.law if isinstance(law, Scaled) else law for law in laws}
        return len(one) == 1 and all(isinstance(branch.mobility, FixedRate) for branch in self.branches)

    def on(self, lattice: Lattice) -> Spectra:
        """Evaluate the spectra on a lattice.

        Raises
        ------
        InputError
            A spectrum is negative or not finite, nothing carries the load at wave vector 0 (unless it comes
            from afar), or H + sum of C vanishes elsewhere.
        """
        permanent = _checked("permanent stiffness", self.permanent, lattice)
        shape = (len(self.branches), *lattice.spectral_shape)
        creeping, rate, means = np.empty(shape), np.empty(shape), np.empty(shape[0])
        for number, branch in enumerate(self.branches):
            which = f" of branch {number}" if shape[0] > 1 else ""
            creeping[number] = _checked(f"creeping stiffness{which}", branch.stiffness, lattice)
            mobility = _checked(f"mobility{which}", branch.mobility, lattice)
            np.multiply(mobility, creeping[number], out=rate[number])
            means[number] = mobility.flat[0]
        whole = permanent + creeping.sum(axis=0)
        if whole.flat[0] == 0 and not self.loaded_from_afar:
            raise InputError(
                "creeping stiffness",
                expected="more than 0 at wave vector 0: the normal load passes through it",
                got="0, so no load can be carried",
                advice="k1 > 0",
            )
        if not whole.flat[1:].all():
            raise InputError("stiffness", expected="H + C > 0 at every wave vector but 0", got="0 at some")
        return Spectra(permanent, creeping, rate, means)


def _checked(name: str, law: SpectrumOf, lattice: Lattice) -> Spectrum:
    values = checks.floats(name, law(lattice), expected="a finite spectrum >= 0")
    if values.shape != lattice.spectral_shape:
        raise InputError(name, expected=f"shape {lattice.spectral_shape}", got=values.shape)
    if not (np.isfinite(values).all() and (values >= 0).all()):
        raise InputError(name, expected="a finite spectrum >= 0", got=f"minimum {values.min()}")
    return values


def _shown(name: str, value: object) -> str:
    if name.endswith("branches"):
        count = len(list(value))  # type: ignore[call-overload]
        return f"{count} {name if count != 1 else name.removesuffix('es')}"
    if isinstance(value, InUnits):
        return f"{name} {value:.4g} {value.unit}"
    return f"{name} {value:g}" if isinstance(value, float) and math.isfinite(value) else f"{name} {value}"
