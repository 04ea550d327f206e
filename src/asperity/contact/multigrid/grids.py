"""The coarse grids: every other site along each axis, of any length, down to a few sites solved directly."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from itertools import pairwise

import numpy as np

from asperity.contact.multigrid import operations
from asperity.contact.multigrid.loops import CoarseOne, CoarseTwo, Fields, Pair, Single, Sites
from asperity.contact.multigrid.pins import compliance, softening
from asperity.contact.pinning import coherent_potential
from asperity.lattice import Field
from asperity.solids import Springs


@dataclass(frozen=True)
class Tuning:
    """Numbers that decide how well coarse grids correct."""

    coarsest: int = 16
    """Most sites of a grid that is solved directly."""
    hard: float = 1e3
    """Stiffness of a pin among others as stiff, over that of a site."""


TUNING = Tuning()

_ROUNDING = 16 * float(np.finfo(np.float32).eps)


@dataclass(frozen=True, eq=False)
class Axis:
    """One axis of a grid: couplings between a site and the next (inverse distances), and cell sizes.

    Where the edges are mirrors, the last coupling is 0.
    """

    coupling: Field
    size: Field
    mirrored: bool = False

    @staticmethod
    @lru_cache
    def fine(n: int, *, mirrored: bool = False) -> Axis:
        """Sites one apart."""
        coupling = np.ones(n) if n > 1 else np.zeros(1)
        coupling[-1] *= not mirrored
        return Axis(coupling, np.ones(n), mirrored)

    @cached_property
    def coarser(self) -> Axis:
        """Every other site; where n is odd, the last and the first are one old distance apart."""
        n = self.size.size
        if n == 1:
            return self
        distance = np.divide(1.0, self.coupling, out=np.full(n, np.inf), where=self.coupling > 0)
        apart = distance[::2].copy()
        apart[: n // 2] += distance[1::2]
        size, half = self.size[::2].copy(), self.size[1::2] / 2
        size[: half.size] += half
        if n % 2:
            size[1:] += half
        else:  # the last site lies between two coarse ones, or between one and its image
            size += np.roll(half, 1)
            if self.mirrored:
                size[0] -= half[-1]
                size[-1] += half[-1]
        return Axis(1.0 / apart if apart.size > 1 else np.zeros(1), size, self.mirrored)

    @property
    def laplacian(self) -> Field:
        """Minus the Laplacian as a matrix."""
        change = np.eye(self.size.size) - np.roll(np.eye(self.size.size), 1, axis=1)
        return np.asarray(change.T @ (self.coupling[:, np.newaxis] * change))


def empty(sites: Sites) -> Single:
    """A field of zeros, in memory that nothing has touched yet."""
    row = operations.packed(np.zeros((1, sites.columns)))
    return np.zeros((sites.rows, *row.shape[1:]), row.dtype)


def together(fields: Iterable[Single]) -> Fields:
    """One field, or a pair of them."""
    grids = tuple(fields)
    return Pair(*grids) if len(grids) == 2 else grids


class Grid:
    """One coarse grid and the work arrays on it."""

    def __init__(self, y: Axis, x: Axis, finer: Sites, fields: int) -> None:
        self.axes, self.finer = (y, x), finer
        self.sites = sites = Sites(y.size.size, x.size.size, y.mirrored)
        gx, mx = (operations.packed(row[np.newaxis])[0] for row in (x.coupling, x.size))
        gy, my = y.coupling.astype(np.float32), y.size.astype(np.float32)
        self.pins = empty(sites)
        self.mesh = (self.pins, gx, gy, mx, my, sites)
        """Pins, couplings and cell sizes, as the equations take them."""
        self.correction, self.source = (together(empty(sites) for _ in range(fields)) for _ in "eb")
        self.joined = together(np.zeros(sites[:2], np.float32) for _ in range(fields))
        """The corrections, for the next finer grid."""

    @cached_property
    def sharing(self) -> Single:
        """What the sites of the next finer grid add up to here if each counts 1; inf where no site is."""
        sums = empty(self.sites)
        operations.restrict(operations.packed(np.ones(self.finer[:2])), self.finer, sums)
        return np.where(sums > 0, sums, np.float32(np.inf))  # a division leaves 0 beside the sites

    @cached_property
    def areas(self) -> Field:
        """Sizes of the cells."""
        y, x = self.axes
        return np.outer(y.size, x.size)

    def in_order(self, field: Single) -> Field:
        """A field as a vector; for the coarsest grid."""
        return operations.unpacked(field, self.sites).ravel()

    def hand_over(self, corrections: Field) -> None:
        """Set the corrections, one after the other in a vector; for the coarsest grid."""
        for joined, values in zip(self.joined, corrections.reshape(-1, *self.sites[:2]), strict=True):
            joined[...] = values

    @cached_property
    def laplacian(self) -> Field:
        """Minus the Laplacian as a matrix; for the coarsest grid."""
        y, x = self.axes
        return np.asarray(np.kron(y.laplacian, np.diag(x.size)) + np.kron(np.diag(y.size), x.laplacian))


class Hierarchy:
    """The grids above a lattice, from the first coarse one to the coarsest."""

    def __init__(self, sites: Sites, fields: int) -> None:
        self.sites = sites
        y, x = (Axis.fine(n, mirrored=sites.mirrored) for n in sites[:2])
        self.grids: list[Grid] = []
        finer = sites
        while not self.grids or math.prod(finer[:2]) > TUNING.coarsest:
            y, x = y.coarser, x.coarser
            self.grids.append(Grid(y, x, finer, fields))
            finer = self.grids[-1].sites

    @cached_property
    def cells(self) -> list[Single]:
        """Sizes of the cells of the lattice and of all grids but the coarsest."""
        areas = [np.ones(self.sites[:2]), *(grid.areas for grid in self.grids[:-1])]
        return [operations.packed(cells) for cells in areas]

    def set_pins(self, e: Single, bound: Single, fraction: float, springs: Springs) -> None:
        """Set pins on all coarse grids; ``fraction`` is that of the sites in contact; k0 = 1.

        A pin among others as stiff does not soften: where all sites that share a coarse one are held, so is
        that.
        """
        if fraction == 0:
            for grid in self.grids:
                grid.pins.fill(0.0)
            return
        sigma = coherent_potential(partial(compliance, springs, 0), fraction, 1.0)
        first, strength = self.grids[0], 1.0 / softening(springs, 0, sigma)
        operations.restrict((e <= bound).astype(np.float32), self.sites, first.pins)
        first.pins *= np.float32(strength)
        # A held site adds ``held`` to the pin on the next coarser grid, and no site adds more.
        held, hard, crowds = strength, TUNING.hard * (4.0 + springs.k1), True
        for level, (fine, coarse) in enumerate(pairwise(self.grids), start=1):
            if crowds:
                full = fine.pins >= np.float32(held * (1.0 - _ROUNDING)) * fine.sharing  # but for rounding
                crowds = bool(full.any())
                fine.pins[full] = np.float32(hard)
            mean = sigma * 4.0**level
            softer = softening(springs, level, mean)
            operations.restrict(fine.pins, fine.sites, coarse.pins, softer, mean)
            held, hard = hard / (1.0 + softer * max(hard - mean, 0.0)), 4.0 * hard

    def coarser_lags(self, lag: Single, spread: float) -> list[Single]:
        """A lag by site, on the coarse grids: its mean over a cell, weighted by how far its sites respond.

        A site that differs from its neighbors relaxes as w = 1 / (lag + 4 spread / mass). The mean weighted
        by w is harmonic where spread is small, arithmetic where it is large.
        """
        lags, sites = [lag], self.sites
        for grid, cells in zip(self.grids, self.cells, strict=True):
            beside = 4.0 * spread * math.prod(sites[:2]) / math.prod(self.sites[:2])
            weights = cells / (lags[-1] + np.float32(beside))
            weight, out = (empty(grid.sites) for _ in range(2))
            operations.restrict(weights, sites, weight)
            operations.restrict(weights * lags[-1], sites, out)
            lags.append(np.divide(out, weight, out=out, where=weight > 0))
            sites = grid.sites
        return lags[1:]


class Corrections(Hierarchy, ABC):
    """Corrections of fields on a lattice, and how the grids above it improve them; in units in which k0 = 1.

    ``bound`` is the least correction of the first field that does not penetrate, ``source`` the right-hand
    side. ``proposed`` are the last corrections of the coarse grids, on the first of them. A shift of the last
    equation goes with them, minus ``coupling`` times their sum. Pins are set anew where more than a part
    ``moved`` of the contacts opens or closes.
    """

    springs: Springs
    coupling = moved = 0.0

    def __init__(self, sites: Sites, fields: int) -> None:
        super().__init__(sites, fields)
        self.size, self.count = sites.rows * sites.columns, fields
        self.bound, self.proposed = empty(sites), self.grids[0].joined
        self.correction, self.source = self.fields(), self.fields()
        self.forget()

    def fields(self) -> Fields:
        """Fields of zeros."""
        return together(empty(self.sites) for _ in range(self.count))

    def clear(self) -> None:
        """Set the corrections to 0."""
        for field in self.correction:
            field.fill(0.0)

    def forget(self) -> None:
        """Forget pins, as the springs have changed."""
        self.pinned, self.factorized = math.nan, False

    @abstractmethod
    def equations(self, level: int) -> CoarseOne | CoarseTwo:
        """The equations on a coarse grid."""

    @abstractmethod
    def inverse_on(self, grid: Grid) -> Field:
        """Corrections and shift on the coarsest grid by the sources and by what the last sum is missing."""

    def improve_on_grids(self, contacts: float, missing: float = 0.0) -> float:
        """Find corrections for the sources on the first coarse grid; the shift that goes with them."""
        if not abs(contacts - self.pinned) <= self.moved * self.pinned:
            self.set_pins(self.correction[0], self.bound, contacts / self.size, self.springs)
            self.pinned, self.factorized = contacts, False
        if not self.factorized:
            self.coarsest, self.factorized = self.inverse_on(self.grids[-1]), True
        return self.cycle_from(0, missing)

    def cycle_from(self, level: int, missing: float) -> float:
        """One V-cycle from a grid up; the shift that goes with its correction."""
        grid = self.grids[level]
        if grid is self.grids[-1]:
            correction = self.coarsest @ np.concatenate([*map(grid.in_order, grid.source), [missing]])
            grid.hand_over(correction[:-1])
            return float(correction[-1])
        coarser, equations = self.grids[level + 1], self.equations(level)
        total = operations.descend(equations, coarser.source)
        shift = self.cycle_from(level + 1, missing - total) - self.coupling * total
        total = operations.ascend(equations, coarser.joined, shift, grid.joined)
        return -self.coupling * total if self.coupling else shift
