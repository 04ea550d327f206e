"""The command ``asperity predict``: from a material, a scan and a load to a page to read."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated, Any, cast

from cyclopts import Parameter

from asperity.app.cli.asking import answer_into
from asperity.app.cli.command import command
from asperity.app.cli.flags import Flags, Folder, file_of_run, given
from asperity.app.cli.options import RESULTS, Results
from asperity.errors import InputError, printable


@command("prediction", "protocol")
def predict(
    material: Path | None = None,
    /,
    *,
    surface: Path | None = None,
    leg: Annotated[list[str] | None, Parameter(negative=(), show_default=False)] = None,
    out: Folder = Path("prediction"),
    results: Results = RESULTS,
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
    leg
        In place of --ramp a leg of the history of the load, once for each leg: "ramp 2.4s pressure=1MPa",
        "hold 1000s", "step pressure=250kPa", "repeat 3" (all legs before it), "repeat 3 last 2" (two of
        them). A first ramp begins at --pressure or --load, by default 0.
    """
    from asperity.app.config.mistakes import Door

    flags = given(keys, surface=surface, leg=leg, units=True)
    if material is None or material.suffix != ".toml":
        contact, protocol = flags.get("contact", {}), flags.get("protocol", {})
        legs = cast(list[Any], protocol.get("legs", []))
        begins = "file" in protocol or bool(legs and legs[0]["kind"] == "ramp")
        if (contact or not begins) and len(contact) != 1:
            got, advice = ("both", "one of them") if contact else ("neither", "--pressure 1MPa")
            raise InputError("--pressure", expected="a pressure or a load", got=got, advice=advice)
        if material is None and "young" not in flags.get("solid", {}):
            expected = "a relaxation table, a TOML file, or --young"
            raise InputError("material", expected=expected, got="none", advice="asperity predict --help")
    # A band covers no adhesion: it is no cure here.
    door = Door(flags, file_of_run(material, flags), {("solid", "relaxation"): "material"}, {"adhesion"})
    typed = printable(shlex.join(["asperity", *sys.argv[1:]]))
    answer_into(out, door, results, "prediction", command=typed)
