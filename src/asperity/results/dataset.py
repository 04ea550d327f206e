"""One self-describing xarray Dataset from the frames of a creeping contact."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.frames import Frame
from asperity.base import checks
from asperity.base.version import __version__
from asperity.carried import Carried, record
from asperity.contact import Contact, Control
from asperity.contact.bodies import Bodies
from asperity.errors import InputError
from asperity.lattice import Lattice
from asperity.patches import QUANTILES, clustering_box, map_series, quantiles
from asperity.protocols import Leg
from asperity.protocols.legs import described, in_words
from asperity.results.parameters import Plain, plain, units_of_parameters
from asperity.results.quantities import describe, had_by, select, units_of
from asperity.solids import Solid

if TYPE_CHECKING:
    import xarray as xr

Moment = dict[str, float]
"""One entry of the time series: ``time`` and a value for each series."""


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Fields at one time, by name."""

    time: float
    fields: Mapping[str, NDArray[Any]]
    leg: int = 0
    shift: Sequence[float] = ()


def moment_of(frame: Frame, *, slides: bool = False, carried: Carried | None = None) -> Moment:
    """Entry of the time series from a frame."""
    row: Moment = {"time": frame.time, "leg": frame.leg, "exact": frame.exact} | {
        name: getattr(frame if hasattr(frame, name) else frame.contact, name)
        for name in had_by(frame.contact, "series", slides=slides)
    }
    if carried is None:
        return row
    if frame.ages is not None:
        row |= frame.ages.means(frame.contact)
    return row | record.quantities(carried, frame.contact)


def snapshot_of(frame: Frame, carried: Carried | None = None) -> Snapshot:
    """Fields of a frame."""
    contact = frame.contact
    fields = {name: getattr(contact, name) for name in had_by(contact, "field")}
    fields |= {} if carried is None else record.maps(carried, contact)
    fields |= {} if frame.ages is None else {"site_age": frame.ages.now.copy()}
    return Snapshot(frame.time, fields, frame.leg, [float(sites) for sites in frame.shift])


def dataset_of(
    start: Contact,
    control: Control,
    protocol: Sequence[Leg] | None,
    switches: Sequence[float],
    keeps_area: bool,
    rows: Sequence[Moment],
    snapshots: Sequence[Snapshot],
    *,
    rtol: float,
) -> xr.Dataset:
    """Gather the entries of a history, from time 0 on, and its fields into a Dataset.

    `control` is prescribed at the start. With a protocol, each entry has its leg, and legs begin and end at
    `switches`. Without one, `keeps_area` says whether the area is held.
    """
    import xarray as xr

    places = coordinates_of(start)
    slides = bool(rows) and "displacement" in rows[0]
    asked = [name for name in select("series", of=["carried", "friction"]) if rows and name in rows[0]]
    series = [*had_by(start, "series", slides=slides), *asked]
    dataset = xr.Dataset(
        data_vars={name: ("time", np.array([row[name] for row in rows])) for name in series},
        coords={"time": [row["time"] for row in rows], **places},
    )
    # Heights before yielding.
    rough = start.heights + start.permanent_indentation if start.solid.yields else start.heights
    dataset["heights"] = (*places,), rough
    if protocol is not None:
        dataset = dataset.assign_coords(leg=("time", [int(row["leg"]) for row in rows]))
    if snapshots:
        dataset = _with_fields(dataset, start, snapshots, slides=slides, legs=protocol is not None)
    describe_recorded(dataset, start)
    attributes = {"title": "Aging of a rough contact", "rtol": rtol, **attributes_of(start, control)}
    if keeps_area:
        attributes |= {"held": "area", "held_area": start.area}
    exact = {bool(row["exact"]) for row in rows if row["time"] > 0}
    if True in exact:
        attributes["exact_contact"] = "at all times" if exact == {True} else "at some times"
    if protocol is not None:
        legs = [described(leg) for leg in protocol]
        attributes |= {"protocol": json.dumps(legs), "protocol_in_words": in_words(legs)}
        attributes["switches"] = json.dumps(list(switches))
    return dataset.assign_attrs(attributes)


