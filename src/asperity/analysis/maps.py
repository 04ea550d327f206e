"""Which sites touch, and since when: maps of the contact at several times."""

from __future__ import annotations

import json
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from asperity.errors import InputError
from asperity.lattice import Field, Mask

_WINDOW = 160
"""Sites of a profile that can be told apart in a figure."""


class SiteState(IntEnum):
    """A site, compared with the first map."""

    FREE = 0
    KEPT = 1
    NEW = 2
    LOST = 3


@dataclass(frozen=True, eq=False)
class ContactMaps:
    """The contact at several times.

    Attributes
    ----------
    heights
        The rough surface, shape ``(n,)`` or ``(n, m)``; length.
    times
        Hold times of the maps, shape ``(k,)``; infinite for the relaxed state, the last if it is known.
    states
        `SiteState` of each site at each time, shape ``(k, n)`` or ``(k, n, m)``.
    surfaces
        u at each time, same shape; length.
    height_range
        Heights between which colors should tell apart; see `color_range`.
    window
        First site and site after the last of the stretch of a profile that has most contacts and is
        short enough to draw; the whole first axis for a surface.
    unit
        Unit of the heights; "1" if unknown.
    """

    heights: Field
    times: Field
    states: NDArray[np.int8]
    surfaces: Field
    height_range: tuple[float, float]
    window: tuple[int, int]
    unit: str

    def area(self, number: int) -> int:
        """Sites in contact in one map."""
        return int(np.isin(self.states[number], (SiteState.KEPT, SiteState.NEW)).sum())

    def count(self, number: int, state: SiteState) -> int:
        """Sites of one state in one map."""
        return int((self.states[number] == state).sum())


def contact_maps(dataset: xr.Dataset) -> ContactMaps:
    """Compare the fields that a history kept with the first of them.

    Parameters
    ----------
    dataset
        The dataset of a `History` that kept fields (``fields_at``), with the relaxed state if
        `with_limit` added it.

    Returns
    -------
    ContactMaps

    Raises
    ------
    InputError
        The history kept no fields.
    """
    if "in_contact" not in dataset:
        raise InputError(
            "dataset", expected="a history that kept fields", got="none", advice="age(..., fields_at=[0.0])"
        )
    times = [float(t) for t in dataset["field_time"]]
    touching = list(np.asarray(dataset["in_contact"], dtype=bool))
    surfaces = list(np.asarray(dataset["u"], dtype=np.float64))
    if "in_contact_relaxed" in dataset:
        times.append(float("inf"))
        touching.append(np.asarray(dataset["in_contact_relaxed"], dtype=bool))
        surfaces.append(np.asarray(dataset["u_relaxed"], dtype=np.float64))
    origin = json.loads(dataset.attrs.get("surface", "{}"))
    heights = np.asarray(dataset["heights"], dtype=np.float64)
    return ContactMaps(
        heights=heights,
        times=np.asarray(times),
        states=np.stack([_compared(touching[0], now) for now in touching]),
        surfaces=np.stack(surfaces),
        height_range=color_range(heights),
        window=_busiest(touching[-1]),
        unit=str(origin.get("unit", "1")),
    )


def color_range(heights: Field) -> tuple[float, float]:
    """Range of all heights but the lowest and the highest 0.3 %: single spikes do not wash out a map."""
    low, high = np.percentile(heights, (0.3, 99.7))
    return float(low), float(high)


def _compared(before: Mask, now: Mask) -> NDArray[np.int8]:
    states = np.full(now.shape, SiteState.FREE, dtype=np.int8)
    states[before & now] = SiteState.KEPT
    states[~before & now] = SiteState.NEW
    states[before & ~now] = SiteState.LOST
    return states


def _busiest(touching: Mask) -> tuple[int, int]:
    sites = touching.shape[0]
    if touching.ndim == 2 or sites <= _WINDOW:
        return 0, sites
    counts = np.convolve(touching.astype(np.int64), np.ones(_WINDOW, dtype=np.int64), mode="valid")
    start = int(np.argmax(counts))
    return start, start + _WINDOW
