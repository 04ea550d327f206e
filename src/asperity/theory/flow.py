"""Contacts that flow by an activated law: their area as a load and a logarithm of time give it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.base.checks import Floats, broadcast, positives


def flowing_area(time: ArrayLike, *, load: float, area: float, at: float, stress: float) -> Floats:
    r"""Return the area of contacts that flow by Eyring's law v0 sinh(s/s0), through one value of it.

    A contact that has flowed for a time t over a length L bears s = s0 ln(2 L/(v0 t)), which falls by s0 in
    every e-fold of time. If such contacts bear all of the load F, their area is F/s, and

        B = d ln A / d ln t = s0/s,        1/A(t) = 1/A(t1) - (s0/F) ln(t/t1).

    Parameters
    ----------
    time
        Times t > 0.
    load
        F, force.
    area
        The area A(t1).
    at
        The time t1.
    stress
        s0, pressure.

    Returns
    -------
    ndarray
        Shape of ``time``; infinite from the time on at which s has come down to 0, long before which the
        law of sinh ends this.

    Raises
    ------
    InputError
        A number is not positive and finite.

    Notes
    -----
    Contacts that do not flow yet bear a part of the load without growing, so B is at most s0/s.
    """
    given = positives(time=time, load=load, area=area, at=at, stress=stress)
    t, force, first, since, scale = broadcast(**given)
    inverse = 1 / first - scale / force * np.log(t / since)
    return np.divide(1.0, inverse, out=np.full_like(inverse, np.inf), where=inverse > 0)[()]
