"""Holds and steps of a record, numbered, and fitted one by one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from asperity.base import checks
from asperity.errors import InputError
from asperity.friction.fitting import rate_and_state
from asperity.friction.laws import StateLaw
from asperity.friction.loading import Drive
from asperity.friction.parameters import MachineFit
from asperity.friction.records import Record


@dataclass(frozen=True)
class Event:
    """A hold, or a step of the velocity of the load point.

    Attributes
    ----------
    number
        From 1.
    kind
        ``"hold"`` or ``"step"``.
    time, end
        When the load point stops, or its velocity steps; and when it goes on, or the same.
    before, after
        Its velocities, in the slide before and after.
    start, stop
        The window of a fit: from half of the slide before, to the end of the slide after.
    """

    number: int
    kind: Literal["hold", "step"]
    time: float
    end: float
    before: float
    after: float
    start: float
    stop: float


def events_of(record: Record) -> list[Event]:
    """Find the holds and steps of a record of a machine; those that the record does not end within."""
    checks.instance("record", record, Record, "asperity.friction.read_record(path)")
    if record.drive is None:
        return []
    speeds, edges = record.drive.velocity, record.drive.edges(record.time)
    found: list[Event] = []
    for n in range(1, speeds.size):
        before, now = float(speeds[n - 1]), float(speeds[n])
        if before == 0 or (now == 0 and n + 1 == speeds.size):
            continue
        last = n + 1 if now == 0 else n
        start = float(edges[n - 1] + edges[n]) / 2
        times = (float(edges[n]), float(edges[last]))
        kind: Literal["hold", "step"] = "hold" if now == 0 else "step"
        after, stop = float(speeds[last]), float(edges[last + 1])
        found.append(Event(len(found) + 1, kind, *times, before, after, start, stop))
    return found


def part_of(record: Record, start: float, stop: float) -> Record:
    """The rows of a record of a machine between two times, with the kinks there."""
    assert record.drive is not None
    kept = (record.time >= start) & (record.time <= stop)
    inside = (record.drive.kinks > start) & (record.drive.kinks < stop)
    first = int(np.searchsorted(record.drive.kinks, start, side="right"))
    speeds = record.drive.velocity[first : first + int(inside.sum()) + 1]
    drive = Drive(record.drive.kinks[inside], speeds, record.drive.spread[inside])
    rows: dict[str, Any] = {name: getattr(record, name)[kept] for name in ("time", "velocity", "friction")}
    rows |= {
        name: None if (place := getattr(record, name)) is None else place[kept]
        for name in ("load_point", "slip")
    }
    return replace(record, drive=drive, **rows)


def fit_events(
    record: Record, *, law: StateLaw = "aging", stiffness: float | str | None = None
) -> Mapping[Event, MachineFit | None]:
    """Fit the events of a record of a machine, each by itself.

    Parameters
    ----------
    record
        Of a machine.
    law, stiffness
        As in `rate_and_state`.

    Returns
    -------
    dict
        By event, its fit; None where it has too few rows, or none that a law fits.
    """
    found: dict[Event, MachineFit | None] = {}
    for event in events_of(record):
        try:
            fit = rate_and_state(part_of(record, event.start, event.stop), law=law, stiffness=stiffness)
        except InputError as error:
            if error.name == "stiffness":
                raise
            found[event] = None
        else:
            found[event] = fit if isinstance(fit, MachineFit) else None
    return found
