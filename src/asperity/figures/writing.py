"""Figures as files: in the formats that are asked for, each with a table of what it draws beside it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain, zip_longest
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from asperity.base import checks
from asperity.base.calls import showing
from asperity.base.files import FORMATS, OF_FIGURES, Format, Standing, expanded, table_beside
from asperity.base.words import PLAIN
from asperity.errors import InputError
from asperity.figures.style import Drawing
from asperity.results.store import whole_file

_PLAIN = {
    **{r"\mu": "mu", r"\theta": "theta", r"\infty": "infinity", r"\to": "to", r"\times": "x", "#": "no."},
    **PLAIN,
}
_MATHEMATICS = re.compile(r"\\[,; ]|[${}\\]")


def write(figure: Figure, path: Path | str, formats: Iterable[Format] | None = None) -> list[Path]:
    """Write a figure in one format or several, and what it draws as a table beside it.

    Parameters
    ----------
    figure
        Of this package; one of your own is drawn into the axes of a `Drawing`.
    path
        Its name; without formats, its suffix is the one.
    formats
        ``"png"``, with 300 dots per inch; ``"pdf"`` and ``"svg"``, whose text stays text and which have no
        title. Nothing is written where the list is empty.

    Returns
    -------
    list of Path
        The files, the table last: of the same name, or with "_data" behind it where that is another table.

    Raises
    ------
    InputError
        There is no such format; or the figure is not a `Drawing`, which alone keeps its numbers.
    """
    advice = "axes of asperity.figures.Drawing(figsize=(3.3, 2.6)).subplots(), or figure.savefig"
    drawing = checks.instance("figure", figure, Drawing, advice)
    path = expanded(path)
    given = path.suffix.removeprefix(".") if formats is None else formats
    suffixes = [given] if isinstance(given, str) else list(given)
    for suffix in suffixes:
        if suffix not in FORMATS:
            raise InputError("formats", expected=f"some of {', '.join(FORMATS)}", got=suffix or "none")
    files = [path.with_name(f"{path.stem}.{suffix}") for suffix in suffixes]
    files += [table_beside(path)] * bool(files)
    for file in files:
        write_figure(drawing, file)
    return files


def write_each(
    draws: Mapping[str, Callable[[], Drawing]], folder: Path, formats: Sequence[Format] | None
) -> None:
    """Draw figures, and write them under their names; one that fails is left out with a remark."""
    for name, draw in draws.items() if formats else ():
        with showing(f"the figure {name!r}"):
            write(draw(), folder / name, formats)


def write_figure(figure: Drawing, path: Path, *, overwrite: bool | Standing = True) -> None:
    """Write a figure that is complete under its name or not there; `OutputError` if the disk refused.

    With the suffix .csv it is the table of what the figure draws.
    """
    with whole_file(path, overwrite=overwrite) as part:
        if part.suffix == ".csv":
            part.write_text(table_of(figure), encoding="utf-8")
        else:
            figure.savefig(part)


def table_of(figure: Drawing) -> str:
    """What a figure draws, as a table in text, which `asperity` reads: the title as a comment, and columns.

    Each curve has a column, after one of its places along the axis unless the curve before has the same.
    """
    about = figure.get_suptitle().splitlines() + [f"The maps: {figure.elsewhere}."] * bool(figure.elsewhere)
    columns: Mapping[str, Any] = figure.table or dict(_unlike(_columns(figure)))
    cells = ([f"{value:.12g}" for value in np.ravel(values).astype(float)] for values in columns.values())
    rows = [",".join(row) for row in zip_longest(*cells, fillvalue="")]
    names = ",".join(f'"{plain(name)}"' for name in columns)
    return "\n".join([OF_FIGURES, *(f"# {plain(line)}" for line in about), names, *rows, ""])


def plain(text: str) -> str:
    """A label of a figure without mathematics and without letters that a header cannot have."""
    for letter, word in _PLAIN.items():
        text = text.replace(letter, word)
    return " ".join(_MATHEMATICS.sub("", text).replace('"', "'").split())


def _unlike(columns: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, Any]]:
    """Number columns of one name."""
    seen: dict[str, int] = {}
    for name, values in columns:
        seen[name] = seen.get(name, 0) + 1
        quantity, bracket, unit = name.partition(" [")
        yield (name if seen[name] == 1 else f"{quantity} ({seen[name]}){bracket}{unit}"), values


def _columns(figure: Drawing) -> Iterator[tuple[str, Any]]:
    place: tuple[str, Any] = ("", ())
    for axes in figure.axes:
        shared = axes.get_shared_x_axes().get_siblings(axes)[::-1]
        title = axes.get_title().partition("\n")[0]
        across = next(filter(None, [*(each.get_xlabel() for each in (axes, *shared)), title, "x"]))
        along = axes.get_ylabel() or figure.get_supylabel() or title or "y"
        panel = title if along == figure.get_supylabel() else ""
        for label, x, series in chain(*getattr(axes, "series", {}).values()):
            if (across, tuple(x)) != place:
                place = across, tuple(x)
                yield place
            told = ", ".join(filter(None, (panel, label.removeprefix("_").partition("\n")[0])))
            named = f"{told}: " if told else ""
            for ending, values in series.items():
                quantity, bracket, unit = along.partition(" [")
                yield f"{named}{quantity}{ending}{bracket}{unit}", values
