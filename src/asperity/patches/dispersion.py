"""How contacts are scattered over the surface."""

from __future__ import annotations

import math

import numpy as np
import scipy.ndimage
from numpy.typing import ArrayLike

from asperity.base import checks
from asperity.lattice import Mask
from asperity.patches.labels import mask

_CONTACTS_PER_BOX = 4
_BOXES_PER_AXIS = 8
_SMALLEST_BOX = 2
"""The index of single sites is 1 whatever they do."""


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
    touching = mask("in_contact", in_contact)
    sites, shorter = touching.size, min(touching.shape)
    fraction = np.count_nonzero(touching) / sites
    expected = f"a whole number of sites, 2 to {shorter // 2} (half an axis)"
    side = usual_box(touching) if box is None else box
    side = checks.integer("box", side, least=_SMALLEST_BOX, most=shorter // 2, expected=expected)
    if fraction in (0.0, 1.0):
        return math.nan
    inside = touching.astype(np.int64)
    for axis in range(touching.ndim):
        inside = scipy.ndimage.convolve1d(inside, np.ones(side, dtype=np.int64), axis=axis, mode="wrap")
    capacity = side**touching.ndim
    at_random = capacity * fraction * (1 - fraction) * (sites - capacity) / (sites - 1)
    return float(np.var(inside) / at_random)


def usual_box(touching: Mask) -> int:
    """Side of the boxes that `clustering` takes where none is given."""
    fraction = np.count_nonzero(touching) / touching.size
    side: float = (_CONTACTS_PER_BOX / fraction) ** (1 / touching.ndim) if fraction else 1.0
    return max(_SMALLEST_BOX, min(round(side), int(min(touching.shape)) // _BOXES_PER_AXIS))
