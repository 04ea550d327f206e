"""Distributions of gaps, pressures and sizes of patches at the times of the maps."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np
import xarray as xr

from asperity.lattice import Field, Lattice
from asperity.patches import patches
from asperity.results.history import check_fields

ONE_TIME = "dataset.isel(field_time=-1), of a history with fields_at=[...]"
"""Advice for a dataset with maps of several times, or of none."""


@dataclass(frozen=True, eq=False)
class Distribution:
    """Sorted values at one time, rising: the k-th of n is exceeded by n - k.

    Attributes
    ----------
    time
        Hold time.
    gap
        Height of the elastic surface above the rough one, at each site off contact, length.
    pressure
        Contact pressure at each site in contact; None for solids that are defined on sites.
    patch
        Sites of each patch of contact.
    sites
        Sites of the rough body.
    """

    time: float
    gap: Field
    pressure: Field | None
    patch: Field
    sites: int


def distributions(dataset: xr.Dataset) -> list[Distribution]:
    """Sort gaps, pressures and sizes of patches at each time at which fields were kept.

    Parameters
    ----------
    dataset
        The dataset of a `History`.

    Returns
    -------
    list of Distribution

    Raises
    ------
    InputError
        The history kept no fields.
    """
    check_fields(dataset)
    at_times = []
    for number, time in enumerate(dataset["field_time"].values.tolist()):
        fields = dataset.isel(field_time=number)
        touching = np.asarray(fields["in_contact"], dtype=bool)
        gap = np.sort(np.asarray(fields["u"] - _rough(fields))[~touching])
        gap = gap[np.isfinite(gap)]
        pressure = np.sort(np.asarray(fields["pressure"])[touching]) if "pressure" in fields else None
        sizes = patches(touching, edges=dataset.attrs.get("edges", "periodic")).sizes[::-1]
        patch, sites = sizes.astype(np.float64), int(touching.sum()) + gap.size
        at_times.append(Distribution(time, gap, pressure, patch, sites))
    return at_times


def lattice_of(dataset: xr.Dataset) -> Lattice:
    """The lattice of a dataset; one that does not say is periodic, its spacing 1."""
    shape = dataset["heights"].shape
    spacing = json.loads(dataset.attrs.get("spacing", json.dumps([1.0] * len(shape))))
    return Lattice(shape, tuple(spacing), dataset.attrs.get("edges", "periodic"))


def cell_of(dataset: xr.Dataset) -> float:
    """Area of a site, m^2, or of a profile its length, m; 1 in a history without SI units."""
    return lattice_of(dataset).cell if dataset.attrs.get("si") else 1.0


def comparable_area(dataset: xr.Dataset) -> tuple[Field, str]:
    """Contact area at each time to compare with measurements, m^2 or sites, and what it is called.

    It is corrected for pixel rims where there are such.
    """
    name = "contact_area_corrected"
    if dataset.attrs.get("si") and name in dataset:
        return np.asarray(dataset[name]), "corrected"
    return cell_of(dataset) * dataset["area"].values, "computed"


def _rough(fields: xr.Dataset) -> Field:
    """Heights of the rough surface where they are in one map: slid, and lower where it has yielded."""
    heights = np.asarray(fields["heights"], dtype=np.float64)
    if "field_shift_y" in fields.coords or "field_shift_x" in fields.coords:
        axes = ("y", "x")[-heights.ndim :]
        heights = lattice_of(fields).shifted(heights, [float(fields[f"field_shift_{axis}"]) for axis in axes])
    if "permanent_indentation" in fields:
        heights = heights - np.asarray(fields["permanent_indentation"], dtype=np.float64)
    return heights


def pressure_of(fields: xr.Dataset) -> Field:
    """Contact pressure of one map; of a solid that is defined on sites the force of each."""
    return np.asarray(fields["pressure" if "pressure" in fields else "force"], dtype=np.float64)
