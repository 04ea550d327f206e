"""A campaign as one Dataset over the swept parameters and the seeds, with its ensemble."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

import asperity.results.parameters as parameters
from asperity.app.campaign.plan import Plan, load_plan, put, value_at
from asperity.app.campaign.store import Store
from asperity.app.config import to_tables
from asperity.base import checks
from asperity.base.version import __version__
from asperity.base.words import tables_to_toml
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.protocols.legs import in_words
from asperity.results.quantities import CAMPAIGN, Units, select, units_named

_NO_ENSEMBLE = re.compile(
    "|".join(
        [
            *(name for name, one in select("series").items() if CAMPAIGN not in one.tables),
            *("worst_residual", "relaxed_residual", "sites", "held", "seconds", "products"),
            *("fit_.*_uncertainty", ".*_low", ".*_high"),
        ]
    )
)
"""Numbers about the computation, and ends of bands, of which no ensemble is taken."""

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
    plan, store = load_plan(directory), Store(directory)
    runs, done = plan.distinct, store.done()
    store.remark_on_remains(set(runs))
    found = {name: store.read(run) for name, run in runs.items() if name in done}
    if not found:
        raise InputError("campaign", expected="finished runs", got=f"{directory} with none yet")
    described = _described(found.values())
    dataset, over = _placed(plan, found, described)
    units = units_named({name: attrs["units"] for name, attrs in described.items()})
    if (of_lengths := getattr(next(iter(runs.values())).config.surface, "unit", None)) is not None:
        units = {**units, **dict.fromkeys(("length unit", "height unit"), of_lengths)}
    coordinate = {name: (one.long_name, one.dimension) for name, one in select("coordinate").items()}
    known = {name: (attrs["long_name"], attrs["units"]) for name, attrs in described.items()}
    for name in map(str, dataset.coords):
        long_name, unit = parameters.of_parameter(name) or (coordinate | known).get(name, ("", ""))
        dataset[name].attrs.update(long_name=long_name, units=units.get(unit, unit))
    if plan.seeds:
        dataset = _with_ensemble(dataset)
    title = "Aging of rough contacts" if "initial_area" in dataset else next(iter(found.values())).title
    return dataset.assign_attrs(
        title=f"{title}: a campaign",
        asperity_version=__version__,
        runs=len(runs),
        finished=len(found),
        over=" ".join(over),
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
    chosen = [run for run in plan.runs if where.items() <= plan.labels(run).items()]
    if len(chosen) != 1:
        expected = f"values of {', '.join(plan.swept) or 'nothing'} that name one run"
        raise InputError("campaign", expected=expected, got=f"{where}, which names {len(chosen)}")
    return Store(directory).fields(chosen[0])


def table(dataset: xr.Dataset) -> pd.DataFrame:
    """One row a run: its coordinates and its numbers, from the dataset of `open`.

    Of other questions the rows of each answer: the coordinates, such as the speed, and its columns.

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
    whole = {*dataset["seconds"].dims}
    whole |= set() if "initial_area" in dataset else {*dataset.attrs["over"].split()}
    dataset = with_ends(dataset)
    numbers = [str(name) for name in dataset.data_vars if {*dataset[name].dims} == whole]
    if whole:
        rows = dataset[numbers].to_dataframe().dropna(how="all").reset_index()
    else:
        rows = pd.DataFrame([{name: float(dataset[name]) for name in numbers}])
    counts = {f"{when}_{name}" for when in _WHEN for name, one in select().items() if one.whole} | {"sites"}
    return rows.astype({name: "Int64" for name in rows if name in counts})


def with_ends(dataset: xr.Dataset) -> xr.Dataset:
    """Add the first and the last value of each series of a run, by names such as ``final_approach``."""
    if "initial_area" not in dataset:  # it has no history
        return dataset
    over_time = dataset.attrs["over"].split()[-1]
    ends: dict[str, xr.DataArray] = {}
    for name, values in dataset.data_vars.items():
        quantity = str(name).removesuffix("_history")
        timed = over_time in values.dims
        along = over_time if timed else "field_time"
        wanted = select("series" if timed else "map", table=CAMPAIGN)
        if along not in values.dims or quantity not in wanted or "quantile" in values.dims:
            continue
        last = (values.notnull().sum(along) - 1).clip(min=0)  # a run of few entries ends with undefined ones
        for when, end in (("initial", values.isel({along: 0})), ("final", values.isel({along: last}))):
            if f"{when}_{quantity}" not in dataset:
                moment = _WHEN[when] if along == over_time else f"on the {_WHICH[when]} map"
                described = values.attrs | {"long_name": f"{values.attrs['long_name']}, {moment}"}
                plain_end = end.drop_vars(["time", "leg", "field_time"], errors="ignore")
                ends[f"{when}_{quantity}"] = plain_end.assign_attrs(described)
    return dataset.assign(ends)


