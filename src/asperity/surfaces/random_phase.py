r"""Self-affine surfaces by their power spectrum, with random phases.

On a periodic lattice, every Fourier mode of wave number :math:`q = |\mathbf q|` gets the squared amplitude

.. math::

    C(q) \propto q_r^{-d-2H}\ (q < q_r), \quad q^{-d-2H}\ (q_r \le q \le q_s), \quad 0\ (q > q_s),

with d the number of axes, :math:`q_r = 2\pi/` roll-off and :math:`q_s = 2\pi/` cut-off, and a phase that is
random and independent. So C falls as :math:`q^{-2(1+H)}` on surfaces and as :math:`q^{-(1+2H)}` on profiles.
The form of C and the measures of roughness are those of T. D. B. Jacobs, T. Junge and L. Pastewka, Surf.
Topogr.: Metrol. Prop. 5, 013001 (2017), DOI 10.1088/2051-672X/aa51f8:

    rms height^2 = sum_q |h_q|^2,  rms slope^2 = sum_q q^2 |h_q|^2,
    rms curvature^2 = sum_q q^4 |h_q|^2 / d^2.

The curvature of a surface is the mean of its two principal ones, half the Laplacian; that of a profile is
its second derivative.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import numpy as np
import scipy
from annotated_types import Ge, Le
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks
from asperity.base.parameters import Quantity
from asperity.errors import InputError
from asperity.lattice import Field, Lattice
from asperity.surfaces.heights import checked_spacing
from asperity.surfaces.making import PixelSize, Positive, Rng, Seed, Shape, Unit, in_unit
from asperity.surfaces.spectrum_files import read_spectrum

_USUAL_CUTOFF = 8
"""Shortest wavelength by default, in units of the larger spacing."""

_ROUNDING = 1e-9


@in_unit
def spectral(
    shape: Shape,
    *,
    hurst: Annotated[float, Ge(0), Le(1), Quantity("Hurst exponent")] = 0.8,
    roll_off: Annotated[
        Positive,
        Quantity("wavelength above which the spectrum is flat, or a side.", dimension="length unit"),
    ] = None,
    cutoff: Annotated[
        Positive,
        Quantity("shortest wavelength. By default 8 larger spacings.", dimension="length unit"),
    ] = None,
    rms_height: Annotated[
        Positive,
        Quantity("rms height. By default 1, without slope and curvature.", dimension="height unit"),
    ] = None,
    rms_slope: Annotated[
        Positive,
        Quantity("rms slope, in place of the height.", dimension="height unit / length unit"),
    ] = None,
    rms_curvature: Annotated[
        Positive, Quantity("rms mean curvature, likewise.", dimension="height unit / length unit^2")
    ] = None,
    pixel_size: PixelSize = None,
    unit: Unit = None,
    spacing: ArrayLike | None = None,
    seed: Seed = 0,
    rng: Rng = None,
) -> Field:
    """Make a periodic self-affine surface of a given power spectrum, with random phases.

    Parameters
    ----------
    shape
        Sites along each axis: ``(n, m)``, or ``n`` or ``(n,)`` for a profile.
    hurst
        Hurst exponent H, from 0 to 1.
    roll_off
        Wavelength above which the spectrum is flat, in the unit of the pixels; by default the longest side,
        so that the whole spectrum is self-affine.
    cutoff
        Shortest wavelength, two of the larger pixels or more; by default eight, or `roll_off` or the
        longest side where that is less.
    rms_height, rms_slope, rms_curvature
        Roughness: one of the three, exact for the heights as a sum of waves; by default an rms height of 1.
        The rms height sets the unit of the heights. The slope is in that over the unit of the pixels, the
        curvature in that over its square.
    pixel_size
        Distance between sites: one number, or one an axis; by default 1. Or `spacing`, the same.
    unit, seed, rng
        As in `gaussian`.

    Returns
    -------
    ndarray of float64, of the given shape; with a unit a `Surface`
        The heights, of mean 0.

    Raises
    ------
    InputError
        A number is out of range, more than one measure of roughness is given, or all waves of the lattice
        are shorter than the cut-off.

    Notes
    -----
    The amplitudes have no scatter: every surface has exactly this spectrum, and seeds differ in phases only.
    """
    del unit  # `in_unit` takes it
    lengths = checks.lattice_shape(shape)
    exponent = checks.number("hurst", hurst, least=0, most=1)
    if pixel_size is None and spacing is None:
        pixel_size = 1.0
    name = checks.one_of("pixel_size=0.5", pixel_size=pixel_size, spacing=spacing)
    steps = checked_spacing(name, pixel_size if spacing is None else spacing, len(lengths))
    lattice = Lattice(lengths, steps)
    q = lattice.wave_number
    longest, shortest = _band(roll_off, cutoff, [n * d for n, d in zip(lengths, steps, strict=True)], steps)
    power, roughness = _roughness(rms_height, rms_slope, rms_curvature, len(lengths))
    phases = _phases(lengths, checks.generator(seed, rng))
    kept = (q > 0) & (q <= 2 * math.pi / shortest * (1 + _ROUNDING))
    if not kept.any():
        expected = "a lattice with a wave as long as the cut-off"
        got = f"{' x '.join(map(str, lengths))} sites, and a cut-off of {shortest:g}"
        raise InputError("shape", expected=expected, got=got)
    # In units of the cut-off the amplitudes neither overflow nor vanish, whatever the spacing.
    relative = q[kept] * (shortest / (2 * math.pi))
    amplitude = np.maximum(relative, shortest / longest) ** -(len(lengths) / 2 + exponent)
    modes = np.zeros_like(phases)
    modes[kept] = phases[kept] * amplitude
    squares = (lattice.multiplicity * np.abs(modes) ** 2)[kept]
    total = math.sqrt(float(np.sum(squares * relative ** (2 * power))))
    modes *= roughness * (shortest / (2 * math.pi)) ** power / total * math.prod(lengths)
    return np.asarray(scipy.fft.irfftn(modes, s=lengths))


@in_unit
def from_spectrum(
    shape: Shape,
    spectrum: Annotated[
        Callable[[Field], ArrayLike] | tuple[ArrayLike, ArrayLike] | str | Path,
        Quantity("table of wave number q and power spectrum C; units need `unit`.", key="path"),
    ],
    *,
    pixel_size: PixelSize = 1.0,
    unit: Unit = None,
    seed: Seed = 0,
    rng: Rng = None,
) -> Field:
    r"""Make a periodic surface from any power spectrum, with random phases.

    Parameters
    ----------
    shape
        Sites along each axis: ``(n, m)``, or ``n`` or ``(n,)`` for a profile.
    spectrum
        C(q), the same in all directions, as `power_spectrum` measures it: a function of an array of wave
        numbers, the pair (q, C) of a table with rising q, or a file for `read_spectrum`. Between the points
        of a table ln C is linear in ln q; outside there are no waves. q is in radians per unit of the pixel
        size, C in the squared unit of the heights times that unit, squared except for a profile.
    pixel_size
        Distance between sites; unit, seed, rng and result are those of `spectral`.

    Raises
    ------
    InputError
        A number is out of range, q does not rise, a value of C is negative or no number, or no wave of the
        lattice has any power.

    Notes
    -----
    The convention is that of T. D. B. Jacobs, T. Junge and L. Pastewka, Surf. Topogr.: Metrol. Prop. 5,
    013001 (2017), DOI 10.1088/2051-672X/aa51f8, for their two-dimensional spectrum: with the area A,
    :math:`C(\mathbf q) = A^{-1} |\int h\, e^{-i \mathbf q \mathbf r} d^2r|^2` and
    :math:`\text{rms height}^2 = (2\pi)^{-2} \int C\, d^2q`. If the integral itself is the squared rms height,
    multiply C by :math:`4\pi^2`; if the abscissa is 1/wavelength, multiply it by :math:`2\pi`.
    The amplitudes have no scatter: every wave has exactly this power, and seeds differ in phases only.
    """
    lengths = checks.lattice_shape(shape)
    if isinstance(spectrum, str | Path):
        spectrum = read_spectrum(spectrum, unit=unit, dimension=len(lengths))
    sides = checked_spacing("pixel_size", pixel_size, len(lengths))
    q = Lattice(lengths, sides).wave_number
    kept = q > 0
    power, waves = np.zeros(q.shape), q[kept]
    measured = spectrum(waves) if callable(spectrum) else _of_table(spectrum, waves)
    measured = checks.not_negative("spectrum", measured)
    if measured.shape not in ((), waves.shape):
        raise InputError("spectrum", expected=f"C at {waves.size} waves", got=f"shape {measured.shape}")
    power[kept] = measured
    if not power.any():
        covered = f"{waves.min(initial=math.inf):.3g} to {q.max():.3g}"
        raise InputError("spectrum", expected=f"power between wave numbers of {covered}", got="none")
    amplitude = np.sqrt(power * (math.prod(lengths) / math.prod(sides)))
    modes = _phases(lengths, checks.generator(seed, rng)) * amplitude
    return np.asarray(scipy.fft.irfftn(modes, s=lengths))


def _phases(shape: tuple[int, ...], random: np.random.Generator) -> NDArray[np.complex128]:
    """Random phase factors of magnitude 1 for the modes of the half spectrum of a real field."""
    noise = scipy.fft.rfftn(random.normal(size=shape))
    return np.asarray(noise / np.abs(noise))


def _of_table(table: tuple[ArrayLike, ArrayLike], q: Field) -> Field:
    """Power at wave numbers, by linear interpolation of ln C in ln q between the points of a table."""
    try:
        wave_numbers, powers = table
    except (TypeError, ValueError):
        expected = "a function of wave numbers, or the pair (q, C)"
        raise InputError("spectrum", expected=expected, got=checks.shown(table)) from None
    points, values = checks.positive("q", wave_numbers), checks.positive("C", powers)
    rising = points.ndim == 1 and points.size > 1 and bool((np.diff(points) > 0).all())
    if not rising or points.shape != values.shape:
        got = f"shapes {points.shape} and {values.shape}" if rising else "q that does not rise"
        raise InputError("spectrum", expected="rising q and as many C, two or more", got=got)
    inside = (q >= points[0] * (1 - _ROUNDING)) & (q <= points[-1] * (1 + _ROUNDING))
    return np.where(inside, np.exp(np.interp(np.log(q), np.log(points), np.log(values))), 0.0)


def _band(
    roll_off: float | None, cutoff: float | None, sides: list[float], spacing: tuple[float, ...]
) -> tuple[float, float]:
    side, step = max(sides), max(spacing)
    least = min(2 * step, side) * (1 - _ROUNDING)  # two of the larger spacings
    longest = side if roll_off is None else checks.number("roll_off", roll_off, least=least)
    if cutoff is None:
        return longest, min(_USUAL_CUTOFF * step, longest, side)
    return longest, checks.number("cutoff", cutoff, least=least, most=longest * (1 + _ROUNDING))


def _roughness(
    height: float | None, slope: float | None, curvature: float | None, axes: int
) -> tuple[int, float]:
    """Power of q of the measure of roughness that is not None, and its value."""
    measures = {"rms_height": height, "rms_slope": slope, "rms_curvature": curvature}
    chosen = {name: value for name, value in measures.items() if value is not None} or {"rms_height": 1.0}
    if len(chosen) > 1:
        got = " and ".join(chosen)
        raise InputError("roughness", expected=f"one of {', '.join(measures)}", got=got, advice="one of them")
    ((name, value),) = chosen.items()
    power = list(measures).index(name)
    return power, checks.number(name, value, above=0) * (axes if power == 2 else 1)
