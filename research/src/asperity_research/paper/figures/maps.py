"""Figures 4 and 7: where a self-affine surface touches as the load grows, and as the contact ages."""

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgba
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray
from scipy.special import stdtrit

from asperity.analysis import ContactMaps, SiteState, clustering, contact_maps, patches, turnover
from asperity.base.words import power, thousands
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.paper.figures.curves import LABEL, SMALL, mark
from asperity_research.paper.figures.paper_figure import PAGE, PaperFigure, captioned
from asperity_research.paper.studies import MAP_BOXES
from asperity_research.studies.evidence import Evidence

_COLORS = {SiteState.KEPT: style.INK, SiteState.NEW: style.VERMILION}
"""They differ from each other, and from white, in luminance too."""

_SMALLEST = 0.8
"""Smallest side of a mark that is drawn faithfully at 200 dots per inch, points: about two pixels."""

_READABLE = 1.2  # The same where colors have to be told apart
_FAINT = LinearSegmentedColormap.from_list("faint", ["0.80", "1.0"])
"""A relief light enough that black sites stand out on it."""

_COLUMNS = 3  # Maps of an aging contact side by side

_PANELS = (
    ("number of patches", "log", ("patches",)),
    ("mean patch size", "linear", ("mean_size",)),
    ("sites since $t$ = 0", "log", ("gained_attached", "gained_detached", "lost")),
    ("index of dispersion", "log", ("dispersion",)),
)
"""The small panels: what is on the axis, its scale, and the quantities drawn."""

_CURVES = {
    **dict.fromkeys(("patches", "mean_size", "dispersion"), (style.INK, "o", "-", "")),
    "gained_attached": (style.VERMILION, "s", "-", "new, on old patches"),
    "gained_detached": (style.VERMILION, "D", "--", "new, in new patches"),
    "lost": (style.BLUE, "^", "-.", "lost"),
}


