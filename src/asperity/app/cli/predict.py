"""The command ``asperity predict``: from a material, a scan and a load to a page to read."""

from __future__ import annotations

import functools
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from cyclopts import Parameter

from asperity.app.cli.command import command
from asperity.app.cli.flags import (
    Flags,
    Folder,
    Switch,
    check_unit,
    file_of_run,
    flag,
    flags_for,
    given,
    in_flags,
)
from asperity.app.cli.new_files import check_free
from asperity.app.cli.options import Results
from asperity.base.words import number
from asperity.errors import InputError, printable

if TYPE_CHECKING:
    from asperity.app.config import RunConfig

__all__ = ["flags_for", "predict"]  # the annotation that `command` writes names flags_for

_CHECKPOINT_EVERY = 3.0
_ARGUMENTS = ("surface", "ramp", "load", "pressure", "first", "last", "per_decade", "extrapolate", "hardness")
"""Arguments of the library that are flags of the same name."""


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
        "hold 1000s", "step pressure=250kPa", "repeat 3" (all legs before it), "repeat 3 last 2" (two of
        them). A first ramp begins at --pressure or --load, by default 0.
    resolution_study
        Predict also without the shortest waves of the scan, to see what a finer scan would change.
    """
    flags = given(keys, surface=surface, leg=leg, units=True)
    if ramp is not None:
        check_unit("--ramp", number(ramp), "s")
    replaceable = check_free(out, overwrite=results.overwrite)
    settings = _settings(material, flags)
    from asperity.app.cli.computing import compute_into  # takes a second: mistakes are reported before
    from asperity.app.config.mistakes import flag_of
    from asperity.app.predict import predict_config
    from asperity.app.predict.folder import write_files
    from asperity.app.predict.words import report
    from asperity.base.units import quantity

    loading = None if ramp is None else quantity(ramp, "s", "--ramp")
    named = {f"[{section}] {key}": flag_of(section, key) for section, keys in flags.items() for key in keys}
    named |= {name: flag(name) for name in _ARGUMENTS} | ({"protocol": "--leg"} if leg else {})
    typed = printable(shlex.join(["asperity", *sys.argv[1:]]))
    with in_flags(named):
        compute_into(
            "prediction",
            out,
            f"{settings!r}{loading}{resolution_study}",
            functools.partial(predict_config, settings, ramp=loading, resolution_study=resolution_study),
            report=report,
            write=functools.partial(write_files, output=settings.output, command=typed),
            every=_CHECKPOINT_EVERY,
            results=results,
            replaceable=replaceable,
        )


def _settings(material: Path | None, flags: dict[str, dict[str, object]]) -> RunConfig:
    """The configuration: that of a file of a run, or of a table, or of flags alone."""
    from asperity.app.config.reading import read_config

    if material is None or material.suffix != ".toml":
        contact, legs = flags.get("contact", {}), cast(list[Any], flags.get("protocol", {}).get("legs", []))
        if len(contact) != 1 and (contact or not legs or legs[0]["kind"] != "ramp"):
            got = "both" if contact else "neither"
            raise InputError("--pressure", expected="a pressure or a load", got=got, advice="--pressure 1MPa")
        if material is None and "young" not in flags.get("solid", {}):
            expected = "a relaxation table, a TOML file, or --young"
            raise InputError("material", expected=expected, got="none", advice="asperity predict --help")
    file = file_of_run(material, flags)
    return read_config(file, flags, names={("solid", "relaxation"): "material"}, lacks={"adhesion"})
