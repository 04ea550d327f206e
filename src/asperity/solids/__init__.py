"""Solids whose surface is elastic and creeps."""

from collections.abc import Callable as _Callable
from collections.abc import Mapping as _Mapping

from asperity import adhesion, creep
from asperity.adhesion import Adhesion as Adhesion
from asperity.adhesion import Dugdale as Dugdale
from asperity.base.calls import answered as _answered
from asperity.base.parameters import Law as _Law
from asperity.base.parameters import parameters_of as _parameters_of
from asperity.creep import CreepLaw as CreepLaw
from asperity.creep import Eyring as Eyring
from asperity.creep import Garofalo as Garofalo
from asperity.creep import LocalCreep as LocalCreep
from asperity.creep import Norton as Norton
from asperity.solids.coating import coated_half_space as coated_half_space
from asperity.solids.continua import contact_modulus as contact_modulus
from asperity.solids.continua import half_space as half_space
from asperity.solids.continua import layer as layer
from asperity.solids.laws import LaplacianSpectrum as LaplacianSpectrum
from asperity.solids.laws import LayerSpectrum as LayerSpectrum
from asperity.solids.laws import PowerMobility as PowerMobility
from asperity.solids.laws import WaveNumberSpectrum as WaveNumberSpectrum
from asperity.solids.solid import CreepBranch as CreepBranch
from asperity.solids.solid import Solid as Solid
from asperity.solids.solid import Spectra as Spectra
from asperity.solids.solid import Springs as Springs
from asperity.solids.springs import spring_lattice as spring_lattice

KINDS: dict[str, _Callable[..., Solid]] = {
    make.__name__: make for make in (spring_lattice, half_space, layer, coated_half_space)
}
"""What makes solids, by the kind in a configuration; annotated arguments are its keys."""

LAWS: dict[str, _Mapping[str, type[_Law]]] = {"creep": creep.LAWS, "adhesion": adhesion.LAWS}
"""Laws that a solid may have, by the argument that takes one, and by their names in a configuration."""

PARAMETERS_OF_LAWS = {
    f"{argument}_{name}": parameter.quantity
    for argument, laws in LAWS.items()
    for law in laws.values()
    for name, parameter in _parameters_of(law).items()
}
"""What the parameters of all laws are, by the names under which they are recorded, which are their keys."""

__dir__ = _answered(globals())
