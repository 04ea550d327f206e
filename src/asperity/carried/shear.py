r"""Contacts on a half-space that are all displaced along its surface, together, before anything slips.

With the compliance K of `asperity.solids.laws.shear_compliance`, forces f along both axes on the contacts C
displace these by 1 along the axis j:

    K f = e_j on C,        k_ij = sum of f_i,        compliance c = 1 / k.

Conjugate gradients on C find f; the preconditioner is 1 / K of all sites, between those of C. Where edges
reflect, forces along the displacement are even at mirrors, and the others are odd: cosine and sine
transforms. The sums of the odd ones are 0.

Displacements along and normal to the surface are uncoupled: the bodies are alike or incompressible.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast
from weakref import WeakKeyDictionary

import numpy as np
import scipy

from asperity.base import checks
from asperity.contact import Contact
from asperity.contact.arrays import inverse
from asperity.contact.contact import Direction
from asperity.errors import ConvergenceError, InputError
from asperity.lattice import Field, Lattice, Mask, Modes, Spectrum
from asperity.solids.laws import shear_compliance

_SOLVED = 1e-6
"""Relative residual on the contacts."""

_COMPLIANCES: WeakKeyDictionary[Contact, dict[float, Field]] = WeakKeyDictionary()
"""Results of `compliances` by Poisson's ratio, kept while the contact lives."""


@dataclass(frozen=True, eq=False)
class Shear:
    """Spectra of the displacement along y and x by a force of a site along y and x."""

    lattice: Lattice
    yy: Spectrum
    yx: Spectrum
    xx: Spectrum

    @classmethod
    def of(cls, contact: Contact, poisson: float) -> Shear:
        """That of a contact on a half-space."""
        lattice, part = contact.lattice.embedding, poisson / (1 - poisson)
        scale = 1 / (cast(float, contact.solid.modulus) * lattice.cell)
        normal, yy, yx, xx = (scale * spectrum for spectrum in shear_compliance(lattice))
        return cls(lattice, normal + part * yy, part * yx, normal + part * xx)

    def along(self, direction: Direction) -> Spectrum:
        """Spectrum of the displacement by forces along the same direction; on the lattice."""
        y, x = unit_vector(direction)
        if self.lattice.reflecting and min(abs(y), abs(x)) > 0:
            expected = "'x' or 'y' where edges reflect: others are not those of mirror images"
            raise InputError("direction", expected=expected, got=direction, advice="'x'")
        whole = y * y * self.yy + 2 * y * x * self.yx + x * x * self.xx
        return np.ascontiguousarray(whole[tuple(map(slice, self.lattice.spectral_shape))])

    def displacement(self, force: Field, axis: int) -> Field:
        """Displacements along y and x, shape ``(2, *shape)``, by such forces; contacts move along an axis."""
        return self._applied((self.yy, self.yx, self.xx), force, axis)

    def stiffened(self, field: Field, axis: int) -> Field:
        """Forces of displacements of all sites."""
        return self._applied(self._stiffness, field, axis)

    @cached_property
    def _stiffness(self) -> tuple[Spectrum, Spectrum, Spectrum]:
        determinant = inverse(self.yy * self.xx - self.yx**2)
        return self.xx * determinant, -self.yx * determinant, self.yy * determinant

    def _applied(self, spectra: tuple[Spectrum, Spectrum, Spectrum], fields: Field, axis: int) -> Field:
        yy, yx, xx = spectra
        y, x = (self._modes(part, odd=n != axis) for n, part in enumerate(fields))
        parts = yy * y + yx * x, yx * y + xx * x
        return np.stack([self._field(part, odd=n != axis) for n, part in enumerate(parts)])

    def held(self, sites: Mask, axis: int) -> Field:
        """Forces along y and x, shape ``(2, *shape)``, that displace the sites by 1 along an axis."""
        both, count = np.stack([sites, sites]), np.count_nonzero(sites)

        def spread(values: Field) -> Field:
            field = np.zeros(both.shape)
            field[both] = values
            return field

        def operator(act: Callable[[Field, int], Field]) -> Any:
            return scipy.sparse.linalg.LinearOperator((2 * count,) * 2, lambda v: act(spread(v), axis)[both])

        compliance, stiffness = map(operator, (self.displacement, self.stiffened))
        target = np.repeat(np.arange(2) == axis, count).astype(float)
        force, failed = scipy.sparse.linalg.cg(compliance, target, rtol=_SOLVED, atol=0, M=stiffness)
        if failed:
            raise ConvergenceError(f"tangential stiffness: not solved after {failed} iterations")
        return spread(force)

    def _modes(self, field: Field, *, odd: bool) -> Modes:
        """Fourier modes; of mirrored fields with one wave more, so that cosines and sines have the same."""
        if not self.lattice.reflecting:
            return self.lattice.forward(field)
        if odd:
            return np.pad(scipy.fft.dstn(field, norm="ortho"), (1, 0))
        return np.pad(scipy.fft.dctn(field, norm="ortho"), (0, 1))

    def _field(self, modes: Modes, *, odd: bool) -> Field:
        if not self.lattice.reflecting:
            return self.lattice.backward(modes)
        if odd:
            return np.asarray(scipy.fft.idstn(modes[1:, 1:], norm="ortho"))
        return np.asarray(scipy.fft.idctn(modes[:-1, :-1], norm="ortho"))


