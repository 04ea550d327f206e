"""Figure 7: where a self-affine surface touches as the contact ages, and what becomes of its patches."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray
from scipy.special import stdtrit

from asperity.analysis import ContactMaps, SiteState, clustering, contact_maps, patches, turnover
from asperity.base.words import power, thousands
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.paper.figures.marks import (
    COLORS,
    draw_marks,
    mark,
    show_lattice,
    site_side,
    width_in_words,
)
from asperity_research.paper.figures.paper_figure import PAGE, PaperFigure, captioned
from asperity_research.paper.studies import MAP_BOXES
from asperity_research.studies.evidence import Evidence

_STUDY = "maps"
_COLUMNS = 3
_TEXT = 8.0
_READABLE = 1.2
"""Side of a mark, points: larger than for one color, so that colors can be told apart."""


_LOST = style.BLUE

_PANELS = (
    ("number of patches", "log", ("patches",)),
    ("mean patch size", "linear", ("mean_size",)),
    ("sites since $t$ = 0", "log", ("gained_attached", "gained_detached", "lost")),
    ("index of dispersion", "log", ("dispersion",)),
)
"""The small panels: what is on the axis, its scale, and the quantities drawn."""

_CURVES = {
    "patches": (style.INK, "o", "-", ""),
    "mean_size": (style.INK, "o", "-", ""),
    "dispersion": (style.INK, "o", "-", ""),
    "gained_attached": (style.VERMILION, "s", "-", "new, on old patches"),
    "gained_detached": (style.VERMILION, "D", "--", "new, in new patches"),
    "lost": (_LOST, "^", "-.", "lost"),
}


def figure_7(evidence: Evidence) -> PaperFigure:
    """Draw the contact at all kept times, and the statistics of its patches over all seeds."""
    dataset = evidence[_STUDY]
    seeds = [int(seed) for seed in dataset["seed"]]
    every = {seed: contact_maps(evidence.fields(_STUDY, seed=seed)) for seed in seeds}
    first = every[seeds[0]]
    box = max(2, min(first.heights.shape) // MAP_BOXES)
    samples = pd.concat([_statistics(seed, maps, box) for seed, maps in every.items()], ignore_index=True)
    tables = {"contacts": _contacts(first), "patches": samples, "patches_ensemble": _ensemble(samples)}
    figure, width = _drawn(first, tables)
    load = float(dataset["load"].isel(seed=0, time=0))
    facts = {"shape": first.heights.shape, "load": load, "width": width, "box": box, "seeds": len(seeds)}
    return captioned(7, figure, tables, facts)


def _contacts(maps: ContactMaps) -> pd.DataFrame:
    """One row a marked site and time."""
    time, y, x = np.nonzero(maps.states)
    names = np.array([state.name.lower() for state in SiteState])
    state = names[maps.states[time, y, x]]
    return pd.DataFrame({"time": maps.times[time], "state": state, "x": x, "y": y})


def _statistics(seed: int, maps: ContactMaps, box: int) -> pd.DataFrame:
    """One row a time: the patches of one surface, and what became of the first contact."""
    touching = np.isin(maps.states, (SiteState.KEPT, SiteState.NEW))
    rows = []
    for time, now in zip(maps.times, touching, strict=True):
        found, change = patches(now), turnover(touching[0], now)
        row = {"seed": seed, "time": time, "area": int(now.sum()), "patches": found.count}
        row |= {name: getattr(found, name) for name in ("mean_size", "largest")}
        row |= {name: getattr(change, name) for name in ("gained_attached", "gained_detached", "lost")}
        rows.append(row | {"dispersion": clustering(now, box)})
    return pd.DataFrame(rows)


def _ensemble(samples: pd.DataFrame) -> pd.DataFrame:
    """One row a quantity and time: mean over the seeds, its standard error, and half its 95 % interval."""
    long = samples.melt(id_vars=["seed", "time"], var_name="quantity")
    grouped = long.groupby(["quantity", "time"], sort=True)["value"]
    table = grouped.agg(mean="mean", stderr="sem", seeds="count").reset_index()
    return table.assign(half_interval=table["stderr"] * stdtrit(table["seeds"] - 1, 0.975))


def _drawn(maps: ContactMaps, tables: dict[str, pd.DataFrame]) -> tuple[Figure, str]:
    """Draw maps and curves; say also how wide the marks are."""
    rows = math.ceil(len(maps.times) / _COLUMNS)
    figure = Figure(figsize=(PAGE, 2.4 * rows + 2.3), layout="constrained")
    parts = figure.subfigures(2, 1, squeeze=False, height_ratios=(2.4 * rows + 0.3, 2.0))
    upper, lower = parts[:, 0]
    panels = upper.subplots(rows, _COLUMNS, squeeze=False).ravel()
    for axes in panels:
        axes.set_xticks([])
        axes.set_yticks([])
    for unused in panels[len(maps.times) :]:
        unused.set_axis_off()
    for number, (axes, time) in enumerate(zip(panels, maps.times, strict=False)):
        title = _counted(tables["contacts"].query("time == @time"))
        axes.set_title(f"({chr(ord('a') + number)}) {_moment(time)}:  {title}", fontsize=_TEXT)
        show_lattice(axes, maps.heights.shape)
    _add_legend(upper)
    _draw_curves(lower, tables["patches_ensemble"], chr(ord("a") + len(maps.times)))
    site = site_side(panels[0], maps.heights.shape[1])
    side = max(site, _READABLE)
    for axes, states in zip(panels, maps.states, strict=False):
        _draw_sites(axes, states, side)
    return figure, width_in_words(side, site)


def _draw_sites(axes: Axes, states: NDArray[np.int8], side: float) -> None:
    """Mark the sites; those that were lost with open circles, which differ from the others without color."""
    rows, columns = np.nonzero(states == SiteState.LOST)
    axes.plot(
        columns, rows, "o", color="none", markeredgecolor=_LOST, markersize=2.5 * side, mew=0.6, zorder=0.5
    )
    draw_marks(axes, np.where(states == SiteState.LOST, np.int8(SiteState.FREE), states), side)


def _moment(time: float) -> str:
    return r"$t \to \infty$" if math.isinf(time) else f"$t\\,k_0R = {power(time)}$"


def _counted(marked: pd.DataFrame) -> str:
    """The number of sites in contact, and of those gained and lost since t = 0."""
    kept, new, lost = (int((marked["state"] == state).sum()) for state in ("kept", "new", "lost"))
    changes = ", ".join(f"{sign}{thousands(sites)}" for sign, sites in (("+", new), ("−", lost)) if sites)
    return f"$A$ = {thousands(kept + new)}" + (f"  ({changes})" if changes else "")


def _add_legend(figure: SubFigure) -> None:
    handles = [
        mark("s", COLORS[SiteState.KEPT], COLORS[SiteState.KEPT], "in contact then and at $t$ = 0"),
        mark("s", COLORS[SiteState.NEW], COLORS[SiteState.NEW], "new since $t$ = 0"),
        mark("o", "none", _LOST, "lost since $t$ = 0"),
    ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=3, fontsize=_TEXT, frameon=False, handletextpad=0.1
    )


def _draw_curves(figure: SubFigure, ensemble: pd.DataFrame, letter: str) -> None:
    panels = figure.subplots(1, len(_PANELS))
    for number, (axes, (label, scale, quantities)) in enumerate(zip(panels, _PANELS, strict=True)):
        for quantity in quantities:
            _draw_curve(axes, ensemble[ensemble["quantity"] == quantity], quantity)
        axes.set_yscale(scale)
        axes.yaxis.set_minor_formatter(NullFormatter())
        bottom = _bottom(ensemble[ensemble["quantity"].isin(quantities)], scale)
        if bottom is not None:
            axes.set_ylim(bottom=bottom)
        axes.set_title(f"({chr(ord(letter) + number)})", fontsize=_TEXT + 1, loc="left")
        axes.set_ylabel(label, fontsize=_TEXT)
        axes.set_xlabel("$t\\,k_0R$", fontsize=_TEXT)
        axes.tick_params(labelsize=_TEXT - 1)
        times = np.unique(ensemble["time"])
        axes.set_xticks(_places(times), [f"${power(time)}$" for time in times])
    panels[-1].axhline(1.0, color=style.GRAY, linestyle=":", linewidth=1.0)
    handles, labels = panels[2].get_legend_handles_labels()
    labels[0] = f"({chr(ord(letter) + 2)})  {labels[0]}"
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=_TEXT, frameon=False)


def _bottom(curves: pd.DataFrame, scale: str) -> float | None:
    """Where the axis begins: error bars that reach 0 must not stretch it; None leaves it to Matplotlib."""
    if scale == "linear":
        return 0.0
    reach = curves["mean"] - curves["half_interval"] <= 0
    above = curves["mean"] > 0
    return float(curves.loc[above, "mean"].min()) / 3 if (reach & above).any() else None


def _draw_curve(axes: Axes, curve: pd.DataFrame, quantity: str) -> None:
    """Draw means with error bars; the relaxed state has an open symbol."""
    color, marker, line, label = _CURVES[quantity]
    time, mean, error = (curve[name].to_numpy() for name in ("time", "mean", "half_interval"))
    place = _places(time)
    drawn = mean > 0
    axes.plot(place[drawn], mean[drawn], line, color=color, linewidth=1.0, zorder=2)
    look: dict[str, Any] = {
        "fmt": marker,
        "color": color,
        "markersize": 3.5,
        "elinewidth": 0.9,
        "capsize": 1.5,
        "zorder": 3,
    }
    for here, face in ((drawn & np.isfinite(time), color), (drawn & np.isinf(time), "white")):
        bars, said = None if np.isnan(error).all() else error[here], label if face == color else ""
        axes.errorbar(place[here], mean[here], yerr=bars, markerfacecolor=face, label=said, **look)


def _places(times: Field) -> Field:
    """Where on the axis a time is: at its logarithm, and 0 and infinity one even step beyond the others."""
    finite = np.log10(times[(times > 0) & np.isfinite(times)])
    if not finite.size:
        return np.arange(times.size, dtype=np.float64)
    step = max(1.0, float(np.ptp(finite)) / max(1, finite.size - 1))
    with np.errstate(divide="ignore"):
        place = np.log10(times)
    return np.clip(place, finite.min() - step, finite.max() + step)
