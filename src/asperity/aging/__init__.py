"""Aging: how a contact creeps (each implicit step is a contact problem), and where it ends."""

from asperity.aging.march import Frame, creep

__all__ = ["Frame", "creep"]
__dir__ = __all__.copy  # dir() lists the public names alone
