"""The command ``asperity sliding``: friction and contact area against speed."""

from __future__ import annotations

from pathlib import Path

from asperity.app.cli.command import command
from asperity.app.cli.flags import Flags, Folder, file_of_run, flags_for, given
from asperity.app.cli.new_files import check_free
from asperity.app.cli.options import Drawn, Results

__all__ = ["flags_for", "sliding"]  # the annotation that `command` writes names flags_for

_DRAWN, _RESULTS = Drawn(), Results()


@command("sliding", "preparation", "solid", "contact", "friction")
def sliding(
    material: Path | None = None,
    /,
    *,
    surface: Path | None = None,
    out: Folder = Path("sliding"),
    results: Results = _RESULTS,
    drawn: Drawn = _DRAWN,
    keys: Flags | None = None,
) -> None:
    """Find friction and contact area of a scan that slides over a viscoelastic solid, against speed.

    Each speed is one contact problem, with the complex modulus at the frequency of each wave of the scan.
    Heat is left out.

    Parameters
    ----------
    material
        Relaxation table, such as storage and loss modulus against frequency, or a TOML file as for asperity
        run, which flags override. Without one, flags describe the solid, by default a half-space.
    surface
        The scan: a surface file of an instrument, a .npy array, or a text matrix, with units.
    """
    flags = given(keys, surface=surface, units=True)
    file = file_of_run(material, flags)
    if drawn.figures is not None:
        flags["output"] = {"figures": drawn.figures}
    from asperity.app.config.mistakes import Door
    from asperity.app.config.reading import config_at

    door = Door(flags, file)
    settings = config_at(door, question="sliding")
    replaceable = check_free(out, overwrite=results.overwrite)
    from asperity.app.cli.computing import answer_into  # takes a second: mistakes are reported before

    answer_into(out, door, settings, results, replaceable)
