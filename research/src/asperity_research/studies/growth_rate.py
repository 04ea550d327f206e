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
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import asperity.theory as theory
import asperity_research.studies.growth as grown
from asperity.fits import Estimate, jackknife
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.growth import GAUSSIAN, LIGHT, LIGHTEST, Grown, by_hurst, by_load, rate
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


def _estimate(combine: Callable[[Field], float], *sets: Grown, of: grown.Number = rate) -> Estimate:
    """Combine a number of some sets."""
    return _combined(combine, lambda one, area, closed: one.number(of, area, closed), sets)


def _over(one: Grown, other: Grown | float = 1.0, of: grown.Number = rate) -> Estimate:
    """A number of one set over that of another, or over a number."""
    if isinstance(other, Grown):
        return _estimate(lambda numbers: float(numbers[0] / numbers[1]), one, other, of=of)
    return _estimate(lambda numbers: float(numbers[0] / other), one, of=of)


def _exponent(sets: Mapping[float, Grown], of: grown.Number = rate) -> Estimate:
    """Slope of the logarithm of a rate against that of what is varied; NaN for an area that does not grow."""
    at = np.array(list(sets))
    return _estimate(lambda rates: power(at, rates) if (rates > 0).all() else math.nan, *sets.values(), of=of)


def _exponent_of_end(sets: Sequence[Grown]) -> Estimate:
    """Slope of the logarithm of the time at which the closed form ends against that of the area then."""
    return _combined(
        lambda ends: power(ends[:, 1], ends[:, 0]), lambda one, *areas: grown.end(one.time, *areas), sets
    )


def _row(key: grown.Key, found: Grown) -> dict[str, Any]:
    """Everything that is said of one set of parameters."""
    return {
        **dict(zip(("of", "surfaces", "at"), key, strict=True)),
        "load": found.load,
        "sites": found.sites,
        "area_at_first": found.area[:, 0].mean(),
        "area_at_last": found.area[:, found.time <= grown.WINDOW[1] * (1 + 1e-9)][:, -1].mean(),
        **all_columns(
            B=_over(found),
            over_closed=_over(found, found.limit),
            relative=_over(found, of=grown.relative_rate),
            straightness=_over(found, of=grown.straightness),
        ),
        "closed": found.limit,
        "runs": len(found.area),
    }


_B, _K = "<i>B</i>", "<i>k</i><sub>1</sub>/<i>k</i><sub>0</sub>"
_BEND = f"{_B} in the second decade over that in the first"


class Sets(dict[grown.Key, Grown]):
    """All sets of parameters."""

    def along(
        self, of: str, surfaces: str = GAUSSIAN, low: float = -math.inf, high: float = math.inf
    ) -> dict[float, Grown]:
        """Return those in which one thing is varied on some surfaces, by its value, between two."""
        every = self.items()
        return {
            at: one for (what, kind, at), one in every if (what, kind) == (of, surfaces) and low <= at <= high
        }


def _closed(words: str, some: Mapping[float, Grown]) -> dict[str, Estimate]:
    """B over that of the closed form; the same whether both are of these surfaces or of those without end."""
    head = f"{_B} over that of the closed form: {words}"
    return {f"{head} {at:g}": _over(one, one.limit) for at, one in some.items()}


def _on_solids(sets: Sets) -> dict[str, dict[str, Estimate]]:
    """Return what decides the claims on stiffness and mobility, under light loads."""
    viscous = {load: sets.along("R_viscous/R", by_load(load)) for load in (LIGHTEST, LIGHT)}
    head = f"d ln {_B}/d ln({_K}), {_K}"
    return {
        "ratio": _closed(_K, sets.along("k1/k0")),
        "proportional": {
            f"{head} up to 1": _exponent(sets.along("k1/k0", high=1.0)),
            f"{head} from 3 on": _exponent(sets.along("k1/k0", low=3.0)),
        },
        "relative": {
            f"d ln(d ln <i>A</i>/d ln <i>t</i>)/d ln({_K}), {_K} from 1 on": _exponent(
                sets.along("k1/k0", low=1.0), grown.relative_rate
            )
        },
        **{f"viscous {load:g}": _closed("R_viscous/R", some) for load, some in viscous.items()},
        "doubles": {
            f"{_B} at R_viscous/R {r:g} over that at 0, load a site {load:g}": _over(one, some[0.0])
            for load, some in viscous.items()
            for r, one in some.items()
            if r >= 1.0
        },
    }


