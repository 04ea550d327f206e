"""The loops of multigrid, compiled; `asperity.contact.multigrid.operations` calls them."""

from asperity.contact.multigrid.loops.one_field import CoarseOne as CoarseOne
from asperity.contact.multigrid.loops.one_field import One as One
from asperity.contact.multigrid.loops.rows import Fields as Fields
from asperity.contact.multigrid.loops.rows import Pair as Pair
from asperity.contact.multigrid.loops.rows import Single as Single
from asperity.contact.multigrid.loops.rows import Sites as Sites
from asperity.contact.multigrid.loops.states import Measured as Measured
from asperity.contact.multigrid.loops.states import Past as Past
from asperity.contact.multigrid.loops.states import Scales as Scales
from asperity.contact.multigrid.loops.states import Surface as Surface
from asperity.contact.multigrid.loops.two_fields import CoarseTwo as CoarseTwo
from asperity.contact.multigrid.loops.two_fields import Two as Two
