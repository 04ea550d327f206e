"""Contact: one problem (Signorini), one file a solver, and the states that come out."""

from asperity.base.calls import answered as _answered
from asperity.contact.active_set import ActiveSet as ActiveSet
from asperity.contact.contact import Contact as Contact
from asperity.contact.controls import Control as Control
from asperity.contact.controls import Load as Load
from asperity.contact.controls import Separation as Separation
from asperity.contact.multigrid import Multigrid as Multigrid

__dir__ = _answered(globals())