def _on_surfaces(sets: Sets) -> dict[str, dict[str, Estimate]]:
    """Return what decides the claims on loads and heights."""
    loads, bend = sets.along("load"), grown.straightness
    waves = {hurst: sets.along("cutoff", by_hurst(hurst)) for hurst in grown.HURST}
    law = sets["law", grown.EXPONENTIAL, 1.0]
    sides = {GAUSSIAN: sets.along("side"), "waves from 4 sites": sets.along("side", by_hurst(0.8))}
    end = f"d ln (time at which the area is {grown.END:g} of that of the closed form)"
    rms = f"{_B} at heights and load times {grown.RMS:g} over that before"
    head = f"d ln {_B}/d ln (shortest wavelength)"
    hurst_over = f"{_B} at the Hurst exponent 0.8 over that at 0.2, waves from"
    over = f"sites along a side over that at {grown.SIDE}"
    return {
        "load": _closed("load a site", loads),
        "load_free": {
            f"d ln {_B}/d ln <i>F</i>, load a site from {low:g} to {high:g}": _exponent(
                sets.along("load", low=low, high=high)
            )
            for low, high in ((LIGHTEST, LIGHT), (grown.SIZE_LOAD, 0.3))
        },
        "logarithm": {f"{_BEND}: load a site {load:g}": _over(one, of=bend) for load, one in loads.items()},
        "logarithm_waves": {
            f"{_BEND}: {by_hurst(hurst)}": _over(some[4.0], of=bend) for hurst, some in waves.items()
        },
        "end": {f"{end}/d ln (contact fraction then)": _exponent_of_end([loads[at] for at in grown.ENDING])},
        "rms": {rms: _over(sets["rms", GAUSSIAN, grown.RMS], loads[LIGHT])},
        "law": {
            f"{_B} over <i>k</i><sub>eff</sub>/(8 pi <i>k</i><sub>0</sub>)": _over(
                law, float(theory.late_slope(grown.RATIO))
            ),
            **_closed("exponential heights, rms", {1.0: law}),
        },
        "waves": {f"{head}: {by_hurst(hurst)}": _exponent(some) for hurst, some in waves.items()},
        "hurst": {
            f"{hurst_over} {wave:g} sites": _over(waves[0.8][wave], waves[0.2][wave])
            for wave in grown.CUTOFFS
        },
        "size": {
            f"{_B} at {side} {over}: {words}": _over(some[side], some[grown.SIDE])
            for words, some in sides.items()
            for side in grown.SIZES[:-1]
        },
    }


def analyse(evidence: Evidence) -> Outcome:
    """Find B for all parameters, and compare it with the closed forms."""
    sets = Sets(grown.sets_of(evidence))
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
    for key, numbers in (_on_solids(sets) | _on_surfaces(sets)).items():
        claim, _, at = key.partition(" ")
        findings.append(WORDS.judge(claim, numbers, key=key.replace(" ", "_"), load=float(at or 0)))
    return Outcome(tuple(findings), tables)


def _lines() -> pd.DataFrame:
    """Closed forms on surfaces without end."""
    time = np.append(0.0, np.geomspace(*grown.WINDOW, 9))
    law = theory.GaussianHeights(1.0)

    def closed(load: float, x1: float = grown.RATIO, r: float = 0.0) -> float:
        return rate(time, grown.closed_area(law, load, time, x1, r)[None])

    ratios = np.geomspace(grown.RATIOS[0], grown.RATIOS[-1], 25).tolist()
    loads = np.geomspace(grown.LOADS[0], grown.LOADS[-1], 25).tolist()
    viscous = np.geomspace(grown.ZERO, grown.VISCOUS[-1], 31).tolist()
    lines: list[tuple[str, str, list[float], list[float]]] = [
        ("k1/k0", "closed form", ratios, [closed(grown.LIGHT, x1) for x1 in ratios]),
        ("k1/k0", "late, exponential", ratios, theory.late_slope(ratios).tolist()),
        ("k1/k0", "paper", ratios, theory.late_slope_paper(ratios).tolist()),
        ("load", "closed form", loads, [closed(load) for load in loads]),
        *(
            ("R_viscous/R", grown.by_load(load), viscous, [closed(load, r=r) for r in viscous])
            for load in (grown.LIGHTEST, grown.LIGHT)
        ),
        ("side", "closed form", list(grown.SIZES), [closed(grown.SIZE_LOAD)] * len(grown.SIZES)),
    ]
    names = ("of", "line", "at", "B")
    return pd.concat([pd.DataFrame(dict(zip(names, one, strict=True))) for one in lines], ignore_index=True)


