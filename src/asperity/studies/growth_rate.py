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

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import asperity.theory as theory
from asperity.checks import Floats
from asperity.figures import style
from asperity.fits.resampling import Estimate, jackknife
from asperity.lattice import Field
from asperity.studies.campaigns import Campaign
from asperity.studies.evidence import Evidence
from asperity.studies.ledger import Finding
from asperity.studies.numbers import columns, crossing, power, slope
from asperity.studies.panels import points
from asperity.studies.study import Outcome, Study
from asperity.surfaces import exponential, gaussian

WINDOW = (10.0, 1e3)
"""Reduced times k0 R t between which B is measured."""

HEIGHTS: Mapping[str, tuple[Callable[..., Field], Callable[[float], theory.HeightLaw]]] = {
    "gaussian": (gaussian, theory.GaussianHeights),
    "exponential": (exponential, theory.ExponentialHeights),
}
"""Surfaces that have a closed form, and their laws of heights, by kind."""

_MIDDLE, _LAST = 100.0, 1e6
"""Where its halves meet, and the end of the runs in which the end of the closed form is looked for."""

SIDE = 512
RATIO = 3.0
"""k1/k0 where it is not varied."""

LIGHT, LIGHTEST = 1e-3, 1e-4
"""Loads a site, over k0 and the rms height, of contacts far apart."""

LOADS = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0)
RATIOS = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
VISCOUS = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
_RMS = 4.0

SIZES = (128, 256, 512)
_SIZE_LOAD = 1e-2

HURST, CUTOFFS = (0.2, 0.5, 0.8), (2.0, 4.0, 8.0)
_WAVE_SIDE, _WAVE_SIZES = 256, (128, 512)

ENDING = (1e-3, 3e-3, 1e-2, 3e-2)
"""Loads a site at which the end of the closed form is looked for."""

END = 0.9
"""Area over that of the closed form at which this has come to its end."""

NEAR = (0.9, 1.1)
"""Ratios that bear out that two rates are the same."""

TWICE = (1.8, 2.2)
"""Ratios that bear out that one rate is twice another."""

FLAT = (-0.05, 0.05)
"""Exponents that bear out that one quantity does not depend on another."""


Number = Callable[[Floats, Field], float]
"""What is computed from times and areas, shapes (n,) and (runs, n)."""

Key = tuple[str, str, float]
"""What is varied, on which surfaces or under which load, and its value."""


def _campaign(
    name: str,
    purpose: str,
    sweep: Mapping[str, object],
    *,
    side: int = SIDE,
    load: float = LIGHT,
    surface: Mapping[str, object] | None = None,
    last: float = WINDOW[1],
) -> Campaign:
    return Campaign(
        name,
        purpose,
        {
            "surface": {"kind": "gaussian", "shape": [side, side], **(surface or {})},
            "solid": {"k0": 1.0, "k1": RATIO, "R": 1.0},
            "contact": {"load": load * side**2},
            "aging": {"first": 0.1, "last": last, "per_decade": 4},
            "output": {"maps_at": []},
            "sweep": dict(sweep),
        },
    )


def campaigns(*, seeds: int, light: int | None = None) -> tuple[Campaign, ...]:
    """Return the campaigns, with so many surfaces each; where all loads are light, another number."""
    return tuple(_campaigns(seeds, light or seeds))


def _campaigns(seeds: int, light: int) -> Iterator[Campaign]:
    sites = SIDE**2
    yield _campaign(
        "viscous",
        "Growth for several R_viscous/R, under two loads",
        {"load": [LIGHTEST * sites, LIGHT * sites], "R_viscous": list(VISCOUS), "seeds": light},
    )
    yield _campaign("ratio", "Growth for several k1/k0", {"k1": list(RATIOS), "seeds": light})
    yield _campaign(
        "load",
        "Growth under several loads",
        {"load": [load * sites for load in LOADS], "seeds": seeds},
        last=_LAST,
    )
    yield _campaign(
        "rms",
        "Growth on higher heights under a load as much higher",
        {"seeds": seeds},
        load=_RMS * LIGHT,
        surface={"rms": _RMS},
    )
    exponential = {"kind": "exponential"}
    yield _campaign("exponential", "Growth on exponential heights", {"seeds": seeds}, surface=exponential)
    wave = {"kind": "spectral", "hurst": 0.8, "roll_off": 32.0, "cutoff": 4.0, "rms_height": 1.0}
    yield _campaign(
        "waves",
        "Growth on surfaces of several Hurst exponents and shortest wavelengths",
        {"hurst": list(HURST), "cutoff": list(CUTOFFS), "seeds": seeds},
        side=_WAVE_SIDE,
        load=_SIZE_LOAD,
        surface=wave,
    )
    for side in SIZES:
        if side != SIDE:
            purpose = f"Growth on independent heights, {side} along a side"
            yield _campaign(f"side_{side}", purpose, {"seeds": seeds}, side=side, load=_SIZE_LOAD)
    for side in _WAVE_SIZES:
        purpose = f"Growth on surfaces with waves, {side} sites along a side"
        yield _campaign(f"waves_{side}", purpose, {"seeds": seeds}, side=side, load=_SIZE_LOAD, surface=wave)


