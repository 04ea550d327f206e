"""Heights of surfaces: made at random, measured, or of single asperities; and what a surface measures."""

from collections.abc import Callable as _Callable
from typing import Any as _Any

from asperity.base.calls import answered as _answered
from asperity.surfaces.asperities import array as array
from asperity.surfaces.asperities import paraboloid as paraboloid
from asperity.surfaces.asperities import punch as punch
from asperity.surfaces.asperities import sphere as sphere
from asperity.surfaces.heights import check_heights as check_heights
from asperity.surfaces.measured import read as read
from asperity.surfaces.midpoints import self_affine as self_affine
from asperity.surfaces.moments import Statistics as Statistics
from asperity.surfaces.moments import statistics as statistics
from asperity.surfaces.random_phase import from_spectrum as from_spectrum
from asperity.surfaces.random_phase import spectral as spectral
from asperity.surfaces.spectrum import PowerSpectrum as PowerSpectrum
from asperity.surfaces.spectrum import SelfAffineRange as SelfAffineRange
from asperity.surfaces.spectrum import power_spectrum as power_spectrum
from asperity.surfaces.spectrum_files import read_spectrum as read_spectrum
from asperity.surfaces.surface import Surface as Surface
from asperity.surfaces.surface import check_square as check_square
from asperity.surfaces.surface import combined as combined
from asperity.surfaces.uncorrelated import exponential as exponential
from asperity.surfaces.uncorrelated import gaussian as gaussian

_AT_RANDOM: tuple[_Any, ...] = (gaussian, exponential, self_affine, spectral, from_spectrum)
_ALONE: tuple[_Any, ...] = (sphere, paraboloid, punch, array)
KINDS: dict[str, _Callable[..., _Any]] = {
    make.__name__.removeprefix("from_"): make for make in (*_AT_RANDOM, *_ALONE)
}
KINDS["file"] = read
"""What makes surfaces, by the kind in a configuration; annotated arguments are its keys."""

__dir__ = _answered(globals())
