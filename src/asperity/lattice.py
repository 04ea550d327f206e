r"""The lattice of sites and its Fourier transforms: the only home of transform conventions.

A *spectrum* is a real array of shape `Lattice.spectral_shape`; it stands for the operator that
multiplies each Fourier mode by it. On a periodic lattice modes are the half spectrum of a real field. Where
edges reflect, they are cosines (the transform DCT-II): those of the lattice joined to its mirror
images, which has four times the sites. A body with free edges ends there: it is one part of a periodic
lattice, `Lattice.embedding`, whose other sites are empty space. The nearest-neighbour Laplacian is minus the
operator with spectrum

    lam(q) = sum over axes of (2 - 2 cos q_axis),        q in radians per site,

which is the paper's :math:`-\nabla^2` (text below Eq. us; written q^2 there).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal, TypeVar

import numpy as np
import scipy
from numpy.typing import NDArray

from asperity.base import checks
from asperity.base.machine import usual_threads
from asperity.errors import InputError

Field = NDArray[np.float64]
Spectrum = NDArray[np.float64]
Modes = NDArray[np.complex128]
Mask = NDArray[np.bool_]
ModesOrSpectrum = TypeVar("ModesOrSpectrum", Modes, Spectrum)
Edges = Literal["periodic", "reflecting", "free"]

_COARSEST = 32
"""Shortest body, sites, whose embedding can be halved."""

_WORTH_SHARING = 2**19
"""Sites from which a second thread speeds up transforms."""


@dataclass(frozen=True)
class Lattice:
    """A lattice of one or two dimensions, of any length along each axis.

    Parameters
    ----------
    shape
        Number of sites along each axis: ``(n,)`` (line contact) or ``(n, m)``.
    spacing
        Distance between sites along each axis, in any unit of length; by default 1.
    edges
        Periodic, reflecting (mirror image beyond the edges) or free (the body ends).
    body
        Of an `embedding`: number of sites along each axis, from the first, that a body with free edges has.
    """

    shape: tuple[int, ...]
    spacing: tuple[float, ...] = ()
    edges: Edges = "periodic"
    body: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "shape", checks.lattice_shape(self.shape))
        spacing = tuple(checks.positive("spacing", self.spacing or (1.0,) * len(self.shape)).tolist())
        if len(spacing) != len(self.shape):
            raise InputError("spacing", expected=f"{len(self.shape)} lengths, one an axis", got=self.spacing)
        object.__setattr__(self, "spacing", spacing)

    @property
    def dimension(self) -> int:
        """Number of axes: 1 or 2."""
        return len(self.shape)

    @cached_property
    def sites(self) -> int:
        """Number of sites N."""
        return math.prod(self.shape)

    @property
    def cell(self) -> float:
        """Area that belongs to a site; in one dimension its length."""
        return math.prod(self.spacing)

    @property
    def reflecting(self) -> bool:
        """Whether edges reflect."""
        return self.edges == "reflecting"

    @cached_property
    def embedding(self) -> Lattice:
        """The lattice on which fields are transformed: of free edges a periodic one, else itself.

        At least twice as long along each axis, so that no image of the body reaches the body (R. W. Hockney,
        Methods Comput. Phys. 9, 135 (1970)), and quick to transform and to halve.
        """
        if self.edges != "free":
            return self
        halvings = max(0, int(math.log2(min(self.shape) / _COARSEST)))
        lengths = (
            2**halvings * scipy.fft.next_fast_len(-(-2 * n // 2**halvings), real=True) for n in self.shape
        )
        return Lattice(tuple(lengths), self.spacing, body=self.shape)

    def cut(self, field: Any) -> Any:
        """The part of one or several fields on the body."""
        return field[(..., *map(slice, self.body))] if self.body else field

    def extended(self, field: Any, beyond: float) -> Any:
        """One or several fields over the body, extended by a number in the empty space."""
        if not self.body:
            return field
        whole = np.full((*field.shape[: -self.dimension], *self.shape), beyond, dtype=field.dtype)
        self.cut(whole)[...] = field
        return whole

    @property
    def spectral_shape(self) -> tuple[int, ...]:
        """Shape of a spectrum."""
        return self.shape if self.reflecting else (*self.shape[:-1], self.shape[-1] // 2 + 1)

    @property
    def mean(self) -> tuple[Any, ...]:
        """Index of wave vector 0 in spectra and modes, one or several."""
        return (..., *(0,) * self.dimension)

    @property
    def angles(self) -> tuple[Field, ...]:
        """Wave number along each axis, in radians per site, shaped to broadcast to a spectrum."""
        if self.reflecting:
            axes: list[Any] = [np.pi * np.arange(n) / n for n in self.shape]
        else:
            axes = [2 * np.pi * np.fft.fftfreq(n) for n in self.shape[:-1]]
            axes.append(2 * np.pi * np.fft.rfftfreq(self.shape[-1]))
        return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))

    @property
    def wave_number(self) -> Spectrum:
        """Magnitude of the wave vector, radians per unit of length; `InputError` where a body ends."""
        self._check_endless()
        squares = ((angle / length) ** 2 for angle, length in zip(self.angles, self.spacing, strict=True))
        return np.sqrt(sum(squares))

    @cached_property
    def lam(self) -> Spectrum:
        """Eigenvalues of minus the lattice Laplacian; from 0 to 4 per dimension. Errors as `wave_number`."""
        self._check_endless()
        # 4 sin^2(q/2) rather than 2 - 2 cos q: the same number without the cancellation at small q.
        return np.asarray(sum(4 * np.sin(q / 2) ** 2 for q in self.angles))

    def _check_endless(self) -> None:
        if self.body or self.edges == "free":
            raise InputError(
                "edges",
                expected="'periodic' or 'reflecting' for this solid: it has no closed form where a body ends",
                got="'free'",
                advice="a half-space that is elastic, has branches, or a law of creep without permanent",
            )

    @cached_property
    def multiplicity(self) -> Spectrum:
        """Number of modes, 1 or 2, for which each entry of a spectrum stands; shape of the last axis."""
        n = self.shape[-1]
        if self.reflecting:
            return np.ones(n)
        count = np.full(n // 2 + 1, 2.0)
        count[0] = 1.0
        if n % 2 == 0:
            count[-1] = 1.0
        return count

    def mean_over_modes(self, spectrum: Spectrum) -> float:
        """Mean over all N modes: the diagonal element of the operator in real space."""
        return float(np.sum(spectrum * self.multiplicity)) / self.sites

    def forward(self, field: Field) -> Modes:
        """Fourier modes of a field, or of several; the entry at wave vector 0 is the sum over sites."""
        axes, threads = tuple(range(-self.dimension, 0)), self._threads
        foreign = _foreign_transforms(field)
        if self.reflecting:
            if foreign:  # array libraries have no cosine transforms
                expected, got = "numpy arrays where edges reflect", type(field).__module__
                raise InputError("edges", expected=expected, got=got, advice="'periodic'")
            cosines: Modes = np.asarray(scipy.fft.dctn(field, axes=axes, norm="ortho", workers=threads))
            cosines *= cosines.dtype.type(math.sqrt(self.sites))
            return cosines
        modes: Modes = (
            foreign.rfftn(field, axes=axes) if foreign else scipy.fft.rfftn(field, axes=axes, workers=threads)
        )
        return modes

    def forward_near(self, field: Field, near: Field, modes: Modes) -> Modes:
        """Fourier modes of a field from those of a near one, with their difference in single precision."""
        xp = namespace(field)
        change = field - near
        scale = float(xp.max(xp.abs(change)))
        if not 0 < scale < math.inf:
            return modes + scale
        return modes + scale * self.forward(xp.astype(change / scale, xp.float32))

    def backward(self, modes: Modes, *, overwrite: bool = False) -> Field:
        """Inverse of `forward`; may overwrite the modes."""
        axes, threads = tuple(range(-self.dimension, 0)), self._threads
        field: Field
        if self.reflecting:
            modes = modes * modes.dtype.type(1 / math.sqrt(self.sites))
            inverse: Any = scipy.fft.idctn
            field = inverse(modes, axes=axes, norm="ortho", overwrite_x=True, workers=threads)
            return field
        if foreign := _foreign_transforms(modes):
            field = foreign.irfftn(modes, s=self.shape, axes=axes)
            return field
        # One axis after the other: irfftn would copy the modes (`apply` at 1024 x 1024: 17 ms, not 11).
        if self.dimension > 1:
            modes = scipy.fft.ifft(modes, axis=-2, overwrite_x=overwrite, workers=threads)
        field = scipy.fft.irfft(modes, n=self.shape[-1], axis=-1, workers=threads)
        return field

    @property
    def _threads(self) -> int:
        return usual_threads() if self.sites >= _WORTH_SHARING else 1

    def flat_modes(self, level: float) -> Modes:
        """Fourier modes of a flat field."""
        modes = np.zeros(self.spectral_shape, dtype=float if self.reflecting else complex)
        modes.flat[0] = self.sites * level
        return modes

    def apply(self, spectrum: Spectrum | Modes, field: Field) -> Field:
        """Apply the operator with this spectrum; in single precision if both arrays are.

        A complex spectrum, of an operator that is not symmetric, is that of positive wave vectors of the last
        axis; its conjugate belongs to the others.
        """
        modes = self.forward(field)
        modes *= spectrum
        return self.backward(modes, overwrite=True)

    def length_of(self, sites: Sequence[float]) -> float:
        """Length of a vector of sites along each axis."""
        return math.hypot(*(n * length for n, length in zip(sites, self.spacing, strict=True)))

    def shifted(self, field: Field, shift: Sequence[Fraction | float]) -> Field:
        """A field moved by a number of sites along each axis, around periodic edges.

        Whole sites are a permutation. A shift by a part of a site turns the phase of each Fourier mode. The
        shortest wave of an axis of even length is multiplied by the cosine of its phase.
        """
        whole = [round(sites) for sites in shift]
        moved = np.roll(field, whole, axis=tuple(range(-self.dimension, 0)))
        rest = [float(sites - n) for sites, n in zip(shift, whole, strict=True)]
        if not any(rest):
            return moved
        if np.isinf(field).any():
            expected = "whole sites, for a body that does not cover its lattice"
            raise InputError("shift", expected=expected, got=f"{rest} of a site beside them")
        modes = self.forward(moved)
        for angle, part in zip(self.angles, rest, strict=True):
            phase = angle * part
            modes = modes * np.where(np.abs(angle) == np.pi, np.cos(phase), np.exp(-1j * phase))
        return self.backward(modes)

    def long_waves(self, modes: ModesOrSpectrum, coarse: Lattice) -> ModesOrSpectrum:
        """Those of the modes, or of a spectrum, that a coarser lattice has too, in its order."""
        kept = modes[..., : coarse.spectral_shape[-1]]
        parts = [kept[rows, ...] for rows, _ in self._rows(coarse)]
        long: ModesOrSpectrum = namespace(modes).concat(parts)
        return long

    def add_long_waves(self, modes: Modes, long: Modes, coarse: Lattice) -> None:
        """Add the modes of a coarser lattice, of odd lengths, to those of this one, in place."""
        kept = modes[..., : coarse.spectral_shape[-1]]
        for rows, coarse_rows in self._rows(coarse):
            kept[rows, ...] += long[coarse_rows, ...]

    def _rows(self, coarse: Lattice) -> list[tuple[slice, slice]]:
        """Places on the first axis of the waves of a coarser lattice, here and on that lattice."""
        n = coarse.spectral_shape[0]
        if self.dimension == 1 or self.reflecting:
            return [(slice(n), slice(n))]
        half, beyond = (n + 1) // 2, self.shape[0] - n // 2
        return [(slice(half), slice(half)), (slice(beyond, None), slice(half, None))]


def namespace(array: object) -> Any:
    """The array's library in the dialect of the standard, which numpy speaks itself."""
    if isinstance(array, np.ndarray):
        return np
    with checks.extra("arrays", "arrays of another library"):
        from array_api_compat import array_namespace
    return array_namespace(array)


def _foreign_transforms(array: object) -> Any:
    """The transforms of the array's own library; None for numpy, which has scipy's."""
    return None if isinstance(array, np.ndarray) else namespace(array).fft
