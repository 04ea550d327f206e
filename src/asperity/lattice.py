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
from typing import Any, TypeVar

import numpy as np
import scipy.fft
from array_api_compat import array_namespace
from numpy.typing import NDArray

import asperity.checks as checks

Field = NDArray[np.float64]
Spectrum = NDArray[np.float64]
Modes = NDArray[np.complex128]
Mask = NDArray[np.bool_]
ModesOrSpectrum = TypeVar("ModesOrSpectrum", Modes, Spectrum)


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
        object.__setattr__(self, "shape", checks.lattice_shape(self.shape))

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
        foreign = _foreign_transforms(field)
        modes: Modes = foreign.rfftn(field) if foreign else scipy.fft.rfftn(field)
        return modes

    def backward(self, modes: Modes, *, overwrite: bool = False) -> Field:
        """Field of given Fourier modes, which may be overwritten; the inverse of `forward`."""
        foreign = _foreign_transforms(modes)
        field: Field
        if foreign:
            field = foreign.irfftn(modes, s=self.shape, axes=tuple(range(self.dimension)))
            return field
        # One axis after the other: scipy.fft.irfftn would copy the modes once more, which takes longer
        # than the transform (`apply` at 1024 x 1024: 17 ms instead of 11).
        if self.dimension > 1:
            modes = scipy.fft.ifft(modes, axis=0, overwrite_x=overwrite)
        field = scipy.fft.irfft(modes, n=self.shape[-1], axis=-1)
        return field

    def apply(self, spectrum: Spectrum, field: Field) -> Field:
        """Apply the operator that has this spectrum; in single precision if both are."""
        modes = self.forward(field)
        modes *= spectrum
        return self.backward(modes, overwrite=True)

    def long_waves(self, modes: ModesOrSpectrum, coarse: Lattice) -> ModesOrSpectrum:
        """Those of the modes, or of a spectrum, that a coarser lattice has too, in its order."""
        kept = modes[..., : coarse.spectral_shape[-1]]
        if self.dimension == 1:
            return kept + 0
        n = coarse.shape[0]
        rows = (kept[: (n + 1) // 2, :], kept[self.shape[0] - n // 2 :, :])
        long: ModesOrSpectrum = array_namespace(modes).concat(rows)
        return long

    def add_long_waves(self, modes: Modes, long: Modes, coarse: Lattice) -> None:
        """Add the modes of a coarser lattice, of odd lengths, to those of this one, in place."""
        last = coarse.spectral_shape[-1]
        if self.dimension == 1:
            modes[:last] += long
            return
        n = coarse.shape[0]
        modes[: (n + 1) // 2, :last] += long[: (n + 1) // 2, :]
        modes[self.shape[0] - n // 2 :, :last] += long[(n + 1) // 2 :, :]


def _foreign_transforms(array: object) -> Any:
    """The transforms of the array's own library; None for numpy, which has scipy's."""
    return None if isinstance(array, np.ndarray) else array_namespace(array).fft
