"""Aging: how a contact creeps (each implicit step is a contact problem), and where it ends."""

from asperity.aging.limit import relax
from asperity.aging.loops import compile_loops
from asperity.aging.march import Frame, creep

__all__ = ["Frame", "compile_loops", "creep", "relax"]


def __dir__() -> list[str]:
    """List the public names."""
    return __all__
