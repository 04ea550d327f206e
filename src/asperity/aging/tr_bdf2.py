r"""TR-BDF2: the second-order, L-stable method by which anchors creep; each stage is a contact problem.

One step of length h from anchors u_b with rates f0_b = M_b C_b (u - u_b), for all branches at once:

    stage 1   v = u_b + d h f0                   (trapezoid to t + 2 d h)
    stage 2   v = u_b + w h (f0 + f1)            (backward differences to t + h)
    each:     solve the implicit step of duration d h from v for u and u_b, then f = M_b C_b (u - u_b)

    d = 1 - 1/sqrt 2,   w = sqrt 2 / 4

Stage 2 is the result (stiffly accurate). The difference to the companion of order three,

    e = h [ (1 - 4 w)/3 f0 + 1/3 f1 - 2 d/3 f2 ],

estimates its error after a filter: one more implicit step of duration d h from e, with the same contacts.
Without it, parts that decay quickly, above all in contact, would be overrated. Each kind of steps
approximates it. Branches count by their stiffness. What is prescribed enters at the stages' own times, and
u_b is measured from the rigid body: v moves with it from the beginning of the step to the end of a stage.
Each stage is guessed by the polynomial in the logarithm of time, in which contacts grow evenly, through the
states before it.
(R. E. Bank et al., IEEE Trans. Electron Devices 32, 1992 (1985),
DOI 10.1109/T-ED.1985.22232; M. E. Hosea, L. F. Shampine, Appl. Numer. Math. 20, 21 (1996),
DOI 10.1016/0168-9274(95)00115-8.)
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from asperity.contact.anchors import Anchors
from asperity.contact.arrays import largest
from asperity.contact.contact import Contact
from asperity.contact.controls import Control
from asperity.contact.problem import ContactSolver
from asperity.contact.system import System
from asperity.errors import ConvergenceError, InputError, PulledOff
from asperity.lattice import Field, Mask

DIAGONAL = 1.0 - 1.0 / math.sqrt(2.0)
WEIGHT = math.sqrt(2.0) / 4.0
ERROR_WEIGHTS = ((1 - 4 * WEIGHT) / 3, 1 / 3, -2 * DIAGONAL / 3)

LONGEST = 1e30
"""Longest time, in units of the time in which the fastest mode creeps; single precision ends at 1e38."""

Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class Attempt:
    """Outcome of a time step that is tried.

    ``error`` is that of u0, rms over the sites; infinite where a stage was not solved, as ``failure`` says.
    ``mean_error`` is that of how far the mean of u0 creeps in the step, and ``mean`` how far it has crept at
    its end; 0 where nothing but the error of u0 is to be judged.
    """

    error: float
    iterations: int
    failure: ConvergenceError | PulledOff | None = None
    mean_error: float = 0.0
    mean: float = 0.0


class Aim(NamedTuple):
    """Tolerances of the contact problems of a step, the last one's apart, and errors of u0 allowed instead.

    Errors are relative to the ``deformation``. A time ``left`` is from the end of the step to the next frame.
    """

    tolerances: tuple[float, float]
    allowed_errors: tuple[float, float]
    deformation: float = math.nan
    left: float = 0.0


class Stage(NamedTuple):
    """One stage of a time step: when it ends, and the duration ``tau`` = d h of its implicit step.

    v ``creeps`` for so long at each rate that is known: d h at f0, or w h at f0 and f1. The ``weights`` are
    those of states before it that guess its end, the latest first. See `Aim` for the rest.
    """

    time: float
    tau: float
    creeps: tuple[float, ...]
    weights: Sequence[float]
    tolerance: float
    allowed_error: float

    @property
    def is_last(self) -> bool:
        """Whether it ends the time step."""
        return len(self.creeps) > 1


@dataclass(frozen=True)
class Extent:
    """How large a deformation is: u about its mean and w, rms over the sites, and the largest u; lengths."""

    spread: float
    stretch: float
    largest: float


class State(NamedTuple):
    """A state to publish: u, the anchors with which it is in exact equilibrium, and the body's position.

    Anchors have ``moved`` by so much, rms, from where they crept, to balance what a solver left.
    """

    u: Field
    anchors: Anchors
    position: float
    moved: float = 0.0


@dataclass
class Origin:
    """What the rigid approach is measured from.

    That is the mean of u0 at the start, and the integral of the load over time since then, where the load is
    prescribed.
    """

    separation: float
    impulse: float = 0.0

    def passed(self, control: Control, since: float, time: float) -> None:
        """Count a time step, by Simpson's rule."""
        if control.load_controlled:
            begin, middle, end = (control.at(t).value for t in (since, (since + time) / 2, time))
            self.impulse += (begin + 4 * middle + end) / 6 * (time - since)


