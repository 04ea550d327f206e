"""What pulls two bodies apart that stick: the curve of load and separation, and what it says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from asperity.base import views
from asperity.contact import Contact
from asperity.errors import InputError
from asperity.results.dataset import attributes_of, describe
from asperity.results.quantities import had_by


@dataclass(frozen=True, eq=False)
class Pull(views.InNotebooks):
    """An approach and a retreat of two bodies, at once; made by `asperity.pull`.

    Attributes
    ----------
    curve
        An xarray Dataset over ``state``: ``load``, ``separation``, ``approach`` (from the contact that was
        pulled), ``area``, ``energy`` and others, and whether a state is of the ``retreat``. The states of the
        approach come first.
    last
        The last state of the retreat in which the bodies touched.
    """

    curve: xr.Dataset
    last: Contact

    @classmethod
    def of(cls, approach: Sequence[Contact], retreat: Sequence[Contact]) -> Pull:
        """Gather the states."""
        start, states = retreat[0], [*approach, *retreat]
        names = [name for name in had_by(start, "series") if hasattr(start, name)]
        series = {name: ("state", np.array([getattr(state, name) for state in states])) for name in names}
        series["approach"] = ("state", np.array([start.separation - state.separation for state in states]))
        back = (
            "state",
            np.arange(len(states)) >= len(approach),
            {"long_name": "whether it is of the retreat"},
        )
        curve = xr.Dataset(series, {"retreat": back})
        describe(curve, start)
        facts = {"title": "Bodies pulled apart", **attributes_of(start, retreat[-1].control)}
        return cls(
            curve.assign_attrs(facts),
            next(state for state in reversed(retreat) if state.area or state is start),
        )

    @property
    def force(self) -> float:
        """Pull-off force: the largest tension of the retreat, force; 0 where there is none."""
        return max(0.0, -float(self.curve["load"].values[self.curve["retreat"].values].min()))

    @property
    def energy_lost(self) -> float:
        """Work done over the approach and the retreat, energy: the area of the loop of load and approach.

        `InputError` through the load: what bodies lose that fly apart under a load is not known.
        """
        if self.curve.attrs["held"] != "separation":
            expected, advice = "a way through the separation", "asperity.pull(contact, through='separation')"
            raise InputError("energy_lost", expected=expected, got="one through the load", advice=advice)
        return float(np.trapezoid(self.curve["load"].values, self.curve["approach"].values))

    def __repr__(self) -> str:
        unit = self.curve["load"].attrs["units"] if self.curve.attrs["si"] else ""
        return (
            f"<Pull: {self.curve.sizes['state']} states, pull-off force {self.force:g} {unit}".rstrip() + ">"
        )
