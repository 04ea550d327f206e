"""The coarse grids: every other site along each axis, of any length, down to a few sites solved directly."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from asperity.contact.multigrid.loops import CoarseOne, CoarseTwo, Pair, Single, Sites
from asperity.contact.multigrid.pins import Response
from asperity.contact.multigrid.processor import Processor
from asperity.lattice import Field

_COARSEST = 16
"""Most sites of the grid on which the problem is solved directly."""

_HARD = 1e3
"""Stiffness of a pin that does not give, in units of k0 (4 + bed)."""

_ALL = 1.0 - 1e-4
"""Part of the largest sum from which all sites that share a coarse site are pinned so."""


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


class Grid:
    """One coarse grid and the work arrays on it."""

    def __init__(self, y: Axis, x: Axis, finer: Sites, fields: int, backend: Processor) -> None:
        self.backend, self.axes, self.finer = backend, (y, x), finer
        self.sites = sites = Sites(y.size.size, x.size.size, y.mirrored)
        gx = backend.along_rows(x.coupling, images=True)
        mx = backend.along_rows(x.size, images=False)
        gy, my = y.coupling.astype(np.float32), y.size.astype(np.float32)
        self.pins = backend.zeros(sites)
        self.mesh = (self.pins, gx, gy, mx, my, sites)
        """Pins, couplings and cell sizes, as the equations take them."""
        self.correction, self.source = ([backend.zeros(sites) for _ in range(fields)] for _ in range(2))
        self.joined = [backend.joined(sites) for _ in range(fields)]
        """The corrections, for the next finer grid."""

    def one(self, bed: float) -> CoarseOne:
        """The equation of one field."""
        (e,), (b,) = self.correction, self.source
        return CoarseOne(e, b, np.float32(bed), *self.mesh)

    def two(self, bed: float, spread: float, lag: NDArray[np.float32] | np.float32) -> CoarseTwo:
        """The equations of two fields."""
        (e, f), (b, c) = self.correction, self.source
        return CoarseTwo(e, f, b, c, np.float32(bed), np.float32(spread), lag, *self.mesh)

    @cached_property
    def sharing(self) -> Single:
        """What the sites of the next finer grid add up to here if each counts 1; inf where no site is."""
        sums = self.backend.zeros(self.sites)
        self.backend.coarser_pins(self.backend.packed(np.ones(self.finer[:2])), self.finer, 0.0, 0.0, sums)
        return np.where(sums > 0, sums, np.float32(np.inf))

    @cached_property
    def areas(self) -> Field:
        """Sizes of the cells."""
        y, x = self.axes
        return np.outer(y.size, x.size)

    def in_order(self, field: Single) -> Field:
        """A field as a vector; for the coarsest grid."""
        return self.backend.unpacked(field, self.sites).ravel()

    def hand_over(self, found: Field) -> None:
        """Set the corrections, one after the other in a vector; for the coarsest grid."""
        for joined, values in zip(self.joined, found.reshape(-1, *self.sites[:2]), strict=True):
            joined[...] = values

    @cached_property
    def laplacian(self) -> Field:
        """Minus the Laplacian as a matrix; for the coarsest grid."""
        ny, nx, _ = self.sites
        y, x = self.axes
        matrix = np.zeros((ny * nx, ny * nx))
        for i in range(ny):
            for j in range(nx):
                here = i * nx + j
                for there, coupling in (
                    ((i + 1) % ny * nx + j, y.coupling[i] * x.size[j]),
                    (i * nx + (j + 1) % nx, x.coupling[j] * y.size[i]),
                ):
                    matrix[here, here] += coupling
                    matrix[there, there] += coupling
                    matrix[here, there] -= coupling
                    matrix[there, here] -= coupling
        return matrix


class Hierarchy:
    """The grids above a lattice, from the first coarse one to the coarsest."""

    def __init__(self, sites: Sites, fields: int, backend: Processor) -> None:
        self.sites, self.backend = sites, backend
        y, x = (Axis.fine(n, mirrored=sites.mirrored) for n in sites[:2])
        self.grids: list[Grid] = []
        finer = sites
        while not self.grids or math.prod(finer[:2]) > _COARSEST:
            y, x = y.coarser, x.coarser
            self.grids.append(Grid(y, x, finer, fields, backend))
            finer = self.grids[-1].sites

    @cached_property
    def cells(self) -> list[Single]:
        """Sizes of the cells of the lattice and of all grids but the coarsest."""
        areas = [np.ones(self.sites[:2]), *(grid.areas for grid in self.grids[:-1])]
        return [self.backend.packed(cells) for cells in areas]

    @property
    def joined(self) -> Pair:
        """The corrections of two fields that the first coarse grid hands over."""
        return Pair(*self.grids[0].joined)

    def set_pins(self, e: Single, bound: Single, fraction: float, response: Response) -> None:
        """Set pins on all coarse grids; ``fraction`` is that of the sites in contact.

        A pin among others as stiff does not soften: where all sites that share a coarse one are held, so is
        that.
        """
        if fraction == 0:
            for grid in self.grids:
                grid.pins.fill(0.0)
            return
        sigma = response.coherent_potential(fraction)
        first, strength = self.grids[0], 1.0 / response.softening(0, sigma)
        self.backend.pin(e, bound, self.sites, strength, first.pins)
        # A held site adds ``held`` to the pin on the next coarser grid, and no site adds more.
        held, hard, crowds = strength, _HARD * (4.0 + response.bed), True
        for level, (fine, coarse) in enumerate(pairwise(self.grids), start=1):
            if crowds:
                full = fine.pins >= np.float32(_ALL * held) * fine.sharing
                crowds = bool(full.any())
                fine.pins[full] = np.float32(hard)
            mean = sigma * 4.0**level
            softening = response.softening(level, mean)
            self.backend.coarser_pins(fine.pins, fine.sites, softening, mean, coarse.pins)
            held, hard = hard / (1.0 + softening * max(hard - mean, 0.0)), 4.0 * hard

    def coarser_lags(self, lag: Single, spread: float) -> list[Single]:
        """A lag by site, on the coarse grids: its mean over a cell, weighted by how far its sites respond.

        A site that differs from its neighbors relaxes as w = 1 / (lag + 4 spread / mass). The mean weighted
        by w is harmonic where spread is small, arithmetic where it is large.
        """
        lags, sites, backend = [lag], self.sites, self.backend
        for grid, cells in zip(self.grids, self.cells, strict=True):
            beside = 4.0 * spread * math.prod(sites[:2]) / math.prod(self.sites[:2])
            lags.append(backend.zeros(grid.sites))
            backend.coarser_lag(lags[-2], cells, beside, sites, lags[-1])
            sites = grid.sites
        return lags[1:]