_TICKS = (0.1, 0.2, 0.5, 1.0, 2.0)


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw B against everything, with the closed forms, and where they end."""
    figure, (viscous, ratio, load, wave, side, over) = style.panels(8.6, 5.6, 3, 2)
    rows, lines = tables["points"], tables["lines"]
    rows = rows.assign(at=rows["at"].where(rows["at"] > 0, grown.ZERO))

    def dots(ax: Axes, of: str, look: str, color: str, label: str, surfaces: str = GAUSSIAN) -> None:
        own = rows[(rows["of"] == of) & (rows["surfaces"] == surfaces)]
        style.points(ax, own, "at", "B", look, color, label=label)

    def line(ax: Axes, of: str, name: str, look: str, color: str, label: str) -> None:
        own = lines[(lines["of"] == of) & (lines["line"] == name)]
        ax.plot(own["at"], own["B"], look, color=color, linewidth=0.9, label=label)

    for value, look, color in ((LIGHTEST, "o", style.BLUE), (LIGHT, "s", style.INK)):
        dots(viscous, "R_viscous/R", look, color, f"load {value:g}", by_load(value))
        line(viscous, "R_viscous/R", by_load(value), "-", color, f"closed form, {value:g}")
    viscous.set(xscale="log", xlabel=r"$\tilde R/R$ (at the left: 0)", ylabel=r"$B$")
    dots(ratio, "k1/k0", "s", style.INK, "load 0.001")
    line(ratio, "k1/k0", "closed form", "-", style.INK, "closed form")
    line(ratio, "k1/k0", "late, exponential", "--", style.BLUE, r"$k_\mathrm{eff}/(8\pi k_0)$")
    line(ratio, "k1/k0", "paper", ":", style.VERMILION, r"$0.04\,k_1/k_0$")
    ratio.set(xscale="log", yscale="log", xlabel=r"$k_1/k_0$")
    dots(load, "load", "s", style.INK, GAUSSIAN)
    line(load, "load", "closed form", "-", style.INK, "closed form")
    load.set(xscale="log", yscale="log", xlabel=r"load a site$\,/(k_0\,$rms height$)$")
    for hurst, look, color in zip(grown.HURST, "o^D", (style.SKY, style.BLUE, style.INK), strict=True):
        dots(wave, "cutoff", f"{look}-", color, by_hurst(hurst), by_hurst(hurst))
    wave.set(xscale="log", xlabel="shortest wavelength (sites)", ylabel=r"$B$")
    wave.set_xticks(grown.CUTOFFS, [f"{cutoff:g}" for cutoff in grown.CUTOFFS])
    for ax in (wave, side):
        ax.set_yscale("log")
        ax.set_yticks(_TICKS, [f"{tick:g}" for tick in _TICKS])
        ax.tick_params(axis="y", which="minor", labelleft=False)
    for name, look, color in ((by_hurst(0.8), "D--", style.BLUE), (GAUSSIAN, "s--", style.INK)):
        dots(side, "side", look, color, name, name)
    line(side, "side", "closed form", "-", style.INK, "closed form")
    side.set(xscale="log", ylim=(0.1, 2.0), xlabel="sites along a side")
    side.set_xticks(grown.SIZES, [f"{size}" for size in grown.SIZES])
    ends = tables["courses"]
    for value, color in zip(grown.ENDING, (style.SKY, style.BLUE, style.VERMILION, style.INK), strict=True):
        part = ends[ends["load"] == value]
        over.plot(part["time"] * part["area"] ** 2, part["over_closed"], "-", color=color, label=f"{value:g}")
    over.axhline(grown.END, color="0.7", linewidth=0.8)
    over.set(xscale="log", xlim=(1e-7, 1e3), ylim=(0.6, 1.03))
    over.set(xlabel=r"$k_0 R t\,(A/N_0)^2$", ylabel="area over closed form")
    over.legend(title="load a site", fontsize=7, title_fontsize=7)
    for ax in (viscous, ratio, load, wave, side):
        ax.legend(fontsize=7)
        ax.tick_params(axis="x", which="minor", labelbottom=False)
    return figure


GROWTH_RATE = Study(
    **WORDS.study,
    quick=tuple(grown.campaigns(seeds=3)),
    full=tuple(grown.campaigns(seeds=5, light=8)),
    analyse=analyse,
    draw=draw,
)
