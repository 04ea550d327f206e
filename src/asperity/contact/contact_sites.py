r"""A contact of few sites, solved for the forces there: a better guess for every other method.

With the compliance K = 1 / S the forces p on the contacts C, and a level where the load prescribes the sum of
p, make u = K (p + b) + level equal to the heights on C. Conjugate gradients on C find p. They act through K
only between sites of C, split into two parts (multilevel summation: R. D. Skeel, I. Tezcan, D. J. Hardy,
J. Comput. Chem. 23, 673 (2002), DOI 10.1002/jcc.10072). One is smooth, and goes through a lattice that is
coarser by four, by cubic B-splines. It is K itself beyond a distance, and below an even polynomial
that continues it. The rest is a sparse matrix of close sites. The preconditioner is S between close sites:
positive definite, as what S couples it couples negatively.

Contacts in tension are released on the way. Then u is evaluated everywhere, by one pair of transforms in
double precision. Sites that penetrate join the contacts, and the next round corrects the error on these.
Three to five rounds suffice at any load and size.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from asperity.contact.arrays import inner, inverse
from asperity.contact.problem import Guess, SpectralProblem
from asperity.lattice import Field, Lattice, Mask, Spectrum

Vector = NDArray[Any]
"""A number for each site, in single precision."""


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    most: float = 0.35
    """Crowding up to which contacts are few."""

    near: float = 16.0
    """Distance below which sites are close, and four times the spacing of the coarser lattice, sites."""

    ring: float = 0.7
    """Distance from which a polynomial follows the compliance, over that below which sites are close."""

    terms: int = 5
    """Number of terms of the polynomial."""

    sampled: int = 8
    """Width of the lattice whose modes stand for all, over the distance below which sites are close."""

    solved: float = 1e-3
    """How far conjugate gradients on the contacts reduce an error, in the norm of the preconditioner."""


TUNING = Tuning()


def solved_on_contacts(problem: SpectralProblem, guess: Guess, tolerance: float) -> tuple[Guess, int]:
    """Improve a guess by solving on its contacts, if they are few; return it and the rounds taken.

    Rounds end where the error of u on the contacts leaves a residual of ``tolerance``, or falls no more.
    """
    lattice, stiffness, heights = problem.lattice, problem.stiffness, problem.heights
    in_contact = np.array(guess.u <= heights if guess.in_contact is None else guess.in_contact)
    plain = lattice.dimension == 2 and not lattice.reflecting
    if not (plain and min(_reach(lattice)) > 0 and 0 < _crowding(in_contact, lattice) <= TUNING.most):
        return guess, 0
    stiffest, load, compliance = float(stiffness.max()), problem.load, inverse(stiffness)
    free = lattice.backward(compliance * problem.rhs) if problem.rhs.flat[1:].any() or load is None else 0.0
    kernel, close = _Kernel(lattice, stiffness, stiffest), None
    force, off, level = np.zeros(lattice.shape), heights - free, 0.0
    error, wrong, rounds = math.inf, lattice.sites, 0
    while True:
        if close is None or (in_contact & ~close.sites).any():
            close = _CloseSites(kernel, in_contact)
        released = close.balance(force, off, in_contact, load)
        contacts, total = np.count_nonzero(in_contact), float(force.sum())
        if not (contacts and math.isfinite(total)):
            return guess, rounds
        modes = lattice.forward(force)
        modes *= compliance
        u = lattice.backward(modes, overwrite=True)
        u += free
        off = heights - u
        errors = off[in_contact]
        if load is not None:
            level = float(errors.mean())
        penetrating = off > level
        penetrating &= ~in_contact
        error, before = float(np.abs(errors - level).max()), error
        wrong, wrong_before = released + int(np.count_nonzero(penetrating)), wrong
        rounds += 1
        accurate = error * stiffest <= tolerance * total / contacts
        if (wrong == 0 and accurate) or not (wrong < wrong_before or error < before / 2):
            return Guess(u + level, in_contact), rounds
        in_contact |= penetrating


def _crowding(in_contact: Mask, lattice: Lattice) -> float:
    """Pairs of contacts in the same cell, as wide as close sites are apart, over all: work and memory."""
    (y, x), (height, width) = np.nonzero(in_contact), _reach(lattice)
    counts = np.bincount(y // height * in_contact.shape[1] + x // width)
    return float(np.sum(counts.astype(float) ** 2)) / in_contact.size


class _Kernel:
    """The compliance in two parts, and the stiffness between close sites; in units of the stiffest."""

    def __init__(self, lattice: Lattice, stiffness: Spectrum, unit: float) -> None:
        self.lattice, self.unit, self.reach = lattice, unit, _reach(lattice)
        self.scale = np.array(lattice.spacing) / math.sqrt(lattice.cell)
        # Some of the modes of so smooth functions tell what they are like between close sites.
        strides = [_stride(n, reach) for n, reach in zip(lattice.shape, self.reach, strict=True)]
        sampled = stiffness[:: strides[0], :: strides[1]] / unit
        small = Lattice(tuple(n // stride for n, stride in zip(lattice.shape, strides, strict=True)))
        near = [np.arange(-reach, reach + 1) for reach in self.reach]
        kernel, self.stiffness = (
            small.backward(spectrum.astype(complex))[np.ix_(*near)]
            for spectrum in (inverse(sampled), sampled)
        )
        distance = np.hypot(*np.meshgrid(*map(np.multiply, near, self.scale), indexing="ij")) / TUNING.near
        ring = (distance > TUNING.ring) & (distance <= 1)
        powers = distance[..., np.newaxis] ** np.arange(0, 2 * TUNING.terms, 2)
        fitted = np.linalg.lstsq(powers[ring], kernel[ring], rcond=None)[0]
        self.short = np.where(distance <= 1, kernel - powers @ fitted, 0.0)
        self.coarse = Lattice(
            tuple(
                min(n, scipy.fft.next_fast_len(math.ceil(4 * n * length / TUNING.near), real=True))
                for n, length in zip(lattice.shape, self.scale, strict=True)
            )
        )
        long = lattice.long_waves(stiffness, self.coarse) / unit
        long = inverse(long) - self._long_waves(near)
        # A cubic B-spline has the modes sinc^4, and forces pass one to the lattice and one back.
        for angle in self.coarse.angles:
            long /= np.sinc(angle / (2 * np.pi)) ** 8
        self.long: Vector = (long * (self.coarse.sites / lattice.sites)).astype(np.float32)

    def _long_waves(self, near: list[NDArray[np.int_]]) -> Spectrum:
        """Those of the short part, axis by axis."""
        (n, m), (rows, columns) = self.lattice.shape, near
        lines = np.zeros((len(rows), m))
        lines[:, columns] = self.short
        modes = np.zeros((n, self.coarse.spectral_shape[1]), dtype=complex)
        modes[rows] = scipy.fft.rfft(lines)[:, : modes.shape[1]]
        return self.lattice.long_waves(scipy.fft.fft(modes, axis=0).real, self.coarse)


class _CloseSites:
    """Forces and displacements of some sites, by both parts of a kernel; in single precision."""

    def __init__(self, kernel: _Kernel, sites: Mask) -> None:
        self.kernel, self.sites = kernel, sites.copy()
        shape, self.places = kernel.lattice.shape, np.flatnonzero(sites)
        places = np.unravel_index(self.places, shape)
        tree = scipy.spatial.KDTree(
            np.transpose(places) * kernel.scale, boxsize=np.array(shape) * kernel.scale
        )
        pairs = tree.query_pairs(TUNING.near, output_type="ndarray")
        first, second = pairs.T.astype(np.int32)
        apart = [
            (x[first] - x[second] + reach) % n
            for x, reach, n in zip(np.asarray(places, dtype=np.int32), kernel.reach, shape, strict=True)
        ]
        offset = apart[0] * (2 * kernel.reach[1] + 1) + apart[1]
        count = len(self.places)
        order = scipy.sparse.csr_array((offset, (first, second)), shape=(count, count))
        self.short, self.stiffness = (
            _symmetric(order, window.astype(np.float32)) for window in (kernel.short, kernel.stiffness)
        )
        weights, cells = [], []
        for x, n, m in zip(places, shape, kernel.coarse.shape, strict=True):
            cell, part = np.divmod(x * (m / n), 1.0)
            weights.append(_cubic(part))
            cells.append((cell[:, np.newaxis].astype(np.int32) + np.arange(-1, 3)) % m)
        spread = weights[0][:, :, np.newaxis] * weights[1][:, np.newaxis, :]
        into = cells[0][:, :, np.newaxis] * kernel.coarse.shape[1] + cells[1][:, np.newaxis, :]
        table = spread.ravel().astype(np.float32), into.ravel(), np.arange(0, 16 * count + 1, 16)
        self.gather = scipy.sparse.csr_array(table, shape=(count, kernel.coarse.sites))
        self.spread = self.gather.T

    def displacement(self, force: Vector) -> Vector:
        """Of forces."""
        grid: Vector = (self.spread @ force).reshape(self.kernel.coarse.shape)
        smooth = self.kernel.coarse.apply(self.kernel.long, grid).ravel()
        displacement: Vector = self.gather @ smooth + self.short(force)
        return displacement

    def balance(self, force: Field, target: Field, in_contact: Mask, load: float | None) -> int:
        """Change forces so that contacts move by a target, up to a level; release those in tension.

        Writes into the forces and the contacts, and returns how many were released.
        """
        forces, contacts = force.reshape(-1), in_contact.reshape(-1)
        old, off, active = forces[self.places], target.reshape(-1)[self.places], contacts[self.places]
        wanted = off - (off[active].mean() if load is not None else 0.0)
        scale = float(np.abs(wanted[active]).max()) or 1.0
        unit = scale * self.kernel.unit
        right = (wanted / scale).astype(np.float32)
        change = np.where(active, 0.0, -old / unit).astype(np.float32)
        before = np.count_nonzero(active)
        missing = None if load is None else (load - float(old.sum())) / unit
        while True:
            self._solve(change, right, active, missing)
            new = old + unit * change.astype(float)
            tension = active & (new < 0)
            if not tension.any():
                break
            change[tension] = -old[tension] / unit
            active &= ~tension
        new[~active] = 0.0
        forces[self.places], contacts[self.places] = new, active
        return int(before - np.count_nonzero(active))

    def _solve(self, change: Vector, right: Vector, active: Mask, total: float | None) -> None:
        """Conjugate gradients, in place; where a ``total`` is given, up to a constant displacement."""
        on = active.astype(np.float32)
        even, weight = np.zeros_like(on), 1.0
        if total is not None:
            even = on * self.stiffness(on)
            weight = inner(on, even, np) or 1.0  # 0 where all sites touch and nothing but neighbors resists
            change += np.float32((total - float(change.sum(dtype=float))) / weight) * even
        residual = on * (right - self.displacement(change))
        direction, slope, goal = None, 1.0, 0.0
        for _ in range(len(change)):
            estimate = on * self.stiffness(residual)
            if total is not None:
                shift = np.float32(inner(on, estimate, np) / weight)
                residual -= shift * on
                estimate -= shift * even
            previous, slope = slope, inner(residual, estimate, np)
            goal = goal or slope * TUNING.solved**2  # slopes are squares of the error in that norm
            if not slope > goal:
                return
            direction = estimate if direction is None else estimate + np.float32(slope / previous) * direction
            response = on * self.displacement(direction)
            curvature = inner(direction, response, np)
            if not curvature > 0:
                return
            length = np.float32(slope / curvature)
            change += length * direction
            residual -= length * response


def _symmetric(pairs: Any, window: NDArray[np.float32]) -> Any:
    """The symmetric matrix that has the values of a window between pairs of sites, each named once."""
    values = window.ravel()[pairs.data]
    upper = scipy.sparse.csr_array((values, pairs.indices, pairs.indptr), shape=pairs.shape)
    diagonal = window[tuple(n // 2 for n in window.shape)]
    lower = upper.T
    return lambda x: upper @ x + lower @ x + diagonal * x


def _cubic(part: Field) -> Field:
    """Values of the cubic B-splines around a place between two sites."""
    rest = 1 - part
    inside = [(4 - 6 * x**2 + 3 * x**3) / 6 for x in (part, rest)]
    return np.stack([rest**3 / 6, *inside, part**3 / 6], axis=-1)


def _reach(lattice: Lattice) -> list[int]:
    """Sites along each axis that may be close; 0 where that is all around the lattice."""
    reach = [math.ceil(TUNING.near * math.sqrt(lattice.cell) / length) for length in lattice.spacing]
    return [r if 2 * r < n else 0 for r, n in zip(reach, lattice.shape, strict=True)]


def _stride(count: int, reach: int) -> int:
    """The largest divisor of a length that leaves some times as much as close sites may be apart."""
    least = TUNING.sampled * reach
    return max((d for d in range(1, count + 1) if count % d == 0 and count >= least * d), default=1)
