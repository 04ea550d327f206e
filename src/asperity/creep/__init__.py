"""Local laws of creep, one a file."""

from asperity.creep.eyring import Eyring
from asperity.creep.garofalo import Garofalo
from asperity.creep.law import LocalCreep, checked_law
from asperity.creep.norton import Norton
from asperity.creep.own import CreepLaw

LAWS: dict[str, type[LocalCreep]] = {law.__name__.lower(): law for law in (Eyring, Norton, Garofalo)}
"""Laws by their name in a configuration."""

__all__ = [
    "LAWS",
    "CreepLaw",
    "Eyring",
    "Garofalo",
    "LocalCreep",
    "Norton",
    "checked_law",
]
