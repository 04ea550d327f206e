"""From a case to what the solvers are given, as files."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from cases import STEP_FROM, STEP_TAU, STEP_TO, Case
from check import force_of
from peers.problem import Law, Problem
from solvers import Worker


@dataclass(frozen=True)
class Task:
    """A case, ready: ``own`` and ``peers`` are the files for Asperity and for its peers.

    ``problem`` is what fields are judged by. ``ages`` are the times between which Asperity ages, in a step.
    """

    problem: Problem
    own: Path
    peers: Path
    folder: Path
    ages: tuple[float, float] | None = None

    @property
    def kind(self) -> str:
        """The kind of law that peers must solve."""
        return self.problem.law.kind


def prepare(case: Case, asperity: Worker, folder: Path, limit: float) -> Task:
    """Make the surface, and with Asperity, untimed, the state from which a case starts."""
    own = Problem(case.heights(), case.law, case.load)
    files = folder / f"{case.name}-own.npz", folder / f"{case.name}-peers.npz"
    write(own, files[0])
    out = folder / "start.npz"
    if case.state == "step":
        request = {"do": "age", "problem": str(files[0]), "times": [STEP_FROM, STEP_FROM + STEP_TAU]}
        asperity.ask({**request, "out": str(out)}, limit)
        with np.load(out) as before:
            task = step(own, before["u0"], before["force"])
        write(task, files[1])
        return Task(task, *files, folder, ages=(STEP_FROM, STEP_TO))
    law = Law("lattice", k0=case.law.k0, k1=case.law.k1) if case.state == "relaxed" else case.law
    pressed = replace(own, law=law)
    first = folder / f"{case.name}-before.npz"
    write(pressed, first)
    request = {"do": "solve", "problem": str(first), "tolerance": 0.0, "out": str(out)}
    reply = asperity.ask(request, limit)
    peers = replace(own, separation=reply["note"]["separation"])
    if case.state == "relaxed":
        with np.load(out) as before:
            peers = replace(own, start=contact_force(pressed, before["u"], before["in_contact"]))
    write(peers, files[1])
    return Task(own, *files, folder)


def contact_force(problem: Problem, u: np.ndarray, in_contact: np.ndarray) -> np.ndarray:
    """Forces from which peers may start: those of a surface, and zero off contact."""
    return np.where(in_contact, np.maximum(force_of(problem, u), 0.0), 0.0)


def step(problem: Problem, u0: np.ndarray, force: np.ndarray) -> Problem:
    """One implicit Euler step of creep from u0, as a contact problem with no memory.

    The force r = H u + C D (u - u0), D = 1 / (1 + tau M C), is S (u - v) with S = H + C D and v = C D u0 / S
    mode by mode. So u - v is pressed onto heights - v.
    """
    law = replace(problem.law, kind="step", tau=STEP_TAU)
    moved = replace(problem, law=law)
    stiffness = moved.stiffness()
    compliance = moved.compliance()
    permanent = replace(problem, law=replace(law, kind="relaxed")).stiffness()
    shift = np.fft.irfft2((stiffness - permanent) * compliance * np.fft.rfft2(u0), s=u0.shape)
    return replace(moved, heights=problem.heights - shift, start=np.maximum(force, 0.0))


def write(problem: Problem, path: Path) -> None:
    """Write a problem where a worker will find it, under a name of its own: workers keep what they read."""
    law = json.dumps(asdict(problem.law))
    fields = {"heights": problem.heights, "load": problem.load, "law": law, "spacing": problem.spacing}
    if problem.start is not None:
        fields["start"] = problem.start
    if problem.separation is not None:
        fields["separation"] = problem.separation
    np.savez(path, **fields)
