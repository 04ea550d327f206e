r"""TR-BDF2 on the lattice of springs, by multigrid.

`asperity.contact.multigrid.stages` solves both stages of a step in corrections to the state where it
starts, which are guessed so well that one cycle often does. Cycles also find what an implicit step leaves of
an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.tr_bdf2 import DIAGONAL, WEIGHT, Arrays, Extent, Stage, State, TrBdf2, rms
from asperity.contact.mechanics import SpringMechanics
from asperity.contact.multigrid import Multigrid, StageSolver
from asperity.contact.state import Contact
from asperity.contact.system import System
from asperity.errors import ConvergenceError
from asperity.lattice import Field


class SpringSteps(TrBdf2):
    """A creeping state on the lattice of springs, solved by multigrid.

    Attributes
    ----------
    stages
        The state and its stage solver.
    mean_u0
        Mean of u0 where the separation is prescribed, a length.
    """

    kind, through = "springs", 3

    def __init__(self, system: System, solver: Multigrid, arrays: Arrays) -> None:
        super().__init__(system, arrays)
        assert isinstance(system.mechanics, SpringMechanics)
        self.max_cycles = solver.max_cycles
        self.stages = solver.stages(system.mechanics, system.heights, arrays)
        self.mean_u0 = float(arrays["mean_u0"])

    @classmethod
    def begin(cls, system: System, solver: Multigrid, start: Contact) -> SpringSteps:
        """At the start of a history."""
        assert isinstance(system.mechanics, SpringMechanics)
        u, stretch = np.maximum(start.u - system.datum, system.heights), start.u - start.anchors
        (rate,), w = system.creep_rate(stretch), stretch[0]
        arrays = StageSolver.arrays(solver.work_on(system.mechanics), u, w, rate)
        arrays |= {"mean_u0": np.array(u.mean() - w.mean()), "times": np.zeros(2)}
        return cls(system, solver, arrays)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """See `TrBdf2`."""
        return self.stages.resume_state() | {"mean_u0": np.array(self.mean_u0)}

    def contacts_tried(self) -> int:
        """See `Steps`."""
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
        """See `Steps`."""
        return Extent(*self.stages.spread())

    def speed(self) -> float:
        """See `Steps`."""
        return rms(self.stages.rate_of_u0)

    def solve(self, stage: Stage) -> int:
        """See `TrBdf2`."""
        stages, tau = self.stages, stage.tau
        if stage.is_last:
            growth, _, *weights = stage.weights
            stages.begin_second(growth, weights)
        else:
            stages.begin(tau, tau * (WEIGHT / DIAGONAL), stage.weights[1:])
        mean, drift = self.system.at(stage.time).mean_stretch, self.system.drift
        done, cycles = stages.improve(mean, drift, stage.allowed_error, self.max_cycles)
        if not done:
            raise ConvergenceError(
                f"aging: {cycles} cycles did not solve a step of {tau:.1e}; "
                "try Multigrid(max_cycles=...) with more, or solver=asperity.ActiveSet()"
            )
        return cycles

    def left_of(self, shares: Sequence[float]) -> float:
        """See `TrBdf2`."""
        error = self.stages.finish(shares)
        if self.system.control.load_controlled:  # the load decides the mean
            error -= error.mean(dtype=np.float64).astype(error.dtype)
        return self.stages.left_of(error, self.stages.tau)

    def advance(self) -> None:
        """See `TrBdf2`."""
        if self.system.free_mean or self.system.drift:
            self.mean_u0 += self.stages.mean_change_of_u0()
        self.stages.advance()
