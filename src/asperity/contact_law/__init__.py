"""Contact laws: approach, stiffness and conductance against pressure and age, for other programs."""

from asperity.base.calls import answered as _answered
from asperity.contact_law.laws import law as law
from asperity.contact_law.programs import closure_fits as closure_fits
from asperity.contact_law.programs import law_for as law_for

__dir__ = _answered(globals())
