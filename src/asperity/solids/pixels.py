"""What an even pressure on one pixel does to a half-space, and how the pixels of a free body add up."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy.fft

from asperity.lattice import Field, Lattice, Spectrum


@lru_cache(maxsize=1)
def compliance_of_pixels(lattice: Lattice) -> Spectrum:
    r"""Displacement of a half-space by even pressures on pixels, as a spectrum; times E* over the pressure.

    A unit of pressure on one pixel displaces the surface of a half-space at a distance (y, x) by the integral
    of 1 / (pi E* r) over the pixel, which has a closed form (A. E. H. Love, Phil. Trans. R. Soc. A 228, 377
    (1929), DOI 10.1098/rsta.1929.0009). Along each axis of the embedding the distance is that to the
    nearest image, and the body covers less than half of it: so within the body sums of these are those of an
    infinite half-space. That the sums in the empty space are of nothing real does no harm, as it has neither
    forces nor heights.

    Parameters
    ----------
    lattice
        An embedding in two dimensions.

    Returns
    -------
    Spectrum
        Length; positive.
    """
    corners = (
        (np.arange(n // 2 + 2) - 0.5) * side for n, side in zip(lattice.shape, lattice.spacing, strict=True)
    )
    integral = _from_origin(*np.meshgrid(*corners, indexing="ij", sparse=True))
    near = np.diff(np.diff(integral, axis=0), axis=1) / np.pi
    for axis, n in enumerate(lattice.shape):  # and the same at the distances before the next image
        mirrored = np.flip(np.take(near, np.arange(1, (n + 1) // 2), axis), axis)
        near = np.concatenate((near, mirrored), axis)
    return np.ascontiguousarray(scipy.fft.rfftn(near).real)


def _from_origin(y: Field, x: Field) -> Field:
    """Integral of 1 / r over the rectangle between the origin and (y, x)."""
    return np.asarray(x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y)))
