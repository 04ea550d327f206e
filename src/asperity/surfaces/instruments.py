"""Files of microscopes and profilometers, through the optional library SurfaceTopography.

That library puts x first and y, upward, second. Here a surface is a matrix like any other: rows
downward, as its picture is seen, and columns to the right.
"""

from __future__ import annotations

import contextlib
import dataclasses
import importlib.metadata
import io
import logging
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from asperity.base import checks
from asperity.base.words import reason_of
from asperity.errors import SurfaceFileError
from asperity.surfaces.points import grid_of
from asperity.surfaces.raw import RawSurface

# These formats have no signature: the library takes any file of a suitable size for one of them.
_UNSIGNED_FORMATS = {"hgt": ".hgt", "nms": ".nms"}
# Spellings of units that the instruments' files are known to use.
_SPELLINGS = {"\u00b5m": "um", "\u03bcm": "um", "\u00c5": "angstrom", "\u212b": "angstrom", "A": "angstrom"}


def read_instrument(path: Path, channel: str | int | None) -> RawSurface:
    """Read one channel of heights, by its name or number; by None the default of the file."""
    with _quiet() as remarks:
        with checks.extra("instruments", f"{path}: reading an instrument's file"):
            from SurfaceTopography.IO import open_topography  # slow to import
        remarks.clear()  # the import's warnings are no remark on this file
        try:
            with open_topography(str(path)) as reader:
                raw = _read_channel(reader, path, channel)
        except SurfaceFileError:
            raise
        # The library's forty readers raise whatever a damaged byte leads them to (IndexError, KeyError,
        # struct.error, ...), so nothing less than Exception keeps the promise of one clear error.
        except Exception as error:
            got = _diagnosis(error)
            advice = "another format that the instrument's software exports, or a matrix of heights as text"
            raise SurfaceFileError(str(path), expected="a surface file", got=got, advice=advice) from error
    told = tuple(str(w.message) for w in remarks if issubclass(w.category, (UserWarning, RuntimeWarning)))
    return dataclasses.replace(raw, remarks=told)


def _read_channel(reader: Any, path: Path, channel: str | int | None) -> RawSurface:
    kind = str(reader.format())
    if path.suffix.lower() != _UNSIGNED_FORMATS.get(kind, path.suffix.lower()):
        raise SurfaceFileError(str(path), expected="a surface file", got="a file of no known kind")
    chosen = _choose(reader, path, channel)
    if chosen.is_uniform is False:
        raise SurfaceFileError(str(path), expected="heights on a regular grid", got="scattered points")
    _require_whole(reader, chosen)
    topography = _topography(chosen)
    heights = np.ma.filled(np.ma.asarray(topography.heights(), dtype=np.float64), np.nan)
    heights = heights.T[::-1] if heights.ndim == 2 else heights
    unit = _SPELLINGS.get(str(topography.unit), topography.unit)
    sizes = chosen.physical_sizes
    known = sizes is not None and all(s is not None and 0 < s < np.inf for s in sizes)
    downward = sizes[::-1] if known else ()
    pixel = tuple(float(s) / n for s, n in zip(downward, heights.shape, strict=True)) if known else None
    # Of points that are no full grid, the library makes a matrix.
    if points := kind == "asc" and not known and heights.ndim == 2 and heights.shape[1] == 3:
        heights, pixel = grid_of(str(path), heights)
    return RawSurface(
        np.array(heights, dtype=np.float64, order="C"),
        format="xyz" if points else kind,
        reader=f"SurfaceTopography {importlib.metadata.version('SurfaceTopography')}",
        unit=unit or "1",
        pixel_size=pixel,
        length_unit=unit if known else None,
        channel=str(chosen.channel_id),
        channels=tuple(str(c.channel_id) for c in reader.channels if _holds_heights(c)),
        says_periodic=bool(topography.is_periodic),
    )


def _choose(reader: Any, path: Path, channel: str | int | None) -> Any:
    """Pick the channel, which must hold heights."""
    listed = [c for c in reader.channels if _holds_heights(c)]
    if channel is None:
        candidates = [c for c in [reader.default_channel, *listed] if _holds_heights(c)]
    elif isinstance(channel, int):
        candidates = [c for c in listed if c.index == channel]
    else:
        candidates = [c for c in listed if c.channel_id == channel] or [
            c for c in listed if c.name == channel
        ]
    if not candidates:
        known = ", ".join(f"{c.channel_id!r} (number {c.index})" for c in listed)
        expected = f"one of its channels of heights: {known}" if listed else "a channel of heights"
        got = "none" if channel is None else f"channel {channel!r}"
        raise SurfaceFileError(str(path), expected=expected, got=got)
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
        # Any other trouble with a channel that nobody asked for is nobody's trouble.
        except Exception:
            continue


def _diagnosis(error: Exception) -> str:
    """Say in one line what the library's error means."""
    if type(error).__name__ == "CannotDetectFileFormat":
        return "a file of no known kind, or a damaged or truncated one"
    # Its own errors speak of the file, others (list index out of range) of its code.
    told = type(error).__module__.startswith("SurfaceTopography") and str(error)
    return "a damaged, truncated or unsupported file" + (f" ({reason_of(error)})" if told else "")


@contextlib.contextmanager
def _quiet() -> Iterator[list[warnings.WarningMessage]]:
    """Collect the library's warnings, and drop what it prints and logs about files that it does not like."""
    logging_was_below = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings(record=True) as remarks, contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("always")
            yield remarks
    finally:
        logging.disable(logging_was_below)
