"""Rows of steady sliding for the terminal, and its files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from asperity.analysis.scan import understood, written
from asperity.app.cli.report import Row
from asperity.app.config import to_toml
from asperity.app.runs import Outcome
from asperity.base.tables import with_unit
from asperity.base.words import tables_to_toml
from asperity.figures import steady_sliding_figure
from asperity.figures.writing import write_each


def sliding_report(outcome: Outcome, *, seconds: float, resumed: bool = False) -> list[Row]:
    """Rows on the friction and the contact area, at the ends of the speeds and where friction is largest."""
    del resumed
    dataset, attrs = outcome.dataset, outcome.dataset.attrs
    scan, pixels = json.loads(attrs["surface"]), " x ".join(map(str, json.loads(attrs["shape"])))
    modulus = f", E* = {written(attrs['modulus'], 'Pa')}" if "modulus" in attrs else ""
    pressure = written(attrs["load"] / attrs["nominal_area"], "Pa")
    rows = [
        ("surface", f"{scan.get('file') or 'surface'}: {pixels} pixels"),
        *understood(scan),
        ("solid", f"{str(attrs['solid']).replace('_', ' ')}{modulus}"),
        ("pressure", f"{pressure} over the nominal area, {json.loads(attrs['direction'])} direction"),
        ("speeds", f"{dataset.sizes['speed']}, each in its steady state"),
    ]
    friction = dataset["hysteresis_friction_coefficient"].values
    places = {"slowest": 0, "largest friction": int(np.argmax(friction)), "fastest": friction.size - 1}
    rows += [(name, _words(dataset.isel(speed=n))) for name, n in places.items()]
    rows.append(("heat", "left out: no flash temperature"))
    worst, products = float(dataset["residual"].max()), int(dataset["products"].sum())
    rows.append(("solver", f"residual {worst:.1e} at most, {products} products"))
    rows.append(("cost", f"{seconds:.1f} s"))
    return [*rows, *(("remark", remark) for remark in outcome.remarks)]


def _words(state: xr.Dataset) -> str:
    """A state in words."""
    text = f"{written(float(state['speed']), str(state['speed'].attrs['units']))}: hysteresis friction "
    text += f"{float(state['hysteresis_friction_coefficient']):.4g}"
    if "friction_coefficient" in state:
        text += f", {float(state['friction_coefficient']):.4g} with shear strength"
    return f"{text}, contact {100 * float(state['contact_fraction']):.4g} %"


def write_sliding(outcome: Outcome, folder: Path, *, own: Mapping[str, Any]) -> None:
    """Write the table, the configuration with the keys of the question, and the figure."""
    dataset = outcome.dataset
    over_speed = [name for name in dataset.data_vars if dataset[name].dims == ("speed",)]
    table = dataset[over_speed].to_dataframe().reset_index()
    names = {str(name): with_unit(str(name), dataset[name].attrs.get("units", "1")) for name in table}
    table.rename(columns=names).to_csv(folder / "sliding.csv", index=False, lineterminator="\n")
    text = f"{to_toml(outcome.config)}\n" + tables_to_toml({"sliding": dict(own)})
    (folder / "config.toml").write_text(text, encoding="utf-8")
    write_each({"sliding": lambda: steady_sliding_figure(dataset)}, folder, outcome.config.output.figures)
