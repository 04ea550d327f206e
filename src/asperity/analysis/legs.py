"""The legs of a history, one by one: what each prescribes, and what the contact was before and after it."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from asperity.protocols import Hold, Leg
from asperity.protocols.legs import leg_of, legs_of
from asperity.results.history import check_dataset


@dataclass(frozen=True)
class LegRow:
    """One leg of a history.

    Attributes
    ----------
    number
        From 0, repetitions counted one by one, as in the coordinate ``leg`` of the dataset.
    leg
        What it prescribes.
    begin, end
        Times; equal for a step.
    load, separation, area
        Values at the beginning and at the end (for a step: before and after), in the units of the dataset;
        NaN where the history was not recorded at that time.
    lowest_area, lowest_after
        The smallest recorded area, its beginning included, in sites, and the time from the beginning of the
        leg until then (the first time); NaN where nothing was recorded.
    """

    number: int
    leg: Leg
    begin: float
    end: float
    load: tuple[float, float]
    separation: tuple[float, float]
    area: tuple[float, float]
    lowest_area: float
    lowest_after: float

    @property
    def kind(self) -> str:
        """``"hold"``, ``"ramp"``, ``"step"`` or ``"slide"``."""
        return type(self.leg).__name__.lower()


def leg_table(dataset: xr.Dataset) -> list[LegRow]:
    """List the legs of a history with the states at their ends.

    Parameters
    ----------
    dataset
        The dataset of a `History`. Without a protocol it is one hold.

    Returns
    -------
    list of LegRow
        Empty for a history without a protocol that ends at time 0; without the legs after bodies part.
    """
    check_dataset(dataset)
    lasted = float(dataset["time"].values[-1])
    if not (protocol := protocol_of(dataset)):
        return [_row(dataset, 0, Hold(lasted), 0.0, lasted)] if lasted > 0 else []
    spans = pairwise(json.loads(dataset.attrs["switches"]))
    parted = dataset.attrs.get("pulled_off", math.inf)
    reached = int(numbers_of(dataset).max()) + 1 if parted < math.inf else None
    return [
        _row(dataset, number, leg, begin, min(end, parted))
        for number, (leg, (begin, end)) in enumerate(zip(legs_of(protocol), spans, strict=True))
    ][:reached]


def protocol_of(dataset: xr.Dataset) -> list[Leg]:
    """Protocol that a history followed, as it was given to `asperity.age`; empty if there was none."""
    return [leg_of(values) for values in json.loads(dataset.attrs.get("protocol", "[]"))]


def numbers_of(dataset: xr.Dataset) -> NDArray[np.int_]:
    """Number of the leg to which each entry belongs, shape ``(n,)``."""
    alone = np.zeros(dataset.sizes["time"], dtype=int)
    return dataset["leg"].values if "leg" in dataset.coords else alone


def _row(dataset: xr.Dataset, number: int, leg: Leg, begin: float, end: float) -> LegRow:
    time, numbers = dataset["time"].values, numbers_of(dataset)
    at_leg = np.flatnonzero(numbers == number)
    # The entry at a switch belongs to the leg that ends there, and that of time 0 to the first leg.
    first = at_leg[:1] if number == 0 else np.flatnonzero(numbers < number)[-1:]
    first = first[time[first] == begin]
    at_leg = np.setdiff1d(at_leg, first)
    last = at_leg[-1:][time[at_leg[-1:]] == end]

    def at(name: str, entries: NDArray[np.int_]) -> float:
        return float(dataset[name].values[entries[0]]) if entries.size else math.nan

    entries = np.concatenate([first, at_leg])
    lowest = entries[np.argsort(dataset["area"].values[entries], kind="stable")[:1]]
    names = ("load", "separation", "area")
    load, separation, area = ((at(name, first), at(name, last)) for name in names)
    lowest_after = at("time", lowest) - begin
    return LegRow(number, leg, begin, end, load, separation, area, at("area", lowest), lowest_after)
