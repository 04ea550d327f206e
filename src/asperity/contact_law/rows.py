"""Rows of a tabulated law."""

from __future__ import annotations

import xarray as xr

from asperity.analysis.rows import bodies_rows
from asperity.base.readable import written
from asperity.base.rows import Row
from asperity.contact_law.programs import closure_fits


def rows_of(dataset: xr.Dataset) -> list[Row]:
    """Rows of a summary of a law: its solid, and at each age its values at the first and last pressure."""
    rows = [
        *bodies_rows(dataset.attrs),
        Row("pressures", f"{dataset.sizes['pressure']}: {_ends(dataset, 'pressure')}, each held"),
    ]
    for time in dataset["time"].values.tolist():
        table = dataset.sel(direction="loading", time=time)
        area = f"contact {100 * float(table['contact_fraction'][-1]):.3g} % under the last pressure"
        text = f"approach {_ends(table, 'approach')}, stiffness {_ends(table, 'stiffness')}, {area}"
        rows.append(Row(f"age {written(time, 's')}", text))
        if "softest_direction" in table:
            ends = [float(table[f"tangential_stiffness_{end}"][-1]) for end in ("soft", "stiff")]
            soft, stiff = (written(end, "Pa/m") for end in ends)
            angle = f"{float(table['softest_direction'][-1]):.3g} degrees from x towards y"
            text = f"stiffness {soft} along {angle}, {stiff} across, under the last pressure"
            rows.append(Row("shear", text))
        for name, first, second, rms, most in closure_fits(dataset, age=time).itertuples():
            text = f"a = p / (K + p / V): K = {written(first, 'Pa/m')}, V = {written(second, 'm')}"
            if name == "power":
                text = f"a = c (p / 1 MPa)^n: c = {written(first, 'm')}, n = {second:.4g}"
            rows.append(Row(name, f"{text}; errs by {100 * rms:.2g} % rms, {100 * most:.2g} % at most"))
    rows.append(Row("approach", "of the mean surface, without the deformation of a flat solid"))
    if dataset.sizes["direction"] > 1:
        rows.append(Row("unloading", "separate table: from the largest pressure at its age, without creep"))
    if dataset.sizes["time"] > 1:
        text = "do not interpolate between ages while the load changes: creep depends on its history"
        rows.append(Row("ages", text))
    return rows


def _ends(table: xr.Dataset, name: str) -> str:
    return " to ".join(written(float(table[name][n]), str(table[name].attrs["units"])) for n in (0, -1))
