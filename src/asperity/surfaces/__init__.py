"""Heights of surfaces: made at random, measured, or of single asperities; and what a surface measures."""

from collections.abc import Callable
from typing import Any

from asperity.base.calls import answered as _answered
from asperity.surfaces.asperities import array, paraboloid, punch, sphere
from asperity.surfaces.heights import check_heights
from asperity.surfaces.measured import read
from asperity.surfaces.midpoints import self_affine
from asperity.surfaces.moments import Statistics, statistics
from asperity.surfaces.random_phase import from_spectrum, spectral
from asperity.surfaces.spectrum import PowerSpectrum, SelfAffineRange, power_spectrum
from asperity.surfaces.spectrum_files import read_spectrum
from asperity.surfaces.surface import Surface, check_square, combined
from asperity.surfaces.uncorrelated import exponential, gaussian

__all__ = [
    "PowerSpectrum",
    "SelfAffineRange",
    "Statistics",
    "Surface",
    "array",
    "check_heights",
    "check_square",
    "combined",
    "exponential",
    "from_spectrum",
    "gaussian",
    "paraboloid",
    "power_spectrum",
    "punch",
    "read",
    "read_spectrum",
    "self_affine",
    "spectral",
    "sphere",
    "statistics",
]
_AT_RANDOM: tuple[Any, ...] = (gaussian, exponential, self_affine, spectral, from_spectrum)
_ALONE: tuple[Any, ...] = (sphere, paraboloid, punch, array)
KINDS: dict[str, Callable[..., Any]] = {
    make.__name__.removeprefix("from_"): make for make in (*_AT_RANDOM, *_ALONE)
}
KINDS["file"] = read
"""What makes surfaces, by the kind in a configuration; annotated arguments are its keys."""

__dir__ = _answered(globals())
