r"""A solid above a rough surface, and how every task on it becomes one contact problem.

An implicit step of duration tau from a shape v is u0 = v + tau M C (u - u0). Eliminating u0,

    u - u0 = D (u - v),    D = 1 / (1 + tau M C),
    r      = S u - C D v,  S = H + C D,

a contact problem. tau = 0 is the instantaneous contact; tau = infinity is the relaxed state, where
D = 0 wherever M C > 0 and D = 1 elsewhere. Under load control wave vector 0 drops out of S, its
pull is minus the load, and the mean of u0 follows from the load, mean(u) - F / (N C(0)).
Under separation control wave vector 0 is a mode like any other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.contact.controls import Control, Load
from asperity.contact.problem import ContactProblem
from asperity.lattice import Field, Lattice, Modes, Spectrum
from asperity.solids import Solid, Spectra


@dataclass(frozen=True, eq=False)
class ImplicitStep:
    """An implicit step of one duration: D, C D and S of the module's formulas."""

    system: System
    damping: Spectrum
    creeping: Spectrum
    stiffness: Spectrum

    def problem(self, shape: Modes) -> ContactProblem:
        """The contact problem of the step from a shape v (modes)."""
        pull = self.creeping * shape
        if isinstance(self.system.control, Load):
            pull.flat[0] = -self.system.control.value
        return ContactProblem(self.system.lattice, self.stiffness, pull, self.system.heights)

    def crept_shape(self, surface: Modes, shape: Modes) -> Modes:
        """u0 (modes) after the step, from the solved u and the shape v before it."""
        crept = surface - self.damping * (surface - shape)
        if isinstance(self.system.control, Load):
            stiffness = self.system.spectra.creeping.flat[0]
            crept.flat[0] = surface.flat[0] - self.system.control.value / stiffness
        return crept


@dataclass(frozen=True, eq=False)
class System:
    """A solid, a rough surface and what is held.

    Heights, u and u0 are measured from `datum`, the highest point of the rough surface.
    """

    lattice: Lattice
    spectra: Spectra
    heights: Field
    datum: float
    control: Control

    @classmethod
    def of(cls, heights: Field, solid: Solid, control: Control) -> System:
        """Set up from checked heights."""
        lattice = Lattice(heights.shape)
        datum = float(heights.max())
        return cls(lattice, solid.on(lattice), heights - datum, datum, control)

    def virgin_shape(self) -> Modes:
        """The flat u0 from which a press starts; under load control its mean is irrelevant."""
        modes = np.zeros(self.lattice.spectral_shape, dtype=complex)
        if not isinstance(self.control, Load):
            modes.flat[0] = self.lattice.sites * (self.control.value - self.datum)
        return modes

    def implicit_step(self, tau: float) -> ImplicitStep:
        """Prepare implicit steps of duration tau >= 0, which may be infinite."""
        rate = self.spectra.mobility * self.spectra.creeping
        damping = np.where(rate > 0, 0.0, 1.0) if np.isinf(tau) else 1.0 / (1.0 + tau * rate)
        creeping = self.spectra.creeping * damping
        stiffness = self.spectra.permanent + creeping
        if isinstance(self.control, Load):
            stiffness.flat[0] = 0.0
        return ImplicitStep(self, damping, creeping, stiffness)

    def creep_rate(self, surface: Modes, shape: Modes) -> Modes:
        """Rate d u0 / dt (modes) = M C (u - u0); the mean is slaved to the load under load control."""
        rate = self.spectra.mobility * self.spectra.creeping * (surface - shape)
        if isinstance(self.control, Load):
            rate.flat[0] = 0.0
        return rate

    def force(self, surface: Modes, shape: Modes) -> Field:
        """Contact force H u + C (u - u0) at every site."""
        return self.lattice.backward(
            self.spectra.permanent * surface + self.spectra.creeping * (surface - shape)
        )

    def energy(self, surface: Modes, shape: Modes) -> float:
        """Elastic energy 1/2 sum_q [ H |u|^2 + C |u - u0|^2 ]."""
        density = (
            self.spectra.permanent * np.abs(surface) ** 2
            + self.spectra.creeping * np.abs(surface - shape) ** 2
        )
        return self.lattice.mean_over_modes(density) / 2