def rate(time: Floats, area: Field) -> float:
    """B in the window, of the mean over surfaces.

    Parameters
    ----------
    time
        Shape (n,), the first of which is 0.
    area
        Shape (runs, n).
    """
    mean = area.mean(axis=0)
    return slope(time, mean, *WINDOW) / float(mean[0])


def relative_rate(time: Floats, area: Field) -> float:
    """Return d ln A/d ln t in the window; arguments as for `rate`."""
    return slope(time, np.log(area.mean(axis=0)), *WINDOW)


def straightness(time: Floats, area: Field) -> float:
    """B in the second half of the window over that in the first half; 1 for a logarithm."""
    mean = area.mean(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):  # an area that does not grow at first: no number
        return float(np.divide(slope(time, mean, _MIDDLE, WINDOW[1]), slope(time, mean, WINDOW[0], _MIDDLE)))


def end(time: Floats, area: Field, closed: Field) -> tuple[float, float]:
    """Time at which the mean area falls to `END` of that of the closed form for good, and the area then.

    Parameters
    ----------
    time
        Shape (n,).
    area, closed
        Shape (runs, n).

    Returns
    -------
    float, float
        NaN where it does not fall so far.
    """
    mean, over = area.mean(axis=0), area.mean(axis=0) / closed.mean(axis=0)
    above = np.flatnonzero(over >= END)
    last = int(above[-1]) if above.size else 0
    if last + 1 == len(time) or last == 0:
        return math.nan, math.nan
    at, part = crossing(time, over, last + 1, END)
    return at, float(mean[last] + part * (mean[last + 1] - mean[last]))


def closed_area(heights: theory.HeightLaw, load: float, time: Floats, x1: float, viscous: float) -> Floats:
    """Part of the sites in contact by the dilute theory, with k0 = 1.

    Parameters
    ----------
    heights
        Their law.
    load
        A site, over k0.
    time
        Reduced times, shape (n,).
    x1, viscous
        k1/k0 and R_viscous/R.
    """
    return theory.dilute_area(load, theory.compliance(x1, time, viscous), heights)


@dataclass(frozen=True)
class Grown:
    """Areas of several surfaces against time, and those of the closed form.

    Attributes
    ----------
    load
        Load a site.
    sites
        Of the surface.
    time
        Reduced times k0 R t, the first of which is 0, shape (n,).
    area
        Shape (runs, n), as a part of all sites.
    closed
        The same by the dilute theory with the heights of each surface; NaN where it has none.
    endless
        The same on a surface without end, shape (n,).
    """

    load: float
    sites: int
    time: Floats
    area: Field
    closed: Field
    endless: Floats

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
    dataset = evidence[name].sel(at | ({"load": load * plotted} if "load" in at else {}))
    sites = int(dataset["sites"].max())
    time = np.asarray(dataset["time"].values, dtype=np.float64)
    area = dataset["area"].transpose("seed", "time").values.astype(np.float64) / sites
    closed, endless = np.full_like(area, np.nan), np.full_like(time, np.nan)
    if surface["kind"] in HEIGHTS:
        numbers, rms = (at.get("k1", RATIO), at.get("R_viscous", 0.0)), surface.get("rms", 1.0)
        endless = closed_area(HEIGHTS[surface["kind"]][1](rms), load, time, *numbers)
        for row, seed in enumerate(dataset["seed"].values.tolist()):
            law = _empirical(surface["kind"], math.isqrt(sites), rms, seed)
            closed[row] = closed_area(law, load, time, *numbers)
    return Grown(load, sites, time, area, closed, endless)


