r"""TR-BDF2 for creep that is local and not linear; stages on fields.

The creeping shape is measured from the rigid body, whose position X is prescribed or follows from the load:

    stage 1   v = u_c + d h f0            stage 2   v = u_c + w h (f0 + f1)
    each:     solve u - X - u_c' = C^-1 s,  u_c' = v + d h V(s),  for u, s, X;  f = (u_c' - v) / (d h)

V(s) is the velocity under the forces s of the creeping springs, by a local law and by linear creep beside
it. Under a load the mean of u_c grows for ever; X takes it in after each step, and ``crept`` counts it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.tr_bdf2 import Aim, Arrays, Attempt, Extent, Origin, State, TrBdf2, rms
from asperity.aging.tr_bdf2 import Stage as TimeStage
from asperity.contact import Contact
from asperity.contact.anchors import AnchorFields
from asperity.contact.arrays import largest
from asperity.contact.choice import local_solver
from asperity.contact.local_creep import LocalState, Stage
from asperity.contact.problem import ContactSolver
from asperity.contact.stencils import combined, extrapolated
from asperity.contact.system import System
from asperity.lattice import Field


class LocalSteps(TrBdf2):
    """A creeping state of a solid whose creep is local and not linear.

    ``states`` are the present one and those before it, latest first; their positions include all that has
    crept. ``shape`` is u_c from the rigid body, without its mean ``crept`` where the load is prescribed,
    ``rates`` are its velocities at the start of the step and at the ends ``tried`` of its stages.
    """

    kind, through = "laws", 3

    def __init__(self, system: System, solver: ContactSolver, arrays: Arrays) -> None:
        del solver  # the law decides
        super().__init__(system, arrays)
        self.solver = local_solver(system)
        states = zip(arrays["u"], arrays["force"], arrays["position"].tolist(), strict=True)
        self.states = [LocalState(*state) for state in states]
        self.crept, self.begun_at = float(arrays["crept"]), float(arrays["begun_at"])
        self.shape = arrays["shape"]
        self.rates, self.tried = [arrays["rate"]], self.states[:1]

    @classmethod
    def begin(cls, system: System, solver: ContactSolver, start: Contact) -> LocalSteps | None:
        """See `Steps`."""
        if system.mechanics.law is None:
            return None
        u, (shape,), _, position = start.relative
        u, shape = np.array(u), np.array(shape)
        force = system.mechanics.creeping_force((u - shape)[np.newaxis], system.load)
        check_stress(system, force)
        arrays = {
            "times": np.zeros(2),
            "u": u[np.newaxis],
            "force": force[np.newaxis],
            "position": np.zeros(1),
            "shape": shape,
            "rate": local_solver(system).velocity(force),
            "crept": np.zeros(()),
            "begun_at": np.array(position),
        }
        return cls(system, solver, arrays)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """See `TrBdf2`."""
        names = "u", "force", "position"
        fields = {name: [getattr(state, name) for state in self.states] for name in names}
        others = {"shape": self.shape, "rate": self.rates[0], "crept": self.crept, "begun_at": self.begun_at}
        return {name: np.array(value) for name, value in (fields | others).items()}

    @property
    def position(self) -> float:
        """How far the rigid body has moved since the beginning."""
        return self.states[0].position

    def approach(self, origin: Origin, separation: float) -> float:
        """See `Steps`."""
        return -self.position if self.system.load is not None else super().approach(origin, separation)

    def state(self) -> State:
        """See `Steps`."""
        now = self.states[0]
        stretch = self.solver.balanced(now, self.system.at(self.time).load)
        return State(now.u, AnchorFields((now.u - stretch)[np.newaxis]), self.begun_at + self.position)

    def extent(self) -> Extent:
        """See `Steps`."""
        u, force = self.states[0].u, self.states[0].force
        greatest = max(largest(u, np), self.solver.indented(force))
        return Extent(float(u.std()), rms(self.solver.stretch(force)), greatest)

    def speed(self) -> float:
        """See `Steps`."""
        return rms(self._about_mean(self.rates[0]))

    def prepare(self, tau: float) -> None:
        """See `TrBdf2`."""
        del tau
        self.tried, self.rates = [], self.rates[:1]

    def solve(self, stage: TimeStage) -> int:
        """See `TrBdf2`."""
        before = combined(self.shape, *zip(stage.creeps, self.rates, strict=True))
        system, again = self.system.at(stage.time), stage.is_last
        position = self.system.moved(0.0, stage.time) + self.crept
        problem = Stage(stage.tau, before, system.load, position, again=again)
        guess = self._extrapolated(stage.weights)
        self.run = self.solver.solve(problem, guess, stage.allowed_error)
        end = self.run.state()
        rate = combined(end.u, (-1.0, self.solver.stretch(end.force)), (-1.0, before))
        rate -= end.position
        rate /= stage.tau
        self.tried.append(LocalState(end.u, end.force, end.position - self.crept))
        self.rates.append(rate)
        return self.run.iterations

    def _extrapolated(self, weights: Sequence[float]) -> LocalState:
        """A guess, whose position goes with the present shape."""
        past = [*self.tried[::-1], *self.states]
        latest, earlier = past[0], past[1:]
        terms = list(zip(weights[1:], earlier, strict=False))
        u = extrapolated(latest.u, *((weight, state.u) for weight, state in terms))
        force = extrapolated(latest.force, *((weight, state.force) for weight, state in terms))
        ahead = sum(weight * (state.position - latest.position) for weight, state in terms)
        return LocalState(u, force, latest.position + ahead + self.crept)

    def attempt(self, duration: float, aim: Aim) -> Attempt:
        """See `Steps`; under a load nothing holds the mean back, so that what a step errs by in it stays."""
        attempt = super().attempt(duration, aim)
        if attempt.failure or self.system.load is None:
            return attempt
        end = self.tried[-1]
        mean = float(np.mean(end.u - self.solver.stretch(end.force))) - end.position
        return replace(attempt, mean_error=self.mean_error, mean=abs(mean))

    def filtered_error(self, shares: Sequence[float]) -> float:
        """See `TrBdf2`; the law is linear beside the end."""
        first, *rates = self.rates
        defect = combined(shares[0] * first, *zip(shares[1:], rates, strict=True))
        mean, error = self.run.filtered_error(self._about_mean(defect))
        self.mean_error = abs(float(defect.mean()) + mean)
        return error

    def _about_mean(self, field: Field) -> Field:
        """A field less its mean, where the load decides that."""
        return field - field.mean() if self.system.load is not None else field

    def advance(self) -> None:
        """See `TrBdf2`."""
        end = self.tried[-1]
        check_stress(self.system, end.force)
        self.shape = end.u - self.solver.stretch(end.force)
        self.shape -= end.position + self.crept
        if self.system.load is not None:
            mean = float(self.shape.mean())
            self.shape -= mean
            self.crept += mean
        self.states, self.rates = [end, *self.states][: self.through], self.rates[-1:]
        self.u, self.system = end.u, self.system.lowered(end.u)
        self.solver.heights = self.system.heights.reshape(self.solver.heights.shape)


def check_stress(system: System, force: Field) -> None:
    """Refuse forces under which the law is not to be used."""
    assert system.mechanics.law is not None
    system.mechanics.law.check_stress(largest(force, np) / system.mechanics.stressed_area)
