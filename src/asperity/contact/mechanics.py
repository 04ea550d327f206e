r"""What a solid on a lattice does: forces, energies, rates of creep, and implicit steps of creep.

An implicit step of duration tau from anchors v_b is u_b = v_b + tau M_b C_b (u - u_b). Eliminating u_b,

    w_b = u - u_b = D_b (u - v_b),    D_b = 1 / (1 + tau M_b C_b),
    r   = S u - sum_b C_b D_b v_b,    S = H + sum_b C_b D_b,

one contact problem however many branches there are. tau = 0 is the instantaneous contact; tau = infinity is
the relaxed state, where D_b = 0 wherever M_b C_b > 0 and D_b = 1 elsewhere.

What happens at wave vector 0 `asperity.contact.rigid_body` states.

`Mechanics` states these things in Fourier modes, for any solid. `SpringMechanics` states some of them in
terms of neighbors, for the lattice of springs in two dimensions, where a stencil costs a small part of a
transform. Fields of anchors and stretches have the branches as their first axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.contact.interface import RIGID, Interface, interface_of
from asperity.contact.problem import ContactProblem, SpectralProblem, SpringProblem
from asperity.contact.rigid_body import Prescribed, RigidBody
from asperity.contact.stencils import bond_energy, lattice_force
from asperity.errors import InputError
from asperity.lattice import Field, Lattice, Mask, Modes, Spectrum
from asperity.solids import LocalCreep, Solid, Spectra, Springs


@dataclass(frozen=True)
class Tuning:
    """Numbers of mechanics."""

    least_share: float = 1e-2
    """Least share of creeping branches in the stiffness with which anchors take up forces."""


TUNING = Tuning()


class Mechanics:
    """Any solid on a lattice, in Fourier modes.

    A local law of creep of the only branch, if it has one, takes the force of a site over ``stressed_area``,
    that of a site on a continuum, else 1. ``interface`` has the bounds of that force.
    """

    law: LocalCreep | None
    interface: Interface
    springs: Springs | None = None
    """Where forces and creep are stated in terms of neighbors."""

    def __init__(self, solid: Solid, lattice: Lattice) -> None:
        self.solid, self.lattice, self.branches = solid, lattice, len(solid.branches)
        self.law, self.stressed_area = solid.creep, lattice.cell if solid.in_lengths else 1.0
        self.interface = interface_of(solid, lattice)

    @cached_property
    def spectra(self) -> Spectra:
        """H, C_b and M_b C_b on this lattice."""
        return self.solid.on(self.lattice)

    @cached_property
    def body(self) -> RigidBody:
        """What hangs on the rigid body."""
        spectra, mean = self.spectra, self.lattice.mean
        hanging = float(spectra.permanent[mean]), spectra.creeping[mean], spectra.rate[mean]
        return RigidBody(*hanging, self.lattice.sites, bool(self.lattice.body))

    @cached_property
    def greatest_stiffness(self) -> float:
        """Largest H + sum of C_b of a wave; what holds the mean may be stiffer."""
        whole = self.spectra.permanent + self.spectra.creeping.sum(axis=0)
        return float(whole.flat[min(1, whole.size - 1) :].max())

    @cached_property
    def fastest_creep(self) -> float:
        """Largest M_b C_b, the rate at which the fastest mode creeps at a given u."""
        return float(np.max(self.spectra.rate, initial=0.0))

    @property
    def soft_modes(self) -> tuple[bool, bool]:
        """Whether nothing permanent resists some wave vectors but 0, and whether nothing resists all."""
        soft = self.implicit_step(np.inf).stiffness.flat[1:] == 0
        return bool(soft.any()), bool(soft.all())

    def implicit_step(self, tau: float) -> ImplicitStep:
        """Prepare implicit steps of duration tau >= 0, which may be infinite."""
        return ImplicitStep(self, tau)

    def force(self, u: Field, stretch: Field, held: Prescribed) -> Field:
        """Contact force H u + sum of C_b w_b at every site; a load from afar where nothing hangs."""
        return self.force_of_modes(self.lattice.forward(u), map(self.lattice.forward, stretch), held)

    def force_of_modes(self, u: Modes, stretch: Iterable[Modes], held: Prescribed) -> Field:
        """The same from Fourier modes."""
        force = self.spectra.permanent * u
        force.flat[0] -= self.body.pull(held.position)
        for stiffness, w in zip(self.spectra.creeping, stretch, strict=True):
            force += stiffness * w
        if held.load is not None and not 0 < self.body.stiffness <= self.greatest_stiffness:
            force.flat[0] = held.load  # stretches of a mean held stiffly are lost in rounding
        return self.lattice.backward(force, overwrite=True)

    def energy(self, u: Field, stretch: Field, held: Prescribed) -> float:
        """Elastic energy 1/2 sum_q [ H |u|^2 + sum of C_b |w_b|^2 ]."""
        return self.energy_of_modes(self.lattice.forward(u), map(self.lattice.forward, stretch), held)

    def energy_of_modes(self, u: Modes, stretch: Iterable[Modes], held: Prescribed) -> float:
        """The same from Fourier modes."""
        density = self.spectra.permanent * _power(u)
        density.flat[0] = self.body.permanent * abs(u.flat[0] - self.lattice.sites * held.position) ** 2
        for stiffness, w in zip(self.spectra.creeping, stretch, strict=True):
            density += stiffness * _power(w)
        return self.lattice.mean_over_modes(density) / 2

    def creeping_force(self, stretch: Field, load: float | None) -> Field:
        """Force of the springs of the only branch; where nothing hangs, its share of a load from afar."""
        creeping = self.spectra.creeping[0]
        modes = creeping * self.lattice.forward(stretch[0])
        if self.body.permanent == 0 and load is not None:
            modes.flat[0] = load
        if self.solid.loaded_from_afar:  # long waves are soft, and pass nothing from the one to the other
            modes.flat[0] *= self.creeping_share
        return self.lattice.backward(modes)

    @property
    def creeping_share(self) -> float:
        """Share of the stiffness that is in series with the local law; `InputError` if there is none."""
        if self.solid.shares is None or math.isfinite(self.solid.shares[0][1]):
            expected = "a lattice of springs, or a solid with one share of its stiffness in series with a law"
            got = "another permanent stiffness, or other creep, beside it"
            raise InputError("creep", expected=expected, got=got)
        return self.solid.shares[0][0]

    def balanced_stretch(
        self, u: Field, stretch: Field, heights: Field, total: float | None, interface: Interface
    ) -> Field:
        """Stretches with which the surface u is in exact equilibrium, near some with which it almost is.

        ``total`` is the sum of w, where it is known and the solid has one branch. Where forces are not local,
        those are the same.
        """
        del u, heights, total, interface
        return stretch

    @cached_property
    def anchors_can_balance(self) -> bool:
        """Whether a small change of the anchors balances any small force, at every wave vector but 0."""
        if self.law is not None or self.solid.springs is not None:
            return False
        creeping = self.spectra.creeping.sum(axis=0)
        enough = creeping >= TUNING.least_share * (creeping + self.spectra.permanent)
        return bool(enough.flat[1:].all())

    def balancing(self, u: Modes, stretch: Modes, in_contact: Mask, held: Prescribed) -> Modes:
        """What added to all stretches puts a surface that almost is into exact equilibrium, Fourier modes.

        All anchors move alike, such that no force is left off contact and none in contact is beyond the
        bounds; all other forces are scaled, which keeps their sum.
        """
        force = self.force_of_modes(u, stretch, held)
        balanced = self.interface.beside(held.external).admit(force, in_contact, float(force.sum()))
        balanced -= force
        change = self.lattice.forward(balanced)
        creeping = self.spectra.creeping.sum(axis=0)
        np.divide(change, creeping, out=change, where=creeping > 0)
        change.flat[0] = 0.0
        return change

    def rms(self, modes: Modes) -> float:
        """Rms over the sites of fields, one a branch, which count by the stiffness of the branches."""
        power = np.asarray(sum(w * _power(field) for w, field in zip(self.weights, modes, strict=True)))
        return float(np.sqrt(self.lattice.mean_over_modes(power) / self.lattice.sites))

    @cached_property
    def weights(self) -> Spectrum:
        """C_b over the sum of C_b, at each wave vector: how much the error of a branch counts."""
        total = self.spectra.creeping.sum(axis=0)
        even = 1.0 / max(self.branches, 1)
        shares = np.full_like(self.spectra.creeping, even)
        return np.asarray(np.divide(self.spectra.creeping, total, out=shares, where=total > 0))


@dataclass(frozen=True, eq=False)
class ImplicitStep:
    """An implicit step of creep of duration ``tau``: D_b, C_b D_b and S of the module's formulas."""

    mechanics: Mechanics
    tau: float

    @cached_property
    def damping(self) -> Spectrum:
        """D_b."""
        rate = self.mechanics.spectra.rate
        return np.where(rate > 0, 0.0, 1.0) if np.isinf(self.tau) else 1.0 / (1.0 + self.tau * rate)

    @cached_property
    def damped_stiffness(self) -> Spectrum:
        """C_b D_b."""
        return self.mechanics.spectra.creeping * self.damping

    @cached_property
    def stiffness(self) -> Spectrum:
        """S."""
        if self.mechanics.branches == 0:
            return self.mechanics.spectra.permanent
        return np.asarray(self.mechanics.spectra.permanent + self.damped_stiffness.sum(axis=0))

    @cached_property
    def load_controlled_stiffness(self) -> Spectrum:
        """S where the load is prescribed: 0 at wave vector 0."""
        stiffness = self.stiffness
        if stiffness.flat[0] != 0:
            stiffness = stiffness.copy()
            stiffness.flat[0] = 0.0
        return stiffness

    def problem(self, heights: Field, anchors: Field | float, held: Prescribed) -> ContactProblem:
        """The contact problem of a step from anchors v_b, or from flat ones at a level.

        ``held`` is what is prescribed at its end; the maximum of the heights is 0.
        """
        return self.spectral_problem(heights, self.modes_of(anchors), held)

    def problem_of_modes(self, heights: Field, anchors: Modes, held: Prescribed) -> ContactProblem:
        """The same from the Fourier modes of the anchors."""
        return self.spectral_problem(heights, anchors, held)

    def spectral_problem(self, heights: Field, anchors: Modes, held: Prescribed) -> SpectralProblem:
        """The same in Fourier modes."""
        rhs = np.einsum("b...,b...->...", self.damped_stiffness, anchors)
        mechanics, lattice, stiffness = self.mechanics, self.mechanics.lattice, self.stiffness
        if held.load is None:
            rhs.flat[0] += mechanics.body.pull(held.position)
        else:
            stiffness = self.load_controlled_stiffness
            rhs.flat[0] = -held.load
        return SpectralProblem(lattice, heights, stiffness, rhs, mechanics.interface)

    def stretch(self, u: Field, anchors: Field, held: Prescribed) -> tuple[Field, float]:
        """Stretches w_b = u - u_b after the step, from the solved u and the anchors before it, and X."""
        lattice = self.mechanics.lattice
        modes, position = self.stretch_modes(lattice.forward(u), lattice.forward(anchors), held)
        return lattice.backward(modes), position

    def stretch_modes(self, u: Modes, anchors: Modes, held: Prescribed) -> tuple[Modes, float]:
        """The same in Fourier modes, in the place of the anchors."""
        mean, modes = self.mechanics.lattice.mean, anchors
        before, surface = anchors[mean].real.copy(), float(u.flat[0].real)
        np.subtract(u, modes, out=modes)
        modes *= self.damping
        if held.load is None:
            return modes, held.position
        how = self.damping[mean], held.load, held.position
        modes[mean], position = self.mechanics.body.after_step(surface, before, *how)
        return modes, position

    def modes_of(self, anchors: Field | float) -> Modes:
        """Fourier modes of anchors, or of flat ones at a level."""
        if not isinstance(anchors, float):
            return self.mechanics.lattice.forward(anchors)
        flat = self.mechanics.lattice.flat_modes(anchors)
        return np.repeat(flat[np.newaxis], self.mechanics.branches, axis=0)


