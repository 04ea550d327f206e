"""What a contact carries: how it resists more load and shear, what it conducts, and where it slips."""

from asperity.base.calls import answered as _answered
from asperity.carried.record import Carried
from asperity.carried.response import check_half_space

__all__ = ["Carried", "check_half_space"]
__dir__ = _answered(globals())
