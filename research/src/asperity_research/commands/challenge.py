"""The commands ``asperity challenge``: reference problems, their inputs, and scores of answers."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from asperity.app.cli.new_files import FIGURE_SUFFIXES, check_new_file
from asperity.app.cli.output import write_figure
from asperity.app.cli.report import aligned
from asperity.base.words import counted
from asperity.errors import InputError
from asperity_research.challenge import NAMES, Score, problems, score, score_figure, write

_FLAGS = {"problem": "--problem", "scan": "--scan", "directory": "folder"}


def list_problems() -> None:
    """Say what there is."""
    rows = [("problem", "what it is", "asked", "known to")]
    for one in problems():
        for row, column in enumerate(one.asked):
            first = (one.name, one.title) if row == 0 else ("", "")
            value, bar = one.answer.values[column.name], one.answer.bars[column.name]
            known = 100 * float(np.median(bar[value != 0] / np.abs(value[value != 0])))
            rows.append((*first, column.heading, f"{known:.1g} %"))
    sys.stdout.write(f"{aligned(rows)}\n\nasperity challenge write FOLDER  writes their inputs\n")


def write_inputs(folder: Path, names: Sequence[str], *, scan: Path | None, overwrite: bool) -> None:
    """Write the inputs of some problems, or of all.

    `AsperityError` if there is no such problem, the scan is another file, or the disk refused.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError("folder", expected="a folder", got=f"{folder}, which is a file")
    chosen = tuple(dict.fromkeys(names)) or NAMES
    try:
        remarks = write(folder, chosen, scan=scan, overwrite=overwrite)
    except InputError as error:
        raise _of_flags(error) from error
    lines = [f"{counted(len(chosen), 'problem')} written: {folder}", *(f"remark: {one}" for one in remarks)]
    sys.stdout.write("\n".join(lines) + "\n")


def score_file(result: Path, *, problem: str | None, out: Path | None, overwrite: bool) -> None:
    """Compare, say, and draw; `AsperityError` if it is no answer, or the figure cannot be written."""
    if out is not None:
        check_new_file("--out", out, FIGURE_SUFFIXES, overwrite=overwrite)
    try:
        found = score(result, problem)
    except InputError as error:
        raise _of_flags(error) from error
    if out is not None:
        write_figure(score_figure(found), out)
    blocks = [aligned(rows) for rows in _blocks(found)]
    written = [] if out is None else [f"figure written: {out}"]
    sys.stdout.write("\n\n".join([*blocks, *written]) + "\n")


def _blocks(found: Score) -> list[list[tuple[str, ...]]]:
    """A table for each quantity, and the verdicts."""
    place = found.problem.abscissa.heading
    blocks: list[list[tuple[str, ...]]] = []
    verdicts: list[tuple[str, ...]] = []
    for one in found.quantities:
        rows: list[tuple[str, ...]] = [(place, one.heading, "certified", "error bar", "in bars", "percent")]
        rows += [
            (f"{x:.6g}", f"{a:.8g}", f"{b:.8g}", f"{bar:.2g}", f"{in_bars:+.2f}", f"{100 * apart:+.3g}")
            for x, a, b, bar, in_bars, apart in zip(
                one.abscissa, one.given, one.certified, one.bar, one.in_bars, one.relative, strict=True
            )
        ]
        blocks.append(rows)
        worst = int(np.argmax(np.abs(one.in_bars)))
        said = f"worst at {one.abscissa[worst]:.6g}: {one.in_bars[worst]:+.3g} bars"
        said += f", {100 * one.relative[worst]:+.2g} %; tolerance {100 * one.column.tolerance:g} %"
        verdicts.append((one.column.heading, one.verdict, said))
    verdicts += [(name, "not given", "") for name in found.missing]
    good = sum(one.verdict != "off" for one in found.quantities)
    total = f"{good} of {counted(len(found.problem.asked), 'quantity', 'quantities')} agree"
    total += f" at {found.rows} of {found.asked} places"
    verdicts.append((found.problem.name, "agrees" if found.agrees else "does not agree", total))
    return [*blocks, verdicts]


def _of_flags(error: InputError) -> InputError:
    """The same error, about the flag."""
    name = _FLAGS.get(error.name, error.name)
    advice = error.advice.replace("overwrite=True", "--overwrite")
    if name == "--problem" and advice:
        advice = f"--problem {advice}"
    return InputError(name, expected=error.expected, got=error.got, advice=advice)
