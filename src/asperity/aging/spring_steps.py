r"""TR-BDF2 on the lattice of springs, by multigrid, in corrections to the state where a step starts.

With e and f the changes of u and of w = u - u0 since then, and m = M C w the flow at the start, both stages
of `asperity.aging.tr_bdf2` are implicit steps of one duration tau = d h from one state:

    (spread L + 1 + drag) f - e = c + shift,      c = -tau (f0 + m)             to t + 2 d h
                                                  c = -w h (f0 + f1) - tau m    to t + h
    f1 = (e - f) / tau - f0,                      f2 = (e - f - w h (f0 + f1)) / tau

Guesses are so good that one cycle often suffices; one cycle of the coarse grids filters the error estimate.
Changes, rates and the flow are in single precision and in units of the largest length; u and w at the ends of
steps, to which they are added, are in double precision.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.field_steps import FieldSteps
from asperity.aging.tr_bdf2 import DIAGONAL, WEIGHT, Arrays, Extent, Stage, State, TrBdf2, rms
from asperity.contact import Contact
from asperity.contact.anchors import AnchorFields
from asperity.contact.arrays import largest
from asperity.contact.multigrid import Multigrid, operations
from asperity.contact.multigrid.loops import Measured, Pair, Past, Scales, Single, Surface
from asperity.contact.multigrid.operations import Found
from asperity.contact.multigrid.two_fields import working_stiffness
from asperity.contact.system import System
from asperity.errors import ConvergenceError
from asperity.lattice import Field


class SpringSteps(TrBdf2):
    """A creeping state u and w on the lattice of springs, solved by multigrid.

    In units of ``unit`` are the changes of u and w in the last two steps, the rate of u0 at its end and the
    flow M C w. ``moments`` are sums over the state, rises above ``level``; ``offset`` is what f lacks after a
    stage for the mean of w to be exact, and ``mean_u0`` that of u0 where the separation is prescribed. Rates
    have velocities ``drifts`` of the rigid body in them that take it to where it is at the ends of stages.
    """

    kind, through = "springs", 3

    def __init__(self, system: System, solver: Multigrid, arrays: Arrays) -> None:
        super().__init__(system, arrays)
        mechanics: Any = system.mechanics
        self.springs, self.solver, self.max_cycles = mechanics.springs, solver, solver.max_cycles
        self.k0 = working_stiffness(self.springs.k0, self.springs.k1)
        self.work = solver.work_on(mechanics)
        self.heights = np.ascontiguousarray(system.heights)
        self.u, self.w, self.rate = arrays["u"], arrays["stretch"], arrays["rate"]
        self.unit, self.level = map(float, arrays["scales"][:2])
        self.mean_u0, self.offset, self.tau, self.weight = float(arrays["mean_u0"]), 0.0, 0.0, 0.0
        self.drifts = [float(arrays["drift"])]
        self.changes = [Pair(*(arrays[name] for name in names)) for names in _CHANGES]
        self.flow, self.middle = self.work.fields()
        self.error = np.zeros_like(self.flow)
        self.work.clear()
        self.work.bound.fill(-np.inf)
        self.settle(0.0)

    @classmethod
    def begin(cls, system: System, solver: Any, start: Contact) -> SpringSteps | None:
        """See `Steps`; they suit a solver that has cycles on fields of changes."""
        mechanics: Any = system.mechanics
        if not (hasattr(solver, "work_on") and solver.suits(mechanics) and mechanics.springs.creep):
            return None
        if start.area == 0 and system.load is None:
            return None  # it hangs, and its surface is known to the last digit
        u, anchors, *_ = start.relative
        u, stretch = np.array(u), u - anchors
        (rate,), w = mechanics.creep_rate(stretch), stretch[0]
        rate += -rate.mean() if system.load is not None else system.drift  # the load decides its mean
        work, unit = solver.work_on(mechanics), max(largest(u, np), largest(w, np)) or 1.0
        arrays: dict[str, NDArray[Any]] = {"u": u, "stretch": w, "rate": operations.packed(rate / unit)}
        for names in _CHANGES:
            arrays |= zip(names, work.fields(), strict=True)
        means = {"scales": [unit, u.mean()], "mean_u0": u.mean() - w.mean(), "drift": system.drift}
        arrays |= {name: np.array(value) for name, value in means.items()}
        return cls(system, solver, arrays | {"times": np.zeros(2)})

    def arrays(self) -> dict[str, NDArray[Any]]:
        """See `TrBdf2`."""
        arrays: dict[str, NDArray[Any]] = {"u": self.u, "stretch": self.w, "rate": self.rate}
        for names, change in zip(_CHANGES, self.changes, strict=True):
            arrays |= zip(names, change, strict=True)
        means = {"scales": [self.unit, self.level], "mean_u0": self.mean_u0, "drift": self.drifts[0]}
        return arrays | {name: np.array(value) for name, value in means.items()}

    def contacts_tried(self) -> int:
        """See `Steps`."""
        return int(np.count_nonzero(self.work.correction.e <= self.work.bound))

    def instead(self) -> FieldSteps:
        """See `Steps`: near rest rounding in single precision, and what cycles leave, look like errors."""
        return FieldSteps.going_on(
            self.system, self.solver, self.time, self.u, self.stretch()[np.newaxis], self.mean_u0
        )

    def state(self) -> State:
        """See `Steps`."""
        stretch = self.system.at(self.time).balanced_stretch(self.u, self.stretch()[np.newaxis])
        return State(self.u, AnchorFields(self.u - stretch), self.mean_u0)

    def stretch(self) -> Field:
        """The field w; its mean is exact, for what creep conserves must not drift."""
        mean = self.system.body.stretch(self.system.at(self.time).load)
        if mean is None:
            mean = float(self.u.mean()) - self.mean_u0
        return self.w + (mean - float(self.w.mean()))

    def extent(self) -> Extent:
        """See `Steps`."""
        m, count = self.moments, self.u.size
        spread = math.sqrt(max(m.squares_u / count - (m.rise / count) ** 2, 0.0))
        return Extent(spread, math.sqrt(m.squares_w / count), m.largest)

    def speed(self) -> float:
        """See `Steps`."""
        return rms(self.unit * operations.unpacked(self.rate, self.work.sites))

    def prepare(self, tau: float) -> None:
        """See `TrBdf2`."""
        s = self.springs
        self.tau, self.weight, self.drifts = tau, tau * (WEIGHT / DIAGONAL), self.drifts[:1]
        self.work.prepare(s.k1 / self.k0, tau * s.spread, tau * s.drag)

    def solve(self, stage: Stage) -> int:
        """See `TrBdf2`."""
        work, tau, size = self.work, stage.tau, self.u.size
        _, *weights = stage.weights
        numbers = 0.0, 0.0, tau, 0.0
        if stage.is_last:
            growth, _, *weights = stage.weights
            numbers = growth, self.offset, self.weight, self.weight
        places = self.middle, work.bound, work.correction, work.source.f, work.sites
        e, f, source = (value / size for value in operations.guess(self.past(weights), numbers, *places))
        mean = self.system.body.stretch(self.system.at(stage.time).load)
        moved = np.dot(stage.creeps, self.drifts) - self.system.moved(self.time, stage.time)
        self.drifts.append(float(-moved / tau))
        moved = float(moved / self.unit)
        wanted = None if mean is None else (mean * size - self.moments.stretch) / self.unit
        shift = moved if wanted is None else work.mean_lag * f - e - source
        work.begin(wanted, self.moments.stretch / self.unit, shift)
        done, cycles = work.improve(stage.allowed_error / self.unit, self.max_cycles)
        if not done:
            work.clear()  # it may be no number, and the next guess takes 0 times it
            raise ConvergenceError(
                f"aging: {cycles} cycles did not solve a step of {tau:.1e}; "
                "try Multigrid(max_cycles=...) with more, or solver=asperity.ActiveSet()"
            )
        e, f = map(self.mean, work.correction)
        due = (e + source + moved) / work.mean_lag if wanted is None else wanted / size
        self.offset = due - f
        return cycles

    def past(self, weights: Sequence[float]) -> Past:
        """Weights of the last two changes from those of where they led from, relative to where they led."""
        (last, before), (a, b) = self.changes, (*weights, 0.0, 0.0)[:2]
        ahead, back, tau = map(np.float32, (-a - b, -b, self.tau))
        return Past(last, before, ahead, back, self.rate, self.flow, tau)

    def mean(self, field: Single) -> float:
        """Mean of a field of the corrections."""
        return operations.total(field, self.work.sites) / self.u.size

    def filtered_error(self, shares: Sequence[float]) -> float:
        """See `TrBdf2`."""
        work = self.work
        rates = self.rate, self.middle, work.source.f
        numbers = self.offset, self.tau, self.weight, *shares
        operations.finish(work.correction, rates, numbers, self.error, work.sites)
        if drift := np.dot(shares, self.drifts):  # how the rigid body moves is no error
            self.error -= np.float32(drift / self.unit)
        return self.unit * work.filtered_error(self.error)[1]

    def advance(self) -> None:
        """See `TrBdf2`."""
        work, (last, before) = self.work, self.changes
        if self.system.free_mean or any(self.drifts):
            e, f = map(self.mean, work.correction)
            self.mean_u0 += self.unit * (e - f - self.offset)
        self.settle(self.unit * self.offset)
        self.drifts = self.drifts[-1:]
        self.changes, work.correction = [work.correction, last], before
        self.rate, work.source = work.source.f, Pair(work.source.e, self.rate)

    def settle(self, offset: float) -> None:
        """Add the corrections, and an offset to w, and prepare for steps from there."""
        work = self.work
        surface, into = Surface(self.u, self.w, self.heights), Measured(work.bound, work.source.e, self.flow)
        scales = Scales(self.k0 * self.unit, self.unit, self.level)
        operations.settle(surface, work.correction, work.bound, self.unit, offset)
        self.moments: Found = operations.measure(
            surface, self.springs, 0.0, scales, into, work.sites, flowing=True
        )


_CHANGES = [(f"change_{n}_u", f"change_{n}_stretch") for n in range(2)]
"""Names of the arrays of changes."""
