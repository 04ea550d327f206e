"""The command ``asperity surface``: describes a surface file, and draws it."""

from __future__ import annotations

import sys
from pathlib import Path

from asperity.app.cli.command import command
from asperity.app.cli.flags import Flags, Out, Switch, given
from asperity.app.cli.new_files import check_figures
from asperity.app.cli.options import DRAWN, Drawn


@command("preparation")
def surface(
    file: Path,
    /,
    *,
    out: Out | None = None,
    overwrite: Switch = False,
    drawn: Drawn = DRAWN,
    keys: Flags | None = None,
) -> None:
    """Describe a surface file as a run would use it, and draw it.

    Parameters
    ----------
    file
        A surface file of an instrument, a .npy array, or a text matrix; or a TOML file as for asperity run,
        of which the surface is made.
    out
        Figure to write (.png, .pdf or .svg). [default: the name of the file with .png, in the current folder]
    overwrite
        Replace the figure if it exists.
    """
    from asperity.app.config.reading import file_surface, read_config

    flags = given(keys)
    of_run = file.suffix.lower() == ".toml"
    settings = read_config(file, flags).surface if of_run else file_surface(file, flags.get("surface", {}))
    target = Path(f"{file.stem or 'surface'}.png") if out is None else out
    figures = check_figures("--out", target, drawn, overwrite=overwrite, source=file)
    from asperity.app.cli.output import write_figures  # takes a second: mistakes are reported before
    from asperity.app.cli.reports.surface import drawn_and_described

    draw, rows = drawn_and_described(settings)
    sys.stdout.write("\n\n".join([rows, *write_figures(draw, figures)]) + "\n")
