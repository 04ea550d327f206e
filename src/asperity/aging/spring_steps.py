r"""TR-BDF2 on the lattice of springs, by multigrid.

`asperity.contact.multigrid.stages` solves both stages of a step in corrections to the state where it
starts. Each begins from the polynomial in the logarithm of time, in which contacts grow evenly, that passes
through the ends of the last two steps and the stage before; so good a guess that one cycle often does.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.step_errors import PASSING, rms
from asperity.aging.tr_bdf2 import (
    DIAGONAL,
    ERROR_WEIGHTS,
    WEIGHT,
    Aim,
    Attempt,
    Extent,
    Point,
    State,
    Step,
    take_step,
)
from asperity.contact.active_set import ActiveSet
from asperity.contact.mechanics import SpringMechanics
from asperity.contact.multigrid import Multigrid, StageSolver
from asperity.contact.multigrid.loops import Single
from asperity.contact.state import Contact
from asperity.contact.system import System
from asperity.lattice import Field

_LARGEST_WEIGHTS = 12.0
"""Largest sum of the magnitudes of the weights of an extrapolation: the factor on errors of the values."""


class SpringSteps:
    """A creeping state on the lattice of springs, solved by multigrid.

    Attributes
    ----------
    stages
        The state and its stage solver.
    times
        Those of the state, of the one before and of the one before that, where there were any.
    mean_u0
        Mean of u0 where the separation is prescribed, a length.
    origin
        Time of the end of the first step.
    forgetting
        Whether the error of a step is what is left of it when the next state is published. That costs cycles,
        and saves steps where many contacts close or open, and always where no springs join neighbors.
    by_fields
        The step that was tried, where cycles did not solve it.
    """

    def __init__(self, system: System, solver: Multigrid, arrays: Mapping[str, NDArray[Any]]) -> None:
        assert isinstance(system.mechanics, SpringMechanics)
        self.system, self.max_cycles = system, solver.max_cycles
        self.stages = solver.stages(system.mechanics, system.heights, arrays)
        self.times: list[float] = arrays["times"].tolist()
        self.mean_u0, self.origin = map(float, arrays["scales"][2:4])
        self.forgetting = bool(arrays["scales"][4])
        self.by_fields: Step | None = None

    @classmethod
    def begin(cls, system: System, solver: Multigrid, start: Contact) -> SpringSteps:
        """At the start of a history."""
        assert isinstance(system.mechanics, SpringMechanics)
        u, stretch = np.maximum(start.u - system.datum, system.heights), start.u - start.anchors
        (rate,), w = system.creep_rate(stretch), stretch[0]
        arrays = StageSolver.arrays(solver.work_on(system.mechanics), u, w, rate)
        arrays["scales"] = np.append(
            arrays["scales"], [u.mean() - w.mean(), 0.0, system.mechanics.springs.k0 == 0]
        )
        return cls(system, solver, {**arrays, "times": np.array([0.0])})

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """See `Steps`."""
        arrays = self.stages.resume_state()
        scales = np.append(arrays["scales"], [self.mean_u0, self.origin, self.forgetting])
        return {**arrays, "scales": scales, "times": np.array(self.times)}

    @property
    def time(self) -> float:
        """Time of the state."""
        return self.times[0]

    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the time step that was tried."""
        if self.by_fields is not None:
            return int(np.count_nonzero(self.by_fields.end.u <= self.system.heights))
        return self.stages.contacts_tried

    def state(self) -> State[Field]:
        """See `Steps`; the mean of w is exact: what creep conserves must not drift."""
        u, w = self.stages.u, self.stages.w
        mean = self.system.at(self.time).mean_stretch
        if mean is None:
            mean = float(u.mean()) - self.mean_u0
        stretch = w + (mean - float(w.mean()))
        return State(u, stretch[np.newaxis], self.mean_u0)

    def extent(self) -> Extent:
        """How large the deformation is."""
        return Extent(*self.stages.spread())

    def speed(self) -> float:
        """Rate of u0, rms over the sites."""
        return rms(self.stages.rate_of_u0)

    def attempt(self, duration: float, aim: Aim) -> Attempt:
        """Try a time step; the tolerances are for the Fourier solver, where cycles do not converge."""
        cycles = 0
        self.by_fields = None
        if self.system.control.load_controlled or self.stages.moments.contacts > 0:
            done, cycles, error = self._attempt(duration, aim)
            if done:
                return Attempt(error, cycles)
        point = Point.of(self.system, self.time, *self.state())
        step = take_step(self.system, ActiveSet(), duration, point, None, tolerances=aim.tolerances)
        self.by_fields = step
        return Attempt(step.error, cycles + step.iterations)

    def _attempt(self, duration: float, aim: Aim) -> tuple[bool, int, float]:
        """Whether both stages were solved, the cycles taken and the error of the step."""
        stages, tau = self.stages, DIAGONAL * duration
        # Where errors of steps count by what is left of them, those of stages are not to be larger.
        share = PASSING if self.forgetting else 1.0
        allowed = [share * error for error in aim.allowed_errors]
        # Logarithms of time, but for times that are short against the first step.
        origin = self.origin or duration
        points = [math.log(time + origin) for time in self.times]
        middle, end = (math.log(self.time + h + origin) for h in (2 * DIAGONAL * duration, duration))

        _, *weights = extrapolation(points, middle)
        stages.begin(tau, WEIGHT * duration, weights)
        done, cycles = self._improve(2 * tau, allowed[0])
        if not done:
            return False, cycles, math.nan
        growth, _, *weights = extrapolation([middle, *points], end)
        stages.begin_second(growth, weights)
        done, more = self._improve(duration, allowed[1])
        if not done:
            return False, cycles + more, math.nan
        error = stages.finish([duration * part for part in ERROR_WEIGHTS])
        return True, cycles + more, self._left(error, max(aim.published - self.time - duration, 0.0))

    def _left(self, error: Single, ahead: float) -> float:
        """What is left of the error of the step that was tried, a length; see `take_step`."""
        stages = self.stages
        if not self.forgetting:
            touching = stages.moments.contacts / self.system.sites
            return stages.unit * self.system.damped_rms(error, stages.tau, touching)
        left = stages.left_of(error, stages.tau)
        if ahead > 0 and not stages.work.opened:
            left = max(PASSING * left, stages.left_of(error, stages.tau + ahead))
        return left

    def _improve(self, ahead: float, allowed_error: float) -> tuple[bool, int]:
        """Solve the stage that ends a time ahead; whether it was solved, and the cycles taken."""
        mean = self.system.at(self.time + ahead).mean_stretch
        return self.stages.improve(mean, self.system.drift, allowed_error, self.max_cycles)

    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""
        self.times = [time, *self.times][:3]
        self.origin = self.origin or time
        if self.by_fields is not None:
            end, lattice = self.by_fields.end, self.system.mechanics.lattice
            u, (w,), (rate,) = end.u, lattice.backward(end.stretch), lattice.backward(end.rate(self.system))
            if self.system.control.load_controlled:
                rate -= rate.mean()
            self.stages.replace(u, w, rate)
            self.mean_u0 = float(u.mean()) - float(w.mean())
            return
        if self.system.free_mean or self.system.drift:
            self.mean_u0 += self.stages.mean_change_of_u0()
        self.stages.advance()


def extrapolation(known: Sequence[float], x: float) -> list[float]:
    """Weights of the values at known points, the latest first, that give the value at x.

    Lagrange's polynomial through the latest points: as many as make no weight too large, at least two.
    """
    for count in range(len(known), 1, -1):
        points = known[:count]
        weights = [math.prod((x - b) / (a - b) for b in points if b != a) for a in points]
        if count == 2 or sum(map(abs, weights)) <= _LARGEST_WEIGHTS:
            return weights + [0.0] * (len(known) - count)
    return [1.0]
