r"""The exact contact of a separable solid under a load that never falls.

If all stiffnesses are multiples of one, K, with shares g_b and times tau_b, the force on the surface is

    r = K [ u - sum_b g_b u_b ],        tau_b d u_b/dt = u - u_b .

While no site loses contact, u is the surface of an elastic solid of stiffness K under the effective load

    L = F + sum_b g_b L_b ,             tau_b d L_b/dt = L - L_b ,

that is E* times the integral of J(t - s) dF(s) with the creep compliance J (E. H. Lee, J. R. M. Radok, J.
Appl. Mech. 27, 438 (1960), DOI 10.1115/1.3644020; T. C. T. Ting, J. Appl. Mech. 33, 845 (1966), DOI
10.1115/1.3625192). L never falls if F does not. So one elastic contact gives u and the contacts at any time,
with no error of time steps. The anchors, and with them the forces, are averages of u over the past: u is
taken as linear in L between the ends of a step, which keeps the balance of forces exact, and the error of
that is what the length of the steps is chosen by.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.controller import step_tolerance
from asperity.aging.tr_bdf2 import Aim, Attempt, Extent, State, Steps
from asperity.contact.anchors import AnchorModes
from asperity.contact.arrays import largest
from asperity.contact.choice import solved
from asperity.contact.contact import Contact
from asperity.contact.problem import TOLERANCE, Accuracy, ContactSolver, Guess, SpectralProblem
from asperity.contact.system import System
from asperity.lattice import Field, Spectrum
from asperity.relaxation import PronySeries, interlacing


@dataclass(frozen=True)
class Tuning:
    """Numbers chosen by measurement."""

    flat: float = 1e-3
    """Largest elastic force off contact, over the mean in contact, of a surface of an elastic solid.

    Solvers leave up to 1e-4 at the default rtol. A load that fell by a millionth leaves 1e-3 where the rim
    was.
    """

    safety: float = 2.0
    """Factor on the error of u between two steps."""

    ahead: float = 2.0
    """Largest extrapolation of u beyond a step, in units of that step."""

    pieces: int = 32
    """Pieces, linear in time, of the longest time step that follows the load."""


TUNING = Tuning()


class EffectiveLoad:
    """The effective loads L_b of branches of given shares and times, exact for loads linear in time.

    In the variables sqrt(g tau) L_b the equations are symmetric: D - w w^T with D = 1/tau, w = sqrt(g/tau).
    Its eigenvalues are the rates of retardation, known to full accuracy over any number of decades.
    """

    def __init__(self, shares: Field, times: Field) -> None:
        self.shares, self.times = shares, times
        g, tau = interlacing.merged(shares, times)
        self.which = np.abs(np.log(times[:, np.newaxis] / tau)).argmin(axis=1)
        series = PronySeries(1.0, tuple(zip(g.tolist(), tau.tolist(), strict=True)))
        _, retardation, fluidity = series.retardation
        self.rates = np.append(1 / retardation, [0.0] if fluidity else [])
        distance = 1 / tau[:, np.newaxis] - self.rates
        least = np.finfo(float).eps / tau[:, np.newaxis]
        distance = np.where(np.abs(distance) < least, least, distance)
        modes = np.sqrt(g / tau)[:, np.newaxis] / distance
        self.modes = modes / np.linalg.norm(modes, axis=0)
        self.forcing, self.scale = self.modes.T @ np.sqrt(g / tau), np.sqrt(g * tau)

    def after(self, loads: Field, load: float, rate: float, duration: float) -> Field:
        """L_b a time later, while the load grows from a value at a rate."""
        merged = np.zeros_like(self.scale)
        merged[self.which] = loads
        y = self.modes.T @ (self.scale * merged)
        x = self.rates * duration
        small = x < 1e-8
        rates = np.where(small, 1.0, self.rates)
        once = np.where(small, duration, -np.expm1(-x) / rates)
        twice = np.where(small, duration**2 / 2, (duration - once) / rates)
        y = np.exp(-x) * y + self.forcing * (load * once + rate * twice)
        return np.asarray((self.modes @ y / self.scale)[self.which])


class SeparableSteps(Steps):
    """A creeping state of a separable solid above a surface that keeps its contacts; see the module.

    ``loads`` are L and all L_b, ``modes`` and ``anchors`` Fourier modes of u and of u_b; ``before`` and
    ``load_before`` are u and L at the end of the step before.
    """

    kind = "exact"

    def __init__(self, system: System, solver: ContactSolver, arrays: Mapping[str, NDArray[Any]]) -> None:
        self.system, self.solver = system, solver
        self.time, self.load_before, *loads = arrays["loads"].tolist()
        self.loads = np.array(loads)
        self.u, self.before, self.anchors = arrays["u"], arrays["before"], arrays["anchors"].copy()
        self.modes = system.mechanics.lattice.forward(self.u)
        self.stiffness, shares, times = parts_of(system)
        self.effective = EffectiveLoad(shares, times)
        self.tried = self.u, self.loads
        self.eager = system.mechanics.anchors_can_balance

    @classmethod
    def begin(cls, system: System, solver: ContactSolver, start: Contact) -> SeparableSteps | None:
        """See `Steps`; they suit a surface and anchors that are those of an elastic solid."""
        control = system.control
        suits = start.solid.separable and len(start.anchors)
        if not (suits and system.load is not None and control.rises):
            return None
        u, anchors, in_contact, _ = start.relative
        free = ~in_contact
        if not free.any():
            return None
        stiffness, shares, _ = parts_of(system)
        if not (shares > 0).all():
            return None
        loads = []
        for surface in (u, *anchors):
            force = system.mechanics.lattice.apply(stiffness, surface)
            lifted = force[free]
            loads.append(-float(lifted.mean()) * system.sites)
            if largest(lifted - lifted.mean(), np) > TUNING.flat * max(loads[0], 0.0) / max(start.area, 1):
                return None
        parts = np.array(loads[1:])
        most = TUNING.flat * loads[0]
        if not -most <= parts.min() <= parts.max() <= loads[0] + most:
            return None
        parts = np.maximum(parts, 0.0)
        loads = [0.0, 0.0, control.value + float(shares @ parts), *parts]
        modes = system.mechanics.lattice.forward(anchors)
        flat = np.zeros_like(u)  # as before any load
        return cls(system, solver, {"loads": np.array(loads), "u": u, "before": flat, "anchors": modes})

    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the time step that was tried."""
        return int(np.count_nonzero(self.tried[0] <= self.system.heights))

    def state(self) -> State:
        """See `Steps`."""
        mechanics, now, stretch = self.system.mechanics, self.system.at(self.time), self._stretch()
        body, load = mechanics.body, now.load
        assert load is not None
        if body.creeping.any():  # the stiffness at wave vector 0 is the solid's own
            stretch[mechanics.lattice.mean] = (self.loads[0] - self.loads[1:]) / body.stiffness
            load = float(self.loads[0])
        drop = load / body.stiffness if body.stiffness > 0 else 0.0
        position = float(self.u.mean()) - drop / self.system.sites
        held, touching = now.held(position), self.u <= self.system.heights
        change = mechanics.balancing(self.modes, stretch, touching, held) if self.eager else 0.0
        moved = mechanics.rms(np.broadcast_to(change, stretch.shape))
        return State(self.u, AnchorModes((self.modes - change) - stretch), position, moved)

    def extent(self) -> Extent:
        """How large the deformation is."""
        stretch = self._stretch()
        return Extent(float(self.u.std()), self.system.mechanics.rms(stretch), largest(self.u, np))

    def speed(self) -> float:
        """Rate of the anchors, rms over the sites."""
        mechanics = self.system.mechanics
        return mechanics.rms(mechanics.spectra.rate * self._stretch())

    def attempt(self, duration: float, aim: Aim) -> Attempt:
        """Find the contact a time later; the error is that of the anchors."""
        system, effective = self.system, self.effective
        pieces = max(1, math.ceil(TUNING.pieces * duration / system.control.longest))
        times = np.linspace(self.time, self.time + duration, pieces + 1).tolist()
        loads, parts = [system.control.at(time).value for time in times], self.loads[1:]
        for begin, end in pairwise(loads):
            length = duration / pieces
            parts = np.maximum(effective.after(parts, begin, (end - begin) / length, length), parts)
        load = loads[-1]
        total = max(load + float(effective.shares @ parts), float(self.loads[0]))
        ahead = self._ahead(total)
        u = self.u + ahead * (self.u - self.before)
        guess = Guess(u)
        lattice = system.mechanics.lattice
        rhs = lattice.flat_modes(-total / system.sites)
        problem = SpectralProblem(lattice, system.heights, self.stiffness, rhs)
        # Forces relax; what is left off contact and not balanced stays in the anchors, so it is to be small.
        accuracy = Accuracy(TOLERANCE * load / total)
        if self.eager:
            accuracy = Accuracy(aim.tolerances[1], aim.allowed_errors[1])
        solution = solved(self.solver, problem, guess, accuracy)
        error = 0.0
        if ahead > 0:
            surprise = solution.u - self.u - ahead * (self.u - self.before)
            error = float(np.std(surprise)) * ahead / (1 + ahead) / 4
        self.tried = solution.u, np.array([total, *parts])
        # Anchors are averages of u, so errors of steps do not add up, as the controller expects of errors.
        relative = TUNING.safety * error / aim.deformation if error > 0 else 0.0
        return Attempt(aim.deformation * step_tolerance(relative), solution.iterations)

    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""
        lattice, (u, loads) = self.system.mechanics.lattice, self.tried
        kept = np.exp(-(time - self.time) / self.effective.times)
        grown = float(loads[0] - self.loads[0])
        share = loads[1:] - kept * self.loads[1:] - (1 - kept) * self.loads[0]
        share = np.clip(share / grown, 0.0, 1 - kept) if grown > 0 else 0 * share
        start, end = self.modes, lattice.forward(u)
        for anchor, old, new in zip(self.anchors, kept, share, strict=True):
            anchor *= old
            anchor += (1 - old - new) * start + new * end
        self.before, self.load_before = self.u, float(self.loads[0])
        self.u, self.modes, self.loads, self.time = u, end, loads, time

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """See `Steps`."""
        loads = np.array([self.time, self.load_before, *self.loads])
        return {"loads": loads, "u": self.u, "before": self.before, "anchors": self.anchors.copy()}

    def _ahead(self, load: float) -> float:
        """How far a load is beyond the present one, over how far that is beyond the one before."""
        last = float(self.loads[0]) - self.load_before
        return min((load - float(self.loads[0])) / last, TUNING.ahead) if last > 0 else 0.0

    def _stretch(self) -> NDArray[np.complex128]:
        """Fourier modes of w_b, without the mean."""
        stretch = self.modes - self.anchors
        stretch[self.system.mechanics.lattice.mean] = 0.0
        return np.asarray(stretch)


def parts_of(system: System) -> tuple[Spectrum, Field, Field]:
    """K, 0 at wave vector 0, with the shares and the times of the branches of a separable solid."""
    spectra = system.mechanics.spectra
    stiffness = spectra.permanent + spectra.creeping.sum(axis=0)
    stiffness.flat[0] = 0.0
    shares, times = np.array(system.mechanics.solid.shares).T
    return stiffness, shares, times
