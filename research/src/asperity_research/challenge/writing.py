"""The input files of the reference problems, which anybody's code can read."""

import textwrap
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import tomli_w

from asperity.errors import InputError
from asperity.results import whole_folder
from asperity.surfaces import Surface
from asperity_research.challenge.posing import NAMES, Column, Problem, problem

_WIDTH = 110
_STATED = " The rule is that of asperity.challenge.heights, whose documentation states it for any language."
_RULES = {
    "independent": "Independent heights on {sites} x {sites} sites, seed {seed}." + _STATED,
    "waves": "A spline of {octaves} octaves: grid {grid}, ratio {ratio}, halvings {halvings}, "
    "seed {seed}{scaled}." + _STATED,
    "scan": "The file {file}, SHA-256 {sha256}; {source}.",
}
_OURS = {"problem.txt", "answer.csv", "heights.npy", "heights.csv", "run.toml"}
_FILES = """\
heights.npy   the heights, rows by columns, in NumPy's format
heights.csv   the same as text, commas between columns
run.toml      the parameters, as `asperity run run.toml` takes them
answer.csv    the form for an answer: fill in the columns, and
              asperity challenge score answer.csv
"""


def write(
    directory: str | Path,
    names: Sequence[str] = NAMES,
    *,
    scan: str | Path | None = None,
    overwrite: bool = False,
) -> tuple[str, ...]:
    """Write the inputs of reference problems: for each a folder with words, heights, parameters and a form.

    Parameters
    ----------
    directory
        The folder, in which those of the problems appear when they are written, beside what it holds.
    names
        Which problems.
    scan
        The file of the measured problem; without it, that folder says where the file is to be had.
    overwrite
        Whether to replace folders of problems that were written before.

    Returns
    -------
    tuple of str
        Remarks: what could not be written, and why.

    Raises
    ------
    InputError
        There is no such problem, the scan is another file, or a problem's folder exists and is to be kept.
    OutputError
        The disk refused.
    """
    chosen = {one: problem(one) for one in names}
    surfaces: dict[str, Surface | None] = {}
    remarks = []
    for name, one in chosen.items():
        if one.heights["rule"] == "scan" and scan is None:
            surfaces[name] = None
            remarks.append(f"{name} has no heights: they need the file {one.heights['file']}, --scan FILE")
        else:
            surfaces[name] = one.surface(scan=scan)
    for name in chosen:
        place = Path(directory, name)
        ours = place.is_dir() and {path.name for path in place.iterdir()} <= _OURS
        if place.exists() and not (ours and overwrite):
            cure = {"overwrite": True} if ours else {}
            expected, got = f"a folder without {name}", f"{place}, which is kept"
            raise InputError("directory", expected=expected, got=got, advice="another folder", cure=cure)
    for name, one in chosen.items():
        with whole_folder(Path(directory, name), overwrite=overwrite) as folder:
            _write(one, surfaces[name], folder)
    return tuple(remarks)


def _write(asked: Problem, surface: Surface | None, folder: Path) -> None:
    if surface is None:
        tables = {"kind": "file", "path": asked.heights["file"], **asked.run["surface"]}
    else:
        np.save(folder / "heights.npy", surface.heights)
        np.savetxt(folder / "heights.csv", surface.heights, fmt="%.17g", delimiter=",")
        tables = {"kind": "file", "path": "heights.npy", "tilt": "none", "periodic": "wrap"}
        if surface.pixel_size is not None:
            tables |= {"file_unit": surface.unit, "length_unit": surface.length_unit}
            tables["pixel_size"] = list(surface.pixel_size)
    solved = {key: table for key, table in asked.run.items() if key != "surface"}
    named = f"# problem: {asked.name}\n"
    columns = ",".join(column.heading for column in (asked.abscissa, *asked.asked))
    places = [f"{place:.12g}{',' * len(asked.asked)}\n" for place in asked.answer.abscissa]
    texts = {
        "problem.txt": in_words(asked, surface),
        "answer.csv": f"{named}{columns}\n{''.join(places)}",  # nothing in it but where it is asked
        "run.toml": named + tomli_w.dumps({"surface": tables, **solved}),
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")


def in_words(asked: Problem, surface: Surface | None = None) -> str:
    """The text of a problem: what is given, and what is asked."""
    rule, scaled, grid = asked.heights, "", ""
    if "side" in rule:
        unit = rule["unit"]
        scaled = f", all times {rule['times']:g} {unit}, on a square of side {rule['side']:g} {unit}"
    stated = _RULES[rule["rule"]].format(**rule, scaled=scaled)
    if surface is not None:
        unit = surface.unit if surface.unit != "1" else "the unit of length of the problem"
        grid = f"Here {' x '.join(map(str, surface.shape))} sites, in {unit}"
        if surface.pixel_size:
            grid += f"; {surface.pixel_size[0]:.9g} x {surface.pixel_size[1]:.9g} {surface.length_unit}"
            grid += " between them"
        grid += "; periodic."
    lines = [f"{asked.name}: {asked.title}", *textwrap.wrap(asked.question, _WIDTH)]
    lines += ["", "Heights", *textwrap.wrap(stated, _WIDTH), *textwrap.wrap(grid, _WIDTH)]
    lines += ["", "Asked", *map(_asked, (asked.abscissa, *asked.asked)), "", "Files", _FILES]
    return "\n".join(lines)


def _asked(column: Column) -> str:
    unit = "" if column.unit == "1" else f" [{column.unit}]"
    tolerance = f"; tolerance {100 * column.tolerance:g} %" if column.tolerance else ""
    return f"{column.heading}{unit}: {column.meaning}{tolerance}"
