"""Measured relaxation, creep or dynamic moduli, the fit, its deviations, and its branches."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from asperity.base import checks
from asperity.base.readable import readable, written
from asperity.base.words import counted
from asperity.figures import style
from asperity.relaxation import Creep, Dynamic, Fit

_COLORS = (style.BLUE, style.VERMILION)
_MARKERS = ("o", "s")


@style.drawn
def relaxation_figure(fit: Fit) -> style.Drawing:
    """Draw data and fit, and below them the deviations and the branches.

    Parameters
    ----------
    fit
        From `asperity.relaxation.fit`.
    """
    checks.instance("fit", fit, Fit, "asperity.relaxation.fit(data)")
    figure, _ = style.figure_of(style.panels_of(fit).values())
    branches = counted(len(fit.series.branches), "branch", "branches")
    missed = f"{100 * fit.rms:.2g} % rms, {100 * fit.series.error:.2g} % at most"
    style.entitle(figure, "", [f"{branches} over {fit.decades:.1f} decades", f"fit error {missed}"])
    return figure


@style.panels_of.register
def _(fit: Fit) -> dict[str, style.Panel]:
    frequency, time = "angular frequency, 1 / relaxation time [rad/s]", "time, relaxation time [s]"
    along = frequency if isinstance(fit.data, Dynamic) else time
    return {
        "moduli": style.Panel(partial(draw_moduli, fit=fit), along, 3.0),
        "deviations": style.Panel(partial(_draw_deviations, fit=fit), along),
        "branches": style.Panel(partial(_draw_branches, fit=fit), along, 1.3),
    }


def draw_moduli(axes: Axes, fit: Fit) -> None:
    """Draw data and fit."""
    x, values = fit.data.columns
    curve_x, curves = fit.curve()
    scale, unit = _unit(fit)
    for i, name in enumerate(fit.data.quantities):
        axes.plot(x, values[i] * scale, _MARKERS[i], label=name, **_look(i))
        label = f"fit of the {name}"
        axes.plot(curve_x, curves[i] * scale, "-", color=_COLORS[i], linewidth=1.4, label=label)
    axes.set_xscale("log")
    drawn = np.concatenate(values)
    if drawn.max() > 5 * drawn.min():
        axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylabel(f"{'compliance' if isinstance(fit.data, Creep) else 'modulus'} [{unit}]")


def _draw_deviations(axes: Axes, fit: Fit) -> None:
    """Draw the deviations of the data from the fit."""
    x, _ = fit.data.columns
    for i, deviation in enumerate(fit.residuals()):
        axes.plot(x, 100 * deviation, _MARKERS[i], **_look(i))
    axes.axhline(0, color=style.INK, linewidth=0.8)
    reach = 1.25 * max(100 * fit.series.error, 1e-3)
    axes.set(xscale="log", ylim=(-reach, reach), ylabel="data − fit [%]")


def _look(quantity: int) -> dict[str, Any]:
    """Of the points of one of the quantities that were measured."""
    return {"color": _COLORS[quantity], "markersize": 4.5, "markerfacecolor": "white"}


def _draw_branches(axes: Axes, fit: Fit) -> None:
    """Draw the branches at their times, or at 1/time on an axis of frequencies."""
    branches = np.array(fit.series.branches).reshape(-1, 2)
    at = 1 / branches[:, 1] if isinstance(fit.data, Dynamic) else branches[:, 1]
    axes.vlines(at, 0, 100 * branches[:, 0], color=style.GRAY, linewidth=1.2)
    axes.plot(at, 100 * branches[:, 0], "D", color=style.INK, markersize=4)
    most = 150 * max(branches[:, 0], default=1.0)
    axes.set(xscale="log", ylim=(0, most), ylabel="part of the\nmodulus [%]")
    text = f"does not relax: {100 * fit.series.permanent:.3g} % of {written(fit.series.modulus, 'Pa', 3)}"
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.9, "pad": 1.5}
    axes.text(0.015, 0.93, text, transform=axes.transAxes, va="top", bbox=box)


def _unit(fit: Fit) -> tuple[float, str]:
    """Factor to the drawn values, and their unit."""
    name, factor = readable("Pa", fit.series.modulus)
    return (1 / factor, f"1/{name}") if isinstance(fit.data, Creep) else (factor, name)