def _placed(
    plan: Plan, found: Mapping[str, xr.Dataset], described: Mapping[str, dict[str, str]]
) -> tuple[xr.Dataset, list[str]]:
    """Variables of the runs over the dimensions and their own; and the dimensions of the answer."""
    first = max(found.values(), key=lambda one: one.sizes.get("direction", 0))  # a law may lack the unloading
    zipped = {axis.name: ("point", list(axis.values)) for axis in plan.axes if plan.zipped}
    dataset = xr.Dataset(coords=zipped | {name: list(values) for name, values in plan.dimensions.items()})
    own = {
        dim
        for dim in first.dims
        if dim != "direction"
        and not all(dim in one.dims and np.array_equal(one[dim], first[dim]) for one in found.values())
    }
    over: list[str] = ["entry" if dim in own else dim for dim in first.attrs["over"]]
    for name, attrs in described.items():
        of_run = next(one.variables[name] for one in found.values() if name in one.variables)
        if not {*of_run.dims} <= {*first.dims} or {*of_run.dims} & own - {*first.attrs["over"]}:
            continue  # what maps at times of their own know of patches
        if name in first.coords and not {*of_run.dims} & own:
            dataset = dataset.assign_coords({name: first.variables[name]})
            continue
        values = _at_places(plan, found, name)
        along = [*plan.dimensions, *("entry" if dim in own else dim for dim in of_run.dims)]
        if name in first.coords:  # the seeds of a point share its times
            values = np.nanmax(values, axis=-2, initial=-1.0) if plan.seeds else values
            values = np.where(values < 0, np.nan, values)
            dataset = dataset.assign_coords({name: ([dim for dim in along if dim != "seed"], values)})
        else:
            # A swept load is a coordinate; the load as it developed needs another name then.
            dataset[f"{name}_history" if name in dataset.coords else name] = along, values, attrs
    entries = {"entry": np.arange(dataset.sizes["entry"])} if "entry" in dataset.dims else {}
    return dataset.assign_coords(entries), over


def _at_places(plan: Plan, found: Mapping[str, xr.Dataset], name: str) -> Field:
    """A variable of each run along the dimensions, then its own; NaN where there is none."""
    variables = {key: one.variables[name] for key, one in found.items() if name in one.variables}
    shape = np.max([one.shape for one in variables.values()], axis=0).astype(int)
    values = np.full((*map(len, plan.dimensions.values()), *shape), np.nan)
    for run in plan.runs:
        if (one := variables.get(run.identity)) is not None:
            place: tuple[Any, ...] = (*plan.place(run), *map(slice, one.shape))
            values[place] = one.values
    return values


def _described(found: Iterable[xr.Dataset]) -> dict[str, dict[str, str]]:
    """Long name and unit of each variable, in one order for all runs."""
    described: dict[str, dict[str, str]] = {}
    for one in found:
        for name, variable in one.variables.items():
            attrs = {"long_name": "", "units": "", **variable.attrs}
            before, unit = described.setdefault(str(name), attrs)["units"], attrs["units"]
            if unit not in before:
                described[str(name)] = attrs | {"units": f"{before} or {unit}, as the run"}
    return described


def _in_common(plan: Plan, units: Units) -> dict[str, Any]:
    """Keys that all runs share, and the file of the campaign."""
    tables = to_tables(plan.runs[0].config)
    swept: dict[str, Any] = {}
    for number, axis in enumerate(plan.axes):
        at = {run.point[number]: run.config for run in reversed(plan.runs)}
        if axis.section == "protocol":
            swept[axis.name] = list(axis.values)
            continue
        of_runs = [value_at(at[i], axis.section, axis.name) for i in range(len(at))]
        swept[axis.name] = list(axis.values) if None in of_runs else of_runs
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
    finished = dataset["seconds"].count("seed")
    names = [str(name) for name in dataset.data_vars if not _NO_ENSEMBLE.fullmatch(str(name))]
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
