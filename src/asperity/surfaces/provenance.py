"""What was understood of the file of a scan."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from asperity.base.rows import Row


def lateral_unit(unit: str | None, origin: Mapping[str, object]) -> str:
    """Name the unit of the pixels of a surface; a file may not state it, and a made surface may have none."""
    return unit or ("unit of the file" if "file" in origin else "length unit")


def understood(origin: Mapping[str, Any]) -> list[Row]:
    """Channel, orientation and units that a reader took from a file."""
    channels, undefined = origin.get("channels") or [], origin.get("undefined_by") or []
    others = f", of {', '.join(map(str, channels))}" if len(channels) > 1 else ""
    sources = ("heights", "original_unit", "unit_from"), ("pixels", "length_unit", "size_from")
    lengths = []
    for quantity, unit, how in sources:
        named = f"in {origin[unit]}" if origin.get(unit) not in (None, "", "1") else "without a unit"
        lengths += [f"{quantity} {named} (from {origin[how]})"] if origin.get(how) else []
    rows = {
        "channel": f"{origin.get('channel') or ''}{others}",
        "orientation": str(origin.get("orientation") or ""),
        "undefined": "; ".join(map(str, undefined)),
        "units": ", ".join(lengths),
    }
    return [Row(name, words) for name, words in rows.items() if words]
