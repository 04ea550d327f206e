"""The files of a run, in one folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from asperity.analysis import contact_maps
from asperity.app.config.reading import to_toml
from asperity.base.calls import remark, showing
from asperity.base.files import Standing
from asperity.figures import (
    Drawing,
    aging_curve,
    carried_figure,
    contact_figure,
    history_figure,
    patch_figure,
    sliding_figure,
)
from asperity.figures.writing import write_each
from asperity.figures.writing import write_figure as write_figure
from asperity.results.quantities import RUN, select
from asperity.sheets.tables import with_unit

if TYPE_CHECKING:
    import xarray as xr

    from asperity.app.runs import Outcome

_MOST_MAPS = 24
"""Maps that one figure shows."""


def write_run(outcome: Outcome, folder: Path) -> None:
    """Write all of a run but history and summary to a folder."""
    (folder / "config.toml").write_text(to_toml(outcome.config), encoding="utf-8")
    _write_table(outcome, folder / "aging.csv")
    if "patches" in outcome.dataset:
        _write_patches(outcome.dataset, folder / "patches.csv")
    if outcome.config.output.figures:
        _write_figures(outcome, folder)


def heads_of(columns: Mapping[str, xr.DataArray], *, si: bool = True) -> dict[str, str]:
    """Names of columns with their units, where these are SI."""
    units = {name: column.attrs.get("units") or "1" for name, column in columns.items()}
    return {name: with_unit(name, unit) if si else name for name, unit in units.items()}


def write_figures(draw: Callable[[], Drawing], files: Mapping[Path, Standing]) -> list[str]:
    """Write a figure under the names of `check_figures`; return a line that lists them, if any."""
    written = []
    if files:
        *pictures, table = map(str, files)
        with showing(f"the figure {pictures[0]}"):
            figure = draw()
            for path, before in files.items():
                write_figure(figure, path, overwrite=before)
            written.append(f"figure written: {', '.join(pictures)}; its data: {table}")
    return written


def _write_figures(outcome: Outcome, folder: Path) -> None:
    summary, measured = outcome.summary, outcome.config.output.measured
    drawings: dict[str, Callable[[], Drawing]] = {}
    if summary is None:
        drawings["history"] = lambda: history_figure(outcome.dataset, measured)
    elif summary.time.size:
        drawings["aging"] = lambda: aging_curve(outcome.dataset, summary, measured)
    if "displacement" in outcome.dataset:
        drawings["sliding"] = lambda: sliding_figure(outcome.dataset)
    if "normal_stiffness" in outcome.dataset and outcome.dataset.sizes["time"] > 1:
        drawings["carried"] = lambda: carried_figure(outcome.dataset)
    if maps := outcome.dataset.sizes.get("field_time", 0):
        shown = outcome.dataset
        if maps > _MOST_MAPS:
            shown = shown.isel(field_time=[n * (maps - 1) // (_MOST_MAPS - 1) for n in range(_MOST_MAPS)])
            remark(f"contacts shows {_MOST_MAPS} of {maps} maps; history.zarr holds all")
        drawings["contacts"] = lambda: contact_figure(contact_maps(shown))
    if maps > 1:
        drawings["patches"] = lambda: patch_figure(outcome.dataset)
    write_each(drawings, folder, outcome.config.output.figures)


def _write_table(outcome: Outcome, path: Path) -> None:
    dataset = outcome.dataset
    if dataset["load"][0] > 0:  # else the first area is that of first touch, and no measure of growth
        dataset = dataset.assign(area_ratio=(dataset["area"] / dataset["area"][0]).drop_attrs(deep=False))
    names = [name for name in select("series", "coordinate", table=RUN) if name in dataset.variables]
    if "area_ratio" in dataset:
        names.insert(names.index("area") + 1, "area_ratio")
    _write_columns(dataset, [(name, dataset[name]) for name in names], path)


def _write_patches(dataset: xr.Dataset, path: Path) -> None:
    columns = [("time", dataset["field_time"])]
    for name in select("map", table=RUN):
        if name in dataset and "quantile" in dataset[name].dims:
            shares = dataset["quantile"].values.tolist()
            parts = {f"{name}_{100 * share:g}_percent": dataset[name].sel(quantile=share) for share in shares}
            columns += parts.items()
        elif name in dataset:
            columns.append((name, dataset[name]))
    _write_columns(dataset, columns, path)


def _write_columns(dataset: xr.Dataset, columns: list[tuple[str, xr.DataArray]], path: Path) -> None:
    heads = heads_of(dict(columns), si=bool(dataset.attrs["si"]))
    table = pd.DataFrame({heads[name]: values.values for name, values in columns})
    path.write_text(table.to_csv(index=False, lineterminator="\n", na_rep="nan"), encoding="utf-8")
