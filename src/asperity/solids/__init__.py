"""Solids whose surface is elastic and creeps."""

from collections.abc import Callable

from asperity.adhesion import Adhesion, Dugdale
from asperity.base.calls import answered as _answered
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

__dir__ = _answered(globals())
