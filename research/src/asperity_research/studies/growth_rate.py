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
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import asperity.theory as theory
from asperity.fits import Estimate, jackknife
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.growth import (
    CUTOFFS,
    END,
    ENDING,
    EXPONENTIAL,
    GAUSSIAN,
    HURST,
    LIGHT,
    LIGHTEST,
    LOADS,
    RATIO,
    RATIOS,
    RMS,
    SIDE,
    SIZE_LOAD,
    SIZES,
    VISCOUS,
    WINDOW,
    ZERO,
    Grown,
    Key,
    Number,
    Sets,
    by_hurst,
    by_load,
    campaigns,
    closed_area,
    end,
    rate,
    relative_rate,
    straightness,
)
from asperity_research.studies.numbers import all_columns, power
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)


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
    figure, (viscous, ratio, load, wave, side, over) = style.panels(6.0, 8.0, 2, 3)
    rows, lines = tables["points"], tables["lines"]
    rows = rows.assign(at=rows["at"].where(rows["at"] > 0, ZERO))

    def dots(ax: Axes, of: str, look: str, color: str, label: str, surfaces: str = GAUSSIAN) -> None:
        selected = rows[(rows["of"] == of) & (rows["surfaces"] == surfaces)]
        style.points(ax, selected, "at", "B", look, color, label=label)

    def line(ax: Axes, of: str, name: str, look: str, color: str, label: str) -> None:
        selected = lines[(lines["of"] == of) & (lines["line"] == name)]
        ax.plot(selected["at"], selected["B"], look, color=color, linewidth=0.9, label=label)

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
