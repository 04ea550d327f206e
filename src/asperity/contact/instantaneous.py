"""Press two bodies together: the instantaneous contact, before anything has crept."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.contact.active_set import ActiveSet
from asperity.contact.controls import Load, control_from
from asperity.contact.problem import TOLERANCE, ContactSolver, Guess
from asperity.contact.state import Contact, contact_from
from asperity.contact.system import System
from asperity.errors import InputError
from asperity.solids import Solid
from asperity.surfaces.heights import check_heights


def press(
    heights: ArrayLike,
    solid: Solid,
    *,
    load: float | None = None,
    separation: float | None = None,
    start: Contact | None = None,
    solver: ContactSolver | None = None,
) -> Contact:
    """Press a flat elastic solid onto a rigid rough surface.

    Parameters
    ----------
    heights
        Heights of the rough surface, shape ``(n,)`` or ``(n, m)``, any unit of length; periodic.
    solid
        The elastic solid, for example `asperity.solids.spring_lattice`.
    load
        Normal load: the sum of all contact forces, in units of stiffness times height.
    separation
        Mean of u0, in the unit of the heights. Give either this or the load.
    start
        A contact to start the search from, such as that of a slightly smaller load; it changes the
        time taken, not the result.
    solver
        How to solve; `ActiveSet` by default.

    Returns
    -------
    Contact

    Raises
    ------
    InputError
        The heights, the load, the separation or the solid cannot be used; the message says why.
    ConvergenceError
        The solver did not reach its tolerance.

    Notes
    -----
    u minimizes Jagla's energy, Eq. (e), under u >= heights, with u0 flat.
    """
    rough = check_heights(heights)
    control = control_from(load, separation)
    system = System.of(rough, solid, control)
    flat = system.virgin_shape()
    if start is None:
        guess = cold_guess(system)
    elif start.heights.shape == rough.shape:
        guess = Guess(start.u - system.datum, start.in_contact)
    else:
        raise InputError("start", expected=f"a contact of shape {rough.shape}", got=start.heights.shape)
    step = system.implicit_step(0.0)
    solution = (solver or ActiveSet()).solve(step.problem(flat), guess, TOLERANCE)
    u0 = step.crept_shape(system.lattice.forward(solution.u), flat)
    flat_u0 = np.full(rough.shape, u0.flat[0].real / rough.size)
    return contact_from(system, solution, flat_u0, solid=solid, heights=rough, surface=_origin(heights))


def cold_guess(system: System) -> Guess:
    """Guess the contacts of a flat u0 as if the asperities were independent (Greenwood and Williamson).

    Each asperity that reaches the level d carries the site stiffness times its overlap, and d is
    where these forces add up to the load. (J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A
    295, 300 (1966), DOI 10.1098/rspa.1966.0242.)
    """
    if isinstance(system.control, Load):
        spectra = system.spectra
        site_compliance = system.lattice.mean_over_modes(1.0 / (spectra.permanent + spectra.creeping))
        descending = np.sort(system.heights, axis=None)[::-1]
        overlap = np.cumsum(descending) - np.arange(1, descending.size + 1) * descending
        reach = int(np.searchsorted(overlap, system.control.value * site_compliance))
        level = float(descending[min(max(reach, 1), descending.size) - 1])
    else:
        level = system.control.value - system.datum
    return Guess(np.full(system.heights.shape, level), system.heights >= level)


def _origin(heights: object) -> dict[str, object]:
    """What a measured surface says of itself; nothing for a plain array."""
    provenance = getattr(heights, "provenance", None)
    return dict(provenance) if isinstance(provenance, dict) else {}
