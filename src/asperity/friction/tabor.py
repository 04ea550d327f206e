"""Tabor's relation: the friction force is the shear strength of the contacts times their real area.

    friction force = sigma_S A,      friction coefficient mu = sigma_S A / load

(F. P. Bowden, D. Tabor, *The Friction and Lubrication of Solids*, Oxford, 1950). The shear strength is
constant, or grows with the logarithm of the sliding velocity, as at interfaces that creep under shear (T.
Baumberger, C. Caroli, Adv. Phys. 55, 279 (2006), DOI 10.1080/00018730600732186):

    sigma_S = sigma_0 (1 + a ln(V / V_ref))
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks, units
from asperity.errors import LARGEST, InputError
from asperity.friction.laws import coming_velocity
from asperity.theory import static_friction


@dataclass(frozen=True)
class ShearStrength:
    """The shear strength of contacts; see the module.

    Parameters
    ----------
    strength
        sigma_0 > 0, force / area; per site on a solid that is defined on sites. With a unit: ``"40 MPa"``.
    rate_coefficient
        a >= 0, the relative growth of the strength per factor e of velocity; 0 for a constant strength.
    reference_velocity
        V_ref > 0, length / time, at which the strength is sigma_0; needed unless the coefficient is 0.
    """

    strength: float
    rate_coefficient: float = 0.0
    reference_velocity: float | None = None

    def __post_init__(self) -> None:
        least = 1 / LARGEST
        strength = units.number("shear_strength", self.strength, "Pa", least=least)
        object.__setattr__(self, "strength", strength)
        rate = checks.number("rate_coefficient", self.rate_coefficient, least=0)
        object.__setattr__(self, "rate_coefficient", rate)
        if self.reference_velocity is not None:
            velocity = units.number("reference_velocity", self.reference_velocity, "m/s", least=least)
            object.__setattr__(self, "reference_velocity", velocity)
        elif rate:
            raise InputError(
                "reference_velocity",
                expected="the velocity at which the shear strength was measured",
                got="none, and a rate coefficient",
                advice="reference_velocity=1.0",
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


def add_friction(dataset: xr.Dataset, shear_strength: ShearStrength | float | str) -> xr.Dataset:
    """Add the friction force and the friction coefficient to the dataset of a history.

    Returns
    -------
    Dataset
        With ``friction_force`` and ``friction``, the force over the load: those of sliding, or, at rest,
        those at which the surface would begin to slide, at the velocity of the next slide leg, or else of the
        last one. The area is ``contact_area_corrected``; on a solid that is defined on sites, their number.

    `InputError` for a strength with units if the dataset has none, or one that depends on a velocity which
    the history lacks. The coefficient is `asperity.theory.static_friction`.
    """
    from asperity.results.quantities import select  # late, as it brings the solvers

    checks.instance("dataset", dataset, xr.Dataset, "history.dataset")
    law = shear_strength if isinstance(shear_strength, ShearStrength) else ShearStrength(shear_strength)  # type: ignore[arg-type]
    units.check_units(vars(law), si=bool(dataset.attrs.get("si", 0)))
    on_sites = "contact_area_corrected" not in dataset
    area, load = dataset["area" if on_sites else "contact_area_corrected"], dataset["load"]
    velocity = dataset["velocity"].values if "velocity" in dataset else 0.0

    speeds = np.apply_along_axis(coming_velocity, -1, np.broadcast_to(velocity, load.shape))
    strength = law.at(speeds)
    carried = np.maximum(load.values, np.finfo(float).tiny)
    coefficient = static_friction(np.maximum(area.values, 0.0), carried, strength)
    units_of = {"force": load.attrs["units"], "1": "1"}
    force, ratio = (
        {"long_name": quantity.long_name, "units": units_of[quantity.dimension]}
        for quantity in select("series", of=("friction",)).values()
    )
    return dataset.assign(
        friction_force=(load.dims, coefficient * carried, force),
        friction=(load.dims, coefficient, ratio),
    ).assign_attrs(
        shear_strength=law.strength,
        **{name: x for name, x in vars(law).items() if name != "strength" and x is not None},
    )
