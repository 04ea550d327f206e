r"""The linear problem on one set of contacts: displace the free sites until no force is left on them.

Conjugate gradients on the free sites, with the preconditioner M = M_0 of nested levels,

    M_k = W_k [ 1 / (S + s_k) - 1 / (S + s_(k-1)) + R M_(k+1) R^T ] W_k,      1 / (S + s_(-1)) = 0.

W_0 is 0 at contacts, and 1 / (1 + 0.05 n) at free sites with n neighbors in contact. Far from contacts the
surface yields like 1 / (S + sigma), with sigma from `asperity.contact.pinning`; among them it is pinned more
strongly, and yields over shorter distances. So long waves are split off onto lattices that are coarser by
four and by four again (R, which keeps the long modes), and weighted there by
W_k = 1 / (1 + c_k rho) with rho the density of contacts around a site, c = 8, 4, 2 and so on. What yields
on one lattice is weighted on all finer ones too: so long waves do not move the sites beside a small contact
that stands alone. s_k falls with k, from the stiffness of the shortest wave that level k + 1 holds down to
sigma, so that each difference and with them M is positive. A level whose waves are all softer than sigma is
left out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from asperity.contact.arrays import inner, largest
from asperity.contact.pinning import effective_pinning
from asperity.lattice import Edges, Field, Lattice, Mask, Spectrum


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    shore: float = 0.05
    """How fast the weight W_0 of a free site falls with the number of its neighbors in contact."""

    pinning: float = 0.4
    """Factor on the mean pinning sigma; near contacts the weights add to it."""

    least: float = 0.01
    """Least part of the neighbors of contacts that counts as free."""

    coarser: int = 4
    """Ratio of the lengths of successive lattices."""

    crowding: float = 8.0
    """How fast the weight W_1 falls with the density rho of contacts; half as fast on each further level."""

    density_width: float = 0.6
    """Width over which contacts make a density (standard deviation), in sites of the coarse lattice."""

    usual_rate: float = 0.3
    """What an iteration is expected to leave of an error."""


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


@dataclass(frozen=True, eq=False)
class _Waves:
    """How the waves of one lattice yield, the long ones by a further level."""

    lattice: Lattice
    weight: Field
    compliance: Spectrum
    longer: _Waves | None

    def respond(self, force: Field) -> Field:
        """Displacement by a force, which this overwrites."""
        force *= self.weight
        modes = self.lattice.forward(force)
        if self.longer is None:
            modes *= self.compliance
        else:
            coarse = self.longer.lattice
            long = coarse.backward(self.lattice.long_waves(modes, coarse), overwrite=True)
            modes *= self.compliance
            self.lattice.add_long_waves(modes, coarse.forward(self.longer.respond(long)), coarse)
        displacement = self.lattice.backward(modes, overwrite=True)
        displacement *= self.weight
        return displacement


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
        mask = self.free / (1.0 + TUNING.shore * neighbors)

        pinning = TUNING.pinning * _pinning(lattice, spectrum, contacts, neighbors, xp)
        longest = Lattice((2,) * lattice.dimension)
        lattices, cuts = [lattice], [math.inf]
        for coarse in _coarse_lattices(lattice.shape, lattice.edges):
            cut = _stiffness_of_waves(spectrum, coarse) - _stiffness_of_waves(spectrum, longest)
            if cut > pinning:
                lattices.append(coarse)
                cuts.append(min(cut, cuts[-1]))
        cuts = [cut / unit for cut in (*cuts, pinning)]
        weights = [mask, *_weights(in_contact, lattices[1:], stiffness.dtype, xp)]
        waves: _Waves | None = None
        for level in range(len(lattices) - 1, -1, -1):
            own = lattices[level]
            long = lattice.long_waves(stiffness, own) if level > 0 else stiffness
            compliance = 1.0 / (long + cuts[level + 1])
            if level > 0:
                compliance -= 1.0 / (long + cuts[level])
            waves = _Waves(own, weights[level], compliance, waves)
        assert waves is not None
        self.waves = waves

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
            estimate = self.waves.respond(defect)
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
            if not (slope > 0 and curvature > 0):
                break
            length = slope / curvature
            part = direction * length
            total += part
            if allowed_error > 0:
                square = max(square, inner(part, part, xp))
            change *= length
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
def _coarse_lattices(shape: tuple[int, ...], edges: Edges) -> list[Lattice]:
    """Lattices coarser by four and four again, of three sites along an axis at least."""
    lattices = []
    while min(shape) // TUNING.coarser > 2:
        shape = tuple(_odd_length(n // TUNING.coarser) for n in shape)
        lattices.append(Lattice(shape, edges=edges))
    return lattices


def _odd_length(most: int) -> int:
    """The largest length up to ``most`` that is quick to transform and odd: no mode has an unclear sign."""
    length = most - (most + 1) % 2
    while True:
        rest = length
        for factor in (3, 5, 7, 11):
            while rest % factor == 0:
                rest //= factor
        if rest == 1:
            return length
        length -= 2


def _stiffness_of_waves(spectrum: Spectrum, coarse: Lattice) -> float:
    """Mean stiffness of waves along the axes, the shortest that a coarse lattice holds."""
    last = [count - 1 if coarse.reflecting else count // 2 for count in coarse.shape]
    return float(np.mean([spectrum[tuple(index)] for index in np.diag(last)]))


@lru_cache(maxsize=8)
def _smoothing(coarse: Lattice) -> Spectrum:
    """What is left of a density, by modes, over the width in which contacts make one."""
    # The mean over a cell has a variance of 1/12.
    exponent = sum(q**2 for q in coarse.angles) * ((TUNING.density_width**2 - 1 / 12) / 2)
    return np.asarray(np.exp(-exponent))


def _weights(in_contact: Mask, lattices: Sequence[Lattice], dtype: Any, xp: Any) -> list[Field]:
    """How far forces move the waves of each coarse lattice: 1 off contact, less where contacts crowd."""
    sums = _added_up(xp.astype(in_contact, xp.int32), xp)  # whole numbers add up several times faster
    densities = (_density(sums, coarse, dtype, xp) for coarse in lattices)
    return [1.0 / (1.0 + TUNING.crowding / 2**level * density) for level, density in enumerate(densities)]


def _added_up(cells: Any, xp: Any) -> Any:
    """Sums of all cells before each along the last axis; the last one is that of all."""
    return xp.cumulative_sum(cells, axis=-1, dtype=cells.dtype, include_initial=True)


def _density(sums: Any, coarse: Lattice, dtype: Any, xp: Any) -> Field:
    """Density of contacts on a coarse lattice: their mean in each of its cells, smoothed; from 0 to 1.

    ``sums`` are the contacts added up along the last axis.
    """
    for axis in reversed(range(coarse.dimension)):
        count, length = coarse.shape[axis], sums.shape[-1] - 1
        # A cell ends midway between two coarse sites. The last one ends at the edge; on a periodic lattice
        # before it, and what lies behind belongs to the first.
        middle = 0.0 if coarse.reflecting else (1 - length / count) / 2
        ends = np.arange(1, count + 1) * (length / count) + middle
        below = np.minimum(ends.astype(int), length - 1)
        whole, more = (xp.astype(xp.take(sums, xp.asarray(below + n), axis=-1), dtype) for n in (0, 1))
        whole += (more - whole) * xp.asarray(ends - below, dtype=dtype)
        total = xp.astype(sums[..., -1:], dtype)
        cells = xp.diff(xp.concat([whole[..., -1:] - total, whole], axis=-1), axis=-1) * (count / length)
        cells = xp.moveaxis(cells, -1, axis)
        if axis > 0:
            sums = _added_up(xp.moveaxis(cells, axis - 1, -1), xp)
    smoothed = coarse.apply(xp.asarray(_smoothing(coarse), dtype=dtype), cells)
    density: Field = xp.clip(smoothed, 0.0, 1.0)
    return density
