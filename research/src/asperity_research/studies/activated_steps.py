r"""Two-step loads with creep that stress and heat activate.

A contact is held under a load for a waiting time t_w; then the load falls at once to a part of it, and stays.
Creep follows Eyring's law v0 sinh(s/s0), and linear laws on the same surfaces stand beside it. The unit of
time is s0/(k1 v0): the relaxation time of a creeping spring under a small force.

While s >> s0 the force that a contact still bears after a time t is about s0 ln(2/t), whatever it was at
first. A load that falls at t_w leaves contacts with a mean force s_2 below the mean s_1 before. They
flow again once s0 ln(2/t) has come down to s_2, that is, at the time t_r with

    ln(t_r/t_w) = (s_1 - s_2)/s0,       d ln t_r/d ln t_w = d s_2/d s_1 ,

a number below 1 where s_2 is a fixed part of s_1. This is an estimate from mean forces, not a theorem.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from asperity.fits import Estimate, jackknife
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, Solid, after_waits, waves
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import all_columns, columns, crossing, mean, slope, vertex

_STEPS = (1e-6, 1e-4, 1e-2, 1.0)
_DECADES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0)
_LINEAR = (0.1, 1.0, 10.0, 100.0, 1e3)
SIDE = 64  # Sites along a side
LOAD = 0.05  # Load a site before the step
ROUGH = waves(SIDE, 16.0)  # The table of the surface, without its height


def _eyring(stress: float, stiffness: float) -> dict[str, Any]:
    """Eyring's law whose linear limit relaxes a spring of this stiffness in a time of 1."""
    return {"creep": "eyring", "creep_rate": stress / stiffness, "creep_stress": stress}


def _springs(words: str, waits: tuple[float, ...], ratios: tuple[float, ...], **table: Any) -> Solid:
    return Solid(words, {"k0": 1.0, "k1": 3.0, "R": 0.0} | table, LOAD, waits, ratios)


def eyring_lattice(
    stress: float, waits: tuple[float, ...] = (), ratios: tuple[float, ...] = (), k0: float = 1.0
) -> Solid:
    """Return a lattice of springs, or a bed of them without k0, with Eyring's law of this stress s0."""
    words = f"{'lattice of' if k0 else 'independent'} springs, s0 = {stress:g}"
    return _springs(words, waits, ratios, k0=k0, **_eyring(stress, 3.0))


def _half_space(words: str, waits: tuple[float, ...], ratios: tuple[float, ...], **table: Any) -> Solid:
    return Solid(words, {"kind": "half_space", "modulus": 1.0} | table, LOAD, waits, ratios)


_LOGARITHM = {"branches": [[0.06, 10.0**decade] for decade in range(-7, 6)]}
SOLIDS = {
    "lattice": eyring_lattice(0.05, _DECADES, (0.2, 0.5)),
    "lighter": eyring_lattice(0.05, _STEPS, (0.8,)),
    "cold": eyring_lattice(0.025, _STEPS, (0.5,)),
    "warm": eyring_lattice(0.1, _STEPS, (0.5,)),
    "bed": eyring_lattice(0.05, _STEPS, (0.5,), k0=0.0),
    "half_space": _half_space(
        "half-space in series with creep, s0 = 0.05", _STEPS, (0.5, 0.8), **_eyring(0.05, 1.0)
    ),
    "viscous": _springs("linear lattice, R_viscous = 1/3", _LINEAR, (0.2,), R_viscous=1 / 3),
    "conserved": _springs("linear lattice, R = 1", _LINEAR, (0.2,), R=1.0),
    "logarithm": _half_space(
        "linear half-space, E(t) like ln t", (1e-3, 1e-2, 0.1, 1.0), (0.5,), **_LOGARITHM
    ),
}
"""By the names of their campaigns. k1 = 3 k0 and E* = 1; M k1 = 1 in the linear limit of each lattice."""

IN_SERIES = ("bed", "half_space")  # Solids whose whole stiffness creeps


def campaigns(surfaces: int, every: int) -> Iterator[Campaign]:
    """Give the campaigns, with so many surfaces each and every so many waiting times."""
    for name, solid in SOLIDS.items():
        for ratio in solid.steps:
            yield solid.campaign(
                f"{name}_{ratio:g}",
                f"Area after the load has fallen to {ratio:g} of it, waiting time as a factor on creep",
                ROUGH | solid.rough,
                aging={"first": 1e-2, "per_decade": 4, "rtol": 5e-3},
                **after_waits({"load": ratio * (LOAD * SIDE**2)}, solid.waits[::every], 1e5, surfaces),
            )


FELL = 0.01  # Lost part of the area from which on it counts as a fall
RISE = 1.03  # Area over the smallest one so far at which growth counts as resumed
Reading = Callable[[Field, Field], float]
"""What is read off times since the step, the first 0, and areas, shape (n,)."""


def time_of_minimum(time: Field, area: Field) -> float:
    """Time at which an area is smallest: that of the parabola in ln t through it and its neighbors.

    NaN where the area does not fall by a part `FELL`, or is smallest at the end.
    """
    at = int(np.argmin(area))
    if area[at] > (1 - FELL) * area[0] or at == area.size - 1:
        return math.nan
    return float(time[1]) if at == 1 else vertex(time, area, at)


