"""The commands ``asperity challenge``: reference problems, their inputs, and scores of answers."""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from asperity.app.cli.flags import naming
from asperity.app.cli.new_files import FIGURE_SUFFIXES, check_new_file
from asperity.app.cli.output import write_figure
from asperity.base.calls import showing
from asperity.base.rows import aligned
from asperity.base.words import counted
from asperity.errors import InputError
from asperity_research.challenge import NAMES, Score, problems, score, score_figure, write

_FLAGS = {"problem": "--problem", "scan": "--scan", "directory": "folder", "overwrite": "--overwrite"}


def list_problems() -> None:
    """Say what there is."""
    rows = [("problem", "what it is", "asked", "known to")]
    for one in problems():
        for row, column in enumerate(one.asked):
            first = (one.name, one.title) if row == 0 else ("", "")
            value, bar = one.answer.values[column.name], one.answer.bars[column.name]
            uncertainty = 100 * float(np.median(bar[value != 0] / np.abs(value[value != 0])))
            rows.append((*first, column.heading, f"{uncertainty:.1g} %"))
    sys.stdout.write(f"{aligned(rows)}\n\nasperity challenge write FOLDER  writes their inputs\n")


def write_inputs(folder: Path, names: Sequence[str], *, scan: Path | None, overwrite: bool) -> None:
    """Write the inputs of some problems, or of all.

    `AsperityError` if there is no such problem, the scan is another file, or the disk refused.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError("folder", expected="a folder", got=f"{folder}, which is a file")
    chosen = tuple(dict.fromkeys(names)) or NAMES
    with naming(**_FLAGS):
        remarks = write(folder, chosen, scan=scan, overwrite=overwrite)
    lines = [f"{counted(len(chosen), 'problem')} written: {folder}", *(f"remark: {one}" for one in remarks)]
    sys.stdout.write("\n".join(lines) + "\n")


def score_file(result: Path, *, problem: str | None, out: Path | None, overwrite: bool) -> None:
    """Compare, say, and draw; `AsperityError` if it is no answer, or the figure cannot be written."""
    if out is not None:
        before = check_new_file("--out", out, FIGURE_SUFFIXES, overwrite=overwrite)
    with naming(**_FLAGS):
        result_score = score(result, problem)
    blocks = [aligned(rows) for rows in _blocks(result_score)]
    if out is not None:
        with showing(f"the figure {out}"):
            write_figure(score_figure(result_score), out, overwrite=before)
            blocks.append(f"figure written: {out}")
    sys.stdout.write("\n\n".join(blocks) + "\n")


def _blocks(found: Score) -> Iterator[list[tuple[str, ...]]]:
    """A table for each quantity, and the verdicts."""
    formats = ("{:.6g}", "{:.8g}", "{:.8g}", "{:.2g}", "{:+.2f}", "{:+.3g}")
    table = found.table().rename(columns={"bar": "error bar", "in_bars": "in bars", "relative": "percent"})
    for heading, part in table.assign(percent=100 * table["percent"]).groupby("quantity", sort=False):
        numbers = part.drop(columns="quantity").rename(columns={"given": str(heading)})
        cells = (tuple(map(str.format, formats, row)) for row in numbers.itertuples(index=False))
        yield [tuple(map(str, numbers)), *cells]
    yield [(row.name, str(row.value), row.note.removeprefix("; ")) for row in found.rows()]
