"""Local laws of creep, one a file."""

from asperity.base.parameters import parameters_of
from asperity.creep.eyring import Eyring
from asperity.creep.garofalo import Garofalo
from asperity.creep.law import LocalCreep, checked_law
from asperity.creep.norton import Norton
from asperity.creep.own import CreepLaw

LAWS: dict[str, type[LocalCreep]] = {law.__name__.lower(): law for law in (Eyring, Norton, Garofalo)}
"""Laws by their name in a configuration."""

PARAMETERS_OF_LAWS = {
    f"creep_{name}": parameter.quantity
    for law in LAWS.values()
    for name, parameter in parameters_of(law).items()
}
"""What the parameters of all laws are, by the names under which they are recorded, which are their keys."""

__all__ = [
    "LAWS",
    "PARAMETERS_OF_LAWS",
    "CreepLaw",
    "Eyring",
    "Garofalo",
    "LocalCreep",
    "Norton",
    "checked_law",
]
