"""Viscoelastic relaxation: laws and measured data as branches of a generalized Maxwell solid.

A table, a law or a half-space becomes a `Material`, for `asperity.predict`::

    polymer = asp.relaxation.material("relaxation.csv", poisson=0.37)

`read` and `fit` are its steps; laws and fits are a `PronySeries`.
"""

from asperity.base.calls import answered as _answered
from asperity.relaxation.data import Creep as Creep
from asperity.relaxation.data import Dynamic as Dynamic
from asperity.relaxation.data import Measured as Measured
from asperity.relaxation.data import Relaxation as Relaxation
from asperity.relaxation.files import read as read
from asperity.relaxation.fitting import Fit as Fit
from asperity.relaxation.fitting import fit as fit
from asperity.relaxation.laws import fractional_zener as fractional_zener
from asperity.relaxation.laws import power_law as power_law
from asperity.relaxation.materials import Material as Material
from asperity.relaxation.materials import material as material
from asperity.relaxation.series import PronySeries as PronySeries
from asperity.relaxation.series import combined as combined
from asperity.relaxation.series import from_retardation as from_retardation
from asperity.relaxation.temperature import arrhenius as arrhenius
from asperity.relaxation.temperature import wlf as wlf
from asperity.solids.branches import check_branches as check_branches

__dir__ = _answered(globals())
