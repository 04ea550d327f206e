"""The instantaneous contact: two bodies pressed together before anything has crept, or anew at once."""

from __future__ import annotations

from collections.abc import Mapping

import asperity.checks as checks
from asperity.contact.choice import chosen_solver
from asperity.contact.controls import Control
from asperity.contact.problem import TOLERANCE, ContactSolver, Guess
from asperity.contact.state import Contact, contact_from
from asperity.contact.system import System
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.solids import Solid

_STRICT = 0.01
"""Part of the tolerance to which a contact is solved whose u0 is given."""


def first_contact(
    heights: Field,
    solid: Solid,
    control: Control,
    *,
    start: Contact | None,
    solver: ContactSolver | None,
    surface: Mapping[str, object],
) -> Contact:
    """Press a solid that has never crept, u0 flat, onto checked heights; see `asperity.press`."""
    system = System.of(heights, solid, control)
    guess = None
    if start is not None:
        checks.instance("start", start, Contact, "asperity.press(...), or leave it out")
        if start.heights.shape != heights.shape:
            raise InputError("start", expected=f"a contact of shape {heights.shape}", got=start.heights.shape)
        guess = Guess(start.u - system.datum, start.in_contact)
    step = system.mechanics.implicit_step(0.0)
    problem = system.problem(step, system.virgin_anchors)
    solution = chosen_solver(solver, system).solve(problem, guess, TOLERANCE)
    level = system.virgin_anchors
    if system.mean_stretch is not None:
        level = float(solution.u.mean()) - system.mean_stretch
    return contact_from(system, solution, level, solid=solid, heights=heights, surface=surface)


def pressed_anew(contact: Contact, control: Control, solver: ContactSolver | None = None) -> Contact:
    """Press an aged contact under a new load or at a new separation, at once: its crept shape stays.

    The anchors u0 keep their shape. They move as a whole: to the given separation, or with the load.

    Raises
    ------
    InputError
        The solid cannot be used with this control.
    ConvergenceError
        The solver did not reach its tolerance.
    """
    system = contact.system(control)
    anchors = contact.u0 - system.datum
    if system.mean_stretch is None:
        anchors += control.value - contact.separation
    problem = system.problem(system.mechanics.implicit_step(0.0), anchors)
    guess = Guess(contact.u - system.datum, contact.in_contact, disposable=True)
    # u0 is given, so that forces left off contact cannot be balanced: their sum is to be small too.
    solution = chosen_solver(solver, system).solve(problem, guess, _STRICT * TOLERANCE)
    if system.mean_stretch is not None:
        anchors += float((solution.u - anchors).mean()) - system.mean_stretch
    return contact.become(system, solution, anchors)
