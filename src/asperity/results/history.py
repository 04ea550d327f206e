"""How a contact aged: a Dataset, and the contact at its end."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from asperity.contact.state import Contact
from asperity.results.store import save


@dataclass(frozen=True, eq=False)
class History:
    """How a contact aged.

    Attributes
    ----------
    dataset
        An xarray Dataset over ``time``, whose first entry, 0, is the state before any creep:
        ``area``, ``contact_fraction``, ``load``, ``separation``, ``approach``, ``energy``,
        ``residual``, ``residual_scale``, ``steps``, ``rejected``, ``iterations``; ``heights`` over the
        sites; and over ``field_time``, where fields were asked for, ``u``, ``u0`` and ``in_contact``.
    final
        The contact at the last time reached (of ``times`` and ``fields_at``); age it further, or relax it.
    """

    dataset: xr.Dataset
    final: Contact

    def __repr__(self) -> str:
        times = self.dataset["time"].values
        areas = self.dataset["area"].values
        return f"<History: {times.size} times to {times[-1]:g}, area {areas[0]} to {areas[-1]} sites>"

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write the dataset; see `asperity.results.save`."""
        save(self.dataset, path, overwrite=overwrite)
