"""How large the patches of a contact are, how long their rims, how elongated, and where they lie."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from asperity.lattice import Edges, Field, Mask
from asperity.patches.labels import Labels, Patches, pieces_of


@dataclass(frozen=True, eq=False)
class Shapes:
    """The patches of one contact, and their shapes; arrays over the patches, largest first."""

    patches: Patches
    """The patches."""
    sites: NDArray[np.int64]
    """Numbers of the sites in contact, along the last axis first, shape ``(area,)``."""
    numbers: Labels
    """The patch of each of them."""
    perimeter: Field
    """Length of the sides between sites in contact and off contact, without reflecting edges; on a line the
    number of ends."""
    aspect: Field
    """Ratio >= 1 of the axes of the ellipse with the second moments of the patch; a/b for a rectangle of
    a x b sites. NaN on a line, and for a patch that reaches around the lattice."""
    center: Field
    """Center of area, within the lattice, from the center of the first site on; shape ``(count,
    dimension)``; NaN of a patch that reaches around the lattice."""


_BEYOND: dict[Edges, Literal["wrap", "nearest", "constant"]] = {
    "periodic": "wrap",
    "reflecting": "nearest",
    "free": "constant",
}


def shapes_of(
    touching: Mask, spacing: Sequence[float], edges: Edges = "periodic", connectivity: int = 1
) -> Shapes:
    """Measure the patches of a contact, in the unit of the spacing; other arguments as of `patches`."""
    pieces = pieces_of(touching, connectivity, edges)
    labelled = Patches(pieces.numbers[pieces.labels], pieces.sizes)
    indices = np.nonzero(touching)
    sites = np.ravel_multi_index(indices, touching.shape)
    numbers = labelled.labels.ravel()[sites]
    places, endless = pieces.places
    patch = pieces.labels.ravel()[sites]
    sized = labelled.sizes.astype(np.float64)
    offsets, center, perimeter = [], [], np.zeros(labelled.count)
    # A mirror is no end of a contact, the end of a body is one.
    for axis, (index, step) in enumerate(zip(indices, spacing, strict=True)):
        place = (index + touching.shape[axis] * places[patch, axis]) * float(step)
        mean = _over_patches(numbers, labelled.count, place) / sized
        offsets.append(place - mean[numbers - 1])
        center.append(np.mod(mean, touching.shape[axis] * step))
        beside = scipy.ndimage.correlate1d(touching.astype(np.int8), [1, 0, 1], axis, mode=_BEYOND[edges])
        free = _over_patches(numbers, labelled.count, 2 - beside.ravel()[sites].astype(np.float64))
        perimeter += free * (math.prod(spacing) / step)
    nowhere = endless[1:]
    return Shapes(
        patches=labelled,
        sites=sites,
        numbers=numbers,
        perimeter=perimeter,
        aspect=np.where(nowhere, math.nan, _aspect(numbers, offsets, spacing, sized)),
        center=np.where(nowhere[:, None], math.nan, np.column_stack(center)),
    )


def _over_patches(numbers: Labels, count: int, values: Field) -> Field:
    return np.bincount(numbers, values, minlength=count + 1)[1:].astype(np.float64)


def _aspect(numbers: Labels, offsets: Sequence[Field], spacing: Sequence[float], sites: Field) -> Field:
    if len(offsets) == 1:
        return np.full(sites.size, math.nan)
    y, x = offsets
    height, width = spacing
    yy, xx, xy = (_over_patches(numbers, sites.size, product) / sites for product in (y * y, x * x, x * y))
    yy, xx = yy + height**2 / 12, xx + width**2 / 12
    mean, spread = (yy + xx) / 2, np.hypot((yy - xx) / 2, xy)
    # The product of the roots is the determinant: mean - spread would lose the digits of a thin patch.
    return np.asarray((mean + spread) / np.sqrt(yy * xx - xy * xy))
