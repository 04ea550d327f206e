r"""Elastic half-spaces: one sphere, one wave, and a random surface.

All lengths in one unit, all pressures and moduli in another, or texts with a unit, which give SI; E* is the
contact modulus (`asperity.solids.contact_modulus`).

    sphere      a^3 = 3 F R / (4 E*),   d = a^2 / R,   p_max = 3 F / (2 pi a^2),   dF/dd = 2 E* a
    wave        share of a wavelength in contact: (2/pi) asin sqrt(p/p*), p* = pi E* amplitude / wavelength
    roughness   share in contact: erf( sqrt(2) p / (E* slope) )

Let the sphere be one of a square array of period L, and the approach d be measured to the mean of the
surface. The other contacts, and the even pressure that balances them, displace a contact at the distance r
from its center, for a/L << 1, by

    F / (pi E*) [ -c/L + k (r^2 + <s^2>) / L^3 ],
    c = -4 zeta(1/2) beta(1/2) = 3.9003,   k = zeta(3/2) beta(3/2) = 2.2584,

with <s^2> the mean square distance of the load from the center. c is the potential at one charge of a square
lattice in an even background, and 4 k / L^3 its Laplacian, a sum of 1/s^3. The curvature 1/R grows by 2 k F /
(pi E* L^3). <s^2> decides dF/dd: it is 2 a^2 / 5 under a sphere and 2 a^2 / 3 under a flat punch. The error
is of relative order (a/L)^5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erf, zeta

from asperity.base.checks import Floats, broadcast, not_negative, positive
from asperity.base.units import either, number

_CURVATURE = float(zeta(1.5) * (zeta(1.5, 0.25) - zeta(1.5, 0.75)) / 8)  # beta by Hurwitz' zeta function
_CONSTANT = 3.900264920001956  # -4 zeta(1/2) beta(1/2); scipy has no zeta function below 1


_UNITS = {"load": "N", "pressure": "Pa", "modulus": "Pa", "slope": "1"}
"""Units of arguments; of others m. Loads and pressures may be 0."""


@dataclass(frozen=True)
class Hertz:
    """An elastic sphere on a plane; each is an array of the shape of the arguments.

    Radius a (length) and area (length^2) of the contact, pressure in its middle (force / length^2), approach
    of the bodies (length), and increase of the load per approach (force / length).
    """

    contact_radius: Floats
    area: Floats
    largest_pressure: Floats
    approach: Floats
    stiffness: Floats


def hertz(load: ArrayLike, *, modulus: ArrayLike, radius: ArrayLike, period: float | None = None) -> Hertz:
    """Contact of a sphere, or of each of a square array of spheres.

    Parameters
    ----------
    load
        Normal load on one sphere (force), not below 0.
    modulus
        Contact modulus E* (force / length^2), above 0.
    radius
        Radius of the sphere, much larger than the contact (length), above 0.
    period
        Of a square array (length): much larger than the contact. The approach is then measured to the mean of
        the surface, as it is on a periodic lattice. By default there is one sphere.

    References
    ----------
    K. L. Johnson, *Contact Mechanics* (Cambridge 1985), Eqs. (4.22) to (4.24), (3.36), DOI
    10.1017/CBO9781139171731. The array: see `asperity.theory.continua`.
    """
    F, E, R = _numbers(load=load, modulus=modulus, radius=radius)
    L = math.inf if period is None else number("period", period, "m", above=0)
    others = F / (np.pi * E)
    R = 1 / (1 / R + 2 * _CURVATURE * others / L**3)
    a = np.cbrt(3 * F * R / (4 * E))
    with np.errstate(divide="ignore", invalid="ignore"):
        pressure = np.where(a > 0, 1.5 * F / (np.pi * a**2), 0.0)
        softness = 1 / (2 * E * a) + (4 / 3 * _CURVATURE * a**2 / L**3 - _CONSTANT / L) / (np.pi * E)
        stiffness = 1 / softness
    approach = a**2 / R + others * (0.4 * _CURVATURE * a**2 / L**3 - _CONSTANT / L)
    return Hertz(*(np.asarray(x)[()] for x in (a, np.pi * a**2, pressure, approach, stiffness)))


def westergaard_area(
    pressure: ArrayLike, *, modulus: ArrayLike, amplitude: ArrayLike, wavelength: ArrayLike
) -> Floats:
    """Share of a line in contact: a half-space on the wave amplitude * cos(2 pi x / wavelength).

    Parameters
    ----------
    pressure, modulus
        Load over nominal area, not below 0, and contact modulus E*, above 0 (force / length^2).
    amplitude, wavelength
        Of the wave (length), above 0.

    References
    ----------
    H. M. Westergaard, J. Appl. Mech. 6, 49 (1939), DOI 10.1115/1.4008919; K. L. Johnson, *Contact Mechanics*
    (Cambridge 1985), section 13.2.
    """
    p, E, height, length = _numbers(
        pressure=pressure, modulus=modulus, amplitude=amplitude, wavelength=wavelength
    )
    full = np.pi * E * height / length
    return np.asarray(2 / np.pi * np.arcsin(np.sqrt(np.minimum(p / full, 1.0))))[()]


def persson_area(pressure: ArrayLike, *, modulus: ArrayLike, slope: ArrayLike) -> Floats:
    """Share of a random surface in contact: Persson's theory, erf(sqrt(2) p / (E* slope)).

    The pressure of full contact is Gaussian, with the standard deviation E* slope / 2. At smaller loads its
    distribution is taken to diffuse as shorter waves are added, and to be absorbed at 0. At light loads it is
    sqrt(8/pi) p / (E* slope), somewhat less than what computations give.

    The slope is the root of the mean square gradient; other arguments are those of `westergaard_area`.

    References
    ----------
    B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001), DOI 10.1063/1.1388626; Phys. Rev. Lett. 87, 116101
    (2001), DOI 10.1103/PhysRevLett.87.116101.
    """
    p, E, gradient = _numbers(pressure=pressure, modulus=modulus, slope=slope)
    return np.asarray(erf(math.sqrt(2) * p / (E * gradient)))[()]


def _numbers(**values: ArrayLike) -> list[Floats]:
    """Check numbers, each alone or with its unit, and broadcast them."""
    numbers = {name: either(name, value, _UNITS.get(name, "m")) for name, value in values.items()}
    checked = {
        name: not_negative(name, value) if name in ("load", "pressure") else positive(name, value)
        for name, value in numbers.items()
    }
    return broadcast(**checked)
