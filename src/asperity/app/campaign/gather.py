"""A campaign as one Dataset over the swept parameters and the seeds, with its ensemble."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

import asperity.results.parameters as parameters
from asperity.app.campaign.plan import Plan, Run, load_plan, put, value_at
from asperity.app.campaign.store import FITTED, QUANTITIES, Finished, Store
from asperity.app.config import to_tables
from asperity.base import checks
from asperity.base.version import __version__
from asperity.base.words import tables_to_toml
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.protocols.legs import in_words
from asperity.results.quantities import CAMPAIGN, Units, select, units_named

_NO_ENSEMBLE = (
    *(name for name, one in select("series").items() if CAMPAIGN not in one.tables),
    *("worst_residual", "relaxed_residual", "sites", "held", "seconds"),
    *(f"fit_{name}_uncertainty" for name in FITTED),
)
"""Numbers about the computation, of which no ensemble is taken."""

_SCALARS = {
    "sites": ("sites of the lattice", "sites"),
    "held": ("load or separation that is held at first", ""),
    "seconds": ("time of computing", "s"),
    "worst_residual": ("largest residual of all entries", "1"),
    "fit_a": ("a of the saturation law", "1"),
    "fit_q": ("q of the saturation law", "1"),
    "fit_t0": ("t0 of the saturation law", "time"),
    "fit_C": ("(a - 1) q of the saturation law", "1"),
    "fit_misfit": ("rms misfit of the saturation law", "1"),
}
"""Long name and dimension of the single numbers of a run."""

_WHICH = {"initial": "first", "final": "last"}
_WHEN = {"initial": "at time 0", "final": "at the last time", "relaxed": "relaxed"}


def open(directory: str | Path) -> xr.Dataset:  # noqa: A001  (asp.campaign.open, as xarray and zarr have it)
    """Open the runs of a campaign that are finished.

    Parameters
    ----------
    directory
        Folder of the campaign.

    Returns
    -------
    Dataset
        Over the swept parameters (or ``point``, for zipped ones), ``seed`` and ``time``: the series of
        `asperity.age`. Where a swept parameter has the name of a series, such as the load, that series
        is called ``load_history``. Over all but ``time``: one number a run, such as ``relaxed_area`` or
        ``fit_q``. Over all but ``seed``: the ensemble, ``area_mean``, ``area_stderr`` (standard error of
        the mean), and so on, and the ``count`` of finished seeds; ``fit_q_count`` where fewer have a fit.
        What is not finished is NaN. Where durations are swept, runs have times of their own: then ``entry``
        takes the place of ``time``, which is a coordinate over the parameters and ``entry``. Where all runs
        kept maps at the same times, what these know of patches is over ``field_time``. The attributes
        hold what all runs have in common, one by one (``k0``, ``shape``, ``last``, ...), their units as
        ``parameter_units``, and the whole campaign file as ``config``.

    Raises
    ------
    InputError
        The folder holds no campaign, or no finished run.
    """
    plan = load_plan(directory)
    store = Store(directory)
    runs, done = plan.distinct, store.done()
    store.remark_on_remains(set(runs))
    finished = {name: store.read(run) for name, run in runs.items() if name in done}
    if not finished:
        raise InputError("campaign", expected="finished runs", got=f"{directory} with none yet")
    dims, described = tuple(plan.dimensions), _described(finished.values())
    entries = max(run.series.shape[1] for run in finished.values())
    padded = {
        name: np.pad(run.series, ((0, 0), (0, entries - run.series.shape[1])), constant_values=np.nan)
        for name, run in finished.items()
    }
    series = dict(zip(QUANTITIES, _at_places(plan, padded), strict=True))
    names = sorted({name for run in finished.values() for name in run.scalars})
    numbers = {
        key: np.array([run.scalars.get(name, np.nan) for name in names]) for key, run in finished.items()
    }
    scalars = _at_places(plan, numbers)
    zipped = {axis.name: ("point", list(axis.values)) for axis in plan.axes if plan.zipped}
    coordinates = zipped | {name: list(values) for name, values in plan.dimensions.items()}
    along, times = _times(plan, finished, series)
    dataset = xr.Dataset(coords=coordinates | times)
    for name, values in series.items():
        if name in described and name not in ("time", "leg"):
            # A swept load is a coordinate; the load as it developed needs another name then.
            free = f"{name}_history" if name in coordinates else name
            long_name, unit = described[name]
            dataset[free] = ((*dims, along), values, {"long_name": long_name, "units": unit})
    dataset = dataset.assign(_of_maps(plan, finished))
    units = units_named({name: unit for name, (_, unit) in described.items()})
    for name, values in zip(names, scalars, strict=True):
        when, _, of_what = name.partition("_")
        long_name, unit = _SCALARS.get(name.removesuffix("_uncertainty"), (name.replace("_", " "), "1"))
        if when in _WHEN and of_what in described:
            long_name, unit = f"{described[of_what][0]}, {_WHEN[when]}", described[of_what][1]
        elif name == "held":
            unit = " or ".join(
                sorted({units["length" if _at_separation(run) else "force"] for run in plan.runs})
            )
        if name.endswith("_uncertainty"):
            long_name = f"{long_name}, standard error of the fit"
        dataset[name] = (dims, values, {"long_name": long_name, "units": units.get(unit, unit)})
    coordinate = {name: (one.long_name, one.dimension) for name, one in select("coordinate").items()}
    for name in map(str, dataset.coords):
        long_name, unit = parameters.of_parameter(name) or (coordinate | described).get(name, ("", ""))
        dataset[name].attrs.update(long_name=long_name, units=units.get(unit, unit))
    if "seed" in dims:
        dataset = _with_ensemble(dataset)
    return dataset.assign_attrs(
        title="Aging of rough contacts: a campaign",
        asperity_version=__version__,
        runs=len(runs),
        finished=len(finished),
        **_in_common(plan, units),
    )


def fields(directory: str | Path, **where: float | int | str) -> xr.Dataset:
    """Read the fields that one run of a campaign kept (``maps_at`` in its ``[output]``).

    Parameters
    ----------
    directory
        Folder of the campaign.
    where
        Which run: a value for every swept parameter, and the ``seed`` where there are several.

    Returns
    -------
    Dataset
        ``heights`` over the sites; ``u``, ``u0``, ``in_contact`` and forces over ``field_time`` and the
        sites; and, where the run has a limit, ``in_contact_relaxed`` and ``u_relaxed``.

    Raises
    ------
    InputError
        No run, or more than one, is meant; it is not finished; it kept no fields.
    """
    plan = load_plan(directory)
    labelled = [(run, plan.labels(run)) for run in plan.runs]
    chosen = [
        run
        for run, labels in labelled
        if all(name in labels and labels[name] == where[name] for name in where)
    ]
    if len(chosen) != 1:
        raise InputError(
            "campaign",
            expected=f"values of {', '.join(plan.swept) or 'nothing'} that name one run",
            got=f"{where}, which names {len(chosen)}",
        )
    return Store(directory).fields(chosen[0])


def table(dataset: xr.Dataset) -> pd.DataFrame:
    """One row a run: its coordinates and its numbers, from the dataset of `open`.

    Parameters
    ----------
    dataset
        From `open`.

    Returns
    -------
    DataFrame
        Runs that are not finished are left out.
    """
    checks.instance("dataset", dataset, xr.Dataset, "asperity.campaign.open(directory)")
    dataset = with_ends(dataset)
    whole = set(dataset.dims) - {"time", "entry", "field_time", "quantile"}
    numbers = [str(name) for name in dataset.data_vars if set(dataset[name].dims) == whole]
    if whole:
        rows = dataset[numbers].to_dataframe().dropna(how="all", subset=["initial_area"]).reset_index()
    else:
        rows = pd.DataFrame([{name: float(dataset[name]) for name in numbers}])
    counts = {f"{when}_{name}" for when in _WHEN for name, one in select().items() if one.whole} | {"sites"}
    return rows.astype({name: "Int64" for name in rows if name in counts})


def with_ends(dataset: xr.Dataset) -> xr.Dataset:
    """Add the first and the last value of each series of a run, by names such as ``final_approach``."""
    over_time = str(dataset["time"].dims[-1])
    series = {name: str(dataset[name].attrs["long_name"]) for name in map(str, dataset.data_vars)}
    ends: dict[str, xr.DataArray] = {}
    for name, long_name in series.items():
        quantity = name.removesuffix("_history")
        values = dataset[name]
        timed = over_time in values.dims
        along = over_time if timed else "field_time"
        if along not in values.dims or quantity not in select("series" if timed else "map", table=CAMPAIGN):
            continue
        if "quantile" in values.dims:
            continue
        last = (values.notnull().sum(along) - 1).clip(min=0)  # a run of few entries ends with undefined ones
        for when, end in (("initial", values.isel({along: 0})), ("final", values.isel({along: last}))):
            if f"{when}_{quantity}" not in dataset:
                moment = _WHEN[when] if along == over_time else f"on the {_WHICH[when]} map"
                described = values.attrs | {"long_name": f"{long_name}, {moment}"}
                plain_end = end.drop_vars(["time", "leg", "field_time"], errors="ignore")
                ends[f"{when}_{quantity}"] = plain_end.assign_attrs(described)
    return dataset.assign(ends)


def _at_places(plan: Plan, numbers: Mapping[str, Field]) -> Field:
    """Numbers of each run: their first axis, then the dimensions; NaN where it is not finished."""
    first, *rest = next(iter(numbers.values())).shape
    values = np.full((first, *map(len, plan.dimensions.values()), *rest), np.nan)
    for run in plan.runs:
        if run.identity in numbers:
            place: tuple[Any, ...] = (slice(None), *plan.place(run))
            values[place] = numbers[run.identity]
    return values


def _times(
    plan: Plan, finished: Mapping[str, Finished], series: Mapping[str, Field]
) -> tuple[str, dict[str, object]]:
    """Dimension of the series: times, if all runs share them; else entries, with times of each point."""
    protocol = bool(plan.runs[0].config.protocol)
    first, *others = finished.values()
    if all(np.array_equal(one.series[0], first.series[0]) for one in others):
        legs = {"leg": ("time", first.series[-1].astype(int))} if protocol else {}
        return "time", {"time": first.series[0], **legs}
    dims, kept = tuple(plan.dimensions), {}
    for name in ("time", "leg"):
        values = series[name]
        if plan.seeds:  # the seeds of a point share its times
            values = np.nanmax(values, axis=-2, initial=-1.0)
            values = np.where(values < 0, np.nan, values)
        kept[name] = ((*(dim for dim in dims if dim != "seed"), "entry"), values)
    return "entry", {**kept, "entry": np.arange(series["time"].shape[-1])}


def _of_maps(plan: Plan, finished: Mapping[str, Finished]) -> xr.Dataset:
    """Patches of the maps over the runs; empty unless all stored maps at the same times."""
    maps = {name: run.maps for name, run in finished.items() if run.maps is not None}
    if len(maps) < len(finished):
        return xr.Dataset()
    first, *others = maps.values()
    if any(list(one) != list(first) or not one.field_time.equals(first.field_time) for one in others):
        return xr.Dataset()
    gathered = xr.Dataset(coords=first.coords)
    for name, one in first.data_vars.items():
        (values,) = _at_places(plan, {run: fields[name].values[np.newaxis] for run, fields in maps.items()})
        gathered[name] = ((*plan.dimensions, *one.dims), values, one.attrs)
    return gathered


def _described(runs: Iterable[Finished]) -> dict[str, tuple[str, str]]:
    described: dict[str, tuple[str, str]] = {}
    for run in runs:
        for name, (long_name, unit) in run.described.items():
            unit_before = described.setdefault(name, (long_name, unit))[1]
            if unit_before != unit:
                described[name] = (long_name, f"{unit_before} or {unit}, as the run")
    return described


def _at_separation(run: Run) -> bool:
    hold = run.config.aging.hold
    return run.config.contact.separation is not None if hold is None else hold == "separation"


def _in_common(plan: Plan, units: Units) -> dict[str, Any]:
    """Keys that all runs share, and the file of the campaign."""
    tables = to_tables(plan.runs[0].config)
    swept: dict[str, Any] = {}
    for number, axis in enumerate(plan.axes):
        at = {run.point[number]: run.config for run in reversed(plan.runs)}
        if axis.section == "protocol":
            swept[axis.name] = list(axis.values)
            continue
        swept[axis.name] = [value_at(at[i], axis.section, axis.name) for i in range(len(at))]
        tables[axis.section].pop(axis.name, None)  # an entry of a list stays: the list has no holes
    if plan.seeds:
        first, count = plan.seeds[0], len(plan.seeds)
        in_a_row = list(plan.seeds) == list(range(first, first + count))
        swept["seeds"] = count if in_a_row else list(plan.seeds)
    if plan.zipped:
        swept["combine"] = "zip"
    config = tables_to_toml(tables | {"sweep": swept})
    if len(plan.seeds) > 1:
        tables["surface"].pop("seed")
    legs = tables.pop("protocol", None)
    tables["solid"]["solid"] = tables["solid"].pop("kind")
    facts = {key: value for name, table in tables.items() if name != "output" for key, value in table.items()}
    facts = {name: one for key, value in facts.items() for name, one in parameters.plain(key, value).items()}
    facts["parameter_units"] = parameters.units_of_parameters(facts, units)
    for axis in plan.axes:
        if axis.section == "protocol":
            put(legs, axis.name.partition(".")[2], "swept")
        elif "." in axis.name:
            facts.pop(parameters.attribute_of(axis.name), None)
    if legs is not None:
        facts |= {"protocol": json.dumps(legs), "protocol_in_words": in_words(legs)}
    return facts | {"config": config}


def _with_ensemble(dataset: xr.Dataset) -> xr.Dataset:
    """Mean over the seeds, its standard error, and how many seeds are finished."""
    finished = dataset["initial_area"].count("seed")
    names = [str(name) for name in dataset.data_vars if str(name) not in _NO_ENSEMBLE]
    for name in names:
        values = dataset[name]
        count = values.count("seed")
        # With one seed there is no spread to judge by: NaN.
        spread = values.std("seed", ddof=0) / np.sqrt((count - 1).where(count > 1))
        long_name, unit = values.attrs["long_name"], values.attrs["units"]
        statistics = {"mean": (values.mean("seed"), "mean over the seeds", unit)}
        if not (count == finished).all():  # a fit that failed, a limit that was not found
            statistics["count"] = (count, "seeds that have it", "1")
        statistics["stderr"] = (spread, "standard error of the mean", unit)
        for end, (number, meaning, its_unit) in statistics.items():
            dataset[f"{name}_{end}"] = number.assign_attrs(
                long_name=f"{long_name}, {meaning}", units=its_unit
            )
    dataset["count"] = finished.assign_attrs(long_name="finished seeds", units="1")
    return dataset
