"""A solution becomes a contact if the fields that it keeps are in equilibrium."""

from __future__ import annotations

import math

import numpy as np

from asperity.contact.anchors import AnchorFields, Anchors, Balance
from asperity.contact.bodies import Bodies
from asperity.contact.contact import Contact
from asperity.contact.problem import Solution, mean_by_rounding
from asperity.contact.system import System
from asperity.errors import ConvergenceError
from asperity.lattice import Field, Mask
from asperity.surfaces.prepare import of_body

ACCEPTED_RESIDUAL = 1e-8
"""No fields are kept whose residual, evaluated on these very fields, is larger."""


def contact_from(
    system: System,
    solution: Solution,
    anchors: Anchors,
    position: float,
    *,
    bodies: Bodies,
    load_may_vanish: bool = True,
    least_force: float = 0.0,
) -> Contact:
    """Publish a solution of a system: its fields, judged once more.

    Anchors and position are relative to the system's datum. `ConvergenceError` where double precision cannot
    resolve the load, unless it may vanish, as at a held separation. Residuals are relative to at least
    ``least_force``, the mean contact force of a contact with which this one is compared, and to the largest
    external force, whose rounding contact forces bear.
    """
    lattice, yielding = system.mechanics.lattice, solution.u < system.heights
    surface, heights, indentation = solution.u, bodies.heights, bodies.permanent_indentation
    if system.yields:
        heights = _lowered(system, surface, heights)
        lowered, body = np.zeros(heights.shape), np.isfinite(heights)
        indentation = indentation + np.subtract(bodies.heights, heights, out=lowered, where=body)
        lower = system.above(heights)
        shift, system = lower.datum - system.datum, lower
        if shift:  # the highest point has yielded
            surface, position = surface - shift, position - shift
            anchors = AnchorFields(anchors.on(lattice) - shift)
    # What differs from the heights by less than their last digit touches.
    touching = solution.in_contact | (surface + system.datum <= lattice.extended(heights, -math.inf))
    surface = np.maximum(surface, system.heights)
    np.copyto(surface, system.heights, where=touching)
    system = system.pulled(surface)
    if (load_may_vanish and not system.load) or not touching.any():
        least_force = _smallest_force(system, surface)
    if system.external is not None:
        least_force = max(least_force, float(np.abs(system.external).max()))
    state = anchors.balance(system, surface, position)
    residual = _judged(system, surface, state, touching, yielding, least_force)
    force = system.interface.admit(state.force, touching)
    borne = system.interface.borne(float(force.sum()))
    scale = max(borne / max(int(np.count_nonzero(touching)), 1), least_force)
    return Contact._judged(
        **vars(bodies)
        | {
            "heights": heights,
            "permanent_indentation": np.broadcast_to(indentation, heights.shape),
            "control": system.control,
            "force": lattice.cut(force),
            "in_contact": lattice.cut(touching),
            "energy": state.energy() + system.interface.bond(surface - system.heights),
            "residual": residual,
            "residual_scale": scale,
            "iterations": solution.iterations,
            "_surface": surface,
            "_anchors": anchors,
            "_position": state.position,
        }
    )


def _judged(
    system: System, u: Field, state: Balance, in_contact: Mask, yielding: Mask, floor: float
) -> float:
    """The residual of a state; subtracts from its forces a mean that is rounding."""
    mechanics = system.mechanics
    if system.load is None:
        size = float(np.abs(u).max()) * mechanics.body.stiffness
        state.force[...] -= mean_by_rounding(system.interface.of_contact(state.force), in_contact, size)
    residual = system.interface.violation(state.force, in_contact, yielding, floor)
    borne = system.interface.borne(system.load or float(state.force.sum()))
    if system.load is not None and borne > 0 and state.carried is not None:
        # The mean of the stretches is as accurate as waves are: a stiffer one follows from the load.
        most = system.sites * max(1.0, mechanics.body.stiffness / mechanics.greatest_stiffness)
        touching = np.count_nonzero(in_contact)
        scale = max(borne, floor * touching)
        residual = max(residual, abs(state.carried - system.load) / scale * touching / most)
        residual = max(residual, abs(float(state.force.sum()) - system.load) / scale)
    if residual <= ACCEPTED_RESIDUAL:
        return residual
    why, advice = "the solver left forces off contact, or other forces than the load", "another solver"
    if borne < _smallest_force(system, u) * np.count_nonzero(in_contact):
        why, advice = "the load is too small beside the crept shape in double precision", "more load"
    raise ConvergenceError(
        f"residual {residual:.1e}, expected at most {ACCEPTED_RESIDUAL:.0e}: {why}; try {advice}"
    )


def _lowered(system: System, u: Field, heights: Field) -> Field:
    """Heights of the rough surface, lower where it has yielded under a surface."""
    obstacle = system.mechanics.lattice.cut(system.lowered(u).heights)
    lower = obstacle < heights - system.datum
    return np.where(lower, obstacle + system.datum, heights)


def _smallest_force(system: System, u: Field) -> float:
    """Smallest force that double precision resolves: the scale of residuals without a load."""
    heights = system.mechanics.lattice.cut(system.heights)
    largest = max(float(np.abs(field).max()) for field in (u, of_body(heights)))
    return 4 * float(np.spacing(largest)) * system.mechanics.greatest_stiffness / ACCEPTED_RESIDUAL
