"""Save a Dataset and open it again: complete under its name, or not there at all."""

from __future__ import annotations

import os
import shutil
import uuid
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import xarray as xr
import zarr
from zarr.codecs import ZstdCodec

from asperity.base import checks, views
from asperity.base.words import reason_of
from asperity.errors import InputError, OutputError

_OTHER_FORMATS = (".nc", ".nc4", ".h5", ".hdf5")
"""Suffixes of files that are no zarr folders."""

_WHOLE = "every_chunk_is_written"
"""Mark of a folder in which a chunk that is not there was lost: zarr would read zeros in its place."""


@views.maker
def save(dataset: xr.Dataset, path: str | Path, *, overwrite: bool = False) -> None:
    """Write a Dataset to a zarr folder, which appears under its name only when it is complete.

    Parameters
    ----------
    dataset
        What to write.
    path
        The folder, such as ``"history.zarr"``.
    overwrite
        Replace the zarr folder that is there; otherwise refuse. Anything else is never replaced.

    Raises
    ------
    InputError
        The name is that of another format.
    OutputError
        The folder exists, or could not be written; nothing half-written is left.

    Notes
    -----
    `load` opens it again; so does ``xarray.open_zarr(path)``.
    """
    checks.instance("dataset", dataset, xr.Dataset, "history.dataset")
    target = Path(path)
    if target.suffix.lower() in _OTHER_FORMATS:
        advice = f'dataset.to_netcdf("{target.name}")'
        raise InputError("path", expected="a name that ends in .zarr", got=target, advice=advice)
    is_empty = target.is_dir() and not any(target.iterdir())
    if overwrite and target.exists() and not is_empty and not (target / "zarr.json").exists():
        why = "it is no zarr folder, so save did not write it"
        raise OutputError(f"{target} is kept: {why}; choose another name")
    with whole_folder(target, overwrite=overwrite) as folder, warnings.catch_warnings():
        # Text (names of swept files) has no specification in zarr 3 yet; what reads it here also wrote it.
        warnings.filterwarnings("ignore", message=".*does not have a Zarr V3 specification.*")
        # Each chunk with a checksum, so that a damaged byte is an error and never another number.
        # With the metadata in one place too, which xarray looks for first.
        warnings.filterwarnings("ignore", message="Consolidated metadata is currently not part.*")
        encoding = {name: {"compressors": [ZstdCodec(checksum=True)]} for name in dataset.variables}
        marked = dataset.assign_attrs({_WHOLE: 1})
        marked.to_zarr(folder, mode="w", consolidated=True, encoding=encoding, write_empty_chunks=True)


def load(path: str | Path) -> xr.Dataset:
    """Open a Dataset that `save` wrote, and read it into memory.

    Parameters
    ----------
    path
        The zarr folder; or the folder of a run of the command line, whose ``history.zarr`` is opened.

    Raises
    ------
    InputError
        There is no such folder, or it holds no Dataset.
    """
    folder = Path(path)
    if (folder / "history.zarr").is_dir():
        folder = folder / "history.zarr"
    if not folder.exists():
        raise InputError("path", expected="a folder that asperity wrote", got=f"{path}, which does not exist")
    if folder.is_dir() and folder.suffix != ".zarr" and not (folder / "zarr.json").exists():
        is_campaign = (folder / "plan.json").exists()
        got = f"{path}, that of a campaign" if is_campaign else f"{path}, which holds no history"
        advice = "asperity.campaign.open(path)" if is_campaign else "the folder of a run"
        raise InputError("path", expected="a folder that asperity wrote", got=got, advice=advice)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about files of others in the folder
            with xr.open_dataset(folder, engine="zarr", consolidated=False, decode_times=False) as dataset:
                loaded = dataset.load()
            # What cannot be recognized is left out without an error.
            folders = {entry.name for entry in folder.iterdir() if entry.is_dir()}
            if lost := {name for name in folders if name[0] not in "._"} - set(loaded.variables):
                raise ValueError(f"{', '.join(sorted(lost))} cannot be read")
            arrays = zarr.open_group(folder, mode="r").arrays() if loaded.attrs.pop(_WHOLE, 0) else ()
            if lost := {name for name, array in arrays if array.nchunks_initialized < array.nchunks}:
                raise ValueError(f"parts of {', '.join(sorted(lost))} are missing")
            return loaded
    except Exception as error:  # descriptions are parsed, numbers decoded: a damaged byte leads anywhere
        got = f"{path}: {reason_of(error)}"
        raise InputError("path", expected="a folder that asperity wrote", got=got) from error


@contextmanager
def whole_folder(path: Path, *, overwrite: bool = False) -> Iterator[Path]:
    """A folder to write into that takes the name ``path`` only when all is written.

    `OutputError` if ``path`` exists and is not to be overwritten, or the disk refused.
    """
    if path.exists() and not overwrite:
        raise OutputError(f"{path} exists already and is kept; choose another name, or overwrite it")
    staging = _beside(path, "partial")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        staging.mkdir()
        yield staging
        flush(staging)
        _move_into_place(staging, path)
    except OSError as error:
        if isinstance(error, OutputError):
            raise
        reason = error.strerror or str(error)
        raise OutputError(f"could not write {path}: {reason}; nothing was left there") from error
    finally:
        shutil.rmtree(staging, ignore_errors=True)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A file to write that takes the name ``path``, replacing what is there, only when all is written.

    `OutputError` if the disk refused; what was there before is untouched.
    """
    part = path.with_name(f"{_part_of(path)}{uuid.uuid4().hex}{path.suffix}")
    try:
        yield part
        _flush_file(part)
        part.replace(path)
    except OSError as error:
        raise OutputError(f"could not write {path}: {error.strerror or error}") from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def remove_parts(path: Path) -> None:
    """Remove what killed writers of a file left beside it; only for a file that has one writer."""
    for part in path.parent.glob(f"{_part_of(path)}*"):
        part.unlink(missing_ok=True)


def _part_of(path: Path) -> str:
    return f".{path.name}.part-"


def _beside(path: Path, kind: str) -> Path:
    """A hidden name that nothing has yet."""
    return path.parent / f".{path.name}.{uuid.uuid4().hex[:12]}.{kind}"


def _move_into_place(staging: Path, path: Path) -> None:
    """Rename; what was there before goes only once the new folder stands."""
    if not path.exists():
        staging.rename(path)
        return
    old = _beside(path, "old")
    path.rename(old)
    staging.rename(path)
    shutil.rmtree(old, ignore_errors=True)


def flush(folder: Path) -> None:
    """Have the disk accept every byte before the folder gets its name."""
    for entry in [*folder.rglob("*"), folder]:
        if entry.is_file():
            _flush_file(entry)
        else:
            flush_folder(entry)


def flush_folder(folder: Path) -> None:
    """Have the disk accept the names in a folder; where folders cannot be flushed, nothing is done."""
    if os.name == "posix":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _flush_file(file: Path) -> None:
    with file.open("r+b") as handle:  # Windows flushes only what is open for writing
        os.fsync(handle.fileno())
