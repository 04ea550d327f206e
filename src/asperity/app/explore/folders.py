"""Results in a folder that the page can show; neither names nor links lead out of it."""

from __future__ import annotations

import contextlib
import os
import tomllib
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np
import xarray as xr

import asperity.results as results
from asperity.analysis.aging import summary_of
from asperity.analysis.rows import history_rows
from asperity.app.campaign.plan import Plan, Run, load_plan, name_of
from asperity.app.campaign.store import Store
from asperity.app.config import RunConfig, config_from, to_toml
from asperity.app.config.python import to_python
from asperity.app.explore.scene import Arrays, Header, Recording, ending, pictured, recorded
from asperity.app.runs import Outcome, recorded_times
from asperity.app.runs.law import Tabulated
from asperity.app.runs.pipeline import height_law
from asperity.app.runs.sliding import Slid
from asperity.app.runs.words import units_in
from asperity.base import files
from asperity.base.rows import words_of
from asperity.errors import AsperityError, ConfigError, InputError, printable
from asperity.results.parameters import PARAMETERS

_DEEPEST, _MOST, _MOST_SEEN = 4, 500, 10_000
"""Most levels of folders, listed results, and folders that are searched."""

_MOST_CURVES = 500
"""Runs of a campaign whose curves are sent."""

_CURVES = ("contact_area", "area", "stiffness")
"""What the curves are of, the first that a run has."""

PICTURED: dict[str, Callable[..., Outcome]] = {"law": Tabulated, "sliding": Slid}
"""Answers that are shown as a figure, by their questions: they have no contact that ages."""

_SHOWN = ("run", "campaign", "prediction", *PICTURED)


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
    """The question that was answered in a folder, or ``"campaign"``; else empty."""
    if folder.suffix == ".zarr" and (folder / "heights" / "zarr.json").is_file():
        return "run"  # a history that was saved
    kind = files.kind_of(folder)
    return kind if kind in _SHOWN else ""


def entries(root: Path) -> list[dict[str, str]]:
    """Answers and campaigns of a folder, which may be one itself: path, kind and title."""
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
    raise InputError("path", expected="an answer or a campaign", got=printable(name))


def _finished(folder: Path, job: str) -> tuple[Recording, RunConfig | None]:
    dataset = results.load(folder)
    file = folder / "config.toml"
    text = file.read_text(encoding="utf-8") if file.exists() else str(dataset.attrs.get("config", ""))
    rows = files.marker_of(folder).get("rows")
    return _shown(dataset, _config(text), job, folder.resolve().name, rows)


def _shown(
    dataset: xr.Dataset, config: RunConfig | None, job: str, title: str, rows: list[tuple[str, str]] | None
) -> tuple[Recording, RunConfig | None]:
    """What the page gets of an answer: a history, or a figure; with the rows that its folder has, if any."""
    title = printable(title)
    if config is not None and config.asked in PICTURED:
        outcome = PICTURED[config.asked](config, dataset, ())
        shown = rows or words_of(outcome.rows())
        return Recording(job, end=pictured(outcome, title, shown, to_toml(config))), config
    recording = recorded(dataset, config, job=job, title=title)
    if rows is None:  # a saved history, a run of a campaign, or a folder of a version that kept none
        law = None if config is None else height_law(config.surface)
        rows = words_of(history_rows(dataset, summary_of(dataset, law)))
    recording.end = ending(dataset, rows)
    if config is not None and not config.asked and recording.scene is not None:
        recording.scene["python"] = to_python(config, recorded_times(config).tolist())
    return recording, config


def _config(text: str) -> RunConfig | None:
    try:
        return config_from(tomllib.loads(text), {}, None) if text else None
    except (ConfigError, tomllib.TOMLDecodeError):  # of another version
        return None


def _campaign(plan: Plan, store: Store, name: str, done: set[str]) -> tuple[Header, Arrays]:
    """Swept parameters, runs, and their curves: arrays ``time.ID`` and ``area.ID``."""
    running, failed = store.running(), store.failures()
    runs: list[Header] = []
    arrays: Arrays = {}
    units: dict[str, str] = {}
    for run in plan.distinct.values():
        places = {"done": done, "running": running, "failed": failed}
        state = next((state for state, names in places.items() if run.identity in names), "left")
        row = {"id": run.identity, "state": state, "reason": failed.get(run.identity, "")}
        runs.append(row | plan.labels(run))
        if state == "done" and len(arrays) < 2 * _MOST_CURVES:
            dataset = store.read(run)
            units = units or _units(plan, dataset)
            along = dataset.attrs["over"][-1]
            shown = next(name for name in _CURVES if name in dataset)
            arrays[f"time.{run.identity}"] = np.ascontiguousarray(dataset[along], dtype=np.float64)
            curve = dataset[shown].transpose(..., along).values.astype(np.float64)
            arrays[f"area.{run.identity}"] = curve.reshape(-1, curve.shape[-1])[0].copy()
    parameters = list(plan.swept)
    return {"kind": "campaign", "path": name, "parameters": parameters, "units": units, "runs": runs}, arrays


def _units(plan: Plan, dataset: xr.Dataset) -> dict[str, str]:
    units = units_in(dataset)
    dimensions = {name: PARAMETERS.get(name, ("", ""))[1] for name in plan.swept}
    return {name: units.get(dimension, dimension) for name, dimension in dimensions.items()}


def _of_campaign(plan: Plan, store: Store, run: Run, name: str) -> tuple[Recording, RunConfig | None]:
    """One run of a campaign, with its surface if it stored no fields."""
    dataset = store.read(run, fields=True)
    config = _config(dataset.attrs["config"]) or run.config
    if "heights" not in dataset and config.asked not in PICTURED:
        rough = config.surface.build()
        heights = rough.in_meters()[0] if dataset.attrs["si"] else rough.heights
        attrs = {"units": dataset["separation"].attrs["units"]}
        dataset["heights"] = ("y", "x")[2 - heights.ndim :], heights, attrs
    title = name_of(plan, run, units=_units(plan, dataset))
    return _shown(dataset, config, f"{name}/{run.identity}", title, None)
