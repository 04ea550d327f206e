"""Sensible numbers for a run that leaves some open: a load, the times to record, the times to map."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

import asperity.checks as checks
from asperity.errors import InputError
from asperity.lattice import Field

MODEST = 0.005
"""Load per site of `modest_load`, in units of (k0 + k1) times the rms height."""


def modest_load(*, k0: float, k1: float, rms: float, sites: int) -> float:
    """Load that brings a Gaussian surface near 1 % contact when k1/k0 = 3.

    Parameters
    ----------
    k0, k1
        Stiffnesses of the spring lattice, force per length.
    rms
        Rms height of the surface, length.
    sites
        Number of lattice sites.

    Returns
    -------
    float
        ``0.005 (k0 + k1) rms sites``, to three significant digits; force.

    Raises
    ------
    InputError
        The surface is flat, so that there is no such load.
    """
    stiffness = checks.number("k0", k0, least=0) + checks.number("k1", k1, least=0)
    load = MODEST * stiffness * checks.number("rms", rms, least=0) * checks.integer("sites", sites, least=1)
    if not load > 0:
        raise InputError(
            "load",
            expected="a load, as the rms height of the surface is 0 and suggests none",
            got="none",
            advice="a load of your own",
        )
    return float(f"{load:.3g}")


def hold_times(*, first: float, last: float, per_decade: int) -> Field:
    """Times spread evenly over the decades from ``first`` to ``last``, both included.

    Parameters
    ----------
    first, last
        Hold times, 0 < first < last.
    per_decade
        Times in each decade; where the range is no whole number of steps, the steps are stretched or
        shrunk a little.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    InputError
        ``first`` is not above 0, ``last`` not above ``first``, or ``per_decade`` below 1.
    """
    first, last = checks.number("first", first), checks.number("last", last)
    if not 0 < first < last:
        raise InputError("first and last", expected="0 < first < last", got=f"{first:g} and {last:g}")
    per_decade = checks.integer("per_decade", per_decade, least=1)
    steps = max(1, round(math.log10(last / first) * per_decade))
    return np.geomspace(first, last, steps + 1)


def map_times(times: Sequence[float], count: int = 6) -> tuple[float, ...]:
    """Pick times at which a history is worth a map: 0, the last, and others spread between.

    Parameters
    ----------
    times
        The recorded hold times, increasing.
    count
        How many to pick at most; at least 2.

    Returns
    -------
    tuple of float
        Members of ``times``, after 0: of powers of ten and the last, every one, or every second, and so on,
        back from the last. Where these are too few, times are spread evenly by index.
    """
    later = [float(t) for t in checks.times("times", times) if t > 0]
    round_ones = [t for t in later if _is_power_of_ten(t) or t == later[-1]]
    wanted = min(checks.integer("count", count, least=2) - 1, len(later))
    if wanted and len(round_ones) >= wanted:
        stride = max(1, round(len(round_ones) / wanted))
        return (0.0, *round_ones[::-stride][:wanted][::-1])
    # The last of each of `wanted` equal parts: the early stretch, where little happens, has no extra map.
    chosen = [later[math.ceil((part + 1) * len(later) / wanted) - 1] for part in range(wanted)]
    return (0.0, *chosen)


def _is_power_of_ten(time: float) -> bool:
    exponent = math.log10(time)
    return abs(exponent - round(exponent)) < 1e-9
