r"""Study: how the growth rate of the contact area depends on mobilities, stiffness, load, roughness and size.

The solid is the paper's lattice of springs (E. A. Jagla, *Towards a modeling of the time dependence of
contact area between solid bodies*). Under a constant load, and between two reduced times x2 = k0 R t,

    B = d(A/A(0))/d ln t,        relative rate = d ln A/d ln t,

both by straight lines in ln t through the mean over surfaces. While contacts are too far apart to feel each
other, the dilute theory (`theory.dilute_area`) gives A(t) from the heights alone,

    N0 E[(xi - d)+] = F G(x1, x2)/k0,      A = N0 Prob(xi > d),

so that B has a closed form: the same line through that A at the same times. For exponential heights it tends
to k_eff/(8 pi k0), and to twice that with R_viscous; the paper has 0.04 k1/k0.

Few contacts are much noise, but the closed form can be computed with the heights of the same surfaces. So on
independent heights B is that of the simulations, over that of the closed form with these heights, times that
of the closed form on a surface without end (a ratio estimator). B of waves is that of the simulations.

(k0, k1, F, 1/R) times a number leave A(t) alone, and so do (heights, F) times a number. So k0 = R = 1 here,
and a larger rms height is a smaller load.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import product
from typing import Any, Self

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import asperity.theory as theory
from asperity.fits import Estimate, jackknife
from asperity.surfaces import exponential, gaussian
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, Solid
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import all_columns, crossing, power, slope
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)
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
        found = of(self.time, area)
        if np.isnan(closed).any():
            return found
        with np.errstate(divide="ignore", invalid="ignore"):  # a closed form that does not grow: no number
            return float(np.divide(found, of(self.time, closed)) * of(self.time, self.endless[None]))


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


def _combined(
    combine: Callable[[Field], float],
    number: Callable[[Grown, Field, Field], float | tuple[float, float]],
    sets: Sequence[Grown],
) -> Estimate:
    """Combine what is computed of areas and closed forms of some sets, of as many surfaces each."""

    def statistic(*arrays: Field) -> float:
        each = zip(sets, arrays[::2], arrays[1::2], strict=True)
        return combine(np.array([number(*one) for one in each]))

    return jackknife(statistic, tuple(array for one in sets for array in (one.area, one.closed)))


def _estimate(combine: Callable[[Field], float], *sets: Grown, of: Number = rate) -> Estimate:
    return _combined(combine, lambda one, area, closed: one.number(of, area, closed), sets)


def _over(one: Grown, other: Grown | float = 1.0, of: Number = rate) -> Estimate:
    """A number of one set over that of another, or over a number."""
    if isinstance(other, Grown):
        return _estimate(lambda numbers: float(numbers[0] / numbers[1]), one, other, of=of)
    return _estimate(lambda numbers: float(numbers[0] / other), one, of=of)


def _exponent(sets: Mapping[float, Grown], of: Number = rate) -> Estimate:
    """Slope of the logarithm of a rate against that of what is varied; NaN for an area that does not grow."""
    at = np.array(list(sets))
    return _estimate(lambda rates: power(at, rates) if (rates > 0).all() else math.nan, *sets.values(), of=of)


def _exponent_of_end(sets: Sequence[Grown]) -> Estimate:
    """Slope of the logarithm of the time at which the closed form ends against that of the area then."""
    return _combined(
        lambda ends: power(ends[:, 1], ends[:, 0]), lambda one, *areas: end(one.time, *areas), sets
    )


def _row(key: Key, found: Grown) -> dict[str, Any]:
    """Everything that is said of one set of parameters."""
    return {
        **dict(zip(("of", "surfaces", "at"), key, strict=True)),
        "load": found.load,
        "sites": found.sites,
        "area_at_first": found.area[:, 0].mean(),
        "area_at_last": found.area[:, found.time <= WINDOW[1] * (1 + 1e-9)][:, -1].mean(),
        **all_columns(
            B=_over(found),
            over_closed=_over(found, found.limit),
            relative=_over(found, of=relative_rate),
            straightness=_over(found, of=straightness),
        ),
        "closed": found.limit,
        "runs": len(found.area),
    }


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
        known = {(GAUSSIAN, SIDE): sets["load", GAUSSIAN, SIZE_LOAD]}
        known[waves, _WAVE_SIDE] = sets["cutoff", waves, 4.0]
        for side, (name, surfaces) in product(SIZES, (("side", GAUSSIAN), ("waves", waves))):
            sets["side", surfaces, side] = known.get((surfaces, side)) or grown(f"{name}_{side}")
        sets["rms", GAUSSIAN, RMS] = grown("rms")
        sets["law", EXPONENTIAL, 1.0] = grown("exponential")
        return sets

    def along(
        self, of: str, surfaces: str = GAUSSIAN, low: float = -math.inf, high: float = math.inf
    ) -> dict[float, Grown]:
        """Return those in which one thing is varied on some surfaces, by its value, between two."""
        own = {at: one for (what, kind, at), one in self.items() if (what, kind) == (of, surfaces)}
        return {at: one for at, one in own.items() if low <= at <= high}


def _numbers(sets: Sets) -> dict[str, Estimate | dict[str, Estimate]]:
    """Return what decides the claims, by claim; under light loads, where nothing else is said."""
    viscous = {load: sets.along("R_viscous/R", by_load(load)) for load in (LIGHTEST, LIGHT)}
    loads, law = sets.along("load"), sets["law", EXPONENTIAL, 1.0]
    waves = {hurst: sets.along("cutoff", by_hurst(hurst)) for hurst in HURST}
    sides = {GAUSSIAN: sets.along("side"), "waves from 4 sites": sets.along("side", by_hurst(0.8))}

    def closed(some: Mapping[float, Grown]) -> dict[str, Estimate]:
        """B over that of the closed form; the same whether both are of these surfaces or without end."""
        return {f"{at:g}": _over(one, one.limit) for at, one in some.items()}

    return {
        "ratio": closed(sets.along("k1/k0")),
        "proportional": {
            "up to 1": _exponent(sets.along("k1/k0", high=1.0)),
            "from 3 on": _exponent(sets.along("k1/k0", low=3.0)),
        },
        "relative": _exponent(sets.along("k1/k0", low=1.0), relative_rate),
        **{f"viscous {load:g}": closed(some) for load, some in viscous.items()},
        "doubles": {
            f"{r:g} over that at 0, load a site {load:g}": _over(one, some[0.0])
            for load, some in viscous.items()
            for r, one in some.items()
            if r >= 1.0
        },
        "load": closed(loads),
        "load_free": {
            f"{low:g} to {high:g}": _exponent(sets.along("load", low=low, high=high))
            for low, high in ((LIGHTEST, LIGHT), (SIZE_LOAD, 0.3))
        },
        "logarithm": {f"{load:g}": _over(one, of=straightness) for load, one in loads.items()},
        "logarithm_waves": {
            by_hurst(hurst): _over(some[4.0], of=straightness) for hurst, some in waves.items()
        },
        "end": _exponent_of_end([loads[at] for at in ENDING]),
        "rms": _over(sets["rms", GAUSSIAN, RMS], loads[LIGHT]),
        "law": {
            "<i>k</i><sub>eff</sub>/(8 pi <i>k</i><sub>0</sub>)": _over(law, float(theory.late_slope(RATIO))),
            "that of the closed form: exponential heights, rms 1": _over(law, law.limit),
        },
        "waves": {by_hurst(hurst): _exponent(some) for hurst, some in waves.items()},
        "hurst": {f"{wave:g}": _over(waves[0.8][wave], waves[0.2][wave]) for wave in CUTOFFS},
        "size": {
            f"{side} sites along a side over that at {SIDE}: {words}": _over(some[side], some[SIDE])
            for words, some in sides.items()
            for side in SIZES[:-1]
        },
    }


def analyse(evidence: Evidence) -> Outcome:
    """Find B for all parameters, and compare it with the closed forms."""
    sets = Sets.of(evidence)
    courses = []
    for load, one in sets.along("load").items():
        area, closed = one.area.mean(axis=0)[1:], one.closed.mean(axis=0)[1:]
        course = {"load": load, "time": one.time[1:], "area": area, "over_closed": area / closed}
        courses.append(pd.DataFrame(course))
    tables = {
        "points": pd.DataFrame([_row(key, found) for key, found in sets.items()]),
        "lines": _lines(),
        "courses": pd.concat(courses, ignore_index=True),
    }
    findings = []
    for key, numbers in _numbers(sets).items():
        claim, _, at = key.partition(" ")
        findings.append(WORDS.judge(claim, numbers, key=key.replace(" ", "_"), load=float(at or 0)))
    return Outcome(tuple(findings), tables)


def _lines() -> pd.DataFrame:
    """Closed forms on surfaces without end."""
    time = np.append(0.0, np.geomspace(*WINDOW, 9))
    law = theory.GaussianHeights(1.0)

    def closed(load: float, x1: float = RATIO, r: float = 0.0) -> float:
        return rate(time, closed_area(law, load, time, x1, r)[None])

    ratios = np.geomspace(RATIOS[0], RATIOS[-1], 25).tolist()
    loads = np.geomspace(LOADS[0], LOADS[-1], 25).tolist()
    viscous = np.geomspace(ZERO, VISCOUS[-1], 31).tolist()
    lines: list[tuple[str, str, list[float], list[float]]] = [
        ("k1/k0", "closed form", ratios, [closed(LIGHT, x1) for x1 in ratios]),
        ("k1/k0", "late, exponential", ratios, theory.late_slope(ratios).tolist()),
        ("k1/k0", "paper", ratios, theory.late_slope_paper(ratios).tolist()),
        ("load", "closed form", loads, [closed(load) for load in loads]),
        *(
            ("R_viscous/R", by_load(load), viscous, [closed(load, r=r) for r in viscous])
            for load in (LIGHTEST, LIGHT)
        ),
        ("side", "closed form", list(SIZES), [closed(SIZE_LOAD)] * len(SIZES)),
    ]
    names = ("of", "line", "at", "B")
    return pd.concat([pd.DataFrame(dict(zip(names, one, strict=True))) for one in lines], ignore_index=True)


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw B against everything, with the closed forms, and where they end."""
    figure, (viscous, ratio, load, wave, side, over) = style.panels(8.6, 5.6, 3, 2)
    rows, lines = tables["points"], tables["lines"]
    rows = rows.assign(at=rows["at"].where(rows["at"] > 0, ZERO))

    def dots(ax: Axes, of: str, look: str, color: str, label: str, surfaces: str = GAUSSIAN) -> None:
        own = rows[(rows["of"] == of) & (rows["surfaces"] == surfaces)]
        style.points(ax, own, "at", "B", look, color, label=label)

    def line(ax: Axes, of: str, name: str, look: str, color: str, label: str) -> None:
        own = lines[(lines["of"] == of) & (lines["line"] == name)]
        ax.plot(own["at"], own["B"], look, color=color, linewidth=0.9, label=label)

    for value, look, color in ((LIGHTEST, "o", style.BLUE), (LIGHT, "s", style.INK)):
        dots(viscous, "R_viscous/R", look, color, f"load {value:g}", by_load(value))
        line(viscous, "R_viscous/R", by_load(value), "-", color, f"closed form, {value:g}")
    for ax, of, words in ((ratio, "k1/k0", "load 0.001"), (load, "load", GAUSSIAN)):
        dots(ax, of, "s", style.INK, words)
        line(ax, of, "closed form", "-", style.INK, "closed form")
    line(ratio, "k1/k0", "late, exponential", "--", style.BLUE, r"$k_\mathrm{eff}/(8\pi k_0)$")
    line(ratio, "k1/k0", "paper", ":", style.VERMILION, r"$0.04\,k_1/k_0$")
    for hurst, look, color in zip(HURST, "o^D", (style.SKY, style.BLUE, style.INK), strict=True):
        dots(wave, "cutoff", f"{look}-", color, by_hurst(hurst), by_hurst(hurst))
    for name, look, color in ((by_hurst(0.8), "D--", style.BLUE), (GAUSSIAN, "s--", style.INK)):
        dots(side, "side", look, color, name, name)
    line(side, "side", "closed form", "-", style.INK, "closed form")
    ends = tables["courses"]
    for value, color in zip(ENDING, (style.SKY, style.BLUE, style.VERMILION, style.INK), strict=True):
        part = ends[ends["load"] == value]
        over.plot(part["time"] * part["area"] ** 2, part["over_closed"], "-", color=color, label=f"{value:g}")
    over.axhline(END, color="0.7", linewidth=0.8)
    WORDS.dress(viscous, ratio, load, wave, side, over)
    return figure


GROWTH_RATE = Study(
    **WORDS.study,
    quick=tuple(campaigns(seeds=3)),
    full=tuple(campaigns(seeds=5, light=8)),
    analyse=analyse,
    draw=draw,
)
