"""Press two bodies together: the instantaneous contact, before anything has crept."""

from __future__ import annotations

from numpy.typing import ArrayLike

import asperity.checks as checks
from asperity.contact.choice import chosen_solver
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
        How to solve: by default `Multigrid` for the lattice of springs in two dimensions, and
        `ActiveSet` for any other solid.

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
    checks.instance("solid", solid, Solid, "asperity.solids.spring_lattice(k0=1.0, k1=3.0)")
    control = control_from(load, separation)
    system = System.of(rough, solid, control)
    guess = None
    if start is not None:
        checks.instance("start", start, Contact, "asperity.press(...), or leave it out")
        if start.heights.shape != rough.shape:
            raise InputError("start", expected=f"a contact of shape {rough.shape}", got=start.heights.shape)
        guess = Guess(start.u - system.datum, start.in_contact)
    problem = system.implicit_step(0.0).problem(system.virgin_shape)
    solution = chosen_solver(solver, system).solve(problem, guess, TOLERANCE)
    level = system.virgin_shape
    if isinstance(control, Load):
        level = float(solution.u.mean()) - system.mean_stretch
    return contact_from(system, solution, level, solid=solid, heights=rough, surface=_origin(heights))


def _origin(heights: object) -> dict[str, object]:
    """What a measured surface says of itself; nothing for a plain array."""
    provenance = getattr(heights, "provenance", None)
    return dict(provenance) if isinstance(provenance, dict) else {}
