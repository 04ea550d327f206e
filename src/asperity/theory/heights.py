"""Laws of the heights of independent asperities, as the dilute theory needs them.

A flat body at separation d touches the asperities with xi > d and compresses them by xi - d. So a law has an
`exceedance` Prob(xi > d), a `mean_excess` E[(xi - d)+], and the inverse of the latter (J. A. Greenwood and J.
B. P. Williamson, Proc. R. Soc. A 295, 300 (1966), doi:10.1098/rspa.1966.0242).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import elementwise
from scipy.special import erfcx, log_ndtr, ndtr

from asperity.base.checks import Floats, floats, number, positive
from asperity.errors import ConvergenceError, InputError

_LOG_ROOT_TWO_PI = 0.5 * np.log(2 * np.pi)


@runtime_checkable
class HeightLaw(Protocol):
    """What the dilute theory asks of a law of heights. Arrays of any shape; scalars in, NumPy float out."""

    def exceedance(self, separation: ArrayLike) -> Floats:
        """Prob(xi > d): the fraction of sites in contact at separation d (length)."""
        ...

    def mean_excess(self, separation: ArrayLike) -> Floats:
        """E[(xi - d)+]: compression per site (length) at separation d (length)."""
        ...

    def separation_for(self, mean_excess: ArrayLike) -> Floats:
        """Inverse of `mean_excess`: separation d (length) at a compression per site (length, above 0)."""
        ...


class _OfRms:
    """A dataclass with a field ``rms``, which must be above 0."""

    rms: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "rms", number("rms", self.rms, above=0))


@dataclass(frozen=True)
class GaussianHeights(_OfRms):
    """Normal heights of mean 0 and standard deviation rms (length): the paper's uncorrelated surfaces."""

    rms: float = 1.0

    def exceedance(self, separation: ArrayLike) -> Floats:
        """Q(d/rms), the upper tail of the normal law."""
        return np.asarray(ndtr(-floats("separation", separation) / self.rms))[()]

    def mean_excess(self, separation: ArrayLike) -> Floats:
        """Rms [phi(x) - x Q(x)], x = d/rms, without the cancellation in the tail."""
        x = floats("separation", separation) / self.rms
        return (self.rms * np.exp(_log_normal_excess(x)))[()]

    def separation_for(self, mean_excess: ArrayLike) -> Floats:
        """Root of a bracketed, elementwise search in the logarithm of the mean excess."""
        target = positive("mean_excess", mean_excess) / self.rms
        log_target = np.log(target)
        # E[(xi - d)+] lies above -d, and below phi(d) for d > 0; the margin keeps rounding out.
        highest = np.sqrt(np.maximum(-2 * (log_target + _LOG_ROOT_TWO_PI), 0)) + 1
        root = elementwise.find_root(_log_excess_above, (-target - 1, highest), args=(log_target,))
        if not np.all(root.success):
            raise ConvergenceError(
                "separation_for: the root search stopped; mean_excess / rms is out of reach"
            )
        return np.asarray(self.rms * root.x, dtype=np.float64)[()]


@dataclass(frozen=True)
class ExponentialHeights(_OfRms):
    """Heights of density exp(-xi/rms)/rms for xi > 0: the paper's P(xi) with gamma = 1/rms (length)."""

    rms: float = 1.0

    def exceedance(self, separation: ArrayLike) -> Floats:
        """Exp(-d/rms), and 1 below the lowest asperity."""
        x = floats("separation", separation) / self.rms
        return np.exp(-np.maximum(x, 0))[()]

    def mean_excess(self, separation: ArrayLike) -> Floats:
        """Rms exp(-d/rms), and rms - d below the lowest asperity."""
        x = floats("separation", separation) / self.rms
        return (self.rms * (np.exp(-np.maximum(x, 0)) - np.minimum(x, 0)))[()]

    def separation_for(self, mean_excess: ArrayLike) -> Floats:
        """Invert in closed form: rms ln(rms/e) for e < rms, rms - e above."""
        x = positive("mean_excess", mean_excess) / self.rms
        return (self.rms * np.where(x < 1, -np.log(x), 1 - x))[()]


@dataclass(frozen=True, eq=False)
class EmpiricalHeights:
    """Heights (length) as given, site by site, of any shape and law; copied."""

    heights: ArrayLike

    def __post_init__(self) -> None:
        array = floats("heights", self.heights)
        if array.size == 0 or not np.isfinite(array).all():
            raise InputError("heights", expected="finite heights, at least one", got=f"shape {array.shape}")
        copied = array.copy()
        copied.flags.writeable = False
        object.__setattr__(self, "heights", copied)

    def __repr__(self) -> str:
        return f"EmpiricalHeights({np.size(self.heights)} heights)"

    @cached_property
    def _knots(self) -> tuple[Floats, Floats]:
        """The heights, rising, and the mean excess at each: a sum of positive terms, nothing cancels."""
        rising = np.sort(np.ravel(self.heights))
        touching = np.arange(rising.size - 1, 0, -1)
        excess = np.append(np.cumsum((touching * np.diff(rising))[::-1])[::-1], 0.0) / rising.size
        return rising, excess

    def exceedance(self, separation: ArrayLike) -> Floats:
        """Fraction of the heights above d."""
        rising, _ = self._knots
        above = rising.size - np.searchsorted(rising, floats("separation", separation), side="right")
        return np.asarray(above / rising.size)[()]

    def mean_excess(self, separation: ArrayLike) -> Floats:
        """Exact: piecewise linear in d, with a knot at each height."""
        d, (rising, excess) = floats("separation", separation), self._knots
        return np.asarray(np.interp(d, rising, excess) + np.maximum(rising[0] - d, 0))[()]

    def separation_for(self, mean_excess: ArrayLike) -> Floats:
        """Exact inverse of the piecewise linear `mean_excess`."""
        target, (rising, excess) = positive("mean_excess", mean_excess), self._knots
        below = np.maximum(target - excess[0], 0)  # where all heights touch
        return np.asarray(np.interp(target, excess[::-1], rising[::-1]) - below)[()]


def _log_normal_excess(x: Floats) -> Floats:
    """Logarithm of phi(x) - x Q(x) for the standard normal law."""
    log_phi = -0.5 * x**2 - _LOG_ROOT_TWO_PI
    # Above 0 by the Mills ratio Q/phi, which neither underflows nor overflows there.
    high = np.maximum(x, 0)
    above = log_phi + np.log1p(-high * np.sqrt(np.pi / 2) * erfcx(high / np.sqrt(2)))
    low = np.minimum(x, 0)
    below = np.log(np.exp(np.minimum(log_phi, 0)) - low * np.exp(log_ndtr(-low)))
    return np.asarray(np.where(x > 0, above, below))


def _log_excess_above(x: Floats, log_target: Floats) -> Floats:
    return np.asarray(_log_normal_excess(x) - log_target)
