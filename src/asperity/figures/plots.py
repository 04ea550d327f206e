"""Single plots, such as `Contact.plot` and `History.plot`, into axes of the user or new ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from asperity.analysis import ContactMaps, SiteState
from asperity.analysis.maps import maps_between
from asperity.base import checks, views
from asperity.base.readable import written
from asperity.contact import Contact
from asperity.errors import InputError
from asperity.figures import style
from asperity.figures.contacts import (
    COLORS,
    draw_pressure,
    draw_profile,
    draw_scale_bar,
    draw_sites,
    draw_states,
    positions,
    side_of_cells,
    swatches,
)
from asperity.figures.history import draw_legs, shown_series
from asperity.figures.surface import SurfaceView, draw_heights, draw_map, draw_spectrum
from asperity.lattice import Field
from asperity.results.history import History, check_dataset
from asperity.surfaces import PowerSpectrum, Surface

_LOWEST = 0.02
"""Part of the sites in contact whose pressure is below the range of colors."""

_SINCE = {SiteState.KEPT: "touches, then and now", SiteState.NEW: "new", SiteState.LOST: "lost"}


@views.defines(Contact.plot)
@style.drawn
def plot_contact(
    contact: Contact, ax: Axes | None = None, *, since: Contact | None = None, colorbar: bool = True
) -> Axes:
    """Draw where a contact touches and with which pressure, or what it won and lost since an earlier one.

    Parameters
    ----------
    contact
        From `asperity.press`, `asperity.relax`, or the ``final`` of a history.
    ax
        Where to draw; by default a new figure.
    since
        An earlier contact of the same surface. Then the colors tell contacts that were there, new and lost.
    colorbar
        Whether to explain the colors, of pressures by a bar, of changes by a legend.

    Returns
    -------
    Axes
        Of a surface a map; where sites are too small to be seen, a coarser sample of true area. Of a profile
        heights and elastic surface in the stretch with most contacts. Of a mirrored scan the scan alone.

    Raises
    ------
    InputError
        The earlier contact is of another surface.
    """
    checks.instance("contact", contact, Contact, "asperity.press(...)")
    if since is not None:
        checks.instance("since", since, Contact, "the contact before: asperity.press(...)")
    maps = maps_between(contact, since)
    axes = axes_for(ax)
    pressure, label = _pressure(contact, maps)
    colored: ScalarMappable | None = None
    if maps.heights.ndim == 1:
        colored = _draw_line(axes, maps, pressure, changed=since is not None)
        if colorbar:
            axes.legend(loc="lower left", framealpha=0.95)
    else:
        side = cells_in(axes, maps)
        if since is not None:
            draw_states(axes, maps, maps.sampled(side)[-1], side)
            if colorbar:
                _explain(axes, maps)
        else:
            shown = maps.coarsened(pressure[np.newaxis], side, np.nan)[0]
            colored = draw_pressure(axes, maps, shown, pressure_norm(shown), side)
        draw_scale_bar(axes, maps)
    if colorbar and colored is not None:
        style.bar_of_pressures(axes.figure, colored, axes, label)
    axes.set_title(_said(contact, maps))
    return axes


@style.drawn
def plot_history(
    dataset: xr.Dataset,
    ax: Axes | None = None,
    *,
    quantity: str = "area",
    limit: Contact | None = None,
    label: str = "",
    color: str | None = None,
) -> Axes:
    """Draw how one quantity of a history changed.

    Parameters
    ----------
    dataset
        The dataset of a `History`.
    ax
        Where to draw; by default a new figure.
    quantity
        Any series of the dataset, such as ``"area"``, ``"load"`` or ``"separation"``.
    limit
        The relaxed state, from `asperity.relax`, to be drawn as a dotted line. It is not needed where
        `asperity.analysis.with_limit` has put it into the dataset.
    label, color
        Name of the curve in the legend, and its color, where several histories share axes. By default the
        next color of the axes' cycle; of a new figure, blue.

    Returns
    -------
    Axes
        Without a protocol, the quantity over the logarithm of time; that at time 0 is a thin line. With one,
        a column for each leg that lasts, over the time since its beginning.

    Raises
    ------
    InputError
        There is no such series, or no time above 0.
    """
    check_series(dataset, quantity)
    relaxed = _limit_of(dataset, quantity, limit)
    axes = axes_for(ax)
    draw_series(axes, dataset, quantity, relaxed, label, color or (style.BLUE if ax is None else None))
    if ax is None and quantity == "area":
        _, _, factor = shown_series(dataset, quantity)
        style.count_nominal_area(axes, 100.0 / (dataset.attrs["sites"] * factor))
    return axes


views.defines(History.plot)(lambda history, *ax, **how: plot_history(history.dataset, *ax, **how))


def check_series(dataset: xr.Dataset, quantity: str) -> None:
    """Refuse a history that has no such series, or no time above 0."""
    check_dataset(dataset)
    series = [name for name in map(str, dataset.data_vars) if dataset[name].dims == ("time",)]
    if quantity not in series:
        raise InputError("quantity", expected=f"one of {', '.join(series)}", got=checks.shown(quantity))
    if float(dataset["time"][-1]) <= 0:
        advice = "age(contact, times=[1.0, 10.0])"
        raise InputError("history", expected="times above 0", got="time 0 alone", advice=advice)


def draw_series(
    axes: Axes,
    dataset: xr.Dataset,
    quantity: str,
    relaxed: float | None = None,
    label: str = "",
    color: str | None = style.BLUE,
) -> Field:
    """Draw a series that `check_series` accepts; return where its entries are along the time axis."""
    values, name, factor = shown_series(dataset, quantity)
    time = dataset["time"].values.astype(np.float64)
    if "protocol" in dataset.attrs:
        place = draw_legs(axes, dataset, quantity)
    else:
        place = time
        axes.set_xscale("log")
        later = time > 0
        curve: Any = style.curve(axes, time[later], values[later], "o-", color, label, zorder=3)
        color = curve.get_color()  # the next one where none was given
        if not label:
            axes.axhline(values[0], color=style.GRAY, linewidth=0.8, label="at $t$ = 0", zorder=1)
        axes.set_ylabel(name, multialignment="center")
        axes.set_xlabel(style.over_time(dataset, "hold time $t$"))
    if relaxed is not None:
        prefix = f"{label}: " if label else ""
        look: dict[str, Any] = {"color": color if label else style.INK, "linestyle": ":", "linewidth": 1.4}
        axes.axhline(relaxed * factor, label=rf"{prefix}relaxed limit, $t \to \infty$", zorder=1, **look)
    style.finish(axes, lines_along="y" if "protocol" in dataset.attrs else "both")
    return place


@views.defines(Surface.plot)
@style.drawn
def plot_surface(surface: Surface, ax: Axes | None = None) -> Axes:
    """Draw a surface as a map of heights, a profile as a line, and of a mirrored scan the scan.

    Raises
    ------
    InputError
        It is no `Surface`.
    """
    checks.instance("surface", surface, Surface, "asperity.surfaces.Surface(heights)")
    view = SurfaceView(surface)
    axes = axes_for(ax)
    if view.heights.ndim == 2:
        draw_map(axes, view)
    else:
        draw_heights(axes, view)
    return axes


@views.defines(PowerSpectrum.plot)
@style.drawn
def plot_spectrum(spectrum: PowerSpectrum, ax: Axes | None = None) -> Axes:
    """Draw a power spectrum, with the power law of its self-affine range if it has one.

    Raises
    ------
    InputError
        It is no `PowerSpectrum`.
    """
    checks.instance("spectrum", spectrum, PowerSpectrum, "asperity.surfaces.power_spectrum(surface)")
    axes = axes_for(ax)
    draw_spectrum(axes, spectrum)
    return axes


@views.defines(views.Pictured.plot)
@style.drawn
def plot_kind(thing: views.Pictured, kind: str | None = None, ax: Axes | None = None) -> Axes:
    """Draw one panel of a result.

    Parameters
    ----------
    thing
        A prediction, an inference, or a fit of relaxation, of growth, or of friction.
    kind
        By default the first. Of a prediction ``"area"``, ``"growth"``, ``"pressure"``, ``"contacts"``,
        ``"friction"``, or a series of its dataset such as ``"normal_stiffness"``; of an inference ``"curve"``
        or ``"deviations"``; of relaxation ``"moduli"``, ``"deviations"`` or ``"branches"``; of growth
        ``"growth"`` or ``"residuals"``; of friction ``"record"``, ``"residuals"``, ``"state"`` or
        ``"healing"``.
    ax
        Where to draw; by default a new figure, as wide as a column of a journal.

    Raises
    ------
    InputError
        The result has no such panel.
    """
    checks.instance("thing", thing, views.Pictured, "asperity.predict(...)")
    panels = style.panels_of(thing)
    kind = next(iter(panels)) if kind is None else kind
    if kind not in panels:
        raise InputError("kind", expected=f"one of {', '.join(panels)}", got=checks.shown(kind))
    axes, panel = axes_for(ax), panels[kind]
    panel.draw(axes)
    if panel.along:
        axes.set_xlabel(panel.along)
        style.finish(axes)
    return axes


def axes_for(ax: Axes | None) -> Axes:
    """Axes that were given, or those of a new figure, which a notebook or ``pyplot.show()`` shows."""
    if ax is not None:
        return checks.instance("ax", ax, Axes, "fig, ax = matplotlib.pyplot.subplots()")
    return shown_figure((style.COLUMN, 2.6)).subplots()


@style.drawn
def shown_figure(size: tuple[float, float]) -> Figure:
    """Make a figure, of this size in inches, that a notebook or ``pyplot.show()`` shows."""
    import matplotlib.pyplot as plt  # it looks for a display, so only where a figure is to be shown

    options: Any = {"FigureClass": lambda **_: style.Drawing(figsize=size)}
    return plt.figure(**options)


def _pressure(contact: Contact, maps: ContactMaps) -> tuple[Field, str]:
    """Pressure over the sites that are shown, NaN off contact, and the label of its axis."""
    scan = tuple(slice(0, n) for n in maps.heights.shape)
    touching = contact.in_contact[scan]
    pressure = np.where(touching, contact.pressure[scan], np.nan)
    if not contact.solid.in_lengths:
        return pressure, r"contact force  [stiffness $\times$ height]"
    if not contact.si:
        return pressure, "contact pressure"
    label, factor = style.scaled("contact pressure", "Pa", float(np.nanmax(pressure, initial=0.0)))
    return pressure * factor, label


def pressure_norm(pressure: Field) -> LogNorm:
    """Colors of pressures: logarithmic, the lowest of them beyond the range."""
    positive = pressure[np.nan_to_num(pressure) > 0]
    if not positive.size:
        return LogNorm(0.1, 1.0)
    low, high = np.quantile(positive, (_LOWEST, 1.0))
    return LogNorm(low if low < high else high / 2, high)


def _draw_line(axes: Axes, maps: ContactMaps, pressure: Field, *, changed: bool) -> ScalarMappable | None:
    """Draw a profile and where it touches: changes in the colors of maps, else pressures."""
    first, last = maps.window
    step, across = positions(maps)
    axes.set_xlabel(across)
    draw_profile(axes, maps, {0: "then", 1: "now"} if changed else {1: "elastic surface"})
    if changed:
        for state, word in _SINCE.items():
            draw_sites(axes, maps, [state], color=COLORS[state], label=word)
        return None
    at = first + np.flatnonzero(~np.isnan(pressure[first:last]))
    if not at.size:
        return None
    norm = pressure_norm(pressure[at])
    look: dict[str, Any] = {"norm": norm, "cmap": style.PRESSURE_MAP, "marker": "s", "s": 16}
    return axes.scatter(step * at, (maps.heights - maps.indentation)[at], c=pressure[at], zorder=5, **look)


def _explain(axes: Axes, maps: ContactMaps) -> None:
    if handles := swatches(maps.states[-1], _SINCE, 6):
        corner = (1.0, 0.0 if maps.pixel_size is None else -0.07)
        look: dict[str, Any] = {"ncols": len(handles), "frameon": False}
        axes.legend(handles=handles, loc="upper right", bbox_to_anchor=corner, **look)


def _said(contact: Contact, maps: ContactMaps) -> str:
    """The part in contact, the load, and the changes."""
    force = "N/m" if contact.lattice.dimension == 1 else "N"
    load = style.spaced(written(contact.load, force if contact.si else "1"))
    changes = [(word, maps.count(-1, state)) for state, word in _SINCE.items() if state != SiteState.KEPT]
    counts = ", ".join(f"{word} {count}" for word, count in changes if count)
    return f"{100 * contact.contact_fraction:.3g} % touches, load {load}\n{counts}".rstrip()


def _limit_of(dataset: xr.Dataset, quantity: str, limit: Contact | None) -> float | None:
    """The quantity in the relaxed state; None where nobody computed it."""
    relaxed = dataset.attrs.get(f"relaxed_{quantity}")
    if limit is not None:
        relaxed = getattr(checks.instance("limit", limit, Contact, "asperity.relax(contact)"), quantity, None)
        if relaxed is None:
            raise InputError("limit", expected=f"none, as a contact alone has no {quantity}", got="a contact")
    return None if relaxed is None else float(relaxed)


def cells_in(axes: Axes, maps: ContactMaps) -> int:
    """Sites along a side of the cells that are drawn in these axes."""
    return side_of_cells(maps, axes.get_window_extent().width / axes.figure.dpi)
