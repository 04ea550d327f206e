"""Which sites touch, and since when: maps of the contact at several times."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from asperity.base import views
from asperity.base.readable import readable
from asperity.contact import Contact
from asperity.errors import InputError
from asperity.lattice import Field, Mask
from asperity.results.history import check_fields
from asperity.surfaces.prepare import of_body
from asperity.surfaces.provenance import lateral_unit
from asperity.surfaces.surface import measured_part

Number = TypeVar("Number", np.int8, np.float64)

_WINDOW = 160
"""Longest profile, sites, whose sites a figure resolves."""

_CLOSE = 128
"""Side of a close-up, sites, that a map resolves."""

_STILL = 1e-6  # part of the largest load by which one that stays may rise by rounding

_BAR = 0.4
"""Part of a map's width up to which a scale bar may be long."""


class SiteState(IntEnum):
    """A site, compared with the map of reference."""

    FREE = 0
    KEPT = 1
    NEW = 2
    LOST = 3


@dataclass(frozen=True, eq=False, repr=False)
class ContactMaps(views.Brief):
    """The contact at several times.

    Attributes
    ----------
    heights
        The rough surface before anything yielded, shape ``(n,)`` or ``(n, m)``; length. Of a mirrored scan,
        the scan alone.
    indentation
        Depth of permanent yielding in the last map of a history, same shape; length.
    times
        Hold times of the maps, shape ``(k,)``; the relaxed state, if known, comes last, at infinity.
    states
        `SiteState` of each site at each time, shape ``(k, n)`` or ``(k, n, m)``.
    surfaces
        u at each time, same shape; length.
    height_range
        Range of the color scale; see `color_range`.
    window
        First site, and site after the last, of the drawn part of a profile: the part with most contacts. The
        whole first axis of a surface.
    unit
        Unit of all heights, chosen to be readable; as in `asperity.figures.surface.SurfaceView`.
    reference
        Number of the map that states are compared with: the first; if its load is 0, the first after
        loading. No site is lost before it.
    copies
        Mirrored copies of which the surface consists; `heights` is one of them.
    pixel_size, length_unit
        Distance between sites along the last axis, or None, and its unit.
    aspect
        Distance between rows over that between columns.
    time_unit
        Unit of the times, "s", or "" where it is the user's own.
    """

    heights: Field
    indentation: Field
    times: Field
    states: NDArray[np.int8]
    surfaces: Field
    height_range: tuple[float, float]
    window: tuple[int, int]
    unit: str
    reference: int = 0
    copies: int = 1
    pixel_size: float | None = None
    length_unit: str = ""
    aspect: float = 1.0
    time_unit: str = ""

    @property
    def sites(self) -> int:
        """Sites of the rough body."""
        return int(np.isfinite(self.heights).sum())

    def area(self, number: int) -> int:
        """Sites in contact in one map."""
        return int(np.isin(self.states[number], (SiteState.KEPT, SiteState.NEW)).sum())

    def count(self, number: int, state: SiteState) -> int:
        """Sites of one state in one map."""
        return int((self.states[number] == state).sum())

    def sampled(self, side: int) -> NDArray[np.int8]:
        """Sample the states onto a coarser lattice; each cell takes the state of one site.

        Of the sites that touch in any map, every ``side**2``-th is taken, along a curve through the cells of
        ``side`` x ``side`` sites. So each state keeps its share, but for chance, and full cells are drawn.

        Returns
        -------
        ndarray of int8, shape ``(k, ceil(n / side), ceil(m / side))``
        """
        return self.coarsened(self.states, side, SiteState.FREE)

    def coarsened(self, fields: NDArray[Number], side: int, free: float) -> NDArray[Number]:
        """Give each cell the value of its site in `sampled`, or `free` if it has none.

        Parameters
        ----------
        fields
            One field a map, of any type, shape ``(k, n, m)``.
        side
            Sites along each side of a cell.
        free
            Value of a cell without contact.

        Returns
        -------
        ndarray of the same type, shape ``(k, ceil(n / side), ceil(m / side))``
        """
        n, m = self.heights.shape
        rows, columns = np.nonzero((self.states != SiteState.FREE).any(axis=0))
        order = np.argsort(_along_a_z_curve(rows // side, columns // side), kind="stable")
        order = order[side**2 // 2 :: side**2]
        rows, columns = rows[order], columns[order]
        cells = np.full((len(fields), -(-n // side), -(-m // side)), free, dtype=fields.dtype)
        cells[:, rows // side, columns // side] = fields[:, rows, columns]
        return cells

    def close_up(self) -> tuple[slice, slice]:
        """Find the square with most changes among adjacent squares of at most 128 sites a side."""
        side = min(_CLOSE, *self.heights.shape)
        rows, columns = (n // side for n in self.heights.shape)
        first = self.states[self.reference]
        seen = (self.states[self.reference :] != first).any(axis=0)
        seen = (seen if seen.any() else first == SiteState.KEPT)[: rows * side, : columns * side]
        best = int(np.argmax(seen.reshape(rows, side, columns, side).sum(axis=(1, 3))))
        row, column = side * (best // columns), side * (best % columns)
        return slice(row, row + side), slice(column, column + side)

    def scale_bar(self, sites: int) -> tuple[float, float, str] | None:
        """Choose a round length for the scale bar of a map of so many columns: sites, length, unit.

        None where the pixel size is unknown.
        """
        if self.pixel_size is None:
            return None
        unit, factor = readable(self.length_unit, _BAR * sites * self.pixel_size)
        longest = _BAR * sites * self.pixel_size * factor
        power = 10.0 ** math.floor(math.log10(longest))
        length = max(digit * power for digit in (1, 2, 5) if digit * power <= longest * (1 + 1e-9))
        return length / (self.pixel_size * factor), length, unit


def contact_maps(dataset: xr.Dataset) -> ContactMaps:
    """Compare the maps of a history with the first of them, or with the end of a loading from 0.

    Parameters
    ----------
    dataset
        The dataset of a `History` with fields (``fields_at``); with the relaxed state after `with_limit`.

    Raises
    ------
    InputError
        The history kept no fields.
    """
    check_fields(dataset)
    times = [float(t) for t in dataset["field_time"]]
    dataset = on_the_surface(dataset)
    touching = list(np.asarray(dataset["in_contact"], dtype=bool))
    surfaces = list(np.asarray(dataset["u"], dtype=np.float64))
    if "in_contact_relaxed" in dataset:
        times.append(float("inf"))
        touching.append(np.asarray(dataset["in_contact_relaxed"], dtype=bool))
        surfaces.append(np.asarray(dataset["u_relaxed"], dtype=np.float64))
    si = bool(dataset.attrs.get("si"))
    indentation = dataset["permanent_indentation"][-1] if "permanent_indentation" in dataset else 0.0
    return _maps_of(
        np.asarray(dataset["heights"], dtype=np.float64),
        np.asarray(indentation, dtype=np.float64),
        times,
        touching,
        surfaces,
        origin=json.loads(dataset.attrs.get("surface", "{}")),
        spacing=json.loads(dataset.attrs["spacing"]) if si else None,
        reference=loaded(dataset),
    )


def loaded(dataset: xr.Dataset) -> int:
    """Number of the first map; if its load is 0, of the first map after the load has risen."""
    forces = dataset.get("pressure", dataset.get("force"))
    if forces is None:
        return 0
    return end_of_loading(np.asarray(forces.sum([axis for axis in forces.dims if axis != "field_time"])))


def end_of_loading(load: Field) -> int:
    """Number of the first entry; if its load is 0, of the first after which the load does not rise."""
    if load[0] > 0:
        return 0
    rises = np.append(np.diff(load) > _STILL * load.max(), False)
    return int(np.argmin(rises)) if load.any() else 0


def on_the_surface(dataset: xr.Dataset) -> xr.Dataset:
    """Move the fields of a history that slides back above the heights of the dataset, to the nearest site.

    Fields stay with the elastic body while the rough surface slides under it.
    """
    axes = [axis for axis in ("y", "x") if f"field_shift_{axis}" in dataset.coords]
    moved = {}
    for name, field in dataset.data_vars.items():
        shifted_axes = [axis for axis in axes if axis in field.dims]
        if shifted_axes and "field_time" in field.dims:
            back = [
                frame.roll({axis: -round(float(frame[f"field_shift_{axis}"])) for axis in shifted_axes})
                for frame in field
            ]
            moved[name] = field.copy(data=np.stack(back))
    return dataset.assign(moved)


def maps_between(contact: Contact, since: Contact | None = None) -> ContactMaps:
    """Compare a contact with an earlier one, by default with itself; the times are unknown (NaN).

    `InputError` if the earlier one is of another surface.
    """
    both = (contact if since is None else since, contact)
    earlier, heights = (state.heights + state.permanent_indentation for state in both)
    if not np.allclose(earlier, heights, rtol=1e-12, atol=1e-12 * float(np.ptp(of_body(heights)))):
        raise InputError("since", expected="a contact of the same surface", got="one of other heights")
    return _maps_of(
        heights,
        contact.permanent_indentation,
        [math.nan] * 2,
        [state.in_contact for state in both],
        [state.u for state in both],
        origin=contact.surface,
        spacing=contact.lattice.spacing if contact.si else None,
    )


def _maps_of(
    heights: Field,
    indentation: Field,
    times: Sequence[float],
    touching: Sequence[Mask],
    surfaces: Sequence[Field],
    *,
    origin: Mapping[str, Any],
    spacing: Sequence[float] | None,
    reference: int = 0,
) -> ContactMaps:
    """Compare maps with one of them; `spacing` is given in metres, like all lengths then."""
    part = measured_part(heights.shape, origin)
    copies = heights.size
    indentation = np.broadcast_to(indentation, heights.shape)[part]
    touching, surfaces = [field[part] for field in touching], [field[part] for field in surfaces]
    heights = heights[part]
    size, lateral = origin.get("pixel_size") or None, str(origin.get("length_unit", ""))
    unit = str(origin.get("unit", "1"))
    if spacing is not None:
        size, lateral, unit = spacing, "m", "m"
    low, high = color_range(heights)
    unit, factor = readable(unit, high - low)
    states = states_since(touching[reference], np.stack(touching))
    states[:reference][states[:reference] == SiteState.LOST] = SiteState.FREE  # not touched yet
    return ContactMaps(
        heights=heights * factor,
        indentation=indentation * factor,
        times=np.asarray(times),
        states=states,
        reference=reference,
        surfaces=np.stack(surfaces) * factor,
        height_range=(low * factor, high * factor),
        window=_busiest(touching[-1]),
        unit=unit,
        copies=copies // heights.size,
        pixel_size=None if size is None else float(size[-1]),
        length_unit=lateral_unit(lateral, origin),
        time_unit="" if spacing is None else "s",
        aspect=1.0 if size is None else float(size[0] / size[-1]),
    )


def states_since(before: Mask, now: Mask) -> NDArray[np.int8]:
    """`SiteState` of each site, from whether it touched before, and touches now."""
    kinds = [SiteState.KEPT, SiteState.NEW, SiteState.LOST]
    return np.select([before & now, now, before], kinds, SiteState.FREE).astype(np.int8)


def color_range(heights: Field) -> tuple[float, float]:
    """Range of heights without the lowest and highest 0.3 %, so that spikes do not wash out a map."""
    low, high = np.percentile(heights[np.isfinite(heights)], (0.3, 99.7))
    return float(low), float(high)


def _along_a_z_curve(rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.int64]:
    """Morton codes of cells: the bits of row and column alternate, so near codes are near cells."""
    code = np.zeros_like(rows)
    for bit in range(int(max(rows.max(initial=0), columns.max(initial=0))).bit_length()):
        code |= (rows >> bit & 1) << (2 * bit + 1) | (columns >> bit & 1) << (2 * bit)
    return code


def _busiest(touching: Mask) -> tuple[int, int]:
    sites = touching.shape[0]
    if touching.ndim == 2 or sites <= _WINDOW:
        return 0, sites
    counts = np.convolve(touching.astype(np.int64), np.ones(_WINDOW, dtype=np.int64), mode="valid")
    start = int(np.argmax(counts))
    return start, start + _WINDOW
