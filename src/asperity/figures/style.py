"""What the figures share: the widths and letters of journals, colors that survive gray printing, numbers.

The hues are of the set of M. Okabe and K. Ito, "Color Universal Design" (2008), chosen so that their
luminances differ too, also for color-blind readers.
"""

from __future__ import annotations

import functools
import json
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext, suppress
from os import PathLike
from typing import IO, Any, Literal, NamedTuple, ParamSpec, TypeVar

import numpy as np
import xarray as xr
from matplotlib import rc_context, rcParams
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backend_bases import RendererBase
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure, SubFigure
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.textpath import text_to_path
from matplotlib.ticker import LogLocator, NullFormatter

from asperity.base.checks import Floats
from asperity.base.readable import printed, readable, written
from asperity.base.words import counted
from asperity.lattice import Field
from asperity.solids import PARAMETERS_OF_LAWS

_P = ParamSpec("_P")
_R = TypeVar("_R")

COLUMN, PAGE = 85 / 25.4, 175 / 25.4
"""Widths of a figure in one column of a journal and across its page, inches."""

SMALL = 7.0
"""Size of the smallest letters, points."""

LOOK: Any = {
    **dict.fromkeys(("font.size", "axes.labelsize", "axes.titlesize", "figure.titlesize"), 8.0),
    **dict.fromkeys(("legend.fontsize", "xtick.labelsize", "ytick.labelsize"), SMALL),
    **dict.fromkeys(("axes.linewidth", "xtick.major.width", "ytick.major.width"), 0.6),
    **{"figure.labelsize": 8.0, "legend.handlelength": 1.6, "legend.borderpad": 0.3, "figure.dpi": 150.0},
}
"""Settings of matplotlib with which figures are drawn."""