def figure_4(evidence: Evidence) -> PaperFigure:
    """Draw the topography, and for each of three loads a map of the sites in contact.

    Tables ``topography``, ``contacts`` (the sites) and ``area`` (their number), of the study ``load_maps``.
    """
    study, contacts, areas, maps = "load_maps", [], [], []
    seed = int(evidence[study]["seed"][0])
    for load in sorted(evidence.values(study, "load")):
        kept = evidence.fields(study, load=load, seed=seed)
        heights = np.asarray(kept["heights"], dtype=np.float64)
        maps.append(np.asarray(kept["in_contact"].sel(field_time=0.0), dtype=bool))
        y, x = np.nonzero(maps[-1])
        contacts.append(pd.DataFrame({"load": load, "time": 0.0, "state": "in contact", "x": x, "y": y}))
        areas.append({"load": load, "area": x.size, "contact_fraction": x.size / heights.size})
    rows, columns = np.indices(heights.shape)
    tables = {
        "topography": pd.DataFrame({"x": columns.ravel(), "y": rows.ravel(), "height": heights.ravel()}),
        "contacts": pd.concat(contacts, ignore_index=True),
        "area": pd.DataFrame(areas),
    }
    figure = Figure(figsize=(PAGE, 6.2), layout="constrained")
    panels = figure.subplots(2, 2).ravel()
    image = panels[0].imshow(heights, cmap="gray", interpolation="none", rasterized=True)
    bar = figure.colorbar(image, ax=panels.tolist(), location="right", aspect=40, pad=0.02)
    bar.set_label(r"height $\xi$ in (a)", fontsize=LABEL)
    bar.ax.tick_params(labelsize=SMALL)
    titles = [r"(a) topography $\xi(\mathbf{r})$"]
    for letter, row in zip("bcd", areas, strict=True):
        fraction = f"{100 * row['contact_fraction']:.2g} %"
        area = f"$A$ = {thousands(int(row['area']))} ({fraction})"
        titles.append(f"({letter}) $F_N/k_0 = {power(row['load'])}$:  {area}")
    for number, (axes, title) in enumerate(zip(panels, titles, strict=True)):
        if number:
            axes.imshow(heights, cmap=_FAINT, interpolation="none", rasterized=True)
        axes.set_title(title, fontsize=LABEL + 1)
        left, low = number % 2 == 0, number > 1
        axes.set_xticks([0, heights.shape[1] // 2, heights.shape[1] - 1])
        axes.set_yticks([0, heights.shape[0] // 2, heights.shape[0] - 1])
        axes.tick_params(labelsize=SMALL, labelbottom=low, labelleft=left)
        axes.set_xlabel("$x$ (sites)" if low else "", fontsize=LABEL)
        axes.set_ylabel("$y$ (sites)" if left else "", fontsize=LABEL)
    side, width = _side_of_marks(panels[0], heights.shape[1], _SMALLEST)
    for axes, touching in zip(panels[1:], maps, strict=True):
        _draw_marks(axes, np.where(touching, np.int8(SiteState.KEPT), np.int8(SiteState.FREE)), side)
    return captioned(4, figure, tables, {"width": width})


def figure_7(evidence: Evidence) -> PaperFigure:
    """Draw the contact at all kept times, and the statistics of its patches over all seeds.

    Tables ``contacts`` (every marked site of the first seed and time), ``patches``, and ``patches_ensemble``
    (mean over the seeds, its standard error, and half its 95 % interval), of the study ``maps``.
    """
    dataset = evidence["maps"]
    every = {int(seed): contact_maps(evidence.fields("maps", seed=int(seed))) for seed in dataset["seed"]}
    first = next(iter(every.values()))
    shape = first.heights.shape
    box = max(2, min(shape) // MAP_BOXES)
    samples = pd.concat([_statistics(seed, maps, box) for seed, maps in every.items()], ignore_index=True)
    grouped = samples.melt(["seed", "time"], var_name="quantity").groupby(["quantity", "time"])["value"]
    ensemble = grouped.agg(mean="mean", stderr="sem", seeds="count").reset_index()
    ensemble = ensemble.assign(half_interval=ensemble["stderr"] * stdtrit(ensemble["seeds"] - 1, 0.975))
    time, y, x = np.nonzero(first.states)
    state = np.array([state.name.lower() for state in SiteState])[first.states[time, y, x]]
    contacts = pd.DataFrame({"time": first.times[time], "state": state, "x": x, "y": y})
    tables = {"contacts": contacts, "patches": samples, "patches_ensemble": ensemble}
    figure, width = _drawn(first, tables)
    load = float(dataset["load"].isel(seed=0, time=0))
    facts = {"shape": shape, "load": load, "width": width, "box": box, "seeds": len(every)}
    return captioned(7, figure, tables, facts)


def _statistics(seed: int, maps: ContactMaps, box: int) -> pd.DataFrame:
    """One row a time: the patches of one surface, and what became of the first contact."""
    touching = np.isin(maps.states, (SiteState.KEPT, SiteState.NEW))
    rows = []
    for time, now in zip(maps.times, touching, strict=True):
        patches_now, change = patches(now), turnover(touching[0], now)
        row = {"seed": seed, "time": time, "area": int(now.sum()), "patches": patches_now.count}
        row |= {name: getattr(patches_now, name) for name in ("mean_size", "largest")}
        row |= {name: getattr(change, name) for name in ("gained_attached", "gained_detached", "lost")}
        rows.append(row | {"dispersion": clustering(now, box)})
    return pd.DataFrame(rows)


def _drawn(maps: ContactMaps, tables: dict[str, pd.DataFrame]) -> tuple[Figure, str]:
    """Draw maps and curves; say also how wide the marks are."""
    rows = math.ceil(len(maps.times) / _COLUMNS)
    figure = Figure(figsize=(PAGE, 2.4 * rows + 2.3), layout="constrained")
    upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(2.4 * rows + 0.3, 2.0))[:, 0]
    panels = upper.subplots(rows, _COLUMNS, squeeze=False).ravel()
    for axes in panels[len(maps.times) :]:
        axes.set_axis_off()
    for number, (axes, time) in enumerate(zip(panels, maps.times, strict=False)):
        axes.set(xticks=[], yticks=[], aspect="equal")
        axes.set(xlim=(-0.5, maps.heights.shape[1] - 0.5), ylim=(maps.heights.shape[0] - 0.5, -0.5))
        moment = r"$t \to \infty$" if math.isinf(time) else f"$t\\,k_0R = {power(time)}$"
        title = _counted(tables["contacts"].query("time == @time"))
        axes.set_title(f"({_letter(number)}) {moment}:  {title}", fontsize=LABEL)
    handles = [
        mark("s", _COLORS[SiteState.KEPT], _COLORS[SiteState.KEPT], "in contact then and at $t$ = 0"),
        mark("s", _COLORS[SiteState.NEW], _COLORS[SiteState.NEW], "new since $t$ = 0"),
        mark("o", "none", style.BLUE, "lost since $t$ = 0"),
    ]
    below: dict[str, Any] = {"loc": "outside lower center", "ncols": 3, "fontsize": LABEL, "frameon": False}
    upper.legend(handles=handles, handletextpad=0.1, **below)
    panel_c, letter = _draw_curves(lower, tables["patches_ensemble"], len(maps.times))
    drawn, labels = panel_c.get_legend_handles_labels()
    lower.legend(drawn, [f"({letter})  {labels[0]}", *labels[1:]], **below)
    side, width = _side_of_marks(panels[0], maps.heights.shape[1], _READABLE)
    for axes, states in zip(panels, maps.states, strict=False):
        # Open circles differ from the other marks without color.
        lost = states == SiteState.LOST
        rings: dict[str, Any] = {"color": "none", "markeredgecolor": style.BLUE, "mew": 0.6, "zorder": 0.5}
        axes.plot(*np.nonzero(lost)[::-1], "o", markersize=2.5 * side, **rings)
        _draw_marks(axes, np.where(lost, np.int8(SiteState.FREE), states), side)
    return figure, width


def _letter(number: int) -> str:
    return chr(ord("a") + number)


def _counted(marked: pd.DataFrame) -> str:
    """The number of sites in contact, and of those gained and lost since t = 0."""
    kept, new, lost = (int((marked["state"] == state).sum()) for state in ("kept", "new", "lost"))
    changes = ", ".join(f"{sign}{thousands(sites)}" for sign, sites in (("+", new), ("−", lost)) if sites)
    return f"$A$ = {thousands(kept + new)}" + (f"  ({changes})" if changes else "")


def _side_of_marks(axes: Axes, sites: int, least: float) -> tuple[float, str]:
    """Side of a mark, points, on a map of so many sites a side that is laid out; and that in words."""
    figure = axes.get_figure(root=True)
    assert figure is not None  # a map without a figure has no size
    figure.draw_without_rendering()
    site = float(72 * axes.get_window_extent().width / figure.dpi / sites)
    if site >= least:
        return site, "to scale"
    return least, f"{least / site:.1f} times as wide as they are, to be seen"


def _draw_marks(axes: Axes, states: NDArray[np.int8], side: float) -> None:
    """Put a square mark, its side in points, on each site that is in contact."""
    # Marks that only just meet leave light seams between them: below, the sites themselves, without any.
    palette = np.zeros((len(SiteState), 4))
    for state, color in _COLORS.items():
        palette[state] = to_rgba(color)
    axes.imshow(palette[states], interpolation="none", rasterized=True)
    for state, color in _COLORS.items():
        rows, columns = np.nonzero(states == state)
        if rows.size:
            # A color each and no snapping: else marks move to whole pixels, and gaps open between them.
            look: dict[str, Any] = {"marker": "s", "linewidths": 0, "rasterized": True, "snap": False}
            axes.scatter(columns, rows, s=side**2, c=[color] * rows.size, **look)
    axes.set(xlim=(-0.5, states.shape[1] - 0.5), ylim=(states.shape[0] - 0.5, -0.5))


def _draw_curves(figure: SubFigure, ensemble: pd.DataFrame, first: int) -> tuple[Axes, str]:
    """Draw the small panels, which go on from a letter; return the one that needs a legend."""
    panels = figure.subplots(1, len(_PANELS))
    times = np.unique(ensemble["time"])
    for number, (axes, (label, scale, quantities)) in enumerate(zip(panels, _PANELS, strict=True)):
        for quantity in quantities:
            _draw_curve(axes, ensemble[ensemble["quantity"] == quantity], *_CURVES[quantity])
        axes.set_yscale(scale)
        axes.yaxis.set_minor_formatter(NullFormatter())
        if (bottom := _bottom(ensemble[ensemble["quantity"].isin(quantities)], scale)) is not None:
            axes.set_ylim(bottom=bottom)
        axes.set_title(f"({_letter(first + number)})", fontsize=LABEL + 1, loc="left")
        axes.set_ylabel(label, fontsize=LABEL)
        axes.set_xlabel("$t\\,k_0R$", fontsize=LABEL)
        axes.tick_params(labelsize=SMALL)
        axes.set_xticks(_places(times), [f"${power(time)}$" for time in times])
    panels[-1].axhline(1.0, color=style.GRAY, linestyle=":", linewidth=1.0)
    return panels[2], _letter(first + 2)


def _bottom(curves: pd.DataFrame, scale: str) -> float | None:
    """Where the axis begins: error bars that reach 0 must not stretch it; None leaves it to Matplotlib."""
    if scale == "linear":
        return 0.0
    above = curves[curves["mean"] > 0]
    reach = above["mean"] <= above["half_interval"]
    return float(above["mean"].min()) / 3 if reach.any() else None


def _draw_curve(axes: Axes, curve: pd.DataFrame, color: str, marker: str, line: str, label: str) -> None:
    """Draw means with error bars; the relaxed state has an open symbol."""
    curve = curve.assign(place=_places(curve["time"].to_numpy())).query("mean > 0")
    axes.plot(curve["place"], curve["mean"], line, color=color, linewidth=1.0, zorder=2)
    look: dict[str, Any] = {"color": color, "markersize": 3.5, "elinewidth": 0.9, "capsize": 1.5, "zorder": 3}
    relaxed = np.isinf(curve["time"])
    for part, face, text in ((curve[~relaxed], color, label), (curve[relaxed], "white", "")):
        bars = {"yerr": part["half_interval"], "markerfacecolor": face, "label": text}
        axes.errorbar(part["place"], part["mean"], fmt=marker, **bars, **look)


def _places(times: Field) -> Field:
    """Where on the axis a time is: at its logarithm, and 0 and infinity one even step beyond the others."""
    finite = np.log10(times[(times > 0) & np.isfinite(times)])
    step = max(1.0, float(np.ptp(finite)) / max(1, finite.size - 1))
    with np.errstate(divide="ignore"):
        return np.clip(np.log10(times), finite.min() - step, finite.max() + step)
