"""How a contact aged: a Dataset, and the contact at its end."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

import asperity.views as views
from asperity.contact.state import Contact
from asperity.results.store import save

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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

    def plot(
        self,
        ax: Axes | None = None,
        *,
        quantity: str = "area",
        limit: Contact | None = None,
        label: str = "",
        color: str = "#0072B2",
    ) -> Axes:
        """Draw how a quantity changed with time; see `asperity.figures.plot_history`.

        Parameters
        ----------
        ax
            Where to draw; by default a new figure.
        quantity
            Any series of the dataset, such as ``"area"``, ``"load"`` or ``"separation"``.
        limit
            The relaxed state, from `asperity.relax`, to be drawn too.
        label, color
            Name of the curve in the legend, and its color, where several histories share axes.

        Returns
        -------
        Axes

        Raises
        ------
        InputError
            There is no such series, or no time above 0.
        """
        return views.plot_history(self.dataset, ax, quantity=quantity, limit=limit, label=label, color=color)

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write the dataset; see `asperity.results.save`."""
        save(self.dataset, path, overwrite=overwrite)
