"""The curve of load and separation of two adhering bodies that are pulled apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from asperity.base import views
from asperity.contact import Contact
from asperity.errors import InputError
from asperity.results.dataset import attributes_of, describe_recorded
from asperity.results.quantities import had_by

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class Pull(views.InNotebooks):
    """An instantaneous approach and retreat of two bodies, from `asperity.pull`.

    Attributes
    ----------
    curve
        An xarray Dataset over ``state``, first those of the approach, then of the retreat: ``load``,
        ``separation``, ``approach`` (since the pulled contact), ``area``, ``energy``, ``retreat`` and others.
    last
        The last state of the retreat in which the bodies touched.
    """

    curve: xr.Dataset
    last: Contact

    @classmethod
    def of(cls, approach: Sequence[Contact], retreat: Sequence[Contact]) -> Pull:
        """Gather the states."""
        import xarray as xr

        start, states = retreat[0], [*approach, *retreat]
        names = [name for name in had_by(start, "series") if hasattr(start, name)]
        series = {name: ("state", np.array([getattr(state, name) for state in states])) for name in names}
        series["approach"] = ("state", np.array([start.separation - state.separation for state in states]))
        retreats, words = np.arange(len(states)) >= len(approach), "whether it is of the retreat"
        curve = xr.Dataset(series, {"retreat": ("state", retreats, {"long_name": words})})
        describe_recorded(curve, start)
        facts = {"title": "Bodies pulled apart", **attributes_of(start, retreat[-1].control)}
        last = next(state for state in reversed(retreat) if state.area or state is start)
        return cls(curve.assign_attrs(facts), last)

    @property
    def force(self) -> float:
        """Pull-off force: the largest tension of the retreat, force; 0 where there is none."""
        return max(0.0, -float(self.curve["load"].values[self.curve["retreat"].values].min()))

    @property
    def energy_lost(self) -> float:
        """Work over approach and retreat, energy: the area of the loop of load and approach.

        `InputError` for a pull through the load, whose jump has no known loss.
        """
        if self.curve.attrs["held"] != "separation":
            expected, advice = "a pull through the separation", "asperity.pull(contact, through='separation')"
            raise InputError("energy_lost", expected=expected, got="one through the load", advice=advice)
        return float(np.trapezoid(self.curve["load"].values, self.curve["approach"].values))

    def __repr__(self) -> str:
        unit = self.curve["load"].attrs["units"] if self.curve.attrs["si"] else ""
        states = self.curve.sizes["state"]
        return f"<Pull: {states} states, pull-off force {self.force:g} {unit}".rstrip() + ">"
