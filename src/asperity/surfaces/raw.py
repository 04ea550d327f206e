"""What a file holds, before any rule is applied to it."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.lattice import Field


@dataclass(frozen=True)
class RawSurface:
    """Heights as a file holds them, NaN where they are undefined, and what the file says about them.

    `channels` are all channels of heights and `channel` is the one that was read; formats without channels
    have none. `remarks` is what the reader warned about.
    """

    heights: Field
    format: str
    reader: str
    """The software that read it."""
    unit: str = "1"
    """Unit of the heights; "1" if the file has none."""
    pixel_size: tuple[float, ...] | None = None
    """Distance between pixels along each axis, in `length_unit`."""
    length_unit: str | None = None
    channel: str = ""
    channels: tuple[str, ...] = ()
    says_periodic: bool = False
    """Whether the file declares itself one period of a periodic surface."""
    remarks: tuple[str, ...] = ()
