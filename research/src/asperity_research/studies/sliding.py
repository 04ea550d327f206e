"""What the studies of sliding share: two solids, and what is read off a slide by whole sites."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
import xarray as xr

from asperity.fits import Estimate, jackknife
from asperity.surfaces import spectral
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Solid
from asperity_research.studies.numbers import columns, power

STEADY = 8  # Shifts at the end of a slide that count as steady
LATTICE = Solid("lattice of springs, conserved creep", {"k0": 1.0, "k1": 3.0, "R": 1.0}, 0.01)
HALF_SPACE = Solid(
    "half-space, E(t) like ln t",
    {"kind": "half_space", "modulus": 1.0, "branches": [[0.06, 10.0**decade] for decade in range(-3, 7)]},
    0.02,
)


def before_shifts(one: xr.Dataset, leg: int) -> Field:
    """Area in a slide at the end of each time between shifts, shape (shifts,)."""
    chosen = one["leg"].values == leg
    place, area = one["displacement"].values[chosen], one["area"].values[chosen]
    last = np.append(np.diff(place) > 0, True)
    return np.asarray(area[last & (place > 0)], dtype=np.float64)


def steady_area(one: xr.Dataset, leg: int) -> float:
    """Mean area before the last shifts of a slide."""
    return float(before_shifts(one, leg)[-STEADY:].mean())


def after_rest(one: xr.Dataset) -> Field:
    """Area at the end of a rest, the second leg, and before each shift of the slide that follows."""
    return np.append(one["area"].values[one["leg"].values == 1][-1], before_shifts(one, 2))


def correlation_length(roll_off: float, cutoff: float, shape: tuple[int, ...] = (512, 512)) -> float:
    """Distance at which the correlation of such heights has fallen to 1/e, in sites, by their spectrum."""
    heights = spectral(shape, hurst=0.8, roll_off=roll_off, cutoff=cutoff, rms_height=1.0, seed=0)
    square = np.abs(np.fft.fft(heights.reshape(-1, shape[-1]), axis=1)) ** 2
    row = np.fft.ifft(np.mean(square, axis=0)).real
    falls = int(np.argmax(row < row[0] / math.e))
    high, low = row[falls - 1] / row[0], row[falls] / row[0]
    return float(falls - 1 + (high - 1 / math.e) / (high - low))


@dataclass(frozen=True, eq=False)
class Slips:
    """What a rest adds to the area of surfaces of several correlation lengths, and the slip that forgets it.

    Correlation lengths in sites, shape (n,); for each the excess at slips of 0, 1, 2 and so on, shape
    (surfaces, slips); and what reads the slip off the mean excess.
    """

    name: str
    length: Field
    excess: tuple[Field, ...]
    slip: Callable[[Field], float]

    def slips(self, *excess: Field) -> Field:
        """D_c for each length, of samples of `excess`."""
        return np.array([self.slip(one.mean(axis=0)) for one in excess])

    def of_length(self) -> Estimate:
        """Power of the correlation length in D_c."""
        return jackknife(lambda *some: power(self.length, self.slips(*some)), self.excess)

    def table(self, **more: object) -> pd.DataFrame:
        """Return D_c, a row each length, beside more columns."""
        found = jackknife(self.slips, self.excess)
        head = {"family": self.name, "length": self.length, **more}
        return pd.DataFrame(head | columns("slip", found) | {"runs": found.runs})
