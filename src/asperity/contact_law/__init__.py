"""Contact laws: approach, stiffness and conductance against pressure and age, for other programs."""

from asperity.base.calls import answered as _answered
from asperity.contact_law.laws import law
from asperity.contact_law.programs import closure_fits, law_for

__all__ = ["closure_fits", "law", "law_for"]
__dir__ = _answered(globals())
