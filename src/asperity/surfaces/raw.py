"""What a file holds, before any rule is applied to it."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.lattice import Field


@dataclass(frozen=True)
class RawSurface:
    """Heights as a file holds them, and what the file says about them.

    Attributes
    ----------
    heights
        Heights in `unit`, one or two dimensions; NaN where the measurement is undefined.
    format
        Name of the format.
    reader
        The software that read it.
    unit
        Unit of the heights, or "1" if the file has none.
    pixel_size
        Distance between pixels along each axis in `length_unit`, or None if the file has none.
    length_unit
        Unit of the pixel size, or None.
    channel, channels
        The channel that was read, and all channels of heights; empty for formats without channels.
    says_periodic
        Whether the file declares itself one period of a periodic surface.
    remarks
        What the reader warned about.
    """

    heights: Field
    format: str
    reader: str
    unit: str = "1"
    pixel_size: tuple[float, ...] | None = None
    length_unit: str | None = None
    channel: str = ""
    channels: tuple[str, ...] = ()
    says_periodic: bool = False
    remarks: tuple[str, ...] = ()
