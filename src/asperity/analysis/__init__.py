"""Analysis of a history: growth of the contact area, patches and maps of contact, legs, the relaxed limit."""

from asperity.analysis.aging import AgingSummary, aging_summary, with_limit
from asperity.analysis.contact_law import law
from asperity.analysis.field_values import Distribution, distributions
from asperity.analysis.law_words import closure_fits, law_for
from asperity.analysis.legs import LegRow, leg_table
from asperity.analysis.maps import ContactMaps, SiteState, contact_maps
from asperity.analysis.observation import Observation, observe
from asperity.analysis.predicting import predict
from asperity.analysis.prediction import Growth, Prediction
from asperity.analysis.tracks import PatchTracks, contact_ages, patch_table, patch_tracks
from asperity.base.calls import answered as _answered
from asperity.contact.remarks import Resolved
from asperity.patches import Links, Patches, Turnover, clustering, link_patches, patches, turnover

__all__ = [
    "AgingSummary",
    "ContactMaps",
    "Distribution",
    "Growth",
    "LegRow",
    "Links",
    "Observation",
    "PatchTracks",
    "Patches",
    "Prediction",
    "Resolved",
    "SiteState",
    "Turnover",
    "aging_summary",
    "closure_fits",
    "clustering",
    "contact_ages",
    "contact_maps",
    "distributions",
    "law",
    "law_for",
    "leg_table",
    "link_patches",
    "observe",
    "patch_table",
    "patch_tracks",
    "patches",
    "predict",
    "turnover",
    "with_limit",
]
__dir__ = _answered(globals())
