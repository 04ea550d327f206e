"""Analysis: from a history, or a surface, to the numbers that figures and reports show."""

from asperity.analysis.aging import AgingSummary, aging_summary
from asperity.analysis.contact_patches import (
    Patches,
    Turnover,
    clustering,
    patches,
    turnover,
)
from asperity.analysis.legs import LegRow, leg_table
from asperity.analysis.limit import with_limit
from asperity.analysis.maps import ContactMaps, SiteState, contact_maps
from asperity.analysis.view import SurfaceView, surface_view

__all__ = [
    "AgingSummary",
    "ContactMaps",
    "LegRow",
    "Patches",
    "SiteState",
    "SurfaceView",
    "Turnover",
    "aging_summary",
    "clustering",
    "contact_maps",
    "leg_table",
    "patches",
    "surface_view",
    "turnover",
    "with_limit",
]


def __dir__() -> list[str]:
    """List the public names."""
    return __all__
