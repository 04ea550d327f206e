"""Analysis of a history: growth of the contact area, patches and maps of contact, legs, the relaxed limit."""

from asperity.analysis.aging import AgingSummary as AgingSummary
from asperity.analysis.aging import aging_summary as aging_summary
from asperity.analysis.aging import with_limit as with_limit
from asperity.analysis.field_values import Distribution as Distribution
from asperity.analysis.field_values import distributions as distributions
from asperity.analysis.legs import LegRow as LegRow
from asperity.analysis.legs import leg_table as leg_table
from asperity.analysis.maps import ContactMaps as ContactMaps
from asperity.analysis.maps import SiteState as SiteState
from asperity.analysis.maps import contact_maps as contact_maps
from asperity.analysis.observation import Observation as Observation
from asperity.analysis.observation import observe as observe
from asperity.analysis.tracks import PatchTracks as PatchTracks
from asperity.analysis.tracks import contact_ages as contact_ages
from asperity.analysis.tracks import patch_table as patch_table
from asperity.analysis.tracks import patch_tracks as patch_tracks
from asperity.base.calls import answered as _answered
from asperity.patches import Links as Links
from asperity.patches import Patches as Patches
from asperity.patches import Turnover as Turnover
from asperity.patches import clustering as clustering
from asperity.patches import link_patches as link_patches
from asperity.patches import patches as patches
from asperity.patches import turnover as turnover

__dir__ = _answered(globals())
