"""Read surface files of all kinds; units and pixel sizes of the user replace those of the file."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from asperity.base.calls import outside
from asperity.base.files import expanded
from asperity.errors import InputError, Name, SurfaceFileError
from asperity.surfaces.heights import sides_of_pixels
from asperity.surfaces.instruments import read_instrument
from asperity.surfaces.matrix_files import read_hdf5, read_mat, read_npy, read_npz
from asperity.surfaces.raw import RawSurface, without
from asperity.surfaces.surface import Provenance
from asperity.surfaces.text_files import read_text

Length = Literal["m", "mm", "um", "nm", "pm"]

_TEXT_SUFFIXES = (".txt", ".csv", ".dat", ".asc", ".xyz")
_ARRAYS = {".npy": read_npy, ".npz": read_npz, ".mat": read_mat}


def read_raw(file: Path, channel: str | int | None, undefined_value: float | None) -> RawSurface:
    """Read a file by its extension, or else by its content; heights of the undefined value become NaN."""
    suffix = file.suffix.lower()
    with file.open("rb") as stream:
        begin = stream.read(4096)
    is_text = b"\0" not in begin or begin.startswith((b"\xff\xfe", b"\xfe\xff"))
    if suffix in _ARRAYS:
        raw = _ARRAYS[suffix](file, channel)
    elif suffix not in _TEXT_SUFFIXES and (readers := dict(outside("asperity.scans", suffix[1:]))):
        raw = readers[suffix[1:]](file)
    elif begin.startswith(b"\x89HDF") and suffix != ".datx":  # that of an interferometer
        raw = read_hdf5(file, channel)
    elif is_text and suffix in _TEXT_SUFFIXES:
        raw = read_text(file, channel)
    elif (channel_data := read_instrument(file, channel)) is not None:
        raw = channel_data
    elif suffix in _TEXT_SUFFIXES or (is_text and b"\0" not in file.read_bytes()[len(begin) :]):
        raw = read_text(file, channel)
    else:
        got, advice = "a file of no known kind, or a damaged or truncated one", "a matrix of heights as text"
        raise SurfaceFileError(str(file), expected="a surface file", got=got, advice=advice)
    if not raw.heights.size:
        raise SurfaceFileError(str(file), expected="heights", got="none")
    if raw.heights.ndim == 2 and 1 in raw.heights.shape:  # a profile
        size = raw.pixel_size and raw.pixel_size[raw.heights.shape[0] == 1 :][:1]
        raw = dataclasses.replace(raw, heights=raw.heights.ravel(), pixel_size=size)
    if raw.pixel_size and not all(0 < side < math.inf for side in raw.pixel_size):
        remark = f"left out the size of the pixels, {' x '.join(f'{side:g}' for side in raw.pixel_size)}"
        raw = dataclasses.replace(raw, pixel_size=None, length_unit=None, remarks=(*raw.remarks, remark))
    if undefined_value is not None:
        heights, rule = without(raw.heights, undefined_value, "undefined_value")
        raw = dataclasses.replace(raw, heights=heights, undefined_by=(*raw.undefined_by, rule))
    return raw


def with_lengths(
    raw: RawSurface,
    file_unit: Length | None,
    pixel_size: float | str | Sequence[float | str] | None,
    length_unit: Length | None,
) -> RawSurface:
    """Replace units and pixel size of the file by those of the user."""
    if file_unit is not None:
        raw = dataclasses.replace(raw, unit=file_unit, unit_from="file_unit")
    if pixel_size is not None:
        sizes, unit = sides_of_pixels(pixel_size, raw.heights.ndim, length_unit)
        unit = unit or raw.length_unit
        raw = dataclasses.replace(raw, pixel_size=sizes, length_unit=unit, size_from="pixel_size")
    elif length_unit is not None:
        if raw.pixel_size is None:
            advice = (Name("pixel_size"),)
            raise InputError("length_unit", expected="pixels of known size", got="none", advice=advice)
        raw = dataclasses.replace(raw, length_unit=length_unit)
    return raw


def record_of(raw: RawSurface) -> Provenance:
    """Describe the content of the file, in its own units."""
    sizes = raw.pixel_size or ()
    return {
        "format": raw.format,
        "reader": raw.reader,
        "reader_remarks": list(dict.fromkeys(raw.remarks)),
        "channel": raw.channel,
        "channels": list(raw.channels),
        "orientation": raw.orientation,
        "undefined_by": list(raw.undefined_by),
        "original_shape": list(raw.heights.shape),
        "original_unit": raw.unit,
        "unit_from": raw.unit_from if raw.unit != "1" else "",
        "physical_size": [s * n for s, n in zip(sizes, raw.heights.shape, strict=False)],
        "size_from": raw.size_from if sizes else "",
        "length_unit": raw.length_unit or "",
    }


def checked_file(path: str | Path) -> tuple[Path, str]:
    """Return the file and its checksum; `SurfaceFileError` if it cannot be read."""
    got = ""
    try:
        file = expanded(path)
        if not file.exists():
            got = "no such file"
        elif not file.is_file():
            got = "a directory" if file.is_dir() else "something that is not a regular file"
        elif file.stat().st_size == 0:
            got = "an empty file"
    except (TypeError, ValueError, OSError) as error:
        expected = "the path of a surface file"
        raise SurfaceFileError("path", expected=expected, got=f"{path!r} ({error})") from error
    if got:
        raise SurfaceFileError(str(path), expected="a surface file", got=got)
    try:
        with file.open("rb") as stream:
            return file, hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise SurfaceFileError(str(file), expected="a readable file", got=str(error.strerror)) from error
