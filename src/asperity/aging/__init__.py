"""Aging: how a contact creeps (each implicit step is a contact problem), and where it ends."""

from asperity.aging.frames import Frame as Frame
from asperity.aging.march import creep as creep
from asperity.base.calls import answered as _answered

__dir__ = _answered(globals())
