"""The content of a surface file before any step of `asperity.surfaces.read`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from asperity.base.version import __version__
from asperity.errors import SurfaceFileError
from asperity.lattice import Field

_SINGLE = 1e-5  # largest relative difference of a number from its six digits in a file
PICTURE = "row 0 is the top line of the picture that the instrument's program shows"
FIRST_LINE = "row 0 is the first line of numbers in the file"
FIRST_ROW = "row 0 is the first row of the array"
LARGEST_Y = "row 0 has the largest y"


@dataclass(frozen=True)
class RawSurface:
    """Heights of a file, NaN where they are undefined, and its metadata.

    `channels` are all channels of heights, `channel` is the one that was read; some formats have none.
    `remarks` are warnings of the reader.
    """

    heights: Field
    format: str
    reader: str = f"asperity {__version__}"
    """Name and version of the software that read it."""
    unit: str = "1"
    """Unit of the heights; "1" if the file has none."""
    pixel_size: tuple[float, ...] | None = None
    """Distance between pixels along each axis, in `length_unit`."""
    length_unit: str | None = None
    channel: str = ""
    channels: tuple[str, ...] = ()
    orientation: str = FIRST_ROW
    """Which line of the file is row 0."""
    undefined_by: tuple[str, ...] = ()
    """Values that mark undefined pixels, with their origin and their number."""
    size_from: str = "the file"
    unit_from: str = "the file"
    remarks: tuple[str, ...] = ()


def without(heights: Field, value: float, name: str, where: str = "") -> tuple[Field, str]:
    """Replace a value, to single precision, by NaN; also describe the rule and count the pixels."""
    void = np.isclose(heights, value, rtol=_SINGLE, atol=0)
    return np.where(void, np.nan, heights), f"{name} {value:g}{where}: {void.sum()} pixels"


def choose(name: str, channel: str | int | None, channels: Mapping[str, str | tuple[int, ...]]) -> str:
    """Pick a channel by its name or number, by None the only one; `channels` has the shape or place of each.

    Raises
    ------
    SurfaceFileError
        If there is no such channel, or None of several; the message lists them.
    """
    if not channels:
        expected = "no channel: this file has a single one"
        raise SurfaceFileError(name, expected=expected, got=f"channel {channel!r}")
    names = list(channels)
    if channel is None and len(names) == 1:
        return names[0]
    if isinstance(channel, int | np.integer) and 0 <= channel < len(names):
        return names[channel]
    if isinstance(channel, str) and channel in channels:
        return channel
    told = [one if isinstance(one, str) else " x ".join(map(str, one)) for one in channels.values()]
    listed = [f"{each!r} (number {i}, {told[i]})" for i, each in enumerate(names)]
    if len(listed) > 8:
        listed[8:] = [f"and {len(names) - 8} more"]
    got = "none" if channel is None else f"channel {channel!r}"
    expected = f"as the channel one of: {', '.join(listed)}"
    raise SurfaceFileError(name, expected=expected, got=got, cure={"channel": names[0]})
