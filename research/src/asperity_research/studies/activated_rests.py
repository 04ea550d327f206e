"""Slide, hold, slide, and two steps of the velocity, at several temperatures."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from asperity.fits import Estimate, jackknife
from asperity_research.arrays import Field
from asperity_research.studies.activated_steps import LOAD, ROUGH, SIDE, eyring_lattice
from asperity_research.studies.campaigns import Campaign, hold, slide, zipped
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import all_columns, power
from asperity_research.studies.sliding import before_shifts, steady_area

TEMPERATURES = (0.015, 0.03, 0.06)  # kT over the activation volume, which is s0 too
_BARRIER, _PREFACTOR = 1.0, 1e3
_HOLD = 1e5
_SLIDES = (16, 8, 12, 12)
_VELOCITIES = (1.0, 1.0, 100.0, 0.01)


def sliding(surfaces: int, temperatures: tuple[float, ...]) -> Campaign:
    """Return the campaign."""
    slides = [slide(*one) for one in zip(_SLIDES, _VELOCITIES, strict=True)]
    solid = replace(eyring_lattice(temperatures[0]), what="lattice of springs")
    rates = [_PREFACTOR * math.exp(-_BARRIER / kT) for kT in temperatures]
    return solid.campaign(
        "sliding",
        "Slide, hold, slide, and two steps of the velocity, at several temperatures",
        ROUGH | solid.rough,
        friction={"shear_strength": 1.0},
        aging={"first": 1.0, "per_decade": 1, "rtol": 0.02},
        protocol=[slides[0], hold(_HOLD), *slides[1:]],
        sweep=zipped(surfaces, creep_stress=temperatures, creep_rate=rates),
    )


@dataclass(frozen=True, eq=False)
class Rests:
    """Slide, hold, slide at several temperatures: kT over the activation volume, shape (temperatures,).

    Times at rest, shape (times,); area then over that just before, shape (surfaces, temperatures, times); and
    area in steady sliding at each of `_VELOCITIES` but the first, shape (surfaces, temperatures, 3).
    """

    temperature: Field
    time: Field
    rest: Field
    steady: Field

    @classmethod
    def of(cls, evidence: Evidence) -> Rests:
        """Read them from the campaign."""
        data = evidence["sliding"]
        temperature = data["creep_stress"].values.astype(np.float64)
        rest, steady = [], []
        for seed in data["seed"].values:
            runs = [data.sel(seed=seed).isel(point=point) for point in range(len(temperature))]
            before = [before_shifts(one, 0)[-1] for one in runs]
            held = [one["area"].values[one["leg"].values == 1] for one in runs]
            rest.append([area / start for area, start in zip(held, before, strict=True)])
            steady.append([[steady_area(one, leg) for leg in (2, 3, 4)] for one in runs])
        one = data.isel(seed=0, point=0)
        time = one["time"].values[one["leg"].values == 1] - _SLIDES[0] / _VELOCITIES[0]
        return cls(temperature, time, np.array(rest), np.array(steady))

    @property
    def late(self) -> Field:
        """Which times at rest count for B: those in which a slide would have passed several contacts."""
        return np.asarray(self.time >= 10)

    def growth(self, rest: Field) -> Field:
        """B, the growth at rest for every e-fold of time over the area before, at each temperature."""
        slopes: Field = np.polyfit(np.log(self.time[self.late]), rest.mean(axis=0)[:, self.late].T, 1)[0]
        return slopes

    def fall(self, steady: Field) -> Field:
        """Fall of the area in steady sliding for every e-fold of the velocity, over that at 1."""
        mean = steady.mean(axis=0)
        order = np.log(_VELOCITIES[1:])
        slopes: Field = np.polyfit(order, (mean / mean[:, :1]).T, 1)[0]
        return -slopes

    def force(self, steady: Field, rest: Field) -> Field:
        """Mean force of a contact at rest, in the middle of the times that count."""
        area = steady[:, :, :1] * rest[:, :, self.late]
        return np.asarray(LOAD * SIDE**2 / np.exp(np.log(area.mean(axis=0)).mean(axis=1)))

    def numbers(self) -> dict[str, dict[str, Estimate]]:
        """Return what decides the claims on friction at rest, by claim."""
        at, both = self.temperature, (self.rest, self.steady)
        temperature = jackknife(lambda rest: power(at, self.growth(rest)), self.rest)
        slope = jackknife(
            lambda rest, steady: (self.growth(rest) / (at / self.force(steady, rest))).mean(), both
        )
        fall = jackknife(lambda rest, steady: (self.fall(steady) / self.growth(rest)).mean(), both)
        return {
            "temperature": {"power of <i>T</i> in B": temperature},
            "slope": {"B s/s0, mean over temperatures": slope},
            "steady": {"b of steady sliding over B, mean over temperatures": fall},
        }

    def table(self) -> pd.DataFrame:
        """B at rest and in steady sliding, and s0/s, at each temperature."""
        stress = self.temperature / self.force(self.steady, self.rest)
        head = {"kT": self.temperature, "s0_over_s": stress, "surfaces": len(self.rest)}
        rest, steady = jackknife(self.growth, self.rest), jackknife(self.fall, self.steady)
        return pd.DataFrame(head | all_columns(rest=rest, steady=steady))