class Steps(ABC):
    """A creeping state at a time, which takes time steps; fields relative to the system's datum."""

    kind: ClassVar[str]
    """What checkpoints and frames call it."""

    system: System
    time: float
    u: Field

    @property
    def touching(self) -> Mask:
        """Which sites are in contact."""
        return self.u <= self.system.heights

    @classmethod
    @abstractmethod
    def begin(cls, system: System, solver: ContactSolver, start: Contact) -> Self | None:
        """At the start of a history; None where these steps do not suit."""

    def instead(self) -> Steps | None:
        """Steps that go on from here where these get nowhere."""
        return None

    def check(self, stops: Field) -> None:
        """Refuse times that these steps cannot reach."""
        del stops

    @abstractmethod
    def contacts_tried(self) -> int:
        """Number of sites in contact at the end of the time step that was tried."""

    @abstractmethod
    def state(self) -> State:
        """The state to publish, read only."""

    def approach(self, origin: Origin, separation: float) -> float:
        """Rigid approach: under load control, what viscous creep adds to the fall of the mean of u0."""
        system = self.system
        if system.load is None:
            return -system.moved(0.0, self.time)
        viscous = system.body.mobility * origin.impulse / system.sites
        return origin.separation - separation + viscous

    @abstractmethod
    def extent(self) -> Extent:
        """How large the deformation is."""

    @abstractmethod
    def speed(self) -> float:
        """Rate of the anchors, rms over the sites."""

    @abstractmethod
    def attempt(self, duration: float, aim: Aim) -> Attempt:
        """Try a time step."""

    @abstractmethod
    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""

    @abstractmethod
    def resume_state(self) -> dict[str, NDArray[Any]]:
        """Arrays from which another march resumes, to identical results."""


class TrBdf2(Steps):
    """Steps of TR-BDF2; who inherits solves their stages.

    ``times`` are those of the state and of states before it, the latest first. The end of the first step, or
    0, is the ``origin``: logarithms are of the sum of both, for times that are short.
    """

    tried: list[Any]
    """States at the ends of the stages that were tried, the latest last."""
    through: ClassVar[int]
    """Number of states through which the polynomial that guesses a stage passes, where there are as many."""

    def __init__(self, system: System, arrays: Arrays) -> None:
        self.system = system
        self.origin, *self.times = arrays["times"].tolist()
        self.time = self.times[0]

    def contacts_tried(self) -> int:
        """See `Steps`."""
        return int(np.count_nonzero(self.tried[-1].u <= self.system.heights))

    def attempt(self, duration: float, aim: Aim) -> Attempt:
        """Try a time step; one whose stages are not solved has an infinite error."""
        tau, evenly, origin = DIAGONAL * duration, WEIGHT * duration, self.origin or duration
        logs, spent = [math.log(time + origin) for time in self.times], 0
        stages = (2 * tau, (tau,)), (duration, (evenly, evenly))
        self.prepare(tau)
        try:
            for (ahead, creeps), *accuracy in zip(stages, aim.tolerances, aim.allowed_errors, strict=True):
                log = math.log(self.time + ahead + origin)
                weights = extrapolation(logs[: self.through], log)
                spent += self.solve(Stage(self.time + ahead, tau, creeps, weights, *accuracy))
                logs = [log, *logs]
            return Attempt(self.filtered_error([duration * share for share in ERROR_WEIGHTS]), spent)
        except (ConvergenceError, PulledOff) as failure:
            return Attempt(math.inf, spent, failure)

    def accept(self, time: float) -> None:
        """Make the end of the time step that was tried the state at a time."""
        self.time, self.times = time, [time, *self.times][: self.through]
        self.origin = self.origin or time
        self.advance()

    def check(self, stops: Field) -> None:
        """Refuse numbers that overflow single precision."""
        fastest, advice = self.system.mechanics.fastest_creep, "another unit of time"
        if stops.size and fastest > 0 and stops[0] < 1 / LONGEST:
            expected = f"0, or times from {1 / LONGEST:.0e}"
            raise InputError("times", expected=expected, got=f"{stops[0]:g}", advice=advice)
        if stops.size and fastest * stops[-1] > LONGEST:
            expected = f"times up to {LONGEST / fastest:.2g}: all creep has ended long before"
            advice = "asperity.relax for what comes in the end"
            raise InputError("times", expected=expected, got=f"{stops[-1]:g}", advice=advice)
        if fastest > LONGEST:
            expected = f"creep at rates (k1 R, k1 R_viscous) up to {LONGEST:.0e}"
            raise InputError("solid", expected=expected, got=f"{fastest:.2g}", advice=advice)

    def resume_state(self) -> dict[str, NDArray[Any]]:
        """See `Steps`."""
        return {**self.arrays(), "times": np.array([self.origin, *self.times])}

    @abstractmethod
    def prepare(self, tau: float) -> None:
        """Prepare both stages of a step, whose implicit steps take tau."""

    @abstractmethod
    def solve(self, stage: Stage) -> int:
        """Solve a stage; the iterations spent. `ConvergenceError` if not."""

    @abstractmethod
    def filtered_error(self, shares: Sequence[float]) -> float:
        """The sum of f0, f1 and f2 with some weights after one more implicit step, rms over the sites."""

    @abstractmethod
    def advance(self) -> None:
        """Make the end of the second stage the state."""

    @abstractmethod
    def arrays(self) -> dict[str, NDArray[Any]]:
        """Arrays of the state."""


def extrapolation(points: Sequence[float], x: float) -> list[float]:
    """Weights of the values at known points with which Lagrange's polynomial has its value at x."""
    return [math.prod((x - b) / (a - b) for b in points if b != a) for a in points]


def rms(field: NDArray[np.floating]) -> float:
    """Root mean square over the sites; 0 of no field."""
    scale = largest(field, np) if field.size else 0.0
    if not 0 < scale < math.inf:
        return scale
    field = field / scale
    return scale * math.sqrt(float(np.einsum("i,i->", field.ravel(), field.ravel())) / field.size)
