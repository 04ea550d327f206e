"""Solids whose surface is elastic and creeps."""

from collections.abc import Callable, Mapping

from asperity import adhesion, creep
from asperity.adhesion import Adhesion, Dugdale
from asperity.base.calls import answered as _answered
from asperity.base.parameters import Law, parameters_of
from asperity.creep import CreepLaw, Eyring, Garofalo, LocalCreep, Norton
from asperity.solids.coating import coated_half_space
from asperity.solids.continua import contact_modulus, half_space, layer
from asperity.solids.laws import (
    LaplacianSpectrum,
    LayerSpectrum,
    PowerMobility,
    WaveNumberSpectrum,
)
from asperity.solids.solid import CreepBranch, Solid, Spectra, Springs
from asperity.solids.springs import spring_lattice

__all__ = [
    "Adhesion",
    "CreepBranch",
    "CreepLaw",
    "Dugdale",
    "Eyring",
    "Garofalo",
    "LaplacianSpectrum",
    "LayerSpectrum",
    "LocalCreep",
    "Norton",
    "PowerMobility",
    "Solid",
    "Spectra",
    "Springs",
    "WaveNumberSpectrum",
    "coated_half_space",
    "contact_modulus",
    "half_space",
    "layer",
    "spring_lattice",
]
KINDS: dict[str, Callable[..., Solid]] = {
    make.__name__: make for make in (spring_lattice, half_space, layer, coated_half_space)
}
"""What makes solids, by the kind in a configuration; annotated arguments are its keys."""

LAWS: dict[str, Mapping[str, type[Law]]] = {"creep": creep.LAWS, "adhesion": adhesion.LAWS}
"""Laws that a solid may have, by the argument that takes one, and by their names in a configuration."""

PARAMETERS_OF_LAWS = {
    f"{argument}_{name}": parameter.quantity
    for argument, laws in LAWS.items()
    for law in laws.values()
    for name, parameter in parameters_of(law).items()
}
"""What the parameters of all laws are, by the names under which they are recorded, which are their keys."""

__dir__ = _answered(globals())
