r"""Self-affine surfaces by successive random midpoints.

The paper's second case (E. A. Jagla, "Towards a modeling of the time dependence of contact area between
solid bodies", section "Results for Self-Affine Surfaces", after Voss). On a periodic mesh of L x L sites,
all corners start at 0. The center of each square gets

    xi(center) = mean of xi at its four corners + N(0, (l^H delta)^2),

where l is the distance from center to corner: L/sqrt(2) at first. The centers become corners of squares
turned by 45 degrees, with l smaller by sqrt(2); and so on, down to l = 1, when every site has its height.
As in the paper, only the new centers get a random value at each step. In the *successive random additions*
that Voss preferred the old corners move, too.

The increments of the surface grow as :math:`\langle[\xi(r) - \xi(0)]^2\rangle \sim r^{2H}` for distances
between the mesh and L. Finite surfaces approach this from below: for H = 1/2 half the slope fitted to one
surface is about 0.45 at L = 256 and 0.48 at L = 2048.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from annotated_types import Gt, Le

from asperity.base import checks
from asperity.base.parameters import Also, Quantity
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.surfaces.making import MOST_SITES, Rng, Seed, in_unit


def power_of_two(name: str, value: int) -> int:
    """Refuse lengths that are no power of two with `InputError`."""
    expected = "a power of two, 2 or more"
    length = checks.integer(name, value, least=2, expected=expected, advice="256")
    if length & (length - 1):
        below = 1 << (length.bit_length() - 1)
        raise InputError(name, expected=expected, got=length, advice=f"{below} or {2 * below}")
    return length


@in_unit
def self_affine(
    size: Annotated[
        int,
        *(Le(MOST_SITES), Also(power_of_two)),
        Quantity("sites along each axis, a power of two.", dimension="sites", usual=256),
    ],
    *,
    hurst: Annotated[float, Gt(0), Le(1), Quantity("Hurst exponent")] = 0.5,
    delta: Annotated[
        float, Gt(0), Quantity("roughness at the scale of the lattice", dimension="height unit")
    ] = 0.01,
    seed: Seed = 0,
    rng: Rng = None,
) -> Field:
    """Make a periodic self-affine surface by successive random midpoints.

    Parameters
    ----------
    size
        Sites along each of the two axes, L: a power of two, 2 or more.
    hurst
        Hurst exponent H, above 0 and up to 1.
    delta
        Roughness at the scale of the mesh, Delta: the width of the random values at l = 1, in the unit of
        the heights.
    seed, rng, unit, pixel_size
        As in `gaussian`.

    Returns
    -------
    ndarray of float64, shape (size, size); with a unit a `Surface`
        The heights; the corner ``[0, 0]`` is 0. The mean is not removed.

    Raises
    ------
    InputError
        A number is out of range, or the size is not a power of two.
    """
    length = power_of_two("size", size)
    exponent = checks.number("hurst", hurst, above=0, most=1)
    width = checks.number("delta", delta, above=0)
    random = checks.generator(seed, rng)

    def noise(distance: float) -> Field:
        """Random values for new centers at this distance from their corners: width l^H delta."""
        return random.normal(scale=distance**exponent * width, size=corners.shape)

    xi = np.zeros((length, length))
    step = length  # side of the squares whose corners are known
    while step > 1:
        half = step // 2
        corners = xi[::step, ::step]
        pairs = corners + np.roll(corners, -1, axis=0)
        centers = (pairs + np.roll(pairs, -1, axis=1)) / 4 + noise(step / math.sqrt(2))
        xi[half::step, half::step] = centers
        # Squares turned by 45 degrees have two old corners and two new centers around the middle of an edge.
        across = (pairs + centers + np.roll(centers, 1, axis=1)) / 4
        along = (corners + np.roll(corners, -1, axis=1) + centers + np.roll(centers, 1, axis=0)) / 4
        xi[half::step, ::step] = across + noise(half)
        xi[::step, half::step] = along + noise(half)
        step = half
    return xi
