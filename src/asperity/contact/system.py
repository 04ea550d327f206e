r"""A solid above a rough surface, and how every task on it becomes one contact problem.

An implicit step of duration tau from a shape v is u0 = v + tau M C (u - u0). Eliminating u0,

    u - u0 = D (u - v),    D = 1 / (1 + tau M C),
    r      = S u - C D v,  S = H + C D,

a contact problem. tau = 0 is the instantaneous contact; tau = infinity is the relaxed state, where
D = 0 wherever M C > 0 and D = 1 elsewhere. Under load control wave vector 0 drops out of S, its
pull is minus the load, and the mean of u - u0 is F / (N C(0)). A solid with C(0) = 0, such as a
half-space, carries the load as a rigid body: there mean(u0) = mean(u).
Under separation control wave vector 0 is a mode like any other.

`System` states these things twice: in Fourier modes for any solid, and in terms of neighbors for
the lattice of springs in two dimensions, where a stencil costs a small part of a transform.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asperity.contact.arrays import largest
from asperity.contact.controls import Control, Load
from asperity.contact.problem import ContactProblem, SpringStep
from asperity.contact.stencils import balanced, bond_energy, damped_power, lattice_force
from asperity.errors import InputError
from asperity.lattice import Field, Lattice, Modes, Spectrum
from asperity.solids import Solid, Spectra, SpringConstants


@dataclass(frozen=True, eq=False)
class System:
    """A solid, a rough surface and what is held.

    Heights, u and u0 are measured from `datum`, the highest point of the rough surface.
    """

    lattice: Lattice
    solid: Solid
    heights: Field
    datum: float
    control: Control

    @classmethod
    def of(cls, heights: Field, solid: Solid, control: Control) -> System:
        """Set up from checked heights.

        Raises
        ------
        InputError
            The solid cannot be used, or not with this control.
        """
        datum = float(heights.max())
        system = cls(Lattice(heights.shape), solid, heights - datum, datum, control)
        if system.mean_stiffness == 0 and not isinstance(control, Load):
            raise InputError(
                "separation",
                expected="a solid that hangs on springs: C > 0 at wave vector 0",
                got="one that carries the load as a rigid body, whose separation moves with it",
                advice="load=...",
            )
        return system

    @cached_property
    def spectra(self) -> Spectra:
        """H, C and M on this lattice."""
        return self.solid.on(self.lattice)

    @cached_property
    def springs(self) -> SpringConstants | None:
        """The constants of the lattice of springs, where this is one in two dimensions."""
        springs = self.solid.springs
        if springs is None or self.lattice.dimension != 2 or not (springs.k0 > 0 and springs.k1 > 0):
            return None
        return springs

    @cached_property
    def mean_stiffness(self) -> float:
        """C at wave vector 0, through which the load passes."""
        return self.springs.k1 if self.springs else float(self.spectra.creeping.flat[0])

    @cached_property
    def mean_mobility(self) -> float:
        """M at wave vector 0."""
        return self.springs.R_viscous if self.springs else float(self.spectra.mobility.flat[0])

    @cached_property
    def greatest_stiffness(self) -> float:
        """Largest H + C."""
        if self.springs:
            return 8 * self.springs.k0 + self.springs.k1
        return float(np.max(self.spectra.permanent + self.spectra.creeping))

    @cached_property
    def fastest_creep(self) -> float:
        """Largest M C, the rate at which the fastest mode creeps at a given u."""
        if self.springs:
            return self.springs.k1 * (8 * self.springs.R + self.springs.R_viscous)
        return float(np.max(self.spectra.mobility * self.spectra.creeping))

    @property
    def mean_stretch(self) -> float:
        """Mean of u - u0 under load control."""
        if not isinstance(self.control, Load) or self.mean_stiffness == 0:
            return 0.0
        return self.control.value / (self.lattice.sites * self.mean_stiffness)

    @property
    def virgin_shape(self) -> float:
        """Level of the flat u0 from which a press starts; under load control it is irrelevant."""
        return 0.0 if isinstance(self.control, Load) else self.control.value - self.datum

    def implicit_step(self, tau: float) -> ImplicitStep:
        """Prepare implicit steps of duration tau >= 0, which may be infinite."""
        return ImplicitStep(self, tau)

    def force(self, u: Field, stretch: Field) -> Field:
        """Contact force H u + C w at every site, w = u - u0."""
        if self.springs:
            return lattice_force(u, stretch, self.springs.k0, self.springs.k1)
        lattice, spectra = self.lattice, self.spectra
        modes = spectra.permanent * lattice.forward(u) + spectra.creeping * lattice.forward(stretch)
        if self.mean_stiffness == 0 and isinstance(self.control, Load):
            modes.flat[0] = self.control.value
        return lattice.backward(modes)

    def creep_rate(self, stretch: Field) -> Field:
        """Rate d u0 / dt = M C w; the mean is slaved to the load under load control."""
        if self.springs:
            k1, R, R_viscous = self.springs.k1, self.springs.R, self.springs.R_viscous
            rate = lattice_force(stretch, stretch, k1 * R, k1 * R_viscous)
        else:
            rate = self.lattice.apply(self.spectra.mobility * self.spectra.creeping, stretch)
        if isinstance(self.control, Load):
            rate -= rate.mean()
        return rate

    def balanced_stretch(self, u: Field, stretch: Field) -> Field:
        """Stretch with which the surface u is in exact equilibrium, near one with which it almost is.

        Only the lattice of springs needs and allows it: off contact w = -k0 L u / k1; in contact w is
        kept where the force is no pull, and scaled to carry the load.
        """
        if self.springs is None:
            return stretch
        k1 = self.springs.k1
        load = None  # as it is
        if isinstance(self.control, Load):
            load = self.control.value / k1
        elif self.mean_mobility == 0:  # then the mean of u0 stays, and of u - u0 with it
            load = float(stretch.sum())
        return balanced(u, stretch, self.heights, self.springs.k0, k1, load)

    def energy(self, u: Field, stretch: Field) -> float:
        """Elastic energy 1/2 sum_q [ H |u|^2 + C |w|^2 ]."""
        if self.springs:
            bulk = float(np.einsum("ij,ij->", stretch, stretch))
            return (self.springs.k0 * bond_energy(u) + self.springs.k1 * bulk) / 2
        lattice, spectra = self.lattice, self.spectra
        density = spectra.permanent * np.abs(lattice.forward(u)) ** 2
        density += spectra.creeping * np.abs(lattice.forward(stretch)) ** 2
        return lattice.mean_over_modes(density) / 2

    def damped_rms(self, error: NDArray[np.floating], tau: float) -> float:
        """Rms over the sites of an error of u0, each mode divided by 1 + tau z.

        z = M C H / (H + C) is the rate at which the mode decays off contact (the paper's z_q). Under load
        control the mean does not count. Single precision does for the size of an error.
        """
        scale = largest(error, np)
        if not 0 < scale < math.inf:
            return scale
        modes = self.lattice.forward((error / scale).astype(np.float32, copy=False))
        if isinstance(self.control, Load):
            modes.flat[0] = 0.0
        if self.springs:
            power = damped_power(modes, self.lattice.shape, self.springs, tau)
        else:
            damped = np.abs(modes) / (1 + np.float32(tau) * self._free_decay_rate)
            power = self.lattice.mean_over_modes(damped**2)
        return scale * math.sqrt(power / self.lattice.sites)

    @cached_property
    def _free_decay_rate(self) -> Spectrum:
        H, C, M = self.spectra.permanent, self.spectra.creeping, self.spectra.mobility
        # Where both vanish, at wave vector 0 of a half-space, nothing creeps either.
        rate = np.divide(M * C * H, H + C, out=np.zeros_like(H), where=H + C > 0)
        return np.asarray(rate, dtype=np.float32)


@dataclass(frozen=True, eq=False)
class ImplicitStep:
    """An implicit step of one duration: D, C D and S of the module's formulas."""

    system: System
    tau: float

    @cached_property
    def damping(self) -> Spectrum:
        """D."""
        rate = self.system.spectra.mobility * self.system.spectra.creeping
        return np.where(rate > 0, 0.0, 1.0) if np.isinf(self.tau) else 1.0 / (1.0 + self.tau * rate)

    @cached_property
    def stiffness(self) -> Spectrum:
        """S; zero at wave vector 0 under load control."""
        stiffness = self.system.spectra.permanent + self.system.spectra.creeping * self.damping
        if isinstance(self.system.control, Load):
            stiffness.flat[0] = 0.0
        return stiffness

    def problem(self, shape: Field | float) -> ContactProblem:
        """The contact problem of the step from a shape v, a field or the level of a flat one."""
        system = self.system
        return ContactProblem(
            system.lattice,
            system.heights,
            stiffness=lambda: self.stiffness,
            pull=lambda: self._pull(shape),
            load_controlled=isinstance(system.control, Load),
            springs=self._springs(shape),
        )

    def _pull(self, shape: Field | float) -> Modes:
        system = self.system
        pull = system.spectra.creeping * self.damping * self._modes(shape)
        if isinstance(system.control, Load):
            pull.flat[0] = -system.control.value
        return pull

    def _springs(self, shape: Field | float) -> SpringStep | None:
        springs, control = self.system.springs, self.system.control
        if springs is None:
            return None
        creeps = springs.R > 0 or springs.R_viscous > 0
        relaxed = bool(np.isinf(self.tau)) and creeps
        rate = self.tau * springs.k1 if creeps and not relaxed else 0.0
        return SpringStep(
            springs.k0,
            springs.k1,
            spread=rate * springs.R,
            drag=rate * springs.R_viscous,
            relaxed=relaxed,
            shape=shape,
            load=control.value if isinstance(control, Load) else None,
        )

    def stretch(self, u: Field, shape: Field | float) -> Field:
        """Stretch w = u - u0 after the step, from the solved u and the shape v before it."""
        modes = self.damping * (self.system.lattice.forward(u) - self._modes(shape))
        if isinstance(self.system.control, Load):
            modes.flat[0] = self.system.mean_stretch * self.system.lattice.sites
        return self.system.lattice.backward(modes)

    def _modes(self, shape: Field | float) -> Modes:
        lattice = self.system.lattice
        if isinstance(shape, np.ndarray):
            return lattice.forward(shape)
        modes = np.zeros(lattice.spectral_shape, dtype=complex)
        modes.flat[0] = lattice.sites * shape
        return modes
