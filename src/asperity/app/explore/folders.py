"""Results in a folder that the page can show; neither names nor links lead out of it."""

from __future__ import annotations

import contextlib
import json
import os
import tomllib
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np
import xarray as xr

import asperity.results as results
from asperity.analysis.aging import summary_of
from asperity.analysis.rows import history_rows
from asperity.app.campaign.plan import Plan, Run, load_plan
from asperity.app.campaign.store import QUANTITIES, Finished, Store
from asperity.app.config import RunConfig, config_from
from asperity.app.config.python import to_python
from asperity.app.explore.scene import Arrays, Header, Recording, ending, recorded
from asperity.app.runs import recorded_times
from asperity.app.runs.pipeline import height_law
from asperity.base import files
from asperity.base.readable import written
from asperity.base.rows import words_of
from asperity.errors import AsperityError, ConfigError, InputError, printable
from asperity.protocols.legs import described
from asperity.protocols.schedule import Schedule
from asperity.results.dataset import attributes_of_solid
from asperity.results.parameters import PARAMETERS
from asperity.results.quantities import units_named

_DEEPEST, _MOST, _MOST_SEEN = 4, 500, 10_000
"""Most levels of folders, listed results, and folders that are searched."""

_MOST_CURVES = 500
"""Runs of a campaign whose curves are sent."""


def inside(root: Path, name: str) -> Path:
    """Resolve a name in a folder; `InputError` if it lies outside, or is no name."""
    pure = PurePosixPath(name)
    if "\0" not in name and "\\" not in name and not pure.is_absolute() and ".." not in pure.parts:
        with contextlib.suppress(UnicodeEncodeError):  # no disk has such a name
            place = files.without_links(root / pure)
            if place.is_relative_to(root.resolve()):
                return place
    raise InputError("path", expected="a name in the folder that is shown", got=printable(name))


def kind_of(folder: Path) -> str:
    """``"run"``, ``"campaign"`` or ``"prediction"``; else empty."""
    if folder.suffix == ".zarr" and (folder / "heights" / "zarr.json").is_file():
        return "run"  # a history that was saved
    kind = files.kind_of(folder)
    return kind if kind in ("run", "campaign", "prediction") else ""


def entries(root: Path) -> list[dict[str, str]]:
    """Runs, campaigns and predictions of a folder, which may be one itself: path, kind and title."""
    listing: list[dict[str, str]] = []
    waiting, seen = deque([(root, 0)]), 0
    while waiting and len(listing) < _MOST and seen < _MOST_SEEN:
        folder, depth = waiting.popleft()
        seen += 1
        with contextlib.suppress(OSError):  # it is not ours to read, or has just gone
            if kind := kind_of(folder):
                path = folder.relative_to(root).as_posix()
                title = folder.resolve().name if path == "." else path
                listing.append({"path": path, "kind": kind, "title": printable(title)})
            elif depth < _DEEPEST:
                inner = sorted(child for child in folder.iterdir() if child.name[0] not in "._")
                waiting += [
                    (child, depth + 1) for child in inner if child.is_dir() and not child.is_symlink()
                ]
    return listing


@dataclass(frozen=True, eq=False)
class Opened:
    """Results under a name: a campaign, or a recording, or both."""

    campaign: tuple[Header, Arrays] | None
    recording: Recording | None
    config: RunConfig | None


def open_entry(root: Path, name: str) -> Opened:
    """Open a run, a prediction, a campaign (its curves and its first run), or one run of a campaign.

    `InputError` if there is no such thing, or it is damaged.
    """
    try:
        return _opened(root, name)
    except InputError as error:  # names on the page are those within the folder
        got = str(error.got).replace(f"{root}{os.sep}", "")
        raise InputError(error.name, expected=error.expected, got=got, advice=error.advice) from None
    except AsperityError:
        raise
    except Exception as error:  # a damaged byte leads anywhere
        got = f"{printable(name)}, which is damaged"
        raise InputError("path", expected="results as asperity wrote them", got=got) from error


def _opened(root: Path, name: str) -> Opened:
    folder = inside(root, name)
    kind = kind_of(folder)
    if kind == "campaign":
        plan, store = load_plan(folder), Store(folder)
        done = store.done()
        first = next((run for run in plan.runs if run.identity in done), None)
        shown = (None, None) if first is None else _of_campaign(plan, store, first, name)
        return Opened(_campaign(plan, store, name, done), *shown)
    if kind:
        recording, config = _finished(folder, name)
        return Opened(None, recording, config)
    above = PurePosixPath(name).parent.as_posix()
    if kind_of(inside(root, above)) == "campaign":
        plan, store = load_plan(inside(root, above)), Store(inside(root, above))
        if run := plan.distinct.get(PurePosixPath(name).name):
            return Opened(None, *_of_campaign(plan, store, run, above))
    raise InputError("path", expected="a run, a campaign or a prediction", got=printable(name))


