"""The campaigns of growth, and areas against time beside those of the dilute theory."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import product
from typing import Self

import numpy as np

import asperity.theory as theory
from asperity.surfaces import exponential, gaussian
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, Solid
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import crossing, slope

WINDOW = (10.0, 1e3)  # Reduced times k0 R t between which B is measured

HEIGHTS: Mapping[str, tuple[Callable[..., Field], Callable[[float], theory.HeightLaw]]] = {
    "gaussian": (gaussian, theory.GaussianHeights),
    "exponential": (exponential, theory.ExponentialHeights),
}
"""Surfaces that have a closed form, and their laws of heights, by kind."""

_MIDDLE, _LAST = 100.0, 1e6
"""Where its halves meet, and the end of the runs in which the end of the closed form is looked for."""

SIDE = 512
RATIO = 3.0  # k1/k0 where it is not varied
_SOLID = {"k0": 1.0, "k1": RATIO, "R": 1.0}

LIGHT, LIGHTEST = 1e-3, 1e-4  # Loads a site, over k0 and the rms height, of contacts far apart
LOADS = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0)
RATIOS = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
VISCOUS = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
RMS = 4.0
ZERO = 1e-3  # Where R_viscous = 0 is drawn
SIZES = (128, 256, 512)
SIZE_LOAD = 1e-2

HURST, CUTOFFS = (0.2, 0.5, 0.8), (2.0, 4.0, 8.0)
_WAVE_SIDE, _WAVE_SIZES = 256, (128, 512)

ENDING = (1e-3, 3e-3, 1e-2, 3e-2)  # Loads a site at which the end of the closed form is looked for
END = 0.9  # Area over that of the closed form at which this has come to its end


Number = Callable[[Field, Field], float]  # What is computed from times and areas, shapes (n,) and (runs, n)
Key = tuple[str, str, float]  # What is varied, on which surfaces or under which load, and its value


def campaigns(*, seeds: int, light: int | None = None) -> Iterator[Campaign]:
    """Give the campaigns, with so many surfaces each; where all loads are light, another number."""
    light, sites = light or seeds, SIDE**2

    def campaign(
        name: str,
        purpose: str,
        sweep: Mapping[str, object] | None = None,
        *,
        side: int = SIDE,
        load: float = LIGHT,
        surface: Mapping[str, object] | None = None,
        last: float = WINDOW[1],
    ) -> Campaign:
        return Solid("k1/k0 = 3" if name != "ratio" else "R = 1", _SOLID, load).campaign(
            name,
            f"Growth {purpose}",
            {"kind": "gaussian", "shape": [side, side], **(surface or {})},
            aging={"first": 0.1, "last": last, "per_decade": 4},
            sweep=sweep or {"seeds": seeds},
        )

    loads = [LIGHTEST * sites, LIGHT * sites]
    sweep = {"load": loads, "R_viscous": list(VISCOUS), "seeds": light}
    yield campaign("viscous", "for several R_viscous/R, under two loads", sweep)
    yield campaign("ratio", "for several k1/k0", {"k1": list(RATIOS), "seeds": light})
    sweep = {"load": [load * sites for load in LOADS], "seeds": seeds}
    yield campaign("load", "under several loads", sweep, last=_LAST)
    higher = "on higher heights under a load as much higher"
    yield campaign("rms", higher, load=RMS * LIGHT, surface={"rms": RMS})
    yield campaign("exponential", "on exponential heights", surface={"kind": "exponential"})
    rough = {"kind": "spectral", "hurst": 0.8, "roll_off": 32.0, "cutoff": 4.0, "rms_height": 1.0}
    sweep = {"hurst": list(HURST), "cutoff": list(CUTOFFS), "seeds": seeds}
    several = "on surfaces of several Hurst exponents and shortest wavelengths"
    yield campaign("waves", several, sweep, side=_WAVE_SIDE, load=SIZE_LOAD, surface=rough)
    for side in SIZES[:-1]:
        words = f"on independent heights, {side} along a side"
        yield campaign(f"side_{side}", words, side=side, load=SIZE_LOAD)
    for side in _WAVE_SIZES:
        words = f"on surfaces with waves, {side} sites along a side"
        yield campaign(f"waves_{side}", words, side=side, load=SIZE_LOAD, surface=rough)


def rate(time: Field, area: Field) -> float:
    """B in the window, of the mean over surfaces; times (n,), the first of them 0, and areas (runs, n)."""
    mean = area.mean(axis=0)
    return slope(time, mean, *WINDOW) / float(mean[0])


def relative_rate(time: Field, area: Field) -> float:
    """Return d ln A/d ln t in the window; arguments as for `rate`."""
    return slope(time, np.log(area.mean(axis=0)), *WINDOW)


def straightness(time: Field, area: Field) -> float:
    """B in the second half of the window over that in the first half; 1 for a logarithm."""
    mean = area.mean(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):  # an area that does not grow at first: no number
        return float(np.divide(slope(time, mean, _MIDDLE, WINDOW[1]), slope(time, mean, WINDOW[0], _MIDDLE)))


def end(time: Field, area: Field, closed: Field) -> tuple[float, float]:
    """Time at which the mean area falls to `END` of that of the closed form for good, and the area then.

    Times (n,) and areas (runs, n); NaN where it does not fall so far.
    """
    mean, over = area.mean(axis=0), area.mean(axis=0) / closed.mean(axis=0)
    above = np.flatnonzero(over >= END)
    last = int(above[-1]) if above.size else 0
    if last + 1 == len(time) or last == 0:
        return math.nan, math.nan
    at, part = crossing(time, over, last + 1, END)
    return at, float(mean[last] + part * (mean[last + 1] - mean[last]))


def closed_area(heights: theory.HeightLaw, load: float, time: Field, x1: float, viscous: float) -> Field:
    """Part of the sites in contact by the dilute theory, with k0 = 1: load a site, k1/k0, R_viscous/R."""
    return theory.dilute_area(load, theory.compliance(x1, time, viscous), heights)


@dataclass(frozen=True)
class Grown:
    """Areas of several surfaces against time, and those of the closed form.

    Load a site; sites; reduced times k0 R t, the first of which is 0, shape (n,); areas as a part of all
    sites, shape (runs, n); the same by the dilute theory with the heights of each surface, NaN where it has
    none; and on a surface without end, shape (n,).
    """

    load: float
    sites: int
    time: Field
    area: Field
    closed: Field
    endless: Field

    @property
    def limit(self) -> float:
        """B of the closed form on a surface without end; NaN where there is no closed form."""
        return math.nan if np.isnan(self.endless).any() else rate(self.time, self.endless[None])

    def number(self, of: Number, area: Field, closed: Field) -> float:
        """Return a number of some of the surfaces; where there is a closed form, by the ratio estimator."""
        value = of(self.time, area)
        if np.isnan(closed).any():
            return value
        with np.errstate(divide="ignore", invalid="ignore"):  # a closed form that does not grow: no number
            return float(np.divide(value, of(self.time, closed)) * of(self.time, self.endless[None]))


def _grown(evidence: Evidence, name: str, **at: float) -> Grown:
    """Read what grew at some values of the swept parameters; a load is that of a site."""
    tables = next(one.tables for one in campaigns(seeds=1) if one.name == name)
    surface, plotted = tables["surface"], math.prod(tables["surface"]["shape"])
    load = at.get("load", tables["contact"]["load"] / plotted)
    where = at | ({"load": load * plotted} if "load" in at else {})
    sites = int(evidence[name].sel(where)["sites"].max())
    time = np.array(evidence.values(name, "time"))
    area = evidence.samples(name, "area", **where) / sites
    closed, endless = np.full_like(area, np.nan), np.full_like(time, np.nan)
    if surface["kind"] in HEIGHTS:
        numbers, rms = (at.get("k1", RATIO), at.get("R_viscous", 0.0)), surface.get("rms", 1.0)
        endless = closed_area(HEIGHTS[surface["kind"]][1](rms), load, time, *numbers)
        for row, seed in enumerate(evidence[name]["seed"].values.tolist()):
            law = _empirical(surface["kind"], math.isqrt(sites), rms, seed)
            closed[row] = closed_area(law, load, time, *numbers)
    return Grown(load, sites, time, area, closed, endless)


@lru_cache(maxsize=64)
def _empirical(kind: str, side: int, rms: float, seed: int) -> theory.HeightLaw:
    """Law of the heights of one surface."""
    return theory.EmpiricalHeights(HEIGHTS[kind][0]((side, side), rms=rms, seed=seed))


GAUSSIAN, EXPONENTIAL = "independent heights", "exponential heights"
by_load, by_hurst = "load {:g}".format, "Hurst exponent {:g}".format  # Names of surfaces


class Sets(dict[Key, Grown]):
    """All sets of parameters."""

    @classmethod
    def of(cls, evidence: Evidence) -> Self:
        """Read them."""
        grown, waves = partial(_grown, evidence), by_hurst(0.8)
        sets = cls({("k1/k0", GAUSSIAN, x1): grown("ratio", k1=x1) for x1 in RATIOS})
        sets.update({("load", GAUSSIAN, load): grown("load", load=load) for load in LOADS})
        for load, r in product((LIGHTEST, LIGHT), VISCOUS):
            sets["R_viscous/R", by_load(load), r] = grown("viscous", load=load, R_viscous=r)
        for hurst, cutoff in product(HURST, CUTOFFS):
            sets["cutoff", by_hurst(hurst), cutoff] = grown("waves", hurst=hurst, cutoff=cutoff)
        aliases = {(GAUSSIAN, SIDE): sets["load", GAUSSIAN, SIZE_LOAD]}
        aliases[waves, _WAVE_SIDE] = sets["cutoff", waves, 4.0]
        for side, (name, surfaces) in product(SIZES, (("side", GAUSSIAN), ("waves", waves))):
            sets["side", surfaces, side] = aliases.get((surfaces, side)) or grown(f"{name}_{side}")
        sets["rms", GAUSSIAN, RMS] = grown("rms")
        sets["law", EXPONENTIAL, 1.0] = grown("exponential")
        return sets

    def along(
        self, of: str, surfaces: str = GAUSSIAN, low: float = -math.inf, high: float = math.inf
    ) -> dict[float, Grown]:
        """Return those in which one thing is varied on some surfaces, by its value, between two."""
        members = {at: one for (what, kind, at), one in self.items() if (what, kind) == (of, surfaces)}
        return {at: one for at, one in members.items() if low <= at <= high}
