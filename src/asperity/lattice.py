r"""The periodic lattice and its Fourier transforms: the only home of transform conventions.

Sites have spacing 1. A *spectrum* is a real array of shape `Lattice.spectral_shape` (the half
spectrum of a real field); it stands for the translation-invariant operator that multiplies each
Fourier mode by it. The nearest-neighbour Laplacian of the lattice is minus the operator with spectrum

    lam(q) = sum over axes of (2 - 2 cos q_axis),

which is the paper's :math:`-\nabla^2` (text below Eq. us; written q^2 there).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from asperity.errors import InputError

Field = NDArray[np.float64]
Spectrum = NDArray[np.float64]
Modes = NDArray[np.complex128]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Lattice:
    """A periodic lattice of one or two dimensions, of any length along each axis.

    Parameters
    ----------
    shape
        Number of sites along each axis: ``(n,)`` (line contact) or ``(n, m)``.
    """

    shape: tuple[int, ...]

    def __post_init__(self) -> None:
        if len(self.shape) not in (1, 2) or any(n < 1 for n in self.shape):
            raise InputError(
                "shape",
                expected="one or two positive lengths",
                got=self.shape,
                advice="(200, 200), or (4096,) for a line contact",
            )

    @property
    def dimension(self) -> int:
        """Number of axes: 1 or 2."""
        return len(self.shape)

    @cached_property
    def sites(self) -> int:
        """Number of sites N."""
        return math.prod(self.shape)

    @property
    def spectral_shape(self) -> tuple[int, ...]:
        """Shape of a spectrum."""
        return (*self.shape[:-1], self.shape[-1] // 2 + 1)

    @property
    def wave_numbers(self) -> tuple[Field, ...]:
        """Wave number along each axis, in radians per site, shaped to broadcast to a spectrum."""
        axes = [2 * np.pi * np.fft.fftfreq(n) for n in self.shape[:-1]]
        axes.append(2 * np.pi * np.fft.rfftfreq(self.shape[-1]))
        return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))

    @cached_property
    def lam(self) -> Spectrum:
        """Eigenvalues of minus the lattice Laplacian; from 0 to 4 per dimension."""
        # 4 sin^2(q/2) rather than 2 - 2 cos q: the same number without the cancellation at small q.
        return np.asarray(sum(4 * np.sin(q / 2) ** 2 for q in self.wave_numbers))

    @cached_property
    def multiplicity(self) -> Spectrum:
        """How many of the N modes each entry of a spectrum stands for (1 or 2), shape of a last axis."""
        n = self.shape[-1]
        count = np.full(n // 2 + 1, 2.0)
        count[0] = 1.0
        if n % 2 == 0:
            count[-1] = 1.0
        return count

    def mean_over_modes(self, spectrum: Spectrum) -> float:
        """Mean over all N modes: the diagonal element of the operator in real space."""
        return float(np.sum(spectrum * self.multiplicity)) / self.sites

    def forward(self, field: Field) -> Modes:
        """Fourier modes of a field; the entry at wave vector 0 is the sum over sites."""
        return np.asarray(scipy.fft.rfftn(field))

    def backward(self, modes: Modes) -> Field:
        """Field of given Fourier modes; the inverse of `forward`."""
        return np.asarray(scipy.fft.irfftn(modes, s=self.shape))

    def apply(self, spectrum: Spectrum, field: Field) -> Field:
        """Apply the operator that has this spectrum."""
        return self.backward(spectrum * self.forward(field))