def compliances(contact: Contact, poisson: float) -> Field:
    """Displacements along y and x, a force along y and x: of the body, and of it less the mean surface.

    Shape ``(2, 2, 2)``; infinite without contact, 0 where all touches and the edges are not free.
    """
    known = _COMPLIANCES.setdefault(contact, {})
    if poisson not in known:
        known[poisson] = _compliances(contact, poisson)
    return known[poisson]


def _compliances(contact: Contact, poisson: float) -> Field:
    shear = Shear.of(contact, checks.number("poisson", poisson, above=-1, most=0.5))
    sites = contact.relative[2]
    if not contact.area or sites.all():
        return np.full((2, 2, 2), 0.0 if contact.area else math.inf)
    body = np.isfinite(contact.system().heights)
    forces = [shear.held(sites, axis) for axis in (0, 1)]
    moved = [shear.displacement(force, axis) for axis, force in enumerate(forces)]
    sums = np.array([force[:, sites].sum(axis=-1) for force in forces])
    surface = np.transpose([field[:, body].mean(axis=-1) for field in moved])
    # The error of this is that of the forces squared.
    stiffness = sums + sums.T - np.einsum("ijs,kjs->ik", *(np.array(f)[..., sites] for f in (forces, moved)))
    if shear.lattice.reflecting:
        stiffness, surface = stiffness * np.eye(2), surface * np.eye(2)
    whole = np.linalg.inv(stiffness)
    rough = whole - surface @ whole
    return np.stack([whole, (rough + rough.T) / 2])


def unit_vector(direction: Direction) -> tuple[float, float]:
    """Components along y and x; `InputError` unless it is ``"x"``, ``"y"`` or a number of degrees."""
    if isinstance(direction, str):
        return {"x": (0.0, 1.0), "y": (1.0, 0.0)}[checks.choice("direction", direction, ("x", "y"))]
    angle = math.radians(checks.number("direction", direction))
    return math.sin(angle), math.cos(angle)


def stiffness_along(compliance: Field, direction: Direction | None) -> float:
    """Force along a direction over the displacement along it; by default of their mean over directions."""
    if not np.isfinite(compliance).all():
        return 0.0
    vector = None if direction is None else np.array(unit_vector(direction))
    yields = float(np.trace(compliance) / 2 if vector is None else vector @ compliance @ vector)
    return 1 / yields if yields > 0 else math.inf


def principal(compliance: Field) -> tuple[float, float, float]:
    """The least and the largest stiffness, and the direction of the least, degrees from x towards y."""
    if not np.isfinite(compliance).all() or not compliance.any():
        return (*(stiffness_along(compliance, None),) * 2, math.nan)
    (stiff, soft), vectors = np.linalg.eigh(compliance)
    y, x = vectors[:, 1]
    return 1 / float(soft), 1 / float(stiff), math.degrees(math.atan2(y, x)) % 180
