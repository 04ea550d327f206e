"""The command ``asperity run``: configuration in, a folder of results out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from asperity.app.cli.asking import answer_into
from asperity.app.cli.command import command
from asperity.app.cli.flags import Flags, Folder, given
from asperity.app.cli.options import RESULTS, Results


@command("surface", "preparation", "solid", "contact", "aging", "protocol", "friction", "carried", "output")
def run(
    config: Path | None = None,
    /,
    *,
    out: Folder = Path("asperity-out"),
    results: Results = RESULTS,
    leg: Annotated[list[str] | None, Parameter(negative=(), show_default=False)] = None,
    keys: Flags | None = None,
) -> None:
    """Press an elastic solid onto a rough surface and let the contact age.

    Without arguments: a Gaussian surface of 200 x 200 sites, k1/k0 = 3, nine decades of hold time.
    Flags override the configuration file, whose sections are the groups below. On a half-space or a layer,
    numbers may have units if the surface has some: --modulus 3.8GPa --pressure "1 MPa".

    Parameters
    ----------
    config
        TOML file of the configuration; a run writes the complete one to its results, as config.toml.
    leg
        A leg of the history of the load or the separation, once for each leg: "hold 10",
        "ramp 5 load=400", "step load=160", "hold 100 hold=area", "slide distance=20 velocity=0.1",
        "repeat 3" (all legs before it), "repeat 3 last 2" (two of them).
        [default: one hold]
    """
    from asperity.app.config.mistakes import Door

    answer_into(out, Door(given(keys, leg=leg), config), results)
