r"""What a solid on a lattice does: forces, energies, rates of creep, and implicit steps of creep.

An implicit step of duration tau from anchors v is u0 = v + tau M C (u - u0). Eliminating u0,

    u - u0 = D (u - v),    D = 1 / (1 + tau M C),
    r      = S u - C D v,  S = H + C D,

a contact problem. tau = 0 is the instantaneous contact; tau = infinity is the relaxed state, where
D = 0 wherever M C > 0 and D = 1 elsewhere. Under load control wave vector 0 drops out of S, its
right-hand side is minus the load, and the mean of u - u0 is F / (N C(0)). A solid with C(0) = 0, such as a
half-space, carries the load as a rigid body: there mean(u0) = mean(u).
Under separation control wave vector 0 is a mode like any other.

There are two: `SpectralMechanics` states these things in Fourier modes, for any solid. `SpringMechanics`
states them in terms of neighbors, for the lattice of springs in two dimensions, where a stencil costs
a small part of a transform.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from asperity.contact.problem import ContactProblem, SpectralProblem, SpringProblem, SpringStep
from asperity.contact.stencils import balanced, bond_energy, damped_power, lattice_force
from asperity.lattice import Field, Lattice, Modes, Spectrum
from asperity.solids import Solid, Spectra, SpringConstants


class ImplicitStep(ABC):
    """An implicit step of creep of one duration."""

    @abstractmethod
    def problem(self, heights: Field, anchors: Field | float, load: float | None) -> ContactProblem:
        """The contact problem of the step.

        Parameters
        ----------
        heights
            The obstacle; its maximum is 0.
        anchors
            v, that is u0 before the step: a field, or the level of a flat one.
        load
            The normal load at the end of the step; None under separation control.
        """

    @abstractmethod
    def stretch(self, u: Field, anchors: Field | float, mean: float | None) -> Field:
        """Stretch w = u - u0 after the step, from the solved u and the anchors v before it.

        ``mean`` is the mean of w where the load prescribes it, else None.
        """


class Mechanics(ABC):
    """A solid on a lattice.

    Attributes
    ----------
    mean_stiffness
        C at wave vector 0, through which the load passes.
    mean_mobility
        M at wave vector 0.
    greatest_stiffness
        Largest H + C.
    fastest_creep
        Largest M C, the rate at which the fastest mode creeps at a given u.
    """

    lattice: Lattice
    mean_stiffness: float
    mean_mobility: float
    greatest_stiffness: float
    fastest_creep: float

    @property
    @abstractmethod
    def soft_modes(self) -> tuple[bool, bool]:
        """Whether nothing permanent resists some wave vectors but 0, and whether nothing resists all."""

    @abstractmethod
    def implicit_step(self, tau: float) -> ImplicitStep:
        """Prepare implicit steps of duration tau >= 0, which may be infinite."""

    @abstractmethod
    def force(self, u: Field, stretch: Field, load: float | None) -> Field:
        """Contact force H u + C w at every site, w = u - u0; a load from afar where C(0) = 0."""

    @abstractmethod
    def creep_rate(self, stretch: Field) -> Field:
        """Rate d u0 / dt = M C w."""

    @abstractmethod
    def energy(self, u: Field, stretch: Field) -> float:
        """Elastic energy 1/2 sum_q [ H |u|^2 + C |w|^2 ]."""

    @abstractmethod
    def balanced_stretch(self, u: Field, stretch: Field, heights: Field, total: float | None) -> Field:
        """Stretch with which the surface u is in exact equilibrium, near one with which it almost is.

        ``total`` is the sum of w, where it is known.
        """

    @abstractmethod
    def damped_power(self, modes: Modes, tau: float) -> float:
        """Mean over the modes of |mode / (1 + tau z)|^2.

        z = M C H / (H + C) is the rate at which a mode decays off contact (the paper's z_q).
        """


@final
class SpectralMechanics(Mechanics):
    """Any solid, in Fourier modes."""

    def __init__(self, solid: Solid, lattice: Lattice) -> None:
        self.solid, self.lattice = solid, lattice

    @cached_property
    def spectra(self) -> Spectra:
        """H, C and M on this lattice."""
        return self.solid.on(self.lattice)

    @cached_property
    def mean_stiffness(self) -> float:  # type: ignore[override]
        """C at wave vector 0."""
        return float(self.spectra.creeping.flat[0])

    @cached_property
    def mean_mobility(self) -> float:  # type: ignore[override]
        """M at wave vector 0."""
        return float(self.spectra.mobility.flat[0])

    @cached_property
    def greatest_stiffness(self) -> float:  # type: ignore[override]
        """Largest H + C."""
        return float(np.max(self.spectra.permanent + self.spectra.creeping))

    @cached_property
    def fastest_creep(self) -> float:  # type: ignore[override]
        """Largest M C."""
        return float(np.max(self.spectra.mobility * self.spectra.creeping))

    @property
    def soft_modes(self) -> tuple[bool, bool]:
        """See `Mechanics`."""
        soft = self.implicit_step(np.inf).stiffness.flat[1:] == 0
        return bool(soft.any()), bool(soft.all())

    def implicit_step(self, tau: float) -> SpectralStep:
        """See `Mechanics`."""
        return SpectralStep(self, tau)

    def force(self, u: Field, stretch: Field, load: float | None) -> Field:
        """See `Mechanics`."""
        lattice, spectra = self.lattice, self.spectra
        modes = spectra.permanent * lattice.forward(u) + spectra.creeping * lattice.forward(stretch)
        if self.mean_stiffness == 0 and load is not None:
            modes.flat[0] = load
        return lattice.backward(modes)

    def creep_rate(self, stretch: Field) -> Field:
        """See `Mechanics`."""
        return self.lattice.apply(self.spectra.mobility * self.spectra.creeping, stretch)

    def energy(self, u: Field, stretch: Field) -> float:
        """See `Mechanics`."""
        lattice, spectra = self.lattice, self.spectra
        density = spectra.permanent * np.abs(lattice.forward(u)) ** 2
        density += spectra.creeping * np.abs(lattice.forward(stretch)) ** 2
        return lattice.mean_over_modes(density) / 2

    def balanced_stretch(self, u: Field, stretch: Field, heights: Field, total: float | None) -> Field:
        """Return the stretch as it is: forces are not local, and need no balance."""
        del u, heights, total
        return stretch

    def damped_power(self, modes: Modes, tau: float) -> float:
        """See `Mechanics`."""
        damped = np.abs(modes) / (1 + np.float32(tau) * self._free_decay_rate)
        return self.lattice.mean_over_modes(damped**2)

    @cached_property
    def _free_decay_rate(self) -> Spectrum:
        H, C, M = self.spectra.permanent, self.spectra.creeping, self.spectra.mobility
        # Where both vanish, at wave vector 0 of a half-space, nothing creeps either.
        rate = np.divide(M * C * H, H + C, out=np.zeros_like(H), where=H + C > 0)
        return np.asarray(rate, dtype=np.float32)


@final
@dataclass(frozen=True, eq=False)
class SpectralStep(ImplicitStep):
    """An implicit step in Fourier modes: D, C D and S of the module's formulas."""

    mechanics: SpectralMechanics
    tau: float

    @cached_property
    def damping(self) -> Spectrum:
        """D."""
        rate = self.mechanics.spectra.mobility * self.mechanics.spectra.creeping
        return np.where(rate > 0, 0.0, 1.0) if np.isinf(self.tau) else 1.0 / (1.0 + self.tau * rate)

    @cached_property
    def stiffness(self) -> Spectrum:
        """S."""
        return np.asarray(self.mechanics.spectra.permanent + self.mechanics.spectra.creeping * self.damping)

    @cached_property
    def _load_controlled_stiffness(self) -> Spectrum:
        stiffness = self.stiffness.copy()
        stiffness.flat[0] = 0.0
        return stiffness

    def problem(self, heights: Field, anchors: Field | float, load: float | None) -> SpectralProblem:
        """See `ImplicitStep`."""
        mechanics = self.mechanics
        stiffness = self.stiffness if load is None else self._load_controlled_stiffness
        rhs = mechanics.spectra.creeping * self.damping * self._modes(anchors)
        if load is not None:
            rhs.flat[0] = -load
        return SpectralProblem(mechanics.lattice, heights, stiffness, rhs, load is not None)

    def stretch(self, u: Field, anchors: Field | float, mean: float | None) -> Field:
        """See `ImplicitStep`."""
        lattice = self.mechanics.lattice
        modes = self.damping * (lattice.forward(u) - self._modes(anchors))
        if mean is not None:
            modes.flat[0] = mean * lattice.sites
        return lattice.backward(modes)

    def _modes(self, field: Field | float) -> Modes:
        lattice = self.mechanics.lattice
        if isinstance(field, np.ndarray):
            return lattice.forward(field)
        modes = np.zeros(lattice.spectral_shape, dtype=complex)
        modes.flat[0] = lattice.sites * field
        return modes


@final
class SpringMechanics(Mechanics):
    """The lattice of springs in two dimensions, k0 > 0 and k1 > 0, in terms of neighbors.

    Attributes
    ----------
    springs
        The spring constants.
    spectral
        The same in Fourier modes.
    """

    def __init__(self, springs: SpringConstants, spectral: SpectralMechanics) -> None:
        self.springs, self.spectral, self.lattice = springs, spectral, spectral.lattice
        self.mean_stiffness, self.mean_mobility = springs.k1, springs.R_viscous
        self.greatest_stiffness = 8 * springs.k0 + springs.k1
        self.fastest_creep = springs.k1 * (8 * springs.R + springs.R_viscous)

    @property
    def soft_modes(self) -> tuple[bool, bool]:
        """None: k0 > 0."""
        return False, False

    def implicit_step(self, tau: float) -> NeighborStep:
        """See `Mechanics`."""
        return NeighborStep(self, tau)

    def force(self, u: Field, stretch: Field, load: float | None) -> Field:
        """See `Mechanics`."""
        del load
        return lattice_force(u, stretch, self.springs.k0, self.springs.k1)

    def creep_rate(self, stretch: Field) -> Field:
        """See `Mechanics`."""
        k1, R, R_viscous = self.springs.k1, self.springs.R, self.springs.R_viscous
        return lattice_force(stretch, stretch, k1 * R, k1 * R_viscous)

    def energy(self, u: Field, stretch: Field) -> float:
        """See `Mechanics`."""
        bulk = float(np.einsum("ij,ij->", stretch, stretch))
        return (self.springs.k0 * bond_energy(u) + self.springs.k1 * bulk) / 2

    def balanced_stretch(self, u: Field, stretch: Field, heights: Field, total: float | None) -> Field:
        """Off contact w = -k0 L u / k1; in contact w is kept where the force is no tension, and scaled."""
        return balanced(u, stretch, heights, self.springs.k0, self.springs.k1, total)

    def damped_power(self, modes: Modes, tau: float) -> float:
        """See `Mechanics`."""
        return damped_power(modes, self.lattice.shape, self.springs, tau)


@final
@dataclass(frozen=True, eq=False)
class NeighborStep(ImplicitStep):
    """An implicit step of the lattice of springs."""

    mechanics: SpringMechanics
    tau: float

    @cached_property
    def spectral(self) -> SpectralStep:
        """The same in Fourier modes."""
        return self.mechanics.spectral.implicit_step(self.tau)

    def problem(self, heights: Field, anchors: Field | float, load: float | None) -> SpringProblem:
        """See `ImplicitStep`."""
        springs = self.mechanics.springs
        relaxed = bool(np.isinf(self.tau)) and springs.creep
        rate = self.tau * springs.k1 if springs.creep and not relaxed else 0.0
        spread, drag = rate * springs.R, rate * springs.R_viscous
        step = SpringStep(springs.k0, springs.k1, spread, drag, relaxed, anchors, load)
        return SpringProblem(heights, step, lambda: self.spectral.problem(heights, anchors, load))

    def stretch(self, u: Field, anchors: Field | float, mean: float | None) -> Field:
        """See `ImplicitStep`."""
        return self.spectral.stretch(u, anchors, mean)


def mechanics_of(solid: Solid, lattice: Lattice) -> Mechanics:
    """Mechanics of a solid on a lattice: in terms of neighbors where there is such a form."""
    spectral, springs = SpectralMechanics(solid, lattice), solid.springs
    if springs is None or lattice.dimension != 2 or not (springs.k0 > 0 and springs.k1 > 0):
        return spectral
    return SpringMechanics(springs, spectral)
