"""Records of simulated contacts that slid."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from asperity.ask.strength import ShearStrength
from asperity.base import checks
from asperity.errors import InputError
from asperity.friction.records import Record, after_slips
from asperity.results.tabor import add_friction

if TYPE_CHECKING:
    from asperity.results import History


def record_of(
    history: History | xr.Dataset | Path | str,
    *,
    shear_strength: ShearStrength | float | str | None = None,
) -> Record:
    """Take the record of a history in which the contact slid.

    It is a `History`, its dataset, or the folder where one is saved. Without a series ``friction`` it needs
    the shear strength of `add_friction`.

    Friction at rest is the strength. `InputError` if the contact never slid, or the strength is missing.
    """
    dataset, source = _dataset(history)
    if "displacement" not in dataset or not (dataset["displacement"] > 0).any():
        advice = "a protocol with legs that slide, such as 'slide distance=8 velocity=5'"
        raise InputError("history", expected="one in which the contact slides", got="none", advice=advice)
    if np.isinf(dataset["velocity"]).any():
        expected = "slides at finite velocities, as the age of contacts has no time to change otherwise"
        raise InputError("history", expected=expected, got="a slide at once")
    if shear_strength is not None:
        dataset = add_friction(dataset, shear_strength)
    if "friction" not in dataset:
        expected = "the shear strength of the contacts, as the history has no series 'friction'"
        raise InputError("shear_strength", expected=expected, got="none", cure={"shear_strength": 1.0})
    si = dataset["load"].attrs.get("units") in ("N", "N/m")
    # From the contact, as a run of a campaign keeps no heights.
    nominal_area = (dataset["contact_area"] / dataset["contact_fraction"]).max() if si else math.nan
    slides = dataset.isel(time=np.isfinite(dataset["time"].values))  # not the relaxed state
    slides = slides.isel(time=~after_slips(slides["time"].values, slides["displacement"].values))
    time = slides["time"].values
    return Record.of_displacement(
        time,
        # The slide goes on between shifts, where there may be states.
        np.cumsum(slides["velocity"].values * np.diff(time, prepend=time[0])),
        slides["friction"].values,
        strength_at_rest=True,
        a=None if dataset.attrs.get("rate_coefficient") else 0.0,
        si=si,
        normal_stress=float(dataset["load"].mean() / nominal_area) if si else None,
        source=source,
    )


def _dataset(history: object) -> tuple[xr.Dataset, str]:
    """The dataset of a history, and the folder of a saved one."""
    from asperity.results import History, load  # late, as they bring the solvers

    if isinstance(history, Path | str):
        return load(history), str(Path(history))
    if isinstance(history, History):
        return history.dataset, ""
    return checks.instance("history", history, xr.Dataset, "asperity.age(contact, times, protocol=...)"), ""
