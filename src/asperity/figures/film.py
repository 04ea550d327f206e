"""The aging of a contact as an animation: the map at each time beside the curve."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes

import asperity.figures.contacts as contacts
from asperity.analysis import ContactMaps, SiteState, contact_maps
from asperity.analysis.bands import rows_of_maps
from asperity.base import checks, views
from asperity.base.files import expanded
from asperity.errors import InputError, OutputError
from asperity.figures import style
from asperity.figures.plots import cells_in, check_series, draw_series, shown_figure
from asperity.lattice import Field
from asperity.results.history import History
from asperity.results.store import whole_file

_SIZE = (9.6, 4.8)
_DPI = 100

_SIGNS = {
    "minus": "−",
    "fast-backward": "⏮",
    "step-backward": "◁|",
    "play fa-flip-horizontal": "◀",
    "pause": "⏸",
    "play": "▶",
    "step-forward": "|▷",
    "fast-forward": "⏭",
    "plus": "+",
}
"""Signs on the player's buttons, in place of a font from the network."""


class Film(FuncAnimation):
    """An animation that a notebook shows with a player."""

    def _repr_html_(self) -> str:
        player: str = self.to_jshtml()
        for name, sign in _SIGNS.items():
            player = player.replace(f'<i class="fa fa-{name}"></i>', sign)
        return re.sub(r'<link rel="stylesheet"\s+href="https?://[^>]*>', "", player)


def animate_history(
    dataset: xr.Dataset,
    path: str | Path | None = None,
    *,
    quantity: str = "area",
    frames_per_second: float = 4.0,
    overwrite: bool = False,
) -> Film:
    """Animate the contact at the times at which fields were kept, beside a curve over time.

    Parameters
    ----------
    dataset
        The dataset of a `History` that kept fields (``fields_at``).
    path
        File to write: its name ends in ``.gif`` or, where ffmpeg is installed, in ``.mp4``. By default none.
    quantity
        The series beside the map; see `plot_history`.
    frames_per_second
        Maps shown in a second.
    overwrite
        Whether a file that exists is replaced.

    Returns
    -------
    Film
        An animation of matplotlib. A notebook shows it with a player.

    Raises
    ------
    InputError
        The history kept no fields, has no such series, or the file's name ends in something else.
    OutputError
        The file exists, or could not be written.
    """
    maps = contact_maps(dataset)
    rate = checks.number("frames_per_second", frames_per_second, above=0, most=100)
    target = None if path is None else expanded(path)
    writer = None if target is None else _writer(target, rate, overwrite=overwrite)
    check_series(dataset, quantity)
    figure = shown_figure(_SIZE)
    import matplotlib.pyplot as plt  # as `shown_figure` does: it looks for a display

    map_axes, curve_axes = figure.subplots(1, 2, width_ratios=(1, 1.15))
    entries = draw_series(curve_axes, dataset, quantity)
    contacts.legend(figure, maps)
    figure.draw_without_rendering()  # the axes have their size from here on
    show = _profiles(map_axes, maps) if maps.heights.ndim == 1 else _maps(map_axes, maps)
    pointer = curve_axes.axvline(curve_axes.get_xlim()[0], color=style.VERMILION, linewidth=1.4, zorder=5)
    places = _places(dataset, maps, entries, curve_axes)

    def update(number: int) -> list[Artist]:
        map_axes.clear()
        show(number)
        map_axes.set_title(contacts.caption(maps, number), fontsize=9)
        pointer.set_xdata([places[number]] * 2)
        return [*map_axes.get_children(), pointer]

    update(0)
    figure.draw_without_rendering()
    if (legend := curve_axes.get_legend()) is not None:
        legend.set_loc("upper left")  # the best place would change from frame to frame
    figure.set_layout_engine("none")  # to lay out each frame anew would take most of the time
    film = Film(figure, update, frames=len(maps.times), interval=1000 / rate, cache_frame_data=False)
    if target is not None and writer is not None:
        with whole_file(target, overwrite=overwrite) as part:
            film.save(part, writer=writer, dpi=_DPI)
    if target is not None or "inline" in plt.get_backend():
        plt.close(figure)  # it is in a file, or a notebook shows it with a player
    return film


views.defines(History.animate)(lambda history, *path, **how: animate_history(history.dataset, *path, **how))


def _maps(axes: Axes, maps: ContactMaps) -> Callable[[int], None]:
    """How one map is drawn, with the scale of its length."""
    side = cells_in(axes, maps)
    states = maps.sampled(side)

    def show(number: int) -> None:
        contacts.draw_states(axes, maps, states[number], side)
        contacts.draw_scale_bar(axes, maps)

    return show


def _profiles(axes: Axes, maps: ContactMaps) -> Callable[[int], None]:
    """How one elastic surface is drawn, above a profile whose axes do not move."""
    contacts.draw_profile(axes, maps, dict.fromkeys(range(len(maps.times)), ""))
    limits = axes.get_ylim()

    def show(number: int) -> None:
        contacts.draw_profile(axes, maps, {number: "elastic surface"})
        for state in (SiteState.KEPT, SiteState.NEW):
            contacts.draw_sites(axes, maps, [state], number, color=contacts.COLORS[state])
        axes.set(ylim=limits, xlabel=contacts.positions(maps)[1])

    return show


def _places(dataset: xr.Dataset, maps: ContactMaps, entries: Field, axes: Axes) -> Field:
    """Where the maps are on the time axis; on a logarithmic one, time 0 is at its left end."""
    time, moments, (start, end) = dataset["time"].values, dataset["field_time"].values, axes.get_xlim()
    rows = np.array(rows_of_maps(dataset))
    later = np.minimum(rows + 1, time.size - 1)
    lapse = time[later] - time[rows]
    share = np.divide(moments - time[rows], lapse, out=np.zeros_like(lapse), where=lapse > 0)
    places = entries[rows] + share * (entries[later] - entries[rows])
    places = np.append(places, end)[: len(maps.times)]  # the relaxed state is at the end
    return np.asarray(np.maximum(places, start))


def _writer(path: Path, rate: float, *, overwrite: bool) -> AbstractMovieWriter:
    """What writes a file of this name, before anything is drawn."""
    suffix = path.suffix.lower()
    if suffix not in (".gif", ".mp4"):
        raise InputError("path", expected="a name that ends in .gif or .mp4", got=path, advice="aging.gif")
    if suffix == ".mp4" and not FFMpegWriter.isAvailable():
        expected, advice = "a name that ends in .gif where no ffmpeg is installed", path.with_suffix(".gif")
        raise InputError("path", expected=expected, got=path, advice=str(advice))
    if path.exists() and not overwrite:
        raise OutputError(f"{path} exists already and is kept; choose another name, or overwrite=True")
    return PillowWriter(fps=rate) if suffix == ".gif" else FFMpegWriter(fps=rate)  # type: ignore[arg-type]