@lru_cache(maxsize=64)
def _empirical(kind: str, side: int, rms: float, seed: int) -> theory.HeightLaw:
    """Law of the heights of one surface."""
    return theory.EmpiricalHeights(HEIGHTS[kind][0]((side, side), rms=rms, seed=seed))


_GAUSSIAN, _EXPONENTIAL = "independent heights", "exponential heights"


def _by_load(load: float) -> str:
    return f"load {load:g}"


def _by_hurst(hurst: float) -> str:
    return f"Hurst exponent {hurst:g}"


def _sets(evidence: Evidence) -> dict[Key, Grown]:
    grown = partial(_grown, evidence)
    waves = _by_hurst(0.8)
    sets: dict[Key, Grown] = {("k1/k0", _GAUSSIAN, x1): grown("ratio", k1=x1) for x1 in RATIOS}
    sets |= {("load", _GAUSSIAN, load): grown("load", load=load) for load in LOADS}
    for load, r in product((LIGHTEST, LIGHT), VISCOUS):
        sets["R_viscous/R", _by_load(load), r] = grown("viscous", load=load, R_viscous=r)
    for hurst, cutoff in product(HURST, CUTOFFS):
        sets["cutoff", _by_hurst(hurst), cutoff] = grown("waves", hurst=hurst, cutoff=cutoff)
    for side in SIZES:
        known = {SIDE: sets["load", _GAUSSIAN, _SIZE_LOAD]}
        sets["side", _GAUSSIAN, side] = known.get(side) or grown(f"side_{side}")
        known = {_WAVE_SIDE: sets["cutoff", waves, 4.0]}
        sets["side", waves, side] = known.get(side) or grown(f"waves_{side}")
    sets["rms", _GAUSSIAN, _RMS] = grown("rms")
    sets["law", _EXPONENTIAL, 1.0] = grown("exponential")
    return sets


def _estimate(combine: Callable[[Floats], float], *sets: Grown, of: Number = rate) -> Estimate:
    """Combine a number of some sets, of as many surfaces each; with its interval."""

    def statistic(*arrays: Field) -> float:
        pairs = zip(sets, arrays[::2], arrays[1::2], strict=True)
        return combine(np.array([one.number(of, area, closed) for one, area, closed in pairs]))

    return jackknife(statistic, tuple(array for one in sets for array in (one.area, one.closed)))


def _only(numbers: Floats) -> float:
    return float(numbers[0])


def _over(one: Grown, other: Grown) -> Estimate:
    """B of one set over that of another."""
    return _estimate(lambda rates: float(rates[0] / rates[1]), one, other)


def _over_limit(found: Grown) -> Estimate:
    """B over that of the closed form; the same whether both are of these surfaces or of those without end."""
    return _estimate(lambda rates: float(rates[0] / found.limit), found)


def _exponent(sets: Mapping[float, Grown], of: Number = rate) -> Estimate:
    """Slope of the logarithm of a rate against that of what is varied; NaN for an area that does not grow."""
    at = np.array(list(sets))
    return _estimate(lambda rates: power(at, rates) if (rates > 0).all() else math.nan, *sets.values(), of=of)


def _row(key: Key, found: Grown) -> dict[str, Any]:
    """Everything that is said of one set of parameters."""
    return {
        **dict(zip(("of", "surfaces", "at"), key, strict=True)),
        "load": found.load,
        "sites": found.sites,
        "area_at_first": found.area[:, 0].mean(),
        "area_at_last": found.area[:, found.time <= WINDOW[1] * (1 + 1e-9)][:, -1].mean(),
        **columns("B", _estimate(_only, found)),
        **columns("over_closed", _over_limit(found)),
        **columns("relative", _estimate(_only, found, of=relative_rate)),
        **columns("straightness", _estimate(_only, found, of=straightness)),
        "closed": found.limit,
        "runs": len(found.area),
    }


def _exponent_of_end(sets: Sequence[Grown]) -> Estimate:
    """Slope of the logarithm of the time at which the closed form ends against that of the area then."""

    def statistic(*arrays: Field) -> float:
        pairs = zip(sets, arrays[::2], arrays[1::2], strict=True)
        at, area = np.array([end(one.time, simulated, closed) for one, simulated, closed in pairs]).T
        return power(area, at)

    return jackknife(statistic, tuple(array for one in sets for array in (one.area, one.closed)))


