"""Rows of a law for the terminal, and its files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from asperity.analysis.scan import understood, written
from asperity.app.cli.report import Row
from asperity.app.config import to_toml
from asperity.app.runs import Outcome
from asperity.base.tables import with_unit
from asperity.contact_law.programs import FILES, Program, closure_fits, law_for
from asperity.figures import law_figure
from asperity.figures.writing import write_each


def law_report(outcome: Outcome, *, seconds: float, resumed: bool = False) -> list[Row]:
    """Rows on the tabulated law, and its values at the first and last pressure."""
    dataset, attrs = outcome.dataset, outcome.dataset.attrs
    scan, pixels = json.loads(attrs["surface"]), " x ".join(map(str, json.loads(attrs["shape"])))
    modulus = f", E* = {written(attrs['modulus'], 'Pa')}" if "modulus" in attrs else ""
    rows = [
        ("surface", f"{scan.get('file') or 'surface'}: {pixels} pixels"),
        *understood(scan),
        ("solid", f"{str(attrs['solid']).replace('_', ' ')}{modulus}"),
        ("pressures", f"{dataset.sizes['pressure']}: {_ends(dataset, 'pressure')}, each held"),
    ]
    for time in dataset["time"].values.tolist():
        table = dataset.sel(direction="loading", time=time)
        area = f"contact {100 * float(table['contact_fraction'][-1]):.3g} % under the last pressure"
        text = f"approach {_ends(table, 'approach')}, stiffness {_ends(table, 'stiffness')}, {area}"
        rows.append((f"age {written(time, 's')}", text))
        if "softest_direction" in table:
            ends = [float(table[f"tangential_stiffness_{end}"][-1]) for end in ("soft", "stiff")]
            soft, stiff = (written(end, "Pa/m") for end in ends)
            angle = f"{float(table['softest_direction'][-1]):.3g} degrees from x towards y"
            rows.append(("shear", f"stiffness {soft} along {angle}, {stiff} across, under the last pressure"))
        for name, first, second, rms, most in closure_fits(dataset, age=time).itertuples():
            text = f"a = p / (K + p / V): K = {written(first, 'Pa/m')}, V = {written(second, 'm')}"
            if name == "power":
                text = f"a = c (p / 1 MPa)^n: c = {written(first, 'm')}, n = {second:.4g}"
            rows.append((name, f"{text}; errs by {100 * rms:.2g} % rms, {100 * most:.2g} % at most"))
    rows.append(("approach", "of the mean surface, without the deformation of a flat solid"))
    if dataset.sizes["direction"] > 1:
        rows.append(("unloading", "separate table: from the largest pressure at its age, without creep"))
    if dataset.sizes["time"] > 1:
        text = "do not interpolate between ages while the load changes: creep depends on its history"
        rows.append(("ages", text))
    rows.append(("cost", f"{seconds:.1f} s{' in this session' if resumed else ''}"))
    return [*rows, *(("remark", remark) for remark in outcome.remarks)]


def _ends(table: xr.Dataset, name: str) -> str:
    return " to ".join(written(float(table[name][n]), str(table[name].attrs["units"])) for n in (0, -1))


def write_law(
    outcome: Outcome, folder: Path, *, programs: Sequence[Program], age: str | None, millimeters: bool
) -> None:
    """Write the table, the configuration, files for other programs, and the figure."""
    dataset = outcome.dataset
    order = ["direction", "time", "pressure", *map(str, dataset.data_vars)]
    names = {name: with_unit(name, dataset[name].attrs.get("units", "1")) for name in order}
    table = dataset.to_dataframe().reset_index()[order].rename(columns=names)
    table.to_csv(folder / "law.csv", index=False, lineterminator="\n")
    (folder / "config.toml").write_text(to_toml(outcome.config), encoding="utf-8")
    for program in programs:
        for direction in dataset["direction"].values.tolist():
            text = law_for(program, dataset, age=age, direction=direction, millimeters=millimeters)
            prefix = "" if direction == "loading" else f"{direction}_"
            (folder / f"{prefix}{FILES[program]}").write_text(text, encoding="utf-8")
    write_each({"law": lambda: law_figure(dataset)}, folder, outcome.config.output.figures)
