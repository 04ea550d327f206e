"""Carried quantities of a contact: stiffness, resistance, partial slip and pull-off."""

from asperity.ask.carried import Carried as Carried
from asperity.base.calls import answered as _answered
from asperity.carried.pull_off import PullOff as PullOff
from asperity.carried.response import check_half_space as check_half_space

__dir__ = _answered(globals())
