r"""Patches of contact: how many and how large, how they are scattered, and how they change.

A patch is a set of sites in contact that are joined through neighbors on the periodic lattice. All functions
take masks of sites in contact and count in sites; lengths are in lattice spacings.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import get_args

import numpy as np
import scipy.ndimage
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import asperity.checks as checks
import asperity.views as views
from asperity.errors import InputError
from asperity.lattice import Edges, Mask

Labels = NDArray[np.int64]

_CONTACTS_PER_BOX = 4
_BOXES_PER_AXIS = 8
_SMALLEST_BOX = 2
"""The index of single sites is 1 whatever they do."""


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


def patches(in_contact: ArrayLike, connectivity: int = 1, *, edges: Edges = "periodic") -> Patches:
    """Find the patches of contact.

    Parameters
    ----------
    in_contact
        Whether each site is in contact, shape ``(n,)`` or ``(n, m)``.
    connectivity
        1: sites are joined to their nearest neighbors, as by the springs k0; 2: diagonally too.
    edges
        "periodic": the last site of an axis is a neighbor of the first; "reflecting": it is not.

    Returns
    -------
    Patches

    Raises
    ------
    InputError
        No boolean mask of one or two axes, or an empty one; a connectivity other than 1 or 2; other edges.
    """
    touching = _mask("in_contact", in_contact)
    expected = "1 (nearest neighbors) or 2 (diagonals too)"
    connectivity = checks.integer("connectivity", connectivity, least=1, most=2, expected=expected)
    if edges not in get_args(Edges):
        raise InputError("edges", expected="'periodic' or 'reflecting'", got=checks.shown(edges))
    pieces, count = _open_pieces(touching, connectivity)
    one, other = np.empty((2, 0), dtype=pieces.dtype)
    if edges == "periodic":
        one, other = _across_the_seam(pieces, connectivity)
    joined = coo_array((np.ones(one.size, dtype=bool), (one, other)), shape=(count + 1, count + 1))
    # No bond reaches piece 0, which is "no contact": it stays a component of its own.
    components, whole = connected_components(joined, directed=False)
    sizes = np.bincount(whole[pieces].ravel(), minlength=components)
    sizes[whole[0]] = np.iinfo(sizes.dtype).max  # the sites off contact come first: number 0
    order = np.argsort(-sizes, kind="stable")
    rank = np.empty(components, dtype=np.int64)
    rank[order] = np.arange(components)
    return Patches(labels=rank[whole][pieces], sizes=sizes[order][1:].astype(np.int64))


def clustering(in_contact: ArrayLike, box: int | None = None) -> float:
    r"""Measure how clustered contacts are: the index of dispersion of their number in square boxes.

    The variance of the number of contacts in a box is divided by the one that the same number of contacts
    would have if they were strewn at random over the N sites, no two on one site. With m sites a box and
    the contact fraction a, that is

        var = m a (1 - a) (N - m)/(N - 1),

    so that the index is 1 on average for contacts at random, at any contact fraction and on any lattice;
    above 1 for contacts in clusters, below 1 for contacts that keep apart. Boxes are laid at every site,
    across the seam too: none is cut off where the box does not divide the lattice.

    Parameters
    ----------
    in_contact
        Whether each site is in contact, shape ``(n,)`` or ``(n, m)``.
    box
        Side of a box, in lattice spacings. By default such that a box holds about four contacts, but at
        least 2 and at most an eighth of the shorter axis: boxes with less than one contact see only contacts
        that all but touch, and of large boxes there are too few to find a variance. The index depends on the
        box: to compare contacts, for example of one surface at several times, give the same box to all.

    Returns
    -------
    float
        The index; NaN where there is nothing to strew (no contact, or all sites in contact).

    Raises
    ------
    InputError
        No boolean mask of one or two axes, or an empty one; a box of less than 2 sites or wider than half the
        shorter axis, so that there is none on axes of less than 4 sites.
    """
    touching = _mask("in_contact", in_contact)
    sites, shorter = touching.size, min(touching.shape)
    fraction = np.count_nonzero(touching) / sites
    if box is None:
        side = (_CONTACTS_PER_BOX / fraction) ** (1 / touching.ndim) if fraction else 1.0
        box = max(_SMALLEST_BOX, min(round(side), shorter // _BOXES_PER_AXIS))
    expected = f"a whole number of sites, 2 to {shorter // 2} (half an axis)"
    box = checks.integer("box", box, least=_SMALLEST_BOX, most=shorter // 2, expected=expected)
    if fraction in (0.0, 1.0):
        return math.nan
    inside = touching.astype(np.int64)
    for axis in range(touching.ndim):
        inside = scipy.ndimage.convolve1d(inside, np.ones(box, dtype=np.int64), axis=axis, mode="wrap")
    capacity = box**touching.ndim
    at_random = capacity * fraction * (1 - fraction) * (sites - capacity) / (sites - 1)
    return float(np.var(inside) / at_random)


@dataclass(frozen=True)
class Turnover:
    """What became of a contact.

    Attributes
    ----------
    kept
        Sites in contact before and after.
    gained
        Sites in contact only after.
    lost
        Sites in contact only before.
    gained_attached
        Of the sites gained, those that extend patches: joined to a site in contact before, through
        neighbors in contact before or after.
    gained_detached
        The other sites gained, which form new patches.
    """

    kept: int
    gained: int
    lost: int
    gained_attached: int
    gained_detached: int


def turnover(before: ArrayLike, after: ArrayLike) -> Turnover:
    """Compare two contacts of one lattice, and tell growing patches from new ones.

    Parameters
    ----------
    before, after
        Whether each site is in contact at two times, shape ``(n,)`` or ``(n, m)``.

    Returns
    -------
    Turnover
        Numbers of sites.

    Raises
    ------
    InputError
        No boolean masks of one or two axes, or empty ones; masks that differ in shape.
    """
    first, last = _mask("before", before), _mask("after", after)
    if first.shape != last.shape:
        raise InputError("after", expected=f"a mask of shape {first.shape}", got=last.shape)
    gained = last & ~first
    either = patches(first | last)
    old = np.zeros(either.count + 1, dtype=bool)
    old[either.labels[first]] = True
    attached = int(np.count_nonzero(old[either.labels[gained]]))
    total = int(np.count_nonzero(gained))
    return Turnover(
        kept=int(np.count_nonzero(first & last)),
        gained=total,
        lost=int(np.count_nonzero(first & ~last)),
        gained_attached=attached,
        gained_detached=total - attached,
    )


def _mask(name: str, given: ArrayLike) -> Mask:
    mask = np.asarray(given)
    if mask.dtype != np.bool_ or mask.ndim not in (1, 2) or mask.size == 0:
        raise InputError(
            name,
            expected="a boolean array of shape (n,) or (n, m)",
            got=f"{mask.dtype} of shape {mask.shape}",
            advice="u == heights",
        )
    return mask


def _open_pieces(touching: Mask, connectivity: int) -> tuple[NDArray[np.int32], int]:
    """Label the patches of the lattice with open ends: 1 and up, and 0 off contact."""
    structure = scipy.ndimage.generate_binary_structure(touching.ndim, min(connectivity, touching.ndim))
    labels = np.empty(touching.shape, dtype=np.int32)
    count = scipy.ndimage.label(touching, structure=structure, output=labels)
    return labels, int(count)


def _across_the_seam(
    pieces: NDArray[np.int32], connectivity: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Pairs of pieces that touch each other from the last site of an axis to its first."""
    pairs = []
    for axis in range(pieces.ndim):
        first, last = np.atleast_1d(pieces.take(0, axis), pieces.take(-1, axis))
        shifts = (-1, 0, 1) if connectivity == 2 else (0,)
        pairs += [np.stack([first, np.roll(last, shift)]) for shift in shifts]
    one, other = np.concatenate(pairs, axis=1)
    both = (one > 0) & (other > 0)
    return one[both], other[both]
