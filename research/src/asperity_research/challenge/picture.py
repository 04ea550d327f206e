"""A score as a figure: the certified answer with what was given, and the deviations below."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.base.checks import instance
from asperity.figures import Drawing
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.challenge.scoring import QuantityScore, Score


def score_figure(score: Score) -> Figure:
    """Draw each quantity, and how far it deviates in percent, with error bars and tolerance.

    Parameters
    ----------
    score
        From `asperity_research.challenge.score`.
    """
    instance("score", score, Score, "asperity.challenge.score(result)")
    count = len(score.quantities)
    figure = Drawing(figsize=(4.2 * count + 0.6, 5.2), layout="constrained")
    panels = figure.subplots(2, count, sharex=True, squeeze=False, height_ratios=[2.2, 1])
    for (upper, lower), one in zip(panels.T, score.quantities, strict=True):
        _draw(upper, lower, one)
        label = score.problem.abscissa.heading
        lower.set_xlabel(_verbatim(label))
        _logarithmic(lower, one.abscissa)
    figure.suptitle(_verbatim(f"{score.problem.name}: {score.problem.title}"), fontsize=10)
    return figure


def _verbatim(text: str) -> str:
    """Write a text so that nothing in it is read as mathematics."""
    return text.replace("$", r"\$")


def _draw(upper: Axes, lower: Axes, one: QuantityScore) -> None:
    bars: dict[str, Any] = {"ecolor": style.INK, "capsize": 2.5}
    rings: dict[str, Any] = {"color": style.BLUE, "markerfacecolor": "none"}
    upper.errorbar(
        one.abscissa, one.certified, yerr=one.bar, fmt="-", color=style.GRAY, label="certified", **bars
    )
    upper.plot(one.abscissa, one.given, "o", markersize=5, label=f"given: {one.verdict}", **rings)
    upper.set_ylabel(_verbatim(one.column.heading))
    upper.legend(fontsize=8)
    tolerance, bar = 100 * one.column.tolerance, 100 * one.bar / np.abs(one.certified + (one.certified == 0))
    lower.axhspan(-tolerance, tolerance, color="0.92", label="tolerance")
    reach = np.where(one.certified == 0, 0.0, bar)
    lower.errorbar(one.abscissa, 0 * one.abscissa, yerr=reach, fmt="none", label="error bar", **bars)
    lower.plot(one.abscissa, 100 * one.relative, "o", markersize=5, **rings)
    lower.set_ylabel("deviation [%]")
    lower.legend(fontsize=7)


def _logarithmic(axes: Axes, places: Field) -> None:
    """A logarithmic axis, linear below the first place that is not 0."""
    positive = places[places > 0]
    if positive.size and positive.max() > 20 * positive.min():
        axes.set_xscale("symlog", linthresh=float(positive.min()))