_AS_TEXT: Any = {"pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "none"}

INK = "#000000"
BLUE = "#0072B2"
VERMILION = "#D55E00"
ORANGE = "#E69F00"
SKY = "#56B4E9"
PURPLE = "#CC79A7"
GRAY = "#8C8C8C"
HEIGHT_MAP = "cividis"
"""Height maps: luminance grows with height, readable with any color vision."""

PRESSURE_MAP = "viridis"
"""Maps of the contact pressure, on light gray where nothing touches."""

RESOLUTION = 300
"""Dots per inch of figures that are written as pixels, as journals ask for."""

PIXELS: dict[str, Any] = {"interpolation": "antialiased", "rasterized": True}
"""How ``imshow`` draws maps of which a pixel may hold many sites."""

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

_MARGIN = 12.0
"""Kept free beside a text that is as wide as its figure, points."""

_ENDS = {
    **{"curve": ("",), "points": ("",), "errors": ("", " low", " high")},
    **{"steps": (" up to the next",), "band": (" low", " high")},
}
"""How the names of columns end, by kinds of series in the order of a table."""


class RecordingAxes(Axes):
    """Axes that keep the numbers they are given to draw, for the table beside their figure."""

    def clear(self) -> None:
        """Begin anew."""
        super().clear()
        self.series: dict[str, list[tuple[str, Floats, dict[str, Floats]]]] = {kind: [] for kind in _ENDS}

    def plot(self, *args: Any, **kwargs: Any) -> Any:
        """Draw a curve."""
        self._keep("curve", kwargs, *(values for values in args if not isinstance(values, str)))
        return super().plot(*args, **kwargs)

    def errorbar(self, x: Any, y: Any, yerr: Any = None, *args: Any, **kwargs: Any) -> Any:
        """Draw points and their errors."""
        ends: Any = ()
        if yerr is not None:
            with suppress(TypeError, ValueError):
                ends = np.ma.asarray(y) + np.multiply([[-1], [1]], np.asarray(yerr, dtype=float))
        self._keep("errors" if len(ends) else "points", kwargs, x, y, *ends)
        return super().errorbar(x, y, yerr, *args, **kwargs)

    def stairs(self, values: Any, edges: Any = None, **kwargs: Any) -> Any:
        """Draw a value between each two edges."""
        self._keep("steps", kwargs, edges, np.append(values, np.nan))
        return super().stairs(values, edges, **kwargs)

    def fill_between(self, x: Any, y1: Any, y2: Any = 0, where: Any = None, *args: Any, **more: Any) -> Any:
        """Draw a band."""
        shown = np.ma.array(x, mask=where is not None and np.asarray(where) == 0)
        self._keep("band", more, shown, y1, y2)
        return super().fill_between(x, y1, y2, where, *args, **more)

    def _keep(self, kind: str, look: Mapping[str, Any], *numbers: Any) -> None:
        """Keep a series, of a kind of `_ENDS`, unless it only marks a place in the picture."""
        with suppress(TypeError, ValueError):  # dates, names, several curves at once: drawn without a column
            filled: Any = [np.ma.filled(np.ma.array(one, dtype=float), np.nan).ravel() for one in numbers]
            rows = np.array(np.broadcast_arrays(*filled))
            if kind == "band":  # where an end is unknown there is no band
                rows = rows[:, np.isfinite(rows).all(axis=0)]
            if rows.size and "transform" not in look:
                values = dict(zip(_ENDS[kind], rows[1:], strict=True))
                self.series[kind].append((str(look.get("label") or ""), rows[0], values))


class Drawing(Figure):
    """A figure in the letters that journals ask for, written at `RESOLUTION`.

    Text in PDF and SVG stays text, which can be searched and edited. Both leave out the title: what it says
    belongs into a caption, and stands in the table that `asperity.figures.write` writes beside the figure.
    """

    table: Mapping[str, object] | None = None
    """What is drawn, by columns "name [unit]", where that is not what its axes keep."""
    elsewhere = ""
    """Where the arrays are that it draws as maps."""

    def __init__(self, *, figsize: tuple[float, float]) -> None:
        super().__init__(figsize=figsize, layout="constrained")
        self._look: Any = {name: rcParams[name] for name in LOOK}

    def add_subplot(self, *args: object, **kwargs: object) -> Axes:
        """Add axes, as matplotlib does."""
        kind: Any = {} if kwargs.keys() & {"projection", "polar"} else {"axes_class": RecordingAxes}
        axes: Axes = super().add_subplot(*args, **kind | kwargs)
        return axes

    def savefig(
        self, fname: str | PathLike[str] | IO[bytes], *, transparent: bool | None = None, **kwargs: object
    ) -> None:
        """Write the figure, as matplotlib does."""
        suffix = str(kwargs.get("format") or getattr(fname, "name", fname)).rpartition(".")[2].lower()
        title: Any = self._suptitle if suffix in ("pdf", "svg", "eps") else None  # type: ignore[attr-defined]
        untitled = nullcontext() if title is None else title._cm_set(visible=False, in_layout=False)
        with untitled, rc_context(_AS_TEXT):
            super().savefig(fname, transparent=transparent, **{"dpi": RESOLUTION, **kwargs})

    def draw(self, renderer: RendererBase) -> None:
        """Draw the figure; letters of ticks that appear only now are as those that it began with."""
        with rc_context(self._look):
            super().draw(renderer)

    @property
    def room(self) -> float:
        """Widest text that fits, points."""
        return 72 * float(self.get_figwidth()) - 2 * _MARGIN


def drawn(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Let a function draw with `LOOK`, unless it draws into axes of the user, whose settings count there."""

    @functools.wraps(function)
    def within(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        new_figure = not any(isinstance(argument, Axes) for argument in (*args, *kwargs.values()))
        with rc_context(LOOK if new_figure else {}):
            return function(*args, **kwargs)

    return within


def fitted(text: str, width: float, size: float = 8) -> str:
    """Reduce a text from outside to what can be drawn: glyphs that the font has, and as many as fit.

    Width and font size are in points. Write the result with `verbatim`.
    """
    font = get_font(findfont(FontProperties()))
    letters = "".join(c if font.get_char_index(ord(c)) else "?" for c in " ".join(text.split()))
    if _width(letters, size) > width:
        while letters and _width(f"{letters}…", size) > width:
            letters = letters[:-1]
        letters = f"{letters.rstrip()}…"
    return letters


def lines(parts: list[str], width: float, size: float = 8, between: str = ", ") -> str:
    """Lay parts out, with commas between, on lines that fit; a part that is too long alone is cut."""
    laid: list[str] = []
    for part in parts:
        longer = f"{laid[-1]}{between}{part}" if laid else ""
        if longer and _width(longer, size) <= width:
            laid[-1] = longer
        else:
            laid.append(part)
    return "\n".join(verbatim(fitted(line, width, size)) for line in laid)


def stacked(size: tuple[float, float], *ratios: float) -> tuple[Drawing, list[Axes]]:
    """Make a figure, of this size in inches, with panels of these heights above a common axis."""
    figure = Drawing(figsize=size)
    grid = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios, squeeze=False)
    figure.align_ylabels(grid)
    return figure, list(grid[:, 0])


class Panel(NamedTuple):
    """One panel of a figure: its function, the label of its x axis, and its height."""

    draw: Callable[[Axes], object]
    along: str
    tall: float = 1.0


@functools.singledispatch
def panels_of(thing: object) -> dict[str, Panel]:
    """The panels of a result, by the kinds that `plot_kind` knows."""
    raise NotImplementedError(type(thing))


@drawn
def figure_of(panels: Iterable[Panel]) -> tuple[Drawing, list[Axes]]:
    """Make a figure of panels above a common axis, as wide as a column."""
    panels = list(panels)
    ratios = [panel.tall for panel in panels]
    figure, grid = stacked((COLUMN, 0.9 + 0.72 * sum(ratios)), *ratios)
    for axes, panel in zip(grid, panels, strict=True):
        panel.draw(axes)
        finish(axes)
    grid[-1].set_xlabel(panels[-1].along or grid[-1].get_xlabel())
    return figure, grid


def conditions(dataset: xr.Dataset, prescribed: str = "") -> list[str]:
    """Name the surface, the prescribed quantity, by default the load at first, and the solid."""
    attrs = dataset.attrs
    origin = json.loads(attrs.get("surface", "{}"))
    source = str(origin.get("file") or str(origin.get("kind", "")).replace("_", "-"))
    prescribed = prescribed or f"load {said(dataset, 'load', float(dataset['load'].values[0]))} at first"
    lattice = " × ".join(str(n) for n in dataset["heights"].shape)
    numbers = {
        "modulus": (f"{str(attrs.get('solid')).replace('_', '-')}, E* =", "Pa"),
        "thickness": ("thickness", "m"),
        **{name: (f"{name} =", "1") for name in ("k0", "k1", "R", "R_viscous")},
        **{name: (f"{law.symbol} =", law.unit) for name, law in PARAMETERS_OF_LAWS.items()},
        "permanent": ("permanent share", "1"),
        "hardness": ("hardness =", "Pa"),
    }
    of_solid = [
        f"{words} {written(attrs[name], (attrs.get('si') and unit) or '1')}"
        for name, (words, unit) in numbers.items()
        if name in attrs and (attrs[name] or name != "R_viscous")
    ]
    if count := len(json.loads(attrs.get("branches", "[]"))):
        of_solid.append(counted(count, "relaxation time"))
    return [*filter(None, [source]), f"{lattice} sites", prescribed, *of_solid]


def entitle(figure: Drawing, title: str, parts: list[str]) -> None:
    """Write a title above a figure, if there is one, and under it what must be said, on lines that fit."""
    figure.suptitle("\n".join(filter(None, [title, lines(parts, figure.room)])))


def finish(axes: Axes, *, legend: bool = True, lines_along: Literal["x", "y", "both"] = "both") -> None:
    """Draw the grid behind what is drawn, and explain the curves that have a name."""
    axes.grid(visible=True, axis=lines_along, color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
    for axis in (axes.xaxis, axes.yaxis):  # within a decade matplotlib labels minor ticks, which overlap
        low, high = axis.get_view_interval()
        if axis.get_scale() == "log" and 0 < low <= high <= 10 * low:
            few_ticks(axis)
    if legend and axes.get_legend_handles_labels()[1]:
        axes.legend(loc="best", framealpha=0.95)


def legend_below(figure: Drawing, axes: Axes, columns: int = 1) -> None:
    """Explain the curves of a panel below the figure, which becomes as much higher: they stay free."""
    handles, labels = axes.get_legend_handles_labels()
    if labels:
        figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False)
        rows = sum(1 + label.count("\n") for label in labels) / columns
        figure.set_figheight(figure.get_figheight() + 0.13 * math.ceil(rows))


def said(dataset: xr.Dataset, name: str, value: float, digits: int = 6) -> str:
    """Write a value of a series, with its unit where that is one of SI."""
    unit = dataset[name].attrs.get("units", "1") if name in dataset else "1"
    return spaced(written(value, unit, digits))


def spaced(text: str) -> str:
    """Write number and unit as they are printed: "2.5 × 10⁷ s", with spaces that do not break."""
    number, _, unit = text.partition(" ")
    mantissa, e, ten = number.partition("e")
    if e and unit:
        number = f"{mantissa}\u00a0×\u00a010{str(int(ten)).translate(_RAISED)}".removeprefix("1\u00a0×\u00a0")
    return f"{number}\u00a0{spelled(unit)}" if unit else number


def over_time(dataset: xr.Dataset, quantity: str) -> str:
    """Label an axis of times."""
    unit = dataset["time"].attrs.get("units", "")
    units = {"s": "  [s]", "time unit": ""}
    return quantity + units.get(unit, r"  [1 / (stiffness $\times$ mobility)]")


def few_ticks(axis: Axis) -> None:
    """Label a logarithmic axis with few plain numbers."""
    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 100 * low else (1.0,), numticks=7))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def bar_of_pressures(figure: Figure | SubFigure, image: ScalarMappable, panels: Any, label: str) -> None:
    """Explain the colors of pressures beside one panel or several."""
    bar = figure.colorbar(image, ax=panels, label=label, extend="min", shrink=0.9)
    few_ticks(bar.ax.yaxis)


def curve(
    axes: Axes, x: Field, y: Field, look: str, color: Any, label: str | None = "", **more: Any
) -> Line2D:
    """Draw computed values with open marks, joined or not; look and more are as matplotlib has them."""
    usual: Any = {"linewidth": 1.2, "markersize": 4, "markerfacecolor": "white"}
    return axes.plot(x, y, look, color=color, label=label or None, **usual | more)[0]


def band(axes: Axes, x: Field, low: Field, high: Field, color: Any = SKY, label: str = "95 % band") -> None:
    """Shade the band of a curve, where it is known."""
    if not np.isnan(low).all():
        axes.fill_between(x, low, high, color=color, alpha=0.35, linewidth=0, label=label)


def show_map(axes: Axes, field: Field, pixel: Sequence[float], unit: str, **look: Any) -> AxesImage:
    """Draw a map with axes in a unit, in which the sides of a pixel are given; look as of ``imshow``."""
    rows, columns = field.shape[:2]
    axes.set(xlabel=with_unit("x", unit), ylabel=with_unit("y", unit))
    return axes.imshow(field, extent=(0, columns * pixel[1], rows * pixel[0], 0), **{**PIXELS, **look})


def swatch(color: Any, label: str, size: float = 7) -> Line2D:
    """A square for a legend."""
    return Line2D([], [], ls="", marker="s", markersize=size, color=color, label=label)


def count_nominal_area(axes: Axes, percent: float) -> None:
    """Add a right axis in percent of the nominal area, and end both where all of it touches.

    One unit of the left axis, of the contact area, is so many percent.
    """
    to_percent, to_area = (lambda area: np.multiply(area, percent)), (lambda part: np.divide(part, percent))
    right = axes.secondary_yaxis("right", functions=(to_percent, to_area))
    right.set_ylabel("real contact [% of nominal area]")
    right.yaxis.set_major_formatter("{x:g}")
    if axes.get_ylim()[1] > 100.0 / percent:  # else the limits stay free for what the user adds
        axes.set_ylim(top=100.0 / percent)


def _width(text: str, size: float) -> float:
    """Width of a line, points."""
    return text_to_path.get_text_width_height_descent(text, FontProperties(size=size), False)[0]


def verbatim(text: str) -> str:
    """Write a text from outside, such as a file's name, so that nothing in it is read as mathematics."""
    return text.replace("$", r"\$")


def with_unit(quantity: str, unit: str) -> str:
    """Label an axis: quantity and unit, where it has one."""
    return quantity if unit == "1" else f"{quantity} [{spelled(unit)}]"


def scaled(quantity: str, unit: str, span: float) -> tuple[str, float]:
    """Label an axis on which a span is readable; and the factor to its unit."""
    shown, factor = readable(unit, span)
    return with_unit(quantity, shown), factor


def spelled(unit: str) -> str:
    """Spell a unit as it is printed; a power of ten stands for numbers that have none."""
    if re.fullmatch(r"1e[+-]\d+", unit):
        return rf"$10^{{{int(unit[2:])}}}$ units"
    names = {"angstrom": "Å", "rms": "rms height"}
    return names.get(unit, verbatim(printed(unit)))
