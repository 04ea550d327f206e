"""Local laws of creep, one a file."""

from asperity.creep.eyring import Eyring as Eyring
from asperity.creep.garofalo import Garofalo as Garofalo
from asperity.creep.law import LocalCreep as LocalCreep
from asperity.creep.law import checked_law as checked_law
from asperity.creep.norton import Norton as Norton
from asperity.creep.own import CreepLaw as CreepLaw

LAWS: dict[str, type[LocalCreep]] = {law.__name__.lower(): law for law in (Eyring, Norton, Garofalo)}
"""Laws by their name in a configuration."""