def analyse(evidence: Evidence) -> Outcome:
    """Find B for all parameters, and compare it with the closed forms."""
    sets = _sets(evidence)
    courses = [
        pd.DataFrame(
            {
                "load": load,
                "time": one.time[1:],
                "area": one.area.mean(axis=0)[1:],
                "over_closed": (one.area.mean(axis=0) / one.closed.mean(axis=0))[1:],
            }
        )
        for (of, _, load), one in sets.items()
        if of == "load"
    ]
    tables = {
        "points": pd.DataFrame([_row(key, found) for key, found in sets.items()]),
        "lines": _lines(),
        "courses": pd.concat(courses, ignore_index=True),
    }
    return Outcome(tuple(_findings(sets)), tables)


_DILUTE, _HERE, _PAPER = "dilute theory", "this study", "Jagla, Eq. (log)"
_B, _K = "<i>B</i>", "<i>k</i><sub>1</sub>/<i>k</i><sub>0</sub>"
_BEND = f"{_B} in the second decade over that in the first"
_RELATIVE = "d ln <i>A</i>/d ln <i>t</i>"
_ENDED = f"d ln (time at which the area is {END:g} of that of the closed form)/d ln (contact fraction then)"


def _findings(sets: Mapping[Key, Grown]) -> Iterator[Finding]:
    """Judge all claims."""

    def chosen(of: str, surfaces: str = _GAUSSIAN) -> dict[float, Grown]:
        return {at: found for (what, kind, at), found in sets.items() if (what, kind) == (of, surfaces)}

    def part(some: Mapping[float, Grown], low: float, high: float = math.inf) -> dict[float, Grown]:
        return {at: found for at, found in some.items() if low <= at <= high}

    def closed(words: str, some: Mapping[float, Grown]) -> dict[str, Estimate]:
        return {
            f"{_B} over that of the closed form: {words} {at:g}": _over_limit(one) for at, one in some.items()
        }

    ratios, loads = chosen("k1/k0"), chosen("load")
    viscous = {load: chosen("R_viscous/R", _by_load(load)) for load in (LIGHTEST, LIGHT)}
    waves = {hurst: chosen("cutoff", _by_hurst(hurst)) for hurst in HURST}
    law = sets["law", _EXPONENTIAL, 1.0]
    yield Finding.within(
        NEAR, "ratio", _DILUTE, "Under a light load B is that of the closed form", closed(_K, ratios)
    )
    numbers = {
        f"d ln {_B}/d ln({_K}), {_K} up to 1": _exponent(part(ratios, 0, 1.0)),
        f"d ln {_B}/d ln({_K}), {_K} from 3 on": _exponent(part(ratios, 3.0)),
    }
    yield Finding.within(NEAR, "proportional", "Jagla, Eq. (ndet2)", "B is in proportion to k1/k0", numbers)
    numbers = {f"d ln({_RELATIVE})/d ln({_K}), {_K} from 1 on": _exponent(part(ratios, 1.0), relative_rate)}
    yield Finding.within(FLAT, "relative", _DILUTE, "d ln A/d ln t does not depend on k1/k0", numbers)
    for load, some in viscous.items():
        words = f"B is that of the closed form at all R_viscous/R under the load {load:g} a site"
        yield Finding.within(NEAR, f"viscous_{load:g}", _DILUTE, words, closed("R_viscous/R", some))
    numbers = {
        f"{_B} at R_viscous/R {r:g} over that at 0, load a site {load:g}": _over(one, some[0.0])
        for load, some in viscous.items()
        for r, one in part(some, 1.0).items()
    }
    yield Finding.within(
        TWICE, "doubles", "Jagla, Fig. 9", "B doubles from R_viscous = 0 to large R_viscous/R", numbers
    )
    yield Finding.within(
        NEAR, "load", _DILUTE, "B is that of the closed form at all loads", closed("load a site", loads)
    )
    numbers = {
        f"d ln {_B}/d ln <i>F</i>, load a site from {low:g} to {high:g}": _exponent(part(loads, low, high))
        for low, high in ((LIGHTEST, LIGHT), (_SIZE_LOAD, 0.3))
    }
    yield Finding.within(FLAT, "load_free", "Jagla, after Eq. (ndet2)", "B does not depend on load", numbers)
    numbers = {
        f"{_BEND}: load a site {load:g}": _estimate(_only, one, of=straightness)
        for load, one in loads.items()
    }
    yield Finding.within(
        NEAR, "logarithm", _PAPER, "On independent heights the area grows like ln t in the window", numbers
    )
    numbers = {
        f"{_BEND}: {_by_hurst(hurst)}": _estimate(_only, some[4.0], of=straightness)
        for hurst, some in waves.items()
    }
    yield Finding.within(
        NEAR, "logarithm_waves", _PAPER, "On waves the area grows like ln t in the window", numbers
    )
    words = "The closed form ends at a time in proportion to (contact fraction)^-2, when dips meet"
    numbers = {_ENDED: _exponent_of_end([loads[load] for load in ENDING])}
    yield Finding.within((-2.2, -1.8), "end", "dilute horizon", words, numbers)
    numbers = {
        f"{_B} at heights and load times {_RMS:g} over that before": _over(
            sets["rms", _GAUSSIAN, _RMS], loads[LIGHT]
        )
    }
    yield Finding.within(
        (0.999, 1.001), "rms", "scaling", "Heights and load times a number leave B alone", numbers
    )
    late = float(theory.late_slope(RATIO))
    numbers = {
        f"{_B} over <i>k</i><sub>eff</sub>/(8 pi <i>k</i><sub>0</sub>)": _estimate(
            lambda rates: float(rates[0] / late), law
        ),
        **closed("exponential heights, rms", {1.0: law}),
    }
    yield Finding.within(NEAR, "law", _DILUTE, "On exponential heights B is k_eff/(8 pi k0)", numbers)
    numbers = {
        f"d ln {_B}/d ln (shortest wavelength): {_by_hurst(hurst)}": _exponent(some)
        for hurst, some in waves.items()
    }
    yield Finding.within(FLAT, "waves", _HERE, "B does not depend on the shortest wavelength", numbers)
    numbers = {
        f"{_B} at the Hurst exponent 0.8 over that at 0.2, waves from {cutoff:g} sites": _over(
            waves[0.8][cutoff], waves[0.2][cutoff]
        )
        for cutoff in CUTOFFS
    }
    yield Finding.within(NEAR, "hurst", _HERE, "B does not depend on the Hurst exponent", numbers)
    numbers = {
        f"{_B} at {side} sites along a side over that at {SIDE}: {words}": _over(some[side], some[SIDE])
        for words, some in (
            (_GAUSSIAN, chosen("side")),
            ("waves from 4 sites", chosen("side", _by_hurst(0.8))),
        )
        for side in SIZES[:-1]
    }
    yield Finding.within(NEAR, "size", _HERE, "B does not depend on the size of the surface", numbers)


