"""Heights of rough surfaces: made at random, or measured; and what a surface measures."""

from asperity.surfaces.heights import check_heights
from asperity.surfaces.measured import Surface, read
from asperity.surfaces.self_affine import self_affine
from asperity.surfaces.statistics import Statistics, statistics
from asperity.surfaces.uncorrelated import exponential, gaussian

__all__ = [
    "Statistics",
    "Surface",
    "check_heights",
    "exponential",
    "gaussian",
    "read",
    "self_affine",
    "statistics",
]


def __dir__() -> list[str]:
    """List the public names."""
    return __all__
