"""The command ``asperity law``: a table of a rough contact for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from asperity.app.cli.asking import answer_into
from asperity.app.cli.command import command
from asperity.app.cli.flags import (
    Flags,
    Folder,
    Switch,
    check_unit,
    file_of_run,
    given,
)
from asperity.app.cli.options import DRAWN, RESULTS, Drawn, Results
from asperity.base.words import number
from asperity.errors import InputError

if TYPE_CHECKING:
    from asperity.app.config import RunConfig


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
    results: Results = RESULTS,
    drawn: Drawn = DRAWN,
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
    flags = given(keys, surface=surface, figures=drawn.figures, units=True)
    if age is not None:
        check_unit("--age", number(age), "s")
    from asperity.app.config.mistakes import Door

    door = Door(flags, file_of_run(material, flags))

    def check(config: RunConfig) -> None:
        if write:
            from asperity.contact_law.programs import place_of

            place_of(age, config.aging.times or [0.0])
        elif asked := [name for name, value in (("age", age), ("millimeters", millimeters)) if value]:
            expected = "--write beside it: it is for files of other programs"
            raise InputError(f"--{asked[0]}", expected=expected, got="none", advice="--write calculix")

    of_programs = {"programs": write, "age": age, "millimeters": millimeters}
    answer_into(out, door, results, "law", check, **of_programs)
