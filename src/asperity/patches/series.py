"""Series from maps of contact: patches, their links, clustering, and contact ages."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, Literal

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks
from asperity.lattice import Edges, Field, Lattice, Mask
from asperity.patches.labels import mask
from asperity.patches.links import Links, linked
from asperity.patches.shapes import Shapes, shapes_of

Maps = Sequence[Mask] | NDArray[np.bool_]
"""Whether each site is in contact, one array of the shape of the lattice for each time."""

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
"""Shares of the sites in contact at which pressures and ages are given; the last is the largest."""

_CONTACTS_PER_BOX = 4
_BOXES_PER_AXIS = 8
_SMALLEST_BOX = 2
"""Boxes of single sites always have the index 1."""

_EVENTS = [name for name, one in vars(Links).items() if isinstance(one, property) and name[0] != "_"]
"""Counts of what happens between two maps; what is one number a patch is a cached property."""


def quantiles(values: Field) -> Field:
    """Values at `QUANTILES`, by the inverted distribution; NaN without values."""
    if not values.size:
        return np.full(len(QUANTILES), math.nan)
    return np.asarray(np.quantile(values, QUANTILES, method="inverted_cdf"), dtype=np.float64)


def map_series(
    maps: Maps, times: Sequence[float], lattice: Lattice, body: Mask | None = None
) -> dict[str, NDArray[Any]]:
    """Measure the patches of each map, at times that do not decrease, and follow them from map to map.

    A rough body that ends has a mask of its sites.
    The arrays over the maps are the ``"map"`` quantities of `asperity.results.quantities`, without pressure.
    Changes since the map before are 0 at first. NaN without patches, and without a box for the clustering.
    """
    rows: list[dict[str, Any]] = []
    box, before = clustering_box(maps, body), None
    around: dict[str, Any] = {"edges": lattice.edges, "body": body}
    for touching, ages in zip(maps, _ages(maps, times), strict=True):
        shapes = shapes_of(touching, lattice.spacing, lattice.edges)
        row = _sizes(shapes, lattice.dimension)
        row["clustering"] = math.nan if box is None else clustering(touching, box, **around)
        links = linked(before or shapes.patches, shapes.patches)
        row |= {name: getattr(links, name) for name in _EVENTS}
        row["mean_contact_age"] = float(ages.mean()) if ages.size else math.nan
        row["contact_age"] = quantiles(ages)
        rows.append(row)
        before = shapes.patches
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def clustering_box(maps: Maps, body: Mask | None = None) -> int | None:
    """Side of the boxes for the clustering of all maps, from the first map with contact; None if too wide."""
    first = next((touching for touching in maps if touching.any()), None)
    box = 0 if first is None else usual_box(first, body)
    return box if first is not None and box <= _shorter(first, body) // 2 else None


def ages_of(maps: Maps, times: Sequence[float]) -> Field:
    """Time since each site was last found free, or since the first map; NaN off contact.

    Shape ``(maps, *lattice)``.
    """
    fields = np.full(np.shape(maps), math.nan)
    for field, touching, ages in zip(fields, maps, _ages(maps, times), strict=True):
        field[touching] = ages
    return fields


def _ages(maps: Maps, times: Sequence[float]) -> Iterator[Field]:
    """For each map, the time for which each of its sites in contact has been so in all maps."""
    since = np.zeros(np.shape(maps)[1:], dtype=np.int32)  # the number of a map
    moments = np.asarray(times, dtype=np.float64)
    for number, touching in enumerate(maps):
        yield moments[number] - moments[since[touching]]
        np.copyto(since, number + 1, where=~touching)


def _sizes(shapes: Shapes, dimension: int) -> dict[str, Any]:
    of_map, sized = shapes.patches, shapes.patches.sizes.astype(np.float64)
    row = {
        "patches": of_map.count,
        "mean_patch_size": of_map.mean_size,
        "median_patch_size": float(np.median(sized)) if of_map.count else math.nan,
        "largest_patch_size": of_map.largest,
        "perimeter": float(shapes.perimeter.sum()),
    }
    if dimension == 2:
        ended = ~np.isnan(shapes.aspect)
        weight = sized[ended].sum()
        row["mean_patch_aspect"] = float(shapes.aspect[ended] @ sized[ended] / weight) if weight else math.nan
    return row


def clustering(
    in_contact: ArrayLike, box: int | None = None, *, edges: Edges = "periodic", body: ArrayLike | None = None
) -> float:
    r"""Measure how clustered contacts are: the index of dispersion of their number in square boxes.

    The variance of the number of contacts in a box is divided by that of as many contacts placed at random on
    the N sites, no two on one. With m sites a box and the contact fraction a, this is

        var = m a (1 - a) (N - m)/(N - 1).

    The index is 1 on average for contacts at random, at any contact fraction and on any lattice. It is above
    1 for clusters, below 1 for contacts that keep apart. There is a box at every site, across periodic edges
    too; others, and the end of a body, cut no box.

    Parameters
    ----------
    in_contact
        Whether each site is in contact, shape ``(n,)`` or ``(n, m)``.
    box
        Side of a box, in lattice spacings. The default box holds about four contacts; its side is at least 2
        and at most an eighth of the shorter axis. The index depends on the box: to compare contacts, give the
        same box to all.
    edges
        Edges of the lattice.
    body
        Sites of a rough body that ends, of the same shape; by default all.

    Returns
    -------
    float
        The index; NaN where there is nothing to strew (no contact, or all sites in contact), or no box.

    Raises
    ------
    InputError
        No boolean mask of one or two axes, or an empty one; a box of less than 2 sites or wider than half the
        shorter axis, so that there is none on axes of less than 4 sites.
    """
    touching = mask("in_contact", in_contact)
    of_body = None if body is None else mask("body", body)
    sites, shorter = _sites(touching, of_body), _shorter(touching, of_body)
    fraction = np.count_nonzero(touching) / sites
    side = usual_box(touching, of_body) if box is None else box
    side = checks.integer("box", side, least=_SMALLEST_BOX, most=shorter // 2)
    if fraction in (0.0, 1.0):
        return math.nan
    capacity, boxes = side**touching.ndim, _in_boxes(touching, side, edges)
    if of_body is not None or edges != "periodic":
        body_sites = np.ones_like(touching) if of_body is None else of_body
        boxes = boxes[_in_boxes(body_sites, side, edges) == capacity]
    at_random = capacity * fraction * (1 - fraction) * (sites - capacity) / (sites - 1)
    return float(np.mean((boxes - capacity * fraction) ** 2) / at_random) if boxes.size else math.nan


def _in_boxes(counted: Mask, side: int, edges: Edges) -> NDArray[np.int64]:
    """How many of these sites are in the box at each site."""
    inside = counted.astype(np.int64)
    beyond: Literal["wrap", "constant"] = "wrap" if edges == "periodic" else "constant"
    for axis in range(counted.ndim):
        inside = scipy.ndimage.convolve1d(inside, np.ones(side, dtype=np.int64), axis, mode=beyond)
    return inside


def usual_box(touching: Mask, body: Mask | None = None) -> int:
    """Side of the boxes that `clustering` takes where none is given."""
    fraction = np.count_nonzero(touching) / _sites(touching, body)
    side: float = (_CONTACTS_PER_BOX / fraction) ** (1 / touching.ndim) if fraction else 1.0
    return max(_SMALLEST_BOX, min(round(side), _shorter(touching, body) // _BOXES_PER_AXIS))


def _sites(touching: Mask, body: Mask | None) -> int:
    """Sites of the body."""
    return int(np.count_nonzero(np.ones_like(touching) if body is None else body))


def _shorter(touching: Mask, body: Mask | None) -> int:
    """Sites along the shorter axis of the body."""
    if body is None:
        return int(min(touching.shape))
    along = range(body.ndim)
    return int(min(np.count_nonzero(body.any(axis=tuple({*along} - {axis}))) for axis in along))
