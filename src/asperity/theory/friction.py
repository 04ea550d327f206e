"""From the contact area to the friction that an experiment measures."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.base.checks import Floats, broadcast, not_negative, positive


def static_friction(area: ArrayLike, load: ArrayLike, shear_strength: ArrayLike) -> Floats:
    """Return the coefficient of static friction, mu_s = sigma_S A / F_N.

    Contacts yield in shear at a force proportional to the real contact area (F. P. Bowden and D. Tabor, *The
    Friction and Lubrication of Solids*, Oxford, 1950; paper, Summary).

    Parameters
    ----------
    area
        Real contact area A, not below 0: in any unit of area; in sites, say.
    load
        Normal load F_N (force), above 0.
    shear_strength
        sigma_S (force per area, in the same unit of area), not below 0.

    Returns
    -------
    ndarray
        Shape of the broadcast arguments; a NumPy float if all are scalars.

    Raises
    ------
    InputError
        For a number out of range, and for shapes that do not broadcast.
    """
    touching, force, strength = broadcast(
        area=not_negative("area", area),
        load=positive("load", load),
        shear_strength=not_negative("shear_strength", shear_strength),
    )
    return np.asarray(strength * touching / force)[()]
