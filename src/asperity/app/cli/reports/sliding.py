"""The files of steady sliding."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from asperity.app.cli.output import heads_of
from asperity.app.config import to_toml
from asperity.app.runs import Outcome
from asperity.figures import steady_sliding_figure
from asperity.figures.writing import write_each


def write_sliding(outcome: Outcome, folder: Path, *, own: Mapping[str, Any]) -> None:
    """Write the table, the configuration with the keys of the question, and the figure."""
    dataset = outcome.dataset
    over_speed = [name for name in dataset.data_vars if dataset[name].dims == ("speed",)]
    table = dataset[over_speed].to_dataframe().reset_index()
    si = dataset["speed"].attrs["units"] == "m/s"
    heads = heads_of({str(name): dataset[name] for name in table}, si=si)
    table.rename(columns=heads).to_csv(folder / "sliding.csv", index=False, lineterminator="\n")
    (folder / "config.toml").write_text(to_toml(outcome.config, sliding=own), encoding="utf-8")
    write_each({"sliding": lambda: steady_sliding_figure(dataset)}, folder, outcome.config.output.figures)
