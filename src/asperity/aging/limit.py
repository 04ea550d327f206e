r"""The relaxed state, t -> infinity, directly: the state in which nothing creeps any more.

With D = 0 wherever M C > 0, the implicit step of infinite duration is the answer (see
`asperity.contact.mechanics`). For the spring lattice:

* R_viscous = 0: the springs to the bulk all carry the same force, F / N; the state depends on
  F / k0 alone.
* R_viscous > 0, load control: the shape of u0 has the same limit, for every mode but the mean is driven to
  it. The rigid body has none: it keeps sinking at the rate R_viscous F / N (`approach` of a history).
* R_viscous > 0, separation control: the load dies out; u and u0 end flat, at the highest point.
"""

from __future__ import annotations

import numpy as np

from asperity.contact.choice import chosen_solver
from asperity.contact.controls import Control
from asperity.contact.problem import TOLERANCE, ContactSolver, Guess, Solution
from asperity.contact.state import Contact
from asperity.contact.system import System
from asperity.errors import InputError
from asperity.lattice import Field


def relaxed(contact: Contact, control: Control, solver: ContactSolver | None = None) -> Contact:
    """Find the state that a contact creeps toward under a control; see `asperity.relax`."""
    system = contact.system(control)
    mechanics = system.mechanics
    some_soft, all_soft = mechanics.soft_modes
    if some_soft and contact.area == 0:
        return contact  # without contact forces the soft modes do not move
    if some_soft and not all_soft:
        raise InputError(
            "solid",
            expected="permanent stiffness above 0 at every wave vector but 0, or nowhere",
            got="some without, along which the limit depends on the path",
            advice="asperity.age with late times",
        )
    if some_soft:
        solution, anchors = _without_stiffness(contact, system)
    elif system.free_mean:
        solution, anchors = _unloaded(contact, system)
    else:
        before = contact.u0 - system.datum
        step = mechanics.implicit_step(np.inf)
        guess = Guess(contact.u - system.datum, contact.in_contact, disposable=True)
        problem = system.problem(step, before)
        solution = chosen_solver(solver, system).solve(problem, guess, TOLERANCE)
        anchors = solution.u - system.stretch(step, solution, before)
    return contact.become(system, solution, anchors)


def _without_stiffness(start: Contact, system: System) -> tuple[Solution, Field]:
    """Nothing permanent resists (k0 = 0): the load spreads evenly over full contact."""
    stretch = system.mean_stretch
    if stretch is None:
        stretch = float(np.mean(start.heights - start.u0))
    mean_force = system.mechanics.mean_stiffness * stretch
    if system.load is not None:
        mean_force = system.load / system.sites
    if mean_force <= 0 or system.free_mean:
        raise InputError(
            "contact",
            expected="a load that lasts until full contact, as k0 = 0",
            got="a separation at which it dies out before, on a path-dependent shape",
            advice="asperity.age with late times, or k0 > 0",
        )
    everywhere = np.ones(system.heights.shape, dtype=bool)
    return Solution(system.heights, everywhere, 0, 0), system.heights - stretch


def _unloaded(start: Contact, system: System) -> tuple[Solution, Field]:
    """The load has died out: flat, touching the highest point unless the body hung above it."""
    level = 0.0 if start.in_contact.any() else max(0.0, start.separation - system.datum)
    flat = np.full(system.heights.shape, level)
    return Solution(flat, system.heights >= level, 0, 0), flat
