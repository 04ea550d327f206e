"""Viscoelastic relaxation: laws and measured data as branches of a generalized Maxwell solid.

A table, a law or a half-space becomes a `Material`, for `asperity.predict`::

    polymer = asp.relaxation.material("relaxation.csv", poisson=0.37)

`read` and `fit` are its steps; laws and fits are a `PronySeries`.
"""

from asperity.base.calls import answered as _answered
from asperity.relaxation.data import Creep, Dynamic, Measured, Relaxation
from asperity.relaxation.files import read
from asperity.relaxation.fitting import Fit, fit
from asperity.relaxation.laws import fractional_zener, power_law
from asperity.relaxation.materials import Material, material
from asperity.relaxation.series import PronySeries, combined, from_retardation
from asperity.relaxation.temperature import arrhenius, wlf
from asperity.solids.branches import check_branches

__all__ = [
    "Creep",
    "Dynamic",
    "Fit",
    "Material",
    "Measured",
    "PronySeries",
    "Relaxation",
    "arrhenius",
    "check_branches",
    "combined",
    "fit",
    "fractional_zener",
    "from_retardation",
    "material",
    "power_law",
    "read",
    "wlf",
]
__dir__ = _answered(globals())