class SpringMechanics(Mechanics):
    """The lattice of springs in two dimensions, k1 > 0, whose surface never yields, in terms of neighbors."""

    springs: Springs

    def __init__(self, solid: Solid, lattice: Lattice, springs: Springs) -> None:
        super().__init__(solid, lattice)
        self.springs, self.interface = springs, RIGID
        self.body = RigidBody(0.0, np.array([springs.k1]), np.array([springs.drag]), lattice.sites)
        self.greatest_stiffness = 8 * springs.k0 + springs.k1
        self.fastest_creep = 8 * springs.spread + springs.drag

    @property
    def soft_modes(self) -> tuple[bool, bool]:
        """All where k0 = 0, unless nothing creeps, else none."""
        soft = self.springs.k0 == 0 and self.springs.creep
        return soft, soft

    def implicit_step(self, tau: float) -> SpringImplicitStep:
        """See `Mechanics`."""
        return SpringImplicitStep(self, tau)

    def force(self, u: Field, stretch: Field, held: Prescribed) -> Field:
        """See `Mechanics`."""
        del held
        springs = self.springs
        return lattice_force(u, stretch[0], springs.k0, springs.k1, mirrored=self.lattice.reflecting)

    def creep_rate(self, stretch: Field) -> Field:
        """Rates d u_b / dt = M_b C_b w_b."""
        w, mirrored = stretch[0], self.lattice.reflecting
        return lattice_force(w, w, self.springs.spread, self.springs.drag, mirrored=mirrored)[np.newaxis]

    def creeping_force(self, stretch: Field, load: float | None) -> Field:
        """See `Mechanics`."""
        del load
        return np.asarray(self.springs.k1 * stretch[0])

    def energy(self, u: Field, stretch: Field, held: Prescribed) -> float:
        """See `Mechanics`."""
        del held
        bulk = float(np.einsum("ij,ij->", stretch[0], stretch[0]))
        bonds = bond_energy(u, mirrored=self.lattice.reflecting)
        return (self.springs.k0 * bonds + self.springs.k1 * bulk) / 2

    def balanced_stretch(
        self, u: Field, stretch: Field, heights: Field, total: float | None, interface: Interface
    ) -> Field:
        """See `Mechanics`."""
        mirrored = self.lattice.reflecting
        return balanced(self.springs, u, stretch[0], heights, total, interface, mirrored=mirrored)[np.newaxis]


