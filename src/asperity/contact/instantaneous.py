"""The instantaneous contact: two bodies pressed together before anything has crept, or pressed anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from asperity.base import checks
from asperity.contact.adhesive import check_zone
from asperity.contact.anchors import AnchorFields
from asperity.contact.bodies import Bodies
from asperity.contact.choice import chosen_solver, solved
from asperity.contact.contact import Contact
from asperity.contact.controls import Control
from asperity.contact.problem import PUBLISHED, TOLERANCE, Accuracy, ContactSolver, Guess, Solution
from asperity.contact.publish import contact_from
from asperity.contact.system import System
from asperity.errors import InputError, PulledOff
from asperity.lattice import Field
from asperity.solids import Solid


@dataclass(frozen=True)
class Tuning:
    """Numbers of contacts in an instant."""

    strict: float = 0.01
    """Part of the tolerance to which a contact is solved whose u0 is given."""


TUNING = Tuning()


def first_contact(
    bodies: Bodies, control: Control, *, start: Contact | None, solver: ContactSolver | None
) -> Contact:
    """Press a solid that has never crept, its anchors flat, onto checked heights; see `asperity.press`."""
    check_zone(bodies)
    system = System.of(bodies.heights, bodies.lattice, bodies.solid, control)
    guess = None
    if system.sticks and system.load is not None and system.load <= 0:  # the highest sites touch at first
        guess = Guess(np.zeros_like(system.heights), system.heights == 0)
    if start is not None:
        checks.instance("start", start, Contact, "asperity.press(...), or leave it out")
        if start.heights.shape != bodies.heights.shape:
            expected = f"a contact of shape {bodies.heights.shape}"
            raise InputError("start", expected=expected, got=start.heights.shape)
        u, _, in_contact, _ = start.relative
        guess = Guess(u + (start.datum - system.datum), in_contact)
    level = control.value - system.datum if system.load is None else 0.0
    if system.load == 0 and not system.sticks:  # nothing is deformed, and the highest sites just touch
        touching = Solution(np.zeros_like(system.heights), system.heights == 0, 0, 0)
        anchors = AnchorFields.flat(level, system)
        return contact_from(system, touching, anchors, level, bodies=bodies)
    problem = system.mechanics.implicit_step(0.0).problem(system.heights, level, system.held())
    solution = solved(chosen_solver(solver, system), problem, guess, PUBLISHED)
    if system.load is not None:
        flat = np.broadcast_to(level, (system.mechanics.branches, *solution.u.shape))
        level += system.body.displacement(solution.u, flat, system.held(level))
    how = system, solution, AnchorFields.flat(level, system), level
    return contact_from(*how, bodies=bodies, load_may_vanish=False)


def pressed_anew(
    contact: Contact,
    control: Control,
    solver: ContactSolver | None = None,
    *,
    least_force: float = 0.0,
    apart: bool = False,
) -> Contact:
    """Press an aged contact under a new load or at a new separation; its crept shape stays.

    The anchors keep their shapes. They move as a whole: to the given separation, or with the load. See
    `contact_from` for the least force. Nothing attracts at first where the bodies were ``apart``.
    """
    system = contact.system(control)
    place = control.value - system.datum if system.load is None else None
    u, _, in_contact, _ = contact.relative
    last = np.full_like(u, np.inf) if apart else None
    guess = Guess(u, in_contact, last=last, gradual=True)
    return _anew(contact, contact, system, guess, place, solver, least_force)


def check_load(system: System) -> None:
    """Refuse a load under which a contact cannot be pressed anew."""
    if system.load == 0 and not system.sticks:
        expected = "a load above 0; only a first contact may have load 0"
        raise InputError("load", expected=expected, got="0", advice="a small load")
    system.held()


def check_whole(solid: Solid, by: Sequence[Fraction]) -> None:
    """Refuse to slide what yields by parts of sites: its indentation has steps from site to site."""
    if solid.yields and any(sites.denominator > 1 for sites in by):
        raise InputError(
            "slide",
            expected="whole sites: a surface that yields is not smooth between them",
            got=", ".join(map(str, by)),
            advice="substeps=1, a shift by whole sites, or a solid without hardness",
        )


def slid(
    contact: Contact, heights: Field, by: Sequence[Fraction], solver: ContactSolver | None = None
) -> Contact:
    """Press an aged contact onto heights that have moved by some sites; its crept shape stays."""
    check_whole(contact.solid, by)
    near, axes = [round(sites) for sites in by], tuple(range(heights.ndim))
    if contact.has_not_crept and np.array_equal(heights, np.roll(contact.heights, near, axis=axes)):
        return contact.moved(near)
    u, in_contact = np.roll(contact.u, near, axis=axes), np.roll(contact.in_contact, near, axis=axes)
    indentation = np.roll(contact.permanent_indentation, near, axis=axes)
    bodies = contact.with_heights(heights, indentation)
    system = contact.system().above(heights)
    guess = Guess(u - system.datum, in_contact)
    return _anew(contact, bodies, system, guess, None, solver)


def _anew(
    contact: Contact,
    bodies: Bodies,
    system: System,
    guess: Guess,
    place: float | None,
    solver: ContactSolver | None,
    least_force: float = 0.0,
) -> Contact:
    """Solve for the surface above the anchors of a contact, in another system or above other heights.

    The rigid body takes the anchors to a place relative to the datum of that system, or stays.
    """
    check_load(system)
    _, anchors, _, position = contact.relative
    moved = contact.datum - system.datum if place is None else place - position
    return above_anchors(anchors + moved, position + moved, bodies, system, guess, solver, least_force)


def above_anchors(
    anchors: Field,
    position: float,
    bodies: Bodies,
    system: System,
    guess: Guess,
    solver: ContactSolver | None = None,
    least_force: float = 0.0,
) -> Contact:
    """Solve for the surface above anchors, which may be overwritten, relative to the datum of the system."""
    problem = system.problem(system.mechanics.implicit_step(0.0), anchors)
    # The anchors are given, so that forces left off contact cannot be balanced: their sum is to be small too.
    accuracy = Accuracy(TUNING.strict * TOLERANCE)
    try:
        solution = solved(chosen_solver(solver, system), problem, guess, accuracy)
    except PulledOff:
        raise PulledOff(getattr(bodies, "load", None)) from None
    if system.load is not None:
        moved = system.body.displacement(solution.u, anchors, system.held(position))
        anchors += moved
        position += moved
    how = system, solution, AnchorFields(anchors), position
    return contact_from(*how, bodies=bodies, least_force=least_force)
