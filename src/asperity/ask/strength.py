"""The shear strength of contacts, of which friction follows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks
from asperity.base.parameters import Checked, Quantity
from asperity.errors import LARGEST, InputError, Name


@dataclass(frozen=True)
class ShearStrength(Checked):
    """The shear strength of contacts; constant, or growing with the sliding velocity.

        sigma_S = sigma_0 (1 + a ln(V / V_ref))

    Parameters
    ----------
    strength
        sigma_0 > 0, force / area; per site on a solid that is defined on sites. With a unit: ``"40 MPa"``.
    rate_coefficient
        a >= 0, the relative growth of the strength per factor e of velocity; 0 for a constant strength.
    reference_velocity
        V_ref > 0, length / time, at which the strength is sigma_0; needed unless the coefficient is 0.
    """

    strength: Annotated[
        float,
        *(Ge(1 / LARGEST), Le(LARGEST)),
        Quantity(
            "shear strength of the contacts",
            "Pa",
            key="shear_strength",
            more="; on the lattice of springs, force per site.",
        ),
    ]
    rate_coefficient: Annotated[
        float,
        *(Ge(0), Le(1)),
        Quantity(
            "relative growth of the shear strength with ln(velocity)", usual=None, more=". By default 0."
        ),
    ] = 0.0
    reference_velocity: Annotated[
        float | None,
        Ge(1 / LARGEST),
        Quantity("sliding velocity that belongs to the shear strength", "m/s", dimension="place / time"),
    ] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rate_coefficient and self.reference_velocity is None:
            raise InputError(
                "rate_coefficient", expected=(Name("reference_velocity"), " beside it"), got="none"
            )

    def at(self, velocity: ArrayLike) -> NDArray[np.float64]:
        """Shear strength while the contacts slide at velocities > 0, of any shape.

        `InputError` if the strength depends on a velocity that is infinite, or so low that the strength would
        not be above 0.
        """
        speeds = checks.floats("velocity", velocity)
        if not self.rate_coefficient:
            return np.full(speeds.shape, self.strength)
        if not (np.isfinite(speeds).all() and (speeds > 0).all()):
            raise InputError(
                "velocity",
                expected="finite velocities > 0, where the shear strength depends on them",
                got="a contact that does not slide, or slides at once",
                advice="Slide(..., velocity=1.0), or rate_coefficient=0.0",
            )
        assert self.reference_velocity is not None
        strength = self.strength * (1 + self.rate_coefficient * np.log(speeds / self.reference_velocity))
        if not (strength > 0).all():
            raise InputError(
                "rate_coefficient",
                expected="a shear strength > 0 at every velocity",
                got=f"{float(strength.min()):g} at {float(speeds.min()):g}",
                advice="a reference_velocity nearer to those of the slides",
            )
        return np.asarray(strength)
