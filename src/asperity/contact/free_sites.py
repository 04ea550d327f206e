r"""The linear problem on one set of contacts: displace the free sites until no force remains on them.

Conjugate gradients on the free sites, with the preconditioner M of two levels,

    M = W_0 [ 1 / (S + s) + R W_1 [ 1 / (S + sigma) - 1 / (S + s) ] W_1 R^T ] W_0.

W_0 is 0 at contacts, and 1 / (1 + 0.05 n) at free sites with n neighbors in contact. Far from contacts the
surface yields like 1 / (S + sigma), with sigma from `asperity.contact.pinning`; among them it is pinned more
strongly, and yields over shorter distances. So long waves are taken to a lattice that is coarser by five (R
keeps the long modes), and weighted there by W_1 = 1 / (1 + 12 rho), with rho the density of contacts around a
site. W_0 weights them too: long waves do not move the sites beside a small contact that stands alone. s is
the stiffness of the shortest waves of the coarse lattice, but at least sigma.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import scipy

from asperity.contact.arrays import inner, largest
from asperity.contact.pinning import effective_pinning
from asperity.lattice import Field, Lattice, Mask, Spectrum


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    shore: float = 0.05
    """Decrease of the weight W_0 of a free site with the number of its neighbors in contact."""

    pinning: float = 0.4
    """Factor on the mean pinning sigma; near contacts the weights add to it."""

    least: float = 0.01
    """Least part of the neighbors of contacts that counts as free."""

    coarser: int = 5
    """Ratio of the lengths of both lattices."""

    crowding: float = 12.0
    """Decrease of the weight W_1 with the density rho of contacts."""

    density_width: float = 0.8
    """Standard deviation over which contacts make a density, in sites of the coarse lattice."""

    usual_rate: float = 0.3
    """Expected ratio of an error after an iteration to that before."""


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Correction:
    """A displacement of the free sites and the forces that it should leave.

    ``worst`` is the largest of those off contact, ``imbalance`` the magnitude of their sum; ``left_over``
    estimates how far the displacement is still off, rms over the sites.
    """

    displacement: Field
    force: Field
    worst: float
    imbalance: float
    iterations: int
    left_over: float = math.inf


class FreeSites:
    """The free sites of one set of contacts, at least one of these, and the preconditioner there.

    ``spectrum`` is S, numpy's; ``stiffness`` is S in a ``unit`` that keeps single precision in range, such as
    its largest, of the array library and in the precision in which to compute.
    """

    def __init__(
        self,
        lattice: Lattice,
        spectrum: Spectrum,
        unit: float,
        stiffness: Spectrum,
        in_contact: Mask,
        xp: Any,
    ) -> None:
        self.lattice, self.stiffness, self.unit = lattice, stiffness, unit
        self.in_contact, self.xp = in_contact, xp
        contacts = xp.astype(in_contact, stiffness.dtype)
        neighbors = xp.zeros_like(contacts)
        for axis in range(lattice.dimension):
            neighbors += xp.roll(contacts, 1, axis=axis)
            neighbors += xp.roll(contacts, -1, axis=axis)
        self.free = 1.0 - contacts
        self.weight = self.free / (1.0 + TUNING.shore * neighbors)

        pinning = TUNING.pinning * _pinning(lattice, spectrum, contacts, neighbors, xp)
        # Without the coarse lattice there are half as many iterations again, or more.
        self.coarse = coarse = _coarser(lattice)
        cut = _stiffness_of_waves(spectrum, coarse) - _stiffness_of_waves(spectrum, _coarsest(lattice))
        cut = max(cut, pinning)
        self.compliance = 1.0 / (stiffness + cut / unit)
        long = lattice.long_waves(stiffness, coarse)
        self.long_compliance = 1.0 / (long + pinning / unit) - 1.0 / (long + cut / unit)
        smoothing = xp.asarray(_smoothing(coarse), dtype=stiffness.dtype)
        modes = lattice.long_waves(lattice.forward(contacts), coarse) * smoothing
        density = xp.clip(coarse.backward(modes) * (coarse.sites / lattice.sites), 0.0, 1.0)
        self.long_weight = 1.0 / (1.0 + TUNING.crowding * density)

    def respond(self, force: Field) -> Field:
        """Displacement M f by a force f, which this overwrites."""
        force *= self.weight
        lattice, coarse = self.lattice, self.coarse
        modes = lattice.forward(force)
        long = coarse.backward(lattice.long_waves(modes, coarse), overwrite=True)
        long = coarse.apply(self.long_compliance, long * self.long_weight) * self.long_weight
        modes *= self.compliance
        lattice.add_long_waves(modes, coarse.forward(long), coarse)
        displacement = lattice.backward(modes, overwrite=True)
        displacement *= self.weight
        return displacement

    def correct(
        self, force: Field, worst: float, goal: float, most: int, allowed: tuple[float, float]
    ) -> Correction:
        """Displace the free sites until no force on them exceeds ``goal`` times the ``worst`` there.

        Or until ``allowed`` are the error, rms over the sites, and the sum of the forces off contact.
        """
        allowed_error, allowed_imbalance = allowed
        xp, lattice = self.xp, self.lattice
        residual = xp.astype(force * (-1.0 / worst), self.stiffness.dtype)
        residual *= self.free
        defect = xp.asarray(residual, copy=True)
        total = xp.zeros_like(residual)
        direction, slope, iterations = None, 1.0, 0
        unit, left_over = worst / self.unit, math.inf
        while iterations < most:
            estimate = self.respond(defect)
            previous, slope = slope, inner(residual, estimate, xp)
            square = inner(estimate, estimate, xp) if allowed_error > 0 else 0.0
            if direction is None:
                direction = estimate
            else:
                direction *= slope / previous
                direction += estimate
            del estimate
            change = lattice.apply(self.stiffness, direction)
            curvature = inner(direction, change, xp)
            if not (slope > 0 and curvature > 0):  # rounding is all that is left
                break
            length = slope / curvature
            part = direction * length
            total += part
            if allowed_error > 0:
                square = max(square, inner(part, part, xp))
            change *= length
            # The residual in contact is kept, too: it predicts the change of the forces there.
            residual -= change
            del part, change  # memory for the transforms
            defect[...] = residual
            defect *= self.free
            iterations += 1
            if allowed_error > 0:
                left_over = unit * TUNING.usual_rate * math.sqrt(square / lattice.sites)
                if left_over <= allowed_error and allowed_imbalance < math.inf:
                    share = worst * abs(float(xp.sum(defect, dtype=xp.float64))) / allowed_imbalance
                    left_over = max(left_over, allowed_error * share)
            if left_over <= allowed_error or largest(defect, xp) <= goal:
                break
        del direction, defect
        return self._correction(force, worst, total, residual, iterations, left_over)

    def _correction(
        self, force: Field, scale: float, total: Field, residual: Field, iterations: int, left_over: float
    ) -> Correction:
        """The outcome, in units of force; off contact the residual is the force, in contact its change."""
        xp = self.xp
        predicted = xp.astype(residual, force.dtype)
        predicted *= -scale
        predicted += xp.where(self.in_contact, force, xp.asarray(0.0))
        residual *= self.free
        displacement = xp.astype(total, force.dtype)
        displacement *= scale / self.unit
        return Correction(
            displacement=displacement,
            force=predicted,
            worst=scale * largest(residual, xp),
            imbalance=scale * abs(float(xp.sum(residual, dtype=xp.float64))),
            iterations=iterations,
            left_over=left_over,
        )


def _pinning(lattice: Lattice, spectrum: Spectrum, contacts: Field, neighbors: Field, xp: Any) -> float:
    """Pinning by contacts as they lie: those beside each other pin less than those that stand alone."""
    count = float(xp.sum(contacts, dtype=xp.float64))
    fraction = max(count, 2.0) / lattice.sites  # one contact pins the mean of the surface and nothing else
    together = inner(contacts, neighbors, xp) / (2 * lattice.dimension * count)
    # 1 if they lie at random
    single = min(1.0, max(1 - together, TUNING.least) / max(1 - fraction, TUNING.least))
    return single * effective_pinning(lattice, spectrum, fraction)


@lru_cache(maxsize=8)
def _coarser(lattice: Lattice) -> Lattice:
    """A coarser lattice whose lengths are quick to transform and odd: no mode has an unclear sign."""
    lengths = (range((max(n // TUNING.coarser, 1) - 1) // 2 * 2 + 1, 0, -2) for n in lattice.shape)
    fast = (next(n for n in odd if scipy.fft.next_fast_len(n) == n) for odd in lengths)
    return Lattice(tuple(fast), edges=lattice.edges)


@lru_cache(maxsize=8)
def _coarsest(lattice: Lattice) -> Lattice:
    """The lattice of the longest waves."""
    return Lattice(tuple(min(n, 2) for n in lattice.shape))


def _stiffness_of_waves(spectrum: Spectrum, coarse: Lattice) -> float:
    """Mean stiffness of waves along the axes, the shortest that a coarse lattice holds."""
    last = [count - 1 if coarse.reflecting else count // 2 for count in coarse.shape]
    return float(np.mean([spectrum[tuple(index)] for index in np.diag(last)]))


@lru_cache(maxsize=8)
def _smoothing(coarse: Lattice) -> Spectrum:
    """Factors of the modes of a density that is smoothed over a width."""
    return np.asarray(np.exp(-sum(q**2 for q in coarse.angles) * (TUNING.density_width**2 / 2)))
