"""What the answer to a question is: a Dataset, its rows, tables and figures, and the files of all of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import pandas as pd
import xarray as xr

from asperity.app.config import RunConfig, to_toml
from asperity.base.rows import Row
from asperity.sheets.tables import with_unit

if TYPE_CHECKING:
    from asperity.figures import Drawing


@dataclass(frozen=True, eq=False)
class Outcome:
    """The answer to the question of a configuration, with remarks on choices and on missing results.

    The configuration is complete: reading it again gives the same answer.
    """

    config: RunConfig
    dataset: xr.Dataset
    remarks: tuple[str, ...]

    over: ClassVar[tuple[str, ...]] = ("time",)
    """Dimensions of its table."""

    def numbers(self) -> dict[str, tuple[tuple[()], float, dict[str, str]]]:
        """Single numbers beside those of the dataset, as variables of it."""
        return {}

    def rows(self) -> list[Row]:
        """Rows of the summary, without remarks."""
        raise NotImplementedError

    def tables(self) -> dict[str, pd.DataFrame]:
        """Tables by the names of their files, with units in the names of their columns; or one over all."""
        dataset, over = self.dataset, self.over
        names = [str(name) for name, one in dataset.data_vars.items() if {*one.dims} == {*over}]
        heads = heads_of({name: dataset[name] for name in (*over, *names)})
        table = dataset[names].to_dataframe(dim_order=[*over]).reset_index()[[*heads]]
        return {self.config.asked: table.rename(columns=heads)}

    def drawings(self) -> dict[str, Callable[[], Drawing]]:
        """What draws each figure, by the names of their files."""
        raise NotImplementedError

    def write(self, folder: Path, **_: Any) -> None:
        """Write configuration, tables and figures to a folder."""
        from asperity.figures.writing import write_each

        (folder / "config.toml").write_text(to_toml(self.config), encoding="utf-8")
        for name, table in self.tables().items():
            table.to_csv(folder / f"{name}.csv", index=False, lineterminator="\n", na_rep="nan")
        formats = self.config.output.figures
        write_each(self.drawings() if formats else {}, folder, formats)


def table_of(columns: Mapping[str, xr.DataArray]) -> pd.DataFrame:
    """Columns of one length as a table."""
    heads = heads_of(columns)
    return pd.DataFrame({heads[name]: values.values for name, values in columns.items()})


def heads_of(columns: Mapping[str, xr.DataArray]) -> dict[str, str]:
    """Names of columns, with their units where any of them has one of SI."""
    units = {name: column.attrs.get("units") or "1" for name, column in columns.items()}
    si = not {"m", "s", "m/s", "Pa"}.isdisjoint(units.values())
    return {name: with_unit(name, unit) if si else name for name, unit in units.items()}
