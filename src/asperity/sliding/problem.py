r"""Contact of a rough profile that slides steadily over a viscoelastic solid.

In the frame of the profile nothing depends on time. The profile moves with the velocity V, so a wave
exp(i q x) of that frame is exp(i q (x - V t)) at a point of the solid, which oscillates at -q . V:

    u_q = C(q) p_q,        C(q) = 1 / K(q, -q . V),

with the complex stiffness K of `asperity.solids.Solid.stiffness_at`; on a half-space
C = 2 / (abs(q) E*(-q . V)). C is real in space and not symmetric. Its symmetric part is positive definite, so
the problem

    u >= h,    p >= 0,    (u - h) p = 0,    sum of p = load

has one solution. Per nominal area the friction against the motion is

    tau = -<p du/dx> = sum_q (q . V / V) Im C(q) abs(p_q)^2,

the dissipation over V. Off contact p = 0, and in contact u = h, so -<p dh/dx> is the same up to the
discretization.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from asperity.contact.problem import SpectralProblem
from asperity.contact.waves import Vector, friction_of_slopes, slope_of, waves_along
from asperity.errors import InputError
from asperity.lattice import Field, Lattice, Mask, Modes, Spectrum
from asperity.solids import Solid


@dataclass(frozen=True, eq=False)
class Sliding:
    """A rough profile that slides over a solid at a speed, under a load.

    Parameters
    ----------
    lattice
        Periodic.
    heights
        Shape of the lattice; -inf where there is no body.
    compliance
        C(q) of each wave, length per force of a site; 0 at wave vector 0, where the load passes.
    slope
        Unit vector of the motion times the wave vector; 0 for the shortest waves, which have no slope.
    load
        Sum of the forces.
    """

    lattice: Lattice
    heights: Field
    compliance: Modes
    slope: Spectrum
    load: float

    @classmethod
    def of(
        cls, lattice: Lattice, heights: Field, solid: Solid, direction: Vector, speed: float, load: float
    ) -> Sliding:
        """Set up from a solid; `InputError` if some wave meets no resistance."""
        compliance = np.zeros(lattice.spectral_shape, dtype=complex)
        along = waves_along(lattice, direction)
        for each in along:
            stiffness = solid.stiffness_at(lattice, -speed * each)
            stiffness.flat[0] = 1.0
            if not stiffness.all():
                raise InputError(
                    "solid",
                    expected="one that bears waves across the motion, which never recover",
                    got="one that flows without end: the load sinks in at every speed",
                    advice="a permanent share of the modulus: branches whose shares add up to less than 1",
                )
            compliance += 1 / (len(along) * stiffness)
        compliance.flat[0] = 0.0
        return cls(lattice, heights, compliance, slope_of(along), load)

    def with_loss(self, share: float) -> Sliding:
        """The same over a solid with a share of the loss compliance."""
        compliance = self.compliance.real + 1j * share * self.compliance.imag
        return self if share == 1 else replace(self, compliance=compliance)

    @cached_property
    def stiffness(self) -> Modes:
        """1 / C; at wave vector 0 that of the longest wave, where it weighs the mean of a correction."""
        stiffness = np.empty_like(self.compliance)
        stiffness.flat[1:] = 1 / self.compliance.flat[1:]
        stiffness.flat[0] = abs(stiffness.flat[min(1, stiffness.size - 1)])
        return stiffness

    @property
    def elastic(self) -> SpectralProblem:
        """The contact of the same profile at rest on an elastic solid of the storage compliance."""
        storage = np.zeros(self.compliance.shape)
        storage.flat[1:] = 1 / self.compliance.real.flat[1:]
        rhs = self.lattice.flat_modes(-self.load / self.lattice.sites)
        return SpectralProblem(self.lattice, self.heights, storage, rhs)

    def displacement(self, force: Field) -> Field:
        """C p, whose mean is 0."""
        return self.lattice.apply(self.compliance, force)

    def force(self, u: Field) -> Field:
        """Forces under a surface, whose sum is the load."""
        mean = self.load / self.lattice.sites
        return self.lattice.apply(self.stiffness, u - u.mean()) + mean


@dataclass(frozen=True, eq=False)
class State:
    """A contact in steady sliding.

    ``u`` is h in contact and not below it elsewhere; ``force`` is not below 0, and 0 elsewhere. ``residual``
    is the largest force off contact, or tension in contact, over the mean contact force, before these are
    left out. ``products`` counts applications of C.
    """

    problem: Sliding
    u: Field
    force: Field
    in_contact: Mask
    residual: float
    products: int

    @cached_property
    def dissipation(self) -> Spectrum:
        """Dissipation over the speed in each wave; the sum is -sum p du/dx. Shape of a spectrum."""
        problem, lattice = self.problem, self.problem.lattice
        power = np.abs(lattice.forward(self.force)) ** 2 * lattice.multiplicity / lattice.sites
        return np.asarray(problem.slope * problem.compliance.imag * power)

    @property
    def friction(self) -> float:
        """Force against the motion, by the energy that the solid dissipates."""
        return float(self.dissipation.sum())

    @property
    def friction_of_slopes(self) -> float:
        """The same as -sum p dh/dx, which the discretization makes another."""
        problem = self.problem
        return friction_of_slopes(problem.lattice, problem.slope, problem.heights, self.u, self.force)
