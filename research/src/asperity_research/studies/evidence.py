"""What the simulations found, campaign by campaign, for the figures and the ledger to read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

from asperity import campaign
from asperity_research.arrays import Field


@dataclass(frozen=True)
class Evidence:
    """The finished campaigns of a study, or of a reproduction.

    Attributes
    ----------
    folder
        Where they lie, one folder each.
    """

    folder: Path
    _opened: dict[str, xr.Dataset] = field(default_factory=dict, compare=False, repr=False)

    def __getitem__(self, study: str) -> xr.Dataset:
        """Return the Dataset of a study, as `asperity.app.campaign.open` gives it.

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
        """Return the values of a swept parameter."""
        return [float(value) for value in self[study][name].values]

    def sites(self, study: str) -> float:
        """Return the nominal area of a study of one size, in sites."""
        return float(self[study]["sites"].max())

    def samples(self, study: str, name: str, **where: float) -> Field:
        """Return one quantity with its seeds first, at some values of the swept parameters.

        What is left of the parameters and the time follows in the order of the Dataset.
        """
        chosen = self[study][name].sel(where)
        return np.asarray(chosen.transpose("seed", ...), dtype=np.float64)

    def waits(self, study: str, name: str = "area") -> Iterator[tuple[float, Around]]:
        """Give each waiting time of a campaign of `campaigns.after_waits`, and a quantity around the step."""
        data = self[study.replace(".", "_")]
        for point in range(data.sizes["point"]):
            runs = data.isel(point=point)
            yield float(runs["protocol.0.mobility"]), Around.step(runs, name)


@dataclass(frozen=True, eq=False)
class Around:
    """A quantity before and after a step, which is the second leg, on all surfaces.

    Attributes
    ----------
    time
        Since the step; 0 is just after it; shape (n,).
    first, before
        The quantity at the beginning and just before the step, shape (surfaces,).
    after
        After it, shape (surfaces, n).
    """

    time: Field
    first: Field
    before: Field
    after: Field

    @classmethod
    def step(cls, runs: xr.Dataset, name: str = "area") -> Around:
        """Read it from runs that differ in their seeds only."""
        values = np.asarray(runs[name].transpose("seed", ...), dtype=np.float64)
        leg, time = (runs[key].values.reshape(-1, values.shape[1])[0] for key in ("leg", "time"))
        since, held = leg >= 1, np.flatnonzero(leg == 0)[-1]
        return cls(time[since] - time[held], values[:, 0], values[:, held], values[:, since])
