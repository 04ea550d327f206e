"""An inference, drawn: the curve and its band, each parameter, pairs of them; and a page."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.base.readable import in_unit
from asperity.figures import style
from asperity.figures.page import Picture, pictures_of, written_page
from asperity.inference.found import Inference
from asperity.inference.indented import IndentedSolid
from asperity.inference.leastsquares import LIMIT

_COLUMNS = 3
_BINS = 41
_PREDICTED = "predicted_N", "predicted_N_low", "predicted_N_high"
_OF_PARAMETERS = (
    "Each parameter: its prior (gray), draws of its posterior (blue), and its profile likelihood, which "
    "falls below the dotted line outside of a 95 % interval. Where the blue fills the gray, the data tell "
    "nothing."
)
_DATA: dict[str, Any] = {"color": style.INK, "markersize": 4, "markerfacecolor": "white"}


@style.panels_of.register
def _(found: Inference) -> dict[str, style.Panel]:
    along = "hold time [s]"
    return {
        "curve": style.Panel(lambda axes: _draw_curve(axes, found), along, 3),
        "deviations": style.Panel(lambda axes: _draw_deviations(axes, found), along),
    }


@style.panels_of.register
def _(found: IndentedSolid) -> dict[str, style.Panel]:
    along = "time [s]"
    return {
        "curve": style.Panel(lambda axes: _draw_forces(axes, found), along, 3),
        "depth": style.Panel(lambda axes: _draw_depth(axes, found), along),
    }


def _in_contact(found: IndentedSolid) -> pd.DataFrame:
    """Forces from shortly before the contact to shortly after it."""
    rows, last = found.forces, found.record.largest
    touching = (rows["predicted_N"] > 0.01 * last) | (rows["force_N"] > 0.05 * last)
    time = rows["time_s"][touching]
    margin = (time.max() - time.min()) / 6
    return rows[rows["time_s"].between(time.min() - margin, time.max() + margin)]


def _draw_forces(axes: Axes, found: IndentedSolid) -> None:
    """Draw measured forces, the fit to approach and hold, and the predicted retraction."""
    rows = _in_contact(found)
    unit, factor = in_unit(found.record.largest, "N")
    axes.plot(rows["time_s"], factor * rows["force_N"], "o", label="measured", **_DATA | {"markersize": 2.5})
    back = rows["segment"] == "retraction"
    fitted = rows[~back]
    axes.plot(fitted["time_s"], factor * fitted["predicted_N"], color=style.BLUE, label="fit")
    if back.any():
        back |= back.shift(-1, fill_value=False)  # from the last row of the fit on
        time, best, low, high = (rows.loc[back, name] for name in ("time_s", *_PREDICTED))
        axes.fill_between(time, factor * low, factor * high, color=style.ORANGE, alpha=0.4)
        axes.plot(time, factor * best, color=style.VERMILION, label="predicted retraction")
    axes.set_ylabel(f"force [{style.spelled(unit)}]")


def _draw_depth(axes: Axes, found: IndentedSolid) -> None:
    """Draw the depth."""
    rows = _in_contact(found)
    unit, factor = in_unit(float(rows["depth_m"].abs().max()), "m")
    axes.plot(rows["time_s"], factor * rows["depth_m"], color=style.INK, linewidth=1.0)
    axes.set_ylabel(f"depth [{style.spelled(unit)}]")


@style.drawn
def modulus_figure(found: IndentedSolid) -> style.Drawing:
    """Draw the modulus against time after a load, where the record determines it."""
    figure, (axes,) = style.stacked((style.COLUMN, 2.2), 1)
    time = np.geomspace(*found.record.span, 60)
    low, median, high = found.modulus_at(time)
    unit, factor = in_unit(float(median[0]), "Pa")
    axes.fill_between(time, factor * low, factor * high, color=style.SKY, alpha=0.5, label="95 % band")
    axes.plot(time, factor * median, color=style.BLUE, label="median")
    axes.set(xscale="log", xlabel="time after a load [s]", ylabel=f"{found.kind} [{style.spelled(unit)}]")
    style.finish(axes)
    return figure


def _draw_curve(upper: Axes, inference: Inference) -> None:
    """Draw the data, and the curve to ten times the last."""
    t, first = inference.time, float(inference.time[inference.time > 0][0])
    shown = t > 0
    at = np.geomspace(first, 10 * t[-1], 120)
    low, middle, high = inference.predicted(at)
    upper.fill_between(at, low, high, color=style.SKY, alpha=0.5, label="95 % band of acceptable models")
    upper.plot(at, middle, color=style.BLUE, linewidth=1.4, label=f"{inference.rivals[0].name}, median")
    upper.axvline(t[-1], color=style.GRAY, linewidth=0.8, linestyle=":")
    measured = t[shown], inference.value[shown], inference.error[shown]
    upper.errorbar(*measured, fmt="o", label="data", elinewidth=0.8, **_DATA)
    upper.set_xscale("log")
    unit = f" [{style.spelled(inference.unit)}]" if inference.unit else ""
    upper.set_ylabel(style.verbatim(f"{inference.quantity}{unit}"))


def _draw_deviations(axes: Axes, inference: Inference) -> None:
    """Draw by how many errors the data deviate."""
    shown = inference.time > 0
    deviation = (inference.value - inference.predicted(inference.time)[1]) / inference.error
    axes.axhline(0, color=style.INK, linewidth=0.8)
    axes.plot(inference.time[shown], deviation[shown], "o", **_DATA)
    axes.set(xscale="log", ylabel="deviation [errors]")


@style.drawn
def parameters_figure(inference: Inference) -> style.Drawing:
    """Draw the posterior of each parameter of the curve over its prior, and its profile likelihood."""
    shown = {name: inference.verdicts[name] for name in inference.profiles}
    rows = -(-len(shown) // _COLUMNS)
    figure = style.Drawing(figsize=(style.PAGE, 1.7 * rows))
    panels = list(figure.subplots(rows, _COLUMNS, squeeze=False).ravel())
    prior = inference.problem.values(inference.problem.of_prior(np.random.default_rng(0), 20_000))
    for axes, (name, verdict) in zip(panels, shown.items(), strict=False):
        law = inference.model.priors[name]
        values, before = inference.values[name].ravel(), prior[name]
        logarithmic = law.kind.startswith("log")
        if logarithmic:
            axes.set_xscale("log")
        low, high = (law.first, law.second) if law.bounded else law.at(np.array(law.reach))
        steps = np.geomspace(low, high, _BINS) if logarithmic else np.linspace(low, high, _BINS)
        for drawn, color, label in ((before, style.GRAY, "prior"), (values, style.BLUE, "posterior")):
            counts = np.histogram(drawn, steps)[0]
            look = {"color": color, "fill": color == style.BLUE, "alpha": 0.7}
            axes.stairs(counts / counts.max(), steps, label=label, **look)
        at, deviance = inference.profiles[name]
        axes.plot(at, np.exp(-deviance / 2), color=style.VERMILION, linewidth=1.3, label="profile likelihood")
        axes.axhline(np.exp(-LIMIT / 2), color=style.VERMILION, linewidth=0.6, linestyle=":")
        unit = f" [{verdict.unit}]" if verdict.unit else ""
        axes.set(title=f"{name}{unit}\n{verdict.verdict}", yticks=[])
        style.finish(axes, legend=False)
    style.legend_below(figure, panels[0], 3)
    for axes in panels[len(shown) :]:
        axes.set_visible(False)
    return figure


@style.drawn
def corner_figure(inference: Inference) -> style.Drawing:
    """Draw the posterior of each pair of parameters that the curve contains, ln of what spans a decade."""
    drawn: dict[str, Floats] = {}
    for name in inference.profiles:
        values = np.clip(inference.values[name].ravel(), *np.quantile(inference.values[name], (0.002, 0.998)))
        wide = inference.model.priors[name].logarithmic and values.max() > 10 * values.min()
        drawn[f"ln {name}" if wide else name] = np.log(values) if wide else values
    side, shares = max(len(drawn), 2), np.array([0.025, 0.5, 0.975])
    figure = style.Drawing(figsize=2 * (min(1.8 * side, style.PAGE),))
    figure.table = {"quantile": shares} | {name: np.quantile(x, shares) for name, x in drawn.items()}
    figure.elsewhere = "the samples in posterior.nc" if inference.sampled else "draws along profiles"
    panels = figure.subplots(len(drawn), len(drawn), sharex="col", squeeze=False)
    for row, (name, values) in enumerate(drawn.items()):
        for column, (other, across) in enumerate(drawn.items()):
            axes = panels[row, column]
            axes.set(visible=column <= row, yticks=[])
            if column == row:
                axes.hist(values, _BINS, color=style.BLUE, alpha=0.7)
            elif column < row:
                axes.hexbin(across, values, gridsize=_BINS // 2, cmap="Blues", mincnt=1, linewidths=0)
            if column == 0 < row:
                axes.set_ylabel(name)
            if row == len(drawn) - 1:
                axes.set_xlabel(other)
    return figure


def inference_pictures(found: Inference) -> dict[str, Picture]:
    """Draw an inference: pictures by the names of their files, without suffix, in order."""
    checks.instance("found", found, Inference, "asperity.infer(time, area, error)")
    of_data = "The data, and the curve to ten times the last of them."
    of_record = "The record: measured forces, the fit to approach and hold, the predicted retraction."
    draws: dict[str, tuple[str, Callable[[], style.Drawing]]] = {
        "curve": (
            of_record if isinstance(found, IndentedSolid) else of_data,
            lambda: style.figure_of(style.panels_of(found).values())[0],
        )
    }
    if isinstance(found, IndentedSolid):
        words = "The relaxing modulus, over the times that the record determines."
        draws["modulus"] = words, partial(modulus_figure, found)
    draws["parameters"] = _OF_PARAMETERS, partial(parameters_figure, found)
    words = "Draws of the posterior: every pair of parameters that the curve contains."
    draws["corner"] = words, partial(corner_figure, found)
    return pictures_of(draws)


def inference_page(
    found: Inference, pictures: Mapping[str, Picture], *, source: str = "", command: str = ""
) -> str:
    """Write an inference as a page of HTML, with the pictures of `inference_pictures`.

    The source of the data and the command line that made it may be empty.
    """
    checks.instance("found", found, Inference, "asperity.infer(time, area, error)")
    return written_page(
        "inference.html",
        f=found,
        pictures=list(pictures.values()),
        source=source or "The curve",
        command=command,
    )
