r"""A shear force below the friction limit: where a contact sticks, where it slips, and how far it gives way.

Under a constant normal load P, forces r of the sites, a shear force Q makes a contact slip from its rim, and
the rest sticks. With Coulomb's law on each site, and tractions t along Q alone,

    0 <= s = mu r - t   perpendicular to   g = delta - K t >= 0,        sum of t = Q,

where K is the compliance along Q, delta the displacement of the bodies, and g how far a site has slipped. So
s are the forces on a punch of the shape mu K r under the load mu P - Q: a contact problem.

Where K is in proportion to the normal compliance (nu = 0), s = mu r(P - Q / mu), the forces of the same
bodies under less load (M. Ciavarella, Int. J. Solids Struct. 35, 2349 (1998), DOI
10.1016/S0020-7683(97)00154-6; J. Jaeger, J. Tribol. 120, 677 (1998), DOI 10.1115/1.2833765). On a ball and on
ellipsoids this holds at every nu.

Left out are tractions across Q: on rough contacts in which all sticks, the stiffness is too small by up to
0.7 % at nu = 0.3, and 2.5 % at 0.5. So is the coupling of displacements along and normal to the surface,
which two bodies that are alike or incompressible have not.

In a cycle between Q and -Q a site slips there and back, each time by 2 g against mu r, so that it loses

    4 mu [sum of r g] >= 0.

By Masing's rule, which Jaeger shows, this is 4 Q delta(Q) less 8 times the integral of delta from 0 to Q: the
elastic energy is quadratic, so that no quadrature is left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from asperity.base import views
from asperity.errors import InputError
from asperity.lattice import Field, Mask


@dataclass(frozen=True, eq=False, repr=False)
class PartialSlip(views.Brief):
    """A contact under a shear force that does not make it slide; lengths and forces are those of the contact.

    Attributes
    ----------
    shear
        Q, force.
    friction
        mu.
    stick, slip
        Sites that stick, and the other sites in contact: masks of the shape of the contact.
    traction
        Tangential traction, force / length^2: mu times the pressure where it slips, less where it sticks.
    poisson
        Poisson's ratio, or None; displacement, stiffness and energy ask for one.
    """

    shear: float
    friction: float
    stick: Mask
    slip: Mask
    traction: Field
    poisson: float | None
    _displacement: float = field(repr=False)
    _lost: float = field(repr=False)
    _stiffness: Callable[[], float] = field(repr=False)

    @property
    def stick_fraction(self) -> float:
        """Share of the contact that sticks."""
        return float(np.count_nonzero(self.stick)) / int(np.count_nonzero(self.stick | self.slip))

    @property
    def displacement(self) -> float:
        """How far the bodies are displaced along the shear force, length; after loading in one way."""
        self._check_poisson()
        return self._displacement

    @cached_property
    def stiffness(self) -> float:
        """Tangential stiffness dQ / d(displacement) at this shear force, force / length."""
        self._check_poisson()
        return self._stiffness()

    @property
    def energy_lost(self) -> float:
        """Energy lost in a cycle between Q and -Q at constant load, force times length; see the module.

        Exact for the sites: 0 where none slips.
        """
        self._check_poisson()
        return self._lost

    def _check_poisson(self) -> None:
        if self.poisson is None:
            expected, advice = "Poisson's ratio, which displacements under shear depend on", "poisson=0.3"
            raise InputError("poisson", expected=expected, got="none", advice=advice)
