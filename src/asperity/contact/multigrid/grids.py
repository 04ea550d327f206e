"""The coarse grids: every other site along each axis, of any length, down to a few sites solved directly."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.contact import kernels
from asperity.contact.multigrid.pins import Response
from asperity.lattice import Field

Single = NDArray[np.float32]
Kernel = Callable[..., Any]

_COARSEST = 16
"""Most sites of the grid on which the problem is solved directly."""


@dataclass(frozen=True, eq=False)
class Axis:
    """One axis of a grid: couplings between a site and the next (inverse distances), and cell sizes."""

    coupling: Field
    size: Field

    @classmethod
    def fine(cls, n: int) -> Axis:
        """Sites one apart."""
        return cls(np.ones(n) if n > 1 else np.zeros(1), np.ones(n))

    def coarser(self) -> Axis:
        """Every other site; where n is odd, the last and the first are one old distance apart."""
        n = self.size.size
        if n == 1:
            return self
        distance = 1.0 / self.coupling
        apart = distance[::2].copy()
        apart[: n // 2] += distance[1::2]
        size, half = self.size[::2].copy(), self.size[1::2] / 2
        size[: half.size] += half
        if n % 2:
            size[1:] += half
        else:
            size += np.roll(half, 1)
        return Axis(1.0 / apart if apart.size > 1 else np.zeros(1), size)


def parted_shape(ny: int, nx: int) -> tuple[int, int, int]:
    """Shape of a field whose rows are parted; see `asperity.contact.kernels`."""
    return ny, 2, (nx + 1) // 2 + 1


def parted(field: NDArray[np.floating]) -> Single:
    """A field or one row, in single precision, its rows parted; no images, and 0 where there is no site."""
    lines = np.atleast_2d(field)
    out = np.zeros(parted_shape(*lines.shape), np.float32)
    for row, line in zip(out, lines, strict=True):
        kernels.part(line, row)
    return out.reshape(*field.shape[:-1], *out.shape[1:])


def join_all(field: Single, shape: tuple[int, ...]) -> Field:
    """A parted field, its rows in order, in double precision."""
    out = np.empty(shape)
    kernels.join_rows(field, out, 0, len(out))
    return out


class Grid:
    """One coarse grid and the work arrays on it: single precision, rows parted."""

    def __init__(self, y: Axis, x: Axis, fields: int) -> None:
        self.shape = (y.size.size, x.size.size)
        self.gx, self.mx = parted(x.coupling), parted(x.size)
        kernels.wrap(self.gx, x.size.size)
        self.gy, self.my = y.coupling.astype(np.float32), y.size.astype(np.float32)
        self.axes = (y, x)
        parts = parted_shape(*self.shape)
        self.pins = np.zeros(parts, np.float32)
        self.corrections = [np.zeros(parts, np.float32) for _ in range(fields)]
        self.sources = [np.zeros(parts, np.float32) for _ in range(fields)]
        self.joined = [np.zeros(self.shape, np.float32) for _ in range(fields)]
        """The corrections, rows in order, for the next finer grid."""

    @property
    def geometry(self) -> tuple[Single, Single, Single, Single, int]:
        """Couplings, cell sizes and number of columns, as the kernels take them."""
        return self.gx, self.gy, self.mx, self.my, self.shape[1]

    @cached_property
    def cells(self) -> Field:
        """Sizes of the cells."""
        y, x = self.axes
        return np.outer(y.size, x.size).ravel()

    def total(self, field: Single) -> float:
        """Sum of a field over the sites that the cells stand for."""
        return float(kernels.weighted_total(field, self.mx, self.my))

    def in_order(self, field: Single) -> Field:
        """A field as a vector; for the coarsest grid."""
        return join_all(field, self.shape).ravel()

    def laplacian(self) -> Field:
        """Minus the Laplacian as a matrix; for the coarsest grid."""
        ny, nx = self.shape
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


class Rows:
    """Runs kernels on slabs of rows, in threads where that pays."""

    def __init__(self, threads: int) -> None:
        self.threads = threads
        self.pool = ThreadPoolExecutor(threads) if threads > 1 else None

    def __call__(self, kernel: Kernel, rows: int, width: int, *arguments: Any) -> None:
        """Call ``kernel(*arguments, low, high)`` for slabs that together are all rows."""
        self._run(kernel, [(*arguments, low, high) for low, high in pairwise(self._edges(rows, width))])

    def _edges(self, rows: int, width: int) -> list[int]:
        shared = self.pool is not None and rows * width >= _WORTH_SHARING
        slabs = min(self.threads, rows // _LOWEST_SLAB) if shared else 1
        return [rows * slab // slabs for slab in range(slabs + 1)]

    def _run(self, kernel: Kernel, calls: list[tuple[Any, ...]]) -> None:
        if self.pool is None or len(calls) == 1:
            for call in calls:
                kernel(*call)
            return
        for future in [self.pool.submit(kernel, *call) for call in calls]:
            future.result()

    def and_edges(
        self,
        kernel: Kernel,
        close: Kernel,
        shape: tuple[int, ...],
        *arguments: Any,
        before: tuple[Any, ...] = (),
        after: tuple[Any, ...] = (),
        closing: tuple[Any, ...] = (),
    ) -> list[int]:
        """A kernel on slabs, then what it left undone on both sides of their edges; returns the edges.

        The arguments are common to both; the kernel takes others before and after them, and
        what closes the edges after them.
        """
        edges = self._edges(*shape)
        self._run(kernel, [(*before, *arguments, *after, low, high) for low, high in pairwise(edges)])
        self._run(close, [(*arguments, *closing, edge) for edge in edges[:-1]])
        return edges

    def by_color(self, kernel: Kernel, shape: tuple[int, ...], *arguments: Any, first: int) -> None:
        """One sweep: the sites of one color, then those of the other."""
        rows, width = shape
        if len(self._edges(rows, width)) == 2:
            kernel(*arguments, first, 2, 0, rows)
            return
        for color in (first, 1 - first):
            # Where the last row has the color of the first, its neighbor, it waits.
            self(kernel, rows - rows % 2, width, *arguments, color, 1)
            if rows % 2:
                kernel(*arguments, color, 1, rows - 1, rows)


_LOWEST_SLAB = 16
"""Minimum rows of a thread; must exceed twice the number of half sweeps."""

_WORTH_SHARING = 2**19
"""Number of sites from which a second thread saves time."""


def usual_threads() -> int:
    """Number of threads: what ``OMP_NUM_THREADS`` says, as for other numerical libraries, or all cores."""
    wanted = os.environ.get("OMP_NUM_THREADS", "")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, int(wanted)) if wanted.isdigit() else cores


class Hierarchy:
    """The grids above a lattice, from the first coarse one to the coarsest."""

    def __init__(self, shape: tuple[int, ...], fields: int, rows: Rows) -> None:
        self.rows = rows
        y, x = (Axis.fine(n) for n in shape)
        self.grids: list[Grid] = []
        while not self.grids or np.prod(self.grids[-1].shape) > _COARSEST:
            y, x = y.coarser(), x.coarser()
            self.grids.append(Grid(y, x, fields))

    def set_pins(self, e: Single, bound: Single, columns: int, fraction: float, response: Response) -> None:
        """Set pins on all coarse grids; ``fraction`` is that of the sites in contact."""
        if fraction == 0:
            for grid in self.grids:
                grid.pins.fill(0.0)
            return
        sigma = response.coherent_potential(fraction)
        first = self.grids[0]
        strength = np.float32(1.0 / response.softening(0, sigma))
        self.rows(kernels.pins_of_contacts, *first.shape, e, bound, columns, strength, first.pins)
        for level, (fine, coarse) in enumerate(zip(self.grids[:-1], self.grids[1:], strict=True), start=1):
            mean = float(fine.pins.sum(dtype=float)) / math.prod(fine.shape)
            softening = np.float32(response.softening(level, mean))
            kernels.coarser_pins(fine.pins, fine.shape[1], softening, np.float32(mean), coarse.pins)
