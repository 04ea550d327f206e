"""Aging: how a contact creeps (each implicit step is a contact problem), and where it ends."""

from asperity.aging.creep import Frame, creep
from asperity.aging.relax import relax

__all__ = ["Frame", "creep", "relax"]
