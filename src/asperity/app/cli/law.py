"""The command ``asperity law``: a table of a rough contact for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

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
)
from asperity.app.cli.new_files import check_free
from asperity.app.cli.options import Drawn, Results
from asperity.base.words import number
from asperity.errors import InputError

__all__ = ["flags_for", "law"]  # the annotation that `command` writes names flags_for

_DRAWN, _RESULTS = Drawn(), Results()


@command("law", "preparation", "solid", "carried")
def law(
    material: Path | None = None,
    /,
    *,
    surface: Path | None = None,
    write: Annotated[
        list[Literal["calculix", "moose"]], Parameter(negative=(), consume_multiple=True, show_default=False)
    ] = [],  # noqa: B006
    age: Annotated[str | None, Parameter(metavar="QUANTITY")] = None,
    millimeters: Switch = False,
    out: Folder = Path("law"),
    results: Results = _RESULTS,
    drawn: Drawn = _DRAWN,
    keys: Flags | None = None,
) -> None:
    """Tabulate approach, stiffness and conductance of a contact against pressure, for other programs.

    The approach is that of the rough layer alone. Each pressure is applied instantly and held for each age.
    Do not interpolate between ages while the load changes: creep depends on the history of the load.

    Parameters
    ----------
    material
        Relaxation table, or a TOML file as for asperity run, which flags override. Without one, flags
        describe the solid, by default a half-space.
    surface
        The scan: a surface file of an instrument, a .npy array, or a text matrix, with units.
    write
        Programs for which to write a file.
    age
        Age of the law in these files; required if there are several.
    millimeters
        Write these files in N, mm, s, MPa in place of SI.
    """
    flags = given(keys, surface=surface, units=True)
    if age is not None:
        check_unit("--age", number(age), "s")
    file = file_of_run(material, flags)
    if drawn.figures is not None:
        flags["output"] = {"figures": drawn.figures}
    from asperity.app.config.mistakes import Door
    from asperity.app.config.reading import config_at

    door = Door(flags, file)
    settings = config_at(door, question="law")
    if write:
        from asperity.contact_law.programs import place_of

        place_of(age, settings.aging.times or [0.0])
    elif asked := [name for name, value in (("age", age), ("millimeters", millimeters)) if value]:
        expected = "--write beside it: it is for files of other programs"
        raise InputError(flag(asked[0]), expected=expected, got="none", advice="--write calculix")
    replaceable = check_free(out, overwrite=results.overwrite)
    from asperity.app.cli.computing import answer_into  # takes a second: mistakes are reported before

    of_programs = {"programs": write, "age": age, "millimeters": millimeters}
    answer_into(out, door, settings, results, replaceable, **of_programs)