def _lines() -> pd.DataFrame:
    """Closed forms on surfaces without end."""
    time = np.append(0.0, np.geomspace(*WINDOW, 9))
    law = theory.GaussianHeights(1.0)

    def closed(load: float, x1: float = RATIO, r: float = 0.0) -> float:
        return rate(time, closed_area(law, load, time, x1, r)[None])

    ratios = np.geomspace(RATIOS[0], RATIOS[-1], 25).tolist()
    loads = np.geomspace(LOADS[0], LOADS[-1], 25).tolist()
    viscous = np.geomspace(_ZERO, VISCOUS[-1], 31).tolist()
    lines: list[tuple[str, str, list[float], list[float]]] = [
        ("k1/k0", "closed form", ratios, [closed(LIGHT, x1) for x1 in ratios]),
        ("k1/k0", "late, exponential", ratios, theory.late_slope(ratios).tolist()),
        ("k1/k0", "paper", ratios, theory.late_slope_paper(ratios).tolist()),
        ("load", "closed form", loads, [closed(load) for load in loads]),
        *(
            ("R_viscous/R", _by_load(load), viscous, [closed(load, r=r) for r in viscous])
            for load in (LIGHTEST, LIGHT)
        ),
        ("side", "closed form", list(SIZES), [closed(_SIZE_LOAD)] * len(SIZES)),
    ]
    names = ("of", "line", "at", "B")
    parts = [pd.DataFrame(dict(zip(names, one, strict=True))) for one in lines]
    return pd.concat(parts, ignore_index=True)


