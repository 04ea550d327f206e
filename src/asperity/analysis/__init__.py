"""Analysis of a history: growth of the contact area, patches and maps of contact, legs, the relaxed limit."""

from asperity.analysis.aging import AgingSummary, aging_summary, with_limit
from asperity.analysis.field_values import Distribution, distributions
from asperity.analysis.legs import LegRow, leg_table
from asperity.analysis.maps import ContactMaps, SiteState, contact_maps
from asperity.analysis.observation import Observation, observe
from asperity.analysis.tracks import PatchTracks, contact_ages, patch_table, patch_tracks
from asperity.base.calls import answered as _answered
from asperity.patches import Links, Patches, Turnover, clustering, link_patches, patches, turnover

__all__ = [
    "AgingSummary",
    "ContactMaps",
    "Distribution",
    "LegRow",
    "Links",
    "Observation",
    "PatchTracks",
    "Patches",
    "SiteState",
    "Turnover",
    "aging_summary",
    "clustering",
    "contact_ages",
    "contact_maps",
    "distributions",
    "leg_table",
    "link_patches",
    "observe",
    "patch_table",
    "patch_tracks",
    "patches",
    "turnover",
    "with_limit",
]
__dir__ = _answered(globals())
