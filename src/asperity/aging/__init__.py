"""Aging: how a contact creeps (each implicit step is a contact problem), and where it ends."""

from asperity.aging.frames import Frame
from asperity.aging.march import creep

__all__ = ["Frame", "creep"]
__dir__ = __all__.copy  # dir() lists the public names alone
