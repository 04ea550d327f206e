r"""TR-BDF2 for any solid, whose contact problems any solver solves.

Anchors, stretches and rates are Fourier modes, so that a branch costs no transform. Nor does the filter of
the error estimate: the contact fraction of the error decays as where u = 0, the rest as on a free surface.
Beside the solution with fixed contacts this is too large by up to a half, seldom by more than 2 %.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.tr_bdf2 import Arrays, Extent, Stage, State, TrBdf2, rms
from asperity.contact.anchors import AnchorFields, AnchorModes
from asperity.contact.arrays import largest
from asperity.contact.choice import solved
from asperity.contact.contact import Contact
from asperity.contact.mechanics import ImplicitStep
from asperity.contact.problem import Accuracy, ContactSolver, Guess
from asperity.contact.stencils import extrapolated
from asperity.contact.system import System
from asperity.lattice import Field, Modes


@dataclass(frozen=True, eq=False)
class Point:
    """A state relative to the datum: the surface and its modes, modes of w_b, and the body's position."""

    u: Field
    modes: Modes
    stretch: Modes
    position: float


class FieldSteps(TrBdf2):
    """A creeping state of any solid.

    ``earlier`` are the surfaces before the state ``point``; ``tried`` the state and the ends of the stages
    that were tried.
    """

    kind, through = "fields", 2
    implicit: ImplicitStep

    def __init__(self, system: System, solver: ContactSolver, arrays: Arrays) -> None:
        super().__init__(system, arrays)
        self.solver, u = solver, arrays["u"]
        modes = system.mechanics.lattice.forward(u)
        self.point = Point(u, modes, arrays["stretch"], float(arrays["position"]))
        self.earlier = list(arrays["earlier"])
        self.tried = [self.point]
        # Whether contact problems are solved no better than a step needs: what that leaves off contact is
        # balanced where a state is published.
        self.eager = system.mechanics.anchors_can_balance

    @classmethod
    def begin(cls, system: System, solver: ContactSolver, start: Contact) -> FieldSteps:
        """At the start of a history."""
        u, anchors, _, position = start.relative
        return cls.going_on(system, solver, 0.0, np.array(u), u - anchors, position)

    @classmethod
    def going_on(
        cls, system: System, solver: ContactSolver, time: float, u: Field, stretch: Field, position: float
    ) -> FieldSteps:
        """From the state that other steps have reached."""
        arrays = {
            "times": np.array([time, time]),
            "u": u,
            "stretch": system.mechanics.lattice.forward(stretch),
            "position": np.array(position),
            "earlier": np.empty((0, *u.shape)),
        }
        return cls(system, solver, arrays)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """See `TrBdf2`."""
        point, earlier = self.point, np.reshape(self.earlier, (-1, *self.point.u.shape))
        return {
            "u": point.u,
            "stretch": point.stretch,
            "position": np.array(point.position),
            "earlier": earlier,
        }

    def state(self) -> State:
        """See `Steps`."""
        point, mechanics = self.point, self.system.mechanics
        system = self.system.at(self.time).pulled(point.u)
        if not self.eager:
            before = mechanics.lattice.backward(point.stretch)
            stretch = system.balanced_stretch(point.u, before)
            return State(point.u, AnchorFields(point.u - stretch), point.position, rms(stretch - before))
        held, touching = system.held(point.position), point.u <= system.heights
        change = mechanics.balancing(point.modes, point.stretch, touching, held)
        moved = mechanics.rms(np.broadcast_to(change, point.stretch.shape))
        return State(point.u, AnchorModes((point.modes - change) - point.stretch), point.position, moved)

    def extent(self) -> Extent:
        """See `Steps`."""
        u, stretch = self.point.u, self.system.mechanics.rms(self.point.stretch)
        return Extent(float(u.std()), stretch, largest(u, np))

    def speed(self) -> float:
        """See `Steps`."""
        system, mechanics = self.system, self.system.mechanics
        rate = mechanics.spectra.rate * self.point.stretch
        rate[mechanics.lattice.mean] += system.drift * system.sites
        return mechanics.rms(rate)

    def prepare(self, tau: float) -> None:
        """See `TrBdf2`."""
        self.tried, self.implicit = [self.point], self.system.mechanics.implicit_step(tau)

    def solve(self, stage: Stage) -> int:
        """See `TrBdf2`; problems are solved to the error allowed, where that can be balanced."""
        system, mechanics, start = self.system, self.system.mechanics, self.point
        lattice = mechanics.lattice
        numbers = (-1.0, 0.0)[: len(stage.creeps)]
        before = self._combined(start.modes, numbers, stage.creeps)
        before[lattice.mean] += system.moved(self.time, stage.time) * system.sites
        held = system.at(stage.time).held(start.position)
        problem = self.implicit.problem_of_modes(system.heights, before, held)
        latest = self.tried[-1]
        surfaces = [*(point.u for point in reversed(self.tried[:-1])), *self.earlier]
        ahead = extrapolated(latest.u, *zip(stage.weights[1:], surfaces, strict=False))
        guess = Guess(ahead, last=latest.u)
        accuracy = Accuracy(stage.tolerance)
        if self.eager:
            accuracy = Accuracy(stage.tolerance, stage.allowed_error)
        solution = solved(self.solver, problem, guess, accuracy)
        if stage.is_last:  # steps begin with modes that are exact
            modes = lattice.forward(solution.u)
        else:
            modes = lattice.forward_near(solution.u, latest.u, latest.modes)
        stretch, position = self.implicit.stretch_modes(modes, before, held)
        self.tried.append(Point(solution.u, modes, stretch, position))
        return solution.iterations

    def _combined(self, u: Modes | float, numbers: Sequence[float], durations: Sequence[float]) -> Modes:
        """Modes u + sum of (n_i + t_i rate_b) w_b,i over the points i that were tried, one field a branch."""
        modes = np.empty_like(self.point.stretch)
        modes[...] = u
        for number, duration, point in zip(numbers, durations, self.tried, strict=True):
            for total, rate, w in zip(modes, self.system.mechanics.spectra.rate, point.stretch, strict=True):
                total += (number + duration * rate) * w
        return modes

    def filtered_error(self, shares: Sequence[float]) -> float:
        """See `TrBdf2` and the module."""
        step, system = self.implicit, self.system
        error = self._combined(0.0, (0.0, 0.0, 0.0), shares)
        u, stiffness = np.einsum("b...,b...->...", step.damped_stiffness, error), step.stiffness
        if system.load is not None:  # the load decides the mean
            stiffness = step.load_controlled_stiffness
        free = 1.0 - self.contacts_tried() / system.sites
        u *= np.divide(free, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0)
        error -= u
        error *= step.damping
        error += u
        if system.load is not None:
            error[system.mechanics.lattice.mean] = 0.0
        return system.mechanics.rms(error)

    def advance(self) -> None:
        """See `TrBdf2`."""
        self.earlier = [self.point.u, *self.earlier][: self.through - 1]
        self.point = self.tried[-1]
        self.u, self.tried = self.point.u, [self.point]
        self.system = self.system.lowered(self.point.u)
