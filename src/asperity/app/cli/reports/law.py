"""The files of a law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from asperity.app.cli.output import heads_of
from asperity.app.config import to_toml
from asperity.app.runs import Outcome
from asperity.contact_law.programs import FILES, Program, law_for
from asperity.figures import law_figure
from asperity.figures.writing import write_each


def write_law(
    outcome: Outcome,
    folder: Path,
    *,
    own: Mapping[str, Any],
    programs: Sequence[Program],
    age: str | None,
    millimeters: bool,
) -> None:
    """Write table, configuration with the keys of the question, files for other programs, and figure."""
    dataset = outcome.dataset
    order = ["direction", "time", "pressure", *map(str, dataset.data_vars)]
    table = dataset.to_dataframe().reset_index()[order]
    table = table.rename(columns=heads_of({name: dataset[name] for name in order}))
    table.to_csv(folder / "law.csv", index=False, lineterminator="\n")
    (folder / "config.toml").write_text(to_toml(outcome.config, law=own), encoding="utf-8")
    for program in programs:
        for direction in dataset["direction"].values.tolist():
            text = law_for(program, dataset, age=age, direction=direction, millimeters=millimeters)
            prefix = "" if direction == "loading" else f"{direction}_"
            (folder / f"{prefix}{FILES[program]}").write_text(text, encoding="utf-8")
    write_each({"law": lambda: law_figure(dataset)}, folder, outcome.config.output.figures)
