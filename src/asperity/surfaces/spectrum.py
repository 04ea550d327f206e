r"""Power spectrum of a surface, and its Hurst exponent.

With the heights :math:`h` on N sites, :math:`d` axes, and the area (length) of a site :math:`a`,

.. math::

    C(\mathbf q) = \frac{a}{N} \left|\sum_{\mathbf x} h(\mathbf x) e^{-i \mathbf q \mathbf x}\right|^2,
    \qquad \int \frac{d^d q}{(2\pi)^d}\, C(\mathbf q) = \text{rms height}^2 ,

as T. D. B. Jacobs, T. Junge and L. Pastewka define it (Surf. Topogr.: Metrol. Prop. 5, 013001 (2017), DOI
10.1088/2051-672X/aa51f8). Over directions it is averaged in bins of equal width in ln q. A self-affine
surface has :math:`C \sim q^{-2(1+H)}`, a profile :math:`C \sim q^{-(1+2H)}`.

If opposite edges do not fit, the steps at the seams hide the spectrum of a smooth surface. Then the
least-squares plane is removed and the heights are multiplied by a Hann window along each axis, normalized so
that white noise keeps its power. Waves longer than a third of a side, which the window blurs, are left out.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy
from numpy.typing import ArrayLike

from asperity.base import views
from asperity.errors import InputError
from asperity.lattice import Field, Lattice
from asperity.surfaces.heights import check_heights
from asperity.surfaces.levelling import remove_tilt
from asperity.surfaces.moments import statistics
from asperity.surfaces.prepare import checked_band
from asperity.surfaces.surface import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_PER_DECADE = 10
_BROAD = 5  # fewest bins of a range with a Hurst exponent: half a decade
_FITTING_SEAM = 2.0  # largest ratio of a step at a seam to a usual one of opposite edges that fit
_TOLERANCE = 0.1  # largest relative deviation of C from a power law, rms over the bins of its range
# Largest deviation of the first or the last bins of the range from the line, standard deviations.
_DRIFT = 1.5
# Largest deficit of the mean power of the first bins below the line, standard deviations: where a surface
# rolls off, the scatter of the logarithms hides that the few long waves have too little power.
_DEFICIT = 2.5
# Largest mean square deviation of C from the line, over that of random waves and 10 %. Isotropic surfaces
# have less than 1, surfaces stretched by 3 along one axis less than 2, grooves over a rough background 45.
_OFF_LINE = 3.0
_ANISOTROPIC = 2.0  # median ratio of the spectra along the two axes above which it is remarked
_ROUNDING = 1e-18  # power over the largest below which a wave is rounding
_UNKNOWN = 0.25  # largest half width of the interval of a Hurst exponent
_SCATTER = math.pi / math.sqrt(6)  # standard deviation of ln of a mode's power: an exponential distribution
_HANN = 35 / 18  # factor by which a Hann window lowers the number of independent modes of an axis


@dataclass(frozen=True)
class SelfAffineRange:
    """A range of wavelengths in which the spectrum is a power law.

    Attributes
    ----------
    hurst
        Hurst exponent H.
    interval
        Its 95 % interval: Student's t times the standard error of a straight line through the logarithms of
        the bins. The scatter of a bin is that of random waves and 10 %, or the observed one if it is larger.
    longest, shortest
        Longest and shortest wavelength.
    exponent
        Power of the wave number: -2 (1 + H), or -(1 + 2 H) of a profile.
    middle
        A point of the fitted line: wave number and C.
    """

    hurst: float
    interval: tuple[float, float]
    longest: float
    shortest: float
    exponent: float
    middle: tuple[float, float]

    def power(self, wave_number: Field) -> Field:
        """C on the fitted line."""
        return np.asarray(self.middle[1] * (wave_number / self.middle[0]) ** self.exponent)


@dataclass(frozen=True, eq=False)
class PowerSpectrum:
    """Power spectrum of a surface.

    Attributes
    ----------
    wave_number
        Wave numbers q, radians per `length_unit`, shape ``(k,)``: geometric means over bins.
    power
        C(q), mean over the directions, in ``unit^2 length_unit^2``, or ``unit^2 length_unit`` of a profile.
    modes
        Waves in each bin, with q and -q counted once.
    along
        For each axis, wave numbers and the mean spectrum of the profiles along it, in ``unit^2 length_unit``.
    hurst_along
        For each axis, the Hurst exponent of these profiles, or None. Near the shortest wave they fall more
        steeply than C: it may be larger than that of `fit` by 0.15.
    anisotropy
        Median ratio, above 1, of the spectra along the two axes; 1 for a profile.
    window
        "none", or "Hann" where opposite edges do not fit.
    fit
        The self-affine range; None if no range of half a decade has a Hurst exponent from 0 to 1 with an
        interval of at most ±0.25, and C itself on the line.
    unit, length_unit
        Units of heights ("1" if unknown) and of lengths ("pixel" if unknown).
    """

    wave_number: Field
    power: Field
    modes: Field
    along: tuple[tuple[Field, Field], ...]
    hurst_along: tuple[float | None, ...]
    anisotropy: float
    window: str
    fit: SelfAffineRange | None
    unit: str
    length_unit: str

    def __repr__(self) -> str:
        q, unit = self.wave_number, self.length_unit
        span = f"{q.size} bins from {q[0]:.3g} to {q[-1]:.3g} rad/{unit}" if q.size else "no bins"
        exponent = "no Hurst exponent" if self.fit is None else f"H = {self.fit.hurst:.3g}"
        return f"<PowerSpectrum: {span}, {exponent}>"

    @property
    def remarks(self) -> tuple[str, ...]:
        """A warning of anisotropy, which no single exponent describes."""
        if self.anisotropy <= _ANISOTROPIC:
            return ()
        columns, rows = ("none" if exponent is None else f"{exponent:.3f}" for exponent in self.hurst_along)
        return (
            f"the surface is not isotropic: spectra along its two axes differ by a factor of "
            f"{self.anisotropy:.2g}; Hurst exponent along the rows {rows}, along the columns {columns}",
        )

    @views.later
    def plot(self, /, ax: Axes | None = None) -> Axes:
        """Draw it into axes or a new figure; see `asperity.figures.plot_spectrum`."""
        raise NotImplementedError


def power_spectrum(
    surface: ArrayLike,
    pixel_size: tuple[float, ...] | None = None,
    *,
    longest: float | None = None,
    shortest: float | None = None,
) -> PowerSpectrum:
    """Measure the power spectrum and the Hurst exponent of a surface.

    Parameters
    ----------
    surface
        A `Surface`, of which the scan without mirror images is measured, or heights as for `check_heights`.
    pixel_size
        Distance between sites along each axis, for heights that are no `Surface`; None counts in pixels.
    longest, shortest
        Range of wavelengths in which the Hurst exponent is fitted. By default the broadest range, of half a
        decade or more, whose bins lie on a power law to 10 % rms and the scatter of random waves, without a
        drift at its ends, and with an exponent from 0 to 1 that is known to ±0.25.

    Raises
    ------
    InputError
        `check_heights` refuses the surface, a number is out of range, or the range has less than three bins.
    """
    if not isinstance(surface, Surface):
        surface = Surface(check_heights(surface), pixel_size=pixel_size)
    scan = surface.scan
    heights, sizes = scan.heights, scan.pixel_size or (1.0,) * scan.heights.ndim
    if not np.isfinite(heights).all():
        expected, advice = "a body that covers its lattice, for a spectrum", "a part of it: Surface.crop"
        raise InputError("surface", expected=expected, got="sites without body", advice=advice)
    limits = checked_band(longest, shortest)
    fits = scan.edges == "periodic" and statistics(heights).seam_ratio <= _FITTING_SEAM
    level, _ = remove_tilt(heights, np.ones(heights.shape, dtype=bool), "mean" if fits else "plane")
    windows = [np.ones(n) if fits or n == 1 else np.hanning(n + 1)[:-1] for n in heights.shape]
    q, power = _isotropic(level, sizes, windows)
    least = 0.0 if fits else 6 * math.pi / min(n * s for n, s in zip(heights.shape, sizes, strict=True))
    most = math.pi / max(sizes)  # beyond it only waves of some directions are on the lattice
    bins = _binned(q.ravel(), power.ravel(), least, most, 1.0 if fits else _HANN**heights.ndim)
    sides = enumerate(zip(sizes, windows, strict=True))
    along = tuple(_along(np.moveaxis(level, axis, -1), *side, 1 if fits else 3) for axis, side in sides)
    profiles = [_binned(*each, 0.0, each[0].max(initial=0.0), 1.0 if fits else _HANN) for each in along]
    return PowerSpectrum(
        wave_number=bins.q,
        power=bins.power,
        modes=bins.modes,
        along=along,
        hurst_along=tuple(None if (line := _fit(each, 1, {})) is None else line.hurst for each in profiles),
        anisotropy=_ratio(profiles[0], profiles[-1]),
        window="none" if fits else "Hann",
        fit=_fit(bins, heights.ndim, limits),
        unit=scan.unit,
        length_unit="pixel" if scan.pixel_size is None else scan.length_unit or "unit of length",
    )


@dataclass(frozen=True, eq=False)
class _Bins:
    """Bins of the spectrum: ends, means, and mean logarithms of the power with standard deviations."""

    low: Field
    high: Field
    q: Field
    power: Field
    modes: Field
    logarithm: Field
    scatter: Field


def _isotropic(level: Field, sizes: tuple[float, ...], windows: list[Field]) -> tuple[Field, Field]:
    """Wave number and power of each wave, with q and -q counted once."""
    lattice, weight = Lattice(level.shape, sizes), functools.reduce(np.multiply.outer, windows)
    power = np.abs(lattice.forward(level * weight)) ** 2 * (lattice.cell / float(np.sum(weight**2)))
    once = np.ones(lattice.spectral_shape, dtype=bool)
    if level.ndim == 2:  # the half spectrum has waves along the first axis twice, as q and -q
        once[level.shape[0] // 2 + 1 :, 0] = False
    return lattice.wave_number[once], power[once]


def _binned(q: Field, power: Field, least: float, most: float, correlated: float) -> _Bins:
    """Means over bins of equal width in ln q; bins without a wave are left out."""
    wanted = (q > 0) & (q >= least * (1 - 1e-9)) & (q <= most * (1 + 1e-9))
    q, power = q[wanted], power[wanted]
    if not q.size:
        return _Bins(*(np.zeros(0) for _ in range(7)))
    number = np.floor(_PER_DECADE * np.log10(most / q) + 1e-9).astype(int)
    number = number.max() - number  # rising with q; the last bin ends at the largest wave number
    count = np.bincount(number)
    full = np.flatnonzero(count)
    modes = count[full].astype(np.float64)
    with np.errstate(divide="ignore"):
        logarithms = np.log(power)

    def mean(values: Field) -> Field:
        return np.bincount(number, values)[full] / modes

    return _Bins(
        low=np.asarray(scipy.ndimage.minimum(q, number, full)),
        high=np.asarray(scipy.ndimage.maximum(q, number, full)),
        q=np.exp(mean(np.log(q))),
        power=mean(power),
        modes=modes,
        logarithm=mean(logarithms),
        scatter=_SCATTER / np.sqrt(np.maximum(modes / correlated, 1)),
    )


def _fit(bins: _Bins, axes: int, limits: dict[str, float]) -> SelfAffineRange | None:
    """Fit a power law to the bins between the limits, or to the broadest straight range."""
    if limits:
        inside = bins.low >= 2 * math.pi / limits.get("longest", math.inf) * (1 - 1e-9)
        inside &= bins.high <= 2 * math.pi / limits.get("shortest", 1e-300) * (1 + 1e-9)
        chosen = np.flatnonzero(inside & np.isfinite(bins.logarithm))
        if chosen.size < 3:
            expected = f"a range of wavelengths with three bins of the spectrum, {_PER_DECADE} a decade"
            raise InputError("longest, shortest", expected=expected, got=chosen.size)
        return _line(bins, chosen, axes)[0]
    best, broadest = None, 0.0
    for first in range(bins.q.size - _BROAD + 1):
        for last in range(first + _BROAD, bins.q.size + 1):
            width = math.log(bins.q[last - 1] / bins.q[first])
            if width <= broadest:
                continue
            if not np.isfinite(bins.logarithm[first:last]).all():
                break
            candidate, misfit, drift, deficit, off = _line(bins, np.arange(first, last), axes)
            narrow = candidate.interval[1] - candidate.hurst <= _UNKNOWN
            straight = misfit <= 1 and drift <= _DRIFT and deficit <= _DEFICIT and off <= _OFF_LINE
            if straight and narrow and 0 <= round(candidate.hurst, 2) <= 1:
                best, broadest = candidate, width
    return best


def _line(bins: _Bins, chosen: np.ndarray, axes: int) -> tuple[SelfAffineRange, float, float, float, float]:
    """Least squares of the mean logarithms; reduced chi-squared; drift; deficit; deviation of C."""
    x, y = np.log(bins.q[chosen]), bins.logarithm[chosen]
    variance = bins.scatter[chosen] ** 2 + _TOLERANCE**2
    weight = 1 / variance
    center = float(np.average(x, weights=weight))
    spread = float(np.sum(weight * (x - center) ** 2))
    slope = float(np.sum(weight * (x - center) * y)) / spread
    residual = y - float(np.average(y, weights=weight)) - slope * (x - center)
    free = chosen.size - 2
    misfit = float(np.sum(weight * residual**2)) / free
    reach = float(scipy.special.stdtrit(free, 0.975)) * math.sqrt(max(misfit, 1.0) / spread) / 2
    hurst = (-slope - axes) / 2
    level = float(np.average(np.log(bins.power[chosen]), weights=weight))
    fitted = SelfAffineRange(
        hurst=hurst,
        interval=(hurst - reach, hurst + reach),
        longest=2 * math.pi / float(bins.low[chosen[0]]),
        shortest=2 * math.pi / float(bins.high[chosen[-1]]),
        exponent=slope,
        middle=(math.exp(center), math.exp(level)),
    )
    normal, half = residual * np.sqrt(weight), chosen.size // 2
    ends = np.stack([normal[:half], normal[: -half - 1 : -1]])
    root = np.sqrt(np.arange(1, half + 1))
    drift = np.abs(np.cumsum(ends, axis=-1)) / root
    # Signed roots of the deviance of a gamma distribution of the independent powers.
    excess = np.log(bins.power[chosen]) - level - slope * (x - center)
    count = 1 / ((bins.scatter[chosen] / _SCATTER) ** 2 + _TOLERANCE**2)
    deviance = np.sign(excess) * np.sqrt(2 * count * np.maximum(np.expm1(excess) - excess, 0))
    deficit = float(np.max(-np.cumsum(deviance[:half]) / root))
    return fitted, misfit, float(drift.max()), deficit, float(np.mean(count * excess**2))


def _ratio(first: _Bins, second: _Bins) -> float:
    """Median ratio, above 1, of two spectra at common wave numbers; 1 without any."""
    logarithms = []
    for spectrum in (first, second):
        kept = spectrum.power > _ROUNDING * spectrum.power.max(initial=0.0)
        logarithms.append((np.log(spectrum.q[kept]), np.log(spectrum.power[kept])))
    (q, power), (other_q, other) = logarithms
    common = (q >= other_q.min(initial=math.inf)) & (q <= other_q.max(initial=-math.inf))
    if not common.any():
        return 1.0
    return math.exp(float(np.median(np.abs(power - np.interp(q, other_q, other))[common])))


def _along(level: Field, size: float, window: Field, first: int) -> tuple[Field, Field]:
    """Mean spectrum of the profiles along the last axis, from the first wave on."""
    modes = scipy.fft.rfft(level.reshape(-1, window.size) * window, axis=-1)
    power = np.mean(np.abs(modes) ** 2, axis=0) * (size / float(np.sum(window**2)))
    return 2 * np.pi * scipy.fft.rfftfreq(window.size, size)[first:], power[first:]
