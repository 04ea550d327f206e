"""Branches of a generalized Maxwell solid: shares of its modulus, and the times in which they relax."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from asperity.base import checks, units
from asperity.errors import LARGEST, InputError

Branches = tuple[tuple[float, float], ...]

ROUNDING = 1e-12
"""What sums of shares, and ratios of times, may be wrong by."""


def check_branches(branches: Iterable[Sequence[float | str]]) -> Branches:
    """Check the branches of a generalized Maxwell solid.

    Parameters
    ----------
    branches
        Pairs of a share of the instantaneous modulus and its relaxation time, both above 0: a list or an
        array of shape (n, 2). The shares add up to 1 at most.

    Returns
    -------
    tuple of (float, float)
        In the order of their times.

    Raises
    ------
    InputError
        They are no pairs of numbers, a share or a time is not above 0, or the shares add up to more than 1.
    """
    expected = "pairs of a share and a relaxation time"
    advice = "branches=[(0.3, 0.01), (0.3, 1.0)]"
    if hasattr(branches, "__array__"):
        array = checks.floats("branches", branches, expected=expected, advice=advice)
        if array.size and array.ndim != 2:
            raise InputError("branches", expected=expected, got=f"shape {array.shape}", advice=advice)
        branches = array.tolist() if array.size else []
    if isinstance(branches, (str, bytes, dict)) or not hasattr(branches, "__iter__"):
        raise InputError("branches", expected=expected, got=checks.shown(branches), advice=advice)
    checked = []
    for number, pair in enumerate(branches, 1):
        of = f"of branch {number}"
        try:
            share, time = [] if isinstance(pair, (str, dict, set)) else pair
        except (TypeError, ValueError) as error:
            got = checks.shown(pair)
            raise InputError(f"branch {number}", expected="a pair", got=got, advice=advice) from error
        share = checks.number(f"share {of}", share, above=0, most=1 + ROUNDING)
        time = units.number(f"relaxation time {of}", time, "s", least=1 / LARGEST)
        checked.append((share, time))
    total = math.fsum(share for share, _ in checked)
    if total > 1 + ROUNDING:
        expected, got = "shares of the instantaneous modulus, 1 together at most", f"{total:.6g} together"
        advice = f"each share divided by {total:.6g}, if nothing is permanent"
        raise InputError("branches", expected=expected, got=got, advice=advice)
    return tuple(sorted(checked, key=lambda branch: branch[1]))
