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
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import zarr
from filelock import FileLock, Timeout
from numpy.typing import NDArray

from asperity.app.campaign.plan import Run
from asperity.app.runs import Outcome
from asperity.base.calls import remark
from asperity.base.files import MARKER, expanded, mark
from asperity.errors import InputError, OutputError
from asperity.lattice import Field
from asperity.patches import QUANTILES
from asperity.results.quantities import select
from asperity.results.store import flush, flush_folder, whole_file

QUANTITIES = ("time", *select("series"), "leg")
FITTED = ("a", "q", "t0", "C")
KEPT_FIELDS = ("heights", *select("field"), "in_contact_relaxed", "u_relaxed", "area_observed")
"""Fields of a run that asked for maps, in the order in which their checksum takes them."""

_PATIENCE = 60.0
"""Seconds to wait for another process that prepares the same folder, which takes it a moment."""

_OF_MAPS = "of_maps"
"""The array of the patches of all maps."""

_WHOLE = "attributes_checksum"
"""The attribute that is the checksum of all others."""


@dataclass(frozen=True, eq=False)
class Finished:
    """A finished run as stored.

    Its series have the shape (quantities, times), with NaN where it has none; ``described`` gives their long
    names and units, ``lattice`` attributes of its dataset; ``maps`` is None for a run without maps.
    """

    series: Field
    scalars: dict[str, float]
    config: str
    described: dict[str, tuple[str, str]]
    lattice: dict[str, Any]
    maps: xr.Dataset | None = None


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
            raise InputError(
                "campaign",
                expected="a folder that is free",
                got=f"{self.directory}, which another process has been preparing for {_PATIENCE:g} s",
                advice="ending that process",
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

    def read(self, run: Run) -> Finished:
        """Read a finished run.

        `InputError` if it is not there, damaged, or another run.
        """
        with self._opened(run) as (group, facts):
            series = np.asarray(group["series"])
            _check(facts["checksum"] == _checksum(series))
            return Finished(
                series=_completed(series, facts["quantities"]),
                scalars={name: float(value) for name, value in facts["scalars"].items()},
                config=str(facts["config"]),
                described={name: (str(long), str(unit)) for name, (long, unit) in facts["described"].items()},
                lattice=facts.get("lattice", {}),
                maps=_maps_of(group, facts),
            )

    def fields(self, run: Run) -> xr.Dataset:
        """Read the fields that a finished run kept, as its history held them.

        `InputError` if the run is not there, kept none, is damaged, or another one.
        """
        with self._opened(run) as (group, facts):
            if "fields_checksum" not in facts:
                raise InputError(
                    "campaign",
                    expected="a run that kept fields",
                    got=f"{run.identity} without",
                    advice="maps_at in [output]",
                )
            names = (*KEPT_FIELDS, "field_time", _OF_MAPS)
            arrays = {name: np.asarray(group[name]) for name in names if name in group}
            _check(facts["fields_checksum"] == _checksum(*arrays.values()))
            sites = ("y", "x")[2 - arrays["heights"].ndim :]
            dims = {0: sites, 1: ("field_time", *sites), 2: ("field_time", "branch", *sites)}
            variables = {
                name: ("field_time" if name == "area_observed" else dims[values.ndim - len(sites)], values)
                for name, values in arrays.items()
                if name not in ("field_time", _OF_MAPS)
            }
            fields = xr.Dataset(
                variables, coords={"field_time": arrays["field_time"]}, attrs=facts.get("lattice", {})
            )
            of_patches = _maps_of(group, facts)
            return fields if of_patches is None else fields.assign(of_patches)

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
    return InputError(
        "campaign",
        expected="runs as they were written",
        got=f"{place}, which {fault}",
        advice=f"removing {part}, and the same sweep again",
    )


def _write_group(folder: Path, identity: str, outcome: Outcome, seconds: float) -> None:
    """One array holds the series: writing costs by the array, and there may be thousands of runs."""
    dataset = outcome.dataset
    with_legs = dataset if "leg" in dataset.coords else dataset.assign_coords(leg=0 * dataset["steps"])
    quantities = [name for name in QUANTITIES if name in with_legs.variables]
    series = np.stack([np.asarray(with_legs[name], dtype=np.float64) for name in quantities])
    group = zarr.open_group(folder, mode="w")
    group.create_array("series", data=series, chunks=series.shape, dimension_names=("quantity", "time"))
    fields = {}
    if "field_time" in dataset:
        fields = {name: np.asarray(dataset[name]) for name in (*KEPT_FIELDS, "field_time") if name in dataset}
    kept = {}
    if "patches" in dataset:
        kept = {name: np.atleast_2d(np.asarray(dataset[name]).T) for name in select("map") if name in dataset}
        fields[_OF_MAPS] = np.concatenate(list(kept.values())).astype(np.float64)
    for name, values in fields.items():
        group.create_array(name, data=values, chunks=values.shape)
    facts: dict[str, Any] = {
        "identity": identity,
        "quantities": quantities,
        "described": {
            name: [with_legs[name].attrs.get(key, "") for key in ("long_name", "units")]
            for name in quantities
        },
        "lattice": {name: dataset.attrs[name] for name in ("spacing", "edges", "si")},
        "scalars": _scalars(outcome) | {"seconds": seconds},
        "config": str(dataset.attrs["config"]),
        "asperity_version": str(dataset.attrs["asperity_version"]),
        "heights_sha256": str(dataset.attrs["heights_sha256"]),
        "checksum": _checksum(series),
        **({"fields_checksum": _checksum(*fields.values())} if fields else {}),
        _OF_MAPS: [
            [name, len(values), values.dtype.str, *map(dataset[name].attrs.get, ("long_name", "units"))]
            for name, values in kept.items()
        ],
    }
    group.attrs.update(facts | {_WHOLE: _checksum_of(facts)})


def _completed(series: Field, quantities: Sequence[str]) -> Field:
    """The series of `QUANTITIES`, undefined where a run has none."""
    columns = dict(zip(quantities, series, strict=True))
    missing = np.full(series.shape[1:], np.nan)
    return np.stack([columns.get(name, missing) for name in QUANTITIES])


def _maps_of(group: zarr.Group, facts: dict[str, Any]) -> xr.Dataset | None:
    """What the maps of a run know of patches; None where it has no maps."""
    if not facts.get(_OF_MAPS):
        return None
    values, row, series = np.asarray(group[_OF_MAPS]), 0, {}
    for name, width, dtype, long_name, unit in facts[_OF_MAPS]:
        run_values = values[row : row + width].astype(dtype)
        shaped = run_values[0] if width == 1 else run_values.T
        described = {"long_name": str(long_name), "units": str(unit)}
        series[str(name)] = (("field_time", "quantile")[: shaped.ndim], shaped, described)
        row += width
    coordinates = {"field_time": np.asarray(group["field_time"]), "quantile": list(QUANTILES)}
    return xr.Dataset(series, coords=coordinates)


def _scalars(outcome: Outcome) -> dict[str, float]:
    dataset, summary = outcome.dataset, outcome.summary
    scalars = {
        "sites": float(dataset.attrs["sites"]),
        "held": float(dataset.attrs[f"held_{dataset.attrs['held']}"]),
        "initial_area": float(dataset["area"][0]),
        "final_area": float(dataset["area"][-1]),
        "worst_residual": float(dataset["residual"].max()),
    }
    scalars |= {
        name: float(value)
        for name, value in dataset.attrs.items()
        if name.startswith("relaxed_") and np.isfinite(value)
    }
    if summary is not None and summary.fit is not None:
        fitted = {f"fit_{name}": getattr(summary.fit, name) for name in FITTED}
        fitted |= {f"fit_{name}_uncertainty": getattr(summary.fit, f"{name}_stderr") for name in FITTED}
        fitted["fit_misfit"] = summary.fit.rms_residual
        scalars |= {name: float(value) for name, value in fitted.items() if np.isfinite(value)}
    return scalars


def _checksum(*arrays: NDArray[Any]) -> str:
    total = hashlib.sha256()
    for array in arrays:
        total.update(array.tobytes())
    return total.hexdigest()


def _checksum_of(facts: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()


def _is_locked(path: Path) -> bool:
    try:
        with FileLock(path, blocking=False):
            return False
    except Timeout:
        return True
