"""The shear strength of contacts, of which friction follows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks
from asperity.base.parameters import Checked, Quantity
from asperity.errors import LARGEST, InputError


@dataclass(frozen=True)
class ShearStrength(Checked):
    """The shear strength of contacts; constant, or growing with the sliding velocity and the age of a site.

        sigma_S = sigma_0 (1 + a ln(V / V_ref) + beta ln(1 + theta / tau)),    d theta / dt = 1 - V theta / D

    Each site has an age theta, 0 when it begins to touch: the law of aging of J. H. Dieterich, J. Geophys.
    Res. 84, 2161 (1979), DOI 10.1029/JB084iB05p02161.

    Parameters
    ----------
    strength
        sigma_0 > 0, force / area; per site on a solid that is defined on sites. With a unit: ``"40 MPa"``.
    rate_coefficient
        a >= 0, the relative growth of the strength per factor e of velocity; 0 for a constant strength.
    reference_velocity
        V_ref > 0, length / time, at which the strength is sigma_0; needed unless the coefficient is 0.
    growth
        beta, the relative growth of the strength per factor e of age. Below 0 contacts weaken.
    after
        tau > 0, the age, time, from which the strength grows; needed unless the growth is 0.
    renewal
        D > 0, the slip, length, that renews a contact; needed with `after`.
    """

    needs = (
        ("rate_coefficient", ("reference_velocity",)),
        ("growth", ("after",)),
        ("after", ("renewal",)),
        ("renewal", ("after",)),
    )

    strength: Annotated[
        float,
        *(Ge(1 / LARGEST), Le(LARGEST)),
        Quantity(
            "shear strength of the contacts; on the lattice of springs, force per site.",
            "Pa",
            key="shear_strength",
            usual=None,
        ),
    ]
    rate_coefficient: Annotated[
        float,
        *(Ge(0), Le(1)),
        Quantity("relative growth of the shear strength with ln(velocity). By default 0.", usual=None),
    ] = 0.0
    reference_velocity: Annotated[
        float | None,
        Ge(1 / LARGEST),
        Quantity("sliding velocity that belongs to the shear strength", "m/s", dimension="place / time"),
    ] = None
    growth: Annotated[
        float,
        *(Ge(-1), Le(1)),
        Quantity(
            "relative growth of the shear strength with ln(age of a contact). By default 0.", usual=None
        ),
    ] = 0.0
    after: Annotated[
        float | None,
        Ge(1 / LARGEST),
        Quantity("age of a contact from which its shear strength grows", "s"),
    ] = None
    renewal: Annotated[
        float | None,
        Ge(1 / LARGEST),
        Quantity("slip that renews a contact; its age then begins anew.", "m", dimension="place"),
    ] = None

    @property
    def ages(self) -> bool:
        """Whether it asks for the ages of contacts."""
        return self.after is not None

    def renewed(self, duration: float, slip: float) -> tuple[float, float]:
        """What is left of an age, 0 to 1, and what comes to it, time, by a slip at a constant velocity."""
        x = slip / (self.renewal or math.inf)
        return math.exp(-x), duration * (-math.expm1(-x) / x if x else 1.0)

    def grown(self, age: ArrayLike) -> NDArray[np.float64]:
        """Relative growth of the strength at an age: beta ln(1 + theta / tau)."""
        return np.asarray(self.growth * np.log1p(np.asarray(age) / (self.after or math.inf)))

    def settled(self, velocity: ArrayLike) -> NDArray[np.float64]:
        """The same in steady sliding, where contacts are as old as D / V."""
        return self.grown(np.asarray((self.renewal or 0.0) / np.asarray(velocity)))

    def at(self, velocity: ArrayLike, grown: ArrayLike = 0.0) -> NDArray[np.float64]:
        """Shear strength while the contacts slide at velocities > 0, of any shape, and have ``grown``.

        `InputError` if the strength depends on a velocity that is infinite, or would not be above 0.
        """
        speeds, rate = checks.floats("velocity", velocity), np.zeros(())
        if self.rate_coefficient and not (np.isfinite(speeds).all() and (speeds > 0).all()):
            expected = "finite velocities > 0, where the shear strength depends on them"
            got = "a contact that does not slide, or slides at once"
            advice = "Slide(..., velocity=1.0), or rate_coefficient=0.0"
            raise InputError("velocity", expected=expected, got=got, advice=advice)
        if self.rate_coefficient:
            assert self.reference_velocity is not None
            rate = self.rate_coefficient * np.log(speeds / self.reference_velocity)
        strength = np.broadcast_to(self.strength * (1 + rate + np.asarray(grown)), speeds.shape)
        if not (strength > 0).all():
            name, got = "rate_coefficient", f"{float(strength.min()):g} at {float(speeds.min()):g}"
            name = name if self.rate_coefficient else "growth"
            raise InputError(name, expected="a shear strength > 0 at every velocity", got=got)
        return strength
