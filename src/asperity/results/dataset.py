"""One self-describing xarray Dataset from the frames of a creeping contact."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from asperity._version import __version__
from asperity.aging.march import Frame
from asperity.contact.controls import Control
from asperity.contact.state import Contact
from asperity.lattice import Field, Mask
from asperity.protocols import Leg, described

SERIES: dict[str, tuple[str, str]] = {
    "area": ("real contact area", "sites"),
    "contact_fraction": ("real contact area over nominal area", "1"),
    "load": ("normal load, the sum of the contact forces", "stiffness unit * height unit"),
    "separation": ("separation, the mean of u0", "height unit"),
    "approach": ("rigid approach of the bodies since the start", "height unit"),
    "energy": ("elastic energy", "stiffness unit * height unit^2"),
    "residual": ("largest force off contact over the residual scale", "1"),
    "residual_scale": (
        "mean contact force, or where the load has died out the smallest that the heights resolve",
        "stiffness unit * height unit",
    ),
    "steps": ("time steps since the previous entry", "1"),
    "rejected": ("time steps repeated with a smaller length since the previous entry", "1"),
    "iterations": ("iterations of the contact solver since the previous entry", "1"),
}
FIELDS: dict[str, tuple[str, str]] = {
    "u": ("height of the elastic surface", "height unit"),
    "u0": ("creeping shape of the elastic surface", "height unit"),
    "in_contact": ("whether the site is in contact", "1"),
}
LEG = "leg of the history, from 0"
TIME_UNIT = "1 / (stiffness unit * R unit)"


Row = dict[str, float]
"""One entry of the time series: ``time`` and a value for each of `SERIES`."""


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The fields at one time."""

    time: float
    u: Field
    u0: Field
    in_contact: Mask
    leg: int = 0


def row_of(frame: Frame) -> Row:
    """Take the entry of the time series from a frame."""
    return {"time": frame.time, "leg": frame.leg, "exact": frame.exact} | {
        name: _value(frame, name) for name in SERIES
    }


def snapshot_of(frame: Frame) -> Snapshot:
    """Take the fields from a frame."""
    contact = frame.contact
    return Snapshot(frame.time, contact.u, contact.u0, contact.in_contact, frame.leg)


def dataset_of(
    start: Contact,
    control: Control,
    protocol: Sequence[Leg] | None,
    keeps_area: bool,
    rows: Sequence[Row],
    snapshots: Sequence[Snapshot],
    *,
    rtol: float,
) -> xr.Dataset:
    """Gather a history into a Dataset.

    Parameters
    ----------
    start
        The contact from which it started.
    control
        What was prescribed at the start.
    protocol
        The history, if it was not just one hold; then every entry says to which leg it belongs.
    keeps_area
        Whether, without a protocol, the area was held.
    rows
        The time series; the first is at time 0.
    snapshots
        The moments whose fields are kept; may be empty.
    rtol
        The tolerance to record.
    """
    sites = ("y", "x")[2 - start.heights.ndim :]
    dataset = xr.Dataset(
        data_vars={name: ("time", np.array([row[name] for row in rows])) for name in SERIES},
        coords={"time": [row["time"] for row in rows]}
        | {axis: np.arange(n) for axis, n in zip(sites, start.heights.shape, strict=True)},
    )
    dataset["heights"] = (sites, start.heights)
    if protocol is not None:
        dataset = dataset.assign_coords(leg=("time", [int(row["leg"]) for row in rows]))
    if snapshots:
        dataset = dataset.assign_coords(field_time=[snapshot.time for snapshot in snapshots])
        several = len(start.anchors) != 1
        for name in FIELDS:
            axes = ("branch",) if name == "u0" and several else ()
            fields = np.stack([getattr(snapshot, name) for snapshot in snapshots])
            dataset[name] = (("field_time", *axes, *sites), fields)
        if protocol is not None:
            legs = [snapshot.leg for snapshot in snapshots]
            dataset = dataset.assign_coords(field_leg=("field_time", legs))
    _describe(dataset)
    attributes = _attributes(start, control, rtol)
    if keeps_area:
        attributes |= {"held": "area", "held_area": start.area}
    exact = {bool(row["exact"]) for row in rows if row["time"] > 0}
    if True in exact:
        attributes["exact_contact"] = "at all times" if exact == {True} else "at some times"
    if protocol is not None:
        attributes["protocol"] = json.dumps([described(leg) for leg in protocol])
    return dataset.assign_attrs(attributes)


def _value(frame: Frame, name: str) -> float:
    if name == "contact_fraction":
        return frame.contact.area / frame.contact.heights.size
    owner = frame if hasattr(frame, name) else frame.contact
    value: float = getattr(owner, name)
    return value


def _describe(dataset: xr.Dataset) -> None:
    """Give every variable its long name and unit."""
    others = {
        "time": ("hold time", TIME_UNIT),
        "field_time": ("hold time at which fields were kept", TIME_UNIT),
        "leg": (LEG, "1"),
        "field_leg": ("leg of the history in which fields were kept, from 0", "1"),
        "x": ("site index along the last axis", "lattice spacing"),
        "y": ("site index along the first axis", "lattice spacing"),
        "heights": ("height of the rigid rough surface", "height unit"),
    }
    for name, (long_name, unit) in (SERIES | FIELDS | others).items():
        if name in dataset.variables:
            dataset[name].attrs.update(long_name=long_name, units=unit)


def _attributes(contact: Contact, control: Control, rtol: float) -> dict[str, str | float | int]:
    """Every parameter that the results depend on."""
    return {
        "title": "Aging of a rough contact",
        "asperity_version": __version__,
        **{name: _recorded(value) for name, value in contact.solid.parameters.items()},
        "held": control.name,
        f"held_{control.name}": control.value,
        "rtol": rtol,
        "sites": contact.heights.size,
        "heights_sha256": hashlib.sha256(np.ascontiguousarray(contact.heights).tobytes()).hexdigest(),
        "surface": json.dumps(dict(contact.surface)),
    }


def _recorded(value: object) -> str | float:
    """A parameter as an attribute: a number, or JSON."""
    return value if isinstance(value, float) else json.dumps(value)
