"""Tabor's relation: the friction force is the shear strength of the contacts times their real area.

    friction force = sigma_S A,      friction coefficient mu = sigma_S A / load

(F. P. Bowden, D. Tabor, *The Friction and Lubrication of Solids*, Oxford, 1950). The shear strength is
constant, or grows with the logarithm of the sliding velocity, as at interfaces that creep under shear (T.
Baumberger, C. Caroli, Adv. Phys. 55, 279 (2006), DOI 10.1080/00018730600732186), or of the age of each site
in contact: see `ShearStrength`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asperity.ask.strength import ShearStrength
from asperity.base import checks, units
from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.results.quantities import describe, select, units_named

if TYPE_CHECKING:
    import xarray as xr


def add_friction(dataset: xr.Dataset, shear_strength: ShearStrength | float | str) -> xr.Dataset:
    """Add the friction force and the friction coefficient to the dataset of a history.

    Returns
    -------
    Dataset
        With ``friction_force`` and ``friction``, the force over the load, NaN where that does not press:
        those of sliding, or, at rest, those at which the surface would begin to slide, at the velocity of the
        next slide leg, or else of the last one. The area is ``contact_area_corrected``; on a solid that is
        defined on sites, their number.

    `InputError` for a strength with units if the dataset has none, one that depends on a velocity which the
    history lacks, or one that grows with the age of contacts.
    """
    import xarray as xr

    checks.instance("dataset", dataset, xr.Dataset, "history.dataset")
    law = shear_strength if isinstance(shear_strength, ShearStrength) else ShearStrength(shear_strength)  # type: ignore[arg-type]
    if law.growth:
        expected = "a strength that does not age: ages are known only while a history runs"
        advice = "asperity.age(..., carried=asperity.Carried(strength=...))"
        raise InputError("shear_strength", expected=expected, got="one that does", advice=advice)
    return with_friction(dataset, law)


def with_friction(dataset: xr.Dataset, law: ShearStrength, grown: Floats | None = None) -> xr.Dataset:
    """As `add_friction`; with the relative growth of the strength at each time also the part of the area."""
    units.check_units(vars(law), si=bool(dataset.attrs.get("si", 0)))
    on_sites = "contact_area_corrected" not in dataset
    area, load = dataset["area" if on_sites else "contact_area_corrected"], dataset["load"]
    velocity = dataset["velocity"].values if "velocity" in dataset else 0.0

    speeds = np.apply_along_axis(coming_velocity, -1, np.broadcast_to(velocity, load.shape))
    strength, touching = law.at(speeds, 0.0 if grown is None else grown), np.maximum(area.values, 0.0)
    carried = np.where(load.values > 0, load.values, np.nan)
    series = {"friction_force": strength * touching, "friction": strength * touching / carried}
    if grown is not None:
        by_area = law.at(speeds) * touching / carried
        series |= {"friction_by_area": by_area, "strength_mean": strength}
    named = units_named({name: dataset[name].attrs["units"] for name in ("time", "load")})
    dataset = dataset.assign({name: (load.dims, values) for name, values in series.items()})
    describe(dataset, {name: select("series")[name].facts for name in series}, named)
    return dataset.assign_attrs(
        shear_strength=law.strength,
        **{name: x for name, x in vars(law).items() if name != "strength" and x is not None},
    )


def coming_velocity(velocity: Floats) -> Floats:
    """The velocity; at rest that of the next slip, or else of the last one, or 0 without any."""
    slides = np.flatnonzero(velocity > 0)
    if not slides.size:
        return velocity
    return velocity[slides[np.minimum(np.searchsorted(slides, np.arange(velocity.size)), slides.size - 1)]]
