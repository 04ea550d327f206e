r"""The relaxed state, t -> infinity, directly: the state in which nothing creeps any more.

With D = 0 wherever M C > 0, the implicit step of infinite duration is the answer (see
`asperity.contact.mechanics`). For the spring lattice:

* R_viscous = 0: the springs to the bulk all carry the same force, F / N; the state depends on
  F / k0 alone.
* R_viscous > 0, load control: the shape of u0 has the same limit, for every mode but the mean is driven to
  it. The rigid body has none: it keeps sinking at the rate R_viscous F / N (`approach` of a history).
* R_viscous > 0, separation control: the load dies out; u and u0 end flat, at the highest point.
* A local law of creep: as with R_viscous > 0, however the law depends on the force.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asperity.contact.anchors import AnchorFields
from asperity.contact.choice import chosen_solver, solved
from asperity.contact.contact import Contact
from asperity.contact.controls import Control
from asperity.contact.mechanics import ImplicitStep, Mechanics, mechanics_of
from asperity.contact.problem import PUBLISHED, ContactSolver, Guess, Solution
from asperity.contact.publish import contact_from
from asperity.contact.system import System
from asperity.errors import InputError
from asperity.lattice import Field


def relaxed(contact: Contact, control: Control, solver: ContactSolver | None = None) -> Contact:
    """Find the state that a contact creeps toward under a control; see `asperity.relax`."""
    system = whole = contact.system(control)
    if system.mechanics.law is not None:
        system = replace(system, mechanics=_without_law(system.mechanics))
    mechanics = system.mechanics
    some_soft, all_soft = mechanics.soft_modes
    if some_soft and contact.area == 0:
        return contact  # without contact forces the soft modes do not move
    expected = got = ""
    if some_soft and not all_soft:
        expected = "permanent stiffness above 0 at every wave vector but 0, or nowhere"
        got = "0 at some, so the limit depends on the history"
    elif some_soft and np.isinf(system.heights).any():
        expected = "permanent stiffness above 0 for a body that ends"
        got = "none: the body sinks for ever"
    if expected:
        raise InputError("solid", expected=expected, got=got, advice="asperity.age with late times")
    u, before, in_contact, position = contact.relative
    step = mechanics.implicit_step(np.inf)
    if some_soft:
        solution = _without_stiffness(system, step, before, position)
    elif whole.free_mean:
        level = 0.0 if contact.area else max(0.0, position)  # flat, touching unless the body hung above
        flat = Solution(np.full(u.shape, level), system.heights >= level, 0, 0)
        return contact_from(whole, flat, AnchorFields.flat(level, whole), position, bodies=contact)
    else:
        guess = Guess(u, in_contact)
        problem = system.problem(step, before)
        solution = solved(chosen_solver(solver, system), problem, guess, PUBLISHED)
    stretch, position = system.stretch(step, solution, before, position)
    how = system, solution, AnchorFields(solution.u - stretch), position
    return contact_from(*how, bodies=contact)


def _without_law(mechanics: Mechanics) -> Mechanics:
    """The same solid with viscous creep in place of a local law, which leads to the same limit.

    Whatever creeps under every force creeps until all springs of the branch carry the same.
    """
    solid, law = mechanics.solid, mechanics.law
    if law is not None and not law.velocity(np.array([np.finfo(float).tiny ** 0.25]))[0][0] > 0:
        raise InputError(
            "creep",
            expected="a law that creeps under every stress",
            got="a law with a threshold: the limit depends on the history",
            advice="asperity.age with late times",
        )
    return mechanics_of(solid.without_law(), mechanics.lattice)


def _without_stiffness(system: System, step: ImplicitStep, before: Field, position: float) -> Solution:
    """Nothing permanent resists (k0 = 0): the load spreads evenly over full contact."""
    everywhere = Solution(system.heights, np.ones(system.heights.shape, dtype=bool), 0, 0)
    stretch, position = system.stretch(step, everywhere, before, position)
    load = system.load
    if load is None:
        load = system.body.carried(system.heights, stretch, position) or 0.0
    if load <= 0 or system.free_mean:
        raise InputError(
            "contact",
            expected="a load that lasts until full contact",
            got="none: without permanent stiffness it vanishes before, so the limit depends on the history",
            advice="asperity.age with late times, or a solid with permanent stiffness",
        )
    return everywhere
