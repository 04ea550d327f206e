"""A solid above a rough surface with the load or the separation prescribed: whatever is computed for it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from asperity.contact.arrays import largest
from asperity.contact.controls import Control
from asperity.contact.mechanics import ImplicitStep, Mechanics, mechanics_of
from asperity.contact.problem import ContactProblem, Solution
from asperity.errors import InputError
from asperity.lattice import Field, Lattice
from asperity.solids import Solid


@dataclass(frozen=True, eq=False)
class System:
    """A solid, a rough surface and what is prescribed.

    Heights, u and u0 are measured from `datum`, the highest point of the rough surface.
    """

    mechanics: Mechanics
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
        mechanics = mechanics_of(solid, Lattice(heights.shape))
        if mechanics.mean_stiffness == 0 and not control.load_controlled:
            raise InputError(
                "separation",
                expected="a solid that hangs on springs: C > 0 at wave vector 0",
                got="one that carries the load as a rigid body, whose separation moves with it",
                advice="load=...",
            )
        return cls(mechanics, heights - datum, datum, control)

    def at(self, time: float) -> System:
        """Return the system with what is prescribed at a time, constant from there."""
        return replace(self, control=self.control.at(time)) if self.control.rate else self

    @property
    def sites(self) -> int:
        """Number of sites N."""
        return self.mechanics.lattice.sites

    @property
    def load(self) -> float | None:
        """The normal load, where it is prescribed."""
        return self.control.value if self.control.load_controlled else None

    @property
    def drift(self) -> float:
        """Velocity at which a moving rigid body carries u0 along; 0 under load control."""
        return 0.0 if self.control.load_controlled else self.control.rate

    @property
    def free_mean(self) -> bool:
        """Whether the mean of u0 creeps: viscous creep at a held separation."""
        return self.mechanics.mean_mobility > 0 and not self.control.load_controlled

    @property
    def mean_stretch(self) -> float | None:
        """Mean of u - u0 as the load prescribes it, 0 where it comes from afar; else None."""
        if self.load is None:
            return None
        stiffness = self.mechanics.mean_stiffness
        return self.load / (self.sites * stiffness) if stiffness > 0 else 0.0

    @property
    def virgin_anchors(self) -> float:
        """Level of the flat u0 from which a press starts; under load control it is irrelevant."""
        return 0.0 if self.control.load_controlled else self.control.value - self.datum

    def problem(self, step: ImplicitStep, anchors: Field | float) -> ContactProblem:
        """The contact problem of an implicit step from anchors v, a field or the level of a flat one."""
        return step.problem(self.heights, anchors, self.load)

    def stretch(self, step: ImplicitStep, solution: Solution, anchors: Field | float) -> Field:
        """Stretch w = u - u0 after a step."""
        if solution.stretch is not None:
            return solution.stretch
        return step.stretch(solution.u, anchors, self.mean_stretch)

    def force(self, u: Field, stretch: Field) -> Field:
        """Contact force at every site."""
        return self.mechanics.force(u, stretch, self.load)

    def creep_rate(self, stretch: Field) -> Field:
        """Rate d u0 / dt; under load control without its mean, which the load decides."""
        rate = self.mechanics.creep_rate(stretch)
        if self.control.load_controlled:
            rate -= rate.mean()
        elif self.drift:
            rate += self.drift
        return rate

    def balanced_stretch(self, u: Field, stretch: Field) -> Field:
        """Stretch with which the surface u is in exact equilibrium, near one with which it almost is."""
        total = None
        if self.load is not None and self.mechanics.mean_stiffness > 0:
            total = self.load / self.mechanics.mean_stiffness
        elif not self.free_mean:  # then the mean of u0 stays, and of u - u0 with it
            total = float(stretch.sum())
        return self.mechanics.balanced_stretch(u, stretch, self.heights, total)

    def energy(self, u: Field, stretch: Field) -> float:
        """Elastic energy."""
        return self.mechanics.energy(u, stretch)

    def damped_rms(self, error: NDArray[np.floating], tau: float) -> float:
        """Rms over the sites of an error of u0, each mode divided by 1 + tau z; see `Mechanics`.

        Under load control the mean does not count. Single precision does for the size of an error.
        """
        scale = largest(error, np)
        if not 0 < scale < math.inf:
            return scale
        modes = self.mechanics.lattice.forward((error / scale).astype(np.float32, copy=False))
        if self.control.load_controlled:
            modes.flat[0] = 0.0
        return scale * math.sqrt(self.mechanics.damped_power(modes, tau) / self.sites)
