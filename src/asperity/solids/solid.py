r"""A solid is a permanent stiffness H and branches, each of a creeping stiffness C_b and a mobility M_b.

    r = H u + sum_b C_b (u - u_b),        d u_b/dt = M_b C_b (u - u_b)

where u is the height of the elastic surface, r the force on it, and u_b the slow, creeping shape of branch
b (Jagla, Eqs. e and dosrs, has one). All are spectra. At wave vector 0 the surface hangs on the rigid body,
by H and C_b there; where they vanish, as on a half-space, the load is applied from afar, evenly.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from typing import Any, cast

import numpy as np

from asperity.adhesion import Adhesion, checked_adhesion
from asperity.base import checks, units, views
from asperity.base.words import InUnits
from asperity.creep import LocalCreep
from asperity.errors import InputError
from asperity.lattice import Lattice, Modes, Spectrum
from asperity.solids.branches import check_branches
from asperity.solids.laws import RIGID, LaplacianSpectrum, Scaled, SpectrumOf

Parameters = Mapping[str, float | tuple[float, ...] | tuple[tuple[float, float], ...]]

Shares = Sequence[tuple[float, float]]
"""Pairs of a share of the instantaneous stiffness and the time in which it relaxes."""


@dataclass(frozen=True)
class CreepBranch:
    """One creeping branch: a stiffness C in series with a creeping element of mobility M.

    Parameters
    ----------
    stiffness
        C: lattice -> spectrum, force per length.
    mobility
        M: lattice -> spectrum, velocity per force.
    time
        Without a mobility: the time in which the branch relaxes at every wave vector, M = 1 / (time C).
    """

    stiffness: SpectrumOf
    mobility: SpectrumOf | None = None
    time: float = math.inf


@dataclass(frozen=True)
class Spectra:
    """H, of shape `Lattice.spectral_shape`; C_b, and M_b C_b, the rate at which a mode of branch b creeps.

    These have the branches as first axis.
    """

    permanent: Spectrum
    creeping: Spectrum
    rate: Spectrum


@dataclass(frozen=True)
class Springs:
    """The lattice of springs: a force k0 L u + k1 w, and a creep of u - w at the rate spread L w + drag w.

    L is minus the Laplacian, w the stretch of the springs to the bulk. ``spread`` is k1 R and ``drag`` k1
    R_viscous: rates, or in an implicit step those times its duration.
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

    Its stiffness and creep are stated in one of three ways: by ``springs``; by a ``stiffness`` and ``shares``
    of it; or by ``permanent`` and ``branches``, which follow from the others.

    Parameters
    ----------
    permanent
        H: lattice -> spectrum, force per length; None where nothing is permanent.
    branches
        The creeping branches; none where nothing creeps.
    parameters
        Further numbers to record with every result.
    stiffness
        H + sum of C, the instantaneous stiffness: lattice -> spectrum, force per length.
    shares
        Pairs (share, relaxation time) of branches that are shares of the stiffness K at every wave vector:
        C_b = g_b K, and M_b C_b = 1 / tau_b. What creeps by a local law alone has an infinite time.
    springs
        The lattice of springs, defined on sites.
    modulus
        Instantaneous contact modulus E*, of a continuum that has one.
    half_space
        Whether normal displacements are those of a half-space of that modulus, from which resistances and
        tangential stiffness follow. It is ``in_lengths`` and ``loaded_from_afar``.
    loaded_from_afar
        Whether the normal load is applied evenly from far away where nothing hangs on the rigid body:
        H and all C vanish at wave vector 0.
    in_lengths
        Whether the spectra depend on the spacing of the sites: a continuum, which takes surfaces with units
        in metres. Else the solid is defined on sites, whose spacing is 1.
    apparatus
        Stiffness at wave vector 0 of what is loaded from afar, force per length, for it hangs on a machine.
        Infinite stands for `asperity.solids.laws.RIGID` times the largest stiffness of a mode.
    creep
        A local law of creep of the only branch, beside its mobility; see `asperity.creep.law`.
    hardness
        Pressure that contacts do not exceed, for they yield under it; on a solid that is defined on sites,
        the force of a site. See `Solid.with_hardness`.
    adhesion
        A law of adhesion of a continuum that has a modulus, in reversible contact; see `asperity.adhesion`.
    kind
        Name of the function that built it, which is recorded.
    """

    permanent: SpectrumOf | None = None
    branches: tuple[CreepBranch, ...] = ()
    parameters: Parameters = field(default_factory=dict, hash=False)
    loaded_from_afar: bool = False
    in_lengths: bool = False
    creep: LocalCreep | None = None
    hardness: float = math.inf
    stiffness: SpectrumOf | None = None
    shares: Shares | None = None
    springs: Springs | None = None
    modulus: float | None = None
    half_space: bool = False
    apparatus: float | None = None
    adhesion: Adhesion | None = None
    kind: str = field(default="of own spectra", compare=False)

    def __post_init__(self) -> None:
        if self.half_space:
            self._set(loaded_from_afar=True, in_lengths=True)
        parts = {"permanent": self.permanent, "branches": tuple(self.branches)}
        if self.springs is not None:
            k0, k1, *rates = astuple(self.springs)
            mobility = LaplacianSpectrum(*(rate / k1 for rate in rates)) if k1 > 0 else None
            branch = CreepBranch(LaplacianSpectrum(uniform=k1), mobility)
            parts = {"permanent": LaplacianSpectrum(k0), "branches": (branch,)}
        elif (law := self.stiffness) is not None:
            shares = () if self.shares is None else self.shares
            self._set(shares=check_branches(shares) if self.creep is None else tuple(shares))
            branches = tuple(CreepBranch(Scaled(law, share), time=time) for share, time in self.shares or ())
            rest = Scaled(law, self.permanent_share) if self.permanent_share else None
            parts = {"permanent": rest, "branches": branches}
        self._check(parts)
        recorded = {
            **({"branches": self.shares} if self.creep is None else self.creep.parameters),
            "apparatus": self.apparatus,
            "hardness": self.hardness if self.yields else None,
            **({} if self.adhesion is None else self.adhesion.parameters),
        }
        recorded = {name: value for name, value in recorded.items() if value is not None}
        first = {} if self.modulus is None else {"modulus": self.modulus}
        self._set(**parts, parameters={**first, **self.parameters, **recorded})

    def _set(self, **values: object) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _check(self, parts: Mapping[str, Any]) -> None:
        """Refuse a solid that is stated in two ways, or lacks a part."""
        for name, part in parts.items():
            stated = getattr(self, name)
            if stated not in (None, (), []) and (tuple(stated) if name == "branches" else stated) != part:
                expected = "nothing beside springs, or beside a stiffness and its shares"
                raise InputError(name, expected=expected, got="both")
        if self.shares is not None and self.stiffness is None:
            raise InputError("stiffness", expected="a stiffness for the shares", got="none")
        if self.half_space and self.modulus is None:
            raise InputError("modulus", expected="the contact modulus of a half-space", got="none")
        if self.creep is not None and len(parts["branches"]) != 1:
            got = f"{len(parts['branches'])} branches"
            raise InputError("creep", expected="a solid of one branch", got=got)
        if self.adhesion is not None:
            checked_adhesion(self.adhesion)
            beside = {
                "a solid that is defined on sites": not self.in_lengths,
                "a solid without a contact modulus": self.modulus is None,
                "a local law of creep": self.creep is not None,
                "a hardness": self.yields,
            }
            if wrong := [case for case, is_so in beside.items() if is_so]:
                expected = "an elastic or viscoelastic continuum without a hardness"
                raise InputError("adhesion", expected=expected, got=wrong[0])

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
        return replace(self, hardness=units.number("hardness", hardness, "Pa", above=0))

    def without_law(self) -> Solid:
        """Return the solid in which every wave creeps in proportion to its force, in place of its local law.

        It leads to the same limit, if the law creeps under every force.
        """
        linear = replace(self.branches[0], mobility=None, time=1.0)
        if self.shares is None and self.springs is None:
            return replace(self, creep=None, branches=(linear,))
        springs = self.springs and replace(self.springs, drag=self.springs.k1)
        shares = self.shares and ((self.shares[0][0], 1.0),)
        return replace(self, creep=None, permanent=None, branches=(), springs=springs, shares=shares)

    def __repr__(self) -> str:
        parameters = ", ".join(_shown(name, value) for name, value in self.parameters.items())
        return f"<Solid: {self.kind}{', ' * bool(parameters)}{parameters}>"

    @property
    def yields(self) -> bool:
        """Whether pressures have a bound."""
        return math.isfinite(self.hardness)

    @property
    def relaxing(self) -> Shares:
        """The shares that relax, each in its time, at every wave vector; none where a local law creeps."""
        return tuple(self.shares or ()) if self.creep is None else ()

    @property
    def permanent_share(self) -> float:
        """Part of the instantaneous stiffness that does not relax."""
        rest = 1.0 - math.fsum(share for share, _ in self.shares or ())
        return rest if rest > 1e-12 else 0.0

    @property
    def separable(self) -> bool:
        """Whether relaxation is the same at all wavelengths, as `shares` states.

        Under a load that never falls the contact is then that of an elastic solid at another load (E. H. Lee,
        J. R. M. Radok, J. Appl. Mech. 27, 438 (1960), DOI 10.1115/1.3644020; T. C. T. Ting, J. Appl. Mech.
        33, 845 (1966), DOI 10.1115/1.3625192), and no site loses contact after the load has fallen. Nothing
        sticks.
        """
        other = self.creep is not None or self.yields or self.adhesion is not None
        return not other and (self.shares is not None or not self.branches)

    def on(self, lattice: Lattice) -> Spectra:
        """Evaluate the spectra on a lattice.

        Raises
        ------
        InputError
            A spectrum is negative or not finite, nothing carries the load at wave vector 0 (unless it comes
            from afar), or H + sum of C vanishes elsewhere.
        """
        permanent = np.zeros(lattice.spectral_shape)
        if self.permanent is not None:
            permanent = _checked("permanent stiffness", self.permanent, lattice)
        creeping = np.empty((len(self.branches), *lattice.spectral_shape))
        rate = np.empty_like(creeping)
        for number, branch in enumerate(self.branches):
            which = f" of branch {number}" if len(creeping) > 1 else ""
            creeping[number] = _checked(f"creeping stiffness{which}", branch.stiffness, lattice)
            if branch.mobility is None:
                rate[number] = np.where(creeping[number] > 0, 1 / branch.time, 0.0)
            else:
                rate[number] = _checked(f"mobility{which}", branch.mobility, lattice) * creeping[number]
        whole = permanent + creeping.sum(axis=0)
        if self.half_space and not lattice.body:
            sides = zip(lattice.angles, lattice.spacing, strict=True)
            last = math.hypot(*(float(angle.flat[-1]) / side for angle, side in sides))
            wanted = cast(float, self.modulus) / 2 * last * lattice.cell
            if not math.isclose(whole.flat[-1], wanted, rel_tol=1e-6):
                expected = f"modulus/2 |q| lattice.cell of a half-space, {wanted:.6g} at q = {last:.6g}"
                raise InputError("stiffness", expected=expected, got=f"{whole.flat[-1]:.6g}")
        if (mounted := self._mounted(lattice, float(whole.max()))) is not None:
            hanging = permanent if self.creep is None else creeping[0]
            whole.flat[0] = hanging.flat[0] = mounted
        if whole.flat[0] == 0 and not self.loaded_from_afar:
            expected = "more than 0 at wave vector 0: the normal load passes through it"
            raise InputError("creeping stiffness", expected=expected, got="0", advice="k1 > 0")
        if not whole.flat[1:].all():
            raise InputError("stiffness", expected="H + C > 0 at every wave vector but 0", got="0 at some")
        return Spectra(permanent, creeping, rate)

    def stiffness_at(self, lattice: Lattice, frequency: Spectrum) -> Modes:
        r"""Complex stiffness of each wave that oscillates, u = Re(u_q exp(i omega t)).

            K(q, omega) = H + sum_b C_b i omega / (i omega + M_b C_b)

        Parameters
        ----------
        lattice
            The lattice.
        frequency
            omega, radians per time, of any sign; broadcasts to `Lattice.spectral_shape`.

        Returns
        -------
        array
            Complex, shape `Lattice.spectral_shape`, force per length of a site. Its conjugate belongs to
            -omega.

        Raises
        ------
        InputError
            A local law of creep has no linear response, or as `on`.
        """
        if self.creep is not None:
            expected, got = "linear creep, which has a stiffness at each frequency", "a local law of creep"
            raise InputError("solid", expected=expected, got=got, advice="branches=[(0.5, 1.0)]")
        if self.stiffness is not None and self.apparatus is None:  # the same at all wave vectors
            whole = _checked("stiffness", self.stiffness, lattice)
            parts = [share * _moving(frequency, 1 / time) for share, time in self.shares or ()]
            return np.asarray(whole * sum(parts, self.permanent_share + 0j), dtype=complex)
        spectra = self.on(lattice)
        response = spectra.permanent.astype(complex)
        for creeping, rate in zip(spectra.creeping, spectra.rate, strict=True):
            response += creeping * _moving(frequency, rate)
        return response

    def _mounted(self, lattice: Lattice, greatest: float) -> float | None:
        """Stiffness of the apparatus for each site, beside the greatest of a mode; None without one."""
        if self.apparatus is None or (lattice.body and math.isinf(self.apparatus)):
            return None  # the position of a body from afar is known as it is
        if lattice.body:
            expected, advice = "no apparatus, or a rigid one, where edges are free", "apparatus=math.inf"
            raise InputError("apparatus", expected=expected, got=f"{self.apparatus:g}", advice=advice)
        return RIGID * greatest if math.isinf(self.apparatus) else self.apparatus / lattice.sites


def _moving(frequency: Spectrum, rate: Spectrum | float) -> Modes:
    """Part i omega / (i omega + rate) of a creeping stiffness; all of it where nothing creeps."""
    turning = 1j * np.asarray(frequency)
    whole = np.asarray(turning + rate)
    part: Modes = np.divide(turning, whole, out=np.ones_like(whole), where=whole != 0)
    return part


def _checked(name: str, law: SpectrumOf, lattice: Lattice) -> Spectrum:
    values = np.array(checks.floats(name, law(lattice), expected="a finite spectrum >= 0"))
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
