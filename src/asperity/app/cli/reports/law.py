"""What a law says, as rows of words, and its files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from asperity.analysis.law_words import FILES, Program, closure_fits, law_for
from asperity.analysis.scan import understood, written
from asperity.app.cli.report import Row
from asperity.app.config import RunConfig, to_toml
from asperity.base.tables import with_unit
from asperity.figures.law import law_figure
from asperity.results.store import write_into


def law_report(dataset: xr.Dataset, remarks: Sequence[str]) -> list[Row]:
    """Say what was tabulated, and what it comes to at the ends."""
    attrs, pressure = dataset.attrs, dataset["pressure"].values.tolist()
    scan, pixels = json.loads(attrs["surface"]), " x ".join(map(str, json.loads(attrs["shape"])))
    sides = " x ".join(written(side, "m") for side in json.loads(attrs["spacing"]))
    rows = [("surface", f"{scan.get('file') or 'surface'}: {pixels} pixels of {sides}"), *understood(scan)]
    rows.append(("solid", f"{str(attrs['solid']).replace('_', ' ')}, E* = {written(attrs['modulus'], 'Pa')}"))
    first, last = written(pressure[0], "Pa"), written(pressure[-1], "Pa")
    rows.append(("pressures", f"{len(pressure)} from {first} to {last}, each put on at once and held"))
    for time in dataset["time"].values.tolist():
        table = dataset.sel(direction="loading", time=time)
        area = f"contact {100 * float(table['contact_fraction'][-1]):.3g} % at the last pressure"
        said = f"approach {_range(table, 'approach')}, stiffness {_range(table, 'stiffness')}, {area}"
        rows.append((f"age {written(time, 's')}", said))
        rows += [(fit.name, str(fit)) for fit in closure_fits(dataset, age=time)]
    rows.append(("taken off", "what the flat solid does: the approach is that of the mean of its surface"))
    if dataset.sizes["direction"] > 1:
        rows.append(("unloading", f"from {last} at each age, at once: a table of its own"))
    if dataset.sizes["time"] > 1:
        said = "do not interpolate between ages while the load changes: what has crept depends on the history"
        rows.append(("ages", said))
    return [*rows, *(("remark", remark) for remark in remarks)]


def _range(table: xr.Dataset, name: str) -> str:
    return " to ".join(written(float(table[name][n]), str(table[name].attrs["units"])) for n in (0, -1))


def write_law(
    dataset: xr.Dataset,
    config: RunConfig,
    folder: Path,
    *,
    programs: Sequence[Program],
    age: str | None,
    millimeters: bool,
) -> None:
    """Write the table, its figure, what was used of the configuration, and files for other programs."""
    write_into(dataset, folder / "law.zarr")
    table = dataset.to_dataframe().reset_index()
    names = {name: with_unit(str(name), _unit(dataset, str(name))) for name in table}
    table = table.rename(columns=names)
    ordered = ["direction", "time_s", *(name for name in table if name not in ("direction", "time_s"))]
    table[ordered].to_csv(folder / "law.csv", index=False, lineterminator="\n")
    law_figure(dataset).savefig(folder / "law.png")
    (folder / "config.toml").write_text(to_toml(config), encoding="utf-8")
    for program in programs:
        for direction in dataset["direction"].values.tolist():
            text = law_for(program, dataset, age=age, direction=direction, millimeters=millimeters)
            name = FILES[program] if direction == "loading" else f"{direction}_{FILES[program]}"
            (folder / name).write_text(text, encoding="utf-8")


def _unit(dataset: xr.Dataset, name: str) -> str:
    column = name.removesuffix("_low").removesuffix("_high")
    return str(dataset[column].attrs.get("units", "1"))