def _finished(folder: Path, job: str) -> tuple[Recording, RunConfig | None]:
    dataset = results.load(folder)
    config = _config(str(dataset.attrs.get("config", "")))
    recording = recorded(dataset, config, job=job, title=printable(folder.resolve().name))
    rows = files.marker_of(folder).get("rows")
    if rows is None:  # a saved history, or a folder of a version that kept none
        law = None if config is None else height_law(config.surface)
        rows = words_of(history_rows(dataset, summary_of(dataset, law)))
    recording.end = ending(dataset, rows)
    return _with_python(recording, config), config


def _config(text: str) -> RunConfig | None:
    try:
        return config_from(tomllib.loads(text), {}, None) if text else None
    except (ConfigError, tomllib.TOMLDecodeError):  # of another version
        return None


def _with_python(recording: Recording, config: RunConfig | None) -> Recording:
    if config is not None and recording.scene is not None:
        recording.scene["python"] = to_python(config, recorded_times(config).tolist())
    return recording


def _campaign(plan: Plan, store: Store, name: str, done: set[str]) -> tuple[Header, Arrays]:
    """Swept parameters, runs, and their curves: arrays ``time.ID`` and ``area.ID``."""
    running, failed = store.running(), store.failures()
    runs: list[Header] = []
    arrays: Arrays = {}
    for run in plan.distinct.values():
        places = {"done": done, "running": running, "failed": failed}
        state = next((state for state, names in places.items() if run.identity in names), "left")
        row = {"id": run.identity, "state": state, "reason": failed.get(run.identity, "")}
        runs.append(row | plan.labels(run))
        if state == "done" and len(arrays) < 2 * _MOST_CURVES:
            series = dict(zip(QUANTITIES, store.read(run).series, strict=True))
            arrays[f"time.{run.identity}"] = np.ascontiguousarray(series["time"])
            area = series["contact_area" if np.isfinite(series["contact_area"]).any() else "area"]
            arrays[f"area.{run.identity}"] = np.ascontiguousarray(area)
    first = next((run for run in plan.runs if run.identity in done), None)
    units = {} if first is None else _units(plan, store.read(first))
    parameters = list(plan.swept)
    return {"kind": "campaign", "path": name, "parameters": parameters, "units": units, "runs": runs}, arrays


def _units(plan: Plan, finished: Finished) -> dict[str, str]:
    if not finished.lattice.get("si"):
        return {}
    units = units_named({name: unit for name, (_, unit) in finished.described.items()})
    dimensions = {name: PARAMETERS.get(name, ("", ""))[1] for name in plan.swept}
    return {name: units.get(dimension, dimension) for name, dimension in dimensions.items()}


def _title(plan: Plan, run: Run, units: Mapping[str, str]) -> str:
    labels = {name: value for name, value in plan.labels(run).items() if len(plan.swept[name]) > 1}
    words = (
        f"{name} = {written(value, units.get(name) or '1') if isinstance(value, int | float) else value}"
        for name, value in labels.items()
    )
    return ", ".join(words) or "the run"


def _of_campaign(plan: Plan, store: Store, run: Run, name: str) -> tuple[Recording, RunConfig]:
    """One run of a campaign: its series, and its maps if it stored fields."""
    finished = store.read(run)
    config = _config(finished.config) or run.config
    try:
        dataset = store.fields(run)
    except InputError:  # it kept none
        rough = config.surface.build()
        heights = rough.in_meters()[0] if finished.lattice.get("si") else rough.heights
        dataset = xr.Dataset({"heights": (("y", "x")[2 - heights.ndim :], heights)})
    dataset.attrs |= finished.lattice | attributes_of_solid(config.solid.build())
    series = dict(zip(QUANTITIES, finished.series, strict=True))
    if config.protocol:
        dataset.attrs["protocol"] = json.dumps([described(leg) for leg in config.protocol])
        schedule = Schedule.of(config.written_out, np.unique(series["time"]))
        dataset.attrs["switches"] = json.dumps(schedule.switches)
    dataset = dataset.assign_coords(time=series["time"])
    for quantity, (long_name, unit) in finished.described.items():
        attrs = {"long_name": long_name, "units": unit}
        if quantity == "leg" and config.protocol:
            dataset = dataset.assign_coords(leg=("time", series["leg"].astype(int), attrs))
        elif quantity not in ("time", "leg"):
            dataset[quantity] = ("time", series[quantity], attrs)
    dataset["time"].attrs.update(long_name="hold time", units=finished.described.get("time", ("", ""))[1])
    dataset["heights"].attrs["units"] = finished.described.get("separation", ("", ""))[1]
    if "relaxed_area" in finished.scalars:
        dataset.attrs["relaxed_area"] = finished.scalars["relaxed_area"]
    recording = recorded(
        dataset, config, job=f"{name}/{run.identity}", title=_title(plan, run, _units(plan, finished))
    )
    recording.end = ending(dataset, ())
    return _with_python(recording, config), config