def time_of_growth(time: Field, area: Field) -> float:
    """Time at which an area first exceeds the smallest one so far by 3 %."""
    over = area / np.minimum.accumulate(area)
    at = int(np.argmax(over > RISE))
    if not over[at] > RISE:
        return math.nan
    return float(time[1]) if at == 1 else crossing(time, over, at, RISE)[0]


@dataclass(frozen=True, eq=False)
class Steps:
    """All histories of a load that falls: one solid, one ratio of the load after the step over that before.

    Waiting times, shape (waits,); the load before the step; times since the step over the waiting time, of
    which the first is 0; areas before it, shape (surfaces, waits), and after it, (surfaces, waits, times).
    """

    name: str
    ratio: float
    wait: Field
    load: float
    time: Field
    before: Field
    area: Field

    @classmethod
    def of(cls, evidence: Evidence, name: str, ratio: float) -> Steps:
        """Read them from a campaign."""
        wait, some = zip(*evidence.waits(f"{name}_{ratio:g}"), strict=True)
        before = np.stack([one.before for one in some], axis=1)
        area = np.stack([one.after for one in some], axis=1)
        return cls(name, ratio, np.array(wait), LOAD * SIDE**2, some[0].time, before, area)

    @property
    def words(self) -> str:
        """Which ones, for a reader."""
        return f"{SOLIDS[self.name].what}, load × {self.ratio:g}"

    @property
    def creep_stress(self) -> float:
        """s0; 0 for a linear solid."""
        return float(SOLIDS[self.name].table.get("creep_stress", 0.0))

    @property
    def head(self) -> dict[str, object]:
        """What they are of, as columns."""
        return {"solid": self.name, "load_ratio": self.ratio}

    def times(self, of: Reading, area: Field) -> Field:
        """Return ln(time / waiting time) at each wait, for a sample of areas after the step."""
        return np.log([of(self.time, one) for one in area.mean(axis=0)])

    def estimated(self, before: Field, area: Field) -> Field:
        """Return ln(t_r/t_w) = (s_1 - s_2)/s0 from mean forces before and after the step; NaN without s0."""
        first = self.load / before.mean(axis=0)
        then = self.ratio * self.load / area[:, :, 0].mean(axis=0)
        return np.asarray((first - then) / (self.creep_stress or math.nan))

    def _slope(self, of: Reading, statistic: Callable[[Field, Field], Field]) -> Estimate | None:
        """Slope against ln t_w, where every sample has that time; None for fewer than three waits."""
        shared = np.isfinite(jackknife(partial(self.times, of), self.area).high)
        if shared.sum() < 3 or np.isnan(statistic(self.before, self.area)[shared]).any():
            return None
        samples = (self.before, self.area)
        return jackknife(lambda *some: slope(self.wait[shared], statistic(*some)[shared]), samples)

    def power(self, of: Reading) -> Estimate | None:
        """Power of the waiting time in a time; None where fewer than three waits have one in every sample."""
        return self._slope(of, lambda _, area: np.log(self.wait) + self.times(of, area))

    def estimated_power(self) -> Estimate | None:
        """Power of the waiting time in the estimate, at the waits at which growth resumes."""
        return self._slope(time_of_growth, lambda *some: np.log(self.wait) + self.estimated(*some))

    def excess(self) -> Estimate | None:
        """Power of the waiting time in t_r less that of the estimate, where both are known."""
        of = time_of_growth
        return self._slope(of, lambda before, area: self.times(of, area) - self.estimated(before, area))

    def deepest(self) -> Estimate:
        """Largest over the waits of the lost area, the mean over the surfaces."""
        return jackknife(lambda area: (1 - area.min(axis=2) / area[:, :, 0]).mean(axis=0).max(), self.area)

    def rows(self) -> pd.DataFrame:
        """Return areas, lost area and times, a row each waiting time."""
        logarithms = all_columns(
            minimum=jackknife(partial(self.times, time_of_minimum), self.area),
            growth=jackknife(partial(self.times, time_of_growth), self.area),
        ) | {"growth_estimated": self.estimated(self.before, self.area)}
        areas = {
            "waiting_time": self.wait,
            "surfaces": len(self.area),
            "area_before": self.before.mean(axis=0),
            "area_after": self.area[:, :, 0].mean(axis=0),
        }
        found = {name: np.exp(values) for name, values in logarithms.items()}
        depth = mean(1 - self.area.min(axis=2) / self.area[:, :, 0])
        return pd.DataFrame(self.head | areas | columns("depth", depth) | found)

    def powers(self) -> dict[str, object]:
        """Return the lost area and the powers of the waiting time."""
        head = self.head | {"surfaces": len(self.area)}
        return head | all_columns(
            depth=self.deepest(),
            minimum=self.power(time_of_minimum),
            growth=self.power(time_of_growth),
            estimated=self.estimated_power(),
        )

    def curves(self) -> pd.DataFrame:
        """Return the mean area over that just after the step, for each waiting time."""
        course = {
            "waiting_time": np.repeat(self.wait, self.time.size),
            "time": np.tile(self.time, self.wait.size),
            "area": (self.area / self.area[:, :, :1]).mean(axis=0).ravel(),
        }
        return pd.DataFrame(self.head | course)
