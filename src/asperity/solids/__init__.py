"""Solids whose surface is elastic and creeps."""

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
    "CreepBranch",
    "CreepLaw",
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
__dir__ = _answered(globals())
