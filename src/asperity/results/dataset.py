"""One self-describing xarray Dataset from the frames of a creeping contact."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence

import numpy as np
import xarray as xr

from asperity._version import __version__
from asperity.aging.creep import Frame
from asperity.contact.controls import Load
from asperity.contact.state import Contact

SERIES: dict[str, tuple[str, str]] = {
    "area": ("real contact area", "sites"),
    "contact_fraction": ("real contact area over nominal area", "1"),
    "load": ("normal load, the sum of the contact forces", "stiffness unit * height unit"),
    "separation": ("separation, the mean of u0", "height unit"),
    "approach": ("rigid approach of the bodies since the start", "height unit"),
    "energy": ("elastic energy", "stiffness unit * height unit^2"),
    "residual": ("largest force off contact over the mean contact force", "1"),
    "steps": ("time steps since the previous entry", "1"),
    "rejected": ("time steps repeated with a smaller length since the previous entry", "1"),
    "iterations": ("conjugate-gradient iterations since the previous entry", "1"),
}
FIELDS: dict[str, tuple[str, str]] = {
    "u": ("height of the elastic surface", "height unit"),
    "u0": ("creeping shape of the elastic surface", "height unit"),
    "in_contact": ("whether the site is in contact", "1"),
}
_TIME_UNIT = "1 / (stiffness unit * R unit)"


def dataset_of(frames: Sequence[Frame], snapshots: Sequence[Frame], *, rtol: float) -> xr.Dataset:
    """Gather frames into a Dataset.

    Parameters
    ----------
    frames
        The moments of the time series; the first is at time 0.
    snapshots
        The moments whose fields are kept; may be empty.
    rtol
        The tolerance to record.
    """
    first = frames[0].contact
    sites = ("y", "x")[2 - first.heights.ndim :]
    dataset = xr.Dataset(
        data_vars={name: ("time", np.array([_value(frame, name) for frame in frames])) for name in SERIES},
        coords={"time": [frame.time for frame in frames]}
        | {axis: np.arange(n) for axis, n in zip(sites, first.heights.shape, strict=True)},
    )
    dataset["heights"] = (sites, first.heights)
    if snapshots:
        dataset = dataset.assign_coords(field_time=[frame.time for frame in snapshots])
        for name in FIELDS:
            fields = np.stack([getattr(frame.contact, name) for frame in snapshots])
            dataset[name] = (("field_time", *sites), fields)
    _describe(dataset)
    return dataset.assign_attrs(_attributes(first, rtol))


def _value(frame: Frame, name: str) -> float | int:
    if name == "contact_fraction":
        return frame.contact.area / frame.contact.heights.size
    owner = frame if name in ("approach", "steps", "rejected", "iterations") else frame.contact
    value: float | int = getattr(owner, name)
    return value


def _describe(dataset: xr.Dataset) -> None:
    """Give every variable its long name and unit."""
    others = {
        "time": ("hold time", _TIME_UNIT),
        "field_time": ("hold time at which fields were kept", _TIME_UNIT),
        "x": ("site index along the last axis", "lattice spacing"),
        "y": ("site index along the first axis", "lattice spacing"),
        "heights": ("height of the rigid rough surface", "height unit"),
    }
    for name, (long_name, unit) in (SERIES | FIELDS | others).items():
        if name in dataset.variables:
            dataset[name].attrs.update(long_name=long_name, units=unit)


def _attributes(contact: Contact, rtol: float) -> dict[str, str | float | int]:
    """Every parameter that the results depend on."""
    held = "load" if isinstance(contact.control, Load) else "separation"
    return {
        "title": "Aging of a rough contact",
        "asperity_version": __version__,
        **dict(contact.solid.parameters),
        "held": held,
        f"held_{held}": contact.control.value,
        "rtol": rtol,
        "sites": contact.heights.size,
        "heights_sha256": hashlib.sha256(np.ascontiguousarray(contact.heights).tobytes()).hexdigest(),
        "surface": json.dumps(dict(contact.surface)),
    }
