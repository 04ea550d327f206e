"""The command ``asperity predict``: from a material, a scan and a load to a page to read."""

from __future__ import annotations

import functools
import shlex
import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from asperity.app.cli.command import command
from asperity.app.cli.flags import Flags, Folder, Switch, flags_for, given
from asperity.app.cli.new_files import check_free
from asperity.app.cli.options import Results

__all__ = ["flags_for", "predict"]  # the annotation that `command` writes names flags_for

_CHECKPOINT_EVERY = 3.0


_RESULTS = Results()


@command("prediction")
def predict(
    material: Path | None = None,
    /,
    *,
    surface: Path | None = None,
    ramp: Annotated[str | None, Parameter(metavar="QUANTITY")] = None,
    leg: Annotated[list[str] | None, Parameter(negative=(), show_default=False)] = None,
    resolution_study: Switch = False,
    out: Folder = Path("prediction"),
    results: Results = _RESULTS,
    keys: Flags | None = None,
) -> None:
    """Predict how the real contact ages, from a material, a scan and a load, with 95 % bands.

    Quantities are numbers with their units: --pressure 1MPa --last "10 days" --temperature -40degC.

    The result is a folder: prediction.html (read it first), tables and pictures. The edges of the scan are
    reflecting unless --periodic or --edges says otherwise. Slides and a constant separation have no band; for
    these take asperity run.

    Parameters
    ----------
    material
        Table of relaxation modulus or creep compliance against time, or of storage and loss modulus against
        frequency; the names of its columns have the units: time_s, E_MPa. Or a TOML file as for asperity
        run, which flags override. Without one, --young and --branch or --creep describe a half-space.
    surface
        The scan: a surface file of an instrument, a .npy array, or a text matrix, with units.
    ramp
        Time over which the load rises linearly, such as 2.4s; all times count from its start. [default:
        instantly]
    leg
        In place of --ramp a leg of the history of the load, once for each leg: "ramp 2.4s pressure=1MPa",
        "hold 1000s", "step pressure=250kPa", "repeat 3" (the legs before it). A first ramp begins at
        --pressure or --load, by default 0.
    resolution_study
        Predict also without the shortest waves of the scan, to see what a finer scan would change.
    """
    flags = given(keys, surface=surface, leg=leg, units=True)
    replaceable = check_free(out, overwrite=results.overwrite)
    from asperity.app.cli.prediction_flags import prediction_asked

    asked, compute, output = prediction_asked(material, flags, ramp)
    from asperity.app.cli.computing import compute_into  # takes a second: mistakes are reported before
    from asperity.app.predict.folder import write_files
    from asperity.app.predict.words import report

    compute_into(
        "prediction",
        out,
        f"{asked}{resolution_study}",
        functools.partial(compute, resolution_study=resolution_study),
        report=report,
        write=functools.partial(write_files, output=output, command=shlex.join(["asperity", *sys.argv[1:]])),
        every=_CHECKPOINT_EVERY,
        results=results,
        replaceable=replaceable,
    )
