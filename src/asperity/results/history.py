"""The history of a contact: a Dataset, and the last contact."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from asperity.base import checks, views
from asperity.base.rows import Row
from asperity.base.words import closest
from asperity.contact import Contact
from asperity.errors import InputError
from asperity.results.store import save

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes


def check_dataset(dataset: object) -> None:
    """`InputError` unless it is the dataset of a history."""
    import xarray as xr

    checks.instance("dataset", dataset, xr.Dataset, "history.dataset")
    if missing := [name for name in ("time", "area") if name not in dataset]:  # type: ignore[operator]
        expected, got = "the dataset of a history", f"one without {', '.join(missing)}"
        raise InputError("dataset", expected=expected, got=got, advice="asperity.results.load(folder)")


def check_fields(dataset: object) -> None:
    """`InputError` unless it is the dataset of a history with fields."""
    import xarray as xr

    checked = checks.instance("dataset", dataset, xr.Dataset, "history.dataset")
    if "field_time" not in checked.get("in_contact", xr.DataArray()).dims:
        expected, advice = "a history that kept fields", "age(..., fields_at=times)"
        raise InputError("dataset", expected=expected, got="none", advice=advice)


@dataclass(frozen=True, eq=False)
class History(views.InNotebooks):
    """The history of an aging contact.

    Attributes
    ----------
    dataset
        An xarray Dataset over ``time``, from 0, the state before any creep: ``area``, ``load``,
        ``separation``, ``energy``, ``residual`` and others; ``heights`` over the sites. With ``fields_at``,
        over ``field_time``: ``u``, ``u0``, ``in_contact``, ``force`` (continua: ``pressure``), and numbers of
        the patches such as ``patches`` and ``births``. The reference lists all, with their units.
        ``history["energy"]`` is one of them.
    final
        The contact at the last time of ``times`` and ``fields_at``; age it further, or relax it.
    """

    dataset: xr.Dataset
    final: Contact

    def __repr__(self) -> str:
        times = self.dataset["time"].values
        areas = self.dataset["area"].values
        return f"<History: {times.size} times to {times[-1]:g}, area {areas[0]} to {areas[-1]} sites>"

    def __getitem__(self, name: str) -> xr.DataArray:
        """Return a variable of the dataset, with its name and unit: ``history["mean_gap"]``."""
        if not isinstance(name, str) or name not in self.dataset.variables:
            near = closest(name, sorted(map(str, self.dataset.variables))) if isinstance(name, str) else None
            expected, advice = "a variable of the dataset, such as area or load", "print(history.dataset)"
            raise InputError("name", expected=expected, got=repr(name), advice=near or advice)
        return self.dataset[name]

    @property
    def time(self) -> xr.DataArray:
        """Times, from 0 on."""
        return self["time"]

    @property
    def area(self) -> xr.DataArray:
        """Real contact area at each time, sites."""
        return self["area"]

    @property
    def load(self) -> xr.DataArray:
        """Normal load at each time."""
        return self["load"]

    @property
    def separation(self) -> xr.DataArray:
        """Separation at each time."""
        return self["separation"]

    @property
    def table(self) -> pd.DataFrame:
        """The series over time, without the fields: a pandas DataFrame with a row for each time.

        Columns have the names of the dataset; ``leg`` is one after a protocol. Their units, and that of the
        time, are in ``table.attrs["units"]``, by name.
        """
        series = [name for name, variable in self.dataset.data_vars.items() if variable.dims == ("time",)]
        table = self.dataset[series].to_dataframe()
        table.attrs["units"] = {name: self.dataset[name].attrs.get("units", "") for name in ("time", *table)}
        return table

    @views.later
    def rows(self, /) -> list[Row]:
        """Rows of a summary: name, value with its unit, 95 % interval; by leg under a protocol."""
        raise NotImplementedError

    @views.later
    def plot(
        self,
        /,
        ax: Axes | None = None,
        *,
        quantity: str = "area",
        limit: Contact | None = None,
        label: str = "",
        color: str | None = None,
    ) -> Axes:
        """Draw how a quantity changed with time.

        Arguments, result and errors are those of `asperity.figures.plot_history`.
        """
        raise NotImplementedError

    @views.later
    def animate(
        self,
        /,
        path: str | Path | None = None,
        *,
        quantity: str = "area",
        frames_per_second: float = 4.0,
        overwrite: bool = False,
    ) -> FuncAnimation:
        """Animate the contact at the times of ``fields_at``.

        Arguments, result and errors are those of `asperity.figures.animate_history`.
        """
        raise NotImplementedError

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write the dataset; see `asperity.results.save`. To age on later, save ``history.final`` too."""
        save(self.dataset, path, overwrite=overwrite)
