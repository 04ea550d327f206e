"""Contact: one problem (Signorini), one file a solver, and the states that come out."""

from asperity.base.calls import answered as _answered
from asperity.contact.active_set import ActiveSet
from asperity.contact.contact import Contact
from asperity.contact.controls import Control, Load, Separation
from asperity.contact.multigrid import Multigrid

__all__ = ["ActiveSet", "Contact", "Control", "Load", "Multigrid", "Separation"]
__dir__ = _answered(globals())
