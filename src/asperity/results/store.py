"""Save and load Datasets: a folder has its name only when it is complete."""

from __future__ import annotations

import glob
import itertools
import os
import shutil
import uuid
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from asperity.base import checks
from asperity.base.files import Standing, beside, expanded, kind_of, standing, without_links
from asperity.base.words import reason_of
from asperity.errors import InputError, OutputError

if TYPE_CHECKING:
    import xarray as xr

_OTHER_FORMATS = (".nc", ".nc4", ".h5", ".hdf5")
"""Suffixes of files that are no zarr folders."""

_WHOLE = "every_chunk_is_written"
"""Mark of a folder in which a chunk that is not there was lost: zarr would read zeros in its place."""


def save(dataset: xr.Dataset, path: str | Path, *, overwrite: bool = False) -> None:
    """Write a Dataset to a zarr folder, which appears under its name only when it is complete.

    Parameters
    ----------
    dataset
        The Dataset.
    path
        The folder, such as ``"history.zarr"``.
    overwrite
        Replace an existing zarr folder; otherwise refuse. Anything else is never replaced.

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
    import xarray as xr

    checks.instance("dataset", dataset, xr.Dataset, "history.dataset")
    target = expanded(path)
    if target.suffix.lower() in _OTHER_FORMATS:
        advice = f'dataset.to_netcdf("{target.name}")'
        raise InputError("path", expected="a name that ends in .zarr", got=target, advice=advice)
    is_empty = target.is_dir() and not any(target.iterdir())
    if overwrite and target.exists() and not is_empty and not (target / "zarr.json").exists():
        why = "it is no zarr folder, so save did not write it"
        raise OutputError(f"{target} is kept: {why}; choose another name")
    with whole_folder(target, overwrite=overwrite) as folder:
        write_into(dataset, folder)


def write_into(dataset: xr.Dataset, folder: Path) -> None:
    """Write a Dataset into a folder that is renamed later, as `save` does."""
    from zarr.codecs import ZstdCodec

    with warnings.catch_warnings():
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
    import xarray as xr
    import zarr

    folder = expanded(path)
    if (folder / "history.zarr").is_dir():
        folder = folder / "history.zarr"
    if not folder.exists():
        raise InputError("path", expected="a folder that asperity wrote", got=f"{path}, which does not exist")
    if folder.is_dir() and folder.suffix != ".zarr" and not (folder / "zarr.json").exists():
        is_campaign = kind_of(folder) == "campaign"
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
    except Exception as error:  # descriptions are parsed, numbers decoded: a damaged byte leads anywhere
        got = f"{path}: {reason_of(error)}"
        raise InputError("path", expected="a folder that asperity wrote", got=got) from error
    return loaded


class PlaceTakenError(OutputError):
    """Results are complete, but under another name, because theirs was taken meanwhile."""


@contextmanager
def whole_folder(path: Path, *, overwrite: bool | Standing = False) -> Iterator[Path]:
    """A folder to write into that takes the name ``path`` only when all is written.

    It replaces an empty folder; and with ``overwrite`` what stood there when this was called, or when
    `standing` gave it. If anything else stands there in the end, the results take a name beside it.

    `OutputError` if ``path`` exists and is not to be overwritten, or the disk refused; or with that name.
    """
    replaceable = standing(path) if overwrite is True else overwrite or frozenset()
    if overwrite is False and standing(path):
        raise OutputError(f"{path} exists already and is kept; choose another name, or overwrite it")
    with _staged(path, "; nothing was left there") as folder:
        finished = folder / "made"
        finished.mkdir()
        yield finished
        flush(finished)
        _move_into_place(finished, path, replaceable)


@contextmanager
def whole_file(path: Path, *, overwrite: bool | Standing = True) -> Iterator[Path]:
    """A file to write that takes the name ``path`` only when all is written.

    It replaces what is there, or only what stood there earlier, when `standing` gave it.

    `OutputError` if the disk refused; what was there before is untouched.
    """
    with _staged(path) as folder:
        part = folder / path.name
        yield part
        _flush_file(part)
        if overwrite is True:
            part.replace(path)
        else:
            _move_into_place(part, path, overwrite or frozenset())


@contextmanager
def _staged(path: Path, aftermath: str = "") -> Iterator[Path]:
    """A hidden folder beside a name, locked while its writer lives; those of killed writers are removed."""
    from filelock import FileLock

    hidden = beside(without_links(path).with_name(f".{without_links(path).name}"), "")
    try:
        hidden.parent.mkdir(parents=True, exist_ok=True)
        for remains in hidden.parent.glob(f"{glob.escape(hidden.name)}.*.partial"):
            with suppress(OSError, NotImplementedError), FileLock(remains / "lock", blocking=False):
                shutil.rmtree(remains, ignore_errors=True)
        folder = beside(hidden, f".{uuid.uuid4().hex[:12]}.new")
        folder.mkdir()
        lock = FileLock(folder / "lock")
        try:
            with suppress(NotImplementedError):  # there are disks without locks: there nothing is removed
                lock.acquire()
            folder = folder.rename(folder.with_suffix(".partial"))
            yield folder
        finally:
            lock.release()
            shutil.rmtree(folder, ignore_errors=True)
    except OSError as error:
        if isinstance(error, OutputError):
            raise
        reason = error.strerror or str(error)
        raise OutputError(f"could not write {path}: {reason}{aftermath}") from error


def _move_into_place(source: Path, path: Path, replaceable: Standing) -> None:
    """Rename to a path, whose replaceable content goes afterwards.

    `PlaceTakenError`, with the name taken beside it, if other content is there.
    """
    target = without_links(path)
    old = beside(target.with_name(f".{target.name}"), f".{uuid.uuid4().hex[:12]}.old")
    present = standing(target)
    if present and present <= replaceable and target.is_dir() and source.is_dir():
        target.rename(old)
        if not standing(old) <= replaceable:  # something came at the last moment
            old.rename(target)
    try:
        _rename(source, target, over=bool(present) and present <= replaceable)
    except OSError:
        if not target.exists():
            raise
        names = (beside(target.with_name(target.stem), f"-{n}{target.suffix}") for n in itertools.count(2))
        free = next(name for name in names if not name.exists())
        _rename(source, free, over=False)
        why = f"{path} holds what was not there when this began, and is kept"
        raise PlaceTakenError(f"{why}; the results are in {path.with_name(free.name)}") from None
    finally:
        if old.exists():
            old.rename(source.parent / "old" if target.exists() else target)


def _rename(source: Path, target: Path, *, over: bool) -> None:
    """Rename; an empty folder of that name is replaced, or a file if `over`."""
    if source.is_dir():
        with suppress(OSError):  # only Windows needs it
            target.rmdir()
    elif not over:
        target.touch(exist_ok=False)
    source.replace(target)


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
