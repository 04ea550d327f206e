r"""Local, nonlinear laws of creep: velocity of the creeping shape u0 at a site as a function of the stress s.

    d u0/dt = v(s),      v(0) = 0,      v does not fall as s grows

s is the force of the creeping springs at the site; on a continuum this force over the area of the site. Small
stresses creep with the mobility v'(0), as with ``R_viscous``.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from annotated_types import Gt

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.base.parameters import Law, Quantity
from asperity.errors import InputError

Rate = Annotated[float, Gt(0), Quantity("velocity", "m/s", "v0")]
Stress = Annotated[float, Gt(0), Quantity("stress", "Pa", "s0")]

_STEP, _ROUNDED = 1e-4, 1e-14
"""Relative step of a difference quotient, and relative rounding of a velocity."""

LARGEST_EXPONENT = 600.0
"""Largest exponent of a velocity: it overflows at 710, and velocities are multiplied by times."""


class LocalCreep(Law):
    """A local law of creep.

    Derive a frozen dataclass. Its fields with a `asperity.base.parameters.Quantity` are the parameters; their
    keys in a configuration begin with ``creep_``.
    """

    prefix = "creep"
    greatest_stress: float = math.inf
    """Largest magnitude of a stress that the law allows."""

    def velocity(self, stress: Floats) -> tuple[Floats, Floats]:
        """Velocity v(s) and its derivative v'(s) >= 0 with respect to the stress; each law has its own."""
        raise NotImplementedError

    def bend(self, stress: Floats) -> Floats | float:
        """Change of the stress over which the derivative changes by about its own size."""
        return 0.1 * np.abs(stress)

    def check_stress(self, greatest: float) -> None:
        """Check the law up to the greatest stress of a contact.

        Raises
        ------
        InputError
            The stress is above `greatest_stress`, or its velocity is not finite; or a velocity or derivative
            at a smaller stress is wrong.
        """
        limit = self.greatest_stress
        with np.errstate(over="ignore", invalid="ignore"):
            finite = greatest <= limit and np.isfinite(self.velocity(np.array([greatest]))).all()
        if not finite:
            most = f"of at most {limit:.3g}" if math.isfinite(limit) else "with a finite velocity"
            expected = f"stresses {most}, as larger ones make the velocity of this law overflow"
            advice = "a hardness, a larger stress in the law (a smaller volume), or less load"
            raise InputError("creep", expected=expected, got=f"{greatest:.3g}", advice=advice)
        if greatest > 0:
            self.check_at(greatest)

    def check_at(self, scale: float) -> None:
        """Check velocities and derivatives at stresses over six decades up to a scale."""
        half = scale * np.logspace(-6, 0, 49)
        probe = np.concatenate([-half[::-1], [0.0], half])
        value, slope = self.velocity(probe)
        advice = "CreepLaw(lambda s: s**3, lambda s: 3 * s**2)"
        if not (value[49] == 0 and (np.diff(value) >= 0).all() and (slope >= 0).all()):
            expected = "a function that is 0 at 0 and falls nowhere, with its derivative"
            raise InputError("rate", expected=expected, got="another one", advice=advice)
        step = _STEP * np.where(probe == 0, scale, probe)
        quotient = (self.velocity(probe + step)[0] - self.velocity(probe - step)[0]) / (2 * step)
        lost = _ROUNDED * np.abs(value / step)  # rounding of the difference
        off = (np.abs(quotient - slope) > 0.1 * np.maximum(quotient, slope) + lost) & (probe != 0)
        if np.count_nonzero(off) > 2:  # one may be a kink on either side
            worst = np.flatnonzero(off)[-1]
            expected = f"the derivative of the rate, {quotient[worst]:.3g} at the stress {probe[worst]:.3g}"
            raise InputError("derivative", expected=expected, got=f"{slope[worst]:.3g}", advice=advice)


def checked_law(creep: LocalCreep) -> LocalCreep:
    """Return a local law of creep; `InputError` for anything else."""
    advice = "asperity.solids.Eyring(rate=1.0, stress=1.0)"
    if not isinstance(creep, LocalCreep):
        raise InputError("creep", expected="a law of creep", got=checks.kind_of(creep), advice=advice)
    if type(creep).velocity is LocalCreep.velocity:
        expected = "a method velocity(stress) that returns v(s) and v'(s)"
        advice = "CreepLaw(rate, derivative), which takes them as two functions"
        raise InputError("creep", expected=expected, got=f"{checks.kind_of(creep)} without it", advice=advice)
    return creep
