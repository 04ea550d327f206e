"""What the simulations found, campaign by campaign, for the figures and the ledger to read."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

import numpy as np
import xarray as xr

from asperity import campaign
from asperity_research.arrays import Field


@dataclass(frozen=True, eq=False)
class Around:
    """A quantity around a step, which is the second leg, on all surfaces.

    Time since the step, 0 just after it, shape (n,); the quantity at the beginning and just before the step,
    shape (surfaces,); and after it, (surfaces, n).
    """

    time: Field
    first: Field
    before: Field
    after: Field

    @classmethod
    def step(cls, runs: xr.Dataset, name: str = "area") -> Self:
        """Read it from runs that differ in their seeds only."""
        values = _seeds_first(runs[name])
        leg, time = (runs[key].values.reshape(-1, values.shape[1])[0] for key in ("leg", "time"))
        since, held = leg >= 1, np.flatnonzero(leg == 0)[-1]
        return cls(time[since] - time[held], values[:, 0], values[:, held], values[:, since])


@dataclass(frozen=True)
class Evidence:
    """The finished campaigns of a study, or of a reproduction, one folder each."""

    folder: Path
    _opened: dict[str, xr.Dataset] = field(default_factory=dict, compare=False, repr=False)

    def __getitem__(self, study: str) -> xr.Dataset:
        """Return the Dataset of a campaign, as `asperity.app.campaign.open` gives it.

        Scans count as seeds: each is a sample of the surface.
        """
        if study not in self._opened:
            data = campaign.open(self.folder / study)
            scans = "path" in data.dims and "seed" not in data.dims
            self._opened[study] = data.rename(path="seed") if scans else data
        return self._opened[study]

    def fields(self, study: str, **where: float) -> xr.Dataset:
        """Return the fields of one run, as `asperity.app.campaign.fields` gives them."""
        return campaign.fields(self.folder / study, **where)

    def values(self, study: str, name: str) -> list[float]:
        """Return the values of a swept parameter, or the times."""
        return [float(value) for value in self[study][name].values]

    def sites(self, study: str) -> float:
        """Return the nominal area of a campaign of one size, in sites."""
        return float(self[study]["sites"].max())

    def samples(self, study: str, name: str, **where: float) -> Field:
        """Return one quantity with its seeds first, at some values of the swept parameters.

        What is left of the parameters and the time follows in the order of the Dataset.
        """
        return _seeds_first(self[study][name].sel(where))

    def waits(self, study: str, name: str = "area") -> Iterator[tuple[float, Around]]:
        """Give each waiting time of a campaign of `campaigns.after_waits`, and a quantity around the step."""
        data = self[study.replace(".", "_")]
        for point in range(data.sizes["point"]):
            runs = data.isel(point=point)
            yield float(runs["protocol.0.mobility"]), Around.step(runs, name)


def _seeds_first(values: xr.DataArray) -> Field:
    return np.asarray(values.transpose("seed", ...), dtype=np.float64)
