"""How maps of the contact mark a site: one color for each state."""

from __future__ import annotations

from asperity.analysis import SiteState
from asperity.figures import style

COLORS = {SiteState.KEPT: style.INK, SiteState.NEW: style.VERMILION, SiteState.LOST: style.SKY}
"""They differ from each other, and from white, in luminance too."""
