r"""Steps of a slide: between two shifts each branch remembers the surface exactly, by few contact problems.

A step of length h has a contact problem at each of the times h (0.1, 0.4, 1) after its start. Between them
u is the polynomial in ln(t + o) through all surfaces of the step, as free sites follow a shift like the
logarithm of the time t since then. The anchors of that u are exact, over any number of decades of rates r_b:

    u_b(s) = exp(-r_b s) u_b(0) + r_b int_0^s exp(-r_b (s - s')) u(s') ds' = k_b u_b(0) + sum_i W_b,i u(s_i)

The last weight makes it an implicit step: w_b = (1 - W_b,last) (u - v_b), where v_b is known. Integrals are
exact for u linear between places so near that this adds no error. The difference from the polynomial that
leaves out the first time estimates the error.

A slide repeats itself, so contact problems are guessed by the surface at the same time after the last shift,
moved with the rough surface, and by what the one before differs by from its guess.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.aging.field_steps import FieldSteps, Point
from asperity.aging.tr_bdf2 import Aim, Arrays, Attempt, extrapolation
from asperity.contact import instantaneous
from asperity.contact.choice import solved
from asperity.contact.contact import Contact
from asperity.contact.mechanics import ImplicitStep
from asperity.contact.problem import Accuracy, ContactSolver, Guess
from asperity.contact.stencils import combined
from asperity.contact.system import System
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Modes, Spectrum


@dataclass(frozen=True)
class Tuning:
    """Numbers chosen by measurement."""

    nodes: tuple[float, ...] = (0.1, 0.4, 1.0)
    """Times of contact problems, over the length of a step."""

    origin: float = 0.05
    """Where logarithms of time begin after a shift, over the length of the first step."""

    places: int = 24
    """Pieces of a step on which u is linear."""

    kept: int = 8
    """Steps of different lengths whose weights are kept, as those of the next shift have the same."""


TUNING = Tuning()


class Memory(NamedTuple):
    """The part ``kept`` of the anchors, and ``weights`` of the surfaces of a step in them, for each rate."""

    kept: Spectrum
    weights: list[Spectrum]

    @classmethod
    def of(cls, rates: Spectrum, times: Sequence[float], origin: float) -> Memory:
        """At the last of the times, for the polynomial through all of them, from 0 on."""
        logs = [math.log(time + origin) for time in times]
        places = np.geomspace(origin, origin + times[-1], TUNING.places + 1)
        kept, weights = np.ones_like(rates), [np.zeros_like(rates) for _ in times]
        values = [extrapolation(logs, log) for log in np.log(places).tolist()]
        for duration, begin, end in zip(np.diff(places), values, values[1:], strict=False):
            lapse = rates * duration
            left, damping = np.exp(-lapse), np.ones_like(rates)
            np.divide(-np.expm1(-lapse), lapse, out=damping, where=lapse > 0)
            kept *= left
            for weight, first, last in zip(weights, begin, end, strict=True):
                weight *= left
                weight += (damping - left) * first + (1 - damping) * last
        return cls(kept, weights)


@dataclass(frozen=True, eq=False)
class RememberedStep(ImplicitStep):
    """An implicit step after which anchors have a ``weight`` of the surface at its end."""

    weight: Spectrum

    @cached_property
    def damping(self) -> Spectrum:
        """See `ImplicitStep`."""
        return np.broadcast_to(1 - self.weight, self.mechanics.spectra.rate.shape)


class SlideSteps(FieldSteps):
    """A creeping state after a shift.

    ``surfaces`` are those of the contact problems since the shift, ``past`` those since the last shift, moved
    along, and ``length`` is that of the first step after a shift.
    """

    kind, through = "slides", 1

    def __init__(self, system: System, solver: ContactSolver, arrays: Arrays) -> None:
        super().__init__(system, solver, arrays)
        self.surfaces, self.past = list(arrays["surfaces"]), list(arrays["past"])
        self.length, self.iterations = float(arrays["length"]), 0
        self.memories: dict[tuple[float, float], list[Memory]] = {}
        self.rates = rates = system.mechanics.spectra.rate
        fastest = rates.max(axis=tuple(range(1, rates.ndim)), keepdims=True)
        if system.body.stiffness == 0 and (rates == fastest).reshape(len(rates), -1)[:, 1:].all():
            self.rates = fastest  # the same at all waves, and nothing creeps at wave vector 0

    @classmethod
    def resting(cls, system: System, solver: ContactSolver, start: Contact) -> SlideSteps:
        """At the beginning of a slide."""
        none = np.empty((0, *system.heights.shape))
        more = {"surfaces": none, "past": none, "length": np.array(math.inf)}
        return cls(system, solver, FieldSteps.begin(system, solver, start).resume_state() | more)

    @classmethod
    def suits(cls, system: System, solver: Any) -> bool:
        """Whether creep is linear and fades, and cycles of multigrid do not go faster."""
        mechanics = system.mechanics
        linear = mechanics.branches > 0 and mechanics.law is None and not (system.yields or system.sticks)
        return linear and not (hasattr(solver, "work_on") and solver.suits(mechanics))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """See `TrBdf2`."""
        shape = -1, *self.point.u.shape
        fields = {"surfaces": np.reshape(self.surfaces, shape), "past": np.reshape(self.past, shape)}
        return super().arrays() | fields | {"length": np.array(self.length)}

    def shifted(self, heights: Field, sites: Sequence[int], accuracy: Accuracy) -> SlideSteps:
        """The state below heights that have moved by about so many sites, u with an error if that can be."""
        system, start, axes = self.system.above(heights), self.point, tuple(range(heights.ndim))
        lattice, drop = system.mechanics.lattice, self.system.datum - system.datum
        u, *past = (np.roll(u + drop, sites, axes) for u in (start.u, *self.surfaces))
        anchors = start.modes - start.stretch
        anchors[lattice.mean] += drop * system.sites
        now = copy(self)
        now.system, now.times, now.origin, now.past, now.surfaces = system, [], 0.0, past, []
        now.point = Point(u, start.modes, start.stretch, start.position + drop)
        now.tried = [now.point]
        if not self.eager:  # the anchors cannot balance what is left
            accuracy = Accuracy(instantaneous.TUNING.strict * accuracy.residual)
        now.iterations = now.reach(system.mechanics.implicit_step(0.0), anchors, u, accuracy)
        now.accept(0.0)
        return now

    def attempt(self, duration: float, aim: Aim) -> Attempt:
        """See `Steps` and the module."""
        mechanics, spent, last = self.system.mechanics, 0, len(TUNING.nodes) - 1
        self.tried, (*memories, rough) = [self.point], self.remembered(duration)
        try:
            for n, memory in enumerate(memories):
                before = self.summed(memory)
                before /= 1 - memory.weights[-1]
                accuracy = Accuracy(aim.tolerances[n == last])
                if self.eager:
                    accuracy = Accuracy(accuracy.residual, aim.allowed_errors[n == last])
                step = RememberedStep(mechanics, duration, memory.weights[-1])
                spent += self.reach(step, before, self.tried[-1].u, accuracy)
        except ConvergenceError as failure:
            return Attempt(math.inf, spent, failure)
        error = self.summed(rough)
        error *= np.exp(-self.rates * aim.left)
        if self.system.load is not None:  # the load decides the mean
            error[mechanics.lattice.mean] = 0.0
        if self.time == 0:
            self.length = math.inf if aim.left == 0 else duration
        return Attempt(mechanics.rms(error), spent)

    def remembered(self, duration: float) -> list[Memory]:
        """What is remembered at the times of a step; the last is what that may be wrong by at its end."""
        # Equal shifts last equally long but for rounding.
        begun, duration = key = float(f"{self.time:.12g}"), float(f"{duration:.12g}")
        if key not in self.memories:
            if len(self.memories) == TUNING.kept:
                self.memories.clear()
            origin = begun + TUNING.origin * (self.origin or duration)
            times = [0.0, *(duration * node for node in TUNING.nodes)]
            memories = [Memory.of(self.rates, times[: n + 2], origin) for n in range(len(TUNING.nodes))]
            none = np.zeros_like(self.rates)
            first, *others = Memory.of(self.rates, [0.0, *times[2:]], origin).weights
            weights = zip(memories[-1].weights, [first, none, *others], strict=True)
            rough = Memory(none, [fine - coarse for fine, coarse in weights])
            self.memories[key] = [*memories, rough]
        return self.memories[key]

    def summed(self, memory: Memory) -> Modes:
        """Modes of what is remembered of the start and of the surfaces tried; all from the body's place."""
        mean, start = self.system.mechanics.lattice.mean, self.point
        anchors = np.empty_like(start.stretch)
        for branch, total in enumerate(anchors):  # one by one, which stays in the cache
            np.multiply(memory.kept[branch], start.modes - start.stretch[branch], out=total)
            for weight, point in zip(memory.weights, self.tried, strict=False):
                total += weight[branch] * point.modes
        for weight, point in zip(memory.weights, self.tried, strict=False):
            anchors[mean] -= weight[mean] * ((point.position - start.position) * self.system.sites)
        return anchors

    def reach(self, step: ImplicitStep, before: Modes, guess: Field, accuracy: Accuracy) -> int:
        """Solve a contact problem above anchors v_b, which this overwrites; returns the iterations."""
        system, lattice, latest = self.system, self.system.mechanics.lattice, self.tried[-1].u
        if (number := len(self.surfaces) + len(self.tried) - 1) < len(self.past):
            guess = self.past[number]
            if number:
                guess = combined(guess, (1.0, latest), (-1.0, self.past[number - 1]))
        held = system.held(self.point.position)
        problem = step.problem_of_modes(system.heights, before, held)
        solution = solved(self.solver, problem, Guess(guess, last=latest), accuracy)
        modes = lattice.forward(solution.u)
        self.tried.append(Point(solution.u, modes, *step.stretch_modes(modes, before, held)))
        return solution.iterations

    def advance(self) -> None:
        """See `TrBdf2`."""
        self.surfaces += [point.u for point in self.tried[1:]]
        super().advance()
