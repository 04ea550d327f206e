"""Analysis: from a history, or a surface, to the numbers that figures and reports show."""

from asperity.analysis.aging import AgingSummary, aging_summary
from asperity.analysis.limit import with_limit
from asperity.analysis.maps import ContactMaps, SiteState, contact_maps
from asperity.analysis.protocol import hold_times, map_times, modest_load
from asperity.analysis.view import SurfaceView, surface_view

__all__ = [
    "AgingSummary",
    "ContactMaps",
    "SiteState",
    "SurfaceView",
    "aging_summary",
    "contact_maps",
    "hold_times",
    "map_times",
    "modest_load",
    "surface_view",
    "with_limit",
]
