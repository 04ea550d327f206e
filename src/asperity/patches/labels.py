r"""Patches: sets of sites in contact that are joined through neighbors, also across periodic edges.

All functions take masks of sites in contact and count in sites.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, get_args

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks, views
from asperity.errors import InputError
from asperity.lattice import Edges, Mask

Labels = NDArray[np.int64]


@dataclass(frozen=True, eq=False, repr=False)
class Patches(views.Brief):
    """The patches of one contact.

    Attributes
    ----------
    labels
        0 off contact, and on contact the number of the patch, from 1 on, largest first; shape of the lattice.
    sizes
        Sites of each patch, descending: ``sizes[k - 1]`` is that of patch k; shape ``(count,)``.
    """

    labels: Labels
    sizes: NDArray[np.int64]

    @property
    def count(self) -> int:
        """Number of patches."""
        return self.sizes.size

    @property
    def largest(self) -> int:
        """Sites of the largest patch; 0 if there is none."""
        return int(self.sizes[0]) if self.count else 0

    @property
    def mean_size(self) -> float:
        """Sites of a patch on average; NaN if there is none."""
        return float(self.sizes.mean()) if self.count else math.nan


@dataclass(frozen=True, eq=False)
class Pieces:
    """The patches of a lattice that is cut open at its edges, and their bonds across these."""

    labels: NDArray[np.signedinteger[Any]]
    """0 off contact, and on contact the number of the piece, from 1 on; shape of the lattice."""
    numbers: Labels
    """Number of the patch to which each piece belongs, by `sizes`; 0 for piece 0."""
    sizes: NDArray[np.int64]
    """Sites of each patch, descending."""
    joined: NDArray[np.int32]
    """Pairs of pieces that touch each other across a seam, shape ``(bonds, 2)``."""
    turns: NDArray[np.int64]
    """Turns around the lattice along each axis from first to second piece: -1, 0 or 1; shape ``(bonds,
    dimension)``."""

    @cached_property
    def places(self) -> tuple[NDArray[np.int64], Mask]:
        """Shift that joins each piece to its patch, lattice lengths, shape ``(pieces + 1, dimension)``.

        And whether a patch reaches around the lattice, so that no shift does: shape ``(patches + 1,)``.
        """
        places = np.zeros((self.numbers.size, self.labels.ndim), dtype=np.int64)
        first, second = self.joined.T
        placed = np.ones(self.numbers.size, dtype=bool)
        placed[first] = placed[second] = False
        joined = np.union1d(first, second)
        placed[joined[np.unique(self.numbers[joined], return_index=True)[1]]] = True  # one of each patch
        while (forth := placed[first] & ~placed[second]).any() or (~placed[first] & placed[second]).any():
            back = ~placed[first] & placed[second]
            places[second[forth]] = places[first[forth]] + self.turns[forth]
            places[first[back]] = places[second[back]] - self.turns[back]
            placed[second[forth]] = placed[first[back]] = True
        torn = (places[second] - places[first] != self.turns).any(axis=1)
        endless = np.zeros(self.sizes.size + 1, dtype=bool)
        endless[self.numbers[first[torn]]] = True
        return places, endless


def patches(in_contact: ArrayLike, connectivity: int = 1, *, edges: Edges = "periodic") -> Patches:
    """Find the patches of contact.

    Parameters
    ----------
    in_contact
        Whether each site is in contact, shape ``(n,)`` or ``(n, m)``.
    connectivity
        1: sites are joined to their nearest neighbors, as by the springs k0; 2: diagonally too.
    edges
        "periodic": the last site of an axis is a neighbor of the first; "reflecting", "free": it is not.

    Raises
    ------
    InputError
        No boolean mask of one or two axes, or an empty one; a connectivity other than 1 or 2; other edges.
    """
    touching = mask("in_contact", in_contact)
    pieces = pieces_of(touching, connectivity, edges)
    return Patches(labels=pieces.numbers[pieces.labels], sizes=pieces.sizes)


def pieces_of(touching: Mask, connectivity: int, edges: Edges) -> Pieces:
    """Find patches, with their bonds across periodic edges; arguments and errors as of `patches`."""
    connectivity = checks.integer("connectivity", connectivity, least=1, most=2)
    checks.choice("edges", edges, get_args(Edges))
    structure = scipy.ndimage.generate_binary_structure(touching.ndim, min(connectivity, touching.ndim))
    labels, count = scipy.ndimage.label(touching, structure)
    joined, turns = np.empty((0, 2), dtype=np.int32), np.empty((0, touching.ndim), dtype=np.int64)
    if edges == "periodic":
        joined, turns = _across_the_seams(labels, connectivity)
    first, second = joined.T
    bonds = scipy.sparse.coo_array(
        (np.ones(first.size, dtype=bool), (first, second)), shape=(count + 1, count + 1)
    )
    # No bond reaches piece 0, which is "no contact": it stays a component of its own.
    components, whole = scipy.sparse.csgraph.connected_components(bonds, directed=False)
    sizes = np.bincount(whole, np.bincount(labels.ravel(), minlength=count + 1)).astype(np.int64)
    sizes[whole[0]] = np.iinfo(sizes.dtype).max  # the sites off contact come first: number 0
    order = np.argsort(-sizes, kind="stable")
    rank = np.empty(components, dtype=np.int64)
    rank[order] = np.arange(components)
    return Pieces(labels, rank[whole], sizes[order][1:], joined, turns)


def mask(name: str, value: ArrayLike) -> Mask:
    """A boolean array of one or two axes; `InputError` for anything else."""
    expected, advice = "a boolean array of shape (n,) or (n, m)", "u == heights"
    try:
        array = np.asarray(value)
    except TypeError as error:  # such as a Dataset
        got = checks.kind_of(value)
        raise InputError(name, expected=expected, got=got, advice=advice) from error
    if array.dtype != np.bool_ or array.ndim not in (1, 2) or array.size == 0:
        got = f"{array.dtype} of shape {array.shape}"
        raise InputError(name, expected=expected, got=got, advice=advice)
    return array


def masks(before: ArrayLike, after: ArrayLike) -> tuple[Mask, Mask]:
    """Two masks of one lattice; `InputError` for anything else."""
    first, last = mask("before", before), mask("after", after)
    if first.shape != last.shape:
        raise InputError("after", expected=f"a mask of shape {first.shape}", got=last.shape)
    return first, last


def _across_the_seams(
    labels: NDArray[np.signedinteger[Any]], connectivity: int
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Pairs of pieces that touch across the edges, and their turns."""
    bonds = []
    for axis in range(labels.ndim):
        first, last = np.atleast_1d(labels.take(0, axis), labels.take(-1, axis))
        for shift in (-1, 0, 1) if connectivity == 2 and labels.ndim == 2 else (0,):
            turns = np.zeros((first.size, labels.ndim), dtype=np.int64)
            turns[:, axis] = -1
            if shift:  # a diagonal neighbor, which may lie across the other seam too
                turns[0 if shift == 1 else -1, 1 - axis] = -shift
            bonds.append(np.column_stack([first, np.roll(last, shift), turns]))
    pairs = np.concatenate(bonds)
    pairs = np.unique(pairs[(pairs[:, 0] > 0) & (pairs[:, 1] > 0)], axis=0)
    return pairs[:, :2].astype(np.int32), pairs[:, 2:]
