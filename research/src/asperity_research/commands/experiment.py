"""The command ``asperity experiment``: measured contacts, and simulations beside them."""

import sys
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from textwrap import fill, wrap

from asperity.app.cli.options import Work
from asperity.base.rows import aligned
from asperity_research.commands.ensembles import Ensembles
from asperity_research.commands.study import answer
from asperity_research.experiments import load, names
from asperity_research.experiments.comparing import comparison_of
from asperity_research.experiments.record import Column, Quantity

_WIDTHS = 24, 24, 10, 12, 12, 34
"""Most letters in each column of the numbers of an experiment."""

_WIDTH = 100


def say_experiments() -> None:
    """List the experiments."""
    rows = [(name, load(name).title) for name in names()]
    sys.stdout.write(f"{aligned(rows)}\n\nasperity experiment NAME               the measured numbers\n")
    sys.stdout.write("asperity experiment NAME --out FOLDER  simulations beside them; --quick in minutes\n")


def say_experiment(name: str) -> None:
    """Say every number of one, with unit, uncertainty, source and how it was read."""
    experiment = load(name)
    rows = [("number", "value", "unit", "uncertainty", "source", "how it was read")]
    rows += [(key, f"{it.value:g}", *_said(it)) for key, it in experiment.inputs.items()]
    for key, series in experiment.series.items():
        for column in series.variables:
            if not str(column).endswith("_error"):
                values = ", ".join(f"{value:g}" for value in series[column].values.tolist())
                rows.append((f"{key} {column}", values, *_said(experiment.columns[key, str(column)])))
    lines = [line for row in rows for line in zip_longest(*map(wrap, row, _WIDTHS), fillvalue="")]
    sources = "\n".join(fill(f"{short}: {paper}", _WIDTH) for short, paper in experiment.sources.items())
    missing = "\n".join(fill(f"missing: {gap}", _WIDTH) for gap in experiment.missing)
    numbers = aligned(lines) if rows[1:] else "no numbers"
    sys.stdout.write(f"{fill(experiment.title, _WIDTH)}\n\n{numbers}\n\n{sources}\n\n{missing}\n")


def _said(it: Quantity | Column) -> tuple[str, str, str, str]:
    error = it.uncertainty if isinstance(it.uncertainty, str) else f"{it.uncertainty:g}"
    if it.relative:
        error += " of it"
    return it.unit, error, it.source, it.how


def compare(
    name: str, out: Path, scans: Sequence[Path], record: Path | None, ensembles: Ensembles, work: Work
) -> None:
    """Run what is missing, compare, and write the report; or say what that takes; as for a study."""
    words = ["experiment", name, *(word for scan in scans for word in ("--surface", str(scan)))]
    words += [] if record is None else ["--record", str(record)]
    answer(comparison_of(name, scans, record), words, out, ensembles, work)
