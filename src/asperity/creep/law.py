r"""Laws of creep that are local and not linear: the velocity of the creeping shape under the stress there.

    d u0/dt = v(s),      v(0) = 0,      v does not fall as s grows

s is the force of the creeping springs at a site on the lattice of springs, and that force over the area of
a site on a continuum. Small stresses creep with the mobility v'(0), as with ``R_viscous``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar

import numpy as np
from annotated_types import Gt

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.base.parameters import Checked, Quantity, parameters_of
from asperity.errors import InputError

Rate = Annotated[float, Gt(0), Quantity("velocity", "m/s", "v0")]
Stress = Annotated[float, Gt(0), Quantity("stress", "Pa", "s0")]

LARGEST_EXPONENT = 600.0
"""Largest exponent of a velocity: it overflows at 710, and velocities are multiplied by times."""


class LocalCreep(Checked):
    """A local law of creep.

    The keys of a configuration are ``creep_`` and the names of its parameters: the fields of a frozen
    dataclass that are annotated with a `asperity.base.parameters.Quantity`.
    """

    formula: ClassVar[str] = ""
    """v(s) in one line; empty where it is not known."""

    greatest_stress: float = math.inf
    """Largest magnitude of the stress that the law takes."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Numbers to record with every result."""
        return {f"creep_{name}": getattr(self, name) for name in parameters_of(type(self))}

    def velocity(self, stress: Floats) -> tuple[Floats, Floats]:
        """Velocity v(s) and its derivative v'(s) >= 0 with respect to the stress; each law has its own."""
        raise NotImplementedError

    def bend(self, stress: Floats) -> Floats | float:
        """Change of the stress over which the derivative changes by about its own size."""
        return 0.1 * np.abs(stress)

    def fingerprint(self) -> str:
        """What tells it from other laws."""
        return repr(self)

    def check_stress(self, greatest: float) -> None:
        """Refuse a stress beyond belief.

        Raises
        ------
        InputError
            ``greatest`` is more than the law takes, or its velocity there is not finite.
        """
        limit = self.greatest_stress
        with np.errstate(over="ignore", invalid="ignore"):
            known = greatest <= limit and np.isfinite(self.velocity(np.array([greatest]))).all()
        if not known:
            most = f"of at most {limit:.3g}" if math.isfinite(limit) else "at which its velocity is finite"
            raise InputError(
                "creep",
                expected=f"stresses {most}, for its velocities leave the range of numbers beyond",
                got=f"{greatest:.3g}",
                advice="a hardness, a larger stress in the law (a smaller volume), or less load",
            )


def checked_law(creep: LocalCreep) -> LocalCreep:
    """Take a local law of creep and nothing else."""
    if not isinstance(creep, LocalCreep):
        raise InputError(
            "creep",
            expected="a law of creep",
            got=checks.kind_of(creep),
            advice="asperity.solids.Eyring(rate=1.0, stress=1.0)",
        )
    if type(creep).velocity is LocalCreep.velocity:
        expected = "a method velocity(stress) that returns v(s) and v'(s)"
        advice = "CreepLaw(rate, derivative), which takes them as two functions"
        raise InputError("creep", expected=expected, got=f"{checks.kind_of(creep)} without it", advice=advice)
    return creep
