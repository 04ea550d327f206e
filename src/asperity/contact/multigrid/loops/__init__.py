"""The loops of multigrid, compiled; `asperity.contact.multigrid.processor` calls them."""

from asperity.contact.multigrid.loops.one_field import CoarseOne, One
from asperity.contact.multigrid.loops.rows import Fields, Pair, Single, Sites
from asperity.contact.multigrid.loops.states import Measured, Past, Scales, Surface
from asperity.contact.multigrid.loops.two_fields import CoarseTwo, Two

__all__ = [
    "CoarseOne",
    "CoarseTwo",
    "Fields",
    "Measured",
    "One",
    "Pair",
    "Past",
    "Scales",
    "Single",
    "Sites",
    "Surface",
    "Two",
]
