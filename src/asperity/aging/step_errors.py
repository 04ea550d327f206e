"""Errors of time steps: how large they are, and what creep leaves of them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.contact.arrays import largest
from asperity.contact.branches import damp_difference, weighted_sum
from asperity.contact.free_sites import Accuracy, FreeSites
from asperity.contact.line_sites import LineSites, line_sites
from asperity.contact.mechanics import SpectralStep
from asperity.contact.system import System
from asperity.lattice import Mask, Modes

_GOAL, _ITERATIONS = 0.1, 100
"""How far forces off contact fall where an error is damped, and the most iterations spent on it."""

PASSING = 0.1
"""Least part of the error of a step that counts, even if less is left when the next state is published."""


def rms(field: NDArray[np.floating]) -> float:
    """Root mean square over the sites."""
    scale = largest(field, np)
    if not 0 < scale < math.inf:
        return scale
    field = field / scale
    return scale * math.sqrt(float(np.einsum("i,i->", field.ravel(), field.ravel())) / field.size)


def modes_rms(error: Modes, system: System) -> float:
    """Rms over the sites of an error of the anchors; a load decides their mean."""
    if system.control.load_controlled:
        error[system.mechanics.lattice.mean] = 0.0
    return system.mechanics.spectral.rms(error)


def damped(error: Modes, system: System, step: SpectralStep, touching: float) -> Modes:
    """About what an implicit step leaves of an error of the anchors, in its place, at no cost of transforms.

    A part of it, the fraction of the sites in contact, decays as where u = 0, the rest as on a free surface,
    S u = sum of C_b D_b e_b. Beside `filtered` it is too large by up to a half, seldom by more than 2 %.
    """
    u, stiffness = weighted_sum(step.damped_stiffness, error), step.stiffness
    if system.control.load_controlled:  # the load decides the mean
        stiffness = step.load_controlled_stiffness
    scale = np.divide(1.0 - touching, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0)
    u *= scale
    damp_difference(step.damping, u, error)
    return np.subtract(u, error, out=error)


def filtered(error: Modes, system: System, step: SpectralStep, in_contact: Mask) -> tuple[Modes, int]:
    """What an implicit step leaves of an error of the anchors while the contacts stay what they are.

    The surface follows the anchors off contact: there S u = sum of C_b D_b e_b, and u = 0 in contact. Solved
    to a tenth, for the error is an estimate; with the iterations spent.
    """
    lattice = step.mechanics.lattice
    pull, stiffness = weighted_sum(step.damped_stiffness, error), step.stiffness
    if system.control.load_controlled:  # the load decides the mean
        stiffness = step.load_controlled_stiffness
        pull[lattice.mean] = 0.0
    force = np.where(in_contact, 0.0, -lattice.backward(pull))
    worst, u, iterations = largest(force, np), np.zeros_like(pull), 0
    if not in_contact.any():
        np.divide(pull, stiffness, out=u, where=stiffness > 0)
    elif worst > 0:
        free: FreeSites | LineSites | None
        free = line_sites(lattice, step.springs(float(stiffness.flat[0])), in_contact)
        if free is None:
            unit = float(stiffness.max())
            scaled: Any = (stiffness / unit).astype(np.float32)
            free = FreeSites(lattice, stiffness, unit, scaled, in_contact, np)
        most = _ITERATIONS
        accuracy = Accuracy(_GOAL, imbalance=math.inf, most=most)
        found = free.correct(force, worst, accuracy)
        u, iterations = lattice.forward(found.displacement), found.iterations
    left = error.copy()
    damp_difference(step.damping, u, left)
    return np.subtract(u, left, out=left), iterations


def left_of(error: Modes, system: System, ahead: float, in_contact: Mask) -> tuple[float, int]:
    """Rms of what is left of an error of the anchors after a time, or a tenth of it; the iterations spent."""
    defect, iterations = filtered(error, system, system.mechanics.implicit_step(ahead).spectral, in_contact)
    return max(PASSING * modes_rms(error, system), modes_rms(defect, system)), iterations
