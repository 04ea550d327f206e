"""Each patch: size, shape and load in one map, and its fate from map to map."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from asperity.analysis.field_values import ONE_TIME, lattice_of, pressure_of
from asperity.base import views
from asperity.base.checks import kind_of
from asperity.contact import Contact
from asperity.errors import InputError
from asperity.lattice import Field, Lattice
from asperity.patches import Patches, Shapes, ages_of, linked, shapes_of
from asperity.results.history import check_fields
from asperity.results.quantities import describe, select, units_named, units_of

_PATCHES = {
    "size": ("sites of the patch", "sites"),
    "contact_area": ("area of the patch", "area"),
    "perimeter": ("length of its rim; on a line, its ends", "rim"),
    "aspect": ("its aspect ratio", "1"),
    "y": ("center of the patch along the first axis", "place"),
    "x": ("center of the patch along the last axis", "place"),
    "load": ("load that it carries", "force"),
    "mean_pressure": ("mean contact pressure in it", "pressure"),
    "largest_pressure": ("largest contact pressure in it", "pressure"),
    "map": ("number of the map, from 0", "1"),
    "time": ("hold time", "time"),
    "patch": ("number of the patch in its map, from 1, largest first", "1"),
    "track": ("number of the patch through time, from 0", "1"),
    "before": ("track of the patch in the map before", "1"),
    "after": ("track of the patch in this map", "1"),
    "shared": ("sites that both share", "sites"),
    "birth": ("time of the first map in which it is", "time"),
    "death": ("time of the first map in which it is no more", "time"),
    "origin": ("whether it was there in the first map, is new, or split off", ""),
    "parent": ("track from which it split off, or -1", "1"),
    "end": ("whether it is there in the last map, is gone, or merged", ""),
    "heir": ("track into which it merged, or -1", "1"),
    "maps": ("maps in which it is", "1"),
    "largest_size": ("its largest size", "sites"),
}
"""Long name and dimension of the columns."""

_FATES = {"birth": float, "death": float, "origin": str, "parent": int, "end": str, "heir": int}
_LASTING: dict[str, object] = {"death": math.nan, "end": "last map", "heir": -1}


@dataclass(frozen=True, eq=False, repr=False)
class PatchTracks(views.Brief):
    """The patches of a history, followed from map to map.

    A patch continues the patch of the map before with which it shares most sites, if this holds both ways.

    Attributes
    ----------
    patches
        Over ``entry``, every patch of every map: ``map``, ``time``, ``patch``, ``track``, and the columns of
        `patch_table`.
    links
        Over ``link``, each pair of patches of successive maps that share sites: ``map`` (the later), the
        tracks ``before`` and ``after``, and ``shared`` sites.
    tracks
        Over ``track``: ``birth``, ``death`` (NaN for those of the last map), ``origin`` (``"first map"``,
        ``"new"``, ``"split"``), ``parent``, ``end`` (``"last map"``, ``"gone"``, ``"merged"``), ``heir``,
        ``maps`` and ``largest_size``.
    """

    patches: xr.Dataset
    links: xr.Dataset
    tracks: xr.Dataset


def patch_table(image: Contact | xr.Dataset, connectivity: int = 1) -> xr.Dataset:
    """List the patches of one contact.

    Parameters
    ----------
    image
        A contact, or the dataset of a history with fields of one time (``dataset.isel(field_time=-1)``).
    connectivity
        As `patches` takes it.

    Returns
    -------
    Dataset
        Over ``patch``, from 1 on, largest first: ``size`` (sites), ``contact_area`` (continua),
        ``perimeter``, ``aspect`` (not on a line), the center ``y`` and ``x`` (``x`` on a line), ``load``,
        ``mean_pressure`` and ``largest_pressure``; with their units. Its
        ``to_dataframe().to_csv(...)`` writes a file.

    Raises
    ------
    InputError
        No contact and no dataset with fields of one time; a connectivity other than 1 or 2.
    """
    units: Mapping[str, str]
    pressure: Field
    if isinstance(image, Contact):
        lattice, touching, units = image.lattice, image.in_contact, units_of(image)
        in_lengths, pressure = image.solid.in_lengths, image.pressure
    elif isinstance(image, xr.Dataset) and image.get("in_contact", xr.DataArray()).ndim in (1, 2):
        lattice, touching = lattice_of(image), np.asarray(image["in_contact"], dtype=bool)
        units, in_lengths, pressure = _units(image), "pressure" in image, pressure_of(image)
    else:
        several = isinstance(image, xr.Dataset) and "field_time" in image.dims
        got = f"fields of {image.sizes['field_time']} times" if several else kind_of(image)
        expected = "a contact, or a dataset with fields of one time"
        raise InputError("image", expected=expected, got=got, advice=ONE_TIME)
    shapes = shapes_of(touching, lattice.spacing, lattice.edges, connectivity)
    columns = _columns(shapes, lattice, in_lengths, pressure)
    return _described(columns | {"patch": np.arange(1, shapes.patches.count + 1)}, "patch", units)


def patch_tracks(dataset: xr.Dataset, connectivity: int = 1) -> PatchTracks:
    """Follow the patches of a history from map to map.

    Parameters
    ----------
    dataset
        The dataset of a `History` that kept fields (``fields_at``).
    connectivity
        As `patches` takes it.

    Raises
    ------
    InputError
        The history kept no fields; a connectivity other than 1 or 2.
    """
    times, maps = _maps(dataset)
    lattice, units = lattice_of(dataset), _units(dataset)
    entries: list[dict[str, NDArray[Any]]] = []
    links: list[dict[str, NDArray[Any]]] = []
    fates: list[dict[str, object]] = []
    before = Patches(np.zeros(lattice.shape, dtype=np.int64), np.zeros(0, dtype=np.int64))
    numbers = np.empty(0, dtype=np.int64)
    for number, (time, touching) in enumerate(zip(times, maps, strict=True)):
        shapes = shapes_of(touching, lattice.spacing, lattice.edges, connectivity)
        link = linked(before, shapes.patches)
        track = np.append(numbers, -1)[link.continued - 1]
        fresh = np.flatnonzero(track < 0)
        track[fresh] = len(fates) + np.arange(fresh.size)
        for parent in np.append(numbers, -1)[link.main_predecessor[fresh] - 1].tolist():
            origin = "split" if parent >= 0 else "new" if number else "first map"
            fates.append({"birth": time, "origin": origin, "parent": parent} | _LASTING)
        for place in np.flatnonzero(~np.isin(numbers, track)):
            heir = int(np.append(track, -1)[link.main_successor[place] - 1])
            end = "merged" if heir >= 0 else "gone"
            fates[numbers[place]] |= {"death": time, "end": end, "heir": heir}
        earlier, after = link.pairs.T - 1
        pairs = {"before": numbers[earlier], "after": track[after], "shared": link.shared}
        links.append({"map": np.full(earlier.size, number)} | pairs)
        pressure = pressure_of(dataset.isel(field_time=number))
        entry = {"map": np.full(track.size, number), "time": np.full(track.size, time)}
        entry |= {"patch": np.arange(1, track.size + 1), "track": track}
        entries.append(entry | _columns(shapes, lattice, "pressure" in dataset, pressure))
        before, numbers = shapes.patches, track
    everything = _joined(entries)
    largest = np.zeros(len(fates), dtype=np.int64)
    np.maximum.at(largest, everything["track"], everything["size"])
    tracks = {
        "track": np.arange(len(fates)),
        **{name: np.array([fate[name] for fate in fates], dtype=kind) for name, kind in _FATES.items()},
        "maps": np.bincount(everything["track"], minlength=len(fates)),
        "largest_size": largest,
    }
    return PatchTracks(
        patches=_described(everything, "entry", units),
        links=_described(_joined(links), "link", units),
        tracks=_described(tracks, "track", units),
    )


def contact_ages(dataset: xr.Dataset) -> xr.DataArray:
    """Time for which each site has touched without interruption, from the maps of a history.

    Parameters
    ----------
    dataset
        The dataset of a `History` that kept fields (``fields_at``).

    Returns
    -------
    DataArray
        Over ``field_time`` and the sites: the time since the first of the successive maps in all of which
        the site is in contact; 0 in the first map. NaN off contact.

    Raises
    ------
    InputError
        The history kept no fields.
    """
    times, maps = _maps(dataset)
    age = select("map")["contact_age"]
    attributes = {"long_name": age.long_name, "units": _units(dataset).get(age.dimension, "")}
    return dataset["in_contact"].copy(data=ages_of(maps, times.tolist())).assign_attrs(attributes)


def _columns(shapes: Shapes, lattice: Lattice, in_lengths: bool, pressure: Field) -> dict[str, NDArray[Any]]:
    sizes = shapes.patches.sizes
    columns: dict[str, NDArray[Any]] = {"size": sizes}
    if in_lengths:
        columns["contact_area"] = sizes * lattice.cell
    columns["perimeter"] = shapes.perimeter
    if lattice.dimension == 2:
        columns["aspect"] = shapes.aspect
    columns |= dict(zip(("y", "x")[2 - lattice.dimension :], shapes.center.T, strict=True))
    values = pressure.ravel()[shapes.sites]
    total = np.bincount(shapes.numbers, values, minlength=sizes.size + 1)[1:]
    largest = np.zeros(sizes.size)
    np.maximum.at(largest, shapes.numbers - 1, values)
    columns |= {"load": total * lattice.cell, "mean_pressure": total / sizes, "largest_pressure": largest}
    return columns


def _maps(dataset: xr.Dataset) -> tuple[Field, NDArray[np.bool_]]:
    check_fields(dataset)
    return np.asarray(dataset["field_time"], dtype=np.float64), np.asarray(dataset["in_contact"], dtype=bool)


def _units(dataset: xr.Dataset) -> Mapping[str, str]:
    return units_named(
        {str(name): var.attrs["units"] for name, var in dataset.variables.items() if "units" in var.attrs}
    )


def _joined(parts: list[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _described(columns: Mapping[str, NDArray[Any]], dimension: str, units: Mapping[str, str]) -> xr.Dataset:
    table = xr.Dataset({name: (dimension, values) for name, values in columns.items()})
    describe(table, _PATCHES, units)
    return table
