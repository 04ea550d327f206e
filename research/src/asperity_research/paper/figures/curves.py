"""What the curves of the reproduction share: ensembles with their intervals, and how these are drawn."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import product
from typing import Any, Literal, NamedTuple, Self

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from asperity.fits import jackknife
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import columns

LABEL = 8.0  # Font size of the labels of axes, points at final size
SMALL = 7.0  # Font size of everything else
_LIGHTEST = 0.82  # Where the color map is cut: beyond it, yellow vanishes on white
_NEAR_ZERO = 1e-6
"""Lower ends of error bars, relative to the value, where the interval includes 0 and the axis cannot."""

_MARKERS = "osD^vPX*"
_DASHES = ((6, 1.5), (4, 1.5, 1, 1.5), (3, 1), (1.5, 1))


class Look(NamedTuple):
    """Color, as ``#rrggbb``, and marker of one curve, full or open; each tells it from its neighbors."""

    color: str
    marker: str = "o"
    filled: bool = True

    @property
    def face(self) -> str:
        """The color of the marker's face."""
        return self.color if self.filled else "none"

    def open(self) -> Self:
        """Return the same, open."""
        return self._replace(filled=False)


def looks(values: Iterable[float]) -> dict[float, Look]:
    """Return a look for each of some values in order: dark to light, so that gray print keeps the order."""
    distinct = list(values)
    shades = np.linspace(0, _LIGHTEST, len(distinct))
    return {
        value: Look(to_hex(colormaps["viridis"](shade)), _MARKERS[at % len(_MARKERS)])
        for at, (value, shade) in enumerate(zip(distinct, shades, strict=True))
    }


def mean(samples: Field) -> Field:
    """Mean over the runs."""
    return np.asarray(samples.mean(axis=0))


def growth(areas: Field) -> Field:
    """A(t)/A(0) of the means over the runs, shape (runs, times); steadier than the mean of the ratios."""
    return np.asarray(areas.mean(axis=0) / areas[:, 0].mean())


def over_seeds(
    evidence: Evidence, study: str, name: str, called: str, statistic: Callable[[Field], Field] = mean
) -> pd.DataFrame:
    """Estimate a statistic of the surfaces for every value of the swept parameters of a study.

    The statistic, as in `asperity.fits.jackknife`, keeps the time, where there is one. The table has a row
    for each value of the swept parameters, and time: these, the statistic as it is called, the ends ``_low``
    and ``_high`` of its 95 % interval, and ``seeds``.
    """
    values = evidence[study][name]
    swept = [str(dim) for dim in values.dims if dim not in ("seed", "time")]
    times = {"time": values["time"].to_numpy()} if "time" in values.dims else {}
    frames = []
    for place in product(*(values[dim].to_numpy() for dim in swept)):
        point = dict(zip(swept, place, strict=True))
        estimate = jackknife(statistic, evidence.samples(study, name, **point))
        numbers = {key: np.atleast_1d(column) for key, column in columns(called, estimate).items()}
        frames.append(pd.DataFrame({**point, **times, **numbers, "seeds": estimate.runs}))
    return pd.concat(frames, ignore_index=True)


def parts(table: pd.DataFrame, by: str | list[str]) -> Iterable[tuple[Any, pd.DataFrame]]:
    """Return the parts of a table, each with the value of a column, or the values of several, that it has."""
    return table.groupby(by)


def points(
    axes: Axes, table: pd.DataFrame, x: str, y: str, look: Look, label: str | None = None, size: float = 3.5
) -> None:
    """Draw the columns x and y of a table, and ``_low`` and ``_high`` of y, as symbols with error bars."""
    value, low, high = (table[f"{y}{end}"].to_numpy(np.float64) for end in ("", "_low", "_high"))
    axes.errorbar(
        table[x].to_numpy(np.float64),
        value,
        yerr=np.stack([np.minimum(value - low, value * (1 - _NEAR_ZERO)), high - value]),
        fmt=look.marker,
        color=look.color,
        markersize=size,
        markerfacecolor=look.face,
        markeredgewidth=0.8,
        elinewidth=0.8,
        label=label,
    )


def band(axes: Axes, table: pd.DataFrame, x: str, y: str, look: Look, label: str | None = None) -> None:
    """Draw a curve as a band, its interval, with some symbols, about two for each decade of x, above 0."""
    place, value, low, high = (table[name].to_numpy(np.float64) for name in (x, y, f"{y}_low", f"{y}_high"))
    axes.fill_between(place, low, high, color=look.color, alpha=0.25, linewidth=0)
    every = max(1, round(place.size / (1 + 2 * np.log10(place[-1] / place[0]))))
    symbols(axes, place, value, look, markerfacecolor=look.face, markevery=every, label=label)


def line(axes: Axes, x: ArrayLike, y: ArrayLike, look: Look, at: int, label: str) -> None:
    """Draw the line number `at` of a family: besides color, dashes tell them apart."""
    dashes = (0, _DASHES[at % 5 - 1]) if at % 5 else "-"
    axes.plot(x, y, color=look.color, linestyle=dashes, linewidth=1.3, label=label)


def dotted(axes: Axes, x: ArrayLike, y: ArrayLike, label: str | None = None) -> None:
    """Draw what is there for comparison."""
    axes.plot(x, y, ":", color=style.INK, linewidth=1.2, label=label)


def symbols(axes: Axes, x: ArrayLike, y: ArrayLike, look: Look, **more: Any) -> Line2D:
    """Draw points without error bars: white, if no more is said, so that a line is seen around them."""
    shown: dict[str, Any] = {"markerfacecolor": "white", "markersize": 3, "markeredgewidth": 0.7, **more}
    [drawn] = axes.plot(x, y, look.marker, color=look.color, **shown)
    return drawn


def mark(marker: str, face: str, edge: str, label: str, size: float = 5) -> Line2D:
    """Return a mark for a legend."""
    look: dict[str, Any] = {"color": face, "markeredgecolor": edge, "markersize": size}
    return Line2D([], [], ls="", marker=marker, label=label, **look)


def dress(axes: Axes, x: str, y: str, *, panel: str = "") -> None:
    """Label the axes, in fonts that are legible in print; name the panel, if there are several."""
    axes.set_xlabel(x, fontsize=LABEL)
    axes.set_ylabel(y, fontsize=LABEL)
    axes.tick_params(which="both", direction="in", labelsize=SMALL, top=True, right=True)
    if panel:
        axes.set_title(panel, loc="left", fontsize=LABEL, fontweight="bold", pad=3)


def legend(
    axes: Axes,
    where: Literal["upper left", "lower right"],
    title: str | None = None,
    *,
    together: Mapping[str, Sequence[Line2D]] | None = None,
) -> None:
    """Add a legend of what is labeled in a panel.

    Below the others stand symbols that go `together`, side by side for one label.
    """
    handles, labels = axes.get_legend_handles_labels()
    several = {label: tuple(symbols) for label, symbols in (together or {}).items()}
    axes.legend(
        [*handles, *several.values()],
        [*labels, *several],
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.4)},
        loc=where,
        title=title,
        fontsize=SMALL,
        title_fontsize=SMALL,
        frameon=False,
        handletextpad=0.4,
        labelspacing=0.25,
        borderpad=0.2,
    )


def note(
    axes: Axes, text: str, at: tuple[float, float], *, where: Literal["left", "right", "center"] = "left"
) -> None:
    """Write a few words that begin, end or are centered (`where`) at a point in the units of the axes."""
    axes.annotate(text, at, ha=where, va="center", fontsize=SMALL, color=style.INK)
