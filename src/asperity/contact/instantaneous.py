"""The instantaneous contact: two bodies pressed together before anything has crept, or anew at once."""

from __future__ import annotations

import asperity.checks as checks
from asperity.contact.bodies import Bodies
from asperity.contact.choice import chosen_solver
from asperity.contact.controls import Control
from asperity.contact.problem import TOLERANCE, ContactSolver, Guess
from asperity.contact.state import Contact, contact_from
from asperity.contact.system import System
from asperity.errors import InputError

_STRICT = 0.01
"""Part of the tolerance to which a contact is solved whose u0 is given."""


def first_contact(
    bodies: Bodies, control: Control, *, start: Contact | None, solver: ContactSolver | None
) -> Contact:
    """Press a solid that has never crept, its anchors flat, onto checked heights; see `asperity.press`."""
    heights = bodies.heights
    system = System.of(heights, bodies.lattice, bodies.solid, control)
    guess = None
    if start is not None:
        checks.instance("start", start, Contact, "asperity.press(...), or leave it out")
        if start.heights.shape != heights.shape:
            raise InputError("start", expected=f"a contact of shape {heights.shape}", got=start.heights.shape)
        guess = Guess(start.u - system.datum, start.in_contact)
    level = 0.0 if control.load_controlled else control.value - system.datum
    step = system.mechanics.implicit_step(0.0)
    solution = chosen_solver(solver, system).solve(system.problem(step, level), guess, TOLERANCE)
    if system.load is not None:
        level += system.displacement(solution.u, level, level)
    return contact_from(system, solution, level, level, bodies=bodies)


def pressed_anew(contact: Contact, control: Control, solver: ContactSolver | None = None) -> Contact:
    """Press an aged contact under a new load or at a new separation, at once: its crept shape stays.

    The anchors keep their shapes. They move as a whole: to the given separation, or with the load.

    Raises
    ------
    InputError
        The solid cannot be used with this control.
    ConvergenceError
        The solver did not reach its tolerance.
    """
    system = contact.system(control)
    anchors, position = contact.anchors - system.datum, contact.separation - system.datum
    if system.load is None:
        anchors += control.value - contact.separation
        position = control.value - system.datum
    problem = system.problem(system.mechanics.implicit_step(0.0), anchors)
    guess = Guess(contact.u - system.datum, contact.in_contact, disposable=True)
    # The anchors are given, so that forces left off contact cannot be balanced: their sum is to be small too.
    solution = chosen_solver(solver, system).solve(problem, guess, _STRICT * TOLERANCE)
    if system.load is not None:
        moved = system.displacement(solution.u, anchors, position)
        anchors += moved
        position += moved
    return contact.become(system, solution, anchors, position)
