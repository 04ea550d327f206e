r"""A shear force below the friction limit: where a contact sticks, where it slips, and how far it gives way.

Under a constant normal load P a shear force Q makes a contact slip from its rim, and the rest sticks. If
normal and tangential displacements do not couple, the tangential traction is mu times the difference of two
normal pressures of the same bodies, whatever their shape,

    q = mu [p(P) - p(P')],    P' = P - Q / mu,    delta_t(Q) = mu (k_n / k_t) [delta(P) - delta(P')],

with the approach delta; the contact at P' is what sticks (M. Ciavarella, Int. J. Solids Struct. 35, 2349
(1998), DOI 10.1016/S0020-7683(97)00154-6; J. Jaeger, J. Tribol. 120, 677 (1998), DOI 10.1115/1.2833765).
k_n / k_t = (2 - nu) / (2 (1 - nu)) on a half-space. Displacements couple, unless the two bodies are alike or
incompressible; that is left out.

In a cycle between Q and -Q a site slips there and back, by 2 mu (k_n / k_t) times the gap g that it has under
P', against mu times its force r under P. So the cycle loses

    4 mu^2 (k_n / k_t) [sum of r(P) g(P')] >= 0.

By Masing's rule, which Jaeger shows, this is 4 Q delta_t(Q) less 8 times the integral of delta_t from 0 to Q:
the elastic energy is quadratic, so that no quadrature is left.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from asperity.base import views
from asperity.errors import InputError
from asperity.lattice import Field, Mask

Pressed = Any
"""An `asperity.Contact`, whose module imports this one."""


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
    _whole: Pressed = field(repr=False)
    _stuck: Pressed = field(repr=False)

    @property
    def stick_fraction(self) -> float:
        """Share of the contact that sticks."""
        return float(np.count_nonzero(self.stick)) / int(np.count_nonzero(self.stick | self.slip))

    @cached_property
    def displacement(self) -> float:
        """How far the bodies are displaced along the shear force, length; after loading in one way."""
        return self._compliance * float(self._stuck.separation - self._whole.separation)

    @cached_property
    def stiffness(self) -> float:
        """Tangential stiffness dQ / d(displacement) at this shear force, force / length."""
        return shear_ratio(self.poisson) * float(self._stuck.normal_stiffness)

    @cached_property
    def energy_lost(self) -> float:
        """Energy lost in a cycle between Q and -Q at constant load, force times length; see the module.

        Exact for the sites: 0 where none slips.
        """
        work = np.vdot(self._whole.force, self._stuck.gap)
        return 4 * self.friction * self._compliance * float(work)

    @property
    def _compliance(self) -> float:
        """Displacement along the shear force over the approach that P' lacks."""
        return self.friction / shear_ratio(self.poisson)


def shear_ratio(poisson: float | None) -> float:
    """Tangential over normal stiffness of a contact on a half-space, 2 (1 - nu) / (2 - nu).

    K. L. Johnson, *Contact Mechanics* (Cambridge 1985), section 7.2. `InputError` without Poisson's ratio.
    """
    if poisson is None:
        expected, advice = "Poisson's ratio, which displacements under shear depend on", "poisson=0.3"
        raise InputError("poisson", expected=expected, got="none", advice=advice)
    return 2 * (1 - poisson) / (2 - poisson)
