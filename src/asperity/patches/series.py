"""What maps of contact know: patches, what became of them, and how long each site has touched."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.lattice import Field, Lattice, Mask
from asperity.patches.dispersion import clustering, usual_box
from asperity.patches.links import linked
from asperity.patches.shapes import Shapes, shapes_of

Maps = Sequence[Mask] | NDArray[np.bool_]
"""Whether each site is in contact, one array of the shape of the lattice for each time."""

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
"""Shares of the sites in contact at which pressures and ages are given; the last is the largest."""

_EVENTS = (
    *("births", "deaths", "merges", "splits"),
    *("gained_by_expansion", "gained_by_coalescence", "gained_by_births"),
    *("lost_by_shrinkage", "lost_by_deaths"),
)


def quantiles(values: Field) -> Field:
    """Values at `QUANTILES`: the least value that such a share does not exceed; NaN where there is none."""
    if not values.size:
        return np.full(len(QUANTILES), math.nan)
    return np.asarray(np.quantile(values, QUANTILES, method="inverted_cdf"), dtype=np.float64)


def map_series(maps: Maps, times: Sequence[float], lattice: Lattice) -> dict[str, NDArray[Any]]:
    """Measure the patches of each map, at times that do not decrease, and follow them from map to map.

    Returns
    -------
    dict of arrays, shape ``(maps,)``; of ``contact_age`` ``(maps, quantiles)``
        What the table of quantities has of maps, but for the pressure. Changes since the map before, those of
        `Links`, are 0 at the first. NaN where there is no patch, and of the clustering where there are no
        boxes.
    """
    rows: list[dict[str, Any]] = []
    box, before = clustering_box(maps), None
    moments = np.asarray(times, dtype=np.float64)
    for number, (touching, since) in enumerate(zip(maps, _touching_since(maps), strict=True)):
        shapes = shapes_of(touching, lattice.spacing, lattice.edges)
        row = _sizes(shapes, lattice.dimension)
        row["clustering"] = math.nan if box is None else clustering(touching, box)
        links = linked(before or shapes.found, shapes.found)
        row |= {name: getattr(links, name) for name in _EVENTS}
        ages = moments[number] - moments[since.ravel()[shapes.sites]]
        row["mean_contact_age"] = float(ages.mean()) if ages.size else math.nan
        row["contact_age"] = quantiles(ages)
        rows.append(row)
        before = shapes.found
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def clustering_box(maps: Maps) -> int | None:
    """Side of the boxes for the clustering of all maps: that which suits the first with a contact."""
    first = next((touching for touching in maps if touching.any()), None)
    box = 0 if first is None else usual_box(first)
    return box if first is not None and box <= min(first.shape) // 2 else None


def ages_of(maps: Maps, times: Sequence[float]) -> Field:
    """Time since each site was last found free, or since the first map; NaN off contact.

    Shape ``(maps, *lattice)``.
    """
    found = np.full(np.shape(maps), math.nan)
    moments = np.asarray(times, dtype=np.float64)
    for number, (touching, since) in enumerate(zip(maps, _touching_since(maps), strict=True)):
        found[number][touching] = moments[number] - moments[since[touching]]
    return found


def _touching_since(maps: Maps) -> Iterator[NDArray[np.int32]]:
    """For each map, the number of the map since which each site in contact has been so in all."""
    since = np.zeros(np.shape(maps)[1:], dtype=np.int32)
    for number, touching in enumerate(maps):
        yield since
        np.copyto(since, number + 1, where=~touching)


def _sizes(shapes: Shapes, dimension: int) -> dict[str, Any]:
    found, sized = shapes.found, shapes.found.sizes.astype(np.float64)
    row = {
        "patches": found.count,
        "mean_patch_size": found.mean_size,
        "median_patch_size": float(np.median(sized)) if found.count else math.nan,
        "largest_patch_size": found.largest,
        "perimeter": float(shapes.perimeter.sum()),
    }
    if dimension == 2:
        ended = ~np.isnan(shapes.aspect)
        weight = sized[ended].sum()
        row["mean_patch_aspect"] = float(shapes.aspect[ended] @ sized[ended] / weight) if weight else math.nan
    return row
