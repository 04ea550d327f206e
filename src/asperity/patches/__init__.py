"""Patches of contact: labelled, measured, and linked through the maps of a history."""

from asperity.base.calls import answered as _answered
from asperity.patches.labels import Labels as Labels
from asperity.patches.labels import Patches as Patches
from asperity.patches.labels import patches as patches
from asperity.patches.links import Links as Links
from asperity.patches.links import Turnover as Turnover
from asperity.patches.links import link_patches as link_patches
from asperity.patches.links import linked as linked
from asperity.patches.links import turnover as turnover
from asperity.patches.series import QUANTILES as QUANTILES
from asperity.patches.series import ages_of as ages_of
from asperity.patches.series import clustering as clustering
from asperity.patches.series import clustering_box as clustering_box
from asperity.patches.series import map_series as map_series
from asperity.patches.series import quantiles as quantiles
from asperity.patches.shapes import Shapes as Shapes
from asperity.patches.shapes import shapes_of as shapes_of

__dir__ = _answered(globals())
