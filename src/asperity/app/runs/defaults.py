"""Sensible numbers for a run that leaves some open: a load, the times to record, the times to map.

The configuration has checked what these functions are given.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from asperity.errors import InputError
from asperity.prediction.predicting import USUAL_MAPS


def modest_load(*, k0: float, k1: float, rms: float, sites: int) -> float:
    """Load that brings a Gaussian surface near 1 % contact when k1/k0 = 3: 0.005 (k0 + k1) rms sites."""
    return _modest("load", 0.005 * (k0 + k1) * rms * sites, "rms height")


def modest_pressure(*, modulus: float, slope: float) -> float:
    """Mean pressure that brings a rough surface near 1 % contact on a half-space: 0.005 E* rms slope.

    While little of it touches, the contact fraction of a self-affine surface is about 2 p / (E* rms slope)
    (S. Hyun, L. Pei, J.-F. Molinari, M. O. Robbins, Phys. Rev. E 70, 026117 (2004)). On a layer that is
    thin beside the distances of contacts less touches.
    """
    return _modest("pressure", 0.005 * modulus * slope, "rms slope")


def _modest(name: str, value: float, of_what: str) -> float:
    """The value to three digits; `InputError` if the surface is flat."""
    if not value > 0:
        expected = f"a {name}, as the {of_what} of the surface is 0 and suggests none"
        raise InputError(name, expected=expected, got="none", advice=f"a {name} of your own")
    return float(f"{value:.3g}")


def map_times(times: Sequence[float], count: int = USUAL_MAPS) -> tuple[float, ...]:
    """Pick times at which a history is worth a map: 0, the last, and others spread between.

    At most so many (2 or more) of the recorded hold times, which increase: after 0, of powers of ten and
    the last, every one, or every second, and so on, back from the last. Where these are too few, times
    are spread evenly by index.
    """
    later = [float(t) for t in times if t > 0]
    exponents = np.log10(later)
    powers = np.abs(exponents - exponents.round()) < 1e-9
    round_ones = [t for t, power in zip(later, powers, strict=True) if power or t == later[-1]]
    wanted = min(count - 1, len(later))
    if wanted and len(round_ones) >= wanted:
        stride = max(1, round(len(round_ones) / wanted))
        return (0.0, *round_ones[::-stride][:wanted][::-1])
    # The last of each of `wanted` equal parts: the early stretch, where little happens, has no extra map.
    chosen = [later[math.ceil((part + 1) * len(later) / wanted) - 1] for part in range(wanted)]
    return (0.0, *chosen)
