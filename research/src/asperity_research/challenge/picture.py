"""A score as a figure: the certified answer with what was given, and the deviations below."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from asperity.base.checks import instance
from asperity.figures import Drawing
from asperity_research import style
from asperity_research.challenge.scoring import QuantityScore, Score


def score_figure(score: Score) -> Drawing:
    """Draw each quantity, and how far it deviates in percent, with error bars and tolerance.

    Parameters
    ----------
    score
        From `asperity_research.challenge.score`.
    """
    instance("score", score, Score, "asperity.challenge.score(result)")
    count = len(score.quantities)
    figure = Drawing(figsize=(4.2 * count + 0.6, 5.2))
    panels = figure.subplots(2, count, sharex=True, squeeze=False, height_ratios=[2.2, 1])
    for (upper, lower), quantity in zip(panels.T, score.quantities, strict=True):
        _draw(upper, lower, quantity)
        lower.set_xlabel(score.problem.abscissa.heading)
    figure.suptitle(f"{score.problem.name}: {score.problem.title}", fontsize=10)
    return figure


def _draw(upper: Axes, lower: Axes, quantity: QuantityScore) -> None:
    bars: dict[str, Any] = {"ecolor": style.INK, "capsize": 2.5}
    rings: dict[str, Any] = {"color": style.BLUE, "markerfacecolor": "none", "markersize": 5}
    x, zero = quantity.abscissa, quantity.certified == 0
    upper.errorbar(
        x, quantity.certified, yerr=quantity.bar, fmt="-", color=style.GRAY, label="certified", **bars
    )
    upper.plot(x, quantity.given, "o", label=f"given: {quantity.verdict}", **rings)
    upper.set_ylabel(quantity.column.heading)
    upper.legend(fontsize=8)
    tolerance, reach = 100 * quantity.column.tolerance, 100 * quantity.bar / np.abs(quantity.certified + zero)
    lower.axhspan(-tolerance, tolerance, color="0.92", label="tolerance")
    lower.errorbar(x, 0 * x, yerr=np.where(zero, 0.0, reach), fmt="none", label="error bar", **bars)
    lower.plot(x, 100 * quantity.relative, "o", **rings)
    lower.set_ylabel("deviation [%]")
    lower.legend(fontsize=7)
    if (positive := x[x > 0]).size and positive.max() > 20 * positive.min():
        # Logarithmic, but linear below the first place that is not 0.
        lower.set_xscale("symlog", linthresh=float(positive.min()))
