"""The input files of the reference problems, which anybody's code can read."""

from __future__ import annotations

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
_RULES = {
    "independent": "Independent heights on {sites} x {sites} sites, seed {seed}.",
    "waves": "A spline of {octaves} octaves: grid {grid}, ratio {ratio}, halvings {halvings}, "
    "seed {seed}{scaled}.",
    "scan": "The file {file}, SHA-256 {sha256}; {source}.",
}
_STATED = " The rule is that of asperity.challenge.heights, whose documentation states it for any language."
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
    chosen = [problem(name) for name in names]
    remarks = []
    surfaces: dict[str, Surface | None] = {}
    for one in chosen:
        absent = one.heights["rule"] == "scan" and scan is None
        surfaces[one.name] = None if absent else one.surface(scan=scan)
        if absent:
            remarks.append(
                f"{one.name} has no heights: they need the file {one.heights['file']}, --scan FILE"
            )
    for one in chosen:
        place = Path(directory, one.name)
        if place.exists():
            ours = place.is_dir() and {path.name for path in place.iterdir()} <= _OURS
            if not (ours and overwrite):
                advice = f"another folder{', or overwrite=True' if ours else ''}"
                expected, got = f"a folder without {one.name}", f"{place}, which is kept"
                raise InputError("directory", expected=expected, got=got, advice=advice)
    for one in chosen:
        with whole_folder(Path(directory, one.name), overwrite=overwrite) as folder:
            _write(one, surfaces[one.name], folder)
    return tuple(remarks)


def _write(asked: Problem, surface: Surface | None, folder: Path) -> None:
    (folder / "problem.txt").write_text(in_words(asked, surface), encoding="utf-8")
    (folder / "answer.csv").write_text(_form(asked), encoding="utf-8")
    if surface is None:
        tables = {"kind": "file", "path": asked.heights["file"], **asked.run["surface"]}
    else:
        np.save(folder / "heights.npy", surface.heights)
        np.savetxt(folder / "heights.csv", surface.heights, fmt="%.17g", delimiter=",")
        tables = {"kind": "file", "path": "heights.npy", "tilt": "none", "periodic": "wrap"}
        if surface.pixel_size is not None:
            tables |= {"file_unit": surface.unit, "length_unit": surface.length_unit}
            tables["pixel_size"] = list(surface.pixel_size)
    run = {"surface": tables} | {key: table for key, table in asked.run.items() if key != "surface"}
    text = f"# problem: {asked.name}\n{tomli_w.dumps(run)}"
    (folder / "run.toml").write_text(text, encoding="utf-8")


def in_words(asked: Problem, surface: Surface | None = None) -> str:
    """The text of a problem: what is given, and what is asked."""
    paragraphs = [f"{asked.name}: {asked.title}", *textwrap.wrap(" ".join(asked.question.split()), _WIDTH)]
    rule = dict(asked.heights)
    scaled = ""
    if "side" in rule:
        unit = rule["unit"]
        scaled = f", all times {rule['times']:g} {unit}, on a square of side {rule['side']:g} {unit}"
    stated = _RULES[rule["rule"]].format(**rule, scaled=scaled)
    if rule["rule"] != "scan":
        stated += _STATED
    lines = [*paragraphs, "", "Heights", *textwrap.wrap(stated, _WIDTH)]
    if surface is not None:
        rows, columns = surface.shape
        unit = surface.unit if surface.unit != "1" else "the unit of length of the problem"
        pixel = (
            f"; {surface.pixel_size[0]:.9g} x {surface.pixel_size[1]:.9g} {surface.length_unit} between them"
            if surface.pixel_size
            else ""
        )
        lines += textwrap.wrap(f"Here {rows} x {columns} sites, in {unit}{pixel}; periodic.", _WIDTH)
    lines += ["", "Asked", *(_asked(column) for column in (asked.abscissa, *asked.asked))]
    lines += ["", "Files", _FILES.rstrip()]
    return "\n".join(lines) + "\n"


def _asked(column: Column) -> str:
    unit = "" if column.unit == "1" else f" [{column.unit}]"
    tolerance = f"; tolerance {100 * column.tolerance:g} %" if column.tolerance else ""
    return f"{column.heading}{unit}: {column.meaning}{tolerance}"


def _form(asked: Problem) -> str:
    """An answer with nothing in it but where it is asked."""
    headings = [asked.abscissa.heading, *(column.heading for column in asked.asked)]
    rows = [f"{place:.12g}{',' * len(asked.asked)}" for place in asked.answer.abscissa]
    return "\n".join([f"# problem: {asked.name}", ",".join(headings), *rows]) + "\n"
