"""The folder of a campaign: one zarr store of finished runs, and the state of running ones.

    DIR/asperity.json                 the marker: that this is a campaign
    DIR/plan.json                     the plan last given
    DIR/runs.zarr/<identity>          a finished run: a zarr group, complete or not there
    DIR/state/...                     locks, failures, checkpoints, and runs being written

A run is written beside the store with its mark ``complete`` last, flushed, and moved in under its name
by one rename. Two writers of the same run cannot disturb each other: the second finds the name taken.
Locks belong to living processes: the operating system drops them when one is killed.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import zarr
from filelock import FileLock, Timeout
from numpy.typing import NDArray

from asperity.app.campaign.plan import Run
from asperity.app.config import to_toml
from asperity.app.runs import Outcome
from asperity.base.calls import remark
from asperity.base.files import MARKER, expanded, mark
from asperity.errors import InputError, OutputError
from asperity.results.store import flush, flush_folder, whole_file

_SITES = {"y", "x", "branch"}
"""Dimensions of the fields of a run."""

_PATIENCE = 60.0
"""Seconds to wait for another process that prepares the same folder, which takes it a moment."""

_WHOLE = "attributes_checksum"
"""The attribute that is the checksum of all others."""


class Store:
    """The runs of one campaign on disk."""

    def __init__(self, directory: str | Path) -> None:
        self.directory = directory = expanded(directory)
        self.runs = directory / "runs.zarr"
        self.work = directory / "state"

    def prepare(self) -> None:
        """Create the folders, and remove remains of killed writers; harmless while others write."""
        if not (self.directory / MARKER).exists():  # first: by it others know the folder
            with whole_file(self.directory / MARKER) as part:
                mark(part, "campaign", ("plan.json", "runs.zarr", "state"))
        for name in ("locks", "failed", "checkpoints", "staging"):
            (self.work / name).mkdir(parents=True, exist_ok=True)
        try:
            with FileLock(self.work / "prepare.lock", timeout=_PATIENCE):  # creating a group is no single act
                self._create_and_clear()
        except Timeout as error:
            got = f"{self.directory}, which another process has been preparing for {_PATIENCE:g} s"
            raise InputError(
                "campaign", expected="a folder that is free", got=got, advice="ending that process"
            ) from error

    def _create_and_clear(self) -> None:
        try:
            zarr.open_group(self.runs, mode="a")
        except OSError:
            raise
        except Exception as error:
            raise _damage(self.runs / "zarr.json", "that file") from error
        remains = list((self.work / "staging").iterdir())
        running = self.running()  # after the list: who began to write since then is not in it
        for remnant in remains:
            if remnant.name.partition(".")[0] not in running:  # its writer was killed
                shutil.rmtree(remnant, ignore_errors=True)

    def is_done(self, identity: str) -> bool:
        """Whether the run is finished."""
        return (self.runs / identity / "zarr.json").exists()

    def done(self) -> set[str]:
        """Identities of all finished runs."""
        return {path.parent.name for path in self.runs.glob("*/zarr.json")}

    def remark_on_remains(self, identities: set[str]) -> None:
        """Name folders of these runs that lack their ``zarr.json``, as a cut-off copy does."""
        present = {path.name for path in self.runs.glob("*/")} & identities  # before asking which are done
        if lacking := sorted(present - self.done()):
            more = f" and {len(lacking) - 1} more" if lacking[1:] else ""
            damaged = f"{self.runs / lacking[0]}{more} without zarr.json: damaged"
            remark(f"{damaged}, and not used; asperity sweep repeats it")

    def checkpoint(self, identity: str) -> Path:
        """The checkpoint of a run."""
        return self.work / "checkpoints" / f"{identity}.npz"

    @contextmanager
    def claim(self, identity: str) -> Iterator[bool]:
        """Lock a run for this process; yields whether that succeeded."""
        lock = FileLock(self._lock(identity))
        try:
            lock.acquire(blocking=False)
        except Timeout:
            yield False
            return
        try:
            yield True
        finally:
            with suppress(OSError):
                self._lock(identity).unlink(missing_ok=True)
            lock.release()

    def running(self) -> set[str]:
        """Identities of the runs that processes on this machine compute."""
        return {path.stem for path in (self.work / "locks").glob("*.lock") if _is_locked(path)}

    def failures(self) -> dict[str, str]:
        """Runs that failed, and why."""
        reasons = {}
        for path in (self.work / "failed").glob("*.txt"):
            with suppress(OSError):  # forgiven meanwhile
                reasons[path.stem] = path.read_text(encoding="utf-8").strip()
        return reasons

    def fail(self, identity: str, reason: str) -> None:
        """Record why a run failed."""
        with whole_file(self.work / "failed" / f"{identity}.txt") as part:
            part.write_text(reason, encoding="utf-8")

    def forgive(self, identity: str) -> None:
        """Forget a failure."""
        (self.work / "failed" / f"{identity}.txt").unlink(missing_ok=True)

    def write(self, identity: str, outcome: Outcome, seconds: float) -> None:
        """Store a finished run.

        `OutputError` if the disk refused; the store is as it was.
        """
        target = self.runs / identity
        try:
            with tempfile.TemporaryDirectory(
                prefix=f"{identity}.", dir=self.work / "staging", ignore_cleanup_errors=True
            ) as staging:
                finished = Path(staging) / "made"
                _write_group(finished, identity, outcome, seconds)
                flush(finished)
                if not self.is_done(identity) and target.exists():  # remains of a folder
                    target.rename(Path(staging) / "remains")
                finished.rename(target)
                flush_folder(self.runs)
        except OSError as error:
            if self.is_done(identity):  # another process was faster, with the same numbers
                return
            raise OutputError(
                f"could not write to {self.directory}: {error.strerror or error}; nothing there is damaged"
            ) from error

    def read(self, run: Run, *, fields: bool = False) -> xr.Dataset:
        """Read the dataset of a finished run, without the fields over its sites or with them.

        `InputError` if it is not there, damaged, or another run.
        """
        with self._opened(run) as (group, facts):
            rows: dict[str, list[str]] = {}
            for name, (key, dims, *_) in facts["variables"].items():
                if fields or not _SITES & {*dims}:
                    rows.setdefault(key, []).append(name)
            found = {name: tuple(one) for name, one in facts["plain"].items()}
            for key, names in rows.items():
                stored = np.asarray(group[key])
                _check(facts["checksums"][key] == _checksum(stored))
                for name, values in zip(names, [stored] if key == names[0] else stored, strict=True):
                    _, dims, dtype, attrs = facts["variables"][name]
                    found[name] = dims, values.astype(dtype), attrs
            coordinates = {name: found.pop(name) for name in facts["coordinates"] if name in found}
            return xr.Dataset(found, coordinates, facts["attributes"] | {"config": facts["config"]})

    def fields(self, run: Run) -> xr.Dataset:
        """Read the dataset of a finished run with the fields that it kept.

        `InputError` if the run is not there, kept none, is damaged, or another one.
        """
        dataset = self.read(run, fields=True)
        if not _SITES & {*dataset.dims}:
            expected, got = "a run that kept fields", f"{run.identity} without"
            raise InputError("campaign", expected=expected, got=got, advice="maps_at in [output]")
        return dataset

    @contextmanager
    def _opened(self, run: Run) -> Iterator[tuple[zarr.Group, dict[str, Any]]]:
        """The group of a finished run, and its attributes, which are whole and that run's.

        What fails while they are read is named as damage: a damaged byte leads anywhere.
        """
        place = self.runs / run.identity
        if not self.is_done(run.identity):
            expected, got = f"a finished run in {self.runs}", f"{run.identity}, which is none"
            raise InputError("campaign", expected=expected, got=got)
        try:
            group = zarr.open_group(place, mode="r")
            facts = dict(group.attrs)
            _check(facts.pop(_WHOLE) == _checksum_of(facts))
            if facts["identity"] != run.identity:
                raise _damage(place, "that folder", "holds another run")
            if "variables" not in facts:
                raise _damage(place, "that folder", "was written by an earlier version")
            yield group, facts
        except Exception as error:
            if type(error) is InputError:
                raise
            raise _damage(place, "that folder") from error

    def _lock(self, identity: str) -> Path:
        return self.work / "locks" / f"{identity}.lock"


def _check(sound: object) -> None:
    if not sound:
        raise ValueError


def _damage(place: Path, part: str, fault: str = "is damaged") -> InputError:
    expected, advice = "runs as they were written", f"removing {part}, and the same sweep again"
    return InputError("campaign", expected=expected, got=f"{place}, which {fault}", advice=advice)


def _write_group(folder: Path, identity: str, outcome: Outcome, seconds: float) -> None:
    """One array holds all numbers over the same dimensions, and each field over the sites has its own.

    Writing costs by the array, and there may be thousands of runs.
    """
    numbers = outcome.numbers() | {"seconds": ((), seconds, {"long_name": "time of computing", "units": "s"})}
    dataset = outcome.dataset.assign(dict(sorted(numbers.items())))
    asked = outcome.config
    if not (asked.output.maps_at or getattr(asked.own, "fields_at", None)):  # no fields were asked for
        dataset = dataset.drop_dims(_SITES & {*dataset.dims})
    plain = {name: one for name, one in dataset.variables.items() if one.dtype.kind == "U" or not one.dims}
    arrays: dict[str, list[NDArray[Any]]] = {}
    variables = {}
    for name, one in dataset.variables.items():
        if name not in plain:
            key = str(name) if _SITES & {*one.dims} else "_".join(["over", *map(str, one.dims)])
            arrays.setdefault(key, []).append(one.values)
            variables[name] = key, one.dims, one.dtype.str, one.attrs
    group, checksums = zarr.open_group(folder, mode="w"), {}
    for key, parts in arrays.items():
        values = parts[0] if key in variables else np.stack(parts).astype(np.float64)
        group.create_array(key, data=values, chunks=values.shape)
        checksums[key] = _checksum(values)
    facts: dict[str, Any] = {
        "identity": identity,
        "variables": variables,
        "plain": {name: (one.dims, one.values.tolist(), one.attrs) for name, one in plain.items()},
        "coordinates": [*dataset.coords],
        "attributes": dataset.attrs | {"over": outcome.over},
        "config": to_toml(outcome.config),
        "checksums": checksums,
    }
    facts = json.loads(json.dumps(facts))
    group.attrs.update(facts | {_WHOLE: _checksum_of(facts)})


def _checksum(array: NDArray[Any]) -> str:
    return hashlib.sha256(array.tobytes()).hexdigest()


def _checksum_of(facts: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()


def _is_locked(path: Path) -> bool:
    try:
        with FileLock(path, blocking=False):
            return False
    except Timeout:
        return True
