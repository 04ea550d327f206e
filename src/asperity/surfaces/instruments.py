"""Files of microscopes and profilometers, through the optional library SurfaceTopography.

The arrays of that library have x first and y second. Here they are transposed: a surface is the picture that
the instrument's program shows, rows downward and columns to the right.
"""

from __future__ import annotations

import contextlib
import dataclasses
import importlib.metadata
import io
import logging
import re
import traceback
import warnings
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asperity.base import checks
from asperity.base.words import reason_of
from asperity.errors import SurfaceFileError
from asperity.surfaces.prepare import spelled
from asperity.surfaces.raw import PICTURE, RawSurface

_OURS = ("asc", "xyz", "npy", "npz", "mat", "h5")  # formats that are read without the library
_UNSIGNED = ("nms", "hgt")  # formats without a signature: any file of a suitable size would pass
_LONGEST_XML = 2**24  # bytes of the header of an .x3p
_PIXELS = 0.01, 100.0  # pixels of a confocal microscope, in um


def read_instrument(
    path: Path, channel: str | int | None, formats: Sequence[str] | None = None
) -> RawSurface | None:
    """Read one channel of heights, by its name or number; by None the default of the file.

    Readers of the file's extension are tried first, then those that recognize its content; or the readers of
    `formats` alone. None where no reader knows the file.
    """
    with _quiet() as remarks:
        with checks.extra("instruments", f"{path}: reading an instrument's file"):
            import SurfaceTopography.IO  # noqa: F401  # slow to import
        remarks.clear()  # the import's warnings are no remark on this file
        try:
            if (opened := _opened(path, formats)) is None:
                return None
            with opened as reader:
                raw = _read_channel(reader, path, channel)
        except SurfaceFileError:
            raise
        # The library's forty readers raise whatever a damaged byte leads them to (IndexError, KeyError,
        # struct.error, ...), so nothing less than Exception keeps the promise of one clear error.
        except Exception as error:
            got = _diagnosis(error)
            advice = "another format that the instrument's software exports, or a matrix of heights as text"
            raise SurfaceFileError(str(path), expected="a surface file", got=got, advice=advice) from error
    warned = (str(w.message) for w in remarks if issubclass(w.category, (UserWarning, RuntimeWarning)))
    return dataclasses.replace(raw, remarks=(*raw.remarks, *warned))


def _opened(path: Path, formats: Sequence[str] | None) -> Any:
    """Open a file; None if no reader knows it, the error of the reader that should if it is damaged."""
    from SurfaceTopography.IO import readers
    from SurfaceTopography.IO.Reader import MagicMatch

    suffix = path.suffix.lower().removeprefix(".")
    by_name = {reader: suffix in reader.file_extensions() for reader in readers}
    if formats is None:
        unsigned = {reader for reader in readers if reader.format() in _UNSIGNED and not by_name[reader]}
        foreign = [r for r in readers if r.format() not in _OURS and r not in unsigned]
        candidates = sorted(foreign, key=lambda reader: not by_name[reader])
    else:
        by_format = {reader.format(): reader for reader in readers}
        candidates = [by_format[name] for name in formats]
    with path.open("rb") as file:
        begin = file.read(512)
    source = _repaired(path, begin)
    begin = source.getvalue()[:512] if isinstance(source, io.BytesIO) else begin
    failures = []
    for reader in candidates:
        signed = reader.can_read(begin)
        if signed == MagicMatch.NO:
            continue
        if isinstance(source, io.BytesIO):
            source.seek(0)
        try:
            return _without_metadata(reader)(source)
        except Exception as error:
            failures += [error] if by_name[reader] or signed == MagicMatch.YES else []
    if failures:
        raise failures[0]
    return None


def _without_metadata(reader: Any) -> Any:
    """Keep a reader from metadata that are not used, such as dates."""
    channels = getattr(reader, "_channel_bindings", None)
    if not channels:
        return reader
    bindings = [{name: value for name, value in each.items() if name != "info"} for each in channels]
    return type(reader.__name__, (reader,), {"_channel_bindings": bindings})


def _repaired(path: Path, begin: bytes) -> io.BytesIO | str:
    """The path; or the content with a header that the library reads in place of an equivalent one."""
    if begin.startswith(b"DSCOMPRESSED"):
        expected, got = "an uncompressed file", "a compressed one"
        raise SurfaceFileError(str(path), expected=expected, got=got, advice="saving it without compression")
    if begin[:8] in (b"aISO-2.0", b"aBCR-1.0", b"bBCR-1.0"):  # the same header, in meters
        return io.BytesIO(begin[:1] + b"ISO-1.0" + path.read_bytes()[8:])
    if begin.startswith(b"DIGITAL SURF"):  # a micro sign in UTF-8
        content = path.read_bytes()
        return io.BytesIO(re.sub(rb"\xc2\xb5m([\0 ])", b"\xb5m\\1\\1", content[:512]) + content[512:])
    if path.suffix.lower() == ".x3p":
        repaired = io.BytesIO(path.read_bytes())  # no member is read that the library does not read
        with zipfile.ZipFile(repaired, "a") as archive:
            with archive.open(archive.NameToInfo.pop("main.xml")) as xml:  # whose dash may be another one
                main = re.sub(rb"(<Revision>)[^<]*5436[^<]*<", rb"\1ISO5436 - 2000<", xml.read(_LONGEST_XML))
            archive.writestr("main.xml", main)
        return repaired
    return str(path)


