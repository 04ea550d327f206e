"""The command ``asperity sliding``: friction and contact area against speed."""

from __future__ import annotations

from pathlib import Path

from asperity.app.cli.asking import answer_into
from asperity.app.cli.command import command
from asperity.app.cli.flags import Flags, Folder, file_of_run, given
from asperity.app.cli.options import DRAWN, RESULTS, Drawn, Results


@command("sliding", "preparation", "solid", "contact", "friction")
def sliding(
    material: Path | None = None,
    /,
    *,
    surface: Path | None = None,
    out: Folder = Path("sliding"),
    results: Results = RESULTS,
    drawn: Drawn = DRAWN,
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
    from asperity.app.config.mistakes import Door

    flags = given(keys, surface=surface, figures=drawn.figures, units=True)
    answer_into(out, Door(flags, file_of_run(material, flags)), results, "sliding")
