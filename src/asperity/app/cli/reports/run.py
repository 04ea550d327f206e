"""The summary of a run, as rows of words."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING

from asperity.analysis.scan import readable, written
from asperity.app.cli.report import Row
from asperity.app.runs.words import carried_words
from asperity.base.words import counted, thousands
from asperity.results.parameters import PARAMETERS
from asperity.results.quantities import Units, units_named

if TYPE_CHECKING:
    import xarray as xr

    from asperity.analysis import AgingSummary
    from asperity.app.config import RunConfig
    from asperity.app.config.models import SurfaceSection
    from asperity.app.runs import Outcome

_ELECTRONVOLT = 1.602176634e-19
_MOST_LEGS = 20
"""Legs of a history that a summary lists."""


def run_report(outcome: Outcome, *, seconds: float, resumed: bool, read: str = "") -> list[Row]:
    """Say what was run and what came out; of a resumed run, the seconds are those of this session."""
    dataset, summary, config = outcome.dataset, outcome.summary, outcome.config
    attrs = dataset.attrs
    held = str(attrs["held"])
    rows = [("surface", _surface(outcome)), ("read", read), ("solid", _solid(config, dataset))]
    rows = [row for row in rows if row != ("read", "")]
    if summary is None:
        rows += _legs(dataset)
    else:
        value = _said(dataset, held, float(attrs[f"held_{held}"]))
        rows += [("held", f"{held} {value}"), *_growth(summary, dataset)]
    if "area_observed" in dataset:
        seen = dataset["area_observed"]
        ends = dict.fromkeys((0, seen.size - 1))
        times, areas = seen["field_time"].values.tolist(), seen.values.tolist()
        rows += [(f"seen at t = {times[n]:g}", written(areas[n], seen.attrs["units"], 5)) for n in ends]
    effort = "exact contact, " if attrs.get("exact_contact") == "at all times" else ""
    effort += f"{int(dataset['steps'].sum())} time steps, {int(dataset['iterations'].sum())} iterations, "
    effort += f"{seconds:.1f} s{' in this session' if resumed else ''}"
    return [
        *rows,
        *carried_words(dataset),
        ("worst residual", f"{float(dataset['residual'].max()):.1e} of the mean contact force"),
        ("effort", effort),
        *(("remark", remark) for remark in outcome.remarks),
    ]


def _said(dataset: xr.Dataset, name: str, value: float, digits: int = 8) -> str:
    """Write a value of a series, with its unit where that is one of SI."""
    return written(value, dataset[name].attrs["units"], digits)


def _solid(config: RunConfig, dataset: xr.Dataset) -> str:
    """What the solid is."""
    described = config.solid.model_dump(exclude_none=True)
    kind, parts = described.pop("kind"), []
    si = bool(dataset.attrs["si"])
    named = {str(name): str(one.attrs.get("units", "")) for name, one in dataset.variables.items()}
    units = units_named(named)
    relaxing = {f"{of}relaxing": described.pop(f"{of}branches", []) for of in ("", "base_")}
    for name, value in described.items():
        if isinstance(value, bool):
            parts += [name] * value
        elif isinstance(value, str):
            parts.append(f"{name} = {value}")
        else:
            values = value if isinstance(value, list | tuple) else [value]
            parts.append(f"{name} = " + " and ".join(_of(name, one, units) for one in values))
    for name, branches in relaxing.items():
        times = [f"{share:.3g} in {written(time, 's' if si else '1')}" for share, time in branches]
        parts += [f"{name}: {', '.join(times)}"] * bool(times)
    return f"{kind}: {', '.join(parts)}"


def _of(name: str, value: float, units: Units) -> str:
    """Write a parameter of a solid; an energy of activation in electronvolts."""
    dimension = PARAMETERS.get(name, ("", "1"))[1]
    unit = units.get(dimension, dimension)
    return written(value / _ELECTRONVOLT, "eV") if unit == "J" else written(value, unit)


def _at(dataset: xr.Dataset, time: float) -> str:
    return f"{time:g} s" if dataset["time"].attrs["units"] == "s" else f"{time:g}"


def _growth(summary: AgingSummary, dataset: xr.Dataset) -> list[Row]:
    """How the area grew while one thing was held."""
    rows = [*_loads(summary, dataset), ("contact at t = 0", _contact(summary.initial_area, summary, dataset))]
    if "mean_contact_pressure" in dataset:
        ends = (("mean_contact_pressure", "mean over the contacts"), ("largest_pressure", "at most"))
        said = (f"{_said(dataset, name, float(dataset[name][0]), 4)} {which}" for name, which in ends)
        rows.append(("pressure at t = 0", ", ".join(said)))
    rows += _yielding(dataset)
    if summary.time.size:
        late = f"contact at t = {_at(dataset, summary.time[-1])}"
        rows.append((late, _contact(int(dataset["area"][-1]), summary, dataset)))
    if summary.relaxed_ratio is not None:
        rows.append(("contact relaxed", _contact(int(dataset.attrs["relaxed_area"]), summary, dataset)))
    rows += _fit(summary)
    if "contact_area" in dataset and summary.time.size > 1:
        decades = math.log10(summary.time[-1] / summary.time[0])
        growth = (summary.area_ratio[-1] - summary.area_ratio[0]) / decades
        rows.append(("mean growth", f"{growth:.3g} A(0) per decade of time, over {decades:.3g} decades"))
    if abs(summary.steepest_per_decade) > 0:
        when = _rounded(summary.steepest_time) + (" s" if dataset.attrs["si"] else "")
        steepest = f"{summary.steepest_per_decade:.3g} A(0) per decade of time, near t = {when}"
        rows.append(("steepest growth" if summary.steepest_per_decade > 0 else "steepest loss", steepest))
    return rows


def _yielding(dataset: xr.Dataset) -> list[Row]:
    """How much of the contact bears the hardness; where fields were kept, how far the surface is lowered."""
    if "yielding_area" not in dataset:
        return []
    first, last = (int(dataset["yielding_area"][at]) for at in (0, -1))
    said = f"{counted(first, 'site')} at t = 0, {thousands(last)} at the end"
    if "permanent_indentation" in dataset:
        lower = dataset["permanent_indentation"][-1]
        said += f"; lowered for good: {counted(int((lower > 0).sum()), 'site')}"
        if (lower > 0).any():
            said += f", by up to {_said(dataset, 'permanent_indentation', float(lower.max()), 4)}"
    return [("yielding", said)]


def _legs(dataset: xr.Dataset) -> list[Row]:
    """What happened in each leg of a history."""
    from asperity.analysis import leg_table

    table = leg_table(dataset)
    first = _said(dataset, "load", float(dataset["load"][0]), 6)
    begun = _areas(dataset, float(dataset["area"][0]))
    rows = [("contact at t = 0", f"{begun} at load {first}"), *_yielding(dataset)]
    for row in table[:_MOST_LEGS]:
        at = f"t = {_at(dataset, row.begin)}"
        at += f" to {_at(dataset, row.end)}" if row.begin != row.end else ""
        loads = " to ".join(_said(dataset, "load", load, 6) for load in row.load)
        change = f"load {loads}, contact {_areas(dataset, *row.area)}"
        jump = row if row.begin == row.end else table[max(row.number - 1, 0)]
        if jump.begin == jump.end and jump.area[0] > 0:
            change += f"{' at once' if jump is row else ''}, {row.area[1] / jump.area[0]:.4g} of before"
            change += "" if jump is row else f" the {jump.kind}"
        if row.lowest_area < min(row.area):
            after = _at(dataset, float(f"{row.lowest_after:.3g}"))
            change += f", least {_areas(dataset, row.lowest_area)} {after} after its beginning"
        rows.append((f"leg {row.number}", f"{row.kind}, {at}: {change}"))
    if len(table) > _MOST_LEGS:
        rows.append(("", f"and {len(table) - _MOST_LEGS} more legs: see aging.csv"))
    return rows


def _areas(dataset: xr.Dataset, *sites: float) -> str:
    """Areas of contact, of one moment or from one to another: in SI in one readable unit, and in sites."""
    counted = f"{' to '.join(f'{area:.0f}' for area in sites)} sites"
    if not dataset.attrs["si"]:
        return counted
    cell = math.prod(json.loads(dataset.attrs["spacing"]))
    unit, factor = readable(dataset["contact_area"].attrs["units"], max(sites) * cell)
    return f"{' to '.join(f'{area * cell * factor:.4g}' for area in sites)} {unit} ({counted})"


def _loads(summary: AgingSummary, dataset: xr.Dataset) -> list[Row]:
    """Load at the beginning; where the separation is held, how it changes."""
    rows = [("load at t = 0", _said(dataset, "load", summary.initial_load))]
    if "mean_contact_pressure" in dataset:
        area = float(dataset["contact_area"][0] / dataset["contact_fraction"][0])
        said = written(summary.initial_load / area, dataset["mean_contact_pressure"].attrs["units"])
        rows.append(("mean pressure", f"{said} over the nominal area"))
    loads = {"load relaxed": summary.relaxed_load}
    if summary.load is None:
        return rows
    if summary.time.size:
        loads = {f"load at t = {_at(dataset, summary.time[-1])}": float(summary.load[-1]), **loads}
    rows += [
        (name, f"{_said(dataset, 'load', load)}, load/load(0) = {load / summary.initial_load:.4g}")
        for name, load in loads.items()
        if load is not None
    ]
    if abs(summary.load_per_decade) > 0:
        slope = summary.load_per_decade / summary.initial_load
        said = f"{slope:+.3g} load(0) per decade of time, near t = {_rounded(summary.load_time)}"
        rows.append(("steepest change of load", said))
    return rows


def _rounded(time: float) -> str:
    """Two digits of a time, without a power of ten where it is short without."""
    return f"{float(f'{time:.2g}'):g}"


def _surface(outcome: Outcome) -> str:
    chosen = outcome.config.surface.model_dump(exclude_none=True)
    if chosen["kind"] == "file":
        lattice = " x ".join(str(n) for n in outcome.dataset["heights"].shape)
        silent = ("kind", "path", "max_undefined", "channel", "resample", "despike")
        rules = ", ".join(f"{k} = {_word(value, ' ')}" for k, value in chosen.items() if k not in silent)
        rules += ", resampled" if chosen["resample"] else ""
        rules += ", spikes filled" if chosen["despike"] else ""
        return f"{Path(chosen['path']).name}: {lattice} sites ({rules})"
    return described(outcome.config.surface)


def described(surface: SurfaceSection) -> str:
    """What a surface is made of, in a line."""
    facts, apart = surface.model_dump(exclude_none=True, exclude={"kind"}), ("places", "radii", "heights")
    words = (f"{k} = {_word(value, ' ' if k in apart else ' x ')}" for k, value in facts.items())
    return f"{surface.kind}: {', '.join(words)}"


def _word(value: object, between: str) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(_word(one, between) for one in value)})"
    if isinstance(value, list):
        return between.join(_word(one, between) for one in value)
    return f"{value:g}" if isinstance(value, float | int) else str(value)


def _contact(area: int, summary: AgingSummary, dataset: xr.Dataset) -> str:
    ratio = f", A/A(0) = {area / summary.initial_area:.4f}" if area != summary.initial_area else ""
    sites = f"{area} of {summary.sites} sites = {100 * area / summary.sites:.4g} %{ratio}"
    if not dataset.attrs["si"]:
        return sites
    cell = math.prod(json.loads(dataset.attrs["spacing"]))
    return f"{written(area * cell, dataset['contact_area'].attrs['units'])}: {sites}"


def _fit(summary: AgingSummary) -> list[Row]:
    fit = summary.fit
    if fit is None:
        return [("fit", summary.fit_note)] if summary.fit_note else []
    known = summary.relaxed_ratio is not None
    a = "A(relaxed)/A(0), exact" if known else "extrapolated: no relaxed state is known"
    rows = [
        ("fit", "A/A(0) = a - (a - 1) / (1 + t/t0)^q"),
        ("  a", f"{fit.a:.{5 if known else 3}g}, {a}"),
        ("  q", f"{fit.q:.3g}"),
        ("  t0", f"{fit.t0:.3g}"),
        ("  (a - 1) q", f"{fit.C:.3g}"),
        ("  misfit", f"{100 * fit.rms_residual:.2g} % rms, {100 * summary.fit_worst:.2g} % at worst"),
    ]
    return [*rows, ("  note", summary.fit_note)] if summary.fit_note else rows
