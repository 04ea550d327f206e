r"""Laws of stiffness and of mobility: what a solid is at each wave vector of a lattice.

The force at a site is the pressure times the area `Lattice.cell` that belongs to it, so a law of a continuum
is a stiffness per area times that. The laws of the lattice of springs are defined on sites.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np
import scipy

from asperity.base import checks
from asperity.lattice import Field, Lattice, Spectrum

SpectrumOf = Callable[[Lattice], Spectrum]

RIGID = 1e4
"""Stiffness at wave vector 0, over the largest elsewhere, of what counts as rigid.

At a held separation the load is too small by the stiffness of the contact over that of all sites here: by
2e-6 of it at 15 % contact, 2e-4 at 89 %. From about 1e6 on the rounding of the mean disturbs creep. A load
that is held does not depend on it.
"""


class Numbers:
    """A dataclass whose fields that are called numbers become Python floats."""

    def __post_init__(self) -> None:
        for field_ in fields(self):  # type: ignore[arg-type]
            if field_.type == "float":
                object.__setattr__(self, field_.name, checks.number(field_.name, getattr(self, field_.name)))


@dataclass(frozen=True)
class LaplacianSpectrum(Numbers):
    """The spectrum ``laplacian * lam(q) + uniform``: springs to the neighbors and to the bulk."""

    laplacian: float = 0.0
    uniform: float = 0.0

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice."""
        return self.laplacian * lattice.lam + self.uniform


@dataclass(frozen=True)
class WaveNumberSpectrum(Numbers):
    """The spectrum ``slope * abs(q)`` for each unit of area: a half-space under normal load.

    Where the rough body has free edges, the inverse of the compliance of pixels under even pressure.
    """

    slope: float

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice."""
        if lattice.body:
            return 2 * self.slope * lattice.cell / compliance_of_pixels(lattice)
        return self.slope * lattice.wave_number * lattice.cell


@dataclass(frozen=True)
class LayerSpectrum(Numbers):
    r"""A layer on a rigid base under normal load: E* abs(q) / (2 S(abs(q) thickness)).

    With x = abs(q) thickness and Poisson's ratio nu, where the layer is bonded to the base

        S = [(3 - 4 nu) sinh 2x - 2x] / [(3 - 4 nu) cosh 2x + 2 x^2 + 5 - 12 nu + 8 nu^2],

    and S = (cosh 2x - 1) / (sinh 2x + 2x) where it slides on it without friction (K. L. Johnson, *Contact
    Mechanics* (1985), section 5.8; R. H. Bentall, K. L. Johnson, Int. J. Mech. Sci. 10, 637 (1968), DOI
    10.1016/0020-7403(68)90070-2).
    """

    modulus: float
    poisson: float
    thickness: float
    bonded: bool = True

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice; an incompressible bonded layer is `RIGID` at wave vector 0."""
        q = lattice.wave_number
        x, nu = q * self.thickness, self.poisson
        decay = np.exp(-2 * x)  # numerator and denominator are multiplied by it
        sinh, cosh = -np.expm1(-4 * x) / 2, (1 + decay**2) / 2
        if self.bonded:
            numerator = (3 - 4 * nu) * sinh - 2 * x * decay
            denominator = (3 - 4 * nu) * cosh + (2 * x**2 + 5 - 12 * nu + 8 * nu**2) * decay
            compressed = (1 - nu) ** 2 / (1 - 2 * nu) if nu < 0.5 else math.inf
        else:
            numerator, denominator = cosh - decay, sinh + 2 * x * decay
            compressed = 1.0
        q.flat[0] = numerator.flat[0] = 1.0
        spectrum = self.modulus * lattice.cell * q * denominator / (2 * numerator)
        spectrum.flat[0] = self.modulus * lattice.cell * compressed / self.thickness
        if math.isinf(compressed):
            spectrum.flat[0] = RIGID * spectrum.flat[1:].max(initial=self.modulus * lattice.cell)
        return spectrum


