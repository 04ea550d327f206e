"""Rows of steady sliding."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from asperity.analysis.rows import bodies_rows
from asperity.base.readable import written
from asperity.base.rows import Row


def rows_of(dataset: xr.Dataset) -> list[Row]:
    """Rows of a summary: the bodies, and the states at the ends of the speeds and of largest friction."""
    attrs = dataset.attrs
    unit = str(dataset["largest_pressure"].attrs["units"])
    unit = unit if unit == "Pa" else "1"
    friction = dataset["hysteresis_friction_coefficient"].values
    largest, fastest = int(np.argmax(friction)), friction.size - 1
    ends = "largest friction" if 0 < largest < fastest else "largest friction, at the end of the speeds"
    places = {"slowest": 0, ends: largest, "fastest": fastest}
    return [
        *bodies_rows(dataset.attrs),
        Row("pressure", attrs["load"] / attrs["nominal_area"], unit, note=" over the nominal area", digits=4),
        Row("direction", str(json.loads(attrs["direction"]))),
        Row("speeds", f"{friction.size}, each in its steady state"),
        *(Row(name, _words(dataset.isel(speed=place))) for name, place in places.items()),
        Row("heat", "left out: no flash temperature"),
        Row("residual", float(dataset["residual"].max()), note=" at most", digits=2),
    ]


def _words(state: xr.Dataset) -> str:
    """A state in words."""
    text = f"{written(float(state['speed']), str(state['speed'].attrs['units']))}: hysteresis friction "
    text += _with_band(state, "hysteresis_friction_coefficient")
    if "friction_coefficient" in state:
        text += f", {_with_band(state, 'friction_coefficient')} with shear strength"
    return f"{text}, contact fraction {_with_band(state, 'contact_fraction')}"


def _with_band(state: xr.Dataset, name: str) -> str:
    low, high = (float(state.get(f"{name}_{end}", np.nan)) for end in ("low", "high"))
    interval = (low, high) if f"{name}_low" in state else None
    return Row(name, float(state[name]), interval=interval, digits=4).words()
