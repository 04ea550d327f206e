"""Surfaces whose sites are independent: Gaussian and exponential heights.

The paper's first case (E. A. Jagla, "Towards a modeling of the time dependence of contact area between
solid bodies", section "The Model"): the heights xi(r) are drawn independently for each site from one
distribution. The paper draws from the Gaussian. For exponential heights the theory of dilute contacts
is simplest: the ratio A(t)/A(0) does not depend on the load.
"""

from __future__ import annotations

from asperity.base import checks
from asperity.lattice import Field
from asperity.surfaces.making import Rms, Rng, Seed, Shape, in_unit


@in_unit
def gaussian(shape: Shape, *, rms: Rms = 1.0, seed: Seed = 0, rng: Rng = None) -> Field:
    """Draw independent Gaussian heights of mean 0.

    Parameters
    ----------
    shape
        Sites along each axis: ``(n, m)``, or ``n`` or ``(n,)`` for a profile.
    rms
        Standard deviation of the heights, in their unit.
    seed
        Seed of the random numbers; the same seed gives the same surface.
    rng
        In place of the seed: a numpy generator, which advances, or its seed.
    unit
        Unit of all lengths, such as ``"um"``; they may then be texts with a unit, such as ``"50 nm"``.
    pixel_size
        Beside a unit, the distance between sites: one number, or one an axis; by default 1.

    Returns
    -------
    ndarray of float64, of the given shape; with a unit a `Surface`

    Raises
    ------
    InputError
        The shape is not one or two positive integers, or a number is out of range.
    """
    lengths, width = checks.lattice_shape(shape), checks.number("rms", rms, above=0)
    return checks.generator(seed, rng).normal(scale=width, size=lengths)


@in_unit
def exponential(shape: Shape, *, rms: Rms = 1.0, seed: Seed = 0, rng: Rng = None) -> Field:
    """Draw independent heights of the density ``P(xi) = exp(-xi / rms) / rms`` for ``xi >= 0``.

    Their standard deviation is `rms`, and so is their mean: the mean is not removed. Arguments, result and
    errors are those of `gaussian`.
    """
    lengths, width = checks.lattice_shape(shape), checks.number("rms", rms, above=0)
    return checks.generator(seed, rng).exponential(scale=width, size=lengths)