@dataclass(frozen=True)
class Scaled(Numbers):
    """A law times a factor: the part of a stiffness that a branch has."""

    law: SpectrumOf
    factor: float

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice."""
        return self.factor * self.law(lattice)


@dataclass(frozen=True)
class PowerMobility(Numbers):
    """The mobility ``mobility * abs(q)**exponent`` of a continuum, velocity per pressure; 0 at q = 0.

    Bulk flow has the exponent -1, dissolution 0, diffusion through the volume 1, along the surface 2
    (C. Herring, J. Appl. Phys. 21, 301 (1950), DOI 10.1063/1.1699656; W. W. Mullins, J. Appl. Phys. 30,
    77 (1959), DOI 10.1063/1.1734979).
    """

    mobility: float
    exponent: float

    def __call__(self, lattice: Lattice) -> Spectrum:
        """Evaluate on a lattice."""
        q = lattice.wave_number
        q.flat[0] = 1.0
        spectrum = self.mobility * q**self.exponent / lattice.cell
        spectrum.flat[0] = 0.0
        return spectrum

    def __str__(self) -> str:
        return f"{self.mobility:.3g} q^{self.exponent:g}"


@lru_cache(maxsize=1)
def compliance_of_pixels(lattice: Lattice) -> Spectrum:
    r"""Spectrum of the displacement of a half-space by even pressures on pixels, times E* over the pressure.

    A unit of pressure on one pixel displaces the surface of a half-space at a distance (y, x) by the integral
    of 1 / (pi E* r) over the pixel, which has a closed form (A. E. H. Love, Phil. Trans. R. Soc. A 228, 377
    (1929), DOI 10.1098/rsta.1929.0009). Along each axis of the embedding (two of them) the distance is that
    to the nearest image, and the body covers less than half of it: so within the body sums of these are those
    of an infinite half-space. That the sums in the empty space are of nothing real does no harm, as it has
    neither forces nor heights. The spectrum is positive, a length.
    """
    # The integral over the rectangle between the origin and (y, x).
    return _of_pixels(lattice, lambda y, x: x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y)))


@lru_cache(maxsize=1)
def shear_compliance(lattice: Lattice) -> tuple[Spectrum, Spectrum, Spectrum, Spectrum]:
    r"""Spectra of a half-space under forces along its surface, times E* and the area of a pixel.

    The displacement along i by a force along j has delta_ij N + nu / (1 - nu) B_ij. N is the compliance under
    normal forces. Returns N, B_yy, B_yx and B_xx. With the wave vector q and a distance r

        N = 2 / q,    B_yy = N q_x^2 / q^2,    B_yx = -N q_x q_y / q^2,    B_xx = N q_y^2 / q^2,

    or where edges are free the integrals over a pixel of 1 / r, y^2 / r^3, y x / r^3 and x^2 / r^3, over pi
    (V. Cerruti, 1882; K. L. Johnson, *Contact Mechanics* (1985), section 3.6). Where edges reflect, spectra
    have one more wave along each axis, for `asperity.carried.shear`.
    """
    if lattice.body:
        normal = compliance_of_pixels(lattice)
        cross = _of_pixels(lattice, lambda y, x: -np.hypot(y, x), sign=-1)
        along_x = _of_pixels(lattice, lambda y, x: y * np.arcsinh(x / np.abs(y)))
        return normal, normal - along_x, cross, along_x
    angles = lattice.angles
    if lattice.reflecting:
        angles = tuple(np.meshgrid(*(np.pi * np.arange(n + 1) / n for n in lattice.shape), indexing="ij"))
    y, x = (angle / side for angle, side in zip(angles, lattice.spacing, strict=True))
    q = np.hypot(y, x)
    q.flat[0] = math.inf
    # A wave with two sites a period has no sign, and a product of sines is minus that of two derivatives.
    signed = np.prod([np.abs(angle) < np.pi for angle in np.broadcast_arrays(*angles)], axis=0)
    cross = (1 if lattice.reflecting else -1) * signed * y * x
    return 2 / q, 2 * x**2 / q**3, 2 * cross / q**3, 2 * y**2 / q**3


def _of_pixels(lattice: Lattice, integral: Callable[[Field, Field], Field], sign: int = 1) -> Spectrum:
    """Spectrum of a function of the distance over pi, integrated over a pixel.

    ``integral`` is that over y and x; ``sign`` is -1 for a function that is odd in both.
    """
    sides = zip(lattice.shape, lattice.spacing, strict=True)
    corners = ((np.arange(n // 2 + 2) - 0.5) * side for n, side in sides)
    values = integral(*np.meshgrid(*corners, indexing="ij", sparse=True))
    near = np.diff(np.diff(values, axis=0), axis=1) / np.pi
    for axis, n in enumerate(lattice.shape):  # and the same at the distances before the next image
        mirrored = np.flip(np.take(near, np.arange(1, (n + 1) // 2), axis), axis)
        near = np.concatenate((near, sign * mirrored), axis)
    return np.ascontiguousarray(scipy.fft.rfftn(near).real)
