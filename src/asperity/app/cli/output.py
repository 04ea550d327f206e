"""Figures that commands write beside what they say."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from asperity.base.calls import showing
from asperity.base.files import Standing
from asperity.figures import Drawing
from asperity.figures.writing import write_figure as write_figure


def write_figures(draw: Callable[[], Drawing], files: Mapping[Path, Standing]) -> list[str]:
    """Write a figure under the names of `check_figures`; return a line that lists them, if any."""
    written = []
    if files:
        *pictures, table = map(str, files)
        with showing(f"the figure {pictures[0]}"):
            figure = draw()
            for path, before in files.items():
                write_figure(figure, path, overwrite=before)
            written.append(f"figure written: {', '.join(pictures)}; its data: {table}")
    return written
