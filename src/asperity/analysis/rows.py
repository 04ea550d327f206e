"""Rows of a summary of a contact or a history, which terminal, cards and page only format."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from asperity.analysis.aging import AgingSummary, summary_of
from asperity.analysis.field_values import cell_of
from asperity.analysis.legs import leg_table, numbers_of
from asperity.base import views
from asperity.base.readable import readable, written
from asperity.base.rows import Row
from asperity.base.words import counted, thousands, to_digits
from asperity.contact import Contact
from asperity.errors import ConvergenceError, InputError
from asperity.fits import growth_rate
from asperity.results.history import History
from asperity.results.quantities import select, units_of
from asperity.surfaces.provenance import understood

_MOST_LEGS = 20
"""Legs of a history that are listed."""


@views.defines(Contact.rows)
def contact_rows(contact: Contact, /) -> list[Row]:
    """Rows of one contact."""
    units = units_of(contact) if contact.si else {}
    dimensions = {"load": "force", "separation": "length"}
    if contact.solid.in_lengths:
        dimensions |= {"contact_area": "area", "mean_pressure": "pressure", "largest_pressure": "pressure"}
    rows = [_extent("contact", contact.area, contact.sites)]
    for name, dimension in dimensions.items():
        value, unit = getattr(contact, name), units.get(dimension, "1")
        rows.append(Row(name.replace("_", " "), value, unit, digits=4, brief=True))
    return rows


@views.defines(History.rows)
def _rows(history: History, /) -> list[Row]:
    return history_rows(history.dataset, summary_of(history.dataset))


def surface_rows(origin: Mapping[str, Any], shape: Iterable[int], meters: Iterable[float] = ()) -> list[Row]:
    """Rows on a surface: its file, its pixels and perhaps their sides, and how the file was understood."""
    sides = " x ".join(written(side, "m") for side in meters)
    pixels = f"{' x '.join(map(str, shape))} pixels{' of ' * bool(sides)}{sides}"
    return [Row("surface", f"{origin.get('file') or 'surface'}: {pixels}"), *understood(origin)]


def bodies_rows(attrs: Mapping[str, Any]) -> list[Row]:
    """Rows on surface and solid, from the attributes of a law or of a slide."""
    modulus = f", E* = {written(attrs['modulus'], 'Pa')}" if "modulus" in attrs else ""
    return [
        *surface_rows(json.loads(attrs["surface"]), json.loads(attrs["shape"])),
        Row("solid", f"{str(attrs['solid']).replace('_', ' ')}{modulus}"),
    ]


def history_rows(dataset: xr.Dataset, summary: AgingSummary | None) -> list[Row]:
    """Rows of a history; without a summary, leg by leg."""
    rows = _legs(dataset) if summary is None else _growth(dataset, summary)
    if "area_observed" in dataset:
        seen = dataset["area_observed"]
        times, areas = seen["field_time"].values.tolist(), seen.values.tolist()
        ends = dict.fromkeys((0, seen.size - 1))
        unit = seen.attrs["units"]
        rows += [Row(f"observed at t = {times[n]:g}", areas[n], unit, digits=5) for n in ends]
    return [*rows, *friction_rows(dataset), *carried_rows(dataset), worst_residual(dataset)]


def friction_rows(dataset: xr.Dataset) -> list[Row]:
    """How friction grew in the last decade of each hold, by the area and by the strength.

    Between both ends the change of mu = s q, with q = A / F_N, is that of q at the mean s, and that of s at
    the mean q; each is divided by that of ln t.
    """
    rows = []
    for leg in leg_table(dataset) if "friction_by_area" in dataset else ():
        since = dataset["time"].values - leg.begin
        in_leg, tenth = numbers_of(dataset) == leg.number, (0.1 - 1e-9) * (leg.end - leg.begin)
        late = in_leg & (since >= tenth) & (since > 0) & (dataset["load"].values > 0)
        if not leg.leg.rests or np.count_nonzero(late) < 2:
            continue
        ends = np.flatnonzero(late)[[0, -1]]
        mu, s = (dataset[name].values[ends] for name in ("friction", "strength_mean"))
        lapse = float(np.log(since[ends[1]] / since[ends[0]]))
        parts = np.diff(mu / s)[0] * s.mean() / lapse, np.diff(s)[0] * (mu / s).mean() / lapse
        times = " to ".join(_time(dataset, float(time)) for time in since[ends])
        area, strength = (f"{round(float(part), 6):.3g}" for part in parts)
        note = f" an e-fold of time: {area} by the area, {strength} by the strength, t = {times}"
        name = "growth of friction"
        if "protocol" in dataset.attrs:  # contacts grow like the logarithm of the time since the last switch
            name, note = f"{name}, leg {leg.number}", f"{note} since the leg began"
        rows.append(Row(name, float(sum(parts)), note=note, digits=3, brief=True))
    return rows


def worst_residual(dataset: xr.Dataset) -> Row:
    """The largest residual of all times, and the steps that they took."""
    exact = dataset.attrs.get("exact_contact") == "at all times"
    effort = "exact contact" if exact else f"{int(dataset['steps'].sum())} time steps"
    effort += f", {int(dataset['iterations'].sum())} iterations"
    worst = f"{float(dataset['residual'].max()):.1e} of the mean contact force"
    return Row("worst residual", worst, note=f"; {effort}", brief=True)


def carried_rows(dataset: xr.Dataset) -> list[Row]:
    """Carried quantities, at the first and the last time."""
    rows = []
    for name, quantity in select("series", of=["carried"]).items():
        if name in dataset:
            unit = str(dataset[name].attrs["units"])
            bands = [_band(dataset, name, unit, n) for n in (0, -1)]
            note = f"{bands[0]} at first, {written(float(dataset[name][-1]), unit)}{bands[1]} at last"
            rows.append(Row(quantity.label, float(dataset[name][0]), unit, note=note, digits=4))
    return rows


def _band(dataset: xr.Dataset, name: str, unit: str, at: int) -> str:
    """The 95 % band of a quantity, if it has one there."""
    if f"{name}_low" not in dataset or np.isnan(dataset[f"{name}_low"][at]):
        return ""
    low, high = (written(float(dataset[f"{name}_{end}"][at]), unit) for end in ("low", "high"))
    return f" ({low} to {high})"


def _first(dataset: xr.Dataset, name: str, digits: int) -> str:
    return written(float(dataset[name][0]), dataset[name].attrs["units"], digits)


def _time(dataset: xr.Dataset, time: float) -> str:
    return f"{time:g} s" if dataset["time"].attrs["units"] == "s" else f"{time:g}"


def _extent(name: str, area: int, sites: int, first: int = 0, cell: float = 0.0, unit: str = "1") -> Row:
    """An area: sites, part of all sites, ratio to the first area; with a cell its area comes first."""
    ratio = f", A/A(0) = {area / first:.4f}" if first and area != first else ""
    part = f"{area} of {sites} sites = {100 * area / sites:.4g} %{ratio}"
    if cell:
        return Row(name, area * cell, unit, note=f": {part}", digits=4, brief=True)
    return Row(name, part, brief=True)


def _growth(dataset: xr.Dataset, summary: AgingSummary) -> list[Row]:
    si, held = bool(dataset.attrs["si"]), str(dataset.attrs["held"])
    cell = cell_of(dataset) if si else 0.0
    square = dataset["contact_area"].attrs["units"] if si else "1"

    def contact(when: str, area: int) -> Row:
        return _extent(f"contact {when}", area, summary.sites, summary.initial_area, cell, square)

    value = written(float(dataset.attrs[f"held_{held}"]), dataset[held].attrs["units"], 8)
    prescribed = Row("prescribed", f"{held} {value}", brief=True)
    rows = [prescribed, *_loads(dataset, summary), contact("at t = 0", summary.initial_area)]
    if "mean_contact_pressure" in dataset:
        mean, most = (_first(dataset, name, 4) for name in ("mean_contact_pressure", "largest_pressure"))
        rows.append(Row("pressure at t = 0", f"{mean} mean over the contacts, {most} at most"))
    rows += yielding_rows(dataset)
    if summary.time.size:
        at = f"at t = {_time(dataset, summary.time[-1])}"
        rows.append(contact(at, int(dataset["area"][-1])))
    if summary.relaxed_ratio is not None:
        rows.append(contact("relaxed", int(dataset.attrs["relaxed_area"])))
    rows += _fit(summary)
    try:
        rate = growth_rate(dataset["time"].values, dataset["area"].values.astype(np.float64))
    except (InputError, ConvergenceError):  # too few times
        return rows
    decade, unit = 100 * math.log(10), "% of A(0) per decade"
    low, high = (decade * end for end in rate.interval("B"))
    times = " to ".join(_time(dataset, time) for time in (rate.first, rate.last))
    bends = "; the curve bends, so that this is a mean" if rate.straight is False else ""
    note, interval = f", t = {times}{bends}", (low, high) if low < high else None
    return [*rows, Row("growth", decade * rate.B, unit, interval, note, digits=3, brief=True)]


def _loads(dataset: xr.Dataset, summary: AgingSummary) -> list[Row]:
    """Load at the beginning; at a held separation also its change."""
    first, unit = summary.initial_load, dataset["load"].attrs["units"]
    whole = first or math.nan  # solids that just touch bear nothing
    rows = [] if summary.load is None else [Row("load at t = 0", first, unit)]
    if "mean_contact_pressure" in dataset:
        area = float(dataset["contact_area"][0] / dataset["contact_fraction"][0])
        pressure = dataset["mean_contact_pressure"].attrs["units"]
        note = " over the nominal area"
        rows.append(Row("mean pressure", first / area, pressure, note=note, digits=4, brief=True))
    if summary.load is None:
        return rows
    loads = {"load relaxed": summary.relaxed_load}
    if summary.time.size:
        loads = {f"load at t = {_time(dataset, summary.time[-1])}": float(summary.load[-1]), **loads}
    return rows + [
        Row(name, load, unit, note=f", load/load(0) = {to_digits(load / whole, 4)}", brief=True)
        for name, load in loads.items()
        if load is not None
    ]


def yielding_rows(dataset: xr.Dataset) -> list[Row]:
    """Sites at the hardness; with maps also the permanent indentation."""
    if "yielding_area" not in dataset:
        return []
    first, last = (int(dataset["yielding_area"][at]) for at in (0, -1))
    text = f"{counted(first, 'site')} at t = 0, {thousands(last)} at the end"
    if "permanent_indentation" in dataset:
        lower = dataset["permanent_indentation"][-1]
        text += f"; lowered for good: {counted(int((lower > 0).sum()), 'site')}"
        if (lower > 0).any():
            text += f", by up to {written(float(lower.max()), lower.attrs['units'])}"
    return [Row("yielding", text)]


def _fit(summary: AgingSummary) -> list[Row]:
    fit = summary.fit
    if fit is None:
        return [Row("fit", summary.fit_note)] if summary.fit_note else []
    relaxed = summary.relaxed_ratio is not None
    a = ", A(relaxed)/A(0), exact" if relaxed else ", extrapolated: no relaxed state is known"
    misfit = f"{100 * fit.rms_residual:.2g} % rms, {100 * summary.fit_worst:.2g} % at worst"
    rows = [
        Row("fit", "A/A(0) = a - (a - 1) / (1 + t/t0)^q"),
        Row("  a", fit.a, note=a, digits=5 if relaxed else 3),
        Row("  q", fit.q, digits=3),
        Row("  t0", fit.t0, digits=3),
        Row("  (a - 1) q", fit.C, digits=3),
        Row("  misfit", misfit),
    ]
    return [*rows, Row("  note", summary.fit_note)] if summary.fit_note else rows


def _legs(dataset: xr.Dataset) -> list[Row]:
    table, unit = leg_table(dataset), dataset["load"].attrs["units"]
    begun = _areas(dataset, float(dataset["area"][0]))
    rows = [Row("contact at t = 0", f"{begun} at load {_first(dataset, 'load', 6)}", brief=True)]
    rows += yielding_rows(dataset)
    for row in table[:_MOST_LEGS]:
        at = f"t = {_time(dataset, row.begin)}"
        at += f" to {_time(dataset, row.end)}" if row.begin != row.end else ""
        loads = " to ".join(written(load, unit, 6) for load in row.load)
        change = f"load {loads}, contact {_areas(dataset, *row.area)}"
        jump = row if row.begin == row.end else table[max(row.number - 1, 0)]
        if jump.begin == jump.end and jump.area[0] > 0:
            change += f"{' at once' if jump is row else ''}, {row.area[1] / jump.area[0]:.4g} of before"
            change += "" if jump is row else f" the {jump.kind}"
        if row.lowest_area < min(row.area):
            after = _time(dataset, float(f"{row.lowest_after:.3g}"))
            change += f", least {_areas(dataset, row.lowest_area)} {after} after its beginning"
        rows.append(Row(f"leg {row.number}", f"{row.kind}, {at}: {change}", brief=row.number < 5))
    if len(table) > _MOST_LEGS:
        rows.append(Row("", f"and {len(table) - _MOST_LEGS} more legs: see aging.csv"))
    least = int(np.argmin(dataset["load"].values))
    if (load := float(dataset["load"][least])) < 0:
        note = f" at t = {_time(dataset, float(dataset['time'][least]))}, among the recorded times"
        rows.append(Row("largest tension", -load, unit, note=note, digits=4, brief=True))
    return rows


def _areas(dataset: xr.Dataset, *sites: float) -> str:
    text = f"{' to '.join(f'{area:.0f}' for area in sites)} sites"
    if not dataset.attrs["si"]:
        return text
    cell = cell_of(dataset)
    unit, factor = readable(dataset["contact_area"].attrs["units"], max(sites) * cell)
    return f"{' to '.join(f'{area * cell * factor:.4g}' for area in sites)} {unit} ({text})"