_TICKS = (0.1, 0.2, 0.5, 1.0, 2.0)
_ZERO = 1e-3
"""Where R_viscous = 0 is drawn."""


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw B against everything, with the closed forms, and where they end."""
    figure = style.Drawing(figsize=(8.6, 5.6), layout="constrained")
    (viscous, ratio, load), (wave, side, over) = figure.subplots(2, 3)
    rows, lines = tables["points"], tables["lines"]
    rows = rows.assign(at=rows["at"].where(rows["at"] > 0, _ZERO))

    def dots(ax: Axes, of: str, look: str, color: str, label: str, surfaces: str = _GAUSSIAN) -> None:
        own = rows[(rows["of"] == of) & (rows["surfaces"] == surfaces)]
        points(ax, own, "at", "B", look, color, label=label)

    def line(ax: Axes, of: str, name: str, look: str, color: str, label: str) -> None:
        own = lines[(lines["of"] == of) & (lines["line"] == name)]
        ax.plot(own["at"], own["B"], look, color=color, linewidth=0.9, label=label)

    for value, look, color in ((LIGHTEST, "o", style.BLUE), (LIGHT, "s", style.INK)):
        dots(viscous, "R_viscous/R", look, color, f"load {value:g}", _by_load(value))
        line(viscous, "R_viscous/R", _by_load(value), "-", color, f"closed form, {value:g}")
    viscous.set(xscale="log", xlabel=r"$\tilde R/R$ (at the left: 0)", ylabel=r"$B$")
    dots(ratio, "k1/k0", "s", style.INK, "load 0.001")
    line(ratio, "k1/k0", "closed form", "-", style.INK, "closed form")
    line(ratio, "k1/k0", "late, exponential", "--", style.BLUE, r"$k_\mathrm{eff}/(8\pi k_0)$")
    line(ratio, "k1/k0", "paper", ":", style.VERMILION, r"$0.04\,k_1/k_0$")
    ratio.set(xscale="log", yscale="log", xlabel=r"$k_1/k_0$")
    dots(load, "load", "s", style.INK, _GAUSSIAN)
    line(load, "load", "closed form", "-", style.INK, "closed form")
    load.set(xscale="log", yscale="log", xlabel=r"load a site$\,/(k_0\,$rms height$)$")
    for hurst, look, color in zip(HURST, "o^D", (style.SKY, style.BLUE, style.INK), strict=True):
        dots(wave, "cutoff", f"{look}-", color, _by_hurst(hurst), _by_hurst(hurst))
    wave.set(xscale="log", xlabel="shortest wavelength (sites)", ylabel=r"$B$")
    wave.set_xticks(CUTOFFS, [f"{cutoff:g}" for cutoff in CUTOFFS])
    for ax in (wave, side):
        ax.set_yscale("log")
        ax.set_yticks(_TICKS, [f"{tick:g}" for tick in _TICKS])
        ax.tick_params(axis="y", which="minor", labelleft=False)
    for name, look, color in ((_by_hurst(0.8), "D--", style.BLUE), (_GAUSSIAN, "s--", style.INK)):
        dots(side, "side", look, color, name, name)
    line(side, "side", "closed form", "-", style.INK, "closed form")
    side.set(xscale="log", ylim=(0.1, 2.0), xlabel="sites along a side")
    side.set_xticks(SIZES, [f"{size}" for size in SIZES])
    ends = tables["courses"]
    for value, color in zip(ENDING, (style.SKY, style.BLUE, style.VERMILION, style.INK), strict=True):
        part = ends[ends["load"] == value]
        over.plot(part["time"] * part["area"] ** 2, part["over_closed"], "-", color=color, label=f"{value:g}")
    over.axhline(END, color="0.7", linewidth=0.8)
    over.set(
        xscale="log",
        xlim=(1e-7, 1e3),
        ylim=(0.6, 1.03),
        xlabel=r"$k_0 R t\,(A/N_0)^2$",
        ylabel="area over closed form",
    )
    over.legend(title="load a site", fontsize=7, title_fontsize=7)
    for ax in (viscous, ratio, load, wave, side):
        ax.legend(fontsize=7)
        ax.tick_params(axis="x", which="minor", labelbottom=False)
    return figure


GROWTH_RATE = Study(
    name="growth-rate",
    question="How does the growth rate B depend on R_viscous/R, k1/k0, load, roughness and size?",
    quick=campaigns(seeds=3),
    full=campaigns(seeds=5, light=8),
    analyse=analyse,
    draw=draw,
    caption="<i>B</i> = d(<i>A</i>/<i>A</i>(0))/d ln <i>t</i> for <i>k</i><sub>0</sub><i>Rt</i> from 10 to "
    "1000, with 95 % intervals, on independent Gaussian heights, where nothing else is said. Lines: the "
    "dilute theory, without free parameter. Last: area over that of the dilute theory with the heights of "
    "the same surfaces, against time in units of that at which dips meet.",
    page="docs/studies/growth_rate.md",
)
