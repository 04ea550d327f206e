"""What the studies of sliding share: two solids, what is read off a slide by whole sites, and lines.

Slides by whole sites resolve only contacts of several sites. On a line such contacts take few sites in all.
Each line slides twice, with a rest and with one of 1, the time of a shift. The difference of the two areas at
the same slip leaves out what differs from place to place, and D_c is the slip at which its mean has fallen
to 1/e of that at the end of the rest.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pandas as pd
import xarray as xr

from asperity.analysis import patches
from asperity.fits import Estimate, jackknife
from asperity.surfaces import spectral
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, Solid, hold, slide
from asperity_research.studies.evidence import Evidence
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
        estimates = jackknife(self.slips, self.excess)
        head = {"family": self.name, "length": self.length, **more}
        return pd.DataFrame(head | columns("slip", estimates) | {"runs": estimates.runs})


REST = "protocol.1.duration"
_ON_LINES = {
    "half_space": (replace(HALF_SPACE, load=0.1), 1e3, style.BLUE),
    "lattice": (replace(LATTICE, load=0.3), 10.0, style.INK),
}
"""Solids, with the load of a site; hold times; colors."""

Waves = tuple[tuple[float, float], ...]  # Longest and shortest wavelengths
_ALL = ((64.0, 16.0), (128.0, 32.0), (256.0, 64.0))
_LONGEST = ((64.0, 32.0), (128.0, 32.0), (256.0, 32.0))
LINES: Mapping[str, tuple[str, str, Waves, str]] = {
    "line_half_space": ("all waves longer, half-space", "half_space", _ALL, "s-"),
    "line_longest": ("only the longest waves longer, half-space", "half_space", _LONGEST, "^-"),
    "line_lattice": ("all waves longer, lattice of springs", "lattice", _ALL, "o-"),
}
"""By name: words, solid, longest and shortest wavelengths, and marks."""
LINE_LOOKS = {name: (mark, _ON_LINES[solid][2], words) for name, (words, solid, _, mark) in LINES.items()}


def line_campaigns(surfaces: int) -> Iterator[Campaign]:
    """Give the campaigns, with so many lines each."""
    conditions = {(solid, *waves): None for _, solid, every, _ in LINES.values() for waves in every}
    for name, roll_off, cutoff in conditions:
        solid, rest, _ = _ON_LINES[name]
        slip = max(1.5 * cutoff, 0.375 * roll_off)
        run_in = round(slip * 2 / 3)
        rough = {"hurst": 0.8, "roll_off": roll_off, "cutoff": cutoff, **solid.rough}
        yield solid.campaign(
            _folder(name, roll_off, cutoff),
            f"A slide after a rest and after hardly one, lines with waves from {cutoff:g} to {roll_off:g}",
            {"kind": "spectral", "shape": [max(2048, int(16 * roll_off))], **rough},
            aging={"first": 1.0, "per_decade": 1, "rtol": 0.05},
            protocol=[slide(run_in), hold(rest), slide(slip)],
            output={"maps_at": [float(run_in)]},
            sweep={REST: [1.0, rest], "seeds": surfaces},
        )


def _folder(solid: str, roll_off: float, cutoff: float) -> str:
    return f"line_{solid}_{roll_off:g}_{cutoff:g}"


def slip_to_one_over_e(excess: Field) -> float:
    """Slip at which an excess, at slips of 0, 1, 2 and so on, first falls to 1/e; NaN if it does not."""
    below = excess < excess[0] / math.e
    at = int(np.argmax(below))
    if not below[at]:
        return math.nan
    return float(at - (excess[0] / math.e - excess[at]) / (excess[at - 1] - excess[at]))


@dataclass(frozen=True, eq=False)
class Lines(Slips):
    """All lines of one family; for each length the mean length of a contact by site, before the rest."""

    slip: Callable[[Field], float] = slip_to_one_over_e
    patch: tuple[Field, ...] = ()

    @classmethod
    def of(cls, evidence: Evidence, name: str, every: Waves | None = None) -> Self:
        """Read them from the campaigns of the family, or of some of its wavelengths."""
        _, solid, all_of_it, _ = LINES[name]
        every = every or all_of_it
        sizes, excesses = [], []
        for waves in every:
            folder = _folder(solid, *waves)
            data, rests = evidence[folder], evidence.values(folder, REST)
            rows, longer = [], []
            for seed in data["seed"].values.tolist():
                hardly, rested = (after_rest(data.sel({REST: rest, "seed": seed})) for rest in rests)
                rows.append(rested - hardly)
                fields = evidence.fields(folder, **{REST: rests[-1], "seed": seed})
                patch_sizes = patches(fields["in_contact"].values[0]).sizes
                longer.append((patch_sizes**2).sum() / patch_sizes.sum())
            sizes.append(np.array(longer))
            excesses.append(np.array(rows))
        lengths = np.array([correlation_length(*waves, shape=(2**16,)) for waves in every])
        return cls(name, lengths, tuple(excesses), patch=tuple(sizes))

    def of_patch(self) -> Estimate:
        """Power of the mean length of a contact in D_c."""
        several = len(self.patch)

        def statistic(*some: Field) -> float:
            return power(np.array([one.mean() for one in some[:several]]), self.slips(*some[several:]))

        return jackknife(statistic, (*self.patch, *self.excess))

    def contacts(self) -> pd.DataFrame:
        """Return the contacts and D_c, a row each length."""
        return self.table(patch=[one.mean() for one in self.patch])
