r"""TR-BDF2 for creep that is local and not linear; the stages of `asperity.aging.tr_bdf2` on fields.

The creeping shape is measured from the rigid body, whose position X is prescribed or follows from the load:

    stage 1   v = u_c + d h f0            stage 2   v = u_c + w h (f0 + f1)
    each:     solve u - X - u_c' = C^-1 s,  u_c' = v + d h V(s),  for u, s, X;  f = (u_c' - v) / (d h)

V(s) is the velocity under the forces s of the creeping springs, by a local law and by linear creep beside
it. Under a load the mean of u_c grows for ever; X takes it in after each step, and ``crept`` counts it.
Each stage starts from the polynomial in the logarithm of time through the states before it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.spring_steps import extrapolation
from asperity.aging.step_errors import rms
from asperity.aging.tr_bdf2 import DIAGONAL, ERROR_WEIGHTS, WEIGHT, Aim, Attempt, Extent, State
from asperity.contact.arrays import largest
from asperity.contact.choice import local_solver
from asperity.contact.local_creep import LocalState, Stage
from asperity.contact.state import Contact
from asperity.contact.stencils import combined, extrapolated
from asperity.contact.system import System
from asperity.errors import ConvergenceError
from asperity.lattice import Field

_KEPT = 3
"""States from which to extrapolate."""


@dataclass(frozen=True, eq=False)
class _Moment:
    """A state and its time; its position counts from the beginning, with all that has crept."""

    time: float
    state: LocalState


class LocalSteps:
    """A creeping state of a solid whose creep is local and not linear.

    Attributes
    ----------
    moments
        The state and the two before it, the latest first.
    shape
        The creeping shape u_c, from the rigid body, its mean taken out where the load is prescribed.
    rate
        Its velocity at the end of the last step.
    crept
        What has been taken out.
    """

    def __init__(self, system: System, arrays: Mapping[str, NDArray[Any]]) -> None:
        self.system, self.solver = system, local_solver(system)
        self.moments = [
            _Moment(time, LocalState(arrays[f"u_{n}"], arrays[f"force_{n}"], position))
            for n, (time, position) in enumerate(arrays["moments"].tolist())
        ]
        self.shape, self.rate = arrays["shape"], arrays["rate"]
        self.crept, self.origin = arrays["crept"].tolist()
        self.tried = self.moments[0].state
        self.tried_rate = self.rate
        self.known_extent: Extent | None = None

    @classmethod
    def begin(cls, system: System, start: Contact) -> LocalSteps:
        """At the start of a history."""
        u = np.maximum(start.u - system.datum, system.heights)
        shape = start.anchors[0] - system.datum
        force = system.mechanics.creeping_force((u - shape)[np.newaxis], system.load)
        law, solver = system.mechanics.law, local_solver(system)
        assert law is not None
        law.check_stress(largest(force, np) / system.mechanics.stressed_area)
        arrays = {
            "moments": np.zeros((1, 2)),
            "u_0": u,
            "force_0": force,
            "shape": shape,
            "rate": solver.velocity(force),
            "crept": np.zeros(2),
        }
        return cls(system, arrays)

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """See `Steps`."""
        arrays = {
            "moments": np.array([(moment.time, moment.state.position) for moment in self.moments]),
            "shape": self.shape,
            "rate": self.rate,
            "crept": np.array([self.crept, self.origin]),
        }
        for n, moment in enumerate(self.moments):
            arrays[f"u_{n}"], arrays[f"force_{n}"] = moment.state.u, moment.state.force
        return arrays

    @property
    def time(self) -> float:
        """Time of the state."""
        return self.moments[0].time

    @property
    def position(self) -> float:
        """How far the rigid body has moved since the beginning."""
        return self.moments[0].state.position

    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the time step that was tried."""
        return int(np.count_nonzero(self.tried.u <= self.system.heights))

    def state(self) -> State[Field]:
        """See `Steps`."""
        now = self.moments[0].state
        stretch = self.solver.balanced(now, self.system.at(self.time).load)
        return State(now.u, stretch[np.newaxis], float(now.u.mean() - stretch.mean()))

    def extent(self) -> Extent:
        """How large the deformation is."""
        if self.known_extent is None:
            u, force = self.moments[0].state.u, self.moments[0].state.force
            greatest = max(largest(u, np), self.solver.indented(force))
            self.known_extent = Extent(float(u.std()), rms(self.solver.stretch(force)), greatest)
        return self.known_extent

    def speed(self) -> float:
        """Rate of the creeping shape, rms over the sites."""
        return rms(self._about_mean(self.rate))

    def attempt(self, duration: float, aim: Aim) -> Attempt:
        """Try a time step; one whose stages are not solved has an infinite error."""
        try:
            return self._attempt(duration, aim.allowed_errors)
        except ConvergenceError:
            return Attempt(math.inf, 0)

    def _attempt(self, duration: float, allowed_errors: tuple[float, float]) -> Attempt:
        tau, f0, known = DIAGONAL * duration, self.rate, self.moments
        before = combined(self.shape, (tau, f0))
        middle, f1, spent, _ = self._stage(tau, self.time + 2 * tau, before, known, allowed_errors[0], False)
        known = [_Moment(self.time + 2 * tau, middle), *known]
        before = combined(self.shape, (WEIGHT * duration, f0), (WEIGHT * duration, f1))
        end, f2, more, stage = self._stage(tau, self.time + duration, before, known, allowed_errors[1], True)
        first, second, third = ERROR_WEIGHTS
        defect = combined(f0, (second / first, f1), (third / first, f2))
        defect *= duration * first
        left = self.solver.damped(self._about_mean(defect), stage, self._in_frame(end))
        self.tried, self.tried_rate = end, f2
        return Attempt(rms(self._about_mean(left)), spent + more)

    def _stage(
        self,
        tau: float,
        time: float,
        before: Field,
        known: list[_Moment],
        allowed_error: float,
        again: bool,
    ) -> tuple[LocalState, Field, int, Stage]:
        """Solve the stage that ends at a time; its end, the rate there, and the iterations spent."""
        system = self.system.at(time)
        stage = Stage(tau, before, system.load, self.system.drift * time + self.crept, again=again)
        guess = self._in_frame(self._extrapolated(known, time))
        end, spent = self.solver.solve(stage, guess, allowed_error)
        rate = combined(end.u, (-1.0, self.solver.stretch(end.force)), (-1.0, before))
        rate -= end.position
        rate /= tau
        return LocalState(end.u, end.force, end.position - self.crept), rate, spent, stage

    def _in_frame(self, state: LocalState) -> LocalState:
        """A state whose position goes with the present shape."""
        return LocalState(state.u, state.force, state.position + self.crept)

    def _extrapolated(self, known: list[_Moment], time: float) -> LocalState:
        # Logarithms of time, but for times that are short against the first step.
        origin = self.origin or known[0].time or time
        weights = extrapolation([math.log(moment.time + origin) for moment in known], math.log(time + origin))
        latest, *earlier = (moment.state for moment in known)

        position = latest.position
        for weight, state in zip(weights[1:], earlier, strict=True):
            position += weight * (state.position - latest.position)
        u, force = (
            extrapolated(
                getattr(latest, name),
                *((w, getattr(state, name)) for w, state in zip(weights[1:], earlier, strict=True) if w),
            )
            for name in ("u", "force")
        )
        return LocalState(u, force, position)

    def _about_mean(self, field: Field) -> Field:
        """A field less its mean, where the load decides that."""
        return field - field.mean() if self.system.control.load_controlled else field

    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""
        end = self.tried
        law = self.system.mechanics.law
        assert law is not None
        law.check_stress(largest(end.force, np) / self.system.mechanics.stressed_area)
        self.origin = self.origin or time
        self.shape = end.u - self.solver.stretch(end.force)
        self.shape -= end.position + self.crept
        self.rate = self.tried_rate
        if self.system.control.load_controlled:
            mean = float(self.shape.mean())
            self.shape -= mean
            self.crept += mean
        self.moments = [_Moment(time, end), *self.moments][:_KEPT]
        self.known_extent = None
        self.system = self.system.lowered(end.u)
        self.solver.heights = self.system.heights.reshape(self.solver.heights.shape)