def _read_channel(reader: Any, path: Path, channel: str | int | None) -> RawSurface:
    kind = str(reader.format())
    chosen = _choose(reader, path, channel)
    if chosen.is_uniform is False:
        raise SurfaceFileError(str(path), expected="heights on a regular grid", got="scattered points")
    _require_whole(reader, chosen)
    topography = _topography(chosen)
    heights = np.ma.filled(np.ma.asarray(topography.heights(), dtype=np.float64), np.nan).T
    unit = spelled(topography.unit)
    sizes = chosen.physical_sizes
    downward = () if sizes is None or None in sizes else sizes[::-1]
    pixel = tuple(float(s) / n for s, n in zip(downward, heights.shape, strict=False)) or None
    remarks: tuple[str, ...] = ()
    if kind == "nms" and pixel and not _PIXELS[0] <= pixel[-1] <= _PIXELS[1]:
        # The library takes the spacing for mm, which gives pixels of meters in the files there are.
        pixel = tuple(1e-6 * side for side in pixel)
        remarks = (f"the file has no unit of the pixel size, {1e3 * pixel[-1]:.6g}: taken as nm",)
    return RawSurface(
        np.array(heights, dtype=np.float64, order="C"),
        format=kind,
        reader=f"SurfaceTopography {importlib.metadata.version('SurfaceTopography')}",
        unit=unit,
        pixel_size=pixel,
        length_unit=unit if pixel and unit != "1" else None,
        channel=str(chosen.channel_id),
        channels=tuple(str(c.channel_id) for c in reader.channels if _holds_heights(c)),
        orientation=PICTURE,
        remarks=remarks,
    )


def _choose(reader: Any, path: Path, channel: str | int | None) -> Any:
    listed = [c for c in reader.channels if _holds_heights(c)]
    if not listed:
        raise SurfaceFileError(str(path), expected="a channel of heights", got="none in a unit of length")
    candidates = [c for c in listed if channel in (c.channel_id, c.index)]
    candidates += [c for c in listed if c.name == channel]
    if channel is None:
        candidates = [c for c in [reader.default_channel, *listed] if _holds_heights(c)]
    if not candidates:
        names = ", ".join(f"{c.channel_id!r} (number {c.index})" for c in listed)
        expected = f"one of its channels of heights: {names}"
        raise SurfaceFileError(str(path), expected=expected, got=f"channel {channel!r}")
    return candidates[0]


def _holds_heights(channel: Any) -> bool:
    # A unit that is a pair (lateral, vertical) marks data that is no length: phase, amplitude, ...
    return bool(channel.is_height_channel) and (channel.unit is None or isinstance(channel.unit, str))


def _topography(channel: Any) -> Any:
    """Read a channel; the library insists on a physical size, and gets the pixels where the file has none."""
    return channel.topography(physical_sizes=channel.nb_grid_pts if channel.physical_sizes is None else None)


def _require_whole(reader: Any, chosen: Any) -> None:
    """Raise the library's error if another channel is cut off: the file is then not what was measured."""
    from SurfaceTopography.Exceptions import CorruptFile

    for other in reader.channels:
        if other.index == chosen.index:
            continue
        try:
            _topography(other).heights()
        except CorruptFile:
            raise
        # Other errors of channels that are not asked for do not matter.
        except Exception:
            continue


def _diagnosis(error: Exception) -> str:
    """Say in one line what the library's error means."""
    # Its own errors speak of the file, others (list index out of range) of its code.
    raised = traceback.extract_tb(error.__traceback__)[-1].filename
    of_file = type(error).__module__.startswith("SurfaceTopography") or type(error) is ValueError
    if of_file and "SurfaceTopography" in raised and str(error):
        return f"a file that cannot be read ({reason_of(error)})"
    return "a damaged or truncated file, or one of another kind"


@contextlib.contextmanager
def _quiet() -> Iterator[list[warnings.WarningMessage]]:
    """Collect the library's warnings; drop what it prints and logs."""
    logging_was_below = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings(record=True) as remarks, contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("always")
            yield remarks
    finally:
        logging.disable(logging_was_below)
