"""Holds and velocity steps of a record, and static friction after holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.base import checks, views
from asperity.base.checks import Floats
from asperity.errors import InputError
from asperity.friction.laws import first_velocity
from asperity.friction.records import HOLD, RUN_IN, STEPPED, Record

Events = Literal["all", "holds", "steps"]
_EVENTS: dict[str, tuple[str, tuple[int, ...]]] = {
    "all": ("a rest, or a step of the velocity", (HOLD, STEPPED)),
    "holds": ("a rest", (HOLD,)),
    "steps": ("a step", (STEPPED,)),
}

_SHORT, _FEW = 2, 10
"""Rows of a short rest, and largest number of short rests that are no noise of the displacement."""


class Event(NamedTuple):
    """A hold from `time` to `end`, or a step of the velocity of the load point, numbered from 1.

    `before` and `after` are the velocities of the load point. `start` and `stop` are the window of a fit,
    from the middle of the slide before to the end of the slide after.
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
    """Find the holds and steps of a record of a machine; the record must go on after them."""
    checks.instance("record", record, Record, "asperity.friction.read_record(path)")
    if record.drive is None:
        return []
    speeds, edges = record.drive.velocity.tolist(), record.drive.edges(record.time).tolist()
    events: list[Event] = []
    for n in range(1, len(speeds)):
        rests = speeds[n] == 0
        if speeds[n - 1] == 0 or (rests and n + 1 == len(speeds)):
            continue
        last, start = n + rests, (edges[n - 1] + edges[n]) / 2
        times = edges[n], edges[last], speeds[n - 1], speeds[last], start, edges[last + 1]
        events.append(Event(len(events) + 1, "hold" if rests else "step", *times))
    return events


def rows_of(record: Record, events: object) -> NDArray[np.bool_]:
    """Mask of the rows of the run-in and of such events, shape (n,); `InputError` without such events."""
    needed, wanted = _EVENTS[checks.choice("events", events, tuple(_EVENTS))]
    _refuse_noise(record)
    kinds = record.events
    rests = bool((record.velocity[1:] == 0).any())
    found = (rests and HOLD in wanted) or (STEPPED in wanted and (kinds == STEPPED).any())
    if not (found or (record.presses_anew and events == "all")):
        got = "rests only"
        if not rests:
            got = f"slip at {record.speed(first_velocity(record.velocity))}, without rest or step"
        raise InputError("record", expected=f"{needed}, to learn b and D_c from", got=got)
    return np.isin(kinds, (RUN_IN, *wanted))


def _refuse_noise(record: Record) -> None:
    """Refuse many short rests, which noise of a displacement makes."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], record.velocity == 0, [False]]).astype(int)))
    many = int(np.count_nonzero(edges[1::2] - edges[::2] <= _SHORT))
    if many > _FEW and not record.strength_at_rest:
        expected = "rests of the machine, longer than two rows"
        got = f"{many} short ones, as noise or rounding of the displacement makes them"
        advice = "asperity.friction.Record.of_machine(time, friction, slip=...), which allows for noise"
        raise InputError("record", expected=expected, got=got, advice=advice)


@dataclass(frozen=True, eq=False, repr=False)
class HoldPeaks(views.Brief):
    """Static friction after holds; arrays of shape (holds,).

    `duration` is the time at rest. `peak` is friction at the end of the rest, if this is the strength, or
    the largest in the slip after it, until the velocity steps. `before` is the mean in the second half of the
    slip before, after its last step, at `velocity`.
    """

    duration: Floats
    peak: Floats
    before: Floats
    velocity: Floats


def hold_peaks(record: Record) -> HoldPeaks:
    """Find static friction against hold time, of the holds with slip before and after them.

    By the aging law, without a direct effect and after steady sliding at V, peak - before is
    b ln(1 + V duration/D_c), which `asperity.fits.logarithm` fits.
    """
    checks.instance("record", record, Record, "asperity.friction.record_of(history)")
    _refuse_noise(record)
    time, velocity, friction = record.time, record.velocity, record.friction
    rested, steps = np.diff(velocity == 0), record.steps
    # Slip in part of an interval is no step, and a slider that gets up speed seems to step in each.
    steps[1:] &= ~(rested | steps)[:-1]
    steps[:-1] &= ~rested[1:]
    runs = np.split(np.arange(time.size), np.flatnonzero(rested | steps) + 1)  # rests, and slips
    rows = []
    for slid, rest, slip in zip(runs, runs[1:], runs[2:], strict=False):
        if velocity[rest[0]] == 0:
            # A load point may turn up to a row before the last of the slip.
            slipping = friction[slip[: max(1, slip.size - 1)]]
            peak = friction[rest[-1]] if record.strength_at_rest else slipping.max()
            late = slid[slid.size // 2 :]
            speed = np.median(velocity[late])
            rows.append((time[rest[-1]] - time[slid[-1]], peak, friction[late].mean(), speed))
    return HoldPeaks(*np.array(rows, dtype=np.float64).reshape(-1, 4).T)
