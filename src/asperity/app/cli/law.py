"""The command ``asperity law``: a table of a rough contact for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from asperity.app.cli.command import command
from asperity.app.cli.flags import Flags, Out, Switch, Whole, check_unit, flags_for, given, in_flags
from asperity.app.cli.new_files import check_free
from asperity.app.cli.options import Results
from asperity.errors import InputError

__all__ = ["flags_for", "law"]  # the annotation that `command` writes names flags_for

_RESULTS = Results()
_Quantities = Annotated[list[str] | None, Parameter(negative=(), consume_multiple=True, metavar="QUANTITY")]
_Programs = Annotated[
    list[Literal["calculix", "moose"]] | None, Parameter(negative=(), consume_multiple=True)
]
_FLAGS = {name: f"--{name}" for name in ("pressures", "times", "age", "surface")}


@command("preparation", "solid", "carried")
def law(
    material: Path | None = None,
    /,
    *,
    surface: Path | None = None,
    pressures: _Quantities = None,
    per_decade: Whole = 10,
    times: _Quantities = None,
    write: _Programs = None,
    age: Annotated[str | None, Parameter(metavar="QUANTITY")] = None,
    millimeters: Switch = False,
    out: Out = Path("law"),
    results: Results = _RESULTS,
    keys: Flags | None = None,
) -> None:
    """Tabulate approach, stiffness and conductance of a rough contact against pressure, for other programs.

    The approach is that of the rough layer alone. Each pressure is put on at once, and held for each age. Do
    not interpolate between ages while the load changes: what has crept depends on the whole history.

    Parameters
    ----------
    material
        Relaxation table, or a TOML file as for asperity run, which flags override. Without: a half-space of
        --young, or what --solid says.
    surface
        The scan: a surface file of an instrument, a .npy array, or a text matrix, with units.
    pressures
        Load over nominal area: two are the ends of a range, such as 0.1MPa 100MPa, more are taken one by one.
    per_decade
        Pressures in each decade of a range.
    times
        Ages, such as 0s 1h "1 year". [default: 0s, where nothing creeps]
    write
        Programs for which to write a file: calculix, moose.
    age
        The age of the law in these files; needed where there are several.
    millimeters
        Write these files in N, mm, s, MPa in place of SI.
    out
        Folder for the results, which appears when all is written; it must not exist yet.
    """
    from asperity.app.config.reading import read_config, to_toml

    flags = given(keys, units=True)
    for name, several in (("--pressures", pressures), ("--times", times), ("--age", [age] if age else None)):
        check_unit(name, several or [], "s" if name != "--pressures" else "MPa")
    if pressures is None:
        advice = "--pressures 0.1MPa 100MPa"
        raise InputError("--pressures", expected="two pressures or more", got="none", advice=advice)
    if surface is not None:
        flags["surface"] = {**flags.get("surface", {}), "path": str(surface)}
    solid = flags.setdefault("solid", {})
    path = material if material is not None and material.suffix == ".toml" else None
    if path is None:
        if surface is None:
            raise InputError(
                "--surface", expected="the file of a scan", got="none", advice="--surface scan.opd"
            )
        solid |= {"kind": "half_space"} if "kind" not in solid else {}
        solid |= {} if material is None else {"relaxation": str(material)}
    if times is not None:
        flags["aging"] = {"times": [one if one.strip() != "0" else 0.0 for one in times]}
    config = read_config(path, flags)
    if write and age is None and len(config.aging.times or []) > 1:
        expected, advice = (
            "the age of the law in these files, for it has several",
            f'--age "{times[-1] if times else "1h"}"',
        )
        raise InputError("--age", expected=expected, got="none", advice=advice)
    replaceable = check_free(out, overwrite=results.overwrite)
    from asperity.app.cli.computing import folder_of_results, place_beside, tell_results
    from asperity.app.cli.reports.law import law_report, write_law
    from asperity.app.runs.law import law_of_config
    from asperity.progress import listener
    from asperity.results import Checkpoint

    asked = f"{to_toml(config)}{pressures}{per_decade}"
    with place_beside(out, asked) as place, listener(not results.quiet) as progress, in_flags(_FLAGS):
        how = {"pressures": pressures, "per_decade": per_decade, "checkpoint": Checkpoint(place)}
        dataset, used, remarks = law_of_config(config, progress, **how)  # type: ignore[arg-type]
        rows = law_report(dataset, remarks)
        progress.stage("writing the results")
        with folder_of_results("law", out, rows, replaceable) as folder:
            write_law(dataset, used, folder, programs=write or (), age=age, millimeters=millimeters)
    tell_results(rows, out, results)
