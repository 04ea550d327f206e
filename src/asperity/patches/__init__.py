"""Patches of contact: labelled, measured, and linked through the maps of a history."""

from asperity.base.calls import answered as _answered
from asperity.patches.labels import Labels, Patches, patches
from asperity.patches.links import Links, Turnover, link_patches, linked, turnover
from asperity.patches.series import QUANTILES, ages_of, clustering, clustering_box, map_series, quantiles
from asperity.patches.shapes import Shapes, shapes_of

__all__ = [
    "QUANTILES",
    "Labels",
    "Links",
    "Patches",
    "Shapes",
    "Turnover",
    "ages_of",
    "clustering",
    "clustering_box",
    "link_patches",
    "linked",
    "map_series",
    "patches",
    "quantiles",
    "shapes_of",
    "turnover",
]
__dir__ = _answered(globals())