@dataclass(frozen=True, eq=False)
class SpringImplicitStep(ImplicitStep):
    """An implicit step of the lattice of springs, whose problem is stated in terms of neighbors."""

    mechanics: SpringMechanics

    def problem(self, heights: Field, anchors: Field | float, held: Prescribed) -> SpringProblem:
        """See `ImplicitStep`."""
        return SpringProblem(
            heights,
            self.mechanics.springs.step(self.tau),
            anchors if isinstance(anchors, float) else anchors[0],
            held.load,
            self.mechanics.lattice.reflecting,
            lambda: self.spectral_problem(heights, self.modes_of(anchors), held),
        )

    def problem_of_modes(self, heights: Field, anchors: Modes, held: Prescribed) -> SpringProblem:
        """See `ImplicitStep`."""
        return self.problem(heights, self.mechanics.lattice.backward(anchors), held)


def _power(modes: Modes) -> Spectrum:
    """Squared magnitudes."""
    return np.asarray(modes.real**2 + modes.imag**2)


def balanced(
    springs: Springs,
    u: Field,
    w: Field,
    heights: Field,
    total: float | None,
    interface: Interface,
    *,
    mirrored: bool,
) -> Field:
    """Stretch of springs with which u is in equilibrium, near w, with a total where that is known."""
    k1, beside = springs.k1, lattice_force(u, w, springs.k0, 0.0, mirrored=mirrored)
    load = None if total is None else k1 * total
    stretch = interface.admit(beside + k1 * w, u <= heights, load)
    stretch -= beside
    stretch /= k1
    return stretch


def mechanics_of(solid: Solid, lattice: Lattice) -> Mechanics:
    """Mechanics of a solid on a lattice: in terms of neighbors where there is such a form.

    Where the interface yields, forces are found in Fourier modes: multigrid knows no bound.
    """
    springs = solid.springs
    if springs is None or lattice.dimension != 2 or springs.k1 == 0 or solid.yields:
        return Mechanics(solid, lattice)
    return SpringMechanics(solid, lattice, springs)
