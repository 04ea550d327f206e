r"""The relaxed state, t -> infinity, directly: creep ends when it has nothing left to drive it.

With D = 0 wherever M C > 0, the implicit step of infinite duration is the answer (see
`asperity.contact.system`). For the spring lattice:

* R_viscous = 0: the springs to the bulk all carry the same force, F / N; the state depends on
  F / k0 alone.
* R_viscous > 0, load held: the shape has the same limit, for every mode but the mean is driven to
  it. The rigid body has none: it keeps sinking at the rate R_viscous F / N (`approach` of a history).
* R_viscous > 0, separation held: the load dies out; u and u0 end flat, at the highest point.
"""

from __future__ import annotations

import numpy as np

from asperity.contact.choice import chosen_solver
from asperity.contact.controls import Hold, Load
from asperity.contact.problem import TOLERANCE, ContactSolver, Guess, Solution
from asperity.contact.state import Contact, contact_from, hold_contact
from asperity.contact.system import System
from asperity.errors import InputError
from asperity.lattice import Field


def relax(contact: Contact, *, hold: Hold | None = None, solver: ContactSolver | None = None) -> Contact:
    """Find the state that a contact creeps toward, without following it through time.

    Parameters
    ----------
    contact
        Where creep starts.
    hold
        What is held constant, ``"load"`` or ``"separation"`` (of the rigid body); by default what
        the contact was pressed by.
    solver
        How to solve; by default as `asperity.press` does.

    Returns
    -------
    Contact
        The limit. With R_viscous > 0 under load control it is the limit of the shape: the mean of
        u0 relative to the rough surface has a limit too, but the rigid body has not.

    Raises
    ------
    InputError
        The limit depends on the path: k0 = 0 and a load that dies out before full contact.
    ConvergenceError
        The solver did not reach its tolerance.
    """
    start = hold_contact(contact, hold)
    system = start.system
    step = system.implicit_step(np.inf)
    soft = np.zeros(1, dtype=bool) if system.springs else step.stiffness.flat[1:] == 0
    if soft.any() and start.area == 0:
        return start  # nothing pushes, and nothing but a push would move it
    if soft.any() and not soft.all():
        raise InputError(
            "solid",
            expected="permanent stiffness above 0 at every wave vector but 0, or nowhere",
            got="some without, along which the limit depends on the path",
            advice="asperity.age with late times",
        )
    if soft.any():
        solution, shape = _without_stiffness(start, system)
    elif system.mean_mobility > 0 and not isinstance(system.control, Load):
        solution, shape = _unloaded(start, system)
    else:
        before = start.u0 - system.datum
        guess = Guess(start.u - system.datum, start.in_contact, disposable=True)
        solution = chosen_solver(solver, system).solve(step.problem(before), guess, TOLERANCE)
        stretch = step.stretch(solution.u, before) if solution.stretch is None else solution.stretch
        shape = solution.u - stretch
    return contact_from(
        system,
        solution,
        shape,
        solid=start.solid,
        heights=start.heights,
        surface=start.surface,
        load_may_vanish=True,
    )


def _without_stiffness(start: Contact, system: System) -> tuple[Solution, Field]:
    """Nothing permanent resists (k0 = 0): the load spreads evenly over full contact."""
    stretch = (
        system.mean_stretch if isinstance(system.control, Load) else float(np.mean(start.heights - start.u0))
    )
    mean_force = system.mean_stiffness * stretch
    if isinstance(system.control, Load):
        mean_force = system.control.value / system.lattice.sites
    if mean_force <= 0 or (system.mean_mobility > 0 and not isinstance(system.control, Load)):
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