def _with_fields(
    dataset: xr.Dataset, start: Contact, snapshots: Sequence[Snapshot], *, slides: bool, legs: bool
) -> xr.Dataset:
    sites = dataset["heights"].dims
    dataset = dataset.assign_coords(field_time=[snapshot.time for snapshot in snapshots])
    for name in snapshots[0].fields:
        fields = np.stack([snapshot.fields[name] for snapshot in snapshots])
        branches = ("branch",) if fields.ndim > 1 + len(sites) else ()
        dataset[name] = (("field_time", *branches, *sites), fields)
    if "branch" in dataset.dims:
        dataset = dataset.assign_coords(branch=np.arange(dataset.sizes["branch"]))
    if legs:
        dataset = dataset.assign_coords(field_leg=("field_time", [each.leg for each in snapshots]))
    if slides:
        places = zip(sites, np.transpose([each.shift for each in snapshots]), strict=True)
        shifts = {f"field_shift_{axis}": ("field_time", place) for axis, place in places}
        dataset = dataset.assign_coords(shifts)
    return _with_patches(dataset, start, snapshots)


def _with_patches(dataset: xr.Dataset, start: Contact, snapshots: Sequence[Snapshot]) -> xr.Dataset:
    import xarray as xr

    maps, times = dataset["in_contact"].values, [snapshot.time for snapshot in snapshots]
    covered = np.isfinite(start.heights)
    body = None if covered.all() else covered
    series = map_series(maps, times, start.lattice, body)
    in_lengths = start.solid.in_lengths
    pressure = dataset["pressure"].values if in_lengths else dataset["force"].values / start.lattice.cell
    pressures = [quantiles(field[touching]) for field, touching in zip(pressure, maps, strict=True)]
    series["contact_pressure"] = np.array(pressures)
    box = clustering_box(maps, body)
    named = xr.Dataset(
        {name: (("field_time", "quantile")[: values.ndim], values) for name, values in series.items()},
        coords={"quantile": list(QUANTILES)},
    )
    if box is not None:
        named["clustering"].attrs["box"] = box
    return dataset.merge(named)


def coordinates_of(contact: Bodies) -> dict[str, NDArray[Any]]:
    """Coordinates of the sites along y and x, or x: lengths on a continuum, else numbers from 0."""
    lattice = contact.lattice
    steps = lattice.spacing if contact.solid.in_lengths else (1,) * lattice.dimension
    axes = zip(("y", "x")[-lattice.dimension :], steps, lattice.shape, strict=True)
    return {axis: step * np.arange(n) for axis, step, n in axes}


def describe_recorded(dataset: xr.Dataset, contact: Contact) -> None:
    """Add long names and units of all that is recorded of a contact."""
    recorded = had_by(contact, slides=True) | select(of=["carried", "friction"])
    describe(dataset, {name: quantity.facts for name, quantity in recorded.items()}, units_of(contact))


def attributes_of(contact: Contact, control: Control) -> dict[str, Plain]:
    """All parameters of the results; lists and tables also item by item."""
    items: dict[str, Plain] = {f"held_{control.name}": control.value}
    for name, value in contact.solid.parameters.items():
        items |= plain(name, value)
    return {
        "asperity_version": __version__,
        **attributes_of_solid(contact.solid),
        "si": int(contact.si),
        "spacing": json.dumps(contact.lattice.spacing),
        "edges": contact.lattice.edges,
        "held": control.name,
        **items,
        "sites": contact.sites,
        "heights_sha256": hashlib.sha256(np.ascontiguousarray(contact.heights).tobytes()).hexdigest(),
        "surface": json.dumps(dict(contact.surface)),
        **plain("surface", contact.surface),
        "parameter_units": units_of_parameters(items, units_of(contact)),
    }


def attributes_of_answer(
    title: str, solid: Solid, lattice: Lattice, surface: Mapping[str, Any]
) -> dict[str, str | float]:
    """Title, version, solid, lattice and surface of an answer that is no history."""
    return {
        "title": title,
        "asperity_version": __version__,
        **attributes_of_solid(solid),
        "edges": lattice.edges,
        "shape": json.dumps(lattice.shape),
        "spacing": json.dumps(lattice.spacing),
        "surface": json.dumps(dict(surface)),
    }


def check_answer(dataset: object, title: str, expected: str, advice: str) -> None:
    """`InputError` unless it is a dataset of this title."""
    import xarray as xr

    if checks.instance("dataset", dataset, xr.Dataset, advice).attrs.get("title") != title:
        raise InputError("dataset", expected=expected, got="another one", advice=advice)


def attributes_of_solid(solid: Solid) -> dict[str, str | float]:
    """Kind and parameters of a solid, as numbers or JSON."""
    numbers = solid.parameters.items()
    return {
        "solid": solid.kind,
        **{name: value if isinstance(value, float) else json.dumps(value) for name, value in numbers},
    }
