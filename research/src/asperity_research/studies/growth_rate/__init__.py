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

from collections.abc import Mapping

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.figures import Drawing
from asperity_research import style
from asperity_research.studies.growth_rate.analysis import analyse
from asperity_research.studies.growth_rate.grown import (
    CUTOFFS,
    END,
    ENDING,
    GAUSSIAN,
    HURST,
    LIGHT,
    LIGHTEST,
    SIZES,
    ZERO,
    by_hurst,
    by_load,
    campaigns,
    end,
    rate,
    relative_rate,
    straightness,
)
from asperity_research.studies.study import Study

__all__ = ["GROWTH_RATE", "analyse", "draw", "end", "rate", "relative_rate", "straightness"]


_TICKS = (0.1, 0.2, 0.5, 1.0, 2.0)


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw B against everything, with the closed forms, and where they end."""
    figure = Drawing(figsize=(8.6, 5.6), layout="constrained")
    (viscous, ratio, load), (wave, side, over) = figure.subplots(2, 3)
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
    viscous.set(xscale="log", xlabel=r"$\tilde R/R$ (at the left: 0)", ylabel=r"$B$")
    dots(ratio, "k1/k0", "s", style.INK, "load 0.001")
    line(ratio, "k1/k0", "closed form", "-", style.INK, "closed form")
    line(ratio, "k1/k0", "late, exponential", "--", style.BLUE, r"$k_\mathrm{eff}/(8\pi k_0)$")
    line(ratio, "k1/k0", "paper", ":", style.VERMILION, r"$0.04\,k_1/k_0$")
    ratio.set(xscale="log", yscale="log", xlabel=r"$k_1/k_0$")
    dots(load, "load", "s", style.INK, GAUSSIAN)
    line(load, "load", "closed form", "-", style.INK, "closed form")
    load.set(xscale="log", yscale="log", xlabel=r"load a site$\,/(k_0\,$rms height$)$")
    for hurst, look, color in zip(HURST, "o^D", (style.SKY, style.BLUE, style.INK), strict=True):
        dots(wave, "cutoff", f"{look}-", color, by_hurst(hurst), by_hurst(hurst))
    wave.set(xscale="log", xlabel="shortest wavelength (sites)", ylabel=r"$B$")
    wave.set_xticks(CUTOFFS, [f"{cutoff:g}" for cutoff in CUTOFFS])
    for ax in (wave, side):
        ax.set_yscale("log")
        ax.set_yticks(_TICKS, [f"{tick:g}" for tick in _TICKS])
        ax.tick_params(axis="y", which="minor", labelleft=False)
    for name, look, color in ((by_hurst(0.8), "D--", style.BLUE), (GAUSSIAN, "s--", style.INK)):
        dots(side, "side", look, color, name, name)
    line(side, "side", "closed form", "-", style.INK, "closed form")
    side.set(xscale="log", ylim=(0.1, 2.0), xlabel="sites along a side")
    side.set_xticks(SIZES, [f"{size}" for size in SIZES])
    ends = tables["courses"]
    for value, color in zip(ENDING, (style.SKY, style.BLUE, style.VERMILION, style.INK), strict=True):
        part = ends[ends["load"] == value]
        over.plot(part["time"] * part["area"] ** 2, part["over_closed"], "-", color=color, label=f"{value:g}")
    over.axhline(END, color="0.7", linewidth=0.8)
    over.set(xscale="log", xlim=(1e-7, 1e3), ylim=(0.6, 1.03))
    over.set(xlabel=r"$k_0 R t\,(A/N_0)^2$", ylabel="area over closed form")
    over.legend(title="load a site", fontsize=7, title_fontsize=7)
    for ax in (viscous, ratio, load, wave, side):
        ax.legend(fontsize=7)
        ax.tick_params(axis="x", which="minor", labelbottom=False)
    return figure


GROWTH_RATE = Study(
    name="growth-rate",
    question="How does the growth rate B depend on R_viscous/R, k1/k0, load, roughness and size?",
    quick=tuple(campaigns(seeds=3)),
    full=tuple(campaigns(seeds=5, light=8)),
    analyse=analyse,
    draw=draw,
    caption="<i>B</i> = d(<i>A</i>/<i>A</i>(0))/d ln <i>t</i> for <i>k</i><sub>0</sub><i>Rt</i> from 10 to "
    "1000, with 95 % intervals, on independent Gaussian heights, where nothing else is said. Lines: the "
    "dilute theory, without free parameter. Last: area over that of the dilute theory with the heights of "
    "the same surfaces, against time in units of that at which dips meet.",
    page="docs/studies/growth_rate.md",
)
