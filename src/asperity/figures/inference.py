"""What a curve determines, drawn: the curve and its band, each parameter, pairs of them; and a page."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import chi2

from asperity.base import checks
from asperity.figures import style
from asperity.figures.page import Picture, pixels, written_page
from asperity.inference import Inference, Prior

_COLUMNS = 3
_BINS = 41
_DOTS = 2000
"""Draws that a panel of two parameters shows."""


def curve_figure(found: Inference) -> Figure:
    """Draw the data, and the curve with the 95 % band of the posterior; below, the deviations."""
    figure = style.Drawing(figsize=(6.8, 5.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[3.0, 1.0])
    t, first = found.time, float(found.time[found.time > 0][0])
    shown = t > 0
    at = np.geomspace(first, t[-1], 120)
    low, middle, high = found.predicted(at)
    upper.fill_between(at, low, high, color=style.SKY, alpha=0.5, label="95 % band of the posterior")
    upper.plot(at, middle, color=style.BLUE, linewidth=1.4, label=f"model {found.model.name}, median")
    look = {"fmt": "o", "color": style.INK, "markersize": 4, "markerfacecolor": "white", "elinewidth": 0.8}
    upper.errorbar(t[shown], found.value[shown], found.error[shown], label="data", **look)
    deviation = (found.value - found.predicted(t)[1]) / found.error
    lower.axhline(0, color=style.INK, linewidth=0.8)
    lower.plot(t[shown], deviation[shown], "o", color=style.INK, markersize=4, markerfacecolor="white")
    upper.set_xscale("log")
    upper.set_ylabel("static friction" if found.model.name == "healing" else "area")
    lower.set_ylabel("deviation [errors]")
    lower.set_xlabel("hold time [s]")
    upper.legend(frameon=False, fontsize=8)
    for axes in (upper, lower):
        style.finish(axes)
    return figure


def parameters_figure(found: Inference) -> Figure:
    """Draw the posterior of each parameter over its prior, and its profile likelihood."""
    rows = -(-len(found.verdicts) // _COLUMNS)
    figure = style.Drawing(figsize=(8.4, 2.2 * rows), layout="constrained")
    panels = list(figure.subplots(rows, _COLUMNS, squeeze=False).ravel())
    prior = found.problem.values(found.problem.of_prior(np.random.default_rng(0), 20_000))
    for axes, (name, verdict) in zip(panels, found.verdicts.items(), strict=False):
        one = found.model.priors[name]
        values, before = found.values[name].ravel(), prior[name]
        logarithmic = one.kind.startswith("log")
        if logarithmic:
            axes.set_xscale("log")
        low, high = (one.first, one.second) if one.bounded else one.at(np.array(one.reach))
        steps = np.geomspace(low, high, _BINS) if logarithmic else np.linspace(low, high, _BINS)
        for drawn, color, label in ((before, style.GRAY, "prior"), (values, style.BLUE, "posterior")):
            counts = np.histogram(drawn, steps)[0]
            look = {"color": color, "fill": color == style.BLUE, "alpha": 0.7}
            axes.stairs(counts / counts.max(), steps, label=label if axes is panels[0] else None, **look)
        if name in found.profiles:
            at, deviance = found.profiles[name]
            axes.plot(
                at, np.exp(-deviance / 2), color=style.VERMILION, linewidth=1.3, label="profile likelihood"
            )
            axes.axhline(np.exp(-chi2.ppf(0.95, 1) / 2), color=style.VERMILION, linewidth=0.6, linestyle=":")
        unit = f" [{verdict.unit}]" if verdict.unit else ""
        axes.set_title(f"{name}{unit}\n{verdict.verdict}", fontsize=9)
        axes.set_yticks([])
        style.finish(axes)
    for axes in panels[len(found.verdicts) :]:
        axes.set_visible(False)
    return figure


def corner_figure(found: Inference) -> Figure:
    """Draw the draws of each pair of parameters that the curve contains, and each alone on the diagonal."""
    names = list(found.profiles)
    side = 1.9 * max(len(names), 2)
    figure = style.Drawing(figsize=(side, side), layout="constrained")
    panels = figure.subplots(len(names), len(names), squeeze=False)
    for i, name in enumerate(names):
        for j, other in enumerate(names):
            axes = panels[i, j]
            if j > i:
                axes.set_visible(False)
                continue
            x, y = found.values[other].ravel(), found.values[name].ravel()
            logarithmic = [_scale(found.model.priors[one], found.values[one]) for one in (other, name)]
            axes.set_xscale(logarithmic[0])
            if i == j:
                ends = x.min(), x.max(), _BINS
                steps = np.geomspace(*ends) if logarithmic[0] == "log" else np.linspace(*ends)
                axes.hist(x, steps, color=style.BLUE, alpha=0.7)
            else:
                axes.set_yscale(logarithmic[1])
                some = np.linspace(0, x.size - 1, min(x.size, _DOTS)).astype(int)
                axes.plot(x[some], y[some], ",", color=style.BLUE, alpha=0.6, rasterized=True)
            axes.tick_params(labelsize=6, which="both")
            axes.set_xlabel(other if i == len(names) - 1 else "", fontsize=8)
            axes.set_ylabel(name if j == 0 and i else "", fontsize=8)
            if i < len(names) - 1:
                axes.tick_params(labelbottom=False, which="both")
            if j or not i:
                axes.tick_params(labelleft=False, which="both")
    return figure


def _scale(prior: Prior, values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> str:
    """The axis of a parameter: logarithmic where it spans a decade."""
    return "log" if prior.kind.startswith("log") and values.max() > 10 * values.min() else "linear"


def inference_pictures(found: Inference) -> dict[str, Picture]:
    """Draw what a curve determines.

    Parameters
    ----------
    found
        From `asperity.infer`.

    Returns
    -------
    dict
        Pictures by the names of their files, without suffix, in the order of the page.
    """
    checks.instance("found", found, Inference, "asperity.infer(time, area, error)")
    drawn = {
        "curve": (curve_figure(found), "The data, and what the posterior says of the curve."),
        "parameters": (
            parameters_figure(found),
            "Each parameter: its prior (gray), its posterior (blue), and its profile likelihood, which falls "
            "below the dotted line outside of a 95 % interval. Where the blue fills the gray, the data tell "
            "nothing.",
        ),
        "corner": (
            corner_figure(found),
            "Draws of the posterior: every pair of parameters that the curve contains.",
        ),
    }
    return {name: Picture(caption, pixels(figure)) for name, (figure, caption) in drawn.items()}


def inference_page(
    found: Inference, pictures: Mapping[str, Picture], *, source: str = "", command: str = ""
) -> str:
    """Write what a curve determines as a page of HTML.

    Parameters
    ----------
    found
        From `asperity.infer`.
    pictures
        From `inference_pictures`.
    source
        Where the data come from; may be empty.
    command
        The command line that made it; may be empty.

    Returns
    -------
    str
    """
    checks.instance("found", found, Inference, "asperity.infer(time, area, error)")
    return written_page(
        "inference.html",
        f=found,
        pictures=list(pictures.values()),
        source=source or "The curve",
        command=command,
    )
