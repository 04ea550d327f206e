"""Legs of a history as a machine wrote it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Ge

from asperity.base import checks
from asperity.base import units as si
from asperity.base.parameters import Quantity, parameters_of
from asperity.errors import InputError, Name
from asperity.protocols.legs import TARGETS, Hold, Leg, Ramp, Step
from asperity.sheets.columns import TIME, Chosen, Columns, Role, in_line, named
from asperity.sheets.tables import Table

_SAME_START = 1e-6
"""Relative difference of a load and an equal one that a solver found."""

_ROLES = (
    Role(
        "",
        "",
        r"temp(?!s\b)|rate\b|veloc|speed|geschw|vitesse|\bstd|\berr|shear|scher|schub|tang|lateral|horizont"
        r"|reib|fri[ck]|frott|\bpor[eo]|tensi|traction|\bzug|luft|\boil\b|\bair\b|confin|hydrau|atmos|offset|preload"
        r"|setpoint|\bmax|chang|anderung|\bdelta\b|δ",
    ),
    TIME,
    Role("separation", "m", r"separation|abstand|\bgap\b|spalt|ecart"),
    Role("approach", "m", r"displac|verschieb|deplac|approach|annaher|rapproch|\bweg\b|stroke|crosshead"),
    Role("load", "N", r"load|force|kraft|last\b|belastung\b|charge|effort|weight|gewicht|poids|^f ?[nz]?$"),
    Role("pressure", "Pa", r"press|druck|stress|spannung|contrainte|^(sigma|σ) ?n?$"),
)
"""Columns of a measured history; the first is of what is left alone."""


class MeasuredHistory(tuple[Leg, ...]):
    """Legs of a measured history; see `measured`.

    Attributes
    ----------
    start
        Where it begins, as the argument of `asperity.press`: ``{"load": 46.0}``; empty for an approach.
    read
        What was read, in one line.
    """

    start: dict[str, float]
    read: str


def measured(
    file: Annotated[
        str | Path | Mapping[str, Sequence[float] | checks.Floats],
        Quantity("table of a measured load or separation"),
    ],
    *,
    columns: Annotated[Chosen | None, Quantity("columns to read, names or numbers from 0")] = None,
    units: Annotated[Sequence[str] | str | None, Quantity("units of its columns: load=mN")] = None,
    compression: Annotated[Literal["positive", "negative"] | None, Quantity("sign of what presses")] = None,
    within: Annotated[float, Ge(0), Quantity("deviation up to which rows are one ramp")] = 0.0,
) -> MeasuredHistory:
    """Legs of a history as a machine wrote it: ramps from row to row, of which rows on a line are one.

    Rows of equal values are a hold, and rows of one time are a step. The first row is the beginning: press
    the contact there by ``asperity.press(..., **history.start)``. Each leg ends at a recorded time.

    Parameters
    ----------
    file
        Table of a time and one of a load (force), a pressure, a separation or an approach (displacement), by
        names in English, German or French with units; or a mapping of arrays, shape (rows,), or a data frame.
        Arrays without units are in those of the contact. An approach counts from the first row.
    columns, units
        Columns to read, and units of them, as in `asperity.relaxation.read`.
    compression
        Sign of what presses: ``"positive"``, by default, or ``"negative"``. A load that never presses needs
        ``"positive"``, too.
    within
        Deviation up to which rows are one ramp, >= 0, in SI units, or in those of the contact: the noise of
        the load, for instance. By default only rounding.

    Raises
    ------
    InputError
        The table cannot be read, times fall back, or it is not clear what is prescribed or presses.
    """
    read_by = parameters_of(measured)
    compression = read_by["compression"].read("compression", compression)
    within = read_by["within"].read("within", within)
    table = _table_of(file) if hasattr(file, "keys") else file
    read = Columns(table, _ROLES, columns, units)
    places, bare = read.by_role, isinstance(table, Table)
    targets = [name for name in TARGETS if name in places]
    if "time" not in places or len(targets) != 1:
        expected = f"a column of time and one of {', '.join(TARGETS[:-1])} or {TARGETS[-1]}"
        got = named(read.table) if len(targets) < 2 else " and ".join(targets)
        cure = {"columns": f"{places.get('time', 0)} {places[targets[0]] if targets else 1}"}
        raise InputError(read.table.name, expected=expected, got=got, cure=cure)
    target = targets[0]
    _check_alone(read, places[target], target)
    times, values = read.values("time", bare=bare), read.values(target, bare=bare)
    if not (np.ptp(times) or np.ptp(values)):
        raise InputError(read.table.name, expected="at least 2 rows that differ", got=f"{len(times)}")
    if (back := np.diff(times) < 0).any():
        raise in_line(read.table, int(np.argmax(back)) + 1, places["time"], "time", "not to fall back")
    if compression and target == "separation":
        raise InputError("compression", expected="none of a separation", got=repr(compression))
    if target in ("load", "pressure") and compression is None and values.max() <= 0 > values.min():
        expected = f"the sign of a {target} that presses, as none in {read.table.name} is above 0"
        raise InputError("compression", expected=expected, got="none", cure={"compression": "negative"})
    sign = -1.0 if compression == "negative" else 1.0
    values = sign * (values - values[0] if target == "approach" else values) + 0.0
    new = np.diff(times, prepend=-math.inf) + np.abs(np.diff(values, prepend=math.inf)) > 0
    times, values = times[new], values[new]
    corners = _corners(times, values, within or 0.0)
    history = MeasuredHistory(_legs_between(target, times[corners], values[corners]))
    pressed_by = target if values[0] else target.replace("pressure", "load")  # both touch only
    history.start = {} if target == "approach" else {pressed_by: float(values[0])}
    side = "" if target == "separation" else f", {'below' if sign < 0 else 'above'} 0 presses"
    history.read = f"{read.read}, {len(history)} legs{side}"
    return history


def start_of(protocol: object) -> dict[str, float]:
    """Where a measured history begins; empty for other legs."""
    return protocol.start if isinstance(protocol, MeasuredHistory) else {}


def check_start(protocol: object, contact: Any) -> None:
    """`InputError` if a measured history begins elsewhere than the contact is."""
    for name, value in start_of(protocol).items():
        present = contact.separation if name == "separation" else contact.load
        present /= contact.nominal_area if name == "pressure" else 1.0
        if abs(present - value) > _SAME_START * max(abs(present), abs(value)):
            advice = f"asperity.press(..., {name}={value!r})"
            expected = f"a contact at the {name} at which the history begins, {value:g}"
            raise InputError("protocol", expected=expected, got=f"{present:g}", advice=advice)


def _check_alone(columns: Columns, place: int, target: str) -> None:
    """Refuse a column of unknown name beside what is prescribed, in units of it: it may be meant."""
    unit = next(role.unit for role in _ROLES if role.name == target)
    for at in sorted({*columns.unknown} & {*columns.chosen}):
        if (written := columns.unit_text(at)) and si.factor(si.spelled(written) or "", unit) is not None:
            got = f"{columns.table.names[place]!r} and {columns.table.names[at]!r}"
            advice = (Name("columns"), " of the time and of one of them")
            raise InputError(columns.table.name, expected=f"one column of {target}", got=got, advice=advice)


def _table_of(arrays: Any) -> Table:
    """Table of arrays by their names; `InputError` unless they are numbers in as many rows."""
    names = [*map(str, arrays.keys())]
    values = np.column_stack(checks.broadcast(**{name: checks.line(name, arrays[name]) for name in names}))
    lines = [(number, ", ".join(map(str, row))) for number, row in enumerate(values.tolist(), 1)]
    return Table("history", names, [""] * len(names), values, lines, ",")


def _corners(times: np.ndarray, values: np.ndarray, within: float) -> list[int]:
    """Rows between which the values are lines, up to a deviation and rounding: each as long as can be."""
    eps = 8 * float(np.finfo(float).eps)
    largest, latest = float(np.abs(values).max()), float(np.abs(times).max())
    corners, low, high = [0], -math.inf, math.inf
    for row in range(1, len(times)):
        lapse, slope = _slope(times, values, corners[-1], row)
        if corners[-1] < row - 1 and not low <= slope <= high:
            corners.append(row - 1)
            low, high = -math.inf, math.inf
            lapse, slope = _slope(times, values, row - 1, row)
        if not lapse:
            corners.append(row)
            continue
        slack = (within + eps * (largest + abs(slope) * latest)) / lapse
        low, high = max(low, slope - slack), min(high, slope + slack)
    return [*corners[: -1 if corners[-1] == len(times) - 1 else None], len(times) - 1]


def _slope(times: np.ndarray, values: np.ndarray, begin: int, end: int) -> tuple[float, float]:
    """Time between two rows, and the slope of the line; NaN of two rows of one time."""
    lapse = float(times[end] - times[begin])
    return lapse, float(values[end] - values[begin]) / lapse if lapse else math.nan


def _legs_between(target: str, times: np.ndarray, values: np.ndarray) -> Iterator[Leg]:
    """Steps, holds and ramps between rows."""
    held: Any = "separation" if target in ("separation", "approach") else "load"
    for lapse, value, rise in zip(np.diff(times).tolist(), values[1:].tolist(), np.diff(values), strict=True):
        change: Any = {target: value}
        yield Step(**change) if not lapse else Ramp(lapse, **change) if rise else Hold(lapse, hold=held)
        held = None  # as before
